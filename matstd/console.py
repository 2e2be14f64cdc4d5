"""What is said on the console: results on standard output."""

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from matstd.twin.words import in_own_unit

if TYPE_CHECKING:
    from rich.console import Console

DEFAULT_WIDTH = 120  # letters of a line where neither a terminal nor COLUMNS says how wide it is


def console() -> "Console":
    """Standard output; a file or a pipe is wide enough for a table."""
    from rich.console import Console

    out = Console(highlight=False)
    is_said = out.is_terminal or "COLUMNS" in os.environ
    return out if is_said else Console(highlight=False, width=DEFAULT_WIDTH)


def say(text: str, style: str | None = None) -> None:
    """One line as it is: a terminal breaks it where it likes, a file keeps it whole."""
    console().print(in_own_unit(text), markup=False, style=style, soft_wrap=True)


def say_each(lines: Iterable[object]) -> None:
    """Several lines, each as an item of a list."""
    for line in lines:
        say(f"- {line}")
