"""What `matstd import` makes of each kind of table: a run, its machine, and words on both."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse

    from matstd.importers.instruments import PositioningTest
    from matstd.importers.sheets import Sheet
    from matstd.twin.frames import Array
    from matstd.twin.machine import Chain
    from matstd.twin.record import Run


def positioning(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A positioning test as a run."""
    from matstd.importers import one_axis_machine, positioning_run, read_positioning
    from matstd.twin.errors import DesignError
    from matstd.twin.files import read_machine
    from matstd.twin.units import UM, URAD

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
    from matstd.importers.instruments import positioning_figures
    from matstd.twin.units import DEG, UM, URAD

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
    from matstd.twin.units import UM, URAD

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


def circle(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A circular test as a run."""
    from matstd.console import say
    from matstd.importers import circle_machine, circle_run, read_circle
    from matstd.twin.errors import DesignError
    from matstd.twin.files import read_machine
    from matstd.twin.units import UM

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
        say("- without --feed speeds are unknown: a servo lag cannot be distinguished")
    chain = read_machine(args.machine) if args.machine else circle_machine(plane, args.radius)
    u = _uncertainty(args, "u_um", UM)
    if args.bar_force is not None and not abs(args.bar_force) <= 1e5:
        raise DesignError(f"--bar-force {args.bar_force:g}: expected at most 100000 N")
    return circle_run(test, chain, u, args.centre, args.feed, args.bar_force), chain


def arm(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """An arm under a tracker as a run."""
    import numpy as np

    from matstd.console import say
    from matstd.importers.arms import (
        arm_from_dh,
        coupled,
        joint_readings,
        likely_mistake,
        misfit,
        tracker_run,
    )
    from matstd.importers.sheets import read_sheet
    from matstd.twin.errors import DesignError
    from matstd.twin.files import read_machine
    from matstd.twin.units import UM

    if bool(args.machine) == bool(args.dh):
        given = "both given" if args.dh else "neither given"
        raise DesignError(f"--machine, --dh: {given}; expected the arm by one of them")
    chain, turned = read_machine(args.machine) if args.machine else None, np.eye(3)
    q, columns = joint_readings(sheet, chain.programmed_axes if chain else ())
    for how in args.coupled:
        q = coupled(q, how)
    dh = read_sheet(args.dh) if args.dh else None
    if chain is None:
        assert dh is not None
        chain, turned = arm_from_dh(dh, q, is_modified=args.modified)
    stated = None if args.reflector is None else turned @ np.array(args.reflector)
    u = _uncertainty(args, "u_um", UM)

    def left(arm: Chain, readings: Array) -> float:
        return misfit(sheet, arm, readings, u, stated, columns)

    other = None if dh is None else arm_from_dh(dh, q, is_modified=not args.modified)[0]
    mistake = likely_mistake(q, chain, other, left)
    likely = f"{mistake[1]:.4g} mm rms are left if {mistake[0]}" if mistake else ""
    try:
        measured = tracker_run(sheet, chain, q, u, stated, columns)
    except DesignError as refusal:
        if not likely:
            raise
        raise DesignError(f"{refusal}; {likely}") from refusal
    pairs = zip(columns, chain.programmed_axes, strict=True)
    say(f"- axes: {', '.join(f'{column} is {axis}' for column, axis in pairs)}")
    targets = dict(zip(measured.touches.feature, measured.touches.target, strict=True))
    for name, target in sorted(targets.items()):
        at = ", ".join(f"{v:.3f}" for v in target)
        say(
            f"- {name} at ({at}) mm of the tool frame, as {'stated' if args.reflector else 'found'}"
        )
    say("- the tracker's frame is the set-up")
    if likely:
        say(
            f"- the arm and its readings do not agree: {left(chain, q):.4g} mm rms are left as "
            f"described; {likely}"
        )
    return measured, chain


def points(args: argparse.Namespace, sheets: list[Sheet], meaning: str) -> tuple[Run, Chain]:
    """A list of points as a run."""
    from matstd.console import say
    from matstd.importers.points import (
        in_measured_frame,
        in_nominal_frame,
        joined_points,
        linear_machine,
        measured_frames,
        misplaced,
        points_run,
        read_points,
    )
    from matstd.twin.files import read_machine
    from matstd.twin.units import DEG, UM

    lists = [read_points(sheet, args.unit) for sheet in sheets]
    points = joined_points(lists, [sheet.path.stem for sheet in sheets])
    frames = measured_frames(points)
    wrong = misplaced(in_nominal_frame(points, frames))
    if wrong:
        some = ", ".join(f"{own!r} at {other!r}" for own, other in wrong[:3])
        say(
            f"- {len(wrong)} of {len(points.line)} points are closer to the nominal position "
            f"of another point than to their own ({some}): names or their order are mixed up?"
        )
    frames = [f for f in frames if f.is_far]
    is_part = meaning == "part"
    points = (in_nominal_frame if is_part else in_measured_frame)(points, frames)
    for f in frames:
        say(
            f"- points of {f.setup!r} were measured in another frame, turned by "
            f"{f.turn / DEG:.4g}° and {f.shift:.4g} mm away: "
            + ("brought back to the nominal one" if is_part else "the standard stands so")
        )
    frames = [] if is_part else frames
    chain = read_machine(args.machine) if args.machine else linear_machine(points, frames)
    u = _uncertainty(args, "u_um", UM)
    return points_run(points, "part" if is_part else "standard", chain, u, frames), chain


def _uncertainty(args: argparse.Namespace, name: str, unit: float) -> float:
    """The stated uncertainty of one reading; raises DesignError where none is stated."""
    from matstd.twin.errors import DesignError

    stated = getattr(args, name)
    option = f"--{name.replace('_', '-')}"
    if stated is None:
        raise DesignError(f"{option}: not given; expected the standard uncertainty of one reading")
    if not 1e-6 <= stated <= 1e5:
        raise DesignError(f"{option} {stated:g}: expected a number from 0.000001 to 100000")
    return float(stated * unit)
