"""Pictures of a residual as a sample: over every variable, and against the normal distribution."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.special import ndtri

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import RankedVariable, binned, standardised
from matstd.report.style import (
    BLUE,
    FAINT,
    INK,
    LINE,
    RED,
    SOFT,
    Figure,
    axis_of,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Array, IntArray
from matstd.twin.sampling import spread_rows
from matstd.twin.units import UM

MOST_DRAWN = 4000  # touches that are drawn as points; means are always over all

COLUMNS = 4
LEVEL = 4  # names of values that stand beside one another; more of them are turned


def kept(n: int) -> IntArray:
    """Rows that are drawn, evenly chosen where there are many."""
    return spread_rows(n, MOST_DRAWN)


def draw_over_variables(fit: Fit, panels: Sequence[RankedVariable]) -> Figure:
    """Residual against variables: small multiples with one scale.

    Grey points are touches, blue ones means with their standard errors; the right-hand scale is in
    units of the stated uncertainty (the median one where rows differ). Means beyond three standard
    errors are red.
    """
    rows = fit.used
    r, weight = fit.residual[rows] / UM, 1.0 / fit.run.u[rows] ** 2
    count = max(1, -(-len(panels) // COLUMNS))
    height = 0.3 + 1.95 * count
    # a grid of plain scales has known margins; laying it out takes as long as drawing it
    is_plain = all(len(panel.labels or ()) <= LEVEL for panel in panels)
    drawn = figure(height, layout=None if is_plain else "constrained")
    if is_plain:
        drawn.subplots_adjust(0.065, 0.5 / height, 0.945, 1.0 - 0.1 / height, 0.08, 0.3)
    axes = drawn.subplots(count, COLUMNS, sharey=True, squeeze=False)
    limit = robust_limit(r, 0.995)
    for ax, panel in zip(axes.flat, panels, strict=False):
        label, values = axis_of(panel.name, panel.values)
        _panel(ax, values, r, weight, limit)
        ax.set_xlabel(label, fontsize=8.5, labelpad=1)
        if panel.labels is not None:
            turned = 90 if len(panel.labels) > LEVEL else 0
            ax.set_xticks(np.arange(len(panel.labels)), panel.labels, rotation=turned)
            ax.set_xlim(-0.5, len(panel.labels) - 0.5)
            ax.tick_params(axis="x", labelsize=7.5)
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    for row in axes:
        row[0].set_ylabel("residual in µm", fontsize=8.5)
    last = [row[min(COLUMNS, len(panels) - k * COLUMNS) - 1] for k, row in enumerate(axes)]
    _normalised_scale(last, fit)
    return drawn


def _panel(ax: Any, values: Array, r: Array, weight: Array, limit: float) -> None:
    """One variable: touches, means, the zero line."""
    shown = kept(len(r))
    ax.axhline(0.0, color=SOFT, lw=0.8)
    ax.plot(values[shown], np.clip(r[shown], -limit, limit), ".", ms=1.6, color=FAINT, alpha=0.6)
    x, mean, error = binned(values, r, weight)
    far = np.abs(mean) > 3.0 * np.maximum(error, 1e-12)
    for which, colour in ((~far, BLUE), (far, RED)):
        ax.errorbar(
            x[which],
            mean[which],
            error[which],
            fmt="o",
            ms=3.6,
            lw=1.2,
            color=colour,
            capsize=0,
            zorder=3,
        )
    ax.set_ylim(-1.05 * limit, 1.05 * limit)
    plain(ax)


def _normalised_scale(axes: list[Any], fit: Fit) -> None:
    """Scale in units of the stated uncertainty on the right of some panels."""
    u = float(np.median(fit.run.u[fit.used])) / UM
    for ax in axes:
        right = ax.secondary_yaxis("right", functions=(lambda v: v / u, lambda v: v * u))
        right.set_ylabel("in stated u", fontsize=8.5, color=SOFT)
        right.tick_params(labelsize=8, colors=SOFT)
        right.spines["right"].set_color(LINE)


def draw_normal_plot(fit: Fit, z: Array | None = None) -> Figure:
    """Histogram and normal plot of residuals in units of their uncertainty, outliers by line.

    Args:
        z: Residuals over their standard uncertainty, (N,); None for `standardised(fit)`.
    """
    z = standardised(fit) if z is None else z
    drawn = figure(4.0)
    left, right = drawn.subplots(1, 2)
    _histogram(left, z[fit.used], fit.noise.factor)
    _normal_plot(right, fit, z)
    for ax in (left, right):
        plain(ax)
    return drawn


def _histogram(ax: Any, z: Array, factor: float) -> None:
    edge = 4.5 * max(factor, 1.0)
    edges = np.linspace(-edge, edge, 46)
    ax.hist(np.clip(z, -edge, edge), edges, color=BLUE, alpha=0.35, density=True)
    x = np.linspace(-edge, edge, 400)
    for sd, style, word in ((1.0, "-", "stated noise"), (factor, "--", "estimated noise")):
        density = np.exp(-0.5 * (x / sd) ** 2) / (sd * np.sqrt(2.0 * np.pi))
        ax.plot(x, density, style, color=INK, lw=1.2, label=word)
    ax.set(xlabel="residual over its stated standard uncertainty", ylabel="density")
    ax.legend(fontsize=8, frameon=False)


def _normal_plot(ax: Any, fit: Fit, z: Array) -> None:
    """Order statistics against those expected; gross errors at the edge of the scale."""
    rows = np.flatnonzero(fit.used | fit.gross.rows)
    rows = rows[np.argsort(z[rows])]
    expected = ndtri((np.arange(len(rows)) + 0.5) / len(rows))
    gross = fit.gross.rows[rows]
    edge = 1.08 * max(4.0, float(np.abs(z[fit.used]).max()))
    for sd, style in ((1.0, "-"), (fit.noise.factor, "--")):
        ax.plot(expected[[0, -1]], sd * expected[[0, -1]], style, color=INK, lw=1.0)
    shown = np.flatnonzero(~gross)[kept(int((~gross).sum()))]
    ax.plot(expected[shown], z[rows[shown]], ".", ms=3.0, color=BLUE)
    if gross.any():
        at = np.clip(z[rows[gross]], -0.96 * edge, 0.96 * edge)
        ax.plot(expected[gross], at, "D", ms=5.0, color=RED, mfc="none", clip_on=False)
        _list_gross(ax, fit)
    ax.set_ylim(-edge, edge)
    ax.set_xlabel("expected for a normal distribution")
    ax.set_ylabel("residual over its stated standard uncertainty")


def _list_gross(ax: Any, fit: Fit, most: int = 12) -> None:
    """Lines of the run file with the largest gross errors, as text beside their marks."""
    rows = np.flatnonzero(fit.gross.rows)
    rows = rows[np.argsort(-np.abs(fit.residual[rows]))]
    text = [f"line {fit.run.line[i]}: {fit.residual[i] / UM:+.1f} µm" for i in rows[:most]]
    if len(rows) > most:
        text.append(f"and {len(rows) - most} more")
    ax.text(
        0.98,
        0.03,
        "\n".join(["left out, off the scale:", *text]),
        transform=ax.transAxes,
        ha="right",
        va="bottom",
        fontsize=7.5,
        color=RED,
    )
