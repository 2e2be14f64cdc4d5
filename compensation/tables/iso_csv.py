"""Open CSV of ISO 230 names, as the ISG kernel and TwinCAT CNC read it: the first to try.

Blocks end at `#`, comments begin with `//`. A block over an axis has its reading (mm, degrees) and
its six component errors (mm, rad); the last block has the location errors, by their names without
the `E`. Values are errors, tool side minus workpiece side.
"""

import re
from pathlib import Path

import numpy as np

from matstd.compensation.tables.by_name import NamedTables
from matstd.compensation.tables.header import Header
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.machine import LETTERS, Chain, Family, Symbol

NAME = "iso230.csv"
ISO_POINTS = 1025
"""Points of an axis; five axes and their location errors stay within some thousand records."""

_COMMENT = "//"


def write(tables: NamedTables, head: Header) -> dict[str, str]:
    """Texts by file name."""
    lines = [f"{_COMMENT} {line}" for line in head.lines()]
    lines.append(f"{_COMMENT} lengths in mm, angles in rad, readings in mm and degrees")
    for axis, nodes in tables.nodes.items():
        unit = tables.chain.link(axis).unit
        lines.append(" ".join([axis, *(f"E{c}{axis}" for c in LETTERS)]))
        for at, row in zip(nodes, head.sign * tables.values[axis], strict=True):
            lines.append(" ".join([f"{at / unit:.6f}", *_words(row)]))
        lines.append("#")
    symbols = _location(tables.chain)
    values = [
        head.sign * tables.place[tables.chain.link_index(s.link), s.component] for s in symbols
    ]
    lines.append(" ".join(s.name[1:] for s in symbols))
    lines.append(
        " ".join(
            f"{v:.9f}" if s.is_angular else f"{v:.7f}" for s, v in zip(symbols, values, strict=True)
        )
    )
    return {NAME: "\n".join(lines) + "\n"}


def read(folder: Path, chain: Chain) -> tuple[NamedTables, Header]:
    """The tables and their head, as a control would take them; raises BadFile."""
    path = folder / NAME
    text = path.read_text(encoding="utf-8")
    head = Header.of(text, path)
    nodes, values = {}, {}
    place = np.zeros((len(chain.links), 6))
    for block in _blocks(text):
        number, names = block[0][0], block[0][1]
        rows = np.array([_numbers(path, line, words, len(names)) for line, words in block[1:]])
        if names[0] in chain.axes:
            expected = [names[0], *(f"E{c}{names[0]}" for c in LETTERS)]
            if names != expected:
                raise BadFile(path, number, " ".join(names), " ".join(expected))
            nodes[names[0]] = rows[:, 0] * chain.link(names[0]).unit
            values[names[0]] = head.sign * rows[:, 1:]
        else:
            for name, value in zip(names, rows[0], strict=True):
                symbol = chain.symbol(f"E{name}")
                place[chain.link_index(symbol.link), symbol.component] = head.sign * value
    return NamedTables(chain=chain, nodes=nodes, values=values, place=place), head


def _location(chain: Chain) -> list[Symbol]:
    """Location errors of the axes that a program moves."""
    own = (s for s in chain.symbols if s.family is Family.LOCATION)
    return [s for s in own if s.link in chain.programmed_axes]


def _words(row: Array) -> list[str]:
    """Lengths to 0.1 nm, angles to a nanoradian: finer than any measurement."""
    return [f"{v:.7f}" for v in row[:3]] + [f"{v:.9f}" for v in row[3:]]


def _blocks(text: str) -> list[list[tuple[int, list[str]]]]:
    """Lines with their numbers and words, block after block, comments dropped."""
    blocks: list[list[tuple[int, list[str]]]] = [[]]
    for number, line in enumerate(text.splitlines(), start=1):
        bare = re.sub(rf"{_COMMENT}.*", "", line).strip()
        if bare == "#":
            blocks.append([])
        elif bare:
            blocks[-1].append((number, bare.split()))
    return [block for block in blocks if block]


def _numbers(path: Path, line: int, words: list[str], count: int) -> list[float]:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        raise BadFile(path, line, " ".join(words), f"{count} numbers") from None
    if len(numbers) != count:
        raise BadFile(path, line, f"{len(numbers)} numbers", f"{count}, as in the head")
    return numbers
