"""Waves in time: does a residual repeat with any period?"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.evidence import EffectSet
from matstd.diagnosis.regression import f_probability
from matstd.diagnosis.residual.patterns import directions
from matstd.twin.frames import Array, IntArray
from matstd.twin.record import Touches

MIN_PERIOD_TOUCHES = 4.0  # shortest period, in mean distances of touches

MIN_PERIOD_STEPS = 2.0
"""Shortest period in usual steps between times: a faster wave looks like a slower one."""

MIN_TURNS = 0.5  # lowest frequency, in turns over the run: what is slower is no wave but a drift
OVERSAMPLING = 2.0  # scanned frequencies per resolvable one
MAX_FREQUENCIES = 800  # most scanned frequencies
FREQUENCIES_AT_A_TIME = 64  # frequencies that are tried at a time

REFINEMENT_POINTS = 8
"""Points of the scan around the best frequency, and how many times it is repeated."""
REFINEMENTS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Wave:
    """The best wave of a scan."""

    count: int
    p_value: float  # probability by chance of the best, not corrected for their number
    drop: float
    period: float  # of the best, s
    direction: str
    # whitened sine and cosine, (N, 2), so large that a prior of one leaves them free
    columns: Array


def best_wave(effects: EffectSet, touches: Touches, rows: IntArray) -> Wave:
    """Scan waves in time over every period that the touches can show, in every direction.

    Args:
        rows: Which of the touches in use are looked at, (R,).
    """
    complement = effects.complement
    time = touches.time[complement.used]
    span = float(np.ptp(time))
    if span <= 0.0:
        return Wave(
            count=0,
            p_value=1.0,
            drop=0.0,
            period=np.inf,
            direction="normal",
            columns=np.zeros((len(time), 0)),
        )
    highest = min(len(rows) / (MIN_PERIOD_TOUCHES * span), 1.0 / (MIN_PERIOD_STEPS * _step(time)))
    count = int(min(MAX_FREQUENCIES, max(FREQUENCIES_AT_A_TIME, OVERSAMPLING * highest * span)))
    frequency = np.linspace(MIN_TURNS / span, max(highest, 1.0 / span), count)
    along = directions(touches)
    weights = {name: part[complement.used] / complement.u for name, part in along.items()}
    _, strongest, direction = _scan(effects, time, frequency, weights, rows)
    weight = weights[direction]
    lowest, step = frequency[0], frequency[1] - frequency[0]
    drop, found = _finer(effects, time, strongest, step, lowest, {direction: weight}, rows)
    p = float(f_probability(drop, 2.0, effects.objective - drop, effects.dof - 2.0))
    columns = _seen(effects, _wave(time, np.array([found])) * weight[:, None])
    # far beyond the noise, so that a prior of one leaves both amplitudes free
    scale = 10.0 / max(float(np.abs(columns).max()), 1e-300)
    return Wave(
        count=count * len(along),
        p_value=p,
        drop=drop,
        period=1.0 / found,
        direction=direction,
        columns=columns * scale,
    )


def _step(time: Array) -> float:
    """Usual step between times at which anything was touched, s."""
    return float(np.median(np.diff(np.unique(time))))


def _scan(
    effects: EffectSet, time: Array, frequency: Array, weights: Mapping[str, Array], rows: IntArray
) -> tuple[float, float, str]:
    """Largest fall of the objective by a wave, its frequency, and the direction it acts along."""
    best = (0.0, float(frequency[0]), next(iter(weights)))
    for block in np.array_split(frequency, -(-len(frequency) // FREQUENCIES_AT_A_TIME)):
        seen = _of_rows(effects, time, block, rows)
        for name, weight in weights.items():
            drop = _drops(effects, seen(weight), rows)
            i = int(np.argmax(drop))
            if drop[i] > best[0]:
                best = (float(drop[i]), float(block[i]), name)
    return best


def _of_rows(
    effects: EffectSet, time: Array, frequency: Array, rows: IntArray
) -> Callable[[Array], Array]:
    """Waves at some of the touches by their weights, freed of the noise's memory if it has one."""
    filter_ = effects.complement.whitener
    if filter_ is None:
        here = _wave(time[rows], frequency)
        return lambda weight: here * weight[rows, None]
    every = _wave(time, frequency)
    return lambda weight: filter_.picked(lambda at: every[at] * weight[at, None], rows)


def _seen(effects: EffectSet, F: Array) -> Array:
    """Columns freed of the noise's memory where it has one."""
    filter_ = effects.complement.whitener
    return F if filter_ is None else filter_.filtered(F)


def _finer(
    effects: EffectSet,
    time: Array,
    frequency: float,
    step: float,
    lowest: float,
    weights: Mapping[str, Array],
    rows: IntArray,
) -> tuple[float, float]:
    """The same around the best frequency of the scan, finer and finer."""
    best = (0.0, frequency)
    for _ in range(REFINEMENTS):
        around = best[1] + step * np.linspace(-1.0, 1.0, 2 * REFINEMENT_POINTS + 1)
        best = max(best, _scan(effects, time, around[around >= lowest], weights, rows)[:2])
        step /= REFINEMENT_POINTS
    return best


def _wave(time: Array, frequency: Array) -> Array:
    """Sines, then cosines of some frequencies, (N, 2 K)."""
    angle = 2.0 * np.pi * time[:, None] * frequency
    return np.concatenate([np.sin(angle), np.cos(angle)], axis=1)


def _drops(effects: EffectSet, F: Array, rows: IntArray) -> Array:
    """Fall of the objective by each pair of columns (i, K + i), model and effects removed, (K,)."""
    complement = effects.complement
    B = complement.Q[rows].T @ F
    E = effects.lower_solve(effects.A[rows].T @ F)
    x, y = np.split(F.T @ complement.residual[rows] - E.T @ effects.along, 2)
    halves = [np.split(M, 2, axis=1) for M in (F, B, E)]

    def inner(first: int, second: int) -> Array:
        whole, model, added = (np.einsum("nk,nk->k", h[first], h[second]) for h in halves)
        return np.asarray(whole - model - added)

    a, b, c = inner(0, 0), inner(0, 1), inner(1, 1)
    det = np.maximum(a * c - b * b, 1e-9 * a * c + 1e-300)
    return np.asarray((c * x * x - 2.0 * b * x * y + a * y * y) / det)
