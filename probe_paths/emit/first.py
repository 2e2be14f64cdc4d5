"""The commissioning program: everything that the others rely on, once, in few blocks.

A programming station without a licence keeps a hundred blocks. The program therefore tests only
what decides where the ball comes down, has one alarm, and prints its whole log at once. It goes
home without M127: a turn the shorter way, with Z up, does no harm.
"""

import numpy as np

from matstd.probe_paths.emit.writer import Writer
from matstd.probe_paths.language import ErrorText, Label, Q, Touch, interlocks
from matstd.probe_paths.plan import home_readings
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.units import MINUTE

_FROM_ABOVE = -0.999  # Z component of the direction of a touch from above


class FirstWriter(Writer):
    """Writes a commissioning program of a plan of touches on one ball."""

    def text(self, name: str, title: str, part: list[int], duration: float) -> str:
        """Whole text: the touch from above, and one in the air where the way down begins."""
        k = self.language
        # one alarm for all tests: each label would cost blocks of the hundred
        row, visit = self._touch_from_above(), self.plan.visits[0]
        above = {a: float(self.plan.start[row, self.plan.chain.axis_index(a)]) for a in "XY"}
        tests = interlocks(k, self.frame, is_first=True, above=above)
        later = [test for test in tests if not (test.is_at_rest or test.is_above)]
        blocks = [
            k.begin(name),
            *self._first_remarks(row, duration),
            *k.reset(self.plan.chain, self.dialect),
            *self._all_tested(test for test in tests if test.is_at_rest),
            self.retract,
            *self._called(),
            *self._turning_place(),
            *self._home(self.first_feed)[-1:],
            *self._probe_data(),
            *self._all_tested(later),
            k.line(self.frame.coordinates(self.plan.start[row], "XY"), None),
            k.wait,
            *self._all_tested(test for test in tests if test.is_above),
            *self._in_air(row, visit.height),
            *self._on_ball(row, visit.pose),
            self.retract,
            k.wait,
            *self._places(),
            self._print(f"{name}.A", name),
            k.program_stop,
            k.label(Label.NO_CONTACT, "NO CONTACT"),
            k.retract_max(self.plan.top),
            k.stop_with_error(ErrorText.TOUCH_POINT_INACCESSIBLE),
            k.label(Label.NOT_AS_PLANNED, f"ALARM {Label.NOT_AS_PLANNED:d}: PROBE OR PRESET"),
            k.stop_with_error(ErrorText.INPUT_VALUE_INCORRECT),
            k.end(name),
        ]
        return k.listed(blocks)

    def _touch_from_above(self) -> int:
        """Row of the touch on the pole, which needs no room beside the ball."""
        z = self.plan.direction[:, 2]
        row, home = int(np.argmin(z)), home_readings(self.plan.chain)
        if z[row] > _FROM_ABOVE or np.any(self.plan.visits[0].rotary != home):
            raise NotReachable("no ball can be touched from above with the rotary axes at home")
        return row

    def _first_remarks(self, row: int, duration: float) -> list[str]:
        k, feature = self.language, str(self.plan.feature[row])
        remarks = [
            *self.heading.lines,
            f"FEATURE {self.number[feature]} IS {feature}",
            f"TOUCHES 1 TO 1, ABOUT {max(duration / MINUTE, 1.0):.0f} MIN",
            *self.purpose.remarks,
            *self._tool_remarks(),
        ]
        return [k.comment(text) for text in remarks]

    def _cycle(self, row: int) -> list[str]:
        options = self.plan.options
        direction: Array = self.plan.direction[row]
        touch = Touch(list(direction), self.plan.distance, self.feeds.probing, options.standoff)
        return self.language.probe_vector(self.dialect, Q.RESULT_X, touch)

    def _in_air(self, row: int, height: float) -> list[str]:
        """The same cycle high above the ball: its status must report no contact."""
        k = self.language
        start = self.frame.coordinates(self.plan.start[row], "XY")
        back = {**start, "Z": self.frame.coordinate("Z", height)}
        return [
            k.assign(Q.STATUS, 0),
            k.line({"Z": back["Z"]}, None),
            *self._cycle(row),
            k.jump_if_less(Q.STATUS, 0, Label.AIR),
            k.retract_max(self.plan.top),
            k.stop_with_error(ErrorText.TOUCH_POINT_INACCESSIBLE),
            k.label(Label.AIR, "MET NOTHING, AS IT MUST"),
            k.line(back, self.feeds.approach),
        ]

    def _on_ball(self, row: int, pose: int) -> list[str]:
        k = self.language
        start = self.frame.coordinates(self.plan.start[row], "XYZ")
        sides = [k.assign(q, 0) for q, _ in zip((Q.SIDE_1, Q.SIDE_2), self.rotary, strict=False)]
        return [
            k.assign(Q.POSE, pose + 1),
            *sides,
            k.assign(Q.TOUCH, 1),
            k.assign(Q.FEATURE, self.number[str(self.plan.feature[row])]),
            k.assign(Q.STATUS, -1),
            k.line({"Z": start["Z"]}, self.feeds.approach),
            *self._cycle(row),
            k.jump_if_less(Q.STATUS, 0, Label.NO_CONTACT),
            k.line(start, self.feeds.approach),
        ]
