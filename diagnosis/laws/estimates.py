"""Numbers of a law with their uncertainties, and what a second run says of it."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.fit import Fit, fit_run
from matstd.diagnosis.laws.formulas import spread
from matstd.diagnosis.laws.learnt import Learning
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.regression import GrossErrors
from matstd.twin.frames import Array
from matstd.twin.laws import CLOCK, Driver, Law, surface_columns
from matstd.twin.model import Model, columns
from matstd.twin.record import Run, with_commanded, without_copies

GRID_OF_WAVE = 41  # points of frequency and of phase of a wave at which its evidence is taken


class Estimate(NamedTuple):
    """One number of a law."""

    name: str
    value: float
    # standard uncertainty; None where it follows from the machine or is no estimate
    u: float | None
    unit: str  # base unit


def amplitudes(learning: Learning, law: Law) -> list[Estimate]:
    """Amplitudes of a law that was learnt."""
    fit = learning.tangent
    place = fit.of_effect(law.name)
    u = np.sqrt(np.diag(fit.covariance)[place])
    theta = learning.after.theta[learning.after.of_effect(law.name)]
    return [
        Estimate(p.name, float(value), float(sd), p.unit)
        for p, value, sd in zip(law.parameters, theta, u, strict=True)
    ]


def places(learning: Learning, law: Law) -> list[Estimate]:
    """Parameters of its shapes.

    Of an edge the uncertainty is that of half the gap between the touches on either side.
    """
    fit, out, waves = learning.tangent, [], _wave_uncertainties(learning, law)
    tangents = {t.index: fit.of_effect(t.name) for t in fit.tangents if t.effect.name == law.name}
    drivers = [f.driver for f in law.factors for _ in f.shape.places]
    jumps = [f.shape.jumps for f in law.factors for _ in f.shape.places]
    for i, (name, value) in enumerate(law.tuning.items()):
        if i in tangents:
            u: float | None = float(np.sqrt(fit.covariance[tangents[i], tangents[i]][0, 0]))
        elif jumps[i] and name.startswith("x"):
            u = _half_gap(drivers[i], fit, value) / np.sqrt(3.0)
        else:
            u = waves.get(i)
        out.append(Estimate(name, value, u, law.units[i]))
    return out


@lru_cache(maxsize=8)  # every page and file states them
def _wave_uncertainties(learning: Learning, law: Law) -> dict[int, float]:
    """Standard uncertainty of period and phase of a wave that jumps, by the number of the place.

    The sum of squares jumps with the touches that the wave passes, so that it has no tangent.
    The evidence is taken on a grid of frequencies and of phases in the middle of the touches, which
    hardly depend on each other, and weighs every point; three grids, each narrower than the last.
    """
    found = [(f, own) for f, own in law.parts if f.shape.jumps and "period" in f.shape.places]
    if not found:
        return {}
    ((factor, own),) = found[:1]
    others = [one.law for one in learning.laws if one.law.name != law.name]
    white = replace(learning.beginning, memory=None)
    space = Space.of(white.fitted(others, gross=learning.after.gross))
    C = space.white(law.carrier.columns(space.touches))
    x = factor.driver.values(space.touches)[space.used]
    middle, (period, phase) = 0.5 * float(x.min() + x.max()), law.places[own]
    # of the grid, 1 / unit of x and rad
    half, centre = np.array([0.5 / max(float(np.ptp(x)), period), 1.0]), np.zeros(2)
    side = np.linspace(-1.0, 1.0, GRID_OF_WAVE)
    steps = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    for heat in (100.0, 10.0, 1.0):
        away = centre + half * steps
        frequency = 1.0 / period + away[:, 0]
        phases = phase + away[:, 1] - 2.0 * np.pi * middle * away[:, 0]
        explained = []
        for at in zip(1.0 / frequency, phases, strict=True):
            moved = law.tuned(*law.places[: own.start], *at, *law.places[own.stop :])
            S = np.stack(moved.amounts(space.touches), axis=1)
            explained.append(space.explained(spread(C, S)))
        gained = space.gained(np.array(explained))
        weight = np.exp((gained - gained.max()) / heat)
        weight /= weight.sum()
        centre = weight @ away
        spacing = half * (side[1] - side[0])
        half = 2.0 * np.maximum(np.sqrt(weight @ (away - centre) ** 2), spacing)
    # about what was found, which may stand anywhere where the sum of squares is the same
    off = (1.0 / frequency - period, phases - phase)
    return {own.start + k: float(np.sqrt(weight @ v**2)) for k, v in enumerate(off)}


def _half_gap(driver: Driver, fit: Fit, value: float) -> float:
    """Half the distance of the touches on either side of a place."""
    x = np.sort(driver.values(fit.run.touches)[fit.used])
    i = int(np.clip(np.searchsorted(x, value), 1, len(x) - 1))
    return 0.5 * float(x[i] - x[i - 1])


def partial_residual(learning: Learning, law: Law) -> tuple[Array, Array]:
    """Residual with the law put back, and the law itself, at every touch, (N,) each, mm."""
    fit = learning.after
    own = columns([law], fit.run.touches) @ fit.theta[fit.of_effect(law.name)]
    return np.asarray(fit.residual + own), np.asarray(own)


def curve_of(learning: Learning, law: Law, driver: Driver, x: Array) -> tuple[Array, Array]:
    """A law over one of its variables, in units of the carrier, with its uncertainty.

    A shape of another variable is held where it is largest. The uncertainty is that of amplitudes
    and parameters together, by differences; of a curve without a formula that of its form beside a
    parabola, which set-ups and geometry take up.

    Args:
        x: Values of the variable, (M,), base unit.

    Returns:
        Values and standard uncertainty, (M,) each, mm or rad.
    """
    fit = learning.tangent
    theta = learning.after.theta[learning.after.of_effect(law.name)]
    tangents = [t for t in fit.tangents if t.effect.name == law.name]
    rows = np.concatenate(
        [np.r_[fit.of_effect(name)] for name in (law.name, *(t.name for t in tangents))]
    )
    covariance = fit.covariance[np.ix_(rows, rows)]
    held = _held(learning, law, driver)
    S = _values(law, driver, x, law.places, held)
    weights = theta.reshape(law.carrier.count, -1)
    way = int(np.argmax(np.abs(weights).sum(axis=1)))
    pick = np.zeros((law.carrier.count, S.shape[1]))
    pick[way] = 1.0
    wide = (S[:, None, :] * pick[None]).reshape(len(x), -1)
    slope = [wide]
    for t in tangents:
        there = np.array(law.places) + t.step * np.eye(len(law.places))[t.index] * [[1.0], [-1.0]]
        up, down = (_values(law, driver, x, tuple(at), held) @ weights[way] for at in there)
        slope.append(((up - down) / (2.0 * t.step))[:, None])
    A = np.hstack(slope)
    if law.is_curve_alone:
        seen = driver.values(fit.run.touches)[fit.used]
        inside = (x >= seen.min()) & (x <= seen.max())
        parabola = np.vander((x - seen.mean()) / float(np.ptp(seen)), 3)
        A = A - parabola @ np.linalg.lstsq(parabola[inside], A[inside], rcond=None)[0]
    return wide @ theta, np.sqrt(np.maximum(np.einsum("np,pk,nk->n", A, covariance, A), 0.0))


def surface_of(learning: Learning, law: Law, x: Array, y: Array) -> tuple[Array, Array]:
    """A smooth surface over its two variables, in units of the carrier, with its uncertainty.

    The uncertainty is that of its form beside a surface of second degree through the touches, which
    set-ups and geometry take up.

    Args:
        x: Values of the first variable, (M,), base unit.
        y: Of the second one, (M,).

    Returns:
        Values and standard uncertainty, (M,) each, mm or rad.
    """
    fit = learning.tangent
    place = fit.of_effect(law.name)
    seen = [driver.values(fit.run.touches)[fit.used] for driver in law.drivers]

    def plain(*at: Array) -> Array:
        u, v = ((a - s.mean()) / float(np.ptp(s)) for a, s in zip(at, seen, strict=True))
        return np.stack([np.ones(len(u)), u, v, u * u, u * v, v * v], axis=1)

    A, there = (np.stack(surface_columns(*at, *law.places), axis=1) for at in ((x, y), seen))
    form = A - plain(x, y) @ np.linalg.lstsq(plain(*seen), there, rcond=None)[0]
    variance = np.einsum("np,pk,nk->n", form, fit.covariance[place, place], form)
    theta = learning.after.theta[learning.after.of_effect(law.name)]
    return A @ theta, np.sqrt(np.maximum(variance, 0.0))


def _held(learning: Learning, law: Law, driver: Driver) -> Array:
    """Columns of the shape of another variable where it acts most, (coefficients,); one without."""
    held = np.ones(1)
    for factor, own in law.parts:
        if factor.driver != driver:
            x = factor.driver.values(learning.after.run.touches)
            S = np.stack(factor.shape.values(x, *law.places[own]), axis=1)
            held = S[int(np.argmax(np.abs(S).sum(axis=1)))]
    return held


def _values(law: Law, driver: Driver, x: Array, at: tuple[float, ...], held: Array) -> Array:
    """Columns of a law over one variable, the shape of another one held, (M, coefficients)."""
    out = np.ones((len(x), 1))
    for factor, own in law.parts:
        S = held[None]
        if factor.driver == driver:
            S = np.stack(factor.shape.values(x, *at[own]), axis=1)
        out = (out[:, :, None] * S[:, None, :]).reshape(len(x), -1)
    return out


@dataclass(frozen=True, eq=False)
class SecondRun:
    """Another run of the machine, whose set-ups and ordinary model are fitted anew."""

    touches: int
    without: float  # root mean square of what the model leaves, per degree of freedom, mm
    learnt: float  # the same with the laws that hold for every run taken off as they were learnt
    # with those besides that belong to the first run, as if what drives them had kept its times;
    # None where there are none
    clocked: float | None = None
    is_clock: bool = True  # whether one of those is a law of the time
    gross: tuple[int, int] = (0, 0)  # touches left out as gross errors, without and with the laws

    @property
    def is_better(self) -> bool:
        """Whether the laws predict it better than none."""
        return self.learnt < self.without

    @property
    def is_clock_kept(self) -> bool:
        """Whether it repeats, at the same times, what seemed to belong to the first run alone."""
        return self.clocked is not None and self.clocked < REPEATED * self.learnt


REPEATED = 0.95
"""Least fall of the error by which a second run repeats a law of the time: another phase makes the
error larger, and none makes it a little smaller."""


def fit_beside(
    known: Array | float, run: Run, model: Model, gross: GrossErrors | None = None
) -> Fit:
    """A model fitted anew beside known deviations, mm; raises NotEnoughData."""
    return fit_run(replace(run, deviation=run.deviation - known), model, gross=gross)


def error_left(fit: Fit) -> float:
    """Root mean square that a fit leaves, per degree of freedom, mm."""
    return float(np.median(fit.run.u)) * fit.noise.chi2_ratio**0.5


def second_run(learning: Learning, run: Run) -> SecondRun:
    """How well the laws predict another run; raises NotEnoughData."""
    run = with_commanded(without_copies(run))

    def beside(known: Array | float, gross: GrossErrors | None = None) -> Fit:
        return fit_beside(known, run, learning.before.model, gross)

    without, learnt, clocked = beside(0.0), beside(learning.predicted(run)), None
    of_run = [one.law for one in learning.laws if not one.travels]
    if of_run:
        clocked = error_left(beside(learning.predicted(run, is_clock_kept=True), learnt.gross))
    return SecondRun(
        touches=len(run),
        without=error_left(without),
        learnt=error_left(learnt),
        clocked=clocked,
        is_clock=any(driver == CLOCK for law in of_run for driver in law.drivers),
        gross=(int(without.gross.rows.sum()), int(learnt.gross.rows.sum())),
    )
