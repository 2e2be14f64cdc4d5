"""`matstd effects`: the library of effects, each with its formula, units, size and source."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from twin.library import Kind


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "kind", metavar="KIND", nargs="?", help="tell all about one kind, such as thermal-lag"
    )
    parser.add_argument(
        "--effects", metavar="FILE.py", action="append", default=[], help="effects of your own"
    )


def run(args: argparse.Namespace) -> int:
    """Print the table, or the whole story of one kind."""
    from pathlib import Path

    from matstd import console as words
    from twin.errors import UnknownEffect
    from twin.library import kinds, load_installed_effects, load_user_effects

    load_installed_effects()
    for path in args.effects:
        load_user_effects(Path(path))
    console = words.console()
    if args.kind is None:
        for kind in kinds():
            _show(console, kind)
        return 0
    word = args.kind.partition("(")[0]
    chosen = next((kind for kind in kinds() if kind.word == word), None)
    if chosen is None:
        known = ", ".join(kind.word for kind in kinds())
        raise UnknownEffect(f"unknown kind '{word}'; available: {known}")
    _show(console, chosen)
    for cls in chosen.classes:
        console.print(_story(cls), markup=False)
    return 0


def _show(console: Console, kind: Kind) -> None:
    """How an effect is written, its formula, units, typical size and source, one below another."""
    from rich.markup import escape

    console.print(f"[bold]{escape(kind.usage)}[/bold]  {escape(kind.summary)}")
    console.print(_card(kind))


def _card(kind: Kind) -> Table:
    """Formula, units, typical size and source of a kind."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, show_header=False, padding=(0, 1))
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    for label in ("formula", "units", "typical", "source"):
        table.add_row(f"  {label}", escape(getattr(kind, label)))
    table.add_row()
    return table


def _story(cls: type) -> str:
    """What the docstring of a class of effects tells a user: all but its attributes, reflowed."""
    import inspect

    text = inspect.getdoc(cls) or cls.__name__
    before, _, after = text.partition("\nAttributes:")
    _, reference, source = (after or before).partition("\nReference:")
    paragraphs = [" ".join(p.split()) for p in before.partition("\nReference:")[0].split("\n\n")]
    if reference:
        paragraphs.append("Reference: " + " ".join(source.split()))
    return "\n\n".join(paragraphs) + "\n"
