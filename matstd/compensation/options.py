"""Options that say which errors of a machine are meant, where and in what state."""

import argparse


def add_state(parser: argparse.ArgumentParser) -> None:
    """Datum, tool, workspace, state, switches."""
    parser.add_argument(
        "--datum",
        metavar="AXIS=READING",
        nargs="+",
        default=[],
        help="readings (mm, degrees) where the preset is taken; others are zero",
    )
    parser.add_argument(
        "--tool-length",
        metavar="MM",
        type=float,
        required=True,
        help="from the gauge point to the tip of the tool that stands at the datum",
    )
    parser.add_argument(
        "--within",
        metavar="AXIS=LOW:HIGH",
        nargs="+",
        default=[],
        help="workspace that is judged (mm, degrees); others over their travel",
    )
    _add_driven(parser)
    parser.add_argument(
        "--switch",
        metavar="WORD=FACTOR",
        nargs="+",
        default=[],
        help="scale errors, 0 is off: by symbol, effect, kind, class, axis or all",
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
    parser.add_argument(
        "--temperature",
        metavar="SENSOR=DEGC",
        nargs="+",
        default=[],
        help="of sensors that the model follows; what lags behind one has settled at it",
    )
    parser.add_argument(
        "--value", metavar="COLUMN=NUMBER", nargs="+", default=[], help="columns of your own"
    )
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
    parser.add_argument("--rpm", type=float, help="spindle speed since switching on")
