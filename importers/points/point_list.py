"""Points with nominal and measured coordinates, whichever machine measured them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.twin.frames import Array, IntArray
from matstd.twin.record import Labels
from matstd.twin.rows import stacked

MISPLACED_RATIO = 2.0
"""A point this many times nearer to another one's place than to its own is misplaced."""
MIN_LISTED_POINTS = 4  # points needed to determine a common displacement


@dataclass(frozen=True, eq=False)
class PointList:
    """Points with their nominal place and the deviation of each coordinate."""

    nominal: Array  # (N, 3), mm
    deviation: Array  # measured minus nominal, (N, 3), mm; not a number where it was not measured
    feature: Labels  # names of the points, (N,)
    setup: Labels  # which part or set-up a point belongs to, (N,)
    line: IntArray  # line of the file, (N,)
    approach: IntArray  # sign of the last motion of X, Y and Z towards the point, (N, 3); 0 unknown
    # which list it stands in where there are several, (N,); "" of one
    run: Labels = field(default_factory=lambda: np.zeros(0, dtype="U1"))


def misplaced(points: PointList) -> list[tuple[str, str]]:
    """Points found nearer to the nominal place of another one: (its name, the other's).

    In a list that was brought to the nominal frame the median of each coordinate is subtracted
    first. Mixed-up names, or a list in another order, cause this. A point without a name is named
    by its line.
    """
    from scipy.spatial import KDTree  # a fifth of a second, for lists of points alone

    out = []
    for one in np.unique(points.setup):
        of = points.setup == one
        nominal, seen = points.nominal[of], np.isfinite(points.deviation[of])
        if len(nominal) < MIN_LISTED_POINTS or not seen.any():
            continue
        off = points.deviation[of]
        common = [np.median(v[s]) if s.any() else 0.0 for v, s in zip(off.T, seen.T, strict=True)]
        off = np.nan_to_num(off - common)
        name = [f or f"line {n}" for f, n in zip(points.feature[of], points.line[of], strict=True)]
        distance, near = KDTree(nominal).query(nominal + off, k=2)
        own = near[:, 0] == np.arange(len(near))  # then the second is the nearest other one
        other = np.where(own, near[:, 1], near[:, 0])
        distance = np.where(own, distance[:, 1], distance[:, 0])
        nearer = MISPLACED_RATIO * distance < np.linalg.norm(off, axis=1)
        out += [(str(name[k]), str(name[other[k]])) for k in np.flatnonzero(nearer)]
    return out


def joined_points(lists: Sequence[PointList], names: Sequence[str] = ()) -> PointList:
    """Several lists as one; each becomes a run, with its name in those of its set-ups."""
    if len(lists) == 1:
        return lists[0]
    if len(set(names)) < len(names):
        names = [f"{name}-{i + 1}" for i, name in enumerate(names)]
    parts = []
    for p, name in zip(lists, names, strict=True):
        setup = np.array([f"{name}_{s}" for s in p.setup])
        parts.append(replace(p, setup=setup, run=np.full(len(p.line), name)))
    return stacked(parts)
