"""Height maps that controls of printers and routers keep of their beds.

RepRapFirmware writes `heightmap.csv`: a line of limits and spacings, and a matrix with a row of
the first axis for every place of the second. Klipper keeps its meshes at the end of `printer.cfg`.
Out comes a table of points with their heights, as a probing with `--standard` has them.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from matstd.twin.errors import BadFile

_REPRAP = re.compile(r"\W*RepRapFirmware height map file", re.IGNORECASE)
_MESH = re.compile(r"(?:#\*#\s*)?\[bed_mesh\s+([^\]]+)\]\s*\Z")
_SECTION = re.compile(r"(?:#\*#\s*)?\[")
_KEY = re.compile(r"(?:#\*#\s*)?([a-z_]+)\s*[=:]\s*(.*?)\s*\Z")
_NOT_PROBED = "0"
"""What stands for a point that was not probed; a height of zero has decimals."""

HEADER = ["x [mm]", "y [mm]", "dz [mm]", "set-up"]
"""Columns of the table that a height map becomes."""

Rows = list[tuple[int, list[str]]]
"""Rows of a table, each with its line."""


def by_heights(path: Path, text: str) -> Rows:
    """Rows of a table of points, each with its line; none where the text is no height map.

    Heights are along Z, mm, positive where the bed is nearer to the tool. Every mesh of Klipper is
    a set-up with its name.

    Raises:
        BadFile: A head without its numbers, axes that are not X and Y, a matrix of another size.
    """
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1) if line.strip()]
    if lines and _REPRAP.match(lines[0][1]):
        return [(lines[0][0], HEADER), *_reprap(path, lines)]
    meshes = [k for k, (_, line) in enumerate(lines) if _MESH.match(line)]
    if not meshes:
        return []
    rows = [row for k in meshes for row in _klipper(path, lines[k:])]
    return [(lines[meshes[0]][0], HEADER), *rows]


def _reprap(path: Path, lines: Sequence[tuple[int, str]]) -> Rows:
    """Points of a height map of RepRapFirmware, of any of its three heads."""
    if len(lines) < 3:
        raise BadFile(path, "file", "a head alone", "a line of names, one of numbers, a matrix")
    head = dict(zip(_split(lines[1][1].lower()), _split(lines[2][1]), strict=False))
    where = f"line {lines[2][0]}"
    axes = [head.get("axis0", "X").upper(), head.get("axis1", "Y").upper()]
    if axes != ["X", "Y"]:
        raise BadFile(path, where, f"axes {' and '.join(axes)}", "X and Y")
    origin, step, count = [], [], []
    for i, letter in enumerate("xy"):
        origin.append(_number(path, where, head, f"{letter}min", f"min{i}"))
        step.append(_number(path, where, head, f"{letter}spacing", f"spacing{i}", "spacing"))
        count.append(int(_number(path, where, head, f"{letter}num", f"num{i}")))
    return _points(path, lines[3:], origin, step, count, "bed")


def _klipper(path: Path, lines: Sequence[tuple[int, str]]) -> Rows:
    """Points of one mesh of Klipper, whose section begins the lines."""
    match = _MESH.match(lines[0][1])
    name = match.group(1).strip() if match else ""
    where = f"line {lines[0][0]}, [bed_mesh {name}]"
    matrix: list[tuple[int, str]] = []
    head: dict[str, str] = {}
    for i, line in lines[1:]:
        key = _KEY.match(line)
        if _SECTION.match(line):
            break
        if key:
            head[key.group(1)] = key.group(2)
        elif "," in line:
            matrix.append((i, line.removeprefix("#*#").strip()))
    count = [int(_number(path, where, head, f"{c}_count")) for c in "xy"]
    low, high = ([_number(path, where, head, f"{m}_{c}") for c in "xy"] for m in ("min", "max"))
    step = [(b - a) / max(n - 1, 1) for a, b, n in zip(low, high, count, strict=True)]
    return _points(path, matrix, low, step, count, name)


def _points(
    path: Path,
    matrix: Sequence[tuple[int, str]],
    origin: Sequence[float],
    step: Sequence[float],
    count: Sequence[int],
    name: str,
) -> Rows:
    """A row a point that was probed."""
    if len(matrix) != count[1]:
        expected = f"{count[1]} rows, as its head says"
        raise BadFile(path, f"height map {name}", f"{len(matrix)} rows of heights", expected)
    out: Rows = []
    for k, (line, text) in enumerate(matrix):
        cells = _split(text)
        if len(cells) != count[0]:
            expected = f"{count[0]}, as the head says"
            raise BadFile(path, f"line {line}", f"{len(cells)} heights", expected)
        for i, cell in enumerate(cells):
            if cell == _NOT_PROBED or cell.lower() == "nan":
                continue
            x, y = origin[0] + i * step[0], origin[1] + k * step[1]
            out.append((line, [f"{x:.12g}", f"{y:.12g}", cell, name]))
    return out


def _split(line: str) -> list[str]:
    return [cell.strip() for cell in line.rstrip(", ").split(",")]


def _number(path: Path, where: str, head: dict[str, str], *names: str) -> float:
    """A number of the head under one of its names."""
    found = next((head[name] for name in names if name in head), None)
    try:
        value = float(found or "")
    except ValueError:
        raise BadFile(path, where, f"{names[0]}: {found or 'nothing'}", "a number") from None
    if not abs(value) <= 1e5:
        raise BadFile(path, where, f"{names[0]}: {found}", "a number up to 100000")
    return value
