"""Which carriers and variables a remainder depends on: smooth curves, tried all at once.

For every carrier and every variable, and every pair of variables, the remainder is regressed on a
smooth curve (or surface) of prior size and correlation length, whose log evidence ranks them. A
curve knows no formula, so that nothing about the law is assumed but that it is smooth or has
corners; what is too quick for it is scanned as a sine.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from itertools import combinations
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from matstd.diagnosis.laws.curves import Curves, Group, Waves, curve_evidence
from matstd.diagnosis.laws.space import MIN_OWN, SMALLEST_COLUMN, Space
from matstd.diagnosis.residual import Bearer, bearers
from matstd.twin.effects import grid_distance
from matstd.twin.frames import Array
from matstd.twin.laws import (
    ON_BALL,
    SHAPES,
    WORDS,
    Driver,
    Shape,
    curve_columns,
    drivers,
    grid,
    shapes_of,
)
from matstd.twin.record import Touches

LENGTHS = (0.03, 0.1, 0.3)  # correlation lengths of curves, as shares of the range
SCAN_WAVES, SCAN_LENGTH = 6, 0.2
"""Waves of either variable of a surface that is scanned, from none on, and its length."""

DOMAIN_MARGIN = 0.1
"""Share of the range by which the domain of a curve exceeds the values on either side."""

LOOPS = ("hysteresis", "play-quad")  # shapes with a memory, which a curve shows least
FAST_WAVES = 1200  # frequencies up to which sines of a reading are scanned, per range and half

PER_DRIVER = 3  # most carriers of one variable: others would crowd out a second variable


Single = NDArray[np.float32]


class Found(NamedTuple):
    """A carrier with one or two variables, and the log evidence of a curve over them."""

    bearer: Bearer
    drivers: tuple[Driver, ...]
    evidence: float
    explained: float  # squared residual
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
            waves.append(Waves((one, other), W, w, (SCAN_LENGTH,)))
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
                    explained=float(found.explained[i]),
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


def evidence_of(space: Space, C: Array, waves: Waves) -> tuple[float, float, float, float]:
    """Log evidence of a curve at columns of a carrier (N, k), what it explains, length and size."""
    group = Group((C * space.used[:, None])[None])
    U = space.basis.T @ (group.C[0][:, :, None] * waves.B[:, None, :]).reshape(len(C), -1)
    weights = np.tile(waves.weights, (1, C.shape[1]))
    G = group.gram(waves.B) - U.T @ U
    found = curve_evidence(space, G, group.right_side(space.r, waves.B), weights)
    size = float(found.size[0] / max(group.scale[0], 1e-300))
    length = waves.lengths[int(found.which[0])]
    return float(found.value[0]), float(found.explained[0]), length, size


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
    k = np.arange(SCAN_WAVES)
    weight = 1.0 / (1.0 + (np.pi * k * SCAN_LENGTH) ** 2)
    return np.cos(np.pi * share[:, None] * k), weight / weight[1]


class Scanned(NamedTuple):
    """Shapes of a variable with one number of coefficients, beside one another."""

    driver: Driver
    shapes: tuple[Shape, ...]
    points: tuple[Array, ...]  # the grid of each, (G, places)
    columns: Single  # of all of them, one at most, (coefficients, N, all points)

    @classmethod
    def of(cls, driver: Driver, x: Array, shapes: Sequence[Shape], points: Sequence[Array]) -> Self:
        """In single precision, since scans rank points; what is kept is computed anew."""
        each = [_columns(s, x, own) for s, own in zip(shapes, points, strict=True)]
        columns = np.concatenate(each, axis=2)
        columns /= np.maximum(np.abs(columns).max(axis=1, keepdims=True), SMALLEST_COLUMN)
        return cls(driver, tuple(shapes), tuple(points), columns.astype(np.float32))


def _columns(shape: Shape, x: Array, points: Array) -> Array:
    """Columns of a shape at points of its grid, (coefficients, N, G)."""
    if shape.remembers:
        return np.stack([np.stack(shape.values(x, *at)) for at in points], axis=2)
    wide = shape.values(x[:, None], *points.T)
    return np.stack([np.broadcast_to(column, (len(x), len(points))) for column in wide])


@dataclass(frozen=True, eq=False)
class Grids:
    """Columns of all shapes of the variables of a run, made once."""

    field: Field
    _made: dict[tuple[str, int | None], list[Scanned]] = dataclass_field(default_factory=dict)

    def of(self, driver: Driver, most: int | None = None) -> list[Scanned]:
        """Every shape of a variable at its grid, of each at most so many points."""
        key = driver.name, most
        if key not in self._made:
            self._made[key] = self._scanned(driver, most)
        return self._made[key]

    def _scanned(self, driver: Driver, most: int | None) -> list[Scanned]:
        x = self.field.x[driver.name]
        each = [(shape, grid(shape, driver, x)) for shape in shapes_of(driver, x)]
        each = [(shape, _some(points, most)) for shape, points in each if len(points)]
        out = []
        for count in sorted({len(shape.coefficients) for shape, _ in each}):
            own = [one for one in each if len(one[0].coefficients) == count]
            out.append(Scanned.of(driver, x, *zip(*own, strict=True)))
        return out


def _some(points: Array, most: int | None) -> Array:
    """At most so many points of a grid, evenly in all its directions: by the golden section."""
    if most is None or len(points) <= most:
        return points
    places = np.arange(most) * (0.5 * (np.sqrt(5.0) - 1.0)) % 1.0
    return points[np.unique((places * len(points)).astype(int))]


class Rough(NamedTuple):
    """A shape that no smooth curve shows, at a carrier, with the squared residual it explains."""

    bearer: Bearer
    driver: Driver
    word: str  # of the shape
    places: tuple[float, ...]
    explained: float


def rough_grids(field: Field) -> list[Scanned]:
    """Quick sines of readings and of time, and loops of hysteresis."""
    grids = list[tuple[Driver, Shape, Array]]()
    for driver in field.drivers:
        x = field.x[driver.name]
        if driver.nature == "linear" or driver.name == "time":
            grids.append((driver, SHAPES["sine"], 1.0 / _quick_frequencies(driver, x)[:, None]))
        for word in LOOPS if driver.name not in ON_BALL else ():
            if word in WORDS[driver.nature]:
                grids.append((driver, SHAPES[word], grid(SHAPES[word], driver, x)))
    return [Scanned.of(d, field.x[d.name], [s], [points]) for d, s, points in grids if len(points)]


def rough_shapes(space: Space, field: Field, grids: Sequence[Scanned], each: int) -> list[Rough]:
    """The best quick sines, and the best loops, of every variable a few.

    What they explain is approximate: the model imitates little of a quick wave or of a loop. Where
    a run drifts, loops of temperatures explain more so than a loop of Z with 291 to gain, and
    filled the list.
    """
    C = np.concatenate([b.C[:, i : i + 1] for b in field.bearers for i in range(b.C.shape[1])], 1)
    C = C * space.used[:, None]
    size = np.sqrt((C**2).mean(axis=0)) + SMALLEST_COLUMN  # squares in single precision underflow
    C = C / size
    owner = [b for b in field.bearers for _ in range(b.C.shape[1])]
    share = max(1.0 - space.basis.shape[1] / space.count, 0.1)
    R, S = (A.T.astype(np.float32) for A in (C * space.r[:, None], C**2))
    found: dict[bool, list[Rough]] = {True: [], False: []}
    for driver, (shape,), (points,), columns in grids:
        along = sum((R @ column) ** 2 for column in columns)
        power = along / (share * (S @ (columns**2).mean(axis=0)) + MIN_OWN)
        largest, place = power.max(axis=1), np.argmax(power, axis=1)
        found[shape.word in LOOPS] += [
            Rough(
                bearer=owner[i],
                driver=driver,
                word=shape.word,
                places=tuple(points[place[i]].tolist()),
                explained=float(largest[i]),
            )
            for i in np.argsort(-largest, kind="stable")[:PER_DRIVER]
        ]
    return [r for kind in found.values() for r in sorted(kind, key=lambda r: -r.explained)[:each]]


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


def modulations(space: Space, field: Field, C: Array, first: Driver) -> list[tuple[Driver, float]]:
    """Variables on which the size of a law depends, by what a curve gains over none, best first.

    Args:
        C: Columns of a carrier times a shape, (N, k).
        first: Variable of that shape.
    """
    constant = Waves((), np.ones((len(C), 1)), np.ones((1, 1)), (0.0,))
    plain = evidence_of(space, C, constant)[0]
    out = []
    for driver in field.drivers:
        if driver != first and not _is_sensible(first, driver):
            continue
        waves = waves_of(field, driver)
        if waves.lengths[0] == 0.0:
            B = np.hstack([constant.B, waves.B])
            waves = waves._replace(B=B, weights=np.ones((1, 2)))
        out.append((driver, evidence_of(space, C, waves)[0] - plain))
    return sorted(out, key=lambda one: -one[1])
