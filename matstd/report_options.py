"""`--pdf` and `--no-report`: what the commands that end in a page have in common."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from report.pages import Printer

REPORT_FILES = ("report.html", "report.pdf", "tables.xlsx", "tables/*.csv")
"""Results that not every run of such a command leaves."""


def add_pdf(parser: argparse.ArgumentParser) -> None:
    """The argument `--pdf`."""
    parser.add_argument(
        "--pdf",
        action="store_true",
        default=None,
        help="print the report into report.pdf too (by WeasyPrint or a browser of this machine)",
    )


def asked_printer(args: argparse.Namespace) -> Printer | None:
    """What prints the page, looked for before the work begins; None where no PDF is wanted.

    Raises:
        MissingLibrary: It is wanted, and nothing here can print.
    """
    if not args.pdf:
        return None
    from report.pages import printer

    return printer()


def print_report(folder: Path, printed_by: Printer | None) -> None:
    """Print the page of a folder, if anything shall."""
    if printed_by is not None:
        from report.pages import write_pdf

        write_pdf(folder / "report.html", folder / "report.pdf", printed_by)
