"""Points with their nominal places and what was found of them, before it is said who found it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.importers.sheets import stacked
from matstd.twin.frames import Array
from matstd.twin.record import IntArray, Labels

NEARER = 2.0
"""So many times nearer to the place of another than to its own a point is called misplaced."""

FEWEST = 4
"""Points from which a list has a common displacement."""


@dataclass(frozen=True, eq=False)
class PointList:
    """Points with their nominal place and what was found of each coordinate.

    Attributes:
        nominal: (N, 3), mm.
        deviation: Measured minus nominal, (N, 3), mm; not a number where it was not measured.
        feature: Names of the points, (N,).
        setup: Which part or set-up a point belongs to, (N,).
        approach: Sign of the last motion of X, Y and Z towards the point, (N, 3); 0 unknown.
        run: Which list it stands in where there are several, (N,); "" of one.
        line: Line of the file, (N,).
    """

    nominal: Array
    deviation: Array
    feature: Labels
    setup: Labels
    line: IntArray
    approach: IntArray
    run: Labels = field(default_factory=lambda: np.zeros(0, dtype="U1"))


def misplaced(points: PointList) -> list[tuple[str, str]]:
    """Points that were found nearer to where another one belongs: (its name, the other's).

    What all points of a coordinate have in common is taken off first. Names mixed up, or a list in
    another order, look so. A point without a name is named by its line.

    Args:
        points: Brought to the nominal frame.
    """
    from scipy.spatial import KDTree  # a fifth of a second, for lists of points alone

    out = []
    for one in np.unique(points.setup):
        of = points.setup == one
        nominal, seen = points.nominal[of], np.isfinite(points.deviation[of])
        if len(nominal) < FEWEST or not seen.any():
            continue
        off = points.deviation[of]
        common = [np.median(v[s]) if s.any() else 0.0 for v, s in zip(off.T, seen.T, strict=True)]
        off = np.nan_to_num(off - common)
        name = [f or f"line {n}" for f, n in zip(points.feature[of], points.line[of], strict=True)]
        distance, near = KDTree(nominal).query(nominal + off, k=2)
        own = near[:, 0] == np.arange(len(near))  # then the second is the nearest other one
        other = np.where(own, near[:, 1], near[:, 0])
        distance = np.where(own, distance[:, 1], distance[:, 0])
        nearer = NEARER * distance < np.linalg.norm(off, axis=1)
        out += [(str(name[k]), str(name[other[k]])) for k in np.flatnonzero(nearer)]
    return out


def joined_points(lists: Sequence[PointList], names: Sequence[str] = ()) -> PointList:
    """Several lists as one; each is a run of its own, with set-ups that bear its name."""
    if len(lists) == 1:
        return lists[0]
    if len(set(names)) < len(names):
        names = [f"{name}-{i + 1}" for i, name in enumerate(names)]
    return stacked(
        [
            replace(
                p,
                setup=np.array([f"{name}_{s}" for s in p.setup]),
                run=np.full(len(p.line), name),
            )
            for p, name in zip(lists, names, strict=True)
        ]
    )
