"""State of the control during one of our programs: positions, modes, parameters, and refusals."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from matstd.probe_paths.control.steps import Value
from matstd.probe_paths.language import (
    FREE,
    Block,
    Interlock,
    Label,
    Terms,
    language_of,
    turn_tests,
)
from matstd.probe_paths.plan import ProgramFrame
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.units import DEG

TOP_OF_TRAVEL = 20.0  # how far below the upper end of Z's travel a retract with M91 may end, mm

SAME_ANGLE = 1e-3
"""Degrees by which a test may take off another reading than the one that was programmed."""

_CHANGES_IN_PLACE = (np.ndarray, dict, set)  # of what a state holds
SAME = 1e-6  # positions that differ by less are the same, mm or rad


@dataclass
class State:
    """Everything that one block can change."""

    path: Path
    frame: ProgramFrame  # conversion of words to readings
    q: Array  # readings, (A,); nan where an axis has not been positioned
    side: Array  # sign of the last motion of every axis, (A,)
    is_tcpm_off: bool  # M129 has been read, or is not needed on this machine
    is_plane_off: bool  # the same of PLANE RESET
    head_left: set[str]  # words of the reset that end an offset of the head, not read so far
    orientation_left: int  # blocks that orient the spindle and were not read behind the tool call
    parameters: dict[int, Value] = field(default_factory=dict)
    feed: float | None = None  # modal feed, mm/min
    is_radius_off: bool = False  # R0 has been read
    is_shorter_way: bool = False  # M126 is active
    is_tilted: bool = False  # the head says that coordinates are those of tilted planes
    plane: ProgramFrame | None = None  # the tilted plane that is active; None where none is
    shift_off: set[str] = field(default_factory=set)  # axes whose datum shift was set to zero
    preset: int | None = None
    tool: int | None = None
    is_retracted: bool = False  # Z stands where M91 or M140 put it
    clearance: float | None = None  # reading of Z that the first move down from the retract went to
    untested: int | None = None  # touch whose status has not been tested
    way_back: Array | None = None  # readings that the next move must return to after a touch
    is_synchronous: bool = False  # FN 20 was read since the last motion
    is_spindle_off: bool = False  # M5 has been read
    fault: Interlock | None = None  # planted deviation at which the program has to stop
    off: float = 0.0  # by how much, mm or degrees
    # counters that belong to the touch or the visit before
    stale: set[int] = field(default_factory=set)
    is_search: bool = False  # touches may be long where they come from above
    is_first: bool = False  # one touch may be in the air, where it must meet nothing
    turns: int = 0  # moves of rotary axes so far
    # parameters that hold where a rotary axis stands, less a number, in degrees
    reached: dict[int, tuple[str, float]] = field(default_factory=dict)
    # rotary axes whose last turn was tested, by axis and side of the limit
    turn_tested: set[tuple[str, bool]] = field(default_factory=set)

    def copied(self) -> "State":
        """A state that can run on its own."""
        own: dict[str, Any] = {}
        own |= {k: v.copy() for k, v in vars(self).items() if isinstance(v, _CHANGES_IN_PLACE)}
        return replace(self, **own)

    @property
    def terms(self) -> Terms:
        """How the program's language says what a refusal asks for."""
        return language_of(self.path).terms

    def refusal(self, block: Block, expected: str, found: str = "") -> BadFile:
        """The one clear line about a block; its text is what was found unless that is stated."""
        return BadFile(self.path, block.line, found or repr(block.text), expected)

    def check_ready(self, block: Block, what: str) -> None:
        """Refuse a coordinate before preset, tool and a reset frame."""
        missing = [
            name
            for name, there in (
                ("M5", self.is_spindle_off),
                (self.terms.reset, self.is_tcpm_off),
                (self.terms.plane, self.is_plane_off),
                (min(self.head_left, default=""), not self.head_left),
                (self.terms.shift, self.shift_off == set("XYZ")),
                (self.terms.tool, self.tool is not None),
                ("the orientation of the spindle (is_oriented)", self.orientation_left <= 0),
                (self.terms.preset, self.preset is not None),
            )
            if not there
        ]
        if missing:
            raise self.refusal(block, f"{missing[0]} before it", what)

    def check_is_as_planned(self, block: Block) -> None:
        """Refuse a move while a fault has not been tested."""
        if self.fault is not None:
            expected = f"a test that stops the program before it (LBL {self.fault.label:d})"
            found = f"{block.text!r} although {self.fault.what} is off by {self.off:+g}"
            raise self.refusal(block, expected, found)

    def check_turn_was_tested(self, block: Block) -> None:
        """Refuse a touch before a test of the rotary axes, where a control may turn otherwise.

        A test takes the planned reading off the one that was read, and has both limits.
        """
        if not language_of(self.path).tests_turns:
            return
        for letter in self.frame.chain.rotary_axes:
            if not {(letter, False), (letter, True)} <= self.turn_tested:
                expected = f"a test of where {letter} stands, after its turn (O{Label.TURNED:d})"
                raise self.refusal(block, expected, "a touch")

    def note_test(self, q: int, label: int, limit: float, is_less: bool) -> None:
        """Note a test of a turn that was passed."""
        if q not in self.reached or label != Label.TURNED:
            return
        letter, planned = self.reached[q]
        reading = float(self.q[self.frame.chain.axis_index(letter)]) / DEG
        sign = -1.0 if is_less else 1.0
        most = max(test.limit for test in turn_tests(language_of(self.path), self.frame))
        if abs(planned - reading) < SAME_ANGLE and 0.0 <= sign * limit <= most:
            self.turn_tested.add((letter, is_less))

    def check_status_was_tested(self, block: Block) -> None:
        """Refuse a block between a touch and the test of its status."""
        if self.untested is not None:
            expected = f"{self.terms.status} first"
            raise self.refusal(block, expected, f"{block.text!r} after touch {self.untested + 1}")

    def write(self, block: Block, q: int, value: Value) -> None:
        """Set a Q parameter of the free range."""
        if q not in FREE:
            raise self.refusal(block, f"a free parameter, Q{FREE[0]} to Q{FREE[-1]}", f"Q{q}")
        self.parameters[q] = value
        self.stale.discard(q)
        self.reached.pop(q, None)

    def value(self, block: Block, q: int) -> Value:
        """A Q parameter that this run has set; values left by other programs do not count."""
        if q not in self.parameters:
            raise self.refusal(block, "a parameter set by this program", f"Q{q} without a value")
        return self.parameters[q]

    def whole(self, block: Block, q: int, name: str) -> int:
        """A counter that must be set before a touch."""
        value = self.parameters.get(q)
        if q in self.stale:
            raise self.refusal(block, f"{name} set anew", f"the {name} of the one before")
        if not isinstance(value, float) or value != int(value):
            raise self.refusal(
                block, f"a whole number ({name}) before the touch", f"Q{q} = {value}"
            )
        return int(value)

    def check_travel(self, block: Block, target: Array) -> None:
        """Every positioned axis stays within its travel."""
        chain = self.frame.chain
        for letter in self.frame.letters:
            low, high = chain.link(letter).range
            value = target[chain.axis_index(letter)]
            if np.isfinite(value) and not low - SAME <= value <= high + SAME:
                scale = self.frame.coordinate(letter, 1.0) if letter not in "XYZ" else 1.0
                expected = f"{low * scale:g} to {high * scale:g}, the travel of {letter}"
                raise self.refusal(block, expected, f"{letter} reading {value * scale:.4f}")
