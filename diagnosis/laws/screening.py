"""Which carriers and variables a remainder depends on: smooth curves, tried all at once.

For every carrier and every variable, and every pair of variables, the remainder is regressed on a
smooth curve (or surface) of prior size and correlation length, whose log evidence ranks them. A
curve knows no formula, so that nothing about the law is assumed but that it is smooth or has
corners; what is too quick for it is scanned as a sine.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.laws.curves import Curves, Group, Waves, curve_evidence
from matstd.diagnosis.laws.space import MIN_OWN, Space
from matstd.diagnosis.residual import Bearer, bearers
from matstd.twin.effects import grid_distance
from matstd.twin.frames import Array
from matstd.twin.laws import ON_BALL, SHAPES, WORDS, Driver, curve_columns, drivers, grid
from matstd.twin.record import Touches

LENGTHS = (0.03, 0.1, 0.3)  # correlation lengths of curves, as shares of the range
SURFACE_WAVES = 6  # waves of either variable of a surface, from none on

SURFACE_LENGTH = 0.2

DOMAIN_MARGIN = 0.1
"""Share of the range by which the domain of a curve exceeds the values on either side."""

LOOPS = ("hysteresis", "play-quad")  # shapes with a memory, which a curve shows least
FAST_WAVES = 1200  # frequencies up to which sines of a reading are scanned, per range and half


class Found(NamedTuple):
    """A carrier with one or two variables, and the log evidence of a curve over them."""

    bearer: Bearer
    drivers: tuple[Driver, ...]
    evidence: float
    length: float  # correlation length, as a share of the domain; 0: no curve, a direction
    size: float  # of the curve, mm or rad


@dataclass(frozen=True, eq=False)
class Field:
    """All that a law may be made of in one run."""

    bearers: tuple[Bearer, ...]
    drivers: tuple[Driver, ...]
    x: dict[str, Array]  # values of every variable at all touches, by name

    def domain(self, driver: Driver) -> tuple[float, float]:
        """Range of a variable with a margin."""
        x = self.x[driver.name]
        low, high = float(x.min()), float(x.max())
        return low - DOMAIN_MARGIN * (high - low), high + DOMAIN_MARGIN * (high - low)


def field_of(touches: Touches, u: Array) -> Field:
    """Carriers and variables of the touches of a run.

    Args:
        u: Stated uncertainty of the touches, (N,), mm.
    """
    variables = tuple(drivers(touches))
    standard = ("shift", "tilt", "growth") if touches.instrument.has_standard else ()

    def white(columns: Array) -> Array:
        return np.asarray(columns / u[:, None])

    return Field(
        bearers=tuple(bearers(touches, white, (*standard, "bias"))),
        drivers=variables,
        x={d.name: d.values(touches) for d in variables},
    )


def curves_of(field: Field) -> Curves:
    """Smooth curves over every variable, at every carrier."""
    return Curves.of(field.bearers, [waves_of(field, d) for d in field.drivers])


def surfaces_of(field: Field) -> Curves:
    """Smooth surfaces over every two variables, at every carrier."""
    bases = {d.name: _surface_waves(field, d) for d in field.drivers}
    waves = []
    for one, other in combinations(field.drivers, 2):
        if _is_sensible(one, other):
            (A, wa), (B, wb) = bases[one.name], bases[other.name]
            W = (A[:, :, None] * B[:, None, :]).reshape(len(A), -1)[:, 1:]
            w = (wa[:, None] * wb).reshape(1, -1)[:, 1:]
            waves.append(Waves((one, other), W, w, (SURFACE_LENGTH,)))
    return Curves.of(field.bearers, waves)


def by_evidence(space: Space, curves: Curves, least: float = -np.inf) -> list[Found]:
    """Every carrier with every variable or pair of them, the best first; exact above the least."""
    out = []
    for waves, group, found in curves.evidence(space, least):
        for i, bearer in enumerate(group.bearers):
            size = float(found.size[i] / group.scale[i]) if group.scale[i] > 0.0 else 0.0
            out.append(
                Found(
                    bearer=bearer,
                    drivers=waves.drivers,
                    evidence=float(found.value[i]),
                    length=waves.lengths[int(found.which[i])],
                    size=size,
                )
            )
    return sorted(out, key=lambda f: -f.evidence)


def waves_of(field: Field, driver: Driver) -> Waves:
    """Waves of a variable; of a direction or of two values the variable itself."""
    x = field.x[driver.name]
    values = np.unique(x)
    if driver.nature == "sign" or len(values) <= 2:
        B = (x - driver.zero)[:, None] / _unit(x, driver)
        return Waves((driver,), B, np.ones((1, 1)), (0.0,))
    low, high = field.domain(driver)
    plain = curve_columns(x, low, high, 0.0)
    weights = [curve_columns(np.array([low]), low, high, length)[0] for length in LENGTHS]
    return Waves((driver,), plain * np.sqrt(plain.shape[1]), np.array(weights), LENGTHS)


def _unit(x: Array, driver: Driver) -> float:
    """Size of a variable of two values."""
    return float(np.abs(x - driver.zero).max()) or 1.0


def evidence_of(space: Space, C: Array, waves: Waves) -> tuple[float, float, float]:
    """Log evidence of a curve at columns of a carrier (N, k), with its length and its size."""
    group = Group((C * space.used[:, None])[None])
    U = space.basis.T @ (group.C[0][:, :, None] * waves.B[:, None, :]).reshape(len(C), -1)
    weights = np.tile(waves.weights, (1, C.shape[1]))
    G = group.gram(waves.B) - U.T @ U
    found = curve_evidence(space, G, group.right_side(space.r, waves.B), weights)
    size = float(found.size[0] / max(group.scale[0], 1e-300))
    return float(found.value[0]), waves.lengths[int(found.which[0])], size


def _is_sensible(one: Driver, other: Driver) -> bool:
    """Whether a law of both is to be expected: one of them is a reading or a direction."""
    moved = ("linear", "rotary", "sign")
    if one.name.startswith("trend-") or other.name.startswith("trend-"):
        return False
    is_two_signs = one.nature == other.nature == "sign"
    return not is_two_signs and (one.nature in moved or other.nature in moved)


def _surface_waves(field: Field, driver: Driver) -> tuple[Array, Array]:
    """Waves of one variable of a surface, the constant first, and their prior deviations."""
    x = field.x[driver.name]
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
    C = C * space.used[:, None]
    owner = [b for b in field.bearers for _ in range(b.C.shape[1])]
    share = max(1.0 - space.basis.shape[1] / space.count, 0.1)
    R, S = C * space.r[:, None], C**2
    waves, loops = list[Rough](), list[Rough]()
    for driver in field.drivers:
        x = field.x[driver.name]
        if driver.nature == "linear" or driver.name == "time":
            f = _quick_frequencies(driver, x)
            angle = 2.0 * np.pi * x[:, None] * f
            along = (R.T @ np.sin(angle)) ** 2 + (R.T @ np.cos(angle)) ** 2  # (carriers, F)
            power = along / (0.5 * share * S.sum(axis=0)[:, None] + MIN_OWN)
            waves += _best_of_carriers(owner, driver, "sine", 1.0 / f[:, None], power)
        for word in LOOPS if driver.name not in ON_BALL else ():
            if word in WORDS[driver.nature]:
                points = grid(SHAPES[word], driver, x)
                H = np.stack([SHAPES[word].values(x, *p)[0] for p in points], 1)
                power = (R.T @ H) ** 2 / (share * (S.T @ H**2) + MIN_OWN)
                loops += _best_of_carriers(owner, driver, word, points, power)
    return [r for kind in (waves, loops) for r in sorted(kind, key=lambda r: -r.explained)[:each]]


def _best_of_carriers(
    owner: Sequence[Bearer], driver: Driver, word: str, places: Array, power: Array
) -> list[Rough]:
    """Every column of a carrier at the places (G, K) where it explains most: power (columns, G)."""
    return [
        Rough(
            bearer=owner[i],
            driver=driver,
            word=word,
            places=tuple(places[j]),
            explained=power[i, j],
        )
        for i, j in enumerate(np.argmax(power, axis=1) if power.size else ())
    ]


def _quick_frequencies(driver: Driver, x: Array) -> Array:
    """Too quick for a curve; touches follow one another at nearly even times, anywhere.

    Readings on an even grid show a wave below twice its distance as a longer one.
    """
    places = np.unique(x)
    if driver.nature == "time":
        limit = 0.45 * len(places)
    else:
        distance = grid_distance(places)
        limit = min(FAST_WAVES, 0.5 * np.ptp(x) / distance) if distance else FAST_WAVES
    return np.asarray(np.arange(8.0, limit, 0.5) / np.ptp(x))


def modulations(space: Space, field: Field, C: Array) -> list[tuple[Driver, float]]:
    """Variables on which the size of a law depends, by what a curve gains over none, best first.

    Args:
        C: Columns of a carrier times a shape, (N, k).
    """
    constant = Waves((), np.ones((len(C), 1)), np.ones((1, 1)), (0.0,))
    plain = evidence_of(space, C, constant)[0]
    out = []
    for driver in field.drivers:
        waves = waves_of(field, driver)
        if waves.lengths[0] == 0.0:
            B = np.hstack([constant.B, waves.B])
            waves = waves._replace(B=B, weights=np.ones((1, 2)))
        out.append((driver, evidence_of(space, C, waves)[0] - plain))
    return sorted(out, key=lambda one: -one[1])
