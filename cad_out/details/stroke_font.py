"""Letters of single strokes, as an engraving cutter runs along them."""

import numpy as np

from twin.frames import Array

WIDTH, HEIGHT = 4.0, 6.0
"""Of a letter, in its own units."""

ADVANCE = 5.6
"""From one letter to the next, in the same units."""

_GLYPHS = {
    "A": "00 26 40/12 32",
    "B": "00 06 36 45 44 33 03/33 42 41 30 00",
    "C": "45 36 16 05 01 10 30 41",
    "D": "00 06 26 44 42 20 00",
    "E": "40 00 06 46/03 33",
    "F": "00 06 46/03 33",
    "G": "45 36 16 05 01 10 30 41 43 23",
    "H": "00 06/40 46/03 43",
    "I": "20 26",
    "J": "01 10 30 41 46",
    "K": "00 06/46 03 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "10 01 05 16 36 45 41 30 10",
    "P": "00 06 36 45 43 32 02",
    "Q": "10 01 05 16 36 45 41 30 10/22 40",
    "R": "00 06 36 45 44 33 03/23 40",
    "S": "01 10 30 41 42 33 13 04 05 16 36 45",
    "T": "20 26/06 46",
    "U": "06 01 10 30 41 46",
    "V": "06 20 46",
    "W": "06 10 23 30 46",
    "X": "00 46/06 40",
    "Y": "06 23 46/23 20",
    "Z": "06 46 00 40",
    "0": "10 01 05 16 36 45 41 30 10",
    "1": "14 26 20",
    "2": "05 16 36 45 44 00 40",
    "3": "05 16 36 45 44 33 13/33 42 41 30 10 01",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 10 01",
    "6": "45 36 16 05 01 10 30 41 42 33 13 02",
    "7": "06 46 10",
    "8": "13 04 05 16 36 45 44 33 13/13 02 01 10 30 41 42 33",
    "9": "01 10 30 41 45 36 16 05 04 13 33 44",
    "-": "13 33",
    "+": "13 33/22 24",
    ".": "20 21",
    "/": "00 46",
    "Ø": "10 01 05 16 36 45 41 30 10/00 46",
    "±": "04 44/22 26/01 41",
    "_": "00 40",
    " ": "",
}
"""Strokes as places "xy" on a grid of 4 by 6, parted by slashes."""

_UNKNOWN = "00 06 46 40 00"


def strokes(text: str) -> list[Array]:
    """Polylines (N, 2) of a line of capitals that begins at the origin; others are boxes."""
    out = []
    for k, letter in enumerate(text.upper()):
        glyph = _GLYPHS.get(letter, _UNKNOWN)
        out += [places + np.array([ADVANCE * k, 0.0]) for places in lines(glyph)]
    return out


def lines(glyph: str) -> list[Array]:
    """Polylines (N, 2) of one glyph, its strokes as places "xy" parted by slashes."""
    return [
        np.array([[float(place[0]), float(place[1])] for place in line.split()])
        for line in filter(None, glyph.split("/"))
    ]


def width(text: str) -> float:
    """Of a line of text, in units of the letters."""
    return max(len(text) - 1, 0) * ADVANCE + (WIDTH if text else 0.0)
