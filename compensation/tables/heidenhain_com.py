"""Heidenhain TNC: a `.COM` table an axis with its positioning error over its own reading.

The rows have the reading and, in the column of the axis, its positioning error (EXX ...), mm or
degrees. The raw head of a table file is in no public manual: the rows are to be pasted
into tables that the control made. Angles, straightness and the lines of rotary axes need rows of
the control's kinematic description, whose meaning is not confirmed: they are not written.
"""

import re
from pathlib import Path

import numpy as np

from matstd.compensation.tables.by_name import NamedTables
from matstd.compensation.tables.header import Header
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain

COM_POINTS = 256  # points of a table (TNC 407 to iTNC 530)

_ROW = re.compile(r"\s*\d+\s")


def write(tables: NamedTables, head: Header) -> dict[str, str]:
    """Texts by file name."""
    texts = {}
    for axis, nodes in tables.nodes.items():
        link = tables.chain.link(axis)
        places = 6 if link.kind == "rotary" else 4  # steps in which the control calculates
        lines = [f"; {line}" for line in head.lines()]
        lines += [f"BEGIN {axis} .COM MM", f"NR AXISPOS {axis}"]
        values = head.sign * tables.values[axis][:, link.own_component] / link.unit
        for k, (at, value) in enumerate(zip(nodes / link.unit, values, strict=True)):
            lines.append(f"{k} {at:+.4f} {value:+.{places}f}")
        texts[f"{axis}.COM"] = "\n".join([*lines, "[END]"]) + "\n"
    return texts


def read(folder: Path, chain: Chain) -> tuple[NamedTables, Header]:
    """The tables and their head; raises BadFile."""
    nodes, values = {}, {}
    heads: list[Header] = []
    for axis in chain.programmed_axes:
        path = folder / f"{axis}.COM"
        text = path.read_text(encoding="utf-8")
        heads.append(Header.of(text, path))
        if heads[-1] != heads[0]:
            raise BadFile(path, "head", heads[-1].model, f"{heads[0].model}, as of the other axes")
        link = chain.link(axis)
        rows = []
        for number, line in enumerate(text.splitlines(), start=1):
            if _ROW.match(line):
                words = line.split()
                if len(words) != 3:
                    raise BadFile(path, number, f"{len(words)} columns", "3")
                rows.append([float(word) for word in words[1:]])
        nodes[axis], own = np.array(rows).T * link.unit
        values[axis] = heads[0].sign * np.outer(own, np.eye(6)[link.own_component])
    place = np.zeros((len(chain.links), 6))
    return NamedTables(chain, nodes, values, place, only_own=True), heads[0]
