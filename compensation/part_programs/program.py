"""A part program as a file: its language by its ending, its blocks and motions."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np

from matstd.compensation.part_programs import gcode, gcode_reader, klartext, klartext_reader
from matstd.compensation.part_programs.corners import without_corners
from matstd.compensation.part_programs.frame import Frame
from matstd.compensation.part_programs.language import Reading
from matstd.compensation.part_programs.motion import Item, Motion
from matstd.compensation.part_programs.radius import resolved
from matstd.twin.errors import BadFile
from matstd.twin.files import CsvTable, read_any_text, read_text
from matstd.twin.frames import Array

COLUMNS = ("first_line", "last_line", "Fx_N", "Fy_N", "Fz_N")
MAX_FORCE = 1e5  # largest plausible cutting force, N


class Load(NamedTuple):
    """Force on the tool in table-frame directions while some lines of a program run, N."""

    first: int
    last: int
    force: tuple[float, float, float]


def read_loads(path: str | Path) -> tuple[Load, ...]:
    """Loads of a table with the columns first_line, last_line, Fx_N, Fy_N, Fz_N.

    Raises:
        BadFile: A column that is missing or unknown, lines in no order or named twice.
    """
    table = CsvTable(read_text(path), path)
    table.require(COLUMNS)
    table.allow_only(COLUMNS)
    first, last = (table.numbers(c, smallest=1.0) for c in COLUMNS[:2])
    force = np.column_stack([table.numbers(c, largest=MAX_FORCE) for c in COLUMNS[2:]])
    out: list[Load] = []
    for row, (a, b) in enumerate(zip(first.astype(int), last.astype(int), strict=True)):
        if b < a:
            raise table.bad(row, "last_line", b, f"{a} or more")
        if any(load.first <= b and a <= load.last for load in out):
            raise table.bad(row, "first_line", a, "lines that no other row names")
        x, y, z = force[row].tolist()
        out.append(Load(int(a), int(b), (x, y, z)))
    if not out:
        raise BadFile(path, "table", "no rows", "a row for every load")
    return tuple(out)


def forces(lines: list[int], loads: tuple[Load, ...], usual: Array) -> Array:
    """Force while each motion runs, (M, 3), N.

    Args:
        usual: Where no load names the line, (3,).
    """
    out = np.tile(usual, (len(lines), 1))
    number = np.array(lines)
    for load in loads:
        out[(number >= load.first) & (number <= load.last)] = load.force
    return out


_ENDINGS = {".h": klartext, ".ngc": gcode, ".nc": gcode, ".tap": gcode}
_READ = {klartext: klartext_reader.read, gcode: gcode_reader.read}
MARK = "matstd model:"  # stands in the head of every compensated program


_ABSURD = re.compile(r"\d{31,}")  # beyond any machine, and beyond what arithmetic can hold


@dataclass(frozen=True, eq=False)
class Program:
    """A program that was read."""

    path: Path
    frame: Frame
    items: tuple[Item, ...]  # blocks and motions in their order
    language: ModuleType
    # force of the process on the tool, block by block; elsewhere that of the state
    loads: tuple[Load, ...] = ()

    @property
    def motions(self) -> list[Motion]:
        """What can be compensated."""
        return [item for item in self.items if isinstance(item, Motion)]


def read_part_program(
    path: str | Path,
    frame: Frame,
    lengths: dict[int | str, float] | None = None,
    radii: dict[int | str, float] | None = None,
    passed: Iterable[int] = (),
    tcp_functions: Iterable[int] = (),
) -> Program:
    """Read a Klartext (`.H`) or G-code (`.ngc`, `.nc`) program.

    Args:
        frame: Where its zero stands; the datum's tool is that of tools without a length.
        lengths: Lengths of tools by number or name, mm.
        radii: Radii of tools by number or name, mm; needed where the program goes beside a contour.
        passed: Numbers of M functions of the machine that move nothing.
        tcp_functions: Those of G-code that switch tool-point control on, and off.

    Raises:
        BadFile: Another ending, a block that is not understood, a program that was compensated.
        NotReachable: The machine has not X, Y and Z.
    """
    path = Path(path)
    language = _ENDINGS.get(path.suffix.lower())
    if language is None:
        raise BadFile(path, "name", path.suffix or "no ending", f"one of {', '.join(_ENDINGS)}")
    text = read_any_text(path)
    if MARK in text:
        line = text[: text.index(MARK)].count("\n") + 1
        raise BadFile(path, line, MARK, "a program that was not compensated before")
    if absurd := _ABSURD.search(text):
        line = text[: absurd.start()].count("\n") + 1
        raise BadFile(path, line, f"a number of {len(absurd[0])} digits", "30 at most")
    frame.linear  # noqa: B018  (a machine without them is refused before anything is read)
    reading = Reading(
        path=path,
        frame=frame,
        lengths=lengths or {},
        radii=radii or {},
        passed=frozenset(passed),
        tcp_functions=tuple(tcp_functions),
    )
    _READ[language](text, reading)
    items = without_corners(reading.items, reading)
    items = resolved(items, reading, is_square=language is klartext)
    program = Program(path, frame, tuple(items), language)
    if not program.motions:
        raise BadFile(path, "file", "no motion from a known place", "one at least")
    _check_travel(program)
    return program


def _check_travel(program: Program) -> None:
    """Refuse a program that ends a motion outside the machine; raises BadFile."""
    chain = program.frame.chain
    low, high = chain.travels.T
    motions = program.motions
    for kind in {(m.tcpm, m.length) for m in motions}:
        own = [m for m in motions if (m.tcpm, m.length) == kind]
        q = program.frame.readings(np.array([m.end for m in own]), *kind)
        beyond = np.argwhere((q < low - 1e-9) | (q > high + 1e-9))
        if len(beyond):
            row, k = (int(v) for v in beyond[0])
            unit = chain.link(chain.axes[k]).unit
            found = f"{chain.axes[k]} at a reading of {q[row, k] / unit:.3f}"
            expected = f"{low[k] / unit:g} to {high[k] / unit:g}; is --datum right?"
            raise BadFile(program.path, own[row].line, found, expected)
