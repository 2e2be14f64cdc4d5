"""Numbers to copy into a machine file or into the head of a run, as the run has them."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.faults import DescriptionFault, Fault
from diagnosis.geometry import Correction, GeometryRow, LearntGeometry
from report.geometry.geometry_words import correction_line
from twin.machine import LETTERS, Chain
from twin.record import Touches


def copy_lines(
    touches: Touches, geometry: LearntGeometry | None, faults: Sequence[DescriptionFault]
) -> list[str]:
    """What would have to stand in the files: mistakes undone, and lines of axes far from theirs.

    Errors of a usual size are left to the model, which knows them better than a machine file can.

    Args:
        touches: Of the run, as it is described.
        geometry: What was learnt of it; None where it could not be fitted.
        faults: Mistakes that were named, each with those that look alike.
    """
    found = [c for f in faults for one in (f, *f.alike) for c in _undone(touches, one)]
    if geometry is None:
        return _told(found)
    keys = {c.key for c in found}
    far = {_key(row) for row in geometry.rows if row.is_beyond_expected}
    found += [c for c in geometry.corrections if c.key not in keys and c.key in far]
    return _told(found)


def _told(found: Sequence[Correction]) -> list[str]:
    return [f"to copy: {correction_line(c)}" for c in found]


def _key(row: GeometryRow) -> str:
    """The key of a machine file that a line or a squareness would be put right in."""
    return f"axis.{row.axes[-1]}.{'direction' if row.symbol[1] in 'ABC' else 'point'}"


def _undone(touches: Touches, fault: DescriptionFault) -> Iterator[Correction]:
    """The keys that a mistake stands in, where it is a number or a direction."""
    match fault.fault:
        case Fault.TOOL_LENGTH:
            yield _number("probe.length_mm", float(np.median(touches.length)), fault)
        case Fault.BALL_RADIUS:
            yield _number("probe.radius_mm", float(np.median(touches.radius)), fault)
        case Fault.PIVOT:
            yield _point(touches.chain, fault)
        case Fault.AXIS_REVERSED:
            for axis in fault.axes:
                d = tuple(float(v) for v in touches.chain.link(axis).direction)
                found = tuple(0.0 - v for v in d)
                yield Correction(f"axis.{axis}.direction", d, found, (None,) * len(d))


def _number(key: str, stated: float, fault: DescriptionFault) -> Correction:
    (number,) = fault.numbers
    return Correction(key, (stated,), (stated + number.change,), (number.u,))


def _point(chain: Chain, fault: DescriptionFault) -> Correction:
    stated = tuple(float(v) for v in chain.link(fault.axes[0]).point)
    moved = {LETTERS.index(n.name[1]): n for n in fault.numbers}
    return Correction(
        key=f"axis.{fault.axes[0]}.point",
        stated=stated,
        found=tuple(v + (moved[i].change if i in moved else 0.0) for i, v in enumerate(stated)),
        u=tuple(moved[i].u if i in moved else None for i in range(3)),
    )
