"""Picture of a pattern without a name: a residual over one or two variables, beside pure chance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import MIN_VIEW, Structure, binned, directions, groups, variables
from matstd.report.numbers import span, time_unit
from matstd.report.plots.residual_pictures import kept
from matstd.report.style import (
    BLUE,
    DIVERGING,
    FAINT,
    INK,
    SOFT,
    axis_of,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Array
from matstd.twin.record import IntArray
from matstd.twin.units import UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NEIGHBOURS = 14
"""Touches over which a map of two variables is averaged."""

BINS = 24


def draw_pattern(fit: Fit, found: Structure, rng: np.random.Generator) -> Figure | None:
    """A residual over the variables of a pattern, and the same residual shuffled.

    The shuffled half shows what noise of this size would look like.

    Args:
        found: The pattern, of one or two variables.

    Returns:
        None where the pattern has no variable to draw over.
    """
    known = variables(fit.run.touches)
    known |= {k: v.astype(float) for k, v in groups(fit.run.touches).items()}
    if not 1 <= len(found.variables) <= 2 or not set(found.variables) <= set(known):
        return None
    rows, r, weight = _seen(fit, found.direction)
    names, x = _axes(found, {name: known[name][rows] for name in found.variables})
    word = "the normal" if found.direction == "normal" else found.direction
    drawn = figure(3.7 if len(x) == 1 else 4.3)
    axes = drawn.subplots(1, 2, sharex=True, sharey=True)
    both = (r, rng.permutation(r))
    if len(x) == 1:
        limit = robust_limit(r, 0.99)
        for ax, values in zip(axes, both, strict=True):
            course(ax, x[0], values, weight, limit)
        axes[0].set_ylabel(f"residual along {word} in µm")
    else:
        label = f"mean residual of {NEIGHBOURS} neighbours along {word}, µm"
        _maps(drawn, axes, x, [_map(x, values, weight) for values in both], label)
        axes[0].set_ylabel(names[1])
    for ax, title in zip(axes, ("as measured", "shuffled: pure chance"), strict=True):
        ax.set_xlabel(names[0])
        ax.set_title(title, fontsize=9.5, loc="left", color=INK)
        plain(ax)
    return drawn


def _axes(found: Structure, known: dict[str, Array]) -> tuple[list[str], Array]:
    """Labels of the variables of a pattern, and their values, (1 or 2, M)."""
    if found.period > 0.0:
        factor, unit = time_unit(found.period)
        label = f"time within a wave of {span(found.period)}, in {unit}"
        return [label], (known[found.variables[0]] % found.period)[None] / factor
    labelled = [axis_of(name, values) for name, values in known.items()]
    return [label for label, _ in labelled], np.stack([values for _, values in labelled])


def _seen(fit: Fit, direction: str) -> tuple[IntArray, Array, Array]:
    """Touches that see a direction, (M,), with their residuals along it, µm, and weights."""
    rows = np.flatnonzero(fit.used)
    along = directions(fit.run.touches)
    seen = along.get(direction, along["normal"])[rows]
    clear = np.abs(seen) >= MIN_VIEW * float(np.quantile(np.abs(seen), 0.99))
    rows, seen = rows[clear], seen[clear]
    return rows, fit.residual[rows] / (seen * UM), (seen / fit.run.u[rows]) ** 2


def _maps(drawn: Any, axes: Array, x: Array, values: Sequence[Array], label: str) -> None:
    """Touches over two variables, coloured by values, on one scale."""
    limit = robust_limit(values[0], 1.0)
    style: dict[str, Any] = {"s": 17, "lw": 0.3, "ec": "#00000030", "cmap": DIVERGING}
    for ax, colour in zip(axes, values, strict=True):
        marks = ax.scatter(*x, c=colour, vmin=-limit, vmax=limit, **style)
    drawn.colorbar(marks, ax=list(axes), pad=0.02, shrink=0.85).set_label(label, fontsize=8.5)


def _map(x: Array, r: Array, weight: Array) -> Array:
    """Mean residual of the nearest touches, variables scaled to their ranges, (N,).

    Args:
        x: Two variables, (2, N).
        r: Residuals, (N,).
        weight: Weight of each, (N,).
    """
    from scipy.spatial import cKDTree

    scaled = (x / np.ptp(x, axis=1)[:, None]).T
    near = cKDTree(scaled).query(scaled, k=min(NEIGHBOURS, len(r)))[1].reshape(len(r), -1)
    return np.asarray((weight[near] * r[near]).sum(axis=1) / weight[near].sum(axis=1))


def course(ax: Any, x: Array, r: Array, weight: Array, limit: float) -> None:
    """Touches and means over one variable."""
    shown = kept(len(r))
    ax.axhline(0.0, color=SOFT, lw=0.8)
    ax.plot(x[shown], np.clip(r[shown], -limit, limit), ".", ms=2.0, color=FAINT, alpha=0.6)
    at, mean, error = binned(x, r, weight, BINS)
    ax.errorbar(at, mean, error, fmt="o-", ms=4, lw=1.2, color=BLUE, zorder=3)
    ax.set_ylim(-1.05 * limit, 1.05 * limit)
