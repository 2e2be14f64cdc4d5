"""Numbers to copy into a machine file or a run, with those that explain the run equally."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.faults import DescriptionFault, Fault
from matstd.diagnosis.geometry import (
    Correction,
    FoundNumber,
    LearntGeometry,
    key_of,
    moved_point,
    turned_direction,
)
from matstd.report.geometry.geometry_words import correction_line
from matstd.report.numbers import with_uncertainty
from matstd.twin.machine import LETTERS
from matstd.twin.record import Touches
from matstd.twin.units import DEG


@dataclass(frozen=True, slots=True)
class Way:
    """One way to put a description right."""

    key: str  # key of the file, or the error that does the same where no key states it
    line: str  # what to write, or what is wrong


def copy_lines(
    touches: Touches, geometry: LearntGeometry | None, faults: Sequence[DescriptionFault]
) -> list[str]:
    """Corrections of the files: mistakes, and lines of axes far from their stated position.

    Errors of a usual size belong into the model, which describes them better than a machine file.
    Where several numbers explain the run equally, none of them alone can be recommended. Columns or
    axes that are wrong altogether leave nothing of the geometry that was estimated with them.

    Args:
        geometry: Estimated from it; None where it could not be fitted.
        faults: Mistakes in the description, each with its alternatives.
    """
    if any(not fault.numbers and fault.fault is not Fault.MINUTES for fault in faults):
        geometry = None
    corrections = {} if geometry is None else {c.key: c for c in geometry.corrections}
    rows = () if geometry is None else geometry.rows
    groups = [[w for one in (f, *f.alike) for w in _undone(touches, one)] for f in faults]
    listed = {way.key for group in groups for way in group}
    far = dict.fromkeys(key_of(row) for row in rows if row.is_beyond_expected or row.is_far)
    keys = [key for key in far if key in corrections]
    if geometry is not None and geometry.together:
        lines = " together with ".join(correction_line(corrections[key]) for key in keys)
        same = [group for group in groups if any(way.key in far for way in group)]
        single = [way for group in same for way in group if way.key not in far]
        groups = [group for group in groups if group not in same]
        groups.append([Way("", lines), *single, *(_way(touches, (n,)) for n in geometry.together)])
        listed |= set(keys)
    for key in keys:
        if key not in listed:
            groups.append([Way(key, correction_line(corrections[key]))])
            listed |= {key, *(w.key for w in _rivals(touches, corrections[key]))}
    return [_alternatives(touches, group, corrections) for group in groups if group]


def file_lines(touches: Touches, geometry: LearntGeometry) -> list[str]:
    """All corrections of the machine file; below each, those that explain the run equally."""
    out = []
    for correction in geometry.corrections:
        out.append(correction_line(correction))
        out += [f"# or {way.line}" for way in _rivals(touches, correction)]
    return out


def _alternatives(
    touches: Touches, group: Sequence[Way], corrections: Mapping[str, Correction]
) -> str:
    """Ways to correct one mistake, with all that the run does not distinguish from them."""
    ways = {way.key: way.line for way in group}
    for way in group:
        if way.key in corrections:
            for rival in _rivals(touches, corrections[way.key]):
                ways.setdefault(rival.key, rival.line)
    alike = "this run cannot distinguish these; one of them is wrong, copy one at most: "
    first, *others = ways.values()
    return alike + "; or ".join([first, *others]) if others else f"to copy: {first}"


def _rivals(touches: Touches, correction: Correction) -> Iterator[Way]:
    for number in correction.rivals:
        yield _way(touches, (number,))


def _undone(touches: Touches, fault: DescriptionFault) -> Iterator[Way]:
    """The correction of a mistake in a number or a direction."""
    if fault.fault is Fault.AXIS_REVERSED:
        for axis in fault.axes:
            d = tuple(float(v) for v in touches.chain.link(axis).direction)
            found = tuple(0.0 - v for v in d)
            yield _line(Correction(f"axis.{axis}.direction", d, found, (None,) * len(d)))
    elif fault.numbers:
        yield _way(touches, fault.numbers)


def _way(touches: Touches, numbers: Sequence[FoundNumber]) -> Way:
    """Numbers that are wrong together, as a line of a file where one states them."""
    number, name = numbers[0], numbers[0].name
    if name in ("length", "radius"):
        stated = float(np.median(getattr(touches, name)))
        found = (stated + number.change,)
        return _line(Correction(f"probe.{name}_mm", (stated,), found, (number.u,)))
    size = with_uncertainty(number.change, number.u, "mm")
    if name[3:] == "t":
        return Way(name, f"the ball is {size} off the tool axis in {name[1]}")
    axis = name[3:]
    link = touches.chain.link(axis)
    if LETTERS.index(name[1]) == link.own_component:
        if link.kind == "rotary":
            size = with_uncertainty(number.change / DEG, number.u / DEG, "°")
        return Way(name, f"the zero of {axis} is wrong by {size}")
    if name[1] in "ABC":
        turned = {LETTERS.index(name[1]) - 3: (number.change, number.u)}
        return _line(turned_direction(link, turned))
    moved = {LETTERS.index(n.name[1]): (n.change, n.u) for n in numbers}
    return _line(moved_point(link, moved))


def _line(correction: Correction) -> Way:
    return Way(correction.key, correction_line(correction))
