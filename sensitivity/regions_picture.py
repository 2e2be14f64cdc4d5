"""Tornado of the variance shares: one chart a region, the errors that matter there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sensitivity.canvas import GRID, INK, SHADES, axis_title, figure, nothing
from sensitivity.regions import Region
from twin.chain import Chain
from twin.units import UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BARS = 8
_COLUMNS = 3


def draw_regions(chain: Chain, regions: Sequence[Region]) -> Figure:
    """Bars of the largest shares of variance in every region, coloured by the link they belong to.

    Args:
        chain: The machine.
        regions: As `sensitivity.regions.regions` gives them.
    """
    from matplotlib.patches import Patch

    shown = [r for r in regions if r.largest(1)]
    if not shown:
        return nothing("No error moves the tool point.")
    columns = min(_COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    drawn = figure(3.5 * columns, 2.35 * rows + 0.5)
    grid = drawn.subplots(rows, columns, squeeze=False, sharex=True)
    colour = {link.name: SHADES[i % len(SHADES)] for i, link in enumerate(chain.links)}
    for axes, region in zip(grid.ravel(), shown, strict=False):
        _tornado(axes, chain, region, colour)
    for axes in grid.ravel()[len(shown) :]:
        axes.set_axis_off()
    for axes in grid.ravel()[max(0, len(shown) - columns) : len(shown)]:  # the lowest of a column
        axes.set_xlabel("share of the variance / %", fontsize=9)
        axes.tick_params(axis="x", labelbottom=True)
    present = {chain.symbols[i].link for r in shown for i in r.largest(_BARS)}
    handles = [
        Patch(color=colour[link.name], label=axis_title(link))
        for link in chain.links
        if link.name in present
    ]
    if len(shown) < grid.size:
        grid.ravel()[-1].legend(handles=handles, loc="center", frameon=False, fontsize=9.5)
    else:
        drawn.legend(handles=handles, loc="outside lower center", ncols=8, frameon=False)
    return drawn


def _tornado(axes: Any, chain: Chain, region: Region, colour: dict[str, str]) -> None:
    """One region: shares of the summed variance, and their range over the poses."""
    order = region.largest(_BARS)
    share = 100.0 * region.mean_shares[order]
    low, high = 100.0 * np.quantile(region.shares[:, order], (0.05, 0.95), axis=0)
    y = np.arange(len(order))
    axes.barh(y, share, color=[colour[chain.symbols[i].link] for i in order], height=0.74)
    axes.hlines(y, low, high, color=INK, lw=1.0)
    axes.plot(low, y, "|", high, y, "|", color=INK, ms=5)
    axes.set_yticks(y, [chain.symbols[i].name for i in order], fontsize=9)
    axes.set_ylim(_BARS - 0.4, -0.6)
    axes.set_xlim(0.0, max(axes.get_xlim()[1], 1.04 * high.max()))
    title = f"{region.words}\n{region.rms / UM:.0f} µm rms"
    axes.set_title(title, fontsize=9.5, loc="left", color=INK)
    axes.grid(axis="x", color=GRID, lw=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=8.5)
    axes.spines[["top", "right", "left"]].set_visible(False)
