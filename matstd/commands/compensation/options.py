"""Options that say which errors of a machine are meant, where and in what state."""

import argparse


def _several(parser: argparse.ArgumentParser, name: str, metavar: str, meaning: str) -> None:
    """An option that takes one value or more, and none where it is not given."""
    parser.add_argument(name, metavar=metavar, nargs="+", default=[], help=meaning)


def add_state(parser: argparse.ArgumentParser) -> None:
    """Datum, tool, workspace, state, switches."""
    _several(
        parser,
        "--datum",
        "AXIS=READING",
        "readings (mm, degrees) where the preset is taken; others are zero",
    )
    parser.add_argument(
        "--tool-length",
        metavar="MM",
        type=float,
        required=True,
        help="from the gauge point to the tip of the tool that stands at the datum",
    )
    _several(
        parser,
        "--within",
        "AXIS=LOW:HIGH",
        "workspace that is judged (mm, degrees); others over their travel",
    )
    _add_driven(parser)
    _several(
        parser,
        "--switch",
        "WORD=FACTOR",
        "scale errors, 0 is off: by symbol, effect, kind, class, axis or all",
    )
    parser.add_argument(
        "--active",
        metavar="FILE",
        action="append",
        default=[],
        help="a table that is active on the control",
    )
    parser.add_argument(
        "--effects", metavar="FILE.py", action="append", default=[], help="effects of your own"
    )


def _add_driven(parser: argparse.ArgumentParser) -> None:
    """State of the machine, and errors that are added to its model."""
    parser.add_argument(
        "--after", metavar="MIN", type=float, default=0.0, help="minutes since switching on"
    )
    _several(
        parser,
        "--temperature",
        "SENSOR=DEGC",
        "of sensors that the model follows; what lags behind one has settled at it",
    )
    _several(parser, "--value", "COLUMN=NUMBER", "columns of your own")
    parser.add_argument("--rpm", type=float, help="spindle speed since switching on")
    parser.add_argument(
        "--load",
        metavar=("FX", "FY", "FZ"),
        nargs=3,
        type=float,
        default=(0.0, 0.0, 0.0),
        help="force on the tool in table-frame directions, N (0 0 0)",
    )
    parser.add_argument(
        "--add",
        metavar="EFFECT=SIZE",
        action="append",
        default=[],
        help="a further error, such as 'beam(Z,cantilever,180x180,at:420,sense:-1,mass:80)="
        "weight=1,load=1'",
    )


def add_program(parser: argparse.ArgumentParser) -> None:
    """What a part program leaves open: its tools, M functions of the machine."""
    _several(
        parser,
        "--tool",
        "TOOL=MM",
        "lengths of tools of the program by number or name; others have that of the datum",
    )
    _several(
        parser,
        "--tool-radius",
        "TOOL=MM",
        "radii of tools by number or name, where the program goes beside a contour "
        "(RL, RR, G41, G42)",
    )
    parser.add_argument(
        "--pass-m",
        metavar="NUMBER",
        nargs="+",
        type=int,
        default=[],
        help="M functions of this machine that move nothing and change no coordinates",
    )
    parser.add_argument(
        "--tcp-m",
        metavar=("ON", "OFF"),
        nargs=2,
        type=int,
        default=(),
        help="M functions of G-code that switch tool-point control (LinuxCNC's tables: 428 429)",
    )
