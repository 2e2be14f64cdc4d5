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
    parser.add_argument("--rpm", type=float, help="spindle speed since switching on")
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
