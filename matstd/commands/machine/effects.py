"""`matstd effects`: the library of effects, each with its formula, units, size and source."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING

from matstd.options import EFFECTS, Options
from matstd.twin.errors import UnknownEffect

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from matstd.twin.model import Kind


OPTIONS: Options = {
    "kind [KIND] ...": "kind of effect, such as thermal-lag, or search words, such as: spindle "
    "growth",
    **EFFECTS,
}


def run(args: argparse.Namespace) -> int:
    """Print the table, the kinds that words may mean, or the whole story of one kind."""
    from matstd import console as words
    from matstd.effect_kinds import register_effects
    from matstd.twin.library import find_kinds, kinds

    register_effects(*args.effects)
    console = words.console()
    query = " ".join(args.kind)
    found = find_kinds(query) if query else kinds()
    if not found:
        known = ", ".join(kind.word for kind in kinds())
        raise UnknownEffect(f"unknown kind '{query}'; available: {known}")
    for kind in found:
        _show(console, kind)
    if len(found) == 1:
        several = len(found[0].classes) > 1 or bool(found[0].about)
        for cls in found[0].classes:
            console.print(_story(cls, with_head=several), markup=False)
    args.next = _next(args, found)
    return 0


def _next(args: argparse.Namespace, found: Sequence[Kind]) -> tuple[str, str]:
    """The whole story of a kind; after it the command that looks for effects of this kind."""
    from matstd.next_steps import RUN, called

    word = found[0].word
    own = [part for file in args.effects for part in ("--effects", file)]
    if len(found) > 1:
        return called("effects", word, *own), "all that is known of one kind"
    if word == "law":
        return called("learn", "-o", "learnt", more=RUN), "learns such a law from a run"
    if word == "drift-law":
        return called("thermal", "-o", "drift", more="LOG.csv"), "fits such a law to a log"
    return called("diagnose", "--only", word, *own, "-o", "diagnosis", more=RUN), "looks for it"


def _show(console: Console, kind: Kind) -> None:
    """How an effect is written, its formula, units, typical size and source, one below another."""
    from rich.markup import escape

    title = f"{kind.title}: " if kind.title else ""
    console.print(f"[bold]{escape(kind.usage)}[/bold]  {escape(title)}{escape(kind.summary)}")
    console.print(_card(kind))


def _card(kind: Kind) -> Table:
    """Formula, units, typical size and source of a kind."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, show_header=False, padding=(0, 1))
    table.add_column(style="dim", no_wrap=True)
    table.add_column()
    for label in ("formula", "units", "typical", "source", "belongs_to"):
        table.add_row(f"  {label.replace('_', ' ')}", escape(getattr(kind, label)))
    table.add_row()
    return table


def _story(cls: type, with_head: bool) -> str:
    """What the docstring of a class of effects says to a user: all but its attributes, reflowed.

    Its first line stands beside the name of the kind already where the kind has one class.
    """
    import inspect

    text = inspect.getdoc(cls) or cls.__name__
    before, _, after = text.partition("\nAttributes:")
    _, reference, source = (after or before).partition("\nReference:")
    paragraphs = [" ".join(p.split()) for p in before.partition("\nReference:")[0].split("\n\n")]
    paragraphs = paragraphs if with_head else paragraphs[1:]
    if reference:
        paragraphs.append("Reference: " + " ".join(source.split()))
    return "\n\n".join(paragraphs) + "\n"
