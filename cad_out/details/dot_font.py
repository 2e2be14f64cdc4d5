"""Letters of dots, as a ball-ended cutter spots them: every dot one face with one edge.

Letters of strokes would leave a thousand faces of a tenth of a square millimetre, among which the
few relevant faces are hard to select when tool paths are programmed.
"""

import numpy as np

from matstd.twin.frames import Array

CUTTER = 0.5  # radius of the ball-ended cutter, mm
DEPTH = 0.35  # of a dot, mm
DOT = float(np.sqrt(DEPTH * (2.0 * CUTTER - DEPTH)))  # radius of a dot where it comes out, mm

SMALL, LARGE = 5, 7  # rows of dots of a letter
_PITCH = 1.15  # mm between dots
_COLUMNS = {SMALL: 3, LARGE: 5}

_GLYPHS = {
    "A": ("25755", "0e11111f111111"),
    "B": ("65656", "1e11111e11111e"),
    "C": ("34443", "0e11101010110e"),
    "D": ("65556", "1c12111111121c"),
    "E": ("74647", "1f10101e10101f"),
    "F": ("74644", "1f10101e101010"),
    "G": ("34553", "0e11101711110f"),
    "H": ("55755", "1111111f111111"),
    "I": ("72227", "0e04040404040e"),
    "J": ("11152", "0702020202120c"),
    "K": ("55655", "11121418141211"),
    "L": ("44447", "1010101010101f"),
    "M": ("57755", "111b1515111111"),
    "N": ("65555", "11111915131111"),
    "O": ("25552", "0e11111111110e"),
    "P": ("65644", "1e11111e101010"),
    "Q": ("25571", "0e11111115120d"),
    "R": ("65655", "1e11111e141211"),
    "S": ("34216", "0f10100e01011e"),
    "T": ("72222", "1f040404040404"),
    "U": ("55557", "1111111111110e"),
    "V": ("55552", "11111111110a04"),
    "W": ("55775", "1111111515150a"),
    "X": ("55255", "11110a040a1111"),
    "Y": ("55222", "1111110a040404"),
    "Z": ("71247", "1f01020408101f"),
    "0": ("75557", "0e11131519110e"),
    "1": ("26227", "040c040404040e"),
    "2": ("71747", "0e11010204081f"),
    "3": ("71717", "1f02040201110e"),
    "4": ("55711", "02060a121f0202"),
    "5": ("74717", "1f101e0101110e"),
    "6": ("74757", "0608101e11110e"),
    "7": ("71122", "1f010204080808"),
    "8": ("75757", "0e11110e11110e"),
    "9": ("75717", "0e11110f01020c"),
    "-": ("00700", "0000001f000000"),
    "+": ("02720", "0004041f040400"),
    ".": ("00002", "00000000000c0c"),
    "/": ("11244", "00010204081000"),
    "_": ("00007", "0000000000001f"),
    " ": ("00000", "00000000000000"),
}
"""Rows of dots from the top: octal digits of three dots, and pairs of hexadecimal ones of five."""

_UNKNOWN = ("75557", "1f11111111111f")


def dots(text: str, rows: int) -> Array:
    """Middles of the dots of a line of capitals, (N, 2), mm; unknown letters are boxes.

    Args:
        rows: Of dots in a letter, `SMALL` or `LARGE`.
    """
    found = [
        (column + k * (_COLUMNS[rows] + 1), row)
        for k, letter in enumerate(text.upper())
        for row, column in _glyph(letter, rows)
    ]
    return DOT + _PITCH * np.array(found, dtype=float).reshape(-1, 2)


def _glyph(letter: str, rows: int) -> list[tuple[int, int]]:
    """Row, counted from below, and column of every dot."""
    small, large = _GLYPHS.get(letter, _UNKNOWN)
    lines = [int(c, 8) for c in small] if rows == SMALL else list(bytes.fromhex(large))
    last = _COLUMNS[rows] - 1
    return [
        (rows - 1 - i, j)
        for i, line in enumerate(lines)
        for j in range(last + 1)
        if line >> (last - j) & 1
    ]


def size(text: str, rows: int) -> Array:
    """Width and height of a line of text, mm, (2,)."""
    columns = max(len(text) * (_COLUMNS[rows] + 1) - 1, 1)
    return 2.0 * DOT + _PITCH * np.array([columns - 1.0, rows - 1.0])
