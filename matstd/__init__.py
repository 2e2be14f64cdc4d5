"""The command line: reads arguments and files, strings the rooms together, prints what they found.

`matstd.cli.main` finds the command; a command is a module in `commands` with the functions
`add_arguments` and `run`. Only here is anything printed, a process ended or a user's file
overwritten; nothing is computed. A new command is a new module and a line in `cli.COMMANDS`.
"""

from typing import Any


def __getattr__(name: str) -> Any:
    """`matstd.Project`, loaded when it is asked for."""
    if name != "Project":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from matstd.design import Project

    return Project
