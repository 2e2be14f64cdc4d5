"""Programs of controls: words, dialects, lines of logs, blocks.

A closed list of blocks (`Kind`): a language (`klartext`, `gcode`) writes them, `read_blocks` takes
no others. `Dialect` holds what differs between controls of one language and between workshops, read
from a file by `read_dialect`; `Q` the parameters that our programs use. A new block needs a
form in every language, a pattern in its reader and an execution in
`matstd.probe_paths.control`.
"""

from matstd.probe_paths.language.blocks import Block as Block
from matstd.probe_paths.language.blocks import Kind as Kind
from matstd.probe_paths.language.dialect import FREE as FREE
from matstd.probe_paths.language.dialect import TOOL_LENGTH as TOOL_LENGTH
from matstd.probe_paths.language.dialect import Dialect as Dialect
from matstd.probe_paths.language.dialect import ErrorText as ErrorText
from matstd.probe_paths.language.dialect import Label as Label
from matstd.probe_paths.language.dialect import Q as Q
from matstd.probe_paths.language.dialect_file import read_dialect as read_dialect
from matstd.probe_paths.language.interlock import Interlock as Interlock
from matstd.probe_paths.language.interlock import interlocks as interlocks
from matstd.probe_paths.language.interlock import turn_tests as turn_tests
from matstd.probe_paths.language.language import Datum as Datum
from matstd.probe_paths.language.language import Terms as Terms
from matstd.probe_paths.language.language import Touch as Touch
from matstd.probe_paths.language.languages import LANGUAGES as LANGUAGES
from matstd.probe_paths.language.languages import language_of as language_of
from matstd.probe_paths.language.languages import read_blocks as read_blocks
from matstd.probe_paths.language.masks import LOG_HEAD as LOG_HEAD
from matstd.probe_paths.language.masks import MaskLine as MaskLine
from matstd.probe_paths.language.masks import SharedMask as SharedMask
from matstd.probe_paths.language.masks import head_mask as head_mask
from matstd.probe_paths.language.masks import parse_mask as parse_mask
from matstd.probe_paths.language.masks import shared_masks as shared_masks
from matstd.probe_paths.language.text import MAX_LINE as MAX_LINE
from matstd.probe_paths.language.text import checked_name as checked_name
