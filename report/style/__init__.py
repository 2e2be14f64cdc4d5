"""The one drawing style: paper, colours and labels of every picture, and of the pages' print.

A picture module takes an empty `figure`, the colours and the labels from here, and hands the
figure to `save`. To change how all pictures look, change this part and nothing else.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from matstd.report.numbers import noun, time_unit, unit_of
from matstd.twin.files import written_whole
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG
from matstd.twin.words import LENGTHS, in_own_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # matplotlib takes a second to load, and is loaded inside the functions that draw
    Axes = Figure = Any


INK, SOFT, LINE, WASH = "#1c2430", "#7d8794", "#d8dee6", "#f4f6f9"
"""Letters, what stands back, grids, and the ground of what is bare."""

FAINT, NEUTRAL = "#9aa4b1", "#c3cad3"
"""Single touches behind their means; bars of what is not singled out."""

BLUE, ORANGE, GREEN, RED = "#0072b2", "#e69f00", "#009e73", "#d55e00"

_SERIES = (
    BLUE, ORANGE, GREEN, "#aa4499", RED, "#56b4e9",
    "#8c564b", "#999933", "#44546a", "#e78ac3", "#117733", "#b2abd2",
)  # fmt: skip
"""The first six are Okabe and Ito's, distinguishable by colour-blind readers; more than twelve
are not distinguishable."""

DIVERGING = "RdBu_r"  # map for signed values: red outside, blue inside, white nothing
_STEP = 0.3  # towards white or black, at every turn of the twelve colours


def series(k: int) -> str:
    """Colour of the k-th of several things, from 0; a different one for each of sixty.

    Example:
        >>> series(0)
        '#0072b2'
        >>> len({series(k) for k in range(60)})
        60
    """
    turn, place = divmod(k, len(_SERIES))
    if turn == 0:
        return _SERIES[place]
    # lighter, darker, much lighter, much darker ...
    ground = 255.0 if turn % 2 else 0.0
    share = 1.0 - (1.0 - _STEP) ** ((turn + 1) // 2)
    plain = (int(_SERIES[place][i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(v + share * (ground - v)):02x}" for v in plain)


WIDTH = 10.0
"""Width of a picture, inch: pages shrink all pictures alike, so letters are equally large."""

_DPI = 140  # 1400 dots across: sharp on the 190 mm of a printed page (190 dpi)


def figure(
    height: float, width: float = WIDTH, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Empty figure that belongs to no window system, inch."""
    from matplotlib.figure import Figure as Figure

    return Figure(figsize=(width, height), layout=layout, facecolor="white")


def save(drawn: Figure, path: str | Path) -> None:
    """PNG, written whole or not at all; drawn once, where `Figure.savefig` draws twice."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    if in_own_unit(LENGTHS) != LENGTHS:
        for text in drawn.findobj(Text):
            text.set_text(in_own_unit(text.get_text()))
    drawn.set_dpi(_DPI)
    with written_whole(path) as part:
        FigureCanvasAgg(drawn).print_png(part)


def nothing(text: str) -> Figure:
    """A small figure with the reason why there is nothing to draw."""
    empty = figure(1.0)
    empty.text(0.5, 0.5, text, ha="center", va="center", color=INK)
    return empty


def plain(ax: Any, grid: Literal["both", "x", "y"] = "both") -> None:
    """Axes without a box, with a faint grid behind the data and 100 in place of powers of ten."""
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(SOFT)
    ax.tick_params(colors=INK, labelsize=8.5, color=SOFT)
    ax.grid(axis=grid, color=LINE, lw=0.6)
    ax.set_axisbelow(True)
    for axis in (ax.xaxis, ax.yaxis):
        if axis.get_scale() == "log":
            _plain_numbers(axis)


def _plain_numbers(axis: Any) -> None:
    """Numbers of a logarithmic axis as 1, 2, 5, 10; powers of ten from three decades on."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    steps = (1.0, 2.0, 5.0) if high < 1e3 * low else (1.0,)
    axis.set_major_locator(LogLocator(subs=steps, numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def axis_title(link: Link) -> str:
    """Axis as the chain notation writes it."""
    if link.kind == "fixed":
        return "workpiece" if link.carries_workpiece else "tool"
    name = link.name + ("'" if link.carries_workpiece else "")
    return name if link.programmed else f"({name})"


def reading_label(chain: Chain, axis: str) -> tuple[str, float]:
    """Label of a reading and what one shown unit of it is."""
    return (f"{axis} in mm", 1.0) if chain.link(axis).kind == "linear" else (f"{axis} in °", DEG)


def axis_of(column: str, values: Array) -> tuple[str, Array]:
    """Label of an axis for a column of a run file, and its values in the unit of the label.

    Example:
        >>> axis_of("B_deg", np.array([-90.0, 0.0]))[0], axis_of("time_s", np.array([0.0, 9e4]))[0]
        ('B in °', 'time in h')
    """
    if column == "time_s":
        # two days are clearer in hours than in days: the axis has room for two digits
        factor, unit = time_unit(min(float(np.max(np.abs(values), initial=1.0)), 86400.0))
        return f"time in {unit}", values / factor
    unit = unit_of(column).replace("deg", "°")
    return (f"{noun(column)} in {unit}" if unit else noun(column)), values


def robust_limit(values: Array, share: float = 0.99) -> float:
    """End of a symmetric scale that a few large values do not decide; 1 where all are zero."""
    limit = float(np.quantile(np.abs(values), share)) if len(values) else 0.0
    return limit or 1.0
