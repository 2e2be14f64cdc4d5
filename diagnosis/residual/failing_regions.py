"""Regions where a model fails, by what carries the error: boxes of a few conditions.

A user who reads "EBY is off by 14 µrad where 20 mm < Y < 120 mm" knows where to look. Every
component error of every axis (and the standard, and the probe) is supposed wrong by a constant
within a box of readings. Its column is the Jacobian of the touch times one inside the box, freed of
what the fitted model imitates, so that an error whose deviation changes sign with the normal, or
which a free set-up takes up in part, is seen as well as any other. The box with the most evidence
is put into the model, and the next is looked for. What is reported of a box is how far the error is
off there beside the fitted model alone, whatever other boxes were found: the mean of its touches.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.evidence import ResidualSpace
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import f_probability, f_tail
from matstd.diagnosis.residual.boxes import (
    MAX_SHARE,
    MIN_TOUCHES_OF_REGION,
    Bounded,
    Box,
    Condition,
    best_box,
    bounded,
    rows_in,
    squares,
    summed,
)
from matstd.diagnosis.residual.carriers import Bearer, bearers
from matstd.diagnosis.residual.partial_residuals import MIN_VIEW
from matstd.diagnosis.residual.patterns import FULL_BELOW
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.laws import carrier_of
from matstd.twin.numbers import rms

MIN_OWN = 0.02
"""Share of the square of a region's column that the model must leave: of a region as wide as the
travel the model imitates nearly all, and the rest rests on its errors of second order."""

MOST_REGIONS = 6  # regions that are looked for

MIN_SIZE = 3.0
"""Size over its uncertainty from which a region is reported. One that stands out only against those
found before it, as the end of a drift does, may be off by nothing."""

NO_LEVER = 1e-9  # mm per mm or rad: the rounding of an arm of a metre is a thousandth of this
PARTS = ("shift-x", "shift-y", "shift-z", "bias")
"""Carriers beside the components of the axes: the standard, and the reading along the normal."""


class Wrong(NamedTuple):
    """What is wrong in a region."""

    carrier: str  # a component error, or one of `PARTS`
    alike: tuple[str, ...]  # others that the touches of the region do not distinguish from it
    # by how much it is wrong beside the fitted model, mm or rad: mean of residual over lever c,
    # weighted by (c/u)^2, of all touches in the region
    size: float
    u: float  # standard uncertainty of the size, from the noise that the regions so far leave
    is_angular: bool  # whether it is an angle


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Touches that a model predicts wrongly: one error is off there, or they scatter more."""

    # all of them hold in it; bounds in the unit of the column, one of each side for a column
    conditions: tuple[Condition, ...]
    rows: Mask  # touches in it, (N,)
    wrong: Wrong | None  # the error that is off; None where touches scatter more than others
    mean: float  # mean residual of the touches in it, along the normal, mm
    u: float  # standard uncertainty of the mean, from the noise, mm
    rms: float  # root mean square residual of the same, mm
    # probability of such an error, or of a scatter so much larger than that of the other touches,
    # by chance, for all regions and carriers that were tried
    p_value: float


def regions(fit: Fit, cured: Fit | None = None) -> tuple[Region, ...]:
    """Regions of a run in which one error is not what the model has, the most evident first.

    Each is looked for beside those before it; the size of each is that beside the fitted model, so
    that regions may share touches. Where there is none, regions where the residual scatters more
    than elsewhere.

    Args:
        cured: The same with the effects that it lacked. What they explain then draws the regions:
            so few numbers are known not to be chance.

    Reference:
        Friedman and Fisher, Bump hunting in high-dimensional data, Statistics and Computing 9
        (1999) 123-143.
    """
    space = ResidualSpace.of(fit)
    if len(space.u) > FULL_BELOW:
        space = space.thinned(FULL_BELOW)
    known = tuple(bounded(space))
    drawn = None if cured is None else _explained(space, fit, cured)
    return tuple(_wrong(fit, space, known, drawn)) or tuple(_loud(fit, space, known))


def _explained(space: ResidualSpace, fit: Fit, cured: Fit) -> Array:
    """What the missing effects explain of a residual, (n + P,), in units of the noise beside them.

    Free of the model as a residual is.
    """
    part = (fit.residual - cured.residual)[space.used][:, None] / space.u[:, None]
    if space.whitener is not None:
        part = space.whitener((fit.residual - cured.residual)[:, None])
    return space.project(part)[:, 0] * (fit.noise.factor / cured.noise.factor)


@dataclass(frozen=True, eq=False)
class _Constant:
    """One carrier, off by a constant in a region."""

    space: ResidualSpace
    column: Array  # of the carrier, all touches, (N,), mm per mm or rad
    drawing: Array | None  # what draws the region, (n + P,); None for the residual

    def gains(self, rows: Mask, variable: Bounded) -> Array:
        """As of `Measure`."""
        space = self.space
        enough, own, whole, along = self._sums(rows, variable)
        sound = (
            (enough >= MIN_TOUCHES_OF_REGION)
            & (enough <= MAX_SHARE * len(space.u))
            & (own > MIN_OWN * whole)
        )
        sound &= variable.is_offered
        drop = np.where(sound, along**2 / np.where(sound, own, 1.0), 0.0)
        return _gain(space, drop) if self.drawing is None else 0.5 * drop

    def _sums(self, rows: Mask, variable: Bounded) -> tuple[Array, Array, Array, Array]:
        """Touches in bins i to k; the column's square beside the model, square, and drawing there.

        Arrays (B, B). In white noise a touch counts in its own bin alone: sums of rows, and no
        product of matrices with a column a bin, which was a quarter of the time of a search.
        """
        space, size = self.space, variable.size
        inside = variable.ordered[(rows & space.used)[variable.ordered]]
        bins = variable.bins[inside]
        count = np.bincount(bins, minlength=size)
        if space.whitener is not None:
            is_in = variable.bins[:, None] == np.arange(size)
            C = _white(space, (rows * self.column)[:, None] * is_in)
            along, beside = C.T @ self._drawn[: len(C)], C.T @ space.Q[: len(C)]
            whole = squares(C.T)
            return summed(count), whole - squares(beside), whole, summed(along)
        sums = np.zeros((size, self._products.shape[1]))
        if len(inside):
            there = count > 0
            first = (np.cumsum(count) - count)[there]
            products = self._products.take(self._place[inside], axis=0)
            sums[there] = np.add.reduceat(products, first, axis=0)
        enough, whole, along = summed(np.column_stack([count, sums[:, :2]]))
        return enough, whole - squares(sums[:, 2:]), whole, along

    @cached_property
    def _place(self) -> IntArray:
        """Row of `_products` of every touch in use, (N,)."""
        return np.cumsum(self.space.used) - 1

    @property
    def _drawn(self) -> Array:
        return self.space.residual if self.drawing is None else self.drawing

    @cached_property
    def _products(self) -> Array:
        """Of the column in white noise with itself, the drawing and the model, (n, 2 + P)."""
        c = _white(self.space, self.column[:, None])
        n = len(c)
        return c * np.column_stack([c, self._drawn[:n], self.space.Q[:n]])


def _white(space: ResidualSpace, columns: Array) -> Array:
    """Columns of all touches (N, K) over the noise, rows in use, (n, K)."""
    if space.whitener is not None:
        return space.whitener(columns)
    return np.asarray(columns[space.used] / space.u[:, None])


def _gain(space: ResidualSpace, drop: Array) -> Array:
    """Log likelihood gained by a fall of the squared residual, the noise free."""
    r = space.residual
    whole = float(r @ r)
    return -0.5 * space.dof * np.log(np.maximum(1.0 - drop / max(whole, 1e-300), 1e-12))


def _wrong(
    fit: Fit, space: ResidualSpace, known: Sequence[Bounded], drawn: Array | None
) -> Iterator[Region]:
    """Regions in which an error is off by a constant, each looked for beside those before it."""
    whole = ResidualSpace.of(fit)
    others = PARTS if space.touches.instrument.has_standard else PARTS[-1:]
    offered, columns = [], []
    for bearer in bearers(space.touches, lambda C: _white(space, C), others):
        column = bearer.carrier.columns(space.touches)[:, 0]
        # what turns the ball on its spot has a column of rounding alone
        if np.abs(column).max() > NO_LEVER:
            offered.append(bearer)
            columns.append(column)
    for _ in range(MOST_REGIONS):
        measures = [_Constant(space, column, drawn) for column in columns]
        found = best_box(measures, known, len(fit.used))
        if found is None:
            return
        rows = rows_in(known, found.box, len(fit.used))
        inside = [_white(space, (rows * c)[:, None]) for c in columns]
        c = space.project(inside[found.measure])[:, 0]
        own, along = float(c @ c), float(c @ space.residual)
        left = float(space.residual @ space.residual)
        drop = along**2 / own
        p = float(f_probability(drop, 1.0, left - drop, space.dof - 1.0))
        p = min(1.0, p * (found.tried if drawn is None else MOST_REGIONS))
        if p >= POLICY.false_alarm or drop < POLICY.material_share * left:
            return
        bearer = offered[found.measure]
        lever = (rows * columns[found.measure])[fit.used] / fit.u[fit.used]
        size = float(lever @ (fit.residual / fit.u)[fit.used] / (lever @ lever))
        seen = np.linalg.norm(_white(whole, (rows * columns[found.measure])[:, None]))
        wrong = Wrong(
            carrier=bearer.carrier.name,
            alike=_alike(space, offered, inside, found.measure),
            size=size,
            u=float(np.sqrt((left - drop) / max(space.dof - 1.0, 1.0)) / seen),
            is_angular=bearer.carrier.is_angular,
        )
        if abs(size) > MIN_SIZE * wrong.u:
            yield _region(fit, known, found.box, wrong, p)
        direction = c / np.sqrt(own)
        if drawn is not None:
            drawn = drawn - direction * (direction @ drawn)
        space = replace(
            space,
            Q=np.column_stack([space.Q, direction]),
            residual=space.residual - direction * (direction @ space.residual),
            dof=space.dof - 1.0,
        )


def _alike(
    space: ResidualSpace, offered: Sequence[Bearer], inside: Sequence[Array], best: int
) -> tuple[str, ...]:
    """Carriers that explain a region as well as the best one, within odds of 100 to 1."""
    drops = []
    for C in inside:
        c = space.project(C)[:, 0]
        own = float(c @ c)
        ok = own > MIN_OWN * float((C**2).sum())
        drops.append(float(c @ space.residual) ** 2 / own if ok else 0.0)
    gains = _gain(space, np.array(drops))
    near = np.flatnonzero(gains > gains[best] - POLICY.log_odds_alike)
    order = sorted(near.tolist(), key=lambda k: (k != best, -gains[k]))
    names = [b.name for k in order for b in (offered[k].carrier, *offered[k].alike)]
    return tuple(names[1:])


class _Scatter(NamedTuple):
    """A larger variance in a region."""

    squares: Array  # of the residual over its own standard deviation, (N,); zero where not in use
    used: Mask  # touches in use, (N,)

    def gains(self, rows: Mask, variable: Bounded) -> Array:
        """As of `Measure`."""
        own, k = variable.bins[rows & self.used], variable.size
        counts = summed(np.bincount(own, minlength=k))
        sums = summed(np.bincount(own, self.squares[rows & self.used], minlength=k))
        count, total = float(self.used.sum()), float(self.squares[self.used].sum())
        others = np.maximum(count - counts, 1.0)
        here = np.maximum(sums / np.maximum(counts, 1.0), 1e-12)
        there = np.maximum((total - sums) / others, 1e-12)
        gained = count * np.log(total / count) - counts * np.log(here) - others * np.log(there)
        enough = np.minimum(counts, count - counts) >= MIN_TOUCHES_OF_REGION
        return np.where((here > there) & enough & variable.is_offered, 0.5 * gained, 0.0)


def _loud(fit: Fit, space: ResidualSpace, known: Sequence[Bounded]) -> Iterator[Region]:
    """Regions in which touches scatter more than elsewhere, each without those before it."""
    own = np.sqrt(np.maximum(1.0 - fit.solution.leverage, 1e-6))
    squares = np.zeros(len(fit.used))
    squares[fit.used] = (fit.residual[fit.used] / own / fit.u[fit.used]) ** 2
    left = fit.used.copy()
    for _ in range(MOST_REGIONS):
        if not squares[left].any():
            return
        found = best_box([_Scatter(squares, left)], known, len(fit.used))
        if found is None:
            return
        rows = rows_in(known, found.box, len(fit.used)) & left
        inside, outside = squares[rows], squares[left & ~rows]
        ratio = float(inside.mean() / max(outside.mean(), 1e-12))
        p = min(1.0, float(f_tail(ratio, len(inside), len(outside))) * found.tried)
        if p >= POLICY.false_alarm:
            return
        yield _region(fit, known, found.box, None, p)
        left &= ~rows


def _region(fit: Fit, known: Sequence[Bounded], box: Box, wrong: Wrong | None, p: float) -> Region:
    """A box as a region."""
    rows = rows_in(known, box, len(fit.used))
    r = fit.residual[rows & fit.used]
    return Region(
        conditions=tuple(c for v in sorted(box) for c in known[v].conditions(*box[v])),
        rows=rows,
        wrong=wrong,
        mean=float(r.mean()),
        u=float(np.sqrt(np.sum(fit.u[rows & fit.used] ** 2)) / len(r)),
        rms=rms(r),
        p_value=p,
    )


def observed_error(fit: Fit, region: Region) -> tuple[IntArray, Array, Array]:
    """What touches say of the error that is off in a region: residual over its lever.

    Returns:
        Rows that see it well enough (M,), the error there (M,), mm or rad, and their weights (M,).
    """
    assert region.wrong is not None
    touches, rows = fit.run.touches, np.flatnonzero(fit.used)
    lever = carrier_of(region.wrong.carrier, touches.chain).columns(touches)[rows, 0]
    seen = np.abs(lever) >= MIN_VIEW * float(np.quantile(np.abs(lever), 0.99))
    rows, lever = rows[seen], lever[seen]
    return rows, fit.residual[rows] / lever, (lever / fit.run.u[rows]) ** 2
