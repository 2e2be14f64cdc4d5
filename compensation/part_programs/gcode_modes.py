"""What stays in force from line to line of G-code, and the words that change it."""

from dataclasses import dataclass

from matstd.compensation.part_programs.language import Reading

MOVES = frozenset({0.0, 1.0, 2.0, 3.0})
CYCLES = frozenset({73.0, 74.0, 81.0, 82.0, 83.0, 84.0, 85.0, 86.0, 89.0})
"""Canned cycles that go down along Z at one place and come up again."""

HOMES = frozenset({28.0, 30.0})
DATUMS = frozenset({54.0, 55.0, 56.0, 57.0, 58.0, 59.0, 59.1, 59.2, 59.3})
TCP = frozenset({43.4, 234.0})
"""Tool-point control of Fanuc and its kin, and of Haas: coordinates on the turning table."""

KEPT = frozenset(
    {4.0, 5.1, 15.0, 17.0, 18.0, 19.0, 20.0, 21.0, 40.0, 43.0, 49.0, 50.0, 50.1, 61.0, 61.1, 64.0}
    | {69.0, 80.0, 92.1, 92.2, 93.0, 94.0, 98.0, 99.0, 187.0}
    | TCP
    | DATUMS
    | HOMES
)
"""Words that stay in the program: modes, what ends one, smoothing, ways home."""

_READ = MOVES | CYCLES | {41.0, 42.0, 53.0, 90.0, 91.0, 90.1, 91.1} | KEPT
_ENDS = frozenset({15.0, 50.0, 50.1, 69.0, 92.1, 92.2})
"""End what is refused: they name no axis."""

_KEPT_M = frozenset({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 19, 29, 30, 48, 49})
_SUBPROGRAMS = (97, 98, 99)
_SIDES = {40.0: 0.0, 41.0: 1.0, 42.0: -1.0}
_PLANES = {17.0: "XY", 18.0: "ZX", 19.0: "YZ"}
_DATUM = "one datum for the whole program"
_REFUSED = {
    **dict.fromkeys((10.0, 52.0, 54.1, 54.2, 92.0), _DATUM),
    **dict.fromkeys((16.0, 51.0, 51.1, 68.0, 68.2, 53.1), "plain coordinates of the datum"),
    **dict.fromkeys((65.0, 66.0), "motions, not macros"),
    95.0: "G94 or G93, feed per minute or inverse time",
}
_UNDERSTOOD = (
    "G0 to G4, G17 to G21, G28, G30, G40 to G43, G43.4, G49, G53 to G64, G69, G73, G74, "
    "G80 to G86, G89 to G91, G93, G94, G98, G99"
)


@dataclass
class Modes:
    """What stays in force.

    Attributes:
        before_cycle: G0 or G1 if one of them was the last before canned cycles; back after G80.
        calls_by_t: Whether T itself changes the tool: nowhere in the program is an M6.
        next_tool: Of the last T word.
        minutes: That the motion takes, of an F word in inverse time.
        cycle: Words of a canned cycle that stay in force; None outside of one.
        height: Of Z when the first of the cycles in a row was called, mm.
    """

    calls_by_t: bool
    before_cycle: float | None = None
    motion: float | None = None
    plane: str = "XY"
    is_absolute: bool = True
    centres_absolute: bool = False
    datum: float | None = None
    is_inverse: bool = False
    minutes: float = 0.0
    next_tool: int | None = None
    is_back_to_start: bool = True
    cycle: dict[str, float] | None = None
    height: float = 0.0


_SETS: dict[float, tuple[str, float | str | bool | None]] = {
    **{g: ("plane", plane) for g, plane in _PLANES.items()},
    90.0: ("is_absolute", True),
    91.0: ("is_absolute", False),
    90.1: ("centres_absolute", True),
    91.1: ("centres_absolute", False),
    93.0: ("is_inverse", True),
    94.0: ("is_inverse", False),
    98.0: ("is_back_to_start", True),
    99.0: ("is_back_to_start", False),
}
"""What a word alone sets in `Modes`."""


def take(
    line: int, words: list[float], other: dict[str, float], reading: Reading, modes: Modes
) -> None:
    """Take the G words of a line.

    Raises:
        BadFile: One that is not understood.
    """
    for g in words:
        if g not in _READ or (g in _ENDS and not set("XYZABCUVW").isdisjoint(other)):
            raise reading.refusal(line, f"G{g:g}", _REFUSED.get(g, _UNDERSTOOD))
        if g in MOVES or g in CYCLES or g == 80.0:
            _take_motion(g, modes)
        elif g in _SETS:
            if g == 94.0 and modes.is_inverse:
                reading.feed = 0.0  # LinuxCNC wants F anew; 1/min is no feed
            setattr(modes, *_SETS[g])
        elif g in (20.0, 21.0):
            reading.unit = 25.4 if g == 20.0 else 1.0
        elif g in _SIDES:
            reading.side = _SIDES[g]
        elif g in (43.0, 49.0) or g in TCP:
            _length(g, other, reading)
        elif g in DATUMS:
            _take_datum(line, g, reading, modes)


def _take_motion(g: float, modes: Modes) -> None:
    """G0 to G3, a canned cycle or its end, after which the motion before it holds again."""
    if g in CYCLES and modes.motion not in CYCLES:
        modes.before_cycle = modes.motion if modes.motion in (0.0, 1.0) else None
    if g == 80.0:
        modes.motion = modes.before_cycle if modes.motion in CYCLES else None
    else:
        modes.motion = g
    if modes.motion not in CYCLES:
        modes.cycle = None


def _take_datum(line: int, g: float, reading: Reading, modes: Modes) -> None:
    if modes.datum not in (None, g):
        expected = f"G{modes.datum:g} alone: a compensated program holds for one datum"
        raise reading.refusal(line, f"G{g:g}", expected)
    modes.datum = g


def _length(g: float, other: dict[str, float], reading: Reading) -> None:
    """G43 and its kin: the length of H, else that of the tool."""
    length = reading.length
    if g != 49.0 and "H" in other:
        length = reading.lengths.get(int(other["H"]), length)
    reading.switch(g in TCP, length)


def function(line: int, m: int, reading: Reading, modes: Modes) -> None:
    """Take an M word.

    Raises:
        BadFile: One that is not understood.
    """
    if m in reading.tcp_functions:
        reading.switch(m == reading.tcp_functions[0], reading.length)
    elif m not in _KEPT_M and (m not in reading.passed or m in _SUBPROGRAMS):
        expected = "M0 to M9, M19, M29, M30, M48, M49"
        if m not in _SUBPROGRAMS:
            expected += f"; --pass-m {m} where it moves nothing"
        raise reading.refusal(line, f"M{m}", expected)
    if m == 6 and modes.next_tool is not None:
        _change(line, modes.next_tool, reading)


def tool(
    line: int, words: list[float], other: dict[str, float], reading: Reading, modes: Modes
) -> None:
    """Tool of a T word, the next one or this, and that whose radius a D word means.

    Raises:
        BadFile: Another tool beside a contour, a D word elsewhere.
    """
    if "T" in other:
        modes.next_tool = int(other["T"])
        if modes.calls_by_t:
            _change(line, modes.next_tool, reading)
    if "D" in other:
        if not {41.0, 42.0}.intersection(words):
            raise reading.refusal(line, f"D{other['D']:g}", "it with G41 or G42")
        reading.tool = int(other["D"])


def _change(line: int, number: int, reading: Reading) -> None:
    if reading.side:
        raise reading.refusal(line, f"T{number}", "G40 before another tool")
    reading.tool = number
    reading.switch(False, reading.lengths.get(number, reading.frame.datum.length))
