"""Klartext and G-code as text: blocks, words, values, and the order in which blocks run.

Nothing here knows a machine. A reader that stands on it decides which blocks it takes.
"""

from matstd.nc.grammar.blocks import NUMBER as NUMBER
from matstd.nc.grammar.blocks import SIGNED as SIGNED
from matstd.nc.grammar.blocks import Block as Block
from matstd.nc.grammar.blocks import gcode_lines as gcode_lines
from matstd.nc.grammar.blocks import klartext_blocks as klartext_blocks
from matstd.nc.grammar.blocks import split_words as split_words
from matstd.nc.grammar.flow import MAX_DEPTH as MAX_DEPTH
from matstd.nc.grammar.flow import Flow as Flow
from matstd.nc.grammar.flow import label_places as label_places
from matstd.nc.grammar.formulas import COMPARISONS as COMPARISONS
from matstd.nc.grammar.modal import DATUMS as DATUMS
from matstd.nc.grammar.modal import MODAL as MODAL
from matstd.nc.grammar.modal import Modal as Modal
from matstd.nc.grammar.order import run_order as run_order
