"""Heidenhain Klartext: words, dialects, masks, blocks.

A closed list: `klartext` writes its blocks, `read_blocks` takes no others. `Dialect` holds what
differs between controls and workshops, `Q` the parameters that our programs use. A new block needs
a function in `klartext`, a pattern in `Kind` and an execution in `probe_paths.control`.
"""

from probe_paths.language.blocks import Block, Kind, read_blocks
from probe_paths.language.dialect import (
    FREE,
    LENGTH_LIMIT,
    SYSTEM_INDEX,
    TOOL_LENGTH,
    Dialect,
    ErrorText,
    Label,
    Q,
)
from probe_paths.language.masks import (
    LOG_HEAD,
    MaskLine,
    SharedMask,
    head_mask,
    parse_mask,
    shared_masks,
)

__all__ = [
    "FREE",
    "LENGTH_LIMIT",
    "LOG_HEAD",
    "SYSTEM_INDEX",
    "TOOL_LENGTH",
    "Block",
    "Dialect",
    "ErrorText",
    "Kind",
    "Label",
    "MaskLine",
    "Q",
    "SharedMask",
    "head_mask",
    "parse_mask",
    "read_blocks",
    "shared_masks",
]
