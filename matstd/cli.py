"""Commands of `matstd`: arguments, exit codes, and one line for what a user can put right."""

import argparse
import errno
import importlib
import os
import sys
from collections.abc import Sequence

from matstd.command_line import CommandLine
from matstd.options import add_options

FOLDERS = {
    "standard": {
        "design": "design a material standard: geometry, STEP and STL, probing programs, "
        "virtual test, report",
        "sensitivity": "sensitivity of the tool point to every error parameter at every pose",
        "calibrate": "apply a CMM calibration to a standard, or write the CMM program (DMIS)",
        "uncertainty": "expanded uncertainty of a measuring task, from repeated runs on a "
        "calibrated standard (ISO 15530-3)",
    },
    "probing": {
        "simulate": "run emitted probing programs on the machine's twin and write a run file",
        "control-test": "run emitted programs on an installed LinuxCNC with the exact twin as its "
        "machine",
        "evaluate": "convert the control's logs of emitted probing programs to a run file",
        "replan": "re-plan the programs for the actual position of the standard",
    },
    "measured": {
        "import": "convert tables of instruments, CMMs and spreadsheets to a run file",
        "compare": "compare measurements with the model: where it fails",
        "diagnose": "find the effect that the model lacks and the error that remains with it",
        "trend": "control charts of one machine over several runs: what changed, and when",
        "learn": "learn the law of what a model leaves, where the library has no effect",
        "thermal": "fit laws of thermal drift to temperature logs and predict with them",
    },
    "compensation": {
        "compensate": "compensate with an identified model: control tables or a part program",
        "serve": "serve corrections while the machine moves, over OPC UA or on LinuxCNC",
        "contributions": "contribution of every error along a program or at poses",
    },
    "machine": {
        "volumetric": "exact deviation of the tool point in the table frame, one row per pose",
        "show": "one page on which a machine moves, with its errors and a program",
        "machines": "list the included machines; print a machine file with the source of every "
        "figure",
        "examples": "copy the examples that come with the tool: runs, projects, scripts",
        "new": "write a commented minimal file: machine, project, run or effect",
        "effects": "list the effects of the library with their formulas and units",
    },
}
"""Commands by the folder of `matstd/commands` that has their files, with what each does.

The file of a command has its arguments, `OPTIONS`, and `run(args)`, which does its work and returns
the exit code; `ABOUT` says more of it than the line here.
"""

COMMANDS = {name: line for folder in FOLDERS.values() for name, line in folder.items()}

EXIT_BAD_INPUT = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Returns:
        0 when it did its work, 2 after one line on what the user can put right, or after the help
        where no command is given; a fault of our own keeps its traceback.
    """
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    if not arguments:
        _parser(arguments).print_help()
        return EXIT_BAD_INPUT
    args, rest = _parser(arguments).parse_known_args(arguments)
    if rest:  # the command knows which options it has
        args.parser.error(f"unrecognized arguments: {' '.join(rest)}")
    from matstd.twin.errors import BadArgument, DesignError

    try:
        _check_output(args)
        code = int(args.run(args) or 0)
        _say_next(args, code)
        sys.stdout.flush()  # a disk that is full says so here, not when Python ends
        return code
    except BadArgument as error:  # named as the option, not as the argument of a function
        option = "--" + str(error.facts["argument"]).replace("_", "-")
        forms = (option, option[1:3])  # --output and -o; what is neither is positional
        is_option = any(word.partition("=")[0] in forms for word in arguments)
        text = str(error).partition(" ")[2]
        print(f"matstd {args.command}: {option + ' ' if is_option else ''}{text}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except DesignError as error:
        print(f"matstd {args.command}: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except BrokenPipeError:  # the reader of our output has gone
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
        return 0
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
            raise
        print(f"matstd {args.command}: cannot write its words ({error.strerror})", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_BAD_INPUT
    except (Exception, SystemExit) as error:
        theirs = _users_fault(error)
        if theirs is None:
            raise
        print(f"matstd {args.command}: {theirs}", file=sys.stderr)
        return EXIT_BAD_INPUT


def _say_next(args: argparse.Namespace, code: int) -> None:
    """The command that follows, as the last line; it stays out of a file that is printed."""
    from matstd.next_steps import next_line, prints_a_file

    if code == 0 and (line := next_line(args)):
        print(line, file=sys.stderr if prints_a_file(args) else sys.stdout)


def _check_output(args: argparse.Namespace) -> None:
    """Refuse an output that is read, or a folder of results in which a file lies that is read."""
    from matstd.twin.files.whole import refuse_own_input

    output = getattr(args, "output", None)
    if output is None:
        return
    given = [v for key, v in vars(args).items() if key not in ("output", "command")]
    words = [w for v in given for w in (v if isinstance(v, list) else [v])]
    refuse_own_input(output, [w for w in words if isinstance(w, str)])


def _users_fault(error: BaseException) -> Exception | None:
    """A failure inside effects that the user wrote, as one line; None if it is our own."""
    from matstd.twin.library import users_fault, users_files, users_lines

    for path in users_files().values():
        if users_lines(error, path):
            return users_fault(error, path, "file", "a formula that holds for every touch")
    return None


def _parser(arguments: Sequence[str]) -> CommandLine:
    """Parser that imports only the command that is called, so that help answers at once."""
    parser = CommandLine(
        prog="matstd",
        description="Designs freeform material standards for multi-axis machine tools, probes "
        "them on the machine's digital twin, and identifies the effects that a model "
        "lacks.",
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, help="print the versions that results depend on"
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    called = next((word for word in arguments if not word.startswith("-")), None)
    for folder, inside in FOLDERS.items():
        for name, line in inside.items():
            said = line[0].upper() + line[1:] + "."
            command = commands.add_parser(name, help=line, description=said)
            command.given = arguments
            if name == called:
                file = f"matstd.commands.{folder}.{name.replace('-', '_')}"
                module = importlib.import_module(file)
                command.description = getattr(module, "ABOUT", said)
                add_options(command, module.OPTIONS)
                command.set_defaults(run=module.run, parser=command)
    return parser


class _Version(argparse.Action):
    """Prints the versions that a result depends on."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from matstd.twin.versions import versions

        for name, version in versions().items():
            print(f"{name} {version}")
        parser.exit()
