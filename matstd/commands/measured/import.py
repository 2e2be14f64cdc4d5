"""`matstd import`: tables of instruments, CMMs and spreadsheets made a run file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from matstd.options import add_output, seen_from

if TYPE_CHECKING:
    from pathlib import Path

    from matstd.importers import Sheet

_SIGN = {
    "positioning": "a deviation (actual - target) is the axis's own error; in the run it stands as "
    "dev_um = -(actual - target) along the direction of motion",
    "component": "an error of the tool relative to the workpiece, along the axis that it is named "
    "after or about it; in the run it stands with the other sign",
    "circle": "a radial deviation (actual - nominal) is where the tool really went; in the run it "
    "stands as dev_um = -(actual - nominal) along the radius outwards",
    "arm": "the tracker says where the reflector really is, the readings where the controller "
    "believes it; in the run stands dev_um = believed - measured along x, y and z of the tracker",
    "part": "measured - nominal is where the tool really went; in the run it stands as "
    "dev_um = -(measured - nominal) along each coordinate",
    "standard": "measured - calibrated is what the controller believes; in the run it stands as "
    "dev_um = measured - calibrated along each coordinate",
}
"""How signs are taken, for the user to check."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="+",
        help="csv, txt, xlsx, xls or ods; of several lists of points each is a set-up of its own",
    )
    _add_kinds(parser)
    _add_details(parser)
    parser.add_argument("--machine", metavar="MACHINE.toml", help="the machine; else one is made")
    parser.add_argument("--u-um", type=float, help="standard uncertainty of one reading, µm")
    parser.add_argument("--u-urad", type=float, help="the same of a rotary axis, µrad")
    parser.add_argument(
        "--in-order",
        metavar="SECONDS",
        type=float,
        help="rows stand in the order in which they were taken, so far apart: for slips and drifts",
    )
    parser.add_argument("--unit", help="of deviations whose column names none, such as µm")
    parser.add_argument(
        "--columns", metavar="NAME,...", help="names of the columns of a table without a header"
    )
    parser.add_argument("--sheet", metavar="NAME", help="sheet of a workbook (the first with data)")
    add_output(parser, "RUN.csv", "overwrite the outputs")


def _add_kinds(parser: argparse.ArgumentParser) -> None:
    """What the files are: one of them."""
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument(
        "--positioning", metavar="AXIS", help="ISO 230-2 table of this axis: targets, cycles"
    )
    kind.add_argument(
        "--component",
        metavar="NAME",
        help="straightness (such as EYX of X in Y) or angular error (EBX) of a linear axis: "
        "positions, readings",
    )
    kind.add_argument(
        "--circle",
        metavar="PLANE",
        help="circular test (ISO 230-4, ball bar) in XY, YZ or ZX: angles, radial deviations",
    )
    kind.add_argument(
        "--part", action="store_true", help="nominal/measured list of a part this machine made"
    )
    kind.add_argument(
        "--standard",
        action="store_true",
        help="nominal/measured list of a calibrated plate or standard this machine measured",
    )
    kind.add_argument(
        "--arm",
        action="store_true",
        help="serial arm under a tracker: columns j1, j2 ... of joints and x, y, z of reflectors",
    )
    kind.add_argument("--map", metavar="MAP.toml", help="any other table, by a mapping file")


def _add_details(parser: argparse.ArgumentParser) -> None:
    """What only one kind of file needs."""
    test = parser.add_argument_group("with --positioning")
    test.add_argument(
        "--target",
        metavar="COLUMN",
        default="",
        help="where the axis was sent, if the header does not say; of two encoders the one "
        "that the control believes",
    )
    test.add_argument(
        "--actual",
        metavar="COLUMN",
        default="",
        help="where the axis really was, by the better instrument",
    )
    circle = parser.add_argument_group("with --circle")
    circle.add_argument("--radius", type=float, help="nominal radius, mm")
    circle.add_argument("--feed", type=float, help="mm/min, from which times and speeds follow")
    circle.add_argument(
        "--bar-force",
        metavar="N",
        type=float,
        help="of a loaded bar, which pushes the tool outwards (negative: pulls)",
    )
    place: dict[str, Any] = {"metavar": ("X", "Y", "Z"), "type": float, "nargs": 3}
    circle.add_argument(
        "--centre", default=(0.0, 0.0, 0.0), help="readings at its centre, mm (0 0 0)", **place
    )
    arm = parser.add_argument_group("with --arm")
    arm.add_argument(
        "--dh",
        metavar="DH.csv",
        help="for --machine: Denavit and Hartenberg's a alpha d theta, a row a joint",
    )
    arm.add_argument(
        "--modified", action="store_true", help="the parameters of --dh are modified ones (Craig)"
    )
    arm.add_argument(
        "--coupled",
        metavar="J3+J2",
        action="append",
        default=[],
        help="a joint whose readings count from the link before another joint (Fanuc: J3+J2)",
    )
    arm.add_argument(
        "--reflector",
        help="place of the reflector, mm, in the tool frame, or with --dh in the frame of the "
        "flange; found from the data where it is not stated",
        **place,
    )


def run(args: argparse.Namespace) -> int:
    """Write the run file, and a machine file where none was given."""
    from pathlib import Path

    from matstd.console import say
    from matstd.importers import read_sheet
    from matstd.twin.errors import DesignError
    from matstd.twin.files import refuse_to_overwrite

    output = Path(args.output)
    refuse_to_overwrite(output, args.force)
    names = [n.strip() for n in args.columns.split(",")] if args.columns else ()
    sheets = [read_sheet(path, args.sheet, names) for path in args.files]
    if args.in_order is not None and not (args.arm or args.part or args.standard):
        raise DesignError("--in-order: expected with --arm, --part or --standard alone")
    if len(sheets) > 1 and not (args.part or args.standard):
        raise DesignError(f"{args.files[1]}: one table at a time; lists of points may be several")
    for sheet in sheets:
        if sheet.left_out:
            lines = ", ".join(map(str, sheet.left_out[:10]))
            say(f"- not read as data: line {lines} of {sheet.path}")
    if args.map:
        _mapped(args, sheets[0], output)
    else:
        _measured(args, sheets, output)
    return 0


def _mapped(args: argparse.Namespace, sheet: Sheet, output: Path) -> None:
    """Any table, by a mapping file."""
    from matstd.console import say, say_each
    from matstd.importers import import_mapped
    from matstd.twin.files import read_machine, write_whole

    chain = read_machine(args.machine) if args.machine else None
    found = import_mapped(sheet, args.map, output.parent, chain)
    write_whole(output, found.text)
    say(f"{output}: {len(found.run)} readings by {args.map}")
    if found.left_out:
        readings = "1 reading" if found.left_out == 1 else f"{found.left_out} readings"
        say(f"- {readings} left out: no deviation stands there")
    say_each(found.run.remarks)


def _measured(args: argparse.Namespace, sheets: list[Sheet], output: Path) -> None:
    """A test of an axis, a circle, an arm, or lists of points."""
    from pathlib import Path

    import numpy as np

    from matstd.commands.measured.kinds import arm, circle, points, positioning
    from matstd.console import say
    from matstd.importers import machine_text
    from matstd.importers.files import timed_by_rows
    from matstd.twin.files import refuse_to_overwrite, write_run, write_whole
    from matstd.twin.units import UM

    if args.part or args.standard:
        measured, chain = points(args, sheets)
    else:
        made = arm if args.arm else circle if args.circle else positioning
        measured, chain = made(args, sheets[0])
    if args.in_order is not None:
        measured = timed_by_rows(measured, args.in_order)
    for sheet in sheets:
        if sheet.unused:
            say(f"- columns of {sheet.path} that were not used: {', '.join(sheet.unused)}")
    machine = Path(args.machine) if args.machine else output.with_suffix(".machine.toml")
    if not args.machine:
        refuse_to_overwrite(machine, args.force)
        source = ", ".join(s.path.name for s in sheets)
        write_whole(machine, machine_text(chain, source, is_known=args.arm))
    write_run(output, measured, seen_from(output.parent, machine))
    rms = float(np.sqrt(np.mean(measured.deviation**2))) / UM
    unit = "µrad" if measured.touches.instrument.reads_angle else "µm"  # of an arm of one metre
    say(f"{output}: {len(measured)} readings, deviations {rms:.3f} {unit} rms")
    say(f"- sign: {next(words for kind, words in _SIGN.items() if getattr(args, kind))}")
    if not args.machine:
        say(f"- {machine}: made from the data; check what is marked PLACEHOLDER")
