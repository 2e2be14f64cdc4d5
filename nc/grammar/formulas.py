"""Values of Klartext: comparisons, functions FN and formulas with Q parameters."""

import math
import operator
import re
from collections.abc import Callable, Iterable

Read = Callable[[str], float]  # gives the value of a word: a number, or a parameter with its sign

COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "EQU": operator.eq,
    "NE": operator.ne,
    "GT": operator.gt,
    "LT": operator.lt,
}
"""Words between the two values of a jump."""


_ONE: dict[str, tuple[str, Callable[[float], float]]] = {
    "0": ("", lambda a: a),
    "5": ("SQRT ?", math.sqrt),
    "6": ("SIN ?", lambda a: math.sin(math.radians(a))),
    "7": ("COS ?", lambda a: math.cos(math.radians(a))),
}
"""Functions FN of one value, with the word before it."""

_TWO: dict[str, tuple[str, Callable[[float, float], float]]] = {
    "1": (r"\+", operator.add),
    "2": ("-", operator.sub),
    "3": (r"\*", operator.mul),
    "4": ("DIV", operator.truediv),
    "8": ("LEN", math.hypot),
    "13": ("ANG", lambda a, b: math.degrees(math.atan2(a, b)) % 360.0),  # 0 to 360 degrees
}
"""Functions FN of two values, with the word between them."""


def function_value(number: str, text: str, value: str, read: Read) -> float | None:
    """Value of FN 0 to FN 8 and FN 13; None for another function or other words.

    `value` is the pattern of a number or parameter. Raises ValueError or ZeroDivisionError where no
    such value exists.
    """
    if number in _ONE and (match := re.fullmatch(f"{_ONE[number][0]}({value})", text)):
        return _ONE[number][1](read(match[1]))
    if number in _TWO:
        word, function = _TWO[number]
        if match := re.fullmatch(f"({value}) ?{word} ?({value})", text):
            return function(read(match[1]), read(match[2]))
    return None


FUNCTIONS: dict[str, Callable[[float], float]] = {
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
"""Functions of a formula."""


_SIGNS: tuple[dict[str, Callable[[float, float], float]], ...] = (
    {"+": operator.add, "-": operator.sub},
    {"*": operator.mul, "/": operator.truediv},
    {"^": math.pow},
)
"""Signs between two values; those of a later level go first."""


class NotAFormulaError(Exception):
    """The text at which a formula is invalid."""


class Formula:
    """A formula: functions go before powers, these before * and /, these before + and -."""

    _TOKEN = re.compile(r"\s*(Q\d+|\d+\.?\d*|\.\d+|[A-Z]+|[-+*/^()])")

    def __init__(self, text: str, read: Read) -> None:
        self.read = read
        self.tokens: list[str] = []
        at = 0
        while text[at:].strip():
            match = self._TOKEN.match(text, at)
            if match is None:
                raise NotAFormulaError(text[at:].strip())
            self.tokens.append(match[1])
            at = match.end()

    def value(self) -> float:
        """Its value; raises NotAFormulaError."""
        out = self._joined()
        if self.tokens:
            raise NotAFormulaError(self.tokens[0])
        return out

    def _take(self, wanted: Iterable[str]) -> str:
        return self.tokens.pop(0) if self.tokens and self.tokens[0] in wanted else ""

    def _joined(self, level: int = 0) -> float:
        """Values that signs of a level of `_SIGNS` join, from left to right."""
        if level == len(_SIGNS):
            return self._single()
        out = self._joined(level + 1)
        while sign := self._take(_SIGNS[level]):
            out = _SIGNS[level][sign](out, self._joined(level + 1))
        return out

    def _single(self) -> float:
        if not self.tokens:
            raise NotAFormulaError("the end")
        token = self.tokens.pop(0)
        if token in ("+", "-"):
            return self._single() if token == "+" else -self._single()
        if token == "(":
            out = self._joined()
            if not self._take(")"):
                raise NotAFormulaError("( without )")
            return out
        if token == "PI":
            return math.pi
        if token in FUNCTIONS:
            return FUNCTIONS[token](self._single())
        if not re.match(r"Q\d|[\d.]", token):
            raise NotAFormulaError(token)
        return self.read(token)
