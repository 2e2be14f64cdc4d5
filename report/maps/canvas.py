"""Paper and pens of the maps: empty figures, files, labels of readings, colours."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from twin.files import written_whole
from twin.machine import Chain, Link
from twin.units import DEG

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Layout = Literal["constrained"] | None

INK = "#22303c"
GRID = "#dde3e8"
SHADES = ("#2f6f9f", "#c8553d", "#5b8e4c", "#8566aa", "#c99a2e", "#4fa3a5", "#7a7a7a", "#b56d8f")
_DPI = 130


def figure(width: float, height: float, layout: Layout = "constrained") -> Figure:
    """An empty figure that belongs to no window system."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    empty = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(empty)
    return empty


def save(drawn: Figure, path: Path) -> None:
    """Write a figure as PNG, whole or not at all."""
    with written_whole(path) as part:
        drawn.savefig(part, dpi=_DPI, format="png", facecolor="white")


def nothing(text: str) -> Figure:
    """A small figure that says why there is nothing to draw."""
    empty = figure(6.0, 1.2)
    empty.text(0.5, 0.5, text, ha="center", va="center", color=INK)
    return empty


def axis_title(link: Link) -> str:
    """Axis as the chain notation writes it."""
    if link.kind == "fixed":
        return "workpiece" if link.carries_workpiece else "tool"
    name = link.name + ("'" if link.carries_workpiece else "")
    return name if link.programmed else f"({name})"


def reading_label(chain: Chain, axis: str) -> tuple[str, float]:
    """Label of a reading and what one shown unit of it is."""
    return (f"{axis} / mm", 1.0) if chain.link(axis).kind == "linear" else (f"{axis} / °", DEG)
