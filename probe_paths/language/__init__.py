"""Heidenhain Klartext: words, dialects, masks, blocks."""

from probe_paths.language.blocks import Block, Kind, read_blocks
from probe_paths.language.dialect import (
    FREE,
    INPUT_VALUE_INCORRECT,
    LENGTH_LIMIT,
    LOG_LABEL,
    MISS_LABEL,
    PROBE_LABEL,
    SYSTEM_INDEX,
    TOOL_LENGTH,
    TOUCH_POINT_INACCESSIBLE,
    Dialect,
    Q,
)
from probe_paths.language.masks import (
    END_MASK,
    LOG_HEAD,
    MISS_MASK,
    POINT_MASK,
    MaskLine,
    head_mask,
    parse_mask,
    shared_masks,
)

__all__ = [
    "END_MASK",
    "FREE",
    "INPUT_VALUE_INCORRECT",
    "LENGTH_LIMIT",
    "LOG_HEAD",
    "LOG_LABEL",
    "MISS_LABEL",
    "MISS_MASK",
    "POINT_MASK",
    "PROBE_LABEL",
    "SYSTEM_INDEX",
    "TOOL_LENGTH",
    "TOUCH_POINT_INACCESSIBLE",
    "Block",
    "Dialect",
    "Kind",
    "MaskLine",
    "Q",
    "head_mask",
    "parse_mask",
    "read_blocks",
    "shared_masks",
]
