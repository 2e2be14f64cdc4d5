"""A part program on the machine that runs it: places, times and poses along its motions."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from matstd.compensation.field import (
    MachineErrors,
    correction,
    feels_direction,
    sample_workspace,
)
from matstd.compensation.part_programs import Paths, Program, forces
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches, last_signs
from matstd.twin.units import DEG, MINUTE

RAPID = 10_000.0
"""Speed of rapid motions where a time is needed, mm/min; drift hardly depends on it."""


def are_first(which: IntArray) -> Mask:
    """Which lines are the first of their motions, (N,)."""
    return np.append(True, which[1:] != which[:-1])


def shares_of_lines(which: IntArray, share: Array) -> Array:
    """Share of its motion that every line is, from the shares at the ends of lines, (N,)."""
    return np.where(are_first(which), share, np.diff(share, prepend=0.0))


class ProgramPath:
    """Every motion of a program on the machine that runs it."""

    def __init__(self, program: Program, errors: MachineErrors) -> None:
        self.program, self.errors = program, errors
        self.motions, self.frame = program.motions, program.frame
        self.paths = Paths(self.motions, self.frame.linear)
        self.is_whole = np.array([m.is_rapid or m.cycle is not None for m in self.motions])
        self.offset = np.array([m.offset for m in self.motions])
        self.is_from_known = np.array([m.is_from_known for m in self.motions])
        speed = np.array([RAPID if m.is_rapid else m.feed or np.inf for m in self.motions])
        stated = np.array([m.minutes for m in self.motions])
        self.seconds = (self.paths.travel / speed + stated) * MINUTE
        self.begins = np.cumsum(self.seconds) - self.seconds
        kinds = [(m.tcpm, m.length) for m in self.motions]
        self.kinds = sorted(set(kinds))
        self.kind = np.array([self.kinds.index(kind) for kind in kinds])
        self.aim = self.frame.datum.deviation(errors)
        self.last = self._last_moves() if self._feels_direction() else None
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

    def rounded(self, which: IntArray, at: Array) -> Array:
        """Coordinates as they are written; axes that a motion does not turn stay as they were."""
        chain = self.errors.chain
        out = at.copy()
        offset = self.offset[which]
        unit = np.array([m.unit for m in self.motions])[which]
        for axis in chain.programmed_axes:
            k = chain.axis_index(axis)
            is_length = chain.link(axis).kind == "linear"
            one, digits = unit if is_length else DEG, self.program.language.DIGITS
            places = np.where(is_length & (unit != 1.0), digits.inch, digits.usual)
            step = one * 10.0**-places
            out[:, k] = np.round((at[:, k] - offset[:, k]) / step) * step + offset[:, k]
        return out

    def begins_at(self, which: IntArray, written: Array) -> Array:
        """Where every line begins, in the coordinates of its own motion, (N, A).

        That is where the line before has ended, whatever coordinates and tool it had; of a motion
        from a place that is not known, where the program has it.
        """
        q = self.readings(which, written)
        out = self.coordinates(which, np.vstack([q[:1], q[:-1]]))
        rows = np.flatnonzero(are_first(which) & ~self.is_from_known[which])
        out[rows] = self.paths.start[which[rows]]
        return out

    def _feels_direction(self) -> bool:
        chain = self.errors.chain
        return feels_direction(self.errors, sample_workspace(chain, {}, _TRIED_POSES))

    def _moving(self, which: IntArray, share: Array) -> Array:
        """Sign of every axis's motion, (N, A); 0 where it stands."""
        ends = [np.clip(share + step, 0.0, 1.0) for step in (-_STEP, _STEP)]
        before, after = (self.readings(which, self.paths.at(which, s)) for s in ends)
        return np.where(np.abs(after - before) > 1e-9, np.sign(after - before), 0.0)

    def _last_moves(self) -> Array:
        """Sign of the last motion of every axis before each motion begins, (M, A)."""
        at_end = self._moving(np.arange(len(self.motions)), np.ones(len(self.motions)))
        return np.vstack([np.zeros_like(at_end[:1]), last_signs(at_end[:-1])])

    def _approach(self, which: IntArray, share: Array) -> Array:
        moving = self._moving(which, share)
        assert self.last is not None
        return np.where(moving != 0.0, moving, self.last[which])


_TRIED_POSES = 16  # at which a reversal is looked for: a law's may be zero at single ones
_STEP = 1e-4  # share of a motion over which its direction is taken
