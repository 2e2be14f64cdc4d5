"""The order in which the blocks of a Klartext program run: labels, jumps, Q parameters.

Labels, calls, jumps and assignments are done here, so that what follows is one straight program of
plain numbers. A word that needs a parameter nobody has given is refused, with its line.
"""

import math
import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

from matstd.compensation.part_programs.language import NUMBER, Reading

DEEPEST = 8
"""Subprograms within one another, as the control has them."""

MOST = 1_000_000
"""Blocks that run: beyond it a program does not end."""

_LABEL = re.compile(r'LBL (\d+|"[^"]+")')
_CALL = re.compile(r'CALL LBL (\d+|"[^"]+")(?: REP ?(\d+)(?:/\d+)?)?')
_JUMP = re.compile(
    rf"FN ?(9|10|11|12) ?: ?IF ?([+-]?Q\d+|{NUMBER}) ?(EQU|NE|GT|LT) ?([+-]?Q\d+|{NUMBER}) ?"
    r'GOTO ?LBL ?(\d+|"[^"]+")'
)
_FUNCTION = re.compile(r"FN ?(\d+) ?: ?Q(\d+) ?= ?(.+)")
_ASSIGNED = re.compile(r"Q(\d+) ?= ?(.+)")
_USED = re.compile(r"([+-]?)Q(\d+)\b", re.IGNORECASE)
_NAMED_NUMBERS = re.compile(r"\s*(?:CYCL DEF (?!7\.)|TCH PROBE)", re.IGNORECASE)
"""Cycles name their own numbers like parameters."""

_ENDS = re.compile(r"(?:.* )?M0*(?:2|30)(?: .*)?")
_JUMPS: dict[str, tuple[str, Callable[[float, float], bool]]] = {
    "9": ("EQU", lambda a, b: a == b),
    "10": ("NE", lambda a, b: a != b),
    "11": ("GT", lambda a, b: a > b),
    "12": ("LT", lambda a, b: a < b),
}
_PAIRS = {"1": r"\+", "2": "-", "3": r"\*", "4": "DIV", "8": "LEN", "13": "ANG"}
"""Of the functions FN with two values, the word between them."""


_FUNCTIONS = "FN 0 to FN 8 and FN 13 with parameters and numbers, FN 9 to FN 12 with a label"


class Block(NamedTuple):
    """One block of the file.

    Attributes:
        line: Of the file.
        text: Without its number.
    """

    line: int
    text: str

    @property
    def bare(self) -> str:
        """Without its comment, in capitals, single spaces; names of labels as they are."""
        text = " ".join(self.text.partition(";")[0].split())
        return "".join(p if p[:1] == '"' else p.upper() for p in re.split(r'("[^"]*")', text))


def in_order(blocks: list[Block], reading: Reading) -> Iterator[Block]:
    """Blocks as they run, parameters put in; the file as it is where it has neither.

    Raises:
        BadFile: A label that is missing or there twice, a program that does not end, a parameter
            without a value, a function that is not understood; each with its line.
    """
    if not any(_is_flow(b.bare) for b in blocks):
        yield from blocks
        return
    yield from _Run(blocks, reading).blocks()


def _is_flow(bare: str) -> bool:
    if bare.startswith(("LBL", "CALL LBL", "FN")):
        return True
    return bool(_USED.search(bare)) and not _NAMED_NUMBERS.match(bare)


class _Run:
    """A program while it runs."""

    def __init__(self, blocks: list[Block], reading: Reading) -> None:
        self.list, self.reading = blocks, reading
        self.q: dict[int, float] = {}
        self.labels: dict[str, int] = {}
        self.back: list[int] = []
        self.left: dict[int, int] = {}
        for i, block in enumerate(blocks):
            match = _LABEL.fullmatch(block.bare)
            if match and match[1] != "0":
                if match[1] in self.labels:
                    first = blocks[self.labels[match[1]]].line
                    raise reading.refusal(
                        block.line, f"LBL {match[1]} again", f"it once, as in line {first}"
                    )
                self.labels[match[1]] = i

    def blocks(self) -> Iterator[Block]:
        """Those that do something, in their order."""
        at = steps = 0
        while at < len(self.list):
            block = self.list[at]
            steps += 1
            if steps > MOST:
                raise self.reading.refusal(block.line, f"{MOST} blocks", "a program that ends")
            nxt = self._flow(at, block)
            if nxt is not None:
                at = nxt
                continue
            yield self._with_numbers(block)
            if _ENDS.fullmatch(block.bare):
                at = self._last(block)
            at += 1

    def _last(self, block: Block) -> int:
        """Block before the end of the program, where M2 and M30 lead."""
        ends = [i for i, b in enumerate(self.list) if b.bare.startswith("END PGM")]
        return (ends[-1] if ends else len(self.list)) - 1

    def _flow(self, at: int, block: Block) -> int | None:
        """Number of the next block where this one only says so; None where it does something."""
        bare = block.bare
        if match := _LABEL.fullmatch(bare):
            return self.back.pop() if match[1] == "0" and self.back else at + 1
        if match := _CALL.fullmatch(bare):
            return self._called(at, block, match[1], match[2])
        if match := _JUMP.fullmatch(bare):
            word, holds = _JUMPS[match[1]]
            if word != match[3]:
                raise self.reading.refusal(block.line, repr(bare), f"{word} with FN {match[1]}")
            values = self._value(block, match[2]), self._value(block, match[4])
            return self._label(block, match[5]) + 1 if holds(*values) else at + 1
        if match := _FUNCTION.fullmatch(bare):
            self.q[int(match[2])] = self._function(block, match[1], match[3])
            return at + 1
        if match := _ASSIGNED.fullmatch(bare):
            self.q[int(match[1])] = self._formula(block, match[2])
            return at + 1
        if bare.startswith("FN"):
            raise self.reading.refusal(block.line, repr(bare), _FUNCTIONS)
        return None

    def _label(self, block: Block, name: str) -> int:
        if name not in self.labels:
            there = ", ".join(self.labels) or "none"
            raise self.reading.refusal(block.line, f"LBL {name}", f"a label of this file: {there}")
        return self.labels[name]

    def _called(self, at: int, block: Block, name: str, repeated: str | None) -> int:
        label = self._label(block, name)
        if repeated is not None:
            left = self.left.pop(at, int(repeated))
            if not left:
                return at + 1
            self.left[at] = left - 1
            return label + 1
        if len(self.back) >= DEEPEST:
            raise self.reading.refusal(
                block.line, f"subprograms {len(self.back) + 1} deep", f"{DEEPEST} at most"
            )
        if not any(b.bare == "LBL 0" for b in self.list[label:]):
            raise self.reading.refusal(block.line, f"LBL {name} without an end", "LBL 0 behind it")
        self.back.append(at + 1)
        return label + 1

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
        return Block(block.line, _USED.sub(put, code) + mark + comment)

    def _value(self, block: Block, word: str) -> float:
        """A number, or that of a parameter with its sign."""
        match = _USED.fullmatch(word)
        if match is None:
            return float(word)
        if int(match[2]) not in self.q:
            expected = "a parameter that the program has set before"
            raise self.reading.refusal(block.line, f"Q{match[2]} without a value", expected)
        value = self.q[int(match[2])]
        return -value if match[1] == "-" else value

    def _function(self, block: Block, number: str, text: str) -> float:
        """FN 0 to FN 8 and FN 13."""
        one = rf"([+-]?Q\d+|{NUMBER})"
        single = {"0": "", "5": "SQRT ?", "6": "SIN ?", "7": "COS ?"}
        if number in single and (match := re.fullmatch(single[number] + one, text)):
            return self._guarded(block, number, self._value(block, match[1]), 0.0)
        if number in _PAIRS and (match := re.fullmatch(f"{one} ?{_PAIRS[number]} ?{one}", text)):
            values = self._value(block, match[1]), self._value(block, match[2])
            return self._guarded(block, number, *values)
        raise self.reading.refusal(block.line, repr(block.bare), _FUNCTIONS)

    def _guarded(self, block: Block, number: str, a: float, b: float) -> float:
        try:
            return _FN[number](a, b)
        except (ValueError, ZeroDivisionError):
            raise self.reading.refusal(
                block.line, repr(block.bare), "a value that exists"
            ) from None

    def _formula(self, block: Block, text: str) -> float:
        try:
            return _Formula(text, lambda word: self._value(block, word)).whole()
        except _NoFormulaError as error:
            known = ", ".join(_NAMED)
            expected = f"numbers, parameters, + - * / ^ ( ), PI, {known}"
            raise self.reading.refusal(block.line, f"'{error}'", expected) from None
        except (ValueError, ZeroDivisionError, OverflowError):
            raise self.reading.refusal(
                block.line, repr(block.bare), "a value that exists"
            ) from None


def _angle(a: float, b: float) -> float:
    """FN 13: from a opposite and an adjacent side, 0 to 360 degrees."""
    return math.degrees(math.atan2(a, b)) % 360.0


_FN: dict[str, Callable[[float, float], float]] = {
    "0": lambda a, b: a,
    "1": lambda a, b: a + b,
    "2": lambda a, b: a - b,
    "3": lambda a, b: a * b,
    "4": lambda a, b: a / b,
    "5": lambda a, b: math.sqrt(a),
    "6": lambda a, b: math.sin(math.radians(a)),
    "7": lambda a, b: math.cos(math.radians(a)),
    "8": math.hypot,
    "13": _angle,
}

_NAMED: dict[str, Callable[[float], float]] = {
    "SIN": lambda v: math.sin(math.radians(v)),
    "COS": lambda v: math.cos(math.radians(v)),
    "TAN": lambda v: math.tan(math.radians(v)),
    "ASIN": lambda v: math.degrees(math.asin(v)),
    "ACOS": lambda v: math.degrees(math.acos(v)),
    "ATAN": lambda v: math.degrees(math.atan(v)),
    "SQ": lambda v: v * v,
    "SQRT": math.sqrt,
    "LN": math.log,
    "LOG": math.log10,
    "EXP": math.exp,
    "NEG": lambda v: -v,
    "INT": math.trunc,
    "ABS": abs,
    "FRAC": lambda v: v - math.trunc(v),
}


class _NoFormulaError(Exception):
    """What stands where a formula cannot go on."""


class _Formula:
    """A formula: functions go before powers, these before * and /, these before + and -."""

    _TOKEN = re.compile(r"\s*(Q\d+|\d+\.?\d*|\.\d+|[A-Z]+|[-+*/^()])")

    def __init__(self, text: str, value: Callable[[str], float]) -> None:
        self.value = value
        self.tokens: list[str] = []
        at = 0
        while text[at:].strip():
            match = self._TOKEN.match(text, at)
            if match is None:
                raise _NoFormulaError(text[at:].strip())
            self.tokens.append(match[1])
            at = match.end()

    def whole(self) -> float:
        """Its value; raises _NoFormulaError."""
        out = self._sum()
        if self.tokens:
            raise _NoFormulaError(self.tokens[0])
        return out

    def _take(self, *wanted: str) -> str:
        return self.tokens.pop(0) if self.tokens and self.tokens[0] in wanted else ""

    def _sum(self) -> float:
        out = self._product()
        while sign := self._take("+", "-"):
            out += self._product() if sign == "+" else -self._product()
        return out

    def _product(self) -> float:
        out = self._power()
        while sign := self._take("*", "/"):
            other = self._power()
            out = out * other if sign == "*" else out / other
        return out

    def _power(self) -> float:
        out = self._single()
        while self._take("^"):
            out = math.pow(out, self._single())
        return out

    def _single(self) -> float:
        if not self.tokens:
            raise _NoFormulaError("the end")
        token = self.tokens.pop(0)
        if token in ("+", "-"):
            return self._single() if token == "+" else -self._single()
        if token == "(":
            out = self._sum()
            if not self._take(")"):
                raise _NoFormulaError("( without )")
            return out
        if token == "PI":
            return math.pi
        if token in _NAMED:
            return _NAMED[token](self._single())
        if not re.match(r"Q\d|[\d.]", token):
            raise _NoFormulaError(token)
        return self.value(token)
