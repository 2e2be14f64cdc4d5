"""Which carriers and variables a remainder depends on: smooth curves, tried all at once.

For every carrier and every variable, and every pair of variables, the remainder is regressed on a
smooth curve (or surface) of prior size and correlation length, whose log evidence ranks them. A
curve knows no formula, so that nothing about the law is assumed but that it is smooth or has
corners; what is too quick for it is scanned as a sine.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.laws.space import MIN_OWN, Space
from matstd.diagnosis.residual import Bearer, bearers
from matstd.twin.frames import Array
from matstd.twin.laws import ON_BALL, SHAPES, WORDS, Driver, curve_columns, drivers, grid

LENGTHS = (0.03, 0.1, 0.3)
"""Correlation lengths of curves, as shares of the range."""

SIZES = np.geomspace(0.3, 300.0, 7)
"""Sizes of curves, in units of the noise at a touch."""

SURFACE_WAVES = 6
"""Waves of either variable of a surface, from none on."""

SURFACE_LENGTH = 0.2

DOMAIN_MARGIN = 0.1
"""Share of the range by which the domain of a curve exceeds the values on either side."""

FAST_WAVES = 1200
"""Frequencies up to which sines of a reading are scanned, per range and half."""

CURVE_CHARGE = 4.0
"""Log evidence that size and length of a curve cost."""


class Found(NamedTuple):
    """A carrier with one or two variables, and the log evidence of a curve over them."""

    bearer: Bearer
    drivers: tuple[Driver, ...]
    evidence: float
    length: float  # correlation length, as a share of the domain; 0: no curve, a direction
    size: float  # of the curve, mm or rad


@dataclass(frozen=True, eq=False)
class Field:
    """All that a law may be made of in one run.

    Attributes:
        x: Values of every variable at all touches, by name.
    """

    bearers: tuple[Bearer, ...]
    drivers: tuple[Driver, ...]
    x: dict[str, Array]

    def used(self, driver: Driver, space: Space) -> Array:
        """Values of a variable at the rows used, (N,)."""
        return self.x[driver.name][space.used]

    def domain(self, driver: Driver) -> tuple[float, float]:
        """Range of a variable with a margin."""
        x = self.x[driver.name]
        low, high = float(x.min()), float(x.max())
        return low - DOMAIN_MARGIN * (high - low), high + DOMAIN_MARGIN * (high - low)


def field_of(space: Space) -> Field:
    """Carriers and variables of the touches of a run."""
    variables = tuple(drivers(space.touches))
    standard = ("shift", "tilt", "growth") if space.touches.instrument.has_standard else ()
    return Field(
        bearers=tuple(bearers(space.touches, space.white, (*standard, "bias"))),
        drivers=variables,
        x={d.name: d.values(space.touches) for d in variables},
    )


def singles(space: Space, field: Field) -> list[Found]:
    """Every carrier with every variable, by the evidence of a curve, the best first."""
    out = []
    bases = {d.name: waves_of(space, field, d) for d in field.drivers}
    for bearer in field.bearers:
        for driver in field.drivers:
            B, weights, lengths = bases[driver.name]
            G, b, scale = normal_equations(space, bearer.C, B)
            weights = np.tile(weights, (1, bearer.C.shape[1]))
            value, which, size = curve_evidence(space, G, b, weights)
            size = size / scale if scale > 0.0 else 0.0
            out.append(
                Found(
                    bearer=bearer,
                    drivers=(driver,),
                    evidence=value,
                    length=lengths[which],
                    size=size,
                )
            )
    return sorted(out, key=lambda f: -f.evidence)


def waves_of(space: Space, field: Field, driver: Driver) -> tuple[Array, Array, Sequence[float]]:
    """Waves of a variable (N, K), the prior deviations of their amplitudes (L, K), the lengths."""
    x = field.used(driver, space)
    values = np.unique(x)
    if driver.nature == "sign" or len(values) <= 2:
        return (x - driver.zero)[:, None] / _unit(x, driver), np.ones((1, 1)), (0.0,)
    low, high = field.domain(driver)
    plain = curve_columns(x, low, high, 0.0)
    weights = [curve_columns(np.array([low]), low, high, length)[0] for length in LENGTHS]
    whole = np.sqrt(plain.shape[1])
    return plain * whole, np.array(weights), LENGTHS


def _unit(x: Array, driver: Driver) -> float:
    """Size of a variable of two values."""
    return float(np.abs(x - driver.zero).max()) or 1.0


def normal_equations(space: Space, C: Array, B: Array) -> tuple[Array, Array, float]:
    """Gram matrix and right side of all products of carrier columns and waves, freed of the model.

    Scaled so that a wave of amplitude one is one noise at a touch, on average; the factor comes
    back.
    """
    n = len(C)
    scale = float(np.sqrt((C**2).sum(axis=1).mean()))
    P = (C[:, :, None] * B[:, None, :]).reshape(n, -1) / max(scale, 1e-300)
    U = space.basis.T @ P
    return P.T @ P - U.T @ U, P.T @ space.r, scale


def curve_evidence(space: Space, G: Array, b: Array, weights: Array) -> tuple[float, int, float]:
    """Best log evidence over lengths and sizes, with the number of the length and the size.

    ``log p(y) = -1/2 log det(1 + s^2 G) - nu/2 log(y^T (1 + s^2 C C^T)^-1 y)``.
    """
    best, which, size = -np.inf, 0, 1.0
    for i, w in enumerate(weights):
        values, vectors = np.linalg.eigh(w[:, None] * G * w)
        values = np.maximum(values, 0.0)
        along = (vectors.T @ (w * b)) ** 2
        # every size at once: sizes lie along the first axis
        s2 = SIZES[:, None] ** 2
        explained = (s2 * along / (1.0 + s2 * values)).sum(axis=1)
        each = space.gained(explained) - 0.5 * np.log1p(s2 * values).sum(axis=1)
        j = int(np.argmax(each))
        if each[j] > best:
            best, which, size = float(each[j]), i, float(SIZES[j])
    return best - CURVE_CHARGE, which, size


def pairs(space: Space, field: Field) -> list[Found]:
    """Every carrier with every two variables, by the evidence of a surface, the best first."""
    bases = {d.name: _surface_waves(space, field, d) for d in field.drivers}
    out = []
    for i, one in enumerate(field.drivers):
        for other in field.drivers[i + 1 :]:
            if not _is_sensible(one, other):
                continue
            (A, wa), (B, wb) = bases[one.name], bases[other.name]
            W = (A[:, :, None] * B[:, None, :]).reshape(len(A), -1)[:, 1:]
            w = (wa[:, None] * wb).reshape(-1)[1:]
            for bearer in field.bearers:
                G, b, scale = normal_equations(space, bearer.C, W)
                weights = np.tile(w, bearer.C.shape[1])[None]
                value, _, size = curve_evidence(space, G, b, weights)
                size = size / max(scale, 1e-300)
                found = Found(
                    bearer=bearer,
                    drivers=(one, other),
                    evidence=value,
                    length=SURFACE_LENGTH,
                    size=size,
                )
                out.append(found)
    return sorted(out, key=lambda f: -f.evidence)


def _is_sensible(one: Driver, other: Driver) -> bool:
    """Whether a law of both is to be expected: one of them is a reading or a direction."""
    moved = ("linear", "rotary", "sign")
    if one.name.startswith("trend-") or other.name.startswith("trend-"):
        return False
    is_two_signs = one.nature == other.nature == "sign"
    return not is_two_signs and (one.nature in moved or other.nature in moved)


def _surface_waves(space: Space, field: Field, driver: Driver) -> tuple[Array, Array]:
    """Waves of one variable of a surface, the constant first, and their prior deviations."""
    x = field.used(driver, space)
    one = np.ones(len(x))
    if driver.nature == "sign" or len(np.unique(x)) <= 2:
        return np.stack([one, (x - driver.zero) / _unit(x, driver)], axis=1), np.ones(2)
    if driver.nature == "rotary" and np.ptp(x) > np.pi:
        waves = [f(k * x) for k in (1, 2, 3) for f in (np.cos, np.sin)]
        return np.stack([one, *waves], axis=1), np.array([1.0, 1.0, 1.0, 0.7, 0.7, 0.4, 0.4])
    low, high = field.domain(driver)
    share = (x - low) / (high - low)
    k = np.arange(SURFACE_WAVES)
    weight = 1.0 / (1.0 + (np.pi * k * SURFACE_LENGTH) ** 2)
    return np.cos(np.pi * share[:, None] * k), weight / weight[1]


class Rough(NamedTuple):
    """A shape that no smooth curve shows, at a carrier, with the squared residual it explains."""

    bearer: Bearer
    driver: Driver
    word: str  # of the shape
    places: tuple[float, ...]
    explained: float


def rough_shapes(space: Space, field: Field, each: int) -> list[Rough]:
    """Quick sines of readings and of time, and loops of hysteresis: the best of either kind.

    What they explain is approximate: the model imitates little of a quick wave or of a loop.
    """
    C = np.concatenate([b.C[:, i : i + 1] for b in field.bearers for i in range(b.C.shape[1])], 1)
    owner = [b for b in field.bearers for _ in range(b.C.shape[1])]
    share = max(1.0 - space.basis.shape[1] / space.count, 0.1)
    R, S = C * space.r[:, None], C**2
    waves, loops = [], []
    for driver in field.drivers:
        x = field.used(driver, space)
        if driver.nature == "linear" or driver.name == "time":
            f = _quick_frequencies(driver, x)
            angle = 2.0 * np.pi * x[:, None] * f
            along = (R.T @ np.sin(angle)) ** 2 + (R.T @ np.cos(angle)) ** 2  # (carriers, F)
            power = along / (0.5 * share * S.sum(axis=0)[:, None] + MIN_OWN)
            waves += [
                Rough(
                    bearer=owner[i],
                    driver=driver,
                    word="sine",
                    places=(float(1.0 / f[j]),),
                    explained=power[i, j],
                )
                for i, j in _of_carriers(power)
            ]
        if "hysteresis" in WORDS[driver.nature] and driver.name not in ON_BALL:
            points = grid(SHAPES["hysteresis"], driver, x)
            whole = field.x[driver.name]
            H = np.stack([SHAPES["hysteresis"].values(whole, *p)[0][space.used] for p in points], 1)
            power = (R.T @ H) ** 2 / (share * (S.T @ H**2) + MIN_OWN)
            loops += [
                Rough(
                    bearer=owner[i],
                    driver=driver,
                    word="hysteresis",
                    places=tuple(points[j].tolist()),
                    explained=power[i, j],
                )
                for i, j in _of_carriers(power)
            ]
    return [r for kind in (waves, loops) for r in sorted(kind, key=lambda r: -r.explained)[:each]]


def _quick_frequencies(driver: Driver, x: Array) -> Array:
    """Too quick for a curve; touches follow one another at nearly even times, anywhere."""
    limit = 0.45 * len(np.unique(x)) if driver.nature == "time" else FAST_WAVES
    return np.asarray(np.arange(8.0, limit, 0.5) / np.ptp(x))


def _of_carriers(power: Array) -> list[tuple[int, int]]:
    """Row of every carrier with its largest column."""
    return list(enumerate(np.argmax(power, axis=1).tolist()))


def modulations(space: Space, field: Field, C: Array) -> list[tuple[Driver, float]]:
    """Variables on which the size of a law depends, by what a curve gains over none, best first.

    Args:
        C: Columns of a carrier times a shape, (N, k).
    """
    constant = np.ones((len(C), 1))
    G, b, _ = normal_equations(space, C, constant)
    plain, _, _ = curve_evidence(space, G, b, np.ones((1, C.shape[1])))
    out = []
    for driver in field.drivers:
        B, weights, _ = waves_of(space, field, driver)
        if driver.nature == "sign" or len(weights) == 1:
            B = np.hstack([constant, B])
            weights = np.ones((1, 2))
        G, b, _ = normal_equations(space, C, B)
        value, _, _ = curve_evidence(space, G, b, np.tile(weights, (1, C.shape[1])))
        out.append((driver, value - plain))
    return sorted(out, key=lambda one: -one[1])
