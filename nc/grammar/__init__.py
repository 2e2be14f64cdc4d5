"""Klartext and G-code as text: blocks, words, values, and the order in which blocks run.

Nothing here knows a machine. A reader that stands on it decides which blocks it takes.
"""

from matstd.nc.grammar.blocks import (
    NUMBER,
    SIGNED,
    Block,
    gcode_lines,
    klartext_blocks,
    split_words,
)
from matstd.nc.grammar.flow import MAX_DEPTH, Flow, label_places
from matstd.nc.grammar.formulas import COMPARISONS
from matstd.nc.grammar.modal import DATUMS, MODAL, Modal
from matstd.nc.grammar.order import run_order

__all__ = [
    "COMPARISONS", "DATUMS", "MAX_DEPTH", "MODAL", "NUMBER", "SIGNED", "Block", "Flow",
    "Modal", "gcode_lines", "klartext_blocks", "label_places", "run_order", "split_words",
]  # fmt: skip
