"""`matstd import`: tables of instruments, CMMs and spreadsheets made a run file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from matstd.options import add_output, seen_from

if TYPE_CHECKING:
    from pathlib import Path

    from matstd.importers.sheets import Sheet
    from matstd.twin.machine import Chain
    from matstd.twin.record import Run

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
        help="where the axis was told to go, if the header does not say; of two encoders the one "
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
    from matstd.importers.sheets import read_sheet
    from matstd.twin.errors import DesignError
    from matstd.twin.files import refuse_to_overwrite

    output = Path(args.output)
    refuse_to_overwrite(output, args.force)
    names = [n.strip() for n in args.columns.split(",")] if args.columns else ()
    sheets = [read_sheet(path, args.sheet, names) for path in args.files]
    if args.in_order is not None and not (args.arm or args.part or args.standard):
        raise DesignError("--in-order: expected with --arm, --part or --standard alone")
    if len(sheets) > 1 and (args.map or args.positioning or args.arm or args.circle):
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
    """Any table, by a mapping file; the result is read once before it gets its name."""
    import tempfile
    from pathlib import Path

    from matstd.console import say, say_each
    from matstd.importers import mapped_run
    from matstd.twin.errors import BadFile
    from matstd.twin.files import read_machine, read_run, write_whole

    text, left_out = mapped_run(sheet, args.map)
    with tempfile.TemporaryDirectory() as folder:
        trial = Path(folder) / output.name
        write_whole(trial, text)
        chain = read_machine(args.machine) if args.machine else _named_machine(args, text, output)
        try:
            found = read_run(trial, chain)
        except BadFile as error:
            facts = error.facts
            where = f"what it makes of {sheet.path}: {facts['where']}"
            raise BadFile(args.map, where, facts["found"], str(facts["expected"])) from error
    write_whole(output, text)
    say(f"{output}: {len(found)} readings by {args.map}")
    if left_out:
        readings = "1 reading" if left_out == 1 else f"{left_out} readings"
        say(f"- {readings} left out: no deviation stands there")
    say_each(found.remarks)


def _named_machine(args: argparse.Namespace, text: str, output: Path) -> Chain:
    """The machine that the head of a mapping file names, seen from the run file."""
    from matstd.twin.errors import BadFile
    from matstd.twin.files import parse_toml, read_machine

    head = "\n".join(ln.removeprefix("# ") for ln in text.splitlines() if ln.startswith("#"))
    named = parse_toml(head, args.map).get("machine")
    if not isinstance(named, str):
        raise BadFile(args.map, "head.machine", "nothing", "the machine file, or --machine")
    return read_machine(output.parent / named)


def _measured(args: argparse.Namespace, sheets: list[Sheet], output: Path) -> None:
    """A positioning test or a list of points."""
    from pathlib import Path

    import numpy as np

    from matstd.commands.measured.kinds import arm, circle, points, positioning
    from matstd.console import say
    from matstd.importers import machine_text
    from matstd.twin.files import refuse_to_overwrite, write_run, write_whole
    from matstd.twin.units import UM

    meaning = next(m for m in _SIGN if getattr(args, m))
    if args.positioning or args.component:
        measured, chain = positioning(args, sheets[0])
    elif args.circle:
        measured, chain = circle(args, sheets[0])
    elif args.arm:
        measured, chain = arm(args, sheets[0])
    else:
        measured, chain = points(args, sheets, meaning)
    if args.in_order is not None:
        measured = _in_order(args, measured)
    for sheet in sheets:
        if sheet.unused:
            say(f"- columns of {sheet.path} that nothing was taken of: {', '.join(sheet.unused)}")
    machine = Path(args.machine) if args.machine else output.with_suffix(".machine.toml")
    if not args.machine:
        refuse_to_overwrite(machine, args.force)
        source = ", ".join(s.path.name for s in sheets)
        write_whole(machine, machine_text(chain, source, is_known=args.arm))
    write_run(output, measured, seen_from(output.parent, machine))
    rms = float(np.sqrt(np.mean(measured.deviation**2))) / UM
    unit = "µrad" if measured.touches.instrument.reads_angle else "µm"  # of an arm of one metre
    say(f"{output}: {len(measured)} readings, deviations {rms:.3f} {unit} rms")
    say(f"- sign: {_SIGN[meaning]}")
    if not args.machine:
        say(f"- {machine}: made from the data; check what is marked PLACEHOLDER")


def _in_order(args: argparse.Namespace, run: Run) -> Run:
    """The run with times by the order of the rows of its table; those of one row are one moment."""
    from dataclasses import replace

    import numpy as np

    from matstd.twin.errors import DesignError
    from matstd.twin.units import DAY

    if not 0.0 < args.in_order <= DAY:
        raise DesignError(f"--in-order {args.in_order:g}: expected seconds from 0 to {DAY:g}")
    t = run.touches
    if np.ptp(t.time) > 0.0:
        raise DesignError(f"--in-order: {args.files[0]} has times; expected a table without")
    time = np.zeros(len(run))
    for k in np.unique(t.run):
        rows = t.run == k
        time[rows] = args.in_order * np.unique(run.line[rows], return_inverse=True)[1]
    return replace(run, touches=replace(t, time=time))
