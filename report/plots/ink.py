"""What all pictures of a diagnosis share: colours that colour-blind readers part, paper, saving."""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from twin.files import written_whole
from twin.frames import Array
from twin.words import noun, time_unit, unit_of

INK, SOFT, LINE = "#1c2430", "#7d8794", "#d8dee6"
BLUE, ORANGE, GREEN, RED, PURPLE = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#aa4499"
CLASSES = (BLUE, ORANGE, GREEN, PURPLE, RED, "#56b4e9")
"""Colours of found effects in the order found (Okabe and Ito's, which all readers tell apart)."""

DIVERGING = "RdBu_r"
"""Map for signed values: red outside, blue inside, white nothing."""

DPI = 140
WIDTH = 10.0
"""Of every picture, inch: all letters on a page come out equally large."""


def new_figure(height: float, layout: Literal["constrained"] | None = "constrained") -> Any:
    """Empty figure that needs no screen, as wide as all, of a height in inch."""
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height), layout=layout, facecolor="white")


def save(figure: Any, path: str | Path) -> None:
    """PNG, written whole or not at all."""
    with written_whole(path) as part:
        figure.savefig(part, dpi=DPI, format="png")


def plain(ax: Any) -> None:
    """Axes without a box, with a faint grid behind the data."""
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(SOFT)
    ax.tick_params(colors=INK, labelsize=8.5, color=SOFT)
    ax.grid(color=LINE, lw=0.6)
    ax.set_axisbelow(True)


def robust_limit(values: Array, share: float = 0.99) -> float:
    """End of a symmetric scale that a few large values do not decide; 1 where all are zero."""
    limit = float(np.quantile(np.abs(values), share)) if len(values) else 0.0
    return limit or 1.0


def axis_of(column: str, values: Array) -> tuple[str, Array]:
    """Label of an axis for a column of a run file, and its values in the unit of the label.

    Example:
        >>> axis_of("B_deg", np.array([-90.0, 0.0]))[0], axis_of("time_s", np.array([0.0, 9e4]))[0]
        ('B in °', 'time in h')
    """
    if column == "time_s":
        # two days are better told in hours than in days: the axis has room for two digits
        factor, unit = time_unit(min(float(np.max(np.abs(values), initial=1.0)), 86400.0))
        return f"time in {unit}", values / factor
    unit = unit_of(column).replace("deg", "°")
    return (f"{noun(column)} in {unit}" if unit else noun(column)), values


def tidy(text: str) -> str:
    """A name on two lines at most, broken where an effect's arguments begin."""
    head, bracket, rest = text.partition("(")
    return f"{head}\n({rest}" if bracket and len(text) > 16 else text
