"""Machine file (TOML, "machine/1"): a chain in ISO notation and what is known of each axis."""

from pathlib import Path
from typing import Annotated

from pydantic import Strict

from twin.errors import BadFile, BadValue, UnknownAxis
from twin.files.toml import Table, check_format, checked, parse_toml, read_text
from twin.machine import Axis, Chain, make_chain
from twin.units import DEG

Vector = Annotated[tuple[float, float, float], Strict(False)]  # TOML has lists, not tuples
Pair = Annotated[tuple[float, float], Strict(False)]


class AxisTable(Table):
    """`[axis.X]`: range in mm or degrees, point in mm, direction."""

    range: Pair | None = None
    point: Vector | None = None
    direction: Vector | None = None


class WorkpieceTable(Table):
    """`[workpiece]`: origin of the table frame, mm."""

    origin: Vector = (0.0, 0.0, 0.0)


class MachineTable(Table):
    """The whole file."""

    format: str
    name: str
    chain: str
    axis: dict[str, AxisTable]
    workpiece: WorkpieceTable = WorkpieceTable()


def read_machine(path: str | Path) -> Chain:
    """Machine from its file.

    Raises:
        BadFile: File, key, what stood there, what was expected.
    """
    data = parse_toml(read_text(path), path)
    check_format(data, "machine/1", path)
    table = checked(MachineTable, data, path)
    axes = {}
    for name, axis in table.axis.items():
        factor = DEG if name[:1] in "ABC" else 1.0
        if axis.range is not None and not axis.range[0] < axis.range[1]:
            raise BadFile(path, f"axis.{name}.range", list(axis.range), "the smaller reading first")
        reach = None if axis.range is None else (axis.range[0] * factor, axis.range[1] * factor)
        axes[name] = Axis(reach, axis.point, axis.direction)
    try:
        return make_chain(table.name, table.chain, axes, table.workpiece.origin)
    except UnknownAxis as error:
        raise BadFile.of(path, error, within="axis") from error
    except BadValue as error:
        raise BadFile.of(path, error) from error
