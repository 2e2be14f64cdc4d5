"""The one drawing style: paper, colours and labels of every picture, and of the pages' print.

A picture module takes an empty `figure`, the colours and the labels from here, and hands the
figure to `save`. To change how all pictures look, change this part and nothing else.
"""

from matstd.report.style.sheet import (
    BLUE,
    DIVERGING,
    FAINT,
    GREEN,
    INK,
    LINE,
    NEUTRAL,
    ORANGE,
    RED,
    SOFT,
    WASH,
    WIDTH,
    axis_of,
    axis_title,
    figure,
    nothing,
    plain,
    reading_label,
    robust_limit,
    save,
    series,
)

__all__ = [
    "BLUE",
    "DIVERGING",
    "FAINT",
    "GREEN",
    "INK",
    "LINE",
    "NEUTRAL",
    "ORANGE",
    "RED",
    "SOFT",
    "WASH",
    "WIDTH",
    "axis_of",
    "axis_title",
    "figure",
    "nothing",
    "plain",
    "reading_label",
    "robust_limit",
    "save",
    "series",
]
