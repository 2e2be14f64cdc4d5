"""LinuxCNC: a `COMP_FILE` of type 1 a joint.

A line has a nominal position and what is added to it after a positive and after a negative motion
(type 1, mm or degrees). It replaces `BACKLASH`. A joint corrects itself alone.
"""

from pathlib import Path

import numpy as np

from matstd.compensation.tables.along_axes import AxisTable, AxisTables
from matstd.compensation.tables.header import Header
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain, Link

COMP_POINTS = 256  # points of a table that LinuxCNC reads


def write(tables: AxisTables, head: Header) -> dict[str, str]:
    """Texts by file name."""
    top = [f"# {line}" for line in head.lines()]
    texts = {}
    for table in tables.tables:
        columns = [table.nodes, head.sign * table.forward, head.sign * table.reverse]
        rows = np.column_stack(columns) / tables.chain.link(table.over).unit
        lines = [*top, *(" ".join(f"{v:.7f}" for v in row) for row in rows)]
        texts[f"{table.over}.comp"] = "\n".join(lines) + "\n"
    return texts


def read(folder: Path, chain: Chain) -> tuple[AxisTables, Header]:
    """The tables and their head, as LinuxCNC would take them; raises BadFile."""
    made, head = [], None
    for axis in chain.programmed_axes:
        path = folder / f"{axis}.comp"
        if not path.exists():
            continue
        text = path.read_text(encoding="utf-8")
        own = Header.of(text, path)
        if head is not None and own != head:
            raise BadFile(path, "head", own.model, f"{head.model}, as of the other axes")
        head = own
        made.append(_table(path, text, chain.link(axis), own.sign))
    if head is None:
        raise BadFile(folder, "files", "none", "a .comp file of an axis")
    return AxisTables(chain, tuple(made)), head


def _table(path: Path, text: str, link: Link, sign: int) -> AxisTable:
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("#"):
            continue
        try:
            nominal, forward, reverse = (float(word) for word in line.split())
        except ValueError:
            raise BadFile(path, number, repr(line), "three numbers") from None
        rows.append((nominal, sign * forward, sign * reverse))
    nodes, forward_all, reverse_all = np.array(rows).T * link.unit
    return AxisTable(link.name, link.name, nodes, forward=forward_all, reverse=reverse_all)
