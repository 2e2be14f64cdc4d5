"""Empty figures that need no screen, axes without ornament, PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from matstd.report.style.colours import INK, LINE, SOFT
from matstd.twin.files import written_whole
from matstd.twin.words import in_own_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 10.0
"""Width of a picture, inch: pages shrink all pictures alike, so letters are equally large."""

DPI = 140
"""1400 dots across: sharp on the 190 mm of a printed page (190 dpi)."""


def figure(
    height: float, width: float = WIDTH, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Empty figure that belongs to no window system, inch."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout=layout, facecolor="white")


def save(drawn: Figure, path: str | Path) -> None:
    """PNG, written whole or not at all."""
    from matplotlib.text import Text

    for text in drawn.findobj(Text):
        text.set_text(in_own_unit(text.get_text()))
    with written_whole(path) as part:
        drawn.savefig(part, dpi=DPI, format="png")


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
