"""Arms from tables of Denavit and Hartenberg's parameters."""

import re
from collections.abc import Sequence

import numpy as np

from matstd.importers.sheets import ANGLES, MM, Sheet
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, pose, rotation
from matstd.twin.machine import Axis, Chain, make_chain
from matstd.twin.units import DEG

_COLUMNS = {
    "a": re.compile(r"\Aa\b", re.IGNORECASE),
    "alpha": re.compile(r"alpha|α", re.IGNORECASE),
    "d": re.compile(r"\Ad\b", re.IGNORECASE),
    "theta": re.compile(r"theta|offset|θ", re.IGNORECASE),
}

_LIMITS = {
    "min": re.compile(r"\b(min|lower|low)", re.IGNORECASE),
    "max": re.compile(r"\b(max|upper|high)", re.IGNORECASE),
}
"""Columns of the limits of the joints."""

LIMIT_TOLERANCE = 0.5 * DEG  # by which a reading may lie beyond a limit


def arm_from_dh(sheet: Sheet, readings: Array, is_modified: bool = False) -> tuple[Chain, Array]:
    """An arm from a table of Denavit and Hartenberg's parameters, one row per joint.

    The machine frame has the directions of the base and its origin at the flange with every joint
    at zero; the table frame is the base. An axis gets the letter of the direction that its line is
    nearest to, and that line as its direction.

    Args:
        sheet: Columns a and d in mm, alpha and theta (its offset at reading zero) in degrees,
            unless their names say other units.
        readings: Readings of the joints, (N, J), rad. Travels are those of `min` and `max`, without
            them half a turn either way, or whole turns where readings go beyond.
        is_modified: Whether a joint turns about z of its own frame (Craig), and not about that of
            the frame before it.

    Returns:
        The arm, and the rotation R (3, 3) that takes flange to tool coordinates.

    Raises:
        BadFile: A missing column, or another number of rows than of joints.

    Reference:
        Denavit and Hartenberg 1955; Craig, Introduction to Robotics (modified parameters).
    """
    a, alpha, d, theta = (_parameter(sheet, name) for name in _COLUMNS)
    if len(a) != readings.shape[1]:
        found = f"{len(a)} rows for {readings.shape[1]} columns of joints"
        raise BadFile(sheet.path, "table", found, "a row a joint")
    travels = _travels(sheet, readings)
    # an axis is the z of the frame before its own rotation: modified parameters first go across
    T, origins, lines = np.eye(4), [], []
    ex, ez = np.eye(3)[0], np.eye(3)[2]
    for i in range(len(a)):
        across = pose(rotation(alpha[i] * ex), a[i] * ex)
        along = pose(rotation(theta[i] * ez), d[i] * ez)
        T = T @ across if is_modified else T
        origins.append(T[:3, 3])
        lines.append(T[:3, 2])
        T = T @ along if is_modified else T @ along @ across
    flange = T[:3, 3]
    names = _names(lines)
    axes = {
        name: Axis(
            range=travels[i], point=_triple(origins[i] - flange), direction=_triple(lines[i])
        )
        for i, name in enumerate(names)
    }
    chain = make_chain("arm", f"[w f {' '.join(names)} t]", axes, _triple(-flange))
    return chain, T[:3, :3]


def _parameter(sheet: Sheet, name: str) -> Array:
    """One parameter of every joint, mm or rad."""
    column = sheet.find(_COLUMNS[name])
    if column is None:
        raise sheet.lacking(f"a column {name} among {', '.join(_COLUMNS)}")
    is_angle = name in ("alpha", "theta")
    values = sheet.quantity(column, ANGLES if is_angle else MM, "deg" if is_angle else "mm")
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise sheet.bad(row, column, "nothing", "a number for every joint")
    return values


def _names(lines: Sequence[Array]) -> list[str]:
    """Letters of axes about some lines, numbered where one comes again."""
    out: list[str] = []
    for line in lines:
        letter = "ABC"[int(np.argmax(np.abs(line)))]
        count = sum(name[0] == letter for name in out)
        out.append(f"{letter}{count}" if count else letter)
    return out


def _travels(sheet: Sheet, readings: Array) -> list[tuple[float, float]]:
    """Travel of every joint, rad; raises BadFile for one limit alone, or readings beyond them."""
    low, high = (sheet.find(_LIMITS[end]) for end in ("min", "max"))
    if low is None and high is None:
        # another log of the same arm has other poses: those of one are no limits
        turns = np.ceil(np.abs(readings).max(axis=0, initial=0.0) / np.pi - 1e-9)
        reach = np.pi * np.maximum(turns, 1.0)
        return [(-float(r), float(r)) for r in reach]
    if low is None or high is None:
        raise sheet.lacking("both limits of the joints, min and max")
    ends = [sheet.quantity(column, ANGLES, "deg") for column in (low, high)]
    for i, (a, b) in enumerate(zip(*ends, strict=True)):
        if not a < b:
            raise sheet.bad(i, low, f"{a / DEG:g} to {b / DEG:g} degrees", "min below max")
        found = readings[:, i].min(), readings[:, i].max()
        if found[0] < a - LIMIT_TOLERANCE or found[1] > b + LIMIT_TOLERANCE:
            shown = f"readings from {found[0] / DEG:g} to {found[1] / DEG:g} degrees"
            raise sheet.bad(i, low, shown, f"the travel, {a / DEG:g} to {b / DEG:g} degrees")
    return [(float(a), float(b)) for a, b in zip(*ends, strict=True)]


def _triple(v: Array) -> tuple[float, float, float]:
    x, y, z = (float(c) for c in np.round(v, 12) + 0.0)
    return x, y, z
