"""Which periods of a long scan are worth a signature: the spectrum of a residual over an axis.

The finer the readings, the more periods they resolve: ten thousand readings over 100 mm distinguish
some 15 000. A signature of each would fill the memory, while the spectrum of the residual,
weighed by what the effect does to every touch, costs one fast Fourier transform and ranks them
alike. Short scans are kept whole.
"""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from matstd.diagnosis.evidence.effect_signatures import Grid, ResidualSpace, tuned_variants
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Tunable, columns, is_tunable

MAX_KEPT = 100  # periods of a long scan that get a signature

MAX_COMPLETE_SCAN = 200_000
"""Touches times periods up to which every period gets a signature, 16 MB; no spectrum that ignores
the model then selects among them."""

BINS_PER_PERIOD = 8.0
"""Bins of a reading in the shortest period: within a bin a sine turns by 45 degrees and keeps 97 %
of its size."""

BACKGROUND_WIDTH = 101  # scanned periods whose median is the background of a line of the spectrum
INFINITE_PERIOD = 1e9  # a period in mm over which a cosine stays 1, as that of no wave a turn does


def period_of(effect: Effect, complement: ResidualSpace) -> Inner | None:
    """The inner parameter of an effect that repeats over the reading of an axis, if that is all."""
    inner = effect.inner(complement.touches) if is_tunable(effect) else ()
    return inner[0] if len(inner) == 1 and inner[0].over else None


def scanned_grids(candidates: Sequence[Effect], complement: ResidualSpace) -> list[Grid]:
    """Candidates at every point of their grids; of long scans of a period at the strongest ones."""
    out = []
    for effect in candidates:
        inner = period_of(effect, complement)
        if inner is None:
            variants = tuple(tuned_variants(effect, complement.touches))
            out.append(Grid(effect, variants, len(variants)))
            continue
        assert is_tunable(effect)
        periods = strongest(effect, inner, complement, complement.residual)
        kept = tuple(effect.tuned(float(p)) for p in periods)
        out.append(Grid(effect, kept, len(inner.grid)))
    return out


def strongest(effect: Tunable, inner: Inner, complement: ResidualSpace, residual: Array) -> Array:
    """Periods (mm) or harmonics at which a residual over an axis is strongest; of few touches all.

    Ascending.

    Half are the strongest of all, half those that stand out most from their neighbours: a slow
    residual hides a small wave in the power that it spreads.

    Args:
        inner: Its period, with the periods to choose from.
        complement: Which touches count, and their uncertainty.
        residual: Whitened, data rows first, (N + ...,).
    """
    grid = np.asarray(inner.grid, dtype=float)
    if len(grid) <= MAX_KEPT or len(grid) * len(complement.u) <= MAX_COMPLETE_SCAN:
        return grid
    q = complement.touches.reading(inner.over)[complement.used]
    # at an endless period the cosine is what the effect does to every touch per unit
    still = effect.tuned(0.0 if inner.is_harmonic else INFINITE_PERIOD)
    C = columns([still], complement.touches)[complement.used]
    weight = C[:, int(np.argmax((C**2).sum(axis=0)))] / complement.u
    power = spectrum(q, weight * residual[: len(q)], inner.frequency(grid))
    background = median_filter(power, BACKGROUND_WIDTH, mode="nearest")
    outstanding = power / np.maximum(background, 1e-12 * power.max() + 1e-300)
    best = {*np.argsort(-power)[: MAX_KEPT // 2], *np.argsort(-outstanding)[: MAX_KEPT // 2]}
    return grid[sorted(int(i) for i in best)]


def spectrum(q: Array, values: Array, frequencies: Array) -> Array:
    """Power ``|sum_i v_i exp(-2 pi i f q_i)|^2`` at some frequencies, (F,), to a few per cent.

    Args:
        q: Readings in any order, (N,), mm or rad.
        values: At every reading, (N,).
        frequencies: Waves per mm or rad, (F,).
    """
    width = 1.0 / (BINS_PER_PERIOD * float(frequencies.max()))
    bins = np.round((q - q.min()) / width).astype(np.int64)
    binned = np.bincount(bins, weights=values)
    # padded fourfold: a line that lies between two bins of the transform keeps 97 % of its size
    size = 1 << int(np.ceil(np.log2(4 * len(binned))))
    power = np.abs(np.fft.rfft(binned, size)) ** 2
    at = np.round(frequencies * width * size).astype(np.int64)
    return np.asarray(power[np.minimum(at, len(power) - 1)])
