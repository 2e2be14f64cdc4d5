"""Directions of approach in the words of foreign tables."""

import re

import numpy as np

from matstd.importers.sheets import Sheet
from matstd.twin.record import IntArray

DOWN = re.compile(
    r"down|\bdn\b|dwn|↓|-|−|\bneg|\brev|\bb(ack|wd|kw)|rück|ruck|zur|\bret", re.IGNORECASE
)
UP = re.compile(
    r"\bup|↑|\+|\bpos(itive?)?\b|\bf(wd|or)|\bvor|\bhin\b|\baller|montée|croiss", re.IGNORECASE
)


def signs(sheet: Sheet, column: int) -> IntArray:
    """Signs of the directions of approach in a column, (N,); 0 where a cell is empty.

    Raises:
        BadFile: A cell that says neither.
    """
    out = np.zeros(len(sheet), dtype=np.int64)
    for i, word in enumerate(sheet.text(column)):
        if word in ("1", "-1", "0"):
            out[i] = int(word)
        elif UP.search(word) or DOWN.search(word):
            out[i] = 1 if UP.search(word) else -1
        elif word:
            raise sheet.bad(i, column, repr(word), "up or down (+ or -, 1 or -1)")
    return out
