"""Pictures of a pattern without a name and of a region: a residual over what it depends on."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import (
    MIN_VIEW,
    Region,
    Side,
    Structure,
    binned,
    directions,
    groups,
    observed_error,
    variables,
)
from matstd.report.numbers import span, time_unit
from matstd.report.plots.residual_pictures import kept
from matstd.report.style import (
    BLUE,
    DIVERGING,
    FAINT,
    INK,
    RED,
    SOFT,
    Figure,
    axis_of,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import UM, URAD


def draw_region(fit: Fit, region: Region) -> Figure | None:
    """The error of a region over every variable that bounds it, within its other bounds.

    Returns:
        None for a region that labels bound, or in which touches scatter.
    """
    known = variables(fit.run.touches)
    bounds = {k: _bounds(region, k, v) for k, v in known.items()}
    names = [k for k in known if any(c.variable == k for c in region.conditions)]
    if region.wrong is None or not names:
        return None
    rows, values, weight = observed_error(fit, region)
    unit, word = (URAD, "µrad") if region.wrong.is_angular else (UM, "µm")
    size = region.wrong.size / unit
    limit = max(robust_limit(values / unit, 0.9), 2.0 * abs(size))
    drawn = figure(3.0)
    axes = drawn.subplots(1, len(names), sharey=True, squeeze=False)[0]
    for ax, name in zip(axes, names, strict=True):
        within = np.ones(len(rows), dtype=bool)
        for other in (k for k in names if k != name):
            low, high = bounds[other]
            within &= (known[other][rows] >= low) & (known[other][rows] <= high)
        label, x = axis_of(name, np.append(known[name][rows[within]], bounds[name]))
        ax.axvspan(*x[-2:], color=FAINT, alpha=0.35, lw=0.0)
        ax.plot(x[-2:], [size, size], "-", color=RED, lw=1.4)
        course(ax, x[:-2], values[within] / unit, weight[within], limit)
        ax.set_xlabel(label, fontsize=8.5)
        plain(ax)
    axes[0].set_ylabel(f"{region.wrong.carrier} in {word}")
    return drawn


def _bounds(region: Region, name: str, values: Array) -> tuple[float, float]:
    """Where a region begins and ends along a variable."""
    own = {c.side: float(c.bound) for c in region.conditions if c.variable == name}
    return own.get(Side.FROM, float(values.min())), own.get(Side.BELOW, float(values.max()))


NEIGHBOURS = 14  # touches over which a map of two variables is averaged

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
