"""Height maps of beds, as controls of printers and routers save them.

RepRapFirmware writes `heightmap.csv`: a line of limits and spacings, and a matrix with a row of
the first axis for every place of the second. Klipper keeps its meshes at the end of `printer.cfg`.
Out comes a table of points with their heights, as a probing with `--standard` has them.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from matstd.importers.sheets.rows import filled_lines
from matstd.twin.errors import BadFile

_REPRAP = re.compile(r"\W*RepRapFirmware height map file", re.IGNORECASE)
_MESH = re.compile(r"(?:#\*#\s*)?\[bed_mesh\s+([^\]]+)\]\s*\Z")
_SECTION = re.compile(r"(?:#\*#\s*)?\[")
_KEY = re.compile(r"(?:#\*#\s*)?([a-z_]+)\s*[=:]\s*(.*?)\s*\Z")
_NOT_PROBED = ("0", "nan")  # cells of points that were not probed; a height of zero has decimals
HEADER = ["x [mm]", "y [mm]", "dz [mm]", "set-up"]  # columns of the table that a height map becomes

Rows = list[tuple[int, list[str]]]  # rows of a table, each with its line

Axes = Sequence[tuple[float, float, int]]  # first place, spacing and number of places along X and Y


def by_heights(path: Path, text: str) -> Rows:
    """Rows of a table of points, each with its line; none where the text is no height map.

    Heights are along Z, mm, positive where the bed is nearer to the tool. Every mesh of Klipper is
    a set-up with its name.

    Raises:
        BadFile: A head without its numbers, axes that are not X and Y, a matrix of another size.
    """
    lines = filled_lines(text)
    if lines and _REPRAP.match(lines[0][1]):
        return [(lines[0][0], HEADER), *_reprap(path, lines)]
    meshes = [(k, m[1].strip()) for k, (_, line) in enumerate(lines) if (m := _MESH.match(line))]
    rows = [row for k, name in meshes for row in _klipper(path, name, lines[k:])]
    return [(lines[meshes[0][0]][0], HEADER), *rows] if meshes else []


def _reprap(path: Path, lines: Sequence[tuple[int, str]]) -> Rows:
    """Points of a height map of RepRapFirmware, of any of its three heads."""
    if len(lines) < 3:
        raise BadFile(path, "file", "a head alone", "a line of names, one of numbers, a matrix")
    head = dict(zip(_split(lines[1][1].lower()), _split(lines[2][1]), strict=False))
    where = lines[2][0]
    axes = [head.get("axis0", "X").upper(), head.get("axis1", "Y").upper()]
    if axes != ["X", "Y"]:
        raise BadFile(path, where, f"axes {' and '.join(axes)}", "X and Y")
    along = [
        (
            _number(path, where, head, f"{letter}min", f"min{i}"),
            _number(path, where, head, f"{letter}spacing", f"spacing{i}", "spacing"),
            int(_number(path, where, head, f"{letter}num", f"num{i}")),
        )
        for i, letter in enumerate("xy")
    ]
    return _points(path, lines[3:], along, "bed")


def _klipper(path: Path, name: str, lines: Sequence[tuple[int, str]]) -> Rows:
    """Points of one mesh of Klipper, whose section begins the lines."""
    where = f"line {lines[0][0]}, [bed_mesh {name}]"
    matrix: list[tuple[int, str]] = []
    head: dict[str, str] = {}
    for i, line in lines[1:]:
        key = _KEY.match(line)
        if _SECTION.match(line):
            break
        if key:
            head[key[1]] = key[2]
        elif "," in line:
            matrix.append((i, line.removeprefix("#*#").strip()))
    along = []
    for letter in "xy":
        count = int(_number(path, where, head, f"{letter}_count"))
        low, high = (_number(path, where, head, f"{end}_{letter}") for end in ("min", "max"))
        along.append((low, (high - low) / max(count - 1, 1), count))
    return _points(path, matrix, along, name)


def _points(path: Path, matrix: Sequence[tuple[int, str]], along: Axes, name: str) -> Rows:
    """A row for every point that was probed."""
    (x, dx, columns), (y, dy, rows) = along
    if len(matrix) != rows:
        expected = f"{rows} rows, as its head says"
        raise BadFile(path, f"height map {name}", f"{len(matrix)} rows of heights", expected)
    out: Rows = []
    for k, (line, text) in enumerate(matrix):
        cells = _split(text)
        if len(cells) != columns:
            raise BadFile(path, line, f"{len(cells)} heights", f"{columns}, as the head says")
        out += [
            (line, [f"{x + i * dx:.12g}", f"{y + k * dy:.12g}", cell, name])
            for i, cell in enumerate(cells)
            if cell.lower() not in _NOT_PROBED
        ]
    return out


def _split(line: str) -> list[str]:
    return [cell.strip() for cell in line.rstrip(", ").split(",")]


def _number(path: Path, where: str | int, head: dict[str, str], *names: str) -> float:
    """A number of the head under one of its names."""
    found = next((head[name] for name in names if name in head), "nothing")
    try:
        value = float(found)
    except ValueError:
        raise BadFile(path, where, f"{names[0]}: {found or 'nothing'}", "a number") from None
    if not abs(value) <= 1e5:
        raise BadFile(path, where, f"{names[0]}: {found}", "a number up to 100000")
    return value
