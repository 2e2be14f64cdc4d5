"""Modal groups of G-code: a G word stays in force until another of its group."""

from dataclasses import dataclass

MOVES = frozenset({0.0, 1.0, 2.0, 3.0})
CYCLES = frozenset({73.0, 74.0, 81.0, 82.0, 83.0, 84.0, 85.0, 86.0, 89.0})
"""Canned cycles that go down along Z at one place and come up again."""
DATUMS = frozenset({54.0, 55.0, 56.0, 57.0, 58.0, 59.0, 59.1, 59.2, 59.3})
INCH = 25.4

_SETS: dict[float, tuple[str, float | str | bool]] = {
    17.0: ("plane", "XY"),
    18.0: ("plane", "ZX"),
    19.0: ("plane", "YZ"),
    20.0: ("unit", INCH),
    21.0: ("unit", 1.0),
    40.0: ("side", 0.0),
    41.0: ("side", 1.0),
    42.0: ("side", -1.0),
    90.0: ("is_absolute", True),
    91.0: ("is_absolute", False),
    90.1: ("has_absolute_centres", True),
    91.1: ("has_absolute_centres", False),
    93.0: ("is_inverse_time", True),
    94.0: ("is_inverse_time", False),
    98.0: ("returns_to_start", True),
    99.0: ("returns_to_start", False),
    **{g: ("datum", g) for g in DATUMS},
}

MODAL = frozenset({*MOVES, *CYCLES, 80.0, *_SETS})
"""Words that `Modal` takes."""


@dataclass
class Modal:
    """What stays in force; the values are those after `G17 G21 G40 G80 G90 G94`."""

    motion: float | None = None  # last of G0 to G3 and the canned cycles; None after G80
    # G0 or G1 if one of them was the last before canned cycles; back after G80
    before_cycle: float | None = None
    plane: str = "XY"  # letters of its axes, in the order in which G3 turns
    unit: float = 1.0  # one unit of lengths, mm
    side: float = 0.0  # of the contour on which the tool goes: 1 left, -1 right, 0 on it
    is_absolute: bool = True  # words are coordinates, not steps
    has_absolute_centres: bool = False  # so are centres of arcs
    is_inverse_time: bool = False  # f is 1/min
    returns_to_start: bool = True  # a canned cycle ends at the height where it began
    datum: float | None = None  # last of the coordinate systems; None where the program names none

    @property
    def is_cycle(self) -> bool:
        """A canned cycle is in force."""
        return self.motion in CYCLES

    @property
    def is_arc(self) -> bool:
        """Motions are arcs."""
        return self.motion in (2.0, 3.0)

    def take(self, g: float) -> None:
        """Take a word of `MODAL`."""
        if g in _SETS:
            setattr(self, *_SETS[g])
        elif g == 80.0:
            self.motion = self.before_cycle if self.is_cycle else None
        else:
            if g in CYCLES and not self.is_cycle:
                self.before_cycle = self.motion if self.motion in (0.0, 1.0) else None
            self.motion = g
