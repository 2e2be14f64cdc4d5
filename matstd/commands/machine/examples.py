"""`matstd examples`: the examples that come with the tool, copied to a folder of the user's."""

import argparse
from fnmatch import fnmatch
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import NamedTuple

from matstd.console import say
from matstd.options import Options
from matstd.twin.errors import BadArgument


class Example(NamedTuple):
    """One example."""

    files: tuple[str, ...]  # patterns of its files within the examples
    about: str  # what it shows
    first: str  # the command to begin with, seen from the folder of the copy


RUNS = ("*.csv", "*.toml", "*.json", "README.md")

EXAMPLES = {
    "hidden-effect": Example(
        tuple(f"hidden_effect/{p}" for p in RUNS),
        "two runs of a machine with an effect that the model lacks",
        "matstd diagnose {folder}/hidden_effect/warm_up.csv -o diagnosis",
    ),
    "crash": Example(
        tuple(f"crash/{p}" for p in RUNS),
        "three runs of one machine: what changed between them",
        "matstd diagnose {folder}/crash/spring.csv {folder}/crash/summer.csv "
        "{folder}/crash/after_crash.csv -o diagnosis",
    ),
    "trend": Example(
        tuple(f"trend/{p}" for p in RUNS),
        "ten weeks of one machine: a centre that jumps, a squareness that drifts",
        "matstd trend {folder}/trend -o charts",
    ),
    "wrong-description": Example(
        tuple(f"wrong_description/{p}" for p in RUNS),
        "runs whose machine file has a mistake: it is named, with the number to copy",
        "matstd compare {folder}/wrong_description/pivot.csv -o comparison",
    ),
    "machine-1995": Example(
        tuple(f"machine_1995/{p}" for p in RUNS),
        "a machining centre with its published errors",
        "matstd diagnose {folder}/machine_1995/run.csv -o diagnosis",
    ),
    "design": Example(
        ("hsm600u.toml", "hsm600u-machine.toml", "task.toml"),
        "the project of the manual: machine, probe, errors, task",
        "matstd design {folder}/hsm600u.toml -o OUT",
    ),
    "machines": Example(
        ("machines/*.toml",),
        "projects for seven other kinds of machines",
        "matstd design {folder}/machines/trunnion.toml -o OUT",
    ),
    "scripts": Example(
        ("ex*.py", "my_effects.py", "hsm600u-machine.toml", "first_look.ipynb"),
        "Python scripts of one idea each, an effect of one's own, a notebook",
        "python {folder}/ex01_one_error_one_pose.py",
    ),
}
"""Examples by name."""


OPTIONS: Options = {
    f"name={'|'.join(['', *EXAMPLES])} []": "copy this example",
    "-o --output FOLDER": "folder of the copy (default: matstd-examples)",
    "--force": "replace files of an earlier copy",
}


def run(args: argparse.Namespace) -> int:
    """Print the list, or copy an example; no file of the user's is replaced unasked."""
    from matstd.twin.files.whole import copy_into

    if args.name is None:
        if args.output is not None:
            raise BadArgument("output", args.output, "it with the name of an example")
        for name, example in EXAMPLES.items():
            say(name, style="bold")
            say(f"  {example.about}")
        args.next = ("matstd examples hidden-effect", "copies the first")
        return 0
    example, folder = EXAMPLES[args.name], Path(args.output or "matstd-examples")
    copies = {
        path: source.read_bytes() for pattern in example.files for path, source in _found(pattern)
    }
    for path in copy_into(folder, copies, args.force):
        say(str(path))
    args.next = (example.first.format(folder=folder.as_posix()), example.about)
    return 0


def _found(pattern: str) -> list[tuple[str, Traversable]]:
    """Files of the examples that a pattern names, by their path within them."""
    *inner, name = pattern.split("/")
    place: Traversable = files("matstd.examples").joinpath(*inner)
    names = sorted(file.name for file in place.iterdir() if fnmatch(file.name, name))
    return [("/".join([*inner, n]), place.joinpath(n)) for n in names if n != "__init__.py"]
