"""Tornado of the variance shares: one chart a region, the errors that matter there."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from matstd.report.style import INK, Figure, axis_title, figure, nothing, plain, series
from matstd.report.words import place_words
from matstd.sensitivity.shares import Region, RegionTotals
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import UM

_BARS = 8
_COLUMNS = 3
_TOTAL: dict[str, Any] = {"marker": "D", "ms": 4.5, "linestyle": "none"}


def draw_regions(
    chain: Chain, regions: Sequence[Region], totals: RegionTotals | None = None
) -> Figure:
    """Bars of the largest shares of variance in every region, coloured by link."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    shown = [k for k, r in enumerate(regions) if r.largest(1)]
    if not shown:
        return nothing("No error moves the tool point.")
    columns = min(_COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    drawn = figure(2.35 * rows + 0.5)
    grid = drawn.subplots(rows, columns, squeeze=False, sharex=True)
    colour = {link.name: series(i) for i, link in enumerate(chain.links)}
    for axes, k in zip(grid.ravel(), shown, strict=False):
        of_length = None if totals is None else (totals.total[k], totals.u[k])
        _tornado(axes, chain, regions[k], colour, of_length)
    for axes in grid.ravel()[len(shown) :]:
        axes.set_axis_off()
    for axes in grid.ravel()[max(0, len(shown) - columns) : len(shown)]:  # the lowest of a column
        axes.set_xlabel("share of the variance in %", fontsize=9)
        axes.tick_params(axis="x", labelbottom=True)
    present = {chain.symbols[i].link for k in shown for i in regions[k].largest(_BARS)}
    handles: list[Any] = [
        Patch(color=colour[link.name], label=axis_title(link))
        for link in chain.links
        if link.name in present
    ]
    if totals is not None:
        handles.append(
            Line2D([], [], color=INK, mfc="white", label="total effect on |d|", **_TOTAL)
        )
    if len(shown) < grid.size:
        grid.ravel()[-1].legend(handles=handles, loc="center", frameon=False, fontsize=9.5)
    else:
        drawn.legend(handles=handles, loc="outside lower center", ncols=8, frameon=False)
    return drawn


def _tornado(
    axes: Any,
    chain: Chain,
    region: Region,
    colour: dict[str, str],
    of_length: tuple[Array, Array] | None,
) -> None:
    """One region: shares of the summed variance, their range over the poses, effects on |d|."""
    order = region.largest(_BARS)
    share = 100.0 * region.mean_shares[order]
    low, high = 100.0 * np.quantile(region.shares[:, order], (0.05, 0.95), axis=0)
    y = np.arange(len(order))
    axes.barh(y, share, color=[colour[chain.symbols[i].link] for i in order], height=0.74)
    axes.hlines(y, low, high, color=INK, lw=1.0)
    axes.plot(low, y, "|", high, y, "|", color=INK, ms=5)
    axes.set_yticks(y, [chain.symbols[i].name for i in order], fontsize=9)
    axes.set_ylim(_BARS - 0.4, -0.6)
    top = high.max()
    if of_length is not None:
        total, u = (100.0 * values[order] for values in of_length)
        axes.errorbar(
            total, y, xerr=2.0 * u, color=INK, mfc="white", lw=0.0, elinewidth=1.0, **_TOTAL
        )
        top = max(top, (total + 2.0 * u).max())
    # all regions share one scale: an axis grows with each and never shrinks
    axes.set_xlim(min(0.0, axes.get_xlim()[0], low.min()), max(axes.get_xlim()[1], 1.04 * top))
    title = f"{place_words(region.place)}\n{region.rms / UM:.0f} µm rms"
    axes.set_title(title, fontsize=9.5, loc="left", color=INK)
    plain(axes, "x")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
