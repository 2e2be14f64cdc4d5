"""Sinumerik `$AN_CEC`: corrections of one axis over the reading of another, at equal steps.

A table corrects one axis; values are added to the commanded position. The number of tables is at
most twice that of the axes: those that correct most are written.
"""

import re
from pathlib import Path

import numpy as np

from matstd.compensation.tables.along_axes import AxisTable, AxisTables
from matstd.compensation.tables.header import Header
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain

NAME = "NC_CEC.INI"
CEC_POINTS = 257  # points of a table; MD18342 says how many a control holds in all
PER_AXIS = 2  # tables per axis that a control holds

_VALUE = re.compile(r"\$AN_CEC\[(\d+),(\d+)\]=([-+\d.eE]+)\Z")
_WORD = re.compile(r"\$AN_CEC_([A-Z_]+)\[(\d+)\]=\(?([^)]*)\)?\Z")


def write(tables: AxisTables, head: Header) -> dict[str, str]:
    """Texts by file name."""
    lines = ["%_N_NC_CEC_INI", *(f"; {line}" for line in head.lines()), "CHANDATA(1)"]
    for k, table in enumerate(tables.tables):
        over, moves = (tables.chain.link(axis).unit for axis in (table.over, table.moves))
        values = head.sign * table.forward / moves
        lines += [f"$AN_CEC[{k},{i}]={v:.6f}" for i, v in enumerate(values)]
        nodes = table.nodes / over
        turn = 360.0 if table.over[0] in "ABC" and np.ptp(nodes) > 359.999 else 0.0
        words = {
            "INPUT_AXIS": f"({table.over})",
            "OUTPUT_AXIS": f"({table.moves})",
            "STEP": f"{(nodes[-1] - nodes[0]) / (len(nodes) - 1):.9g}",
            "MIN": f"{nodes[0]:.9g}",
            "MAX": f"{nodes[-1]:.9g}",
            "DIRECTION": "0",
            "MULT_BY_TABLE": "0",
            "IS_MODULO": "1" if turn else "0",
        }
        lines += [f"$AN_CEC_{word}[{k}]={value}" for word, value in words.items()]
    return {NAME: "\n".join([*lines, "M17"]) + "\n"}


def read(folder: Path, chain: Chain) -> tuple[AxisTables, Header]:
    """The tables and their head, as a control would take them; raises BadFile."""
    path = folder / NAME
    text = path.read_text(encoding="utf-8")
    values: dict[int, dict[int, float]] = {}
    words: dict[int, dict[str, str]] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        value, word = _VALUE.match(line), _WORD.match(line)
        if value is not None:
            values.setdefault(int(value[1]), {})[int(value[2])] = float(value[3])
        elif word is not None:
            words.setdefault(int(word[2]), {})[word[1]] = word[3]
        elif not line.startswith((";", "%", "CHANDATA", "M17")):
            raise BadFile(path, number, repr(line), "$AN_CEC...=...")
    head = Header.of(text, path)
    made = [_table(chain, values[k], words[k], head.sign) for k in sorted(values)]
    return AxisTables(chain, tuple(made)), head


def _table(chain: Chain, values: dict[int, float], words: dict[str, str], sign: int) -> AxisTable:
    """One table, in base units."""
    over, moves = words["INPUT_AXIS"], words["OUTPUT_AXIS"]
    low, step = float(words["MIN"]), float(words["STEP"])
    nodes = (low + step * np.arange(float(len(values)))) * chain.link(over).unit
    held = sign * np.array([values[i] for i in range(len(values))]) * chain.link(moves).unit
    return AxisTable(over, moves, nodes, forward=held, reverse=held)
