"""Effects that can be switched on and off, each as columns over its inner parameter.

A time constant or a period enters the columns non-linearly. They are computed at a few values of
it; the differences from those at the present value are kept as a few principal columns, so that the
columns at any value are a mix of stored ones. At the present value the mix is exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import continuous_inner
from matstd.diagnosis.reduced.base import Base
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Tunable, is_tunable, with_inner

NODES = 13  # values of an inner parameter at which columns are computed

MAX_PRINCIPAL, FEWER_PRINCIPAL = 5, 4
"""Most principal columns of one effect; of one that was not found. The fifth moves columns by a
thousandth."""

MIN_PRINCIPAL = 1e-3  # share of the first one below which a principal column is left out
MAX_WIDTH = 3  # parameters of an effect above which its inner parameter stays where it is

MAX_MISFIT = 0.02
"""Error of a column between two values, over the change of the columns, up to which the range is
kept; else it is halved about the present value."""

MAX_HALVINGS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Switch:
    """An effect that can be switched."""

    effect: Effect  # at its present tuning
    # standard deviations of its parameters as they are believed in a fit, (K,), base units
    sd: Array
    is_found: bool  # whether it is part of the model that the diagnosis ends with
    alike: tuple[str, ...]  # names of switches that the run cannot distinguish from it
    # stored ones, all rows, over the stated uncertainty and times `sd`, (N, M); the first K are the
    # effect itself
    columns: Array
    inner: Inner | None  # its inner parameter that can be moved; None where there is none
    values: Array  # of it, ascending, (V,), base units; its present one among them
    mixes: Array  # weights of the stored columns in those at the values, (V, K, M)
    # whether its one column is what a model predicts, whose amount no run determines
    is_fixed: bool = False

    @property
    def present(self) -> int:
        """Number of the present value among `values`."""
        own = np.eye(len(self.sd), self.columns.shape[1])
        return int(np.argmin(np.abs(self.mixes - own).sum(axis=(1, 2))))


def switch(
    base: Base,
    effect: Effect,
    sd: Array,
    *,
    is_found: bool,
    alike: Sequence[str] = (),
    is_movable: bool = True,
) -> Switch:
    """An effect with its columns; arguments as of `Switch`.

    Args:
        is_movable: Whether its inner parameter may be moved.
    """
    own = base.columns([effect]) * sd
    inner = continuous_inner(effect, base.fit.run.touches) if is_movable else []
    values, mixes, stored = np.zeros(0), np.eye(len(sd))[None], own
    found: Inner | None = None
    if inner and len(sd) <= MAX_WIDTH and is_tunable(effect):
        most = MAX_PRINCIPAL if is_found else FEWER_PRINCIPAL
        moved = _moved(base, effect, sd, own, *inner[0], most)
        if moved is not None:
            found, (values, mixes, stored) = inner[0][1], moved
    return Switch(
        effect=effect,
        sd=sd,
        is_found=is_found,
        alike=tuple(alike),
        columns=stored,
        inner=found,
        values=values,
        mixes=mixes,
    )


def fixed(base: Base, effect: Effect, theta: Array) -> Switch:
    """An effect of which a model predicts the amounts: it is there, whole, or not."""
    return Switch(
        effect=effect,
        sd=np.ones(1),
        is_found=True,
        alike=(),
        columns=(base.columns([effect]) @ theta)[:, None],
        inner=None,
        values=np.zeros(0),
        mixes=np.ones((1, 1, 1)),
        is_fixed=True,
    )


def _moved(
    base: Base,
    effect: Tunable,
    sd: Array,
    own: Array,
    index: int,
    inner: Inner,
    value: float,
    most: int,
) -> tuple[Array, Array, Array] | None:
    """Values, mixes and stored columns of an effect over its inner parameter; None without any."""
    grid = np.asarray(inner.grid, dtype=float)
    low, high = min(grid[0], value), max(grid[-1], value)
    ratio = low > 0.0 and high > 4.0 * low
    for _ in range(MAX_HALVINGS):
        values = _values(low, high, value, ratio)
        raw = [base.columns([with_inner(effect, index, float(v))]) * sd for v in values]
        if not all(np.isfinite(C).all() for C in raw):
            return None
        if _misfit(raw, values, ratio) < MAX_MISFIT:
            return values, *_principal(base, own, raw, most)
        low, high = (
            (np.sqrt(low * value), np.sqrt(high * value))
            if ratio
            else (0.5 * (low + value), 0.5 * (high + value))
        )
    return None


def _values(low: float, high: float, value: float, is_ratio: bool) -> Array:
    """Values from low to high, the present one among them, twice as dense as they are kept."""
    space = np.geomspace if is_ratio else np.linspace
    out = space(low, high, NODES)
    out[np.argmin(np.abs(out - value))] = value
    return np.asarray(out)


def _misfit(raw: Sequence[Array], values: Array, is_ratio: bool) -> float:
    """How badly every second value's columns follow from the others, over their largest change."""
    x = np.log(values) if is_ratio else values
    change = max(float(np.linalg.norm(C - raw[0])) for C in raw)
    worst = 0.0
    for i in range(3, len(values) - 3, 2):
        others = [i - 3, i - 1, i + 1, i + 3]
        w = lagrange(x[others], float(x[i]))
        guess = sum(wk * raw[k] for wk, k in zip(w, others, strict=True))
        worst = max(worst, float(np.linalg.norm(raw[i] - guess)))
    return worst / (change or 1.0)


def lagrange(x: Array, at: float) -> Array:
    """Weights of values at places x in the polynomial through them, at one place."""
    return np.array(
        [np.prod([(at - b) / (a - b) for j, b in enumerate(x) if j != i]) for i, a in enumerate(x)]
    )


def _principal(base: Base, own: Array, raw: Sequence[Array], most: int) -> tuple[Array, Array]:
    """Mixes (V, K, M) and stored columns (N, M) that give columns at all values."""
    count = own.shape[1]
    change = np.hstack([C - own for C in raw])
    whole = base.fit.noise.factor * base.fit.weight
    seen = base.freed(change[base.fit.used], whole)
    _, S, Wt = np.linalg.svd(seen, full_matrices=False)
    kept = int(np.clip(np.sum(S / max(S[0], 1e-300) > MIN_PRINCIPAL), 0, most))
    scale = np.maximum(S[:kept], 1e-300)
    stored = change @ (Wt[:kept].T / scale)  # length 1 where the base is projected out
    weights = (scale[:, None] * Wt[:kept]).T.reshape(len(raw), count, kept)
    same = np.broadcast_to(np.eye(count), (len(raw), count, count))
    return np.concatenate([same, weights], axis=2), np.hstack([own, stored])
