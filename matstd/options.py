"""Options that several commands share, and what they mean."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Sequence
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


Options = dict[str, "str | Options"]
"""Arguments with their meanings for the help, as `add_options` explains."""

ONE_OF, EXACTLY_ONE = "one of", "exactly one of"
"""Names of groups of options that exclude each other."""


class Required(str):
    """Meaning of an option that has to be given."""


def add_options(parser: argparse._ActionsContainer, options: Options) -> None:
    """Arguments as the help lists them.

    `--name` is a switch, `--name WORD` takes a word and `--name X Y Z` three; `--name WORD ...`
    takes one or more, and again where it is given again. `name WORD` is positional, and may be left
    out in brackets.

    Behind the name of an option, `:int` or `:float` is the type of a number, and `:list` lets it be
    repeated. `=1.0` or `=word` holds without the option, for each of several numbers; of
    `=one|other` one is chosen, the first without the option; of `=|one|other` that is none.

    Options below another key are a group: those of `ONE_OF` and `EXACTLY_ONE` exclude each other,
    any other group has a heading in the help.
    """
    for form, about in options.items():
        if isinstance(about, dict):
            group = (
                parser.add_mutually_exclusive_group(required=form == EXACTLY_ONE)
                if form in (ONE_OF, EXACTLY_ONE)
                else parser.add_argument_group(form)
            )
            add_options(group, about)
            continue
        words = form.split()
        count = sum(word.startswith("-") for word in words)
        flags, shown = words[: count or 1], words[count or 1 :]
        name, equals, default = flags[-1].partition("=")
        flags[-1], _, kind = name.partition(":")
        more = _taken(shown, kind, default if equals else None, is_option=count > 0)
        if isinstance(about, Required):
            more["required"] = True
        parser.add_argument(*flags, help=about, **more)


def _taken(shown: Sequence[str], kind: str, default: str | None, is_option: bool) -> dict[str, Any]:
    """What an argument takes, in the words of argparse."""
    if not shown and not kind and default is None and is_option:
        return {"action": "store_true"}
    names = tuple(word.strip("[]") for word in shown if word != "...")
    may_lack, is_open = "[" in "".join(shown), "..." in shown
    more: dict[str, Any] = {"metavar": names if len(names) > 1 else "".join(names) or None}
    if is_open and is_option:
        more |= {"action": "extend", "nargs": "+", "default": []}
    elif is_open or may_lack:
        more["nargs"] = "?" if not is_open else "*" if may_lack else "+"
    elif len(names) > 1:
        more["nargs"] = len(names)
    if kind == "list":
        more |= {"action": "append", "default": []}
    elif kind:
        more["type"] = {"int": int, "float": float}[kind]
    elif default is not None and "|" in default:
        choices = default.split("|")
        more |= {"choices": [*filter(None, choices)], "default": choices[0] or None}
    elif default is not None:
        value = _value(default)
        more |= {"type": type(value), "default": (value,) * len(names) if names[1:] else value}
    return more


def _value(text: str) -> int | float | str:
    """The number that a text is, or the text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def output(name: str = "OUT", force: str = "") -> Options:
    """The options -o and --force.

    Args:
        name: Of what is written: `RUN.csv`; a folder is `OUT`.
        force: Help of --force where it is not the usual.
    """
    is_folder = name == "OUT"
    usual = "replace results of an earlier run" if is_folder else "overwrite an existing output"
    return {
        f"-o --output {name}": Required("output folder" if is_folder else "output file"),
        "--force": force or usual,
    }


EFFECTS: Options = {"--effects:list FILE.py": "file with your own effects; may be repeated"}

PDF: Options = {"--pdf": "also print the report to report.pdf (needs WeasyPrint or a browser)"}

RESULTS: Options = {
    **EFFECTS,
    "--standard FILE": "what was probed, drawn on the page: STANDARD.toml, or a drawing in the "
    "frame of the standard (.stl, .obj, .ply, .step). Default: standard.toml beside the run, if it "
    "is its",
    "--no-report": "do not write the report page and its figures",
    **PDF,
    **output(),
}
"""The user's effects, the page and the folder of results."""


def body(meaning: str) -> Options:
    """Options that state the temperature of the standard."""
    return {
        "--body-degC:float T": meaning,
        "--body-u-K:float U": "standard uncertainty of the temperature of the standard, K (0.3 if "
        "the temperature is stated; otherwise 2, about 20 °C)",
    }


def measured(without: str) -> Options:
    """What compare, diagnose and learn have in common.

    Args:
        without: What a command does without a model, for the help.
    """
    return {
        "--model MODEL.toml": f"model of an earlier run; {without}",
        "--start WHAT": f"starting model: {SETUP} (position of the standard only), {GEOMETRY} (the "
        "ordinary geometric model, the default) or MODEL.toml (as --model)",
        "--pitch AXIS=MM ...": "pitch of the screw or scale of an axis; the search for periodic "
        "errors includes it and its whole fractions and prefers it to similar periods",
        **RESULTS,
    }


def seen_from(folder: Path, file: str | Path) -> str:
    """A file as another one in some folder names it."""
    return Path(os.path.relpath(file, folder.resolve())).as_posix()


def asked_printer(pdf: bool) -> Printer | None:
    """What prints a page, None where no PDF is wanted; raises MissingLibrary for nothing."""
    if not pdf:
        return None
    from matstd.report.pages import printer

    return printer()


def print_report(folder: Path, printed_by: Printer | None, name: str = "report") -> None:
    """Print the page of a folder, if anything shall."""
    if printed_by is not None:
        from matstd.report.pages import write_pdf

        write_pdf(folder / f"{name}.html", folder / f"{name}.pdf", printed_by)


def starting_model(args: argparse.Namespace) -> str:
    """The starting model, a word or the path of a model file; raises DesignError for both."""
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
    """Numbers by name of words such as `X=10`; raises DesignError for no number, or one twice."""
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
    """Pitches by axis, mm, of `--pitch`."""
    return named_numbers("--pitch", args.pitch, "an axis and its pitch in mm, such as X=10")
