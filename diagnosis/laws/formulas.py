"""From a curve to a formula: every shape of the grammar at every point of its grid, then refined.

A shape of one variable, times the columns of a carrier, is scanned over its grid as one product of
matrices. A product of two shapes is found by turns: with one factor in place, the carrier times
that factor is a carrier like any other.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.laws.screening import Field, Grids, Single
from matstd.diagnosis.laws.space import MIN_OWN, Space
from matstd.diagnosis.residual import Bearer
from matstd.twin.frames import Array
from matstd.twin.laws import SHAPES, Driver, Factor, Law

SMALLEST_SQUARE = 1e-30  # of a column without numbers

COLUMNS_AT_A_TIME = 2000  # columns that are projected at a time

COARSE, FULL = 50, 5
"""Points of a grid that are tried beside every simple shape, and the best pairs whose second shape
is then scanned in full: a third of the time of full scans, and the same laws."""

MOST_OF_ONE_SHAPE = 3
"""Products of one variable's shape that are kept: what looks like a line over a temperature (a
play, a kink, a settling over time) would crowd out other shapes of the other variable."""

ROUNDED = {"window": "plateau", "ramp": "saturation"}
"""Shapes with a rounded one beside them, whose grid is too coarse for a narrow one: a worn zone of
50 mm was taken for a window, and a second run left with 0.65 um instead of 0.58."""

MOST_STEPS = 400  # most evaluations of a refinement

MAX_OUTSIDE = 0.25
"""Share of the range of a variable by which a place may lie outside it: the flank of a bump whose
top is farther away says little of that top."""

SIMPLE_HARMONICS = (1, 2, 3, 4)


@dataclass(frozen=True, eq=False)
class Candidate:
    """A law at some parameters, and what it explains."""

    bearer: Bearer  # its carrier, with columns
    law: Law
    explained: float  # squared residual
    parameters: int  # number of amplitudes and of parameters that the run determines
    score: float  # log evidence, parameters charged


class Part(NamedTuple):
    """One factor at a point of its grid."""

    factor: Factor
    places: tuple[float, ...]


_FARTHEST = 1e100  # of a formula in a step of the search: the square of a larger value overflows


def part_of(law: Law, which: int) -> Part:
    """One factor of a law with its places."""
    factor, own = law.parts[which]
    return Part(factor, law.places[own])


def columns_of(field: Field, space: Space, parts: Sequence[Part]) -> Array:
    """Columns of a product of shapes at all touches, (N, coefficients)."""
    out = [np.ones(space.count)]
    for part in parts:
        found = part.factor.shape.values(field.x[part.factor.driver.name], *part.places)
        out = [a * b for a in out for b in found]
    return np.stack(out, axis=1)


def spread(C: Array, S: Array) -> Array:
    """Carrier columns (N, k) times shape columns (N, m), (N, k m)."""
    return np.asarray((C[:, :, None] * S[:, None, :]).reshape(len(C), -1))


def scan(
    space: Space, grids: Grids, C: Array, driver: Driver, most: int | None = None
) -> list[tuple[Part, float, int]]:
    """The best point of every shape of a variable, for a carrier.

    Args:
        C: Columns of the carrier, or of the carrier times a first factor, (N, k).
        most: Points of every shape that are tried; None for all.

    Returns:
        Shape and place, squared residual explained, number of its parameters.
    """
    C = C * space.used[:, None]
    C = C / (float(np.sqrt((C**2).mean())) or 1.0)
    k = C.shape[1]
    carrier = _Carrier(
        basis=_single([space.basis * C[:, [i]] for i in range(k)]),
        sides=_single([C * space.r[:, None]]),
        squares=_single([C[:, [i]] * C for i in range(k)]),
    )
    out = []
    for _, shapes, grid_of_each, columns in grids.of(driver, most):
        blocks = range(0, columns.shape[2], COLUMNS_AT_A_TIME)
        each = [carrier.explained(columns[:, :, at : at + COLUMNS_AT_A_TIME]) for at in blocks]
        ends = np.cumsum([len(points) for points in grid_of_each])
        found = np.split(np.concatenate(each), ends[:-1])
        for shape, points, explained in zip(shapes, grid_of_each, found, strict=True):
            g = int(np.argmax(explained))
            part = Part(Factor(shape, driver), tuple(float(v) for v in points[g]))
            count = k * len(shape.coefficients) + len(shape.free)
            out.append((part, float(explained[g]), count))
    return out


def _single(columns: Sequence[Array]) -> Single:
    """Columns (N, ...) beside one another, as rows in single precision."""
    return np.ascontiguousarray(np.concatenate(columns, axis=1).T, dtype=np.float32)


class _Carrier(NamedTuple):
    """A carrier of k columns, of about one: their squares must not underflow."""

    basis: Single  # what the model can imitate, times every column, (k P, N)
    sides: Single  # columns times the residual, (k, N)
    squares: Single  # columns times one another, (k k, N)

    def explained(self, S: Single) -> Array:
        """Squared residual that it explains times shapes (coefficients, N, G), (G,)."""
        (m, _, points), k = S.shape, len(self.sides)
        U = [(self.basis @ s).reshape(k, -1, points) for s in S]
        b = np.stack([self.sides @ s for s in S], axis=1).reshape(k * m, points)
        G = np.empty((k * m, k * m, points))
        raw = np.empty((k * m, points))
        for j in range(m):
            for h in range(j + 1):
                products = (self.squares @ (S[j] * S[h])).reshape(k, k, points)
                for i in range(k):
                    for g in range(k):
                        own = products[i, g] - np.einsum("pg,pg->g", U[j][i], U[h][g])
                        G[i * m + j, g * m + h] = G[g * m + h, i * m + j] = own
                    raw[i * m + j] = products[i, i]
        size = np.sqrt(np.maximum(raw, SMALLEST_SQUARE))
        G, b = G / (size[:, None] * size), b / size
        if k * m == 1:
            is_own = G[0, 0] > MIN_OWN
            return np.where(is_own, b[0] ** 2 / np.where(is_own, G[0, 0], 1.0), 0.0)
        values, vectors = np.linalg.eigh(G.transpose(2, 0, 1))
        along = np.einsum("gab,ag->gb", vectors, b) ** 2
        is_own = values > MIN_OWN
        return np.asarray(np.where(is_own, along / np.where(is_own, values, 1.0), 0.0).sum(axis=1))


def candidate(
    space: Space, field: Field, bearer: Bearer, parts: Sequence[Part], extra: int = 0
) -> Candidate:
    """A law with what it explains, exactly."""
    S = columns_of(field, space, parts)
    explained = space.explained(spread(bearer.C, S))
    law = Law(
        bearer.carrier,
        tuple(p.factor for p in parts),
        tuple(v for p in parts for v in p.places),
    )
    count = len(law.parameters) + len(law.free) + extra
    score = float(space.gained(np.array(explained))) - space.charge(count)
    return Candidate(bearer=bearer, law=law, explained=explained, parameters=count, score=score)


def single_formulas(
    space: Space, grids: Grids, bearer: Bearer, driver: Driver, most: int
) -> list[Candidate]:
    """Formulas of one variable at one carrier, the best first."""
    ranked = sorted(
        scan(space, grids, bearer.C, driver),
        key=lambda one: space.charge(one[2]) - float(space.gained(np.array(one[1]))),
    )
    parts = [part for part, _, _ in ranked[:most]]
    parts += [_rounded(part) for part in parts if part.factor.shape.word in ROUNDED]
    return [candidate(space, grids.field, bearer, [part]) for part in parts]


def _rounded(part: Part) -> Part:
    """A plateau of the width of a window, or a saturation of that of a ramp."""
    first, last = part.places
    width = 0.5 * (last - first)
    word = ROUNDED[part.factor.shape.word]
    shift = 0.5 * width
    places = (first + shift, last - shift, width) if word == "plateau" else (first + width, width)
    return Part(Factor(SHAPES[word], part.factor.driver), places)


def sharpened(part: Part) -> Part:
    """The window of a plateau, or the ramp of a saturation; any other part as it is."""
    word = next((w for w, r in ROUNDED.items() if r == part.factor.shape.word), None)
    if word is None:
        return part
    *middle, width = part.places
    shift = 0.5 * width if word == "window" else width
    places = (middle[0] - shift, middle[-1] + shift)
    return Part(Factor(SHAPES[word], part.factor.driver), places)


def product_formulas(
    space: Space, grids: Grids, bearer: Bearer, drivers: Sequence[Driver], most: int
) -> list[Candidate]:
    """Products of two shapes at one carrier, the best first.

    Either variable begins with its simple shapes, beside which a part of the grid of the other is
    scanned; from the best pairs on, each factor is scanned anew in full with the other in place.
    """
    orders = {tuple(drivers), tuple(drivers[::-1])}
    found = [
        product
        for first, second in sorted(orders, key=lambda o: [d.name for d in o])
        for part in _simple(grids, first)
        for product in _products(space, grids, bearer, part, second, COARSE)
    ]
    for which, best in ((1, FULL), (0, FULL // 2)):  # the factor that is scanned in full
        found.sort(key=lambda p: p.cost(space))
        pairs = [(one.parts[1 - which], one.parts[which].factor.driver) for one in found[:best]]
        found += [
            product if which == 1 else product.turned
            for part, driver in dict.fromkeys(pairs)
            for product in _products(space, grids, bearer, part, driver)
        ]
    ranked = sorted(found, key=lambda p: p.cost(space))
    out: list[Candidate] = []
    met: Counter[tuple[int, str]] = Counter()
    for parts in (product.parts for product in ranked):
        ordered = parts if parts[0].factor.driver == drivers[0] else parts[::-1]
        words = [(i, part.factor.shape.word) for i, part in enumerate(ordered)]
        one = candidate(space, grids.field, bearer, ordered)
        if max(met[word] for word in words) < MOST_OF_ONE_SHAPE and one.law.name not in (
            c.law.name for c in out
        ):
            met.update(words)
            out.append(one)
        if len(out) == most:
            break
    return out


class _Product(NamedTuple):
    """Two factors with what they explain and their number of parameters."""

    parts: tuple[Part, Part]
    explained: float
    parameters: int

    @property
    def turned(self) -> "_Product":
        """With its factors in the other order."""
        return self._replace(parts=self.parts[::-1])

    def cost(self, space: Space) -> float:
        """Log evidence that it lacks."""
        return space.charge(self.parameters) - float(space.gained(np.array(self.explained)))


def _products(
    space: Space,
    grids: Grids,
    bearer: Bearer,
    kept: Part,
    driver: Driver,
    most: int | None = None,
) -> Iterator[_Product]:
    """One factor in place, times every shape of a variable at its best point."""
    C = spread(bearer.C, columns_of(grids.field, space, [kept]))
    free = len(kept.factor.shape.free)
    for other, explained, count in scan(space, grids, C, driver, most):
        yield _Product((kept, other), explained, count + free)


def _simple(grids: Grids, driver: Driver) -> list[Part]:
    """Shapes of a variable with which a product is begun."""
    words: list[tuple[str, tuple[float, ...]]]
    x = grids.field.x[driver.name]
    zero, unit = driver.zero, driver.scale
    if driver.nature == "sign":
        words = [("sign", ())]
    elif driver.nature == "rotary":
        words = [("harmonic", (float(k),)) for k in SIMPLE_HARMONICS]
        words += [("half-wave", (p,)) for p in np.radians([0.0, 90.0, 180.0, 270.0])]
        words += [("lin", (zero, unit))]
        if np.ptp(x) > np.pi:
            words += [("harmonic", (float(k),)) for k in (5, 6, 7, 8, 9, 10, 12)]
    else:
        low, high = float(x.min()), float(x.max())
        words = [("lin", (zero, unit)), ("quad", (zero, unit))]
        words += [("kink", (p, unit)) for p in np.quantile(x, (0.3, 0.6))]
        words += [("step", (p,)) for p in np.quantile(x, (0.25, 0.5, 0.75))]
        words += [("bump", (p, 0.25 * (high - low))) for p in np.quantile(x, (0.2, 0.4, 0.6, 0.8))]
        if driver.nature == "time":
            words += [("exp", (0.0, w * (high - low))) for w in (0.1, 0.4)]
    return [Part(Factor(SHAPES[word], driver), places) for word, places in words]


def refined(space: Space, field: Field, start: Candidate) -> Candidate:
    """The law with its parameters where they explain most, between and beyond points of the grid.

    Nelder and Mead's simplex, since edges make the sum of squares jump; amplitudes follow from the
    parameters in closed form.
    """
    from scipy.optimize import minimize

    law = start.law
    if not law.free or law.is_curve_alone:
        return start
    values, free = np.array(law.places), np.array(law.free)
    inner = law.inner(space.touches)
    steps = np.array([float(inner[i].grid[-1] - inner[i].grid[-2]) for i in free])
    ranges = [
        (float(field.x[f.driver.name].min()), float(field.x[f.driver.name].max()))
        for f in law.factors
        for _ in f.shape.places
    ]

    def parts_at(at: Array) -> list[Part]:
        moved = values.copy()
        moved[free] = values[free] + at * steps
        return [Part(factor, tuple(moved[own].tolist())) for factor, own in law.parts]

    def left(at: Array) -> float:
        parts = parts_at(at)
        if not _is_allowed(law, [v for p in parts for v in p.places], ranges):
            return space.square
        with np.errstate(invalid="ignore"):  # a logarithm with a negative width
            S = columns_of(field, space, parts)
        if not np.all(np.abs(S) < _FARTHEST):  # nor NaN
            return space.square
        return space.square - space.explained(spread(start.bearer.C, S))

    best = np.zeros(len(free))
    for size in (1.0, 0.2):
        simplex = np.vstack([best, best + size * np.eye(len(free))])
        options = {
            "initial_simplex": simplex,
            "maxfev": MOST_STEPS // 2 * max(len(free) - 1, 1),
            "xatol": 1e-3,
            "fatol": 1e-3,
        }
        found = minimize(left, best, method="Nelder-Mead", options=options)
        if found.fun <= left(best):
            best = found.x
    return candidate(space, field, start.bearer, parts_at(best))


def _is_allowed(law: Law, places: Sequence[float], ranges: Sequence[tuple[float, float]]) -> bool:
    """Whether places are near the touches, widths are widths, and edges in their order."""
    named = dict(zip(law.place_names, places, strict=True))
    spans = [high - low for low, high in ranges]
    for (name, value), (low, high), span in zip(named.items(), ranges, spans, strict=True):
        base = name.split("-")[0]
        outside = MAX_OUTSIDE * span
        if base in ("x0", "x1", "x2") and not low - outside < value < high + outside:
            return False
        if base in ("w", "wa", "wb") and abs(value) < 2e-3 * span:
            return False
        if base in ("w", "wa", "wb", "period") and abs(value) > 30.0 * span:
            return False
        if base == "p" and not 0.1 < value < 8.0:
            return False
    for end in ("", "-2"):
        if f"x1{end}" in named and f"x2{end}" in named:
            gap = named[f"x2{end}"] - named[f"x1{end}"]
            if gap < 1e-3 * max(spans):
                return False
    return not ("wa" in named and named["wb"] < 1.2 * named["wa"])
