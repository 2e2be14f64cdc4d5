"""Patterns without a name: smooth functions of any variable or pair, groups, waves in time.

They stand for whatever the library of effects does not hold. A pattern is a set of features of the
touches with a spectrum that says how rough a function is expected to be; whether anything of it is
in a residual is a question that needs no name of a cause.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from matstd.diagnosis.evidence import ResidualSpace
from matstd.twin.frames import Array, IntArray
from matstd.twin.record import Touches

ORDER_ALONE = 12  # half waves over the range of a variable by itself
ORDER_PAIR = 9  # half waves of both variables of a pair together
ROUGHNESS = (0.3, 0.12, 0.05)  # correlation lengths that are tried, as shares of the range
MAX_GROUPS = 150  # labels with more values than this are not tried one by one
FULL_BELOW = 4000  # beyond this many touches patterns are looked for in an even choice of so many


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Features of one or two variables in one direction."""

    variables: tuple[str, ...]  # columns of the run file that it varies with
    direction: str  # along what it acts: "normal", or a direction of the machine
    shapes: Array  # functions of the variables, (N, K); all directions share them
    part: Array  # deviation along the normal per unit along the direction, (N,), mm per mm
    spectra: Array  # expected share of the variance in each feature, one row a roughness, (L, K)

    def whitened(self, complement: ResidualSpace, rows: IntArray) -> Array:
        """Deviation along the normal by every function over the noise, (R, K).

        Args:
            rows: Which of the touches in use, (R,).
        """
        if complement.whitener is not None:
            return complement.whitener(self.shapes * self.part[:, None])[rows]
        used = np.flatnonzero(complement.used)[rows]
        return np.asarray(self.shapes[used] * (self.part[used] / complement.u[rows])[:, None])


def variables(touches: Touches) -> dict[str, Array]:
    """Everything recorded that varies, by the column of the run file, in its unit, (N,) each."""
    chain = touches.chain
    out: dict[str, Array] = {}
    for axis in chain.programmed_axes:
        link = chain.link(axis)
        out[link.column] = touches.reading(axis) / link.unit
    out["time_s"] = touches.since_start
    out |= {f"T_{sensor}_degC": values for sensor, values in touches.temperature.items()}
    out |= {f"p{c}_mm": touches.point[:, i] for i, c in enumerate("xyz")}
    out |= {f"n{c}": touches.normal[:, i] for i, c in enumerate("xyz")}
    if touches.spindle_rpm is not None:
        out["spindle_rpm"] = touches.spindle_rpm
    if touches.force is not None:
        out |= {f"F{c}_N": touches.force[:, i] for i, c in enumerate("xyz")}
    return {name: v for name, v in out.items() if np.ptp(v) > 1e-9 * max(1.0, np.abs(v).max())}


def directions(touches: Touches) -> dict[str, Array]:
    """Deviation along the normal per unit along the normal and along X, Y, Z of the machine."""
    links = touches.chain.links
    first = next(i for i, link in enumerate(links) if not link.carries_workpiece)
    along = {"normal": np.ones(len(touches))}
    along |= {c: touches.signature.twist[:, first, i] for i, c in enumerate("XYZ")}
    return {name: v for name, v in along.items() if np.any(np.abs(v) > 1e-9)}


def half_waves(values: Array, order: int) -> Array:
    """``cos(pi k u)``, k = 0 .. order, u the value scaled to [0, 1] by its range, (N, K)."""
    u = (values - values.min()) / np.ptp(values)
    return np.cos(np.pi * np.arange(order + 1) * u[:, None])


def alone_spectra(order: int) -> Array:
    """Spectra over k = 1 .. order of the roughnesses, (L, K)."""
    k = np.arange(1, order + 1)
    return _normalised([np.exp(-0.5 * (np.pi * k * r) ** 2) for r in ROUGHNESS])


def _normalised(rows: list[Array]) -> Array:
    """Rows that sum to 1."""
    return np.stack([row / row.sum() for row in rows])


def paired(values: tuple[Array, Array]) -> tuple[Array, Array]:
    """Products of half waves of two variables up to a common order, and their spectra."""
    a, b = (half_waves(v, ORDER_PAIR) for v in values)
    orders = [(i, j) for i in range(ORDER_PAIR + 1) for j in range(ORDER_PAIR + 1 - i) if i + j > 0]
    i, j = np.array(orders).T
    squared = i**2 + j**2
    spectra = [np.exp(-0.5 * np.pi**2 * squared * r**2) for r in ROUGHNESS]
    return a[:, i] * b[:, j], _normalised(spectra)


def groups(touches: Touches) -> dict[str, IntArray]:
    """Labels of the touches with a moderate number of values, (N,) each; each grouping once."""
    pose = np.unique(np.column_stack([touches.setup, touches.pose]), axis=0, return_inverse=True)
    labels = {
        "feature": np.unique(touches.feature, return_inverse=True)[1],
        "pose": pose[1].reshape(-1),
        "setup": touches.setup,
    }
    for i, axis in enumerate(touches.chain.axes):
        if axis in touches.chain.programmed_axes:
            sides = np.unique(np.sign(touches.approach[:, i]), return_inverse=True)[1]
            labels[f"dir{axis}"] = sides.reshape(-1)
    both = len(np.unique(np.column_stack([labels["feature"], labels["pose"]]), axis=0))
    if both == 1 + labels["feature"].max() == 1 + labels["pose"].max():
        del labels["pose"]  # cycles of a positioning test, holes of a list
    return {k: v for k, v in labels.items() if 1 < len(np.unique(v)) <= MAX_GROUPS}


def pairs(touches: Touches, known: Mapping[str, Array]) -> list[tuple[str, str]]:
    """Pairs of variables that physics may join: two readings, reading and time, two coordinates."""
    chain = touches.chain
    readings = [v for v in known if v.split("_")[0] in chain.axes]
    points = [v for v in known if v in ("px_mm", "py_mm", "pz_mm")]
    timed = [(a, "time_s") for a in readings] if "time_s" in known else []
    return [*combinations(readings, 2), *timed, *combinations(points, 2)]


def patterns(touches: Touches) -> Iterator[Pattern]:
    """Every smooth pattern and every grouping that a run can show."""
    along = directions(touches)
    for names, shapes, spectra in _shapes(touches):
        for direction, part in along.items():
            yield Pattern(
                variables=names, direction=direction, shapes=shapes, part=part, spectra=spectra
            )


def _shapes(touches: Touches) -> Iterator[tuple[tuple[str, ...], Array, Array]]:
    """Variables, functions (N, K) and spectra (L, K) of the same, whatever the direction."""
    known = variables(touches)
    for name, values in known.items():
        yield (name,), half_waves(values, ORDER_ALONE)[:, 1:], alone_spectra(ORDER_ALONE)
    for first, second in pairs(touches, known):
        yield (first, second), *paired((known[first], known[second]))
    for name, label in groups(touches).items():
        F = (label[:, None] == np.arange(label.max() + 1)).astype(float)
        F = F[:, F.any(axis=0)]
        yield (name,), F, np.full((1, F.shape[1]), 1.0 / F.shape[1])


def thinned(complement: ResidualSpace) -> IntArray:
    """Touches in use that are looked at, by number: all, or an even choice of a long run."""
    n = len(complement.u)
    return np.unique(np.linspace(0, n - 1, min(n, FULL_BELOW)).astype(np.int64))
