"""`matstd import`: tables of instruments, CMMs and spreadsheets made a run file."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from matstd.options import add_output, seen_from

if TYPE_CHECKING:
    from pathlib import Path

    from twin.foreign import PositioningTest, Sheet
    from twin.machine import Chain
    from twin.record import Run

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
        help="serial arm under a tracker: columns j1, j2 ... of joints and x, y, z of a reflector",
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
        "--reflector",
        help="place of the reflector, mm, in the tool frame, or with --dh in the frame of the "
        "flange; found from the data where it is not stated",
        **place,
    )


def run(args: argparse.Namespace) -> int:
    """Write the run file, and a machine file where none was given."""
    from pathlib import Path

    from matstd.console import say
    from twin.errors import DesignError
    from twin.files import refuse_to_overwrite
    from twin.foreign import read_sheet

    output = Path(args.output)
    refuse_to_overwrite(output, args.force)
    names = [n.strip() for n in args.columns.split(",")] if args.columns else ()
    sheets = [read_sheet(path, args.sheet, names) for path in args.files]
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
    from twin.errors import BadFile
    from twin.files import read_machine, read_run, write_whole
    from twin.foreign import mapped_run

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
    from twin.errors import BadFile
    from twin.files import parse_toml, read_machine

    head = "\n".join(ln.removeprefix("# ") for ln in text.splitlines() if ln.startswith("#"))
    named = parse_toml(head, args.map).get("machine")
    if not isinstance(named, str):
        raise BadFile(args.map, "head.machine", "nothing", "the machine file, or --machine")
    return read_machine(output.parent / named)


def _measured(args: argparse.Namespace, sheets: list[Sheet], output: Path) -> None:
    """A positioning test or a list of points."""
    from pathlib import Path

    import numpy as np

    from matstd.console import say
    from twin.files import refuse_to_overwrite, write_run, write_whole
    from twin.foreign import machine_text
    from twin.units import UM

    meaning = next(m for m in _SIGN if getattr(args, m))
    if args.positioning or args.component:
        measured, chain = _positioning(args, sheets[0])
    elif args.circle:
        measured, chain = _circle(args, sheets[0])
    elif args.arm:
        measured, chain = _arm(args, sheets[0])
    else:
        measured, chain = _points(args, sheets, meaning)
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


def _positioning(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A positioning test as a run."""
    from twin.errors import DesignError
    from twin.files import read_machine
    from twin.foreign import one_axis_machine, positioning_run, read_positioning
    from twin.units import UM, URAD

    name = args.component or ""
    axis = name[-1:] if name else args.positioning
    if name and not re.fullmatch("E[XYZABC][XYZ]", name):
        raise DesignError(f"--component {name}: expected a component error of X, Y or Z, as EYX")
    if axis not in tuple("XYZABC"):
        raise DesignError(f"--positioning {axis}: expected one of X Y Z A B C")
    test = read_positioning(sheet, axis, args.unit, (args.target, args.actual), name)
    u = _uncertainty(args, "u_urad", URAD) if test.is_angle else _uncertainty(args, "u_um", UM)
    _say_positioning(test)
    chain = read_machine(args.machine) if args.machine else one_axis_machine(axis, test.target)
    return positioning_run(test, chain, u), chain


def _say_positioning(test: PositioningTest) -> None:
    """Targets, directions, and the figures of the standard, which no model makes."""
    import numpy as np

    from matstd.console import say
    from twin.foreign import positioning_figures
    from twin.units import DEG, UM, URAD

    turns = test.axis in "ABC"
    low, high = (v / (DEG if turns else 1.0) for v in (test.target.min(), test.target.max()))
    up, down = (int((test.direction == s).sum()) for s in (1, -1))
    say(
        f"- {len(np.unique(test.target))} targets from {low:g} to {high:g}, "
        f"{len(np.unique(test.cycle))} cycles or strokes; {up} readings with {test.axis} growing, "
        f"{down} with it falling{', by the order of the rows' if test.is_by_order else ''}"
    )
    if not up and not down:
        say("- no direction of approach is stated (columns up and down): no reversal can be found")
    if not test.is_own:
        _say_component(test)
        return
    found = None if np.any(test.time) else positioning_figures(test)
    if found is not None:
        unit, name = (URAD, "µrad") if turns else (UM, "µm")
        say(
            f"- ISO 230-2: reversal B {found.reversal / unit:.3g} {name} "
            f"(mean {found.mean_reversal / unit:.3g}), M {found.mean_range / unit:.3g}, "
            f"E {found.systematic / unit:.3g}, R {found.repeatability / unit:.3g}, "
            f"A {found.accuracy / unit:.3g} {name}"
        )


def _say_component(test: PositioningTest) -> None:
    """Peak to valley of the mean curve, of a straightness about its line of least squares."""
    import numpy as np

    from matstd.console import say
    from twin.units import UM, URAD

    targets, of = np.unique(np.round(test.target, 6), return_inverse=True)
    mean = np.bincount(of.ravel(), test.deviation) / np.bincount(of.ravel())
    if test.is_angle:
        say(f"- angular error {test.component}: {np.ptp(mean) / URAD:.3g} µrad peak to valley")
        return
    left = mean - np.polyval(np.polyfit(targets, mean, 1), targets)
    say(
        f"- straightness {test.component}: {np.ptp(left) / UM:.3g} µm peak to valley about the "
        "line of least squares"
    )


def _circle(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A circular test as a run."""
    from matstd.console import say
    from twin.errors import DesignError
    from twin.files import read_machine
    from twin.foreign import circle_machine, circle_run, read_circle
    from twin.units import UM

    plane = args.circle.upper()
    if plane not in ("XY", "YZ", "ZX", "YX", "ZY", "XZ"):
        raise DesignError(f"--circle {args.circle}: expected two axes such as XY, YZ or ZX")
    for option, value in (("--radius", args.radius), ("--feed", args.feed)):
        if value is None and option == "--feed":
            continue
        if value is None or not 0.0 < value < 1e6:
            found = "not given" if value is None else f"{value:g}"
            raise DesignError(f"{option}: {found}; expected a number above 0")
    test = read_circle(sheet, plane, args.radius, args.unit)
    for run in dict.fromkeys(test.run):
        rows = test.run == run
        way = "from the first axis to the second" if test.sense[rows][0] > 0 else "the other way"
        say(f"- {run}: {int(rows.sum())} readings, {way}")
    if args.feed is None:
        say("- without --feed nothing is known of speeds: a servo lag cannot be told")
    chain = read_machine(args.machine) if args.machine else circle_machine(plane, args.radius)
    u = _uncertainty(args, "u_um", UM)
    if args.bar_force is not None and not abs(args.bar_force) <= 1e5:
        raise DesignError(f"--bar-force {args.bar_force:g}: expected at most 100000 N")
    return circle_run(test, chain, u, args.centre, args.feed, args.bar_force), chain


def _arm(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """An arm under a tracker as a run."""
    import numpy as np

    from matstd.console import say
    from twin.errors import DesignError
    from twin.files import read_machine
    from twin.foreign import arm_from_dh, joint_readings, read_sheet, tracker_run
    from twin.units import UM

    if bool(args.machine) == bool(args.dh):
        given = "both given" if args.dh else "neither given"
        raise DesignError(f"--machine, --dh: {given}; expected the arm by one of them")
    chain, turned = read_machine(args.machine) if args.machine else None, np.eye(3)
    q, columns = joint_readings(sheet, chain.programmed_axes if chain else ())
    if chain is None:
        chain, turned = arm_from_dh(read_sheet(args.dh), q, is_modified=args.modified)
    stated = None if args.reflector is None else turned @ np.array(args.reflector)
    measured = tracker_run(sheet, chain, q, _uncertainty(args, "u_um", UM), stated)
    pairs = zip(columns, chain.programmed_axes, strict=True)
    say(f"- axes: {', '.join(f'{column} is {axis}' for column, axis in pairs)}")
    at = ", ".join(f"{v:.3f}" for v in measured.touches.target[0])
    how = "found" if stated is None else "stated"
    say(f"- reflector at ({at}) mm of the tool frame, as {how}; the tracker's frame is the set-up")
    return measured, chain


def _points(args: argparse.Namespace, sheets: list[Sheet], meaning: str) -> tuple[Run, Chain]:
    """A list of points as a run."""
    from matstd.console import say
    from twin.files import read_machine
    from twin.foreign import joined_points, linear_machine, misplaced, points_run, read_points
    from twin.units import UM

    lists = [read_points(sheet, args.unit) for sheet in sheets]
    points = joined_points(lists, [sheet.path.stem for sheet in sheets])
    wrong = misplaced(points)
    if wrong:
        some = ", ".join(f"{own!r} at {other!r}" for own, other in wrong[:3])
        say(
            f"- {len(wrong)} of {len(points.line)} points were found nearer to the nominal place "
            f"of another point than to their own ({some}): names or their order are mixed up?"
        )
    chain = read_machine(args.machine) if args.machine else linear_machine(points)
    u = _uncertainty(args, "u_um", UM)
    return points_run(points, "part" if meaning == "part" else "standard", chain, u), chain


def _uncertainty(args: argparse.Namespace, name: str, unit: float) -> float:
    """The stated uncertainty of one reading; raises DesignError where none is stated."""
    from twin.errors import DesignError

    stated = getattr(args, name)
    option = f"--{name.replace('_', '-')}"
    if stated is None:
        raise DesignError(f"{option}: not given; expected the standard uncertainty of one reading")
    if not 1e-6 <= stated <= 1e5:
        raise DesignError(f"{option} {stated:g}: expected a number from 0.000001 to 100000")
    return float(stated * unit)
