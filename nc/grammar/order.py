"""The order in which the blocks of a Klartext program run: labels, jumps, Q parameters.

Labels, calls, jumps and assignments are executed here; the result is one straight program of plain
numbers. A parameter without a value is refused with its line.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from matstd.nc.grammar.blocks import NUMBER, Block
from matstd.nc.grammar.flow import Flow, label_places
from matstd.nc.grammar.formulas import (
    COMPARISONS,
    FUNCTIONS,
    Formula,
    NotAFormulaError,
    function_value,
)
from matstd.twin.errors import BadFile

MAX_BLOCKS = 1_000_000  # largest number of executed blocks; beyond it a program does not end
_VALUE = rf"[+-]?Q\d+|{NUMBER}"
_NAME = r'\d+|"[^"]+"'
_LABEL = re.compile(f"LBL ({_NAME})")
_CALL = re.compile(rf"CALL LBL ({_NAME})(?: REP ?(\d+)(?:/\d+)?)?")
_JUMP = re.compile(
    rf"FN ?(9|10|11|12) ?: ?IF ?({_VALUE}) ?(EQU|NE|GT|LT) ?({_VALUE}) ?GOTO ?LBL ?({_NAME})"
)
_JUMPS = {"9": "EQU", "10": "NE", "11": "GT", "12": "LT"}
_FUNCTION = re.compile(r"FN ?(\d+) ?: ?Q(\d+) ?= ?(.+)")
_ASSIGNED = re.compile(r"Q(\d+) ?= ?(.+)")
_USED = re.compile(r"([+-]?)Q(\d+)\b", re.IGNORECASE)
_NAMED_NUMBERS = re.compile(r"\s*(?:CYCL DEF (?!7\.)|TCH PROBE)", re.IGNORECASE)
"""Cycles name their own numbers like parameters."""
_ENDS = re.compile(r"(?:.* )?M0*(?:2|30)(?: .*)?")
_KNOWN = "FN 0 to FN 8 and FN 13 with parameters and numbers, FN 9 to FN 12 with a label"


def run_order(blocks: Sequence[Block], path: Path) -> Iterator[Block]:
    """Blocks as they run, parameters put in; the file as it is where it has neither.

    Raises:
        BadFile: A label that is missing or stands twice, a program that does not end, a parameter
            without a value, a function that is not understood; each with its line.
    """
    if not any(_is_flow(b.bare) for b in blocks):
        yield from blocks
        return
    yield from _Run(blocks, path).blocks()


def _is_flow(bare: str) -> bool:
    if bare.startswith(("LBL", "CALL LBL", "FN")):
        return True
    return bool(_USED.search(bare)) and not _NAMED_NUMBERS.match(bare)


class _Run:
    """A program while it runs."""

    def __init__(self, blocks: Sequence[Block], path: Path) -> None:
        self.list, self.path = blocks, path
        self.q: dict[int, float] = {}
        labels = ((i, b, _LABEL.fullmatch(b.bare)) for i, b in enumerate(blocks))
        places = label_places(((i, b.line, m[1]) for i, b, m in labels if m), path)
        self.flow = Flow(path, places, MAX_BLOCKS)

    def _refusal(self, block: Block, found: str, expected: str) -> BadFile:
        return BadFile(self.path, block.line, found, expected)

    def blocks(self) -> Iterator[Block]:
        """Those that do something, in their order."""
        at = 0
        while at < len(self.list):
            block = self.list[at]
            self.flow.count(block.line)
            nxt = self._next(at, block)
            if nxt is not None:
                at = nxt
                continue
            yield self._with_numbers(block)
            if _ENDS.fullmatch(block.bare):
                at = self._last()
            at += 1

    def _last(self) -> int:
        """Block before the end of the program, where M2 and M30 lead."""
        ends = [i for i, b in enumerate(self.list) if b.bare.startswith("END PGM")]
        return (ends[-1] if ends else len(self.list)) - 1

    def _next(self, at: int, block: Block) -> int | None:
        """Index of the next block if this one only controls the flow; None for other blocks."""
        bare = block.bare
        if match := _LABEL.fullmatch(bare):
            back = self.flow.end() if match[1] == "0" else None
            return at + 1 if back is None else back
        if match := _CALL.fullmatch(bare):
            return self._called(at, block, match[1], match[2])
        if match := _JUMP.fullmatch(bare):
            word = _JUMPS[match[1]]
            if word != match[3]:
                raise self._refusal(block, repr(bare), f"{word} with FN {match[1]}")
            holds = COMPARISONS[word](self._value(block, match[2]), self._value(block, match[4]))
            return self.flow.behind(block.line, match[5]) if holds else at + 1
        if match := _FUNCTION.fullmatch(bare):
            self.q[int(match[2])] = self._assigned(block, match[1], match[3])
            return at + 1
        if match := _ASSIGNED.fullmatch(bare):
            self.q[int(match[1])] = self._assigned(block, None, match[2])
            return at + 1
        if bare.startswith("FN"):
            raise self._refusal(block, repr(bare), _KNOWN)
        return None

    def _called(self, at: int, block: Block, name: str, times: str | None) -> int:
        if times is not None:
            return self.flow.repeat(at, block.line, name, int(times))
        start = self.flow.call(at, block.line, name)
        if not any(b.bare == "LBL 0" for b in self.list[start:]):
            raise self._refusal(block, f"LBL {name} without an end", "LBL 0 behind it")
        return start

    def _with_numbers(self, block: Block) -> Block:
        """The block with the values of its parameters."""

        def put(match: re.Match[str]) -> str:
            value = self._value(block, match[0])
            before = match.string[match.start() - 1 : match.start()]
            sign = "" if before in ("F", "S") or before.isspace() else "+"
            return f"{value:{sign}.9f}".rstrip("0").rstrip(".")

        code, mark, comment = block.text.partition(";")
        if _NAMED_NUMBERS.match(code):
            return block
        return block._replace(text=_USED.sub(put, code) + mark + comment)

    def _value(self, block: Block, word: str) -> float:
        """A number, or that of a parameter with its sign."""
        match = _USED.fullmatch(word)
        if match is None:
            return float(word)
        if int(match[2]) not in self.q:
            expected = "a parameter that the program has set before"
            raise self._refusal(block, f"Q{match[2]} without a value", expected)
        value = self.q[int(match[2])]
        return -value if match[1] == "-" else value

    def _assigned(self, block: Block, number: str | None, text: str) -> float:
        """Value of FN 0 to FN 8 and FN 13, or of a formula where no number of FN is given."""

        def read(word: str) -> float:
            return self._value(block, word)

        try:
            if number is None:
                return Formula(text, read).value()
            value = function_value(number, text, _VALUE, read)
        except NotAFormulaError as error:
            expected = f"numbers, parameters, + - * / ^ ( ), PI, {', '.join(FUNCTIONS)}"
            raise self._refusal(block, f"'{error}'", expected) from None
        except BadFile:  # a ValueError too
            raise
        except (ValueError, ZeroDivisionError, OverflowError):
            raise self._refusal(block, repr(block.bare), "a value that exists") from None
        if value is None:
            raise self._refusal(block, repr(block.bare), _KNOWN)
        return value
