"""Heat map of the correlations after the fit."""

import numpy as np

from matstd.information.identifiability import Ties
from matstd.report.identifiability import short
from matstd.report.style import INK, Figure, figure, nothing

_SHOWN = 34  # parameters: their names stay readable in print


def draw_ties(ties: Ties, most: int = _SHOWN) -> Figure:
    """Correlations of the parameters of the largest groups, each group in a frame of its own."""
    from matplotlib.patches import Rectangle

    order: list[int] = []
    frames: list[tuple[int, int]] = []
    for group in ties.groups:
        part = group[: most - len(order)]
        if len(part) < 2:
            break
        frames.append((len(order), len(part)))
        order += part
    if not order:
        return nothing("No two parameters are tied by their correlation.")
    names = [short(ties.names[i]) for i in order]
    side = 0.215 * len(order)
    drawn = figure(side + 1.5, side + 2.6)
    axes = drawn.subplots()
    r = ties.r[np.ix_(order, order)]
    mesh = axes.imshow(r, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
    places = np.arange(len(order))
    axes.set_xticks(places, names, rotation=90, fontsize=8.5)
    axes.set_yticks(places, names, fontsize=8.5)
    axes.tick_params(length=0)
    for start, size in frames:
        corner = (start - 0.5, start - 0.5)
        axes.add_patch(Rectangle(corner, size, size, fill=False, edgecolor=INK, lw=1.3))
    bar = drawn.colorbar(mesh, ax=axes, shrink=0.7, pad=0.02)
    bar.set_label("correlation r", fontsize=9)
    bar.ax.tick_params(labelsize=8.5)
    return drawn
