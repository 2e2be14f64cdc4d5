"""Machine file (TOML, "machine/1"): a chain in ISO notation and what is known of each axis."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from matstd.twin.errors import BadFile, BadValue, UnknownAxis
from matstd.twin.files.keys import Table, checked
from matstd.twin.files.slips import machine_questions, machine_slips, refuse_unit_slips
from matstd.twin.files.toml import is_file, read_toml
from matstd.twin.machine import Axis, Chain, make_chain
from matstd.twin.units import DEG

KILOMETRE = 1e6  # in mm: nothing of a machine lies, and no axis travels, farther; degrees neither

Coordinate = Annotated[float, Field(ge=-KILOMETRE, le=KILOMETRE)]
Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]  # TOML has lists
Pair = Annotated[tuple[float, float], Strict(False)]
Range = Annotated[tuple[Coordinate, Coordinate], Strict(False)]


class AxisTable(Table):
    """`[axis.X]`: range in mm or degrees, point, pitch and expected errors in mm, direction."""

    range: Range | None = Field(default=None, examples=[[-200.0, 200.0]])
    """smallest and largest reading, mm or degrees; needed for every axis that is programmed"""
    point: Vector | None = Field(default=None, examples=[[0.0, 0.0, -420.0]])
    """reference point of the angular errors of a linear axis, a point on the line of a rotary one:
    mm, machine frame, every axis at zero. Default: the machine origin, with a remark for a rotary
    axis"""
    direction: Vector | None = Field(default=None, examples=[[0.0, 0.0, 1.0]])
    """direction of travel or of the line, machine frame, along which or about which errors of the
    axis's own letter act ([conventions](../conventions.md#errors)). Default: that of the letter"""
    pitch: float | None = Field(default=None, examples=[10.0])
    """pitch of the screw or scale of a linear axis, mm. `diagnose` searches for errors at it and
    at its whole fractions even if the targets are too far apart to resolve them, and prefers them
    among periods that the targets cannot distinguish. `diagnose --pitch X=10` has the same
    effect"""
    expected: float | None = Field(default=None, examples=[0.01])
    """usual size of each translational error of a linear axis (EXX, EYX, EZX), mm. An error that
    exceeds it significantly is reported as larger than expected; a fit is as free as the class of
    the error permits. Default: that of the class, 77 µm. `matstd import` writes 1 µm and 15 ppm of
    the travel"""

    def axis(self, name: str) -> Axis:
        """What the table says of the axis of that name, base units."""
        factor = DEG if name[:1] in "ABC" else 1.0
        low, high = self.range or (0.0, 0.0)
        travel = None if self.range is None else (low * factor, high * factor)
        return Axis(
            range=travel,
            point=self.point,
            direction=self.direction,
            pitch=self.pitch,
            expected=self.expected,
        )


class WorkpieceTable(Table):
    """`[workpiece]`: origin of the table frame, mm."""

    origin: Vector = (0.0, 0.0, 0.0)
    """origin of the table frame, mm, machine frame, every axis at zero"""


class MachineTables(Table):
    """A machine as it stands in its own file and in model files."""

    name: str = Field(examples=["Small mill"])
    """name of the machine, for reports"""
    chain: str = Field(examples=["[w C' B' X' f Y Z (C1) t]"])
    """ISO notation from workpiece `w` over foundation `f` to tool `t`; a prime marks an axis that
    carries the workpiece, brackets a spindle whose angle is not programmed, or an axis that stays
    at zero, such as a quill `(W)` beside Z"""
    axis: dict[str, AxisTable]
    """a table `[axis.X]` for every programmed axis"""
    workpiece: WorkpieceTable = WorkpieceTable()
    """the table `[workpiece]`"""

    def made(self, path: str | Path, within: str = "") -> Chain:
        """The machine in base units; raises BadFile, with the key `within` of these tables."""
        axes = {name: table.axis(name) for name, table in self.axis.items()}
        try:
            return make_chain(self.name, self.chain, axes, self.workpiece.origin)
        except UnknownAxis as error:
            raise BadFile.of(path, error, within, f"axis.{error.facts['key']}") from error
        except BadValue as error:
            raise BadFile.of(path, error, within=within) from error


class MachineFile(MachineTables):
    """The whole file."""

    format: str = Field(examples=["machine/1"])
    """kind and version of the file, `"machine/1"`"""
    bodies: dict[str, str] | None = None
    """drawings of the bodies of the machine for `matstd show`. The key is a link (an axis, `w`,
    `t`, or `f` for the foundation), the value an STL, OBJ, PLY or STEP file seen from the machine
    file, in mm, machine frame with every axis at zero. Links without a drawing are plain solids.
    No result depends on it"""
    confirmed: list[str] = Field(default_factory=list, examples=[["workpiece.origin"]])
    """keys of this file whose values look like a mistake and are meant, such as a table beside the
    line about which it turns; they are not asked about"""


def read_machine(path: str | Path, named_in: str | Path | None = None) -> Chain:
    """Machine from its file; raises BadFile.

    Args:
        named_in: File that names it by a path relative to itself; None for a path as it is.
    """
    if named_in is not None:
        named, path = path, Path(named_in).parent / path
        if not is_file(path):
            found = f"{str(named)!r}, and {path} is no file"
            expected = "the path of a machine file, relative to this file"
            raise BadFile(named_in, "machine", found, expected)
    tables = checked(MachineFile, read_toml(path, "machine/1"), path)
    chain = tables.made(path)
    if slips := [BadFile.of(path, slip) for slip in machine_slips(chain)]:
        raise BadFile.several(slips)
    is_placed = "workpiece" in tables.model_fields_set
    questions = (BadFile.of(path, one) for one in machine_questions(chain, is_placed))
    refuse_unit_slips(tables, path, questions, tables.confirmed)
    known, drawings = ["f", *(link.name for link in chain.links)], tables.bodies or {}
    for name in drawings:
        if name not in known:
            raise BadFile(path, "bodies", name, f"one of {', '.join(known)}")
    # a drawing is seen from the machine file
    return replace(chain, drawings={name: Path(path).parent / d for name, d in drawings.items()})
