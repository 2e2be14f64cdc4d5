"""Labels and ends of scales: columns of a run, axes of a machine, names of effects."""

import numpy as np

from matstd.report.numbers import noun, time_unit, unit_of
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG


def axis_title(link: Link) -> str:
    """Axis as the chain notation writes it."""
    if link.kind == "fixed":
        return "workpiece" if link.carries_workpiece else "tool"
    name = link.name + ("'" if link.carries_workpiece else "")
    return name if link.programmed else f"({name})"


def reading_label(chain: Chain, axis: str) -> tuple[str, float]:
    """Label of a reading and what one shown unit of it is."""
    return (f"{axis} in mm", 1.0) if chain.link(axis).kind == "linear" else (f"{axis} in °", DEG)


def axis_of(column: str, values: Array) -> tuple[str, Array]:
    """Label of an axis for a column of a run file, and its values in the unit of the label.

    Example:
        >>> axis_of("B_deg", np.array([-90.0, 0.0]))[0], axis_of("time_s", np.array([0.0, 9e4]))[0]
        ('B in °', 'time in h')
    """
    if column == "time_s":
        # two days are clearer in hours than in days: the axis has room for two digits
        factor, unit = time_unit(min(float(np.max(np.abs(values), initial=1.0)), 86400.0))
        return f"time in {unit}", values / factor
    unit = unit_of(column).replace("deg", "°")
    return (f"{noun(column)} in {unit}" if unit else noun(column)), values


def robust_limit(values: Array, share: float = 0.99) -> float:
    """End of a symmetric scale that a few large values do not decide; 1 where all are zero."""
    limit = float(np.quantile(np.abs(values), share)) if len(values) else 0.0
    return limit or 1.0
