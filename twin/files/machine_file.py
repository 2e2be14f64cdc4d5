"""Machine file (TOML, "machine/1"): a chain in ISO notation and what is known of each axis."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from matstd.twin.errors import BadFile, BadValue, UnknownAxis
from matstd.twin.files.toml import Table, check_format, checked, parse_toml, read_text
from matstd.twin.machine import Axis, Chain, make_chain
from matstd.twin.units import DEG

KILOMETRE = 1e6
"""In mm: nothing of a machine lies, and no axis travels, farther; degrees neither."""

Coordinate = Annotated[float, Field(ge=-KILOMETRE, le=KILOMETRE)]
Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]  # TOML has lists
Pair = Annotated[tuple[float, float], Strict(False)]
Range = Annotated[tuple[Coordinate, Coordinate], Strict(False)]


class AxisTable(Table):
    """`[axis.X]`: range in mm or degrees, point, pitch and expected errors in mm, direction."""

    range: Range | None = None
    point: Vector | None = None
    direction: Vector | None = None
    pitch: float | None = None
    expected: float | None = None

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


class MachineTables(Table):
    """A machine as it stands in its own file and in model files."""

    name: str
    chain: str
    axis: dict[str, AxisTable]
    workpiece: WorkpieceTable = WorkpieceTable()

    def made(self, path: str | Path, within: str = "") -> Chain:
        """The machine in base units; raises BadFile.

        Args:
            within: Key of the table that the machine stands in.
        """
        axes = {name: table.axis(name) for name, table in self.axis.items()}
        try:
            return make_chain(self.name, self.chain, axes, self.workpiece.origin)
        except UnknownAxis as error:
            raise BadFile.of(path, error, within, f"axis.{error.facts['key']}") from error
        except BadValue as error:
            raise BadFile.of(path, error, within=within) from error


class MachineFile(MachineTables):
    """The whole file."""

    format: str
    bodies: dict[str, str] | None = None


def read_machine(path: str | Path) -> Chain:
    """Machine from its file; raises BadFile."""
    return _read(path).made(path)


def read_bodies(path: str | Path) -> dict[str, Path]:
    """Drawings of a machine's bodies by link: an axis, `w`, `t`, or `f` for the foundation.

    They are seen from the machine file. Nothing but a picture depends on them.

    Raises:
        BadFile: A file of another kind, or a body of a link that the machine does not have.
    """
    tables = _read(path)
    known = ["f", *(link.name for link in tables.made(path).links)]
    drawings = tables.bodies or {}
    for name in drawings:
        if name not in known:
            raise BadFile(path, "bodies", name, f"one of {', '.join(known)}")
    return {name: Path(path).parent / file for name, file in drawings.items()}


def _read(path: str | Path) -> MachineFile:
    data = parse_toml(read_text(path), path)
    check_format(data, "machine/1", path)
    return checked(MachineFile, data, path)
