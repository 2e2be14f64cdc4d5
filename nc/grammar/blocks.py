"""Text of a program to its blocks and words: numbers, comments, continued lines, nothing else."""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
"""A number as programs of any origin write it."""
SIGNED = r"[+-]\d{1,5}(?:\.\d{0,7})?"
"""A coordinate as our own programs write it and controls save it: always with its sign."""
_WORD = re.compile(rf"([A-Z])({NUMBER})")
_WORDS = re.compile(rf"(?:[A-Z]{NUMBER})*")


def split_words(text: str) -> list[tuple[str, float]]:
    """Words of a block: letters with their numbers.

    Raises:
        ValueError: Something that is no word, which is the message.
    """
    bare = "".join(text.split())
    if not _WORDS.fullmatch(bare):
        raise ValueError(_WORD.sub("", bare))
    return [(letter, float(number)) for letter, number in _WORD.findall(bare)]


class Block(NamedTuple):
    """One block of Klartext."""

    line: int  # of the file, from 1; the first of a block that goes on
    number: str  # block number as it stands there; empty where the block has none
    text: str  # without the number; line ends stand where the block goes on

    @property
    def bare(self) -> str:
        """On one line, without its comment, in capitals; names in quotes as they are."""
        text = " ".join(self.text.partition(";")[0].split())
        return "".join(p if p[:1] == '"' else p.upper() for p in re.split(r'("[^"]*")', text))


_NUMBERED = re.compile(r"\s*(\d+)\s+")


def klartext_blocks(lines: Sequence[str]) -> Iterator[Block]:
    """Blocks of a Klartext program; a line that ends in a tilde continues on the next one.

    Only the last block of a file that is cut off can end in a tilde.
    """
    i = 0
    while i < len(lines):
        first, raw = i + 1, lines[i]
        while raw.rstrip().endswith("~") and i + 1 < len(lines):
            i += 1
            raw = f"{raw}\n{lines[i]}"
        i += 1
        match = _NUMBERED.match(raw)
        number, text = (match[1], raw[match.end() :]) if match else ("", raw)
        yield Block(first, number, text.strip())


class Line(NamedTuple):
    """One line of G-code."""

    line: int  # of the file, from 1
    text: str  # as it stands there, without spaces at its ends
    code: str  # in capitals, without remarks
    remarks: str  # comments in brackets and behind a semicolon, with these, one after the other


_REMARK = re.compile(r"\([^)]*\)|;.*")


def gcode_lines(lines: Sequence[str]) -> Iterator[Line]:
    """Lines of a G-code program."""
    for number, raw in enumerate(lines, start=1):
        remarks = _REMARK.findall(raw) if "(" in raw or ";" in raw else []
        code = (_REMARK.sub("", raw) if remarks else raw).strip().upper()
        yield Line(number, raw.strip(), code, "".join(remarks).strip())
