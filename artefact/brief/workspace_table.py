"""Workspace of a project file: ranges of readings, in the units of axes."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matstd.twin.errors import BadFile, UnknownAxis
from matstd.twin.machine import Chain
from matstd.twin.units import DEG, meant_in_radians

MAX_READING = 1e6
"""Largest plausible reading, mm or degrees; larger integers may not convert to floats."""

LEAST_WORKSPACE = 5.0
"""Smallest range of a linear axis that is of interest, mm: less is one in metres."""


def workspace_ranges(
    stated: Mapping[str, Any], chain: Chain, path: Path
) -> tuple[dict[str, tuple[float, float]], int]:
    """Ranges of readings in base units, and the number of poses; raises BadFile."""
    given = dict(stated)
    poses = given.pop("poses", 2000)
    if not isinstance(poses, int) or not 100 <= poses <= 100_000:
        raise BadFile(path, "workspace.poses", repr(poses), "a whole number, 100 to 100000")
    out = {axis: chain.link(axis).range for axis in chain.programmed_axes}
    for axis, pair in given.items():
        if axis not in chain.programmed_axes:
            raise BadFile.of(path, UnknownAxis(axis, chain.programmed_axes), within="workspace")
        low, high = _pair(pair, path, f"workspace.{axis}")
        factor = 1.0 if chain.link(axis).kind == "linear" else DEG
        travel = chain.link(axis).range
        if low * factor < travel[0] or high * factor > travel[1]:
            raise BadFile(
                path,
                f"workspace.{axis}",
                [low, high],
                f"within the travel {travel[0] / factor:g} to {travel[1] / factor:g}",
            )
        _check_unit(axis, (low, high), (travel[0] / factor, travel[1] / factor), path)
        out[axis] = (low * factor, high * factor)
    return out, poses


def _check_unit(
    axis: str, stated: tuple[float, float], travel: tuple[float, float], path: Path
) -> None:
    """Refuse a workspace in metres or radians; units of the file."""
    low, high = stated
    key, found = f"workspace.{axis}", [low, high]
    width = f"{high - low:.3g}"
    if axis[0] in "ABC":
        meant = meant_in_radians(low, high)
        if meant is not None and travel[0] <= meant[0] and meant[1] <= travel[1]:
            ends = f"[{meant[0]:g}, {meant[1]:g}]"
            raise BadFile(path, key, found, f"degrees, not {width}; is it in radians, {ends}?")
    elif 0.0 < high - low < LEAST_WORKSPACE:
        ends = f"[{1e3 * low:g}, {1e3 * high:g}]"
        raise BadFile(path, key, found, f"mm, not {width} of them; is it in metres, {ends}?")


def _pair(value: Any, path: Path, key: str) -> tuple[float, float]:
    """Two finite numbers, the smaller first."""
    is_pair = isinstance(value, list) and len(value) == 2
    if not is_pair or not all(type(v) in (int, float) and abs(v) < MAX_READING for v in value):
        raise BadFile(path, key, repr(value), "two numbers")
    low, high = float(value[0]), float(value[1])
    if not low <= high:
        raise BadFile(path, key, [low, high], "the smaller number first")
    return low, high
