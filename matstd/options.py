"""Options that several commands share, and what they mean."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matstd.twin.errors import DesignError

if TYPE_CHECKING:
    from matstd.report.pages import Printer

SETUP, GEOMETRY = "setup", "geometry"
"""Words for starting models: where the standard stands and no more, or the ordinary model."""

SHEET = "setup"  # folder of the set-up sheet, and of the programs that are run before the others

SHEET_FILES = (
    f"{SHEET}/setup.pdf",
    f"{SHEET}/tables/*.csv",
    *(f"{SHEET}/{stem}_*" for stem in ("setup", "playback")),
    *(f"{SHEET}/*_{ending}.*" for ending in ("LOC", "CAL", "COM", "DRY")),
    "programs/*_[0-9]*.*",
)
"""Of it and of the programs, what not every run leaves."""


Option = str | tuple[str, str | float | Sequence[str] | type[int] | type[float]]
"""Meaning of an option for the help; in a pair also what it takes."""


def add_options(parser: argparse._ActionsContainer, options: Mapping[str, Option]) -> None:
    """Options as the help lists them: `--name` is a switch, `--name WORD` takes a word.

    In a pair, `int` or `float` is the type of a number; a number or a word is what holds without
    the option; of several words one is chosen, the first without the option.
    """
    for words, meaning in options.items():
        name, _, metavar = words.partition(" ")
        about, kind = (meaning, None) if isinstance(meaning, str) else meaning
        more: dict[str, Any] = {"metavar": metavar or None}
        if isinstance(kind, type):
            more["type"] = kind
        elif isinstance(kind, str | int | float):
            more |= {"type": type(kind), "default": kind}
        elif kind is not None:
            more |= {"choices": kind, "default": kind[0]}
        elif not metavar:
            more = {"action": "store_true"}
        parser.add_argument(name, help=about, **more)


def add_output(parser: argparse.ArgumentParser, name: str = "OUT", force: str = "") -> None:
    """The options -o and --force.

    Args:
        name: Of what is written: `RUN.csv`; a folder is `OUT`.
        force: Help of --force where it is not the usual.
    """
    is_folder = name == "OUT"
    meaning = "output folder" if is_folder else "output file"
    usual = "replace results of an earlier run" if is_folder else "overwrite an existing output"
    parser.add_argument("-o", "--output", metavar=name, required=True, help=meaning)
    parser.add_argument("--force", action="store_true", help=force or usual)


def add_several(parser: argparse.ArgumentParser, option: str, word: str, meaning: str) -> None:
    """An option with one or more words, which may be given more than once."""
    parser.add_argument(option, metavar=word, action="extend", nargs="+", default=[], help=meaning)


def add_effects(parser: argparse.ArgumentParser) -> None:
    """The option --effects."""
    parser.add_argument(
        "--effects",
        metavar="FILE.py",
        action="append",
        default=[],
        help="file with your own effects; may be repeated",
    )


def add_body(parser: argparse.ArgumentParser, meaning: str) -> None:
    """Options that state the temperature of the standard."""
    add_options(
        parser,
        {
            "--body-degC T": (meaning, float),
            "--body-u-K U": (
                "standard uncertainty of the temperature of the standard, K (0.3 if the "
                "temperature is stated; otherwise 2, about 20 °C)",
                float,
            ),
        },
    )


def seen_from(folder: Path, file: str | Path) -> str:
    """A file as another one in some folder names it."""
    return Path(os.path.relpath(file, folder.resolve())).as_posix()


def add_measured(parser: argparse.ArgumentParser, without: str) -> None:
    """What compare and diagnose have in common.

    Args:
        without: What it does without a model, for the help.
    """
    add_start(parser, without)
    add_pitch(parser)
    add_results(parser)


def add_results(parser: argparse.ArgumentParser) -> None:
    """The user's effects, the page and the folder of results."""
    add_effects(parser)
    add_options(
        parser,
        {
            "--standard FILE": "what was probed, drawn on the page: STANDARD.toml, or a drawing "
            "in the frame of the standard (.stl, .obj, .ply, .step). Default: standard.toml "
            "beside the run, if it is its",
            "--no-report": "do not write the report page and its figures",
        },
    )
    add_pdf(parser)
    add_output(parser)


def add_pdf(parser: argparse.ArgumentParser) -> None:
    """The argument `--pdf`."""
    parser.add_argument(
        "--pdf",
        action="store_true",
        default=None,
        help="also print the report to report.pdf (needs WeasyPrint or a browser)",
    )


def asked_printer(args: argparse.Namespace) -> Printer | None:
    """What prints the page, looked for before the work begins; None where no PDF is wanted.

    Raises:
        MissingLibrary: It is wanted, and nothing here can print.
    """
    if not args.pdf:
        return None
    from matstd.report.pages import printer

    return printer()


def print_report(folder: Path, printed_by: Printer | None, name: str = "report") -> None:
    """Print the page of a folder, if anything shall."""
    if printed_by is not None:
        from matstd.report.pages import write_pdf

        write_pdf(folder / f"{name}.html", folder / f"{name}.pdf", printed_by)


def add_start(parser: argparse.ArgumentParser, without: str) -> None:
    """The options --model and --start.

    Args:
        without: What it does without a model, for the help.
    """
    add_options(
        parser,
        {
            "--model MODEL.toml": f"model of an earlier run; {without}",
            "--start WHAT": f"starting model: {SETUP} (position of the standard only), {GEOMETRY} "
            "(the ordinary geometric model, the default) or MODEL.toml (as --model)",
        },
    )


def add_pitch(parser: argparse.ArgumentParser) -> None:
    """The option --pitch."""
    add_several(
        parser,
        "--pitch",
        "AXIS=MM",
        "pitch of the screw or scale of an axis; the search for periodic errors "
        "includes it and its whole fractions and prefers it to similar periods",
    )


def starting_model(args: argparse.Namespace) -> str:
    """The starting model: a word, or the path of a model file.

    Raises:
        DesignError: A model by both options, or a word that is none of theirs.
    """
    start: str | None = args.start
    if start is None or (start == GEOMETRY and args.model is not None):
        return args.model or GEOMETRY
    if args.model is not None:
        raise DesignError(f"--start {start}: beside --model {args.model}, expected one of the two")
    if start not in (SETUP, GEOMETRY) and not start.endswith(".toml"):
        expected = f"expected {SETUP}, {GEOMETRY} or a model file (.toml)"
        raise DesignError(f"--start {start}: {expected}")
    return start


def named_numbers(option: str, words: Sequence[str], expected: str) -> dict[str, float]:
    """Numbers by name of words such as `X=10`.

    Raises:
        DesignError: No name and number, or a name that is given twice.
    """
    out: dict[str, float] = {}
    for word in words:
        name, _, number = (part.strip() for part in word.rpartition("="))
        try:
            value = float(number)
        except ValueError:
            name, value = "", 0.0
        if not name or not math.isfinite(value):
            raise DesignError(f"{option} {word}: expected {expected}")
        if name in out:
            raise DesignError(f"{option} {word}: {name} is given twice, expected it once")
        out[name] = value
    return out


def pitches(args: argparse.Namespace) -> dict[str, float]:
    """Pitches by axis, mm, of the option of `add_pitch`."""
    return named_numbers("--pitch", args.pitch, "an axis and its pitch in mm, such as X=10")
