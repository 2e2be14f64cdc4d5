"""`matstd machines`: the machines that come with the tool, with the source of every figure."""

import argparse

from matstd.console import say
from matstd.options import Options

OPTIONS: Options = {
    "name [NAME]": "print the machine file of this machine",
    "--errors": "print its error file instead of its machine file",
}


def text(name: str, errors: bool = False) -> str:
    """A machine file, or its error file, as text; raises DesignError for another name."""
    from matstd.api.machines import machine_file

    return machine_file(name, errors).read_text(encoding="utf-8").replace("\r\n", "\n")


def run(args: argparse.Namespace) -> int:
    """Print the list, or a file to be kept under another name."""
    if args.name is not None:
        print(text(args.name, args.errors), end="")
        return 0
    from matstd.api.machines import machine_names

    for name in machine_names():
        say(name, style="bold")
        for line in _card(name):
            say(f"  {line}")
    return 0


def _card(name: str) -> list[str]:
    """What a machine is, its chain, its travels, how many errors are known of it."""
    import tomllib

    whole = text(name)
    table, errors = tomllib.loads(whole), tomllib.loads(text(name, errors=True))
    ranges = [(axis, *entry["range"]) for axis, entry in table["axis"].items()]
    travels = [f"{axis} {low:g} to {high:g}" for axis, low, high in ranges]
    known = len(errors) - 1
    return [
        whole.partition("\n")[0].removeprefix("# "),
        f"{table['chain']}; {', '.join(travels)} (mm, degrees)",
        f"{known} published errors" if known else "no published errors",
    ]
