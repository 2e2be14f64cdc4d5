"""iTNC 530 KinematicsComp: a `.COM` table an axis, and the kinematic table that refers to them.

A `.COM` table has the reading, the positioning error in the column of the axis, and in C1 to C6 the
components EX., EY., EZ. (mm), EA., EB., EC. (degrees); the own positioning error is in the column
of the axis alone. The kinematic table has, before every axis, the components as transformations
that refer to those columns, and the location errors with their values; the lines of rotary axes
stand corrected. The raw head of a table file is in no public manual: the rows are to be
pasted into tables that the control made.
"""

import re
from pathlib import Path

import numpy as np

from compensation.tables.by_name import NamedTables
from compensation.tables.header import Header
from twin.errors import BadFile
from twin.frames import Array
from twin.machine import LETTERS, Chain, Link
from twin.units import DEG

MOST_POINTS = 256
"""Points of a table (TNC 407 to iTNC 530)."""
KINEMATICS = "KINEMATICS.TXT"
_ROW = re.compile(r"\s*\d+\s")
_UNITS = np.array([1.0] * 3 + [DEG] * 3)


def write(tables: NamedTables, head: Header) -> dict[str, str]:
    """Texts by file name."""
    top = [f"; {line}" for line in head.lines()]
    texts = {}
    for axis, nodes in tables.nodes.items():
        link = tables.chain.link(axis)
        unit = DEG if link.kind == "rotary" else 1.0
        lines = [*top, f"BEGIN {axis} .COM MM", "NR AXISPOS " + " ".join([axis, *_COLUMNS])]
        for k, (at, row) in enumerate(zip(nodes, head.sign * tables.values[axis], strict=True)):
            shown = row / _UNITS
            cells = [_cell(shown[c], c) for c in range(6)]
            own = cells[link.own_component]
            cells[link.own_component] = "0"
            lines.append(" ".join([str(k), f"{at / unit:+.4f}", own, *cells]))
        texts[f"{axis}.COM"] = "\n".join([*lines, "[END]"]) + "\n"
    rows = [row for link in tables.chain.links for row in _kinematics(tables, link, head.sign)]
    numbered = [f"{k} {row}" for k, row in enumerate(rows)]
    lines = [*top, "BEGIN KINEMATICS .TAB MM", "NR DOC KEY AXIS COORD COMPTAB", *numbered, "[END]"]
    texts[KINEMATICS] = "\n".join(lines) + "\n"
    return texts


_COLUMNS = tuple(f"C{k}" for k in range(1, 7))


def _cell(value: float, component: int) -> str:
    """Steps of 0.1 µm and of a millionth of a degree, in which the control calculates."""
    return f"{value:+.4f}" if component < 3 else f"{value:+.6f}"


def _kinematics(tables: NamedTables, link: Link, sign: int) -> list[str]:
    """Rows of one axis: its place, its errors, the axis, the errors of angle undone behind it."""
    if link.name not in tables.nodes:
        return []
    place = sign * tables.place[tables.chain.link_index(link.name)] / _UNITS
    point = link.point + sign * place[:3] * (link.kind == "rotary")
    rows = []
    if link.kind == "rotary":
        rows += [f"{link.name}_POINT Trans {'XYZ'[i]} {point[i]:+.4f} -" for i in range(3)]
    displaced = [i for i in range(6) if place[i] != 0.0]
    for i in displaced:
        rows.append(f"E{LETTERS[i]}0{link.name} Trans {LETTERS[i]} {_cell(place[i], i)} -")
    for i, letter in enumerate(LETTERS):
        if i != link.own_component:
            rows.append(f"E{letter}{link.name} Trans {letter} - {link.name}..C{i + 1}")
    rows.append(f"{link.name}_AXIS MachAxis {link.name} - -")
    for i in (i for i in displaced[::-1] if i >= 3):
        rows.append(f"E{LETTERS[i]}0{link.name}_BACK Trans {LETTERS[i]} {_cell(-place[i], i)} -")
    return rows


def read(folder: Path, chain: Chain) -> tuple[NamedTables, Header]:
    """The tables and their head, as a control would take them.

    Raises:
        BadFile: File, line, what stood there, what was expected.
    """
    path = folder / KINEMATICS
    text = path.read_text(encoding="utf-8")
    head = Header.of(text, path)
    place = np.zeros((len(chain.links), 6))
    for line in filter(_ROW.match, text.splitlines()):
        doc, value = line.split()[1], line.split()[4]
        if re.fullmatch(r"E[XYZABC]0[A-Z]\d?", doc):
            symbol = chain.symbol(doc)
            unit = _UNITS[symbol.component]
            place[chain.link_index(symbol.link), symbol.component] = head.sign * float(value) * unit
    nodes, values = {}, {}
    for axis in chain.programmed_axes:
        nodes[axis], values[axis] = _read_table(folder / f"{axis}.COM", chain.link(axis), head)
    return NamedTables(chain=chain, nodes=nodes, values=values, place=place), head


def _read_table(path: Path, link: Link, head: Header) -> tuple[Array, Array]:
    """Points and components of one axis."""
    text = path.read_text(encoding="utf-8")
    own = Header.of(text, path)
    if own != head:
        raise BadFile(path, "head", own.model, f"{head.model}, as of {KINEMATICS}")
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if _ROW.match(line):
            words = line.split()
            if len(words) != 9:
                raise BadFile(path, f"line {number}", f"{len(words)} columns", "9")
            rows.append([float(word) for word in words[1:]])
    table = np.array(rows)
    values = table[:, 2:] * _UNITS
    values[:, link.own_component] = table[:, 1] * _UNITS[link.own_component]
    return table[:, 0] * (DEG if link.kind == "rotary" else 1.0), head.sign * values
