"""Task file (TOML, format "task/1"): surfaces that are measured, poses and tolerance."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from matstd.twin.errors import BadFile
from matstd.twin.files import Table, checked, read_toml, refuse_unit_slips
from matstd.twin.units import DEG, UM

Range = Annotated[list[float], Field(min_length=2, max_length=2)]


class WorkpieceTable(Table):
    """`[workpiece]`: how workpieces differ from the calibrated standard."""

    form_um: float = Field(default=0.0, ge=0.0)
    """standard uncertainty due to form, roughness, dirt"""
    length_mm: float = Field(default=0.0, ge=0.0)
    """length that expands between datum and surface"""
    warmer: float = Field(default=0.0, alias="warmer_K", ge=0.0)
    """difference of the workpieces from 20 °C, or from the temperature to which their scale is
    corrected, K"""
    expansion_u: float = Field(default=1e-6, alias="expansion_u_1_K", ge=0.0, lt=1e-3)
    """standard uncertainty of their coefficient of expansion, 1/K"""


class TaskTable(Table):
    """The whole file."""

    format: str = Field(examples=["task/1"])
    """kind and version of the file, `"task/1"`"""
    name: str = Field(examples=["pockets"])
    """name of the task"""
    tolerance_um: float | None = Field(default=None, gt=0.0, examples=[20.0])
    """width of the tolerance zone of the surface's profile (ISO 1660), half of it to either
    side"""
    slope_deg: Range = Field(default=[0.0, 180.0])
    """smallest and largest angle between the normal and the workpiece's z"""
    curvature_1_m: Range = Field(default=[0.0, 1e6])
    """smallest and largest of the larger principal curvature, concave or convex, 1/m"""
    poses: dict[str, Range] = Field(default_factory=dict)
    """smallest and largest reading of rotary axes: `A_deg`, `B_deg`, `C_deg`"""
    workpiece: WorkpieceTable = WorkpieceTable()
    """differences between workpieces and the standard: u_w"""


@dataclass(frozen=True)
class Task:
    """A measuring task: surfaces, table poses and tolerance."""

    name: str = "every touch on the freeform faces"
    # smallest and largest angle of a normal to the workpiece's z, rad
    slope: tuple[float, float] = (0.0, np.pi)
    # range of the largest absolute principal curvature, 1/mm
    curvature: tuple[float, float] = (0.0, np.inf)
    # ranges of rotary readings by letter, rad; other axes are free
    rotary: dict[str, tuple[float, float]] = field(default_factory=dict)
    # width of the profile tolerance zone, symmetric to the surface, mm; None for none
    tolerance: float | None = None
    u_w: float = 0.0  # standard uncertainty contributed by the workpieces, mm


def read_task(path: str | Path) -> Task:
    """Read a task; raises BadFile with the key, what stood there and what was expected."""
    file = checked(TaskTable, read_toml(path, "task/1"), path)
    refuse_unit_slips(file, path)
    ranges = {"slope_deg": file.slope_deg, "curvature_1_m": file.curvature_1_m}
    for key, (low, high) in (ranges | {f"poses.{k}": v for k, v in file.poses.items()}).items():
        if low > high or (low < 0.0 and not key.startswith("poses")):
            raise BadFile(path, key, [low, high], "smallest and largest, in this order")
    rotary = {}
    for key, (low, high) in file.poses.items():
        letter, _, unit = key.partition("_")
        if letter not in ("A", "B", "C") or unit != "deg":
            raise BadFile(path, f"poses.{key}", key, "rotary axes: A_deg, B_deg or C_deg")
        rotary[letter] = (low * DEG, high * DEG)
    piece = file.workpiece
    expands = piece.length_mm * piece.warmer * piece.expansion_u
    return Task(
        name=file.name,
        slope=(file.slope_deg[0] * DEG, file.slope_deg[1] * DEG),
        curvature=(file.curvature_1_m[0] * 1e-3, file.curvature_1_m[1] * 1e-3),
        rotary=rotary,
        tolerance=None if file.tolerance_um is None else file.tolerance_um * UM,
        u_w=float(np.hypot(piece.form_um * UM, expands)),
    )
