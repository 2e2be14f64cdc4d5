"""Programs of controls: words, dialects, lines of logs, blocks.

A closed list of blocks (`Kind`): a language (`klartext`, `gcode`) writes them, `read_blocks` takes
no others. `Dialect` holds what differs between controls of one language and between workshops, read
from a file by `read_dialect`; `Q` the parameters that our programs use. A new block needs a
form in every language, a pattern in its reader and an execution in
`matstd.probe_paths.control`.
"""

from matstd.probe_paths.language.blocks import Block, Kind
from matstd.probe_paths.language.dialect import FREE, TOOL_LENGTH, Dialect, ErrorText, Label, Q
from matstd.probe_paths.language.dialect_file import read_dialect
from matstd.probe_paths.language.interlock import Interlock, interlocks, turn_tests
from matstd.probe_paths.language.language import Datum, Terms, Touch
from matstd.probe_paths.language.languages import LANGUAGES, language_of, read_blocks
from matstd.probe_paths.language.masks import (
    LOG_HEAD,
    MaskLine,
    SharedMask,
    head_mask,
    parse_mask,
    shared_masks,
)
from matstd.probe_paths.language.text import MAX_LINE, checked_name

__all__ = [
    "FREE",
    "LANGUAGES",
    "LOG_HEAD",
    "MAX_LINE",
    "TOOL_LENGTH",
    "Block",
    "Datum",
    "Dialect",
    "ErrorText",
    "Interlock",
    "Kind",
    "Label",
    "MaskLine",
    "Q",
    "SharedMask",
    "Terms",
    "Touch",
    "checked_name",
    "head_mask",
    "interlocks",
    "language_of",
    "parse_mask",
    "read_blocks",
    "read_dialect",
    "shared_masks",
    "turn_tests",
]
