"""What commands whose result is saved with a page have in common."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from matstd.console import say
from matstd.options import asked_printer, print_report

if TYPE_CHECKING:
    from matstd.api.saved import Saveable
    from matstd.twin.compute import Progress

T = TypeVar("T", bound="Saveable")


def made_in_folder(
    args: argparse.Namespace, kind: type[T], make: Callable[[Progress], T]
) -> tuple[T, str]:
    """A result with its files and its page; the folder appears whole or not at all.

    Args:
        make: Computes it, with a function that shows how far the work is.

    Returns:
        The result, and the line of `Saveable.write`.
    """
    from matstd.effect_kinds import register_effects
    from matstd.progress import stages
    from matstd.twin.files import results_folder

    register_effects(*args.effects)
    printed_by = asked_printer(args)
    with results_folder(args.output, args.force, kind.sometimes) as folder, stages() as show:
        found = make(show)
        arm = found.write(folder)
        if not args.no_report:
            show("report", 0, 1)
            found.write_page(folder)
            print_report(folder, printed_by)
    return found, arm


def say_files(args: argparse.Namespace, *names: str) -> None:
    """The files to look at, the page first; an empty name is none."""
    page = "" if args.no_report else "report.html"
    say(f"{args.output}: look at {', '.join(filter(None, (page, *names)))}")
