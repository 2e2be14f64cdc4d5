"""`matstd import`: tables of instruments, CMMs and spreadsheets made a run file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.console import say, say_each
from matstd.options import EXACTLY_ONE, Options, output, seen_from
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matstd.importers import Sheet
    from matstd.twin.machine import Chain

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


OPTIONS: Options = {
    "files FILE ...": "csv, txt, xlsx, xls or ods; each of several lists of points is one set-up",
    EXACTLY_ONE: {
        "--positioning AXIS": "positioning test of this axis (ISO 230-2): targets, cycles",
        "--component NAME": "straightness (such as EYX of X in Y) or angular error (EBX) of a "
        "linear axis: positions, readings",
        "--circle PLANE": "circular test (ISO 230-4, ball bar) in XY, YZ or ZX: angles, radial "
        "deviations",
        "--part": "nominal/measured list of a part that this machine made",
        "--standard": "nominal/measured list of a calibrated plate or standard that this machine "
        "measured",
        "--arm": "serial arm measured by a laser tracker: columns j1, j2 ... (joints) and x, y, z "
        "(reflector)",
        "--map MAP.toml": "any other table, described by a mapping file",
    },
    "with --positioning": {
        "--target= COLUMN": "column of the target positions, if the header does not name it; with "
        "two encoders, the one that closes the position loop",
        "--actual= COLUMN": "column of the actual positions, by the reference instrument",
    },
    "with --circle": {
        "--radius:float": "nominal radius, mm",
        "--feed:float": "feed, mm/min; times and speeds follow from it",
        "--bar-force:float N": "force of a loaded ball bar on the tool, N, outwards (negative: "
        "inwards)",
        "--centre=0.0 X Y Z": "axis readings at the centre of the circle, mm (0 0 0)",
    },
    "with --arm": {
        "--dh DH.csv": "Denavit-Hartenberg parameters a, alpha, d, theta, one row per joint, "
        "instead of --machine",
        "--modified": "the parameters of --dh follow the modified convention (Craig)",
        "--coupled:list J3+J2": "coupled joints: the reading of the first is relative to the link "
        "before the second (Fanuc: J3+J2)",
        "--reflector:float X Y Z": "position of the reflector, mm, in the tool frame, or with --dh "
        "in the flange frame (default: estimated from the data)",
    },
    "--machine MACHINE.toml": "machine file (default: a file is written from the table)",
    "--u-um:float": "standard uncertainty of one reading, µm",
    "--u-urad:float": "standard uncertainty of one reading of a rotary axis, or of the measured "
    "orientation of a target on an arm, µrad",
    "--travel:list AXIS LOW HIGH": "travel of an axis in the machine file that is written, mm or "
    "degrees (default: that of the data; of joints without limits in --dh, whole half turns)",
    "--in-order:float SECONDS": "rows are in the order of measurement, SECONDS apart; allows the "
    "search for drifts and slips",
    "--unit UNIT": "unit of deviations if the column header names none, such as µm",
    "--columns NAME,...": "column names of a table without header",
    "--sheet NAME": "sheet of a workbook (default: the first with data)",
    "--table:int N": "number of the table in a file with several (default: the one with most "
    "readings)",
    **output("RUN.csv", "overwrite existing outputs"),
}


def run(args: argparse.Namespace) -> int:
    """Write the run file, and a machine file where none was given."""
    from matstd.twin.files.whole import refuse_to_overwrite

    path = Path(args.output)
    refuse_to_overwrite(path, args.force)
    names = [n.strip() for n in args.columns.split(",")] if args.columns else ()
    sheets = [_chosen(args, path, names) for path in args.files]
    if args.in_order is not None and not (args.arm or args.part or args.standard):
        raise DesignError("--in-order: expected with --arm, --part or --standard alone")
    if args.travel and (args.machine or args.map):
        raise DesignError("--travel: expected without --machine, which states the travels")
    if len(sheets) > 1 and not (args.part or args.standard):
        raise DesignError(f"{args.files[1]}: one table at a time, except lists of points")
    for sheet in sheets:
        if sheet.left_out:
            lines = ", ".join(map(str, sheet.left_out[:10]))
            say(f"- not read as data: line {lines} of {sheet.path}")
    if args.map:
        _mapped(args, sheets[0], path)
    else:
        _measured(args, sheets, path)
    return 0


def _chosen(args: argparse.Namespace, path: str, names: Sequence[str]) -> Sheet:
    """The table that `--table` names, or of which most can be read; others are listed."""
    from matstd.commands.measured.kinds import readings_of
    from matstd.importers import read_sheet
    from matstd.importers.sheets import listed_tables, most_read, read_tables

    if args.table is not None:
        return read_sheet(path, args.sheet, names, args.table)
    tables = read_tables(path, args.sheet, names)
    reader, axis = readings_of(args)
    if reader is None or len(tables) == 1:
        sheet = read_sheet(path, args.sheet, names) if len(tables) > 1 else tables[0]
    else:
        sheet = most_read(tables, reader, axis)
    if len(tables) > 1:
        say(f"- tables of {path}: {listed_tables(tables)}")
        say(f"- table {sheet.number} is read; --table chooses another")
    return sheet


def _mapped(args: argparse.Namespace, sheet: Sheet, output: Path) -> None:
    """Any table, by a mapping file."""
    from matstd.importers import import_mapped
    from matstd.twin.files import read_machine, write_whole

    chain = read_machine(args.machine) if args.machine else None
    found = import_mapped(sheet, args.map, output.parent, chain)
    write_whole(output, found.text)
    say(f"{output}: {len(found.run)} readings by {args.map}")
    if found.left_out:
        readings = "1 reading" if found.left_out == 1 else f"{found.left_out} readings"
        say(f"- {readings} left out: no deviation")
    say_each(found.run.remarks)


def _measured(args: argparse.Namespace, sheets: list[Sheet], output: Path) -> None:
    """A test of an axis, a circle, an arm, or lists of points."""
    from matstd.commands.measured.kinds import arm, circle, points, positioning
    from matstd.importers import machine_text, with_travels
    from matstd.importers.sheets import timed_by_rows
    from matstd.twin.files import write_run, write_whole
    from matstd.twin.files.whole import refuse_to_overwrite
    from matstd.twin.numbers import rms

    if args.part or args.standard:
        measured, chain = points(args, sheets)
    else:
        made = arm if args.arm else circle if args.circle else positioning
        measured, chain = made(args, sheets[0])
    if args.travel:
        measured = with_travels(measured, _travels(args.travel, chain))
        chain = measured.touches.chain
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
    left = rms(measured.deviation) / UM
    unit = "µrad" if measured.touches.instrument.reads_angle else "µm"  # of an arm of one metre
    say(f"{output}: {len(measured)} readings, deviations {left:.3f} {unit} rms")
    say(f"- sign: {next(words for kind, words in _SIGN.items() if getattr(args, kind))}")
    if not args.machine:
        say(f"- {machine}: made from the data; check what is marked PLACEHOLDER")


def _travels(stated: Sequence[Sequence[str]], chain: Chain) -> dict[str, tuple[float, float]]:
    """Travels of `--travel`, mm and rad."""
    out = {}
    for axis, *ends in stated:
        try:
            low, high = map(float, ends)
        except ValueError:
            raise DesignError(f"--travel {axis} {' '.join(ends)}: expected two numbers") from None
        unit = chain.link(axis).unit
        out[axis] = low * unit, high * unit
    return out
