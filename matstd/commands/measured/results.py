"""What commands whose result is saved with a page have in common."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from matstd.console import say

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
    from matstd.api.saved import page_folder
    from matstd.effect_kinds import register_effects
    from matstd.progress import stages

    register_effects(*args.effects)
    pdf = args.pdf and not args.no_report
    with page_folder(args.output, pdf, args.force, kind.sometimes) as folder, stages() as show:
        found = make(show)
        arm = found.write(folder)
        if not args.no_report:
            show("report", 0, 1)
            found.write_page(folder)
    return found, arm


def say_files(args: argparse.Namespace, *names: str) -> None:
    """The files to look at, the page first; an empty name is none."""
    page = "" if args.no_report else "report.html"
    say(f"{args.output}: look at {', '.join(filter(None, (page, *names)))}")
