"""What `matstd import` makes of each kind of table: a run, its machine, and words on both."""

import argparse
import re
from collections.abc import Callable

import numpy as np

from matstd.console import say
from matstd.importers import (
    Sheet,
    circle_machine,
    circle_run,
    import_arm,
    import_points,
    one_axis_machine,
    positioning_run,
    read_circle,
    read_positioning,
    read_sheet,
)
from matstd.importers.arms import oriented, read_arm
from matstd.importers.instruments import (
    CircleParameter,
    PositioningTest,
    circle_parameters,
    component_range,
    positioning_figures,
)
from matstd.importers.points import Meaning, read_points
from matstd.report.numbers import with_uncertainty
from matstd.twin.errors import DesignError
from matstd.twin.files import read_machine
from matstd.twin.machine import Chain
from matstd.twin.record import Run
from matstd.twin.units import DEG, UM, URAD


def readings_of(args: argparse.Namespace) -> tuple[Callable[[Sheet], int] | None, str]:
    """Number of readings of a table for this kind of import, and its axis.

    None with a mapping file, for which any table may be meant.
    """
    if args.component or args.positioning:
        name = args.component or ""
        axis = name[-1:] or args.positioning
        named = (args.target, args.actual)
        return lambda t: len(read_positioning(t, axis, args.unit, named, name).target), axis
    if args.circle:
        plane, radius = args.circle.upper(), args.radius or 1.0
        return lambda t: len(read_circle(t, plane, radius, args.unit).angle), ""
    if args.arm:
        return lambda t: int(read_arm(t).shots.sum()), ""
    if args.part or args.standard:
        return lambda t: len(read_points(t, args.unit).line), ""
    return None, ""


def positioning(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A test of one axis as a run."""
    name = args.component or ""
    axis = name[-1:] if name else args.positioning
    if name and not re.fullmatch("E[XYZABC][XYZ]", name):
        raise DesignError(f"--component {name}: expected a component error of X, Y or Z, as EYX")
    if axis not in tuple("XYZABC"):
        raise DesignError(f"--positioning {axis}: expected one of X Y Z A B C")
    test = read_positioning(sheet, axis, args.unit, (args.target, args.actual), name)
    u = _uncertainty(args, "u_urad", URAD) if test.is_angle else _uncertainty(args, "u_um", UM)
    _say_positioning(test)
    chain = _machine(args) or one_axis_machine(axis, test.target)
    return positioning_run(test, chain, u), chain


def _say_positioning(test: PositioningTest) -> None:
    """Targets, directions, and the figures of the standard, which no model makes."""
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
    unit, name = (URAD, "µrad") if test.is_angle else (UM, "µm")
    if not test.is_own:
        kind = "angular error" if test.is_angle else "straightness"
        about = "" if test.is_angle else " about the line of least squares"
        size = component_range(test) / unit
        say(f"- {kind} {test.component}: {size:.3g} {name} peak to valley{about}")
        return
    found = None if test.is_log else positioning_figures(test)
    if found is not None:
        say(
            f"- ISO 230-2: reversal B {found.reversal / unit:.3g} {name} "
            f"(mean {found.mean_reversal / unit:.3g}), M {found.mean_range / unit:.3g}, "
            f"E {found.systematic / unit:.3g}, R {found.repeatability / unit:.3g}, "
            f"A {found.accuracy / unit:.3g} {name}"
        )


def circle(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """A circular test as a run."""
    plane = args.circle.upper()
    if plane not in ("XY", "YZ", "ZX", "YX", "ZY", "XZ"):
        raise DesignError(f"--circle {args.circle}: expected two axes such as XY, YZ or ZX")
    if args.radius is None:
        raise DesignError("--radius: not given; expected a number above 0")
    for option, value in (("--radius", args.radius), ("--feed", args.feed)):
        if value is not None and not 0.0 < value < 1e6:
            raise DesignError(f"{option} {value:g}: expected a number above 0, below 1000000")
    if args.bar_force is not None and not abs(args.bar_force) <= 1e5:
        raise DesignError(f"--bar-force {args.bar_force:g}: expected at most 100000 N")
    test = read_circle(sheet, plane, args.radius, args.unit)
    for run in dict.fromkeys(test.run):
        rows = test.run == run
        way = "first axis to the second" if test.sense[rows][0] > 0 else "second axis to the first"
        say(f"- {run}: {int(rows.sum())} readings, from the {way}")
    if args.feed is None:
        say("- without --feed no speeds are known: a servo lag cannot be found")
    if words := [_circle_words(one) for one in circle_parameters(test)]:
        say(f"- ISO 230-4, if nothing else acts: {', '.join(words)}")
    chain = _machine(args) or circle_machine(plane, args.radius)
    u = _uncertainty(args, "u_um", UM)
    return circle_run(test, chain, u, args.centre, args.feed, args.bar_force), chain


def _circle_words(one: CircleParameter) -> str:
    """`squareness of X and Y -29.60 ± 0.29 µrad`."""
    unit, name = {"squareness": (URAD, "µrad"), "scale": (1e-6, "ppm")}.get(
        one.name.partition(" ")[0], (UM, "µm")
    )
    return f"{one.name} {with_uncertainty(one.value / unit, one.u / unit, name)}"


def arm(args: argparse.Namespace, sheet: Sheet) -> tuple[Run, Chain]:
    """An arm under a tracker as a run."""
    found = import_arm(
        sheet,
        _uncertainty(args, "u_um", UM),
        _machine(args),
        read_sheet(args.dh) if args.dh else None,
        is_modified=args.modified,
        couplings=args.coupled,
        reflector=args.reflector,
        u_angle=None if args.u_urad is None else _uncertainty(args, "u_urad", URAD),
    )
    pairs = zip(found.joints, found.chain.programmed_axes, strict=True)
    say(f"- axes: {', '.join(f'{column} is {axis}' for column, axis in pairs)}")
    how = "stated" if args.reflector else "found"
    for name, place in found.reflectors.items():
        at = ", ".join(f"{v:.3f}" for v in place)
        say(f"- {name} at ({at}) mm of the tool frame, as {how}")
    say("- the tracker's frame is the set-up")
    for name, moved in found.fixed.items():
        say(
            f"- {name} does not move with the arm (range {moved / UM:.3g} µm): its motion is "
            "imported as columns in µm and may drive effects"
        )
    if args.u_urad is None and oriented(sheet) is not None:
        say("- orientations of the target are not used: --u-urad states their standard uncertainty")
    if found.mistake is not None:
        words, left = found.mistake
        say(
            f"- the arm and its readings do not agree: {found.rms:.4g} mm rms are left as "
            f"described; {left:.4g} mm rms are left if {words}"
        )
    return found.run, found.chain


def points(args: argparse.Namespace, sheets: list[Sheet]) -> tuple[Run, Chain]:
    """Lists of points as a run."""
    meaning: Meaning = "part" if args.part else "standard"
    then = "brought back to the nominal one" if args.part else "the standard stands so"
    u = _uncertainty(args, "u_um", UM)
    found = import_points(sheets, meaning, u, _machine(args), args.unit)
    if found.misplaced:
        some = ", ".join(f"{own!r} at {other!r}" for own, other in found.misplaced[:3])
        say(
            f"- {len(found.misplaced)} of {found.count} points are closer to the nominal "
            f"position of another point than to their own ({some}): "
            "are names or their order mixed up?"
        )
    for f in found.frames:
        say(
            f"- points of {f.setup!r} were measured in another frame, turned by "
            f"{f.turn / DEG:.4g}° and {f.shift:.4g} mm away: {then}"
        )
    return found.run, found.chain


def _machine(args: argparse.Namespace) -> Chain | None:
    """The machine of `--machine`, None where it is not given."""
    return read_machine(args.machine) if args.machine else None


def _uncertainty(args: argparse.Namespace, name: str, unit: float) -> float:
    """The stated uncertainty of one reading; raises DesignError where none is stated."""
    stated = getattr(args, name)
    option = f"--{name.replace('_', '-')}"
    if stated is None:
        raise DesignError(f"{option}: not given; expected the standard uncertainty of one reading")
    if not 1e-6 <= stated <= 1e5:
        raise DesignError(f"{option} {stated:g}: expected a number from 0.000001 to 100000")
    return float(stated * unit)
