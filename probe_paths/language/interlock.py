"""What a program tests on the control before the probe goes down, and stops where it is not so.

Every test takes a system datum (or the difference of two), subtracts what the plan has, and goes to
a label that stops the program where the rest is beyond a limit. The number of the label is the
alarm that the operator reads. A language without a datum has no such test.
"""

from collections.abc import Mapping
from typing import NamedTuple

from matstd.probe_paths.language.dialect import LENGTH_LIMIT, Label
from matstd.probe_paths.language.language import Datum, Language
from matstd.probe_paths.plan import LINEAR, ProgramFrame

PRESET_LIMIT = 1.0
"""Largest displacement of the preset, mm: the clearance that is planned at a touch."""

ANGLE_LIMIT = 0.05  # largest basic rotation and rotary zero, degrees: 0.2 mm at 200 mm

OFFSET_LIMIT = 0.05
"""Largest offset of a tool from the spindle axis, mm: the program moves by all of it."""

SCALE_LIMIT = 5e-4  # largest difference of a scaling factor from 1: 0.1 mm at 200 mm

MIRROR_LIMIT = 0.5  # of a number of bits: none may be set

RADIUS_LIMIT = 0.2  # largest difference of the calibrated ball's radius, mm

TOP_LIMIT = 5.0
"""Largest missing height at the upper end of Z, mm: turns are planned with that clearance."""


class Interlock(NamedTuple):
    """One test."""

    label: Label
    what: str  # is tested
    datum: Datum | None  # datum that is read; None for the length in the tool table
    work: Datum | None  # datum that is subtracted from it, or None
    planned: float  # what is left where all is as planned, mm or degrees
    limit: float  # by how much it may differ

    @property
    def is_at_rest(self) -> bool:
        """A test that needs neither probe nor preset: it stands before the first motion."""
        return self.datum is Datum.TOP

    @property
    def is_above(self) -> bool:
        """A test of where X or Y stands, above the ball of a commissioning program."""
        return self.work is None and self.datum in (Datum.X, Datum.Y)


NOWHERE = {"X": 0.0, "Y": 0.0}  # where a place is asked for and none is known

_CYCLES = "cycle 8, 10, 11 or 26"

_FIRST = (Label.TOP, Label.OTHER_PROBE, Label.ROTATION, Label.PRESET_Z)
"""What a commissioning program tests beside the place above the ball."""


def turn_tests(language: Language, frame: ProgramFrame) -> list[Interlock]:
    """Tests behind every turn, where the control may understand one otherwise.

    `planned` is the reading of the visit and stands in the program.
    """
    axes = frame.chain.rotary_axes if language.tests_turns else ()
    rows = ((Label.TURNED, f"turn of {a}", Datum(a), None, 0.0, ANGLE_LIMIT) for a in axes)
    return [Interlock(*row) for row in rows]


def interlocks(
    language: Language,
    frame: ProgramFrame,
    is_first: bool = False,
    above: Mapping[str, float] = NOWHERE,
) -> list[Interlock]:
    """Tests of a program, in their order.

    A commissioning program has few blocks. In place of presets and cycles it tests the place above
    the ball, which all of them would move.

    Args:
        is_first: For a commissioning program, which has one alarm for all.
        above: Readings of X and Y above its ball, mm.
    """
    probe, chain = frame.probe, frame.chain
    rows: list[tuple[Label, str, Datum | None, Datum | None, float, float]] = [
        (Label.OTHER_PROBE, "length of the tool", None, None, probe.tool_length, LENGTH_LIMIT),
        (Label.RADIUS, "radius of the ball", Datum.RADIUS, None, probe.radius, RADIUS_LIMIT),
        (Label.ROTATION, "basic rotation", Datum.ROTATION, None, 0.0, ANGLE_LIMIT),
        (Label.CYCLES, _CYCLES, Datum.CYCLE_ROTATION, None, 0.0, ANGLE_LIMIT),
        (Label.CYCLES, _CYCLES, Datum.MIRROR, None, 0.0, MIRROR_LIMIT),
        *((Label.CYCLES, _CYCLES, Datum[f"SCALE_{a}"], None, 1.0, SCALE_LIMIT) for a in LINEAR),
        (Label.TOP, "upper end of Z", Datum.TOP, None, chain.link("Z").range[1], TOP_LIMIT),
    ]
    for letter, label in zip(LINEAR, (Label.PRESET_X, Label.PRESET_Y, Label.PRESET_Z), strict=True):
        work, planned = Datum(f"preset {letter}"), -frame.coordinate(letter, 0.0)
        rows.append((label, f"preset in {letter}", Datum(letter), work, planned, PRESET_LIMIT))
    for letter, label in zip(chain.rotary_axes, (Label.ZERO_1, Label.ZERO_2), strict=False):
        work = Datum(f"preset {letter}")
        rows.append((label, f"zero of {letter}", Datum(letter), work, 0.0, ANGLE_LIMIT))
    for datum in (Datum.TOOL_X, Datum.TOOL_Y):
        rows.append((Label.TOOL_OFFSET, datum.value, datum, None, 0.0, OFFSET_LIMIT))
    tests = [Interlock(*row) for row in rows]
    known = {None, *language.system}
    tests = [test for test in tests if test.datum in known and test.work in known]
    if not is_first:
        return tests
    few = [test._replace(label=Label.NOT_AS_PLANNED) for test in tests if test.label in _FIRST]
    places = ((f"place in {a}", Datum(a), None, at, PRESET_LIMIT) for a, at in above.items())
    return [*few, *(Interlock(Label.NOT_AS_PLANNED, *place) for place in places)]
