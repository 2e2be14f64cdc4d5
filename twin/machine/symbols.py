"""Error parameters by their ISO 230-1 names: `EXX`, `EC0Y`, `EX0w`, and what each one means.

Two conventions hold everywhere. The six components of an error are always in the letter
order X Y Z A B C = (dx, dy, dz, ra, rb, rc), which is the second letter of the name. A component
error is *tool side minus workpiece side* of its axis, in the directions of the body that the axis
sits on, whichever side of the machine carries the axis.
"""

import re
from dataclasses import dataclass
from enum import Enum

LETTERS = "XYZABC"  # second letter of a name -> index of the component
ALONG = {**{k: k for k in "XYZ"}, **dict(zip("ABCUVW", "XYZXYZ", strict=True)), "S": "Z"}
"""Letter of an axis -> direction of the machine frame that it moves along or turns about (ISO 841).
"""
_PATTERN = re.compile(r"E([XYZABC])(0?)([XYZUVWABCS]\d?|w|t)\Z")


class Family(Enum):
    """What kind of error a name stands for."""

    COMPONENT = "component error of an axis (a function of its reading)"
    LOCATION = "location error of an axis (a constant)"
    SETUP = "set-up of the workpiece or the tool (a constant)"


@dataclass(frozen=True, slots=True)
class Symbol:
    """One error parameter of ISO 230-1."""

    component: int  # index of the component in X Y Z A B C
    link: str  # name of the axis, or `w` (workpiece), `t` (tool)
    family: Family  # component, location or set-up

    @property
    def name(self) -> str:
        """`EXX`, `EC0Y`, `EX0w`."""
        zero = "" if self.family is Family.COMPONENT else "0"
        return f"E{LETTERS[self.component]}{zero}{self.link}"

    @property
    def is_angular(self) -> bool:
        """Whether the parameter is an angle (rad) rather than a length (mm)."""
        return self.component >= 3

    @property
    def unit(self) -> str:
        """Base unit: "rad" or "mm"."""
        return "rad" if self.is_angular else "mm"

    @property
    def motion(self) -> str:
        """Where it moves the tool, whichever body carries it: `along Z`, `about X`."""
        return f"{'about' if self.is_angular else 'along'} {'XYZ'[self.component % 3]}"

    @property
    def title(self) -> str:
        """In words: `straightness of X in Y`, `squareness of Y about Z`."""
        axis, letter = self.link, self.link[0]
        is_linear = letter in "XYZUVW"
        is_own = "XYZ"[self.component % 3] == ALONG.get(letter)
        if self.family is Family.SETUP:
            what = "rotation" if self.is_angular else "displacement"
            return f"{what} of the {'workpiece' if axis == 'w' else 'tool'} {self.motion}"
        if self.family is Family.LOCATION:
            if is_own and self.is_angular != is_linear:
                return f"zero position of {axis}"
            what = "tilt" if self.is_angular else "displacement"
            return f"{'squareness' if is_linear else f'{what} of the line'} of {axis} {self.motion}"
        if is_own and self.is_angular != is_linear:
            return f"positioning error of {axis}"
        if is_own:
            return f"{'roll' if is_linear else 'axial motion'} of {axis}"
        if is_linear and not self.is_angular:
            return f"straightness of {axis} in {'XYZ'[self.component % 3]}"
        return f"{'tilt' if self.is_angular else 'radial motion'} of {axis} {self.motion}"


def parse_symbol(name: str) -> Symbol | None:
    """Symbol of a name, or None if the name is none of ISO 230-1.

    Reference:
        ISO 230-1:2012, 3.4 and annex A (names without comma and subscript).

    Example:
        >>> parse_symbol("EC0Y")
        Symbol(component=5, link='Y', family=<Family.LOCATION: 'location error of an axis (a constant)'>)
    """  # noqa: E501  (the output of the example is one line)
    match = _PATTERN.match(name)
    if match is None:
        return None
    letter, zero, link = match.groups()
    if link in "wt":
        family = Family.SETUP if zero else None
    else:
        family = Family.LOCATION if zero else Family.COMPONENT
    return None if family is None else Symbol(LETTERS.index(letter), link, family)
