"""Which languages there are, and which one a file is written in."""

from collections.abc import Mapping
from functools import lru_cache
from os.path import splitext
from pathlib import Path

from matstd.probe_paths.language.blocks import Block, read_klartext
from matstd.probe_paths.language.dialect import Dialect
from matstd.probe_paths.language.gcode import GCODE
from matstd.probe_paths.language.gcode_reader import read_gcode
from matstd.probe_paths.language.klartext import KLARTEXT
from matstd.probe_paths.language.language import Language

LANGUAGES: Mapping[str, Language] = {"klartext": KLARTEXT, "gcode": GCODE}
"""By the name that dialects give."""


@lru_cache
def language_of(path: str | Path) -> Language:
    """Language of a program file, by the ending of its name."""
    return GCODE if splitext(path)[1].lower() == GCODE.ending else KLARTEXT


def read_blocks(data: bytes, path: str | Path, dialect: Dialect | None = None) -> list[Block]:
    """Blocks of a program file in the language of its name; raises BadFile for any other."""
    if language_of(path) is GCODE:
        return read_gcode(data, path)
    return read_klartext(data, path, dialect or Dialect())
