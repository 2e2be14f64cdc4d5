"""Options that say which errors of a machine are meant, where and in what state."""

import argparse

from matstd.options import add_effects, add_options, add_several


def add_model(parser: argparse.ArgumentParser) -> None:
    """The model, or a machine file with known errors."""
    parser.add_argument(
        "model", metavar="MODEL.toml", help="model of a diagnosis, or a machine file with --errors"
    )
    parser.add_argument(
        "--errors",
        metavar="ERRORS.toml",
        help="errors of the machine, if MODEL.toml is a machine file",
    )


def add_state(parser: argparse.ArgumentParser) -> None:
    """Datum, tool, workspace, state, switches."""
    add_several(
        parser,
        "--datum",
        "AXIS=READING",
        "axis readings (mm, degrees) at which the preset is taken (default: 0)",
    )
    parser.add_argument(
        "--tool-length",
        metavar="MM",
        type=float,
        required=True,
        help="length of the datum tool, from the spindle gauge point to the tip",
    )
    add_several(
        parser,
        "--within",
        "AXIS=LOW:HIGH",
        "workspace for which the result is evaluated (mm, degrees; default: the whole travel)",
    )
    add_driven(parser)
    add_several(
        parser,
        "--switch",
        "WORD=FACTOR",
        "multiply errors by a factor (0: off), by symbol, effect, kind, class, axis or all",
    )
    parser.add_argument(
        "--active",
        metavar="FILE",
        action="append",
        default=[],
        help="compensation table that is active on the control",
    )
    add_effects(parser)


def add_driven(parser: argparse.ArgumentParser) -> None:
    """State of the machine, and errors that are added to its model."""
    add_options(
        parser,
        {
            "--after MIN": ("minutes since the machine was switched on", 0.0),
        },
    )
    add_several(
        parser,
        "--temperature",
        "SENSOR=DEGC",
        "sensor temperatures; effects with a time lag are taken as settled at them",
    )
    add_several(
        parser,
        "--value",
        "COLUMN=NUMBER",
        "values of further run columns that your own effects use",
    )
    parser.add_argument(
        "--rpm", type=float, help="spindle speed since the machine was switched on, 1/min"
    )
    parser.add_argument(
        "--load",
        metavar=("FX", "FY", "FZ"),
        nargs=3,
        type=float,
        default=(0.0, 0.0, 0.0),
        help="force on the tool in the table frame, N (0 0 0)",
    )
    parser.add_argument(
        "--add",
        metavar="EFFECT=SIZE",
        action="append",
        default=[],
        help="add an error, such as "
        "'beam(Z,cantilever,180x180,at:420,sense:-1,mass:80)=weight=1,load=1'",
    )


def add_program(parser: argparse.ArgumentParser) -> None:
    """What a part program leaves open: its tools, M functions of the machine."""
    add_several(
        parser,
        "--tool",
        "TOOL=MM",
        "tool lengths by number or name (default: the length of the datum tool)",
    )
    add_several(
        parser,
        "--tool-radius",
        "TOOL=MM",
        "tool radii by number or name, for programs with radius compensation (RL, RR, G41, G42)",
    )
    parser.add_argument(
        "--pass-m",
        metavar="NUMBER",
        nargs="+",
        type=int,
        default=[],
        help="M functions of this machine that neither move an axis nor change coordinates",
    )
    parser.add_argument(
        "--tcp-m",
        metavar=("ON", "OFF"),
        nargs=2,
        type=int,
        default=(),
        help="M functions that switch tool centre point control in G-code (tables for "
        "LinuxCNC: 428 429)",
    )
