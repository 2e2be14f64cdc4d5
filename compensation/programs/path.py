"""Every motion of a program on the machine that runs it: poses, times, what a control would do."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from compensation.field import MachineErrors, actual_tip, correction, shifted
from compensation.part_programs import Paths, Program, forces
from twin.errors import BadFile
from twin.frames import Array
from twin.machine import tip
from twin.record import IntArray, Touches
from twin.units import DEG, MINUTE

RAPID = 10_000.0
"""Speed of rapid motions where a time is needed, mm/min: drift does not feel the difference."""


class ProgramPath:
    """Every motion of a program on the machine that runs it."""

    def __init__(self, program: Program, errors: MachineErrors) -> None:
        self.program, self.errors = program, errors
        self.motions, self.frame = program.motions, program.frame
        self.paths = Paths(self.motions, self.frame.linear)
        self.is_whole = np.array([m.is_rapid or m.cycle is not None for m in self.motions])
        self.offset = np.array([m.offset for m in self.motions])
        speed = np.array([RAPID if m.is_rapid else m.feed or np.inf for m in self.motions])
        self.stated = np.array([m.minutes for m in self.motions])
        self.seconds = (self.paths.travel / speed + self.stated) * MINUTE
        moved = np.delete(self.paths.end - self.paths.start, self.frame.linear, axis=1)
        at_a_feed = ~self.is_whole & (self.stated == 0.0) & (self.seconds > 0.0)
        self.turns = at_a_feed & (moved != 0.0).any(axis=1)
        self.begins = np.cumsum(self.seconds) - self.seconds
        kinds = [(m.tcpm, m.length) for m in self.motions]
        self.kinds = sorted(set(kinds))
        self.kind = np.array([self.kinds.index(kind) for kind in kinds])
        self.aim = self.frame.datum.deviation(errors)
        self.last = self._last_moves() if _feels_approach(errors) else None
        usual = np.array(errors.state.force or (0.0, 0.0, 0.0))
        lines = [m.line for m in self.motions]
        self.force = forces(lines, program.loads, usual) if program.loads else None

    def readings(self, which: IntArray, at: Array) -> Array:
        """Readings of program coordinates on some motions, (N, A)."""
        return self._each(which, at, self.frame.readings)

    def coordinates(self, which: IntArray, q: Array) -> Array:
        """Program coordinates of readings on some motions, (N, A)."""
        return self._each(which, q, self.frame.coordinates)

    def _each(
        self, which: IntArray, values: Array, convert: Callable[[Array, bool, float], Array]
    ) -> Array:
        out = np.empty_like(values)
        for k, (tcpm, length) in enumerate(self.kinds):
            rows = self.kind[which] == k
            if rows.any():
                out[rows] = convert(values[rows], tcpm, length)
        return out

    def touches(self, which: IntArray, share: Array) -> Touches:
        """Poses on some motions, with their time and the side that each axis comes from."""
        q = self.readings(which, self.paths.at(which, share))
        length = np.array([length for _, length in self.kinds])[self.kind[which]]
        approach = None if self.last is None else self._approach(which, share)
        elapsed = self.begins[which] + share * self.seconds[which]
        touches = self.errors.touches(q, length, approach, elapsed)
        return touches if self.force is None else replace(touches, force=self.force[which])

    def needed(self, which: IntArray, share: Array) -> Array:
        """Program coordinates that bring the tool point where it should be, (N, A)."""
        touches = self.touches(which, share)
        added = correction(self.errors, touches, self.aim)
        return self.coordinates(which, touches.q + added)

    def _moving(self, which: IntArray, share: Array) -> Array:
        """Sign of every axis's motion, (N, A); 0 where it stands."""
        ends = [np.clip(share + step, 0.0, 1.0) for step in (-_STEP, _STEP)]
        before, after = (self.readings(which, self.paths.at(which, s)) for s in ends)
        return np.where(np.abs(after - before) > 1e-9, np.sign(after - before), 0.0)

    def _last_moves(self) -> Array:
        """Sign of the last motion of every axis before each motion begins, (M, A)."""
        at_end = self._moving(np.arange(len(self.motions)), np.ones(len(self.motions)))
        out = np.zeros_like(at_end)
        for k in range(1, len(out)):
            out[k] = np.where(at_end[k - 1] != 0.0, at_end[k - 1], out[k - 1])
        return out

    def _approach(self, which: IntArray, share: Array) -> Array:
        moving = self._moving(which, share)
        assert self.last is not None
        return np.where(moving != 0.0, moving, self.last[which])


_STEP = 1e-4
"""Of a motion, over which its direction is taken."""


def _feels_approach(errors: MachineErrors) -> bool:
    """Whether anything depends on the side that an axis comes from."""
    q = np.zeros((1, len(errors.chain.axes)))
    sides = [errors.contribution(errors.touches(q, 0.0, np.full_like(q, s))) for s in (1.0, -1.0)]
    return not np.array_equal(sides[0].twist, sides[1].twist)


SAMPLES = (0.25, 0.5, 0.75)
"""Of a line, where the path between its ends is looked at: its middle was what divided it."""


def distance_between(path: ProgramPath, which: IntArray, share: Array, written: Array) -> Array:
    """Largest distance from the wanted path between the ends of every line, (N,), mm.

    The control moves the programmed coordinates in proportion from one end to the other. What it
    is off along the wanted path is time, not shape, and does not count.
    """
    out = np.full(len(which), np.nan)
    rows = np.flatnonzero(~path.is_whole[which])
    rows = rows[rows > 0]
    first = np.where(which[rows] == which[rows - 1], share[rows - 1], 0.0)
    motion, worst = which[rows], np.zeros(len(rows))
    for s in SAMPLES:
        at = first + s * (share[rows] - first)
        wanted = path.touches(motion, at)
        q = path.readings(motion, written[rows - 1] + s * (written[rows] - written[rows - 1]))
        nominal = tip(path.errors.chain, wanted.q, wanted.target)
        off = actual_tip(path.errors, shifted(wanted, q - wanted.q)) - nominal - path.aim
        ahead = path.readings(motion, path.paths.at(motion, np.minimum(at + _STEP, 1.0)))
        along = tip(path.errors.chain, ahead, wanted.target) - nominal
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along = np.divide(along, length, out=np.zeros_like(along), where=length > 1e-12)
        off -= np.sum(off * along, axis=1, keepdims=True) * along
        worst = np.maximum(worst, np.linalg.norm(off, axis=1))
    out[rows] = worst
    return out


SAME_TIME = 0.01
"""Share by which the duration of a line may change, whatever its feed refers to."""


def check_duration(path: ProgramPath, which: IntArray, share: Array, written: Array) -> None:
    """Refuse lines whose duration compensation would change on a control that no time is stated to.

    Beside turning axes a feed refers to the path of the linear axes (LinuxCNC) or to the root of
    the sum of squares of mm and degrees (Fanuc); a correction of 0.1 mm that comes to a turn by
    90 degrees makes it one of 0.1 mm. A line passes where both lengths stay what they were.

    Raises:
        BadFile: With the line of the program.
    """
    linear = path.frame.linear
    wanted = path.paths.at(which, share)
    is_first = np.append(True, which[1:] != which[:-1])
    starts = [np.roll(v, 1, axis=0) for v in (wanted, written)]
    begins = path.paths.start[which]
    starts[0][is_first] = begins[is_first]
    is_new = is_first & (np.abs(np.roll(wanted, 1, axis=0) - begins).max(axis=1) > 1e-6)
    is_new[0] = True
    starts[1][is_new] = begins[is_new]
    lengths = []
    for end, start in zip((wanted, written), starts, strict=True):
        moved = end - start
        far = np.linalg.norm(moved[:, linear], axis=1)
        turned = np.linalg.norm(np.delete(moved, linear, axis=1), axis=1) / DEG
        lengths.append([np.bincount(which, v) for v in (far, np.hypot(far, turned))])
    (far, both), (far_now, both_now) = lengths
    is_same = (abs(far_now - far) <= SAME_TIME * far) & (abs(both_now - both) <= SAME_TIME * both)
    changed = np.flatnonzero(path.turns & ~is_same)
    if len(changed):
        motion = path.motions[changed[0]]
        raise BadFile(
            path.program.path,
            f"line {motion.line}",
            f"a turn of {', '.join(motion.turned)} at a feed, beside which a correction of the "
            f"linear axes would change what F refers to",
            path.program.language.TIMED,
        )
