"""Programs that a page plays: positions between which every axis moves evenly."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from matstd.compensation.field import MachineErrors
from matstd.compensation.part_programs import Program
from matstd.compensation.programs import passed
from matstd.probe_paths.control import Clock, Move, ProbeStep, ReadProgram, step_times
from matstd.twin.frames import Array, IntArray, unit
from matstd.twin.machine import Chain, linear_directions
from matstd.twin.record import last_signs
from matstd.twin.rows import picked
from matstd.twin.units import DEG

MAX_POSITIONS = 40_000
"""Positions of one page: of a longer program every second, third ... is left out."""

_SMALLEST_MOTION = 1e-9  # an axis that moves less has not moved, mm or rad

_STEP = 6.0 * DEG
"""Between two positions while something turns, rad: even steps between them are 0.15 % short."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Played:
    """Positions of one or more programs in their order, and their text."""

    names: Sequence[str]  # of the programs
    texts: Sequence[str]  # of the programs
    time: Array  # since the start, s, (K,)
    q: Array  # readings, (K, A)
    sides: IntArray  # sign of the last motion of every axis, (K, A)
    length: Array  # of the tool, (K,), mm
    line: IntArray  # of the program's text, (K,)
    which: IntArray  # of the programs, (K,)
    # number of the touch that is being made, 0 for other moves, (K,); None of a part program
    touch: IntArray | None = None
    features: Sequence[dict[int, str]] = ()  # by the number of the touch, for each program
    # outward normal of what is touched, table frame, (K, 3); zero elsewhere
    normal: Array | None = None
    # of the probe from the nearest body, (K,), mm; nan where it is not known
    clearance: Array | None = None
    # name of that body, (K,); None without clearances
    nearest: np.ndarray | None = field(default=None)

    def __len__(self) -> int:
        return len(self.time)

    def place(self, k: int) -> str:
        """Where a position stands in its program, as the control counts: `block 54`, `line 55`."""
        text = self.texts[self.which[k]].splitlines()[self.line[k] - 1]
        numbered = re.match(r"\d+(?= )", text)
        return f"block {numbered[0]}" if numbered else f"line {self.line[k]}"

    def thinned(self, most: int = MAX_POSITIONS) -> "Played":
        """With at most so many positions; those of touches, and the last, stay."""
        if len(self) <= most:
            return self
        keep = np.arange(len(self)) % int(np.ceil(len(self) / most)) == 0
        keep[-1] = True
        if self.touch is not None:
            keep |= self.touch > 0
        return picked(self, np.flatnonzero(keep))


def played_part(program: Program, errors: MachineErrors, text: str) -> Played:
    """A part program on its machine, its positions near enough to one another for the errors."""
    touches, motions = passed(program, errors)
    lines = np.array([m.line for m in program.motions])[motions]
    return Played(
        names=(program.path.name,),
        texts=(text,),
        time=touches.time - errors.state.time,
        q=touches.q,
        sides=last_moves(touches.q),
        length=touches.length,
        line=lines,
        which=np.zeros(len(lines), dtype=np.int64),
    )


def played_probing(
    chain: Chain,
    programs: Sequence[ReadProgram],
    texts: Sequence[str],
    standoff: float | None = None,
) -> Played:
    """Probing programs, with positions often enough while something turns.

    Args:
        texts: Of the programs.
        standoff: From the start of a touch to its surface, mm; None for how far the probe retracts
            afterwards, which is the same in the programs of `matstd design`.
    """
    rows: list[tuple[float, Array, int, int, int]] = []
    lengths: list[float] = []
    begin, rotary = 0.0, chain.rotary_columns
    first = _first_readings(programs)
    for k, program in enumerate(programs):
        to_surface = [t.back if standoff is None else standoff for t in program.touches]
        travel = np.array(
            [
                t.distance if t.is_air else s
                for t, s in zip(program.touches, to_surface, strict=True)
            ]
        )
        times = begin + step_times(chain, program.steps, Clock(), travel)
        for step, time in zip(program.steps, times, strict=True):
            if isinstance(step, Move):
                at = np.where(np.isfinite(step.q), step.q, first)
                row = (float(time), at, step.line, 0, k)
            elif isinstance(step, ProbeStep):
                at = np.where(np.isfinite(step.q), step.q, first)
                at = at + travel[step.index] * step.direction
                row = (float(time), at, step.line, step.number, k)
            else:
                continue
            # the page moves straight from row to row: of a turn that would be a chord
            rows += _between(rows[-1], row, rotary) if rows else []
            rows.append(row)
            lengths += [program.heading.probe.length] * (len(rows) - len(lengths))
        begin = float(times[-1])
    time, q, line, touch, which = (np.array(column) for column in zip(*rows, strict=True))
    return Played(
        names=[program.name for program in programs],
        texts=texts,
        time=time,
        q=q,
        sides=last_moves(q),
        length=np.array(lengths),
        line=line,
        which=which,
        touch=touch,
        features=[
            {t.number: p.features[t.feature] for t in p.touches if not t.is_air} for p in programs
        ],
        normal=_against_motion(chain, programs, q, touch, which),
    )


def _first_readings(programs: Sequence[ReadProgram]) -> Array:
    """The first reading that programs state of every axis, (A,); zero where they state none.

    An axis stands there until a program moves it: where it stood before, no program says.
    """
    moves = [s for p in programs for s in p.steps if isinstance(s, Move | ProbeStep)]
    q = np.array([step.q for step in moves])
    stated = np.isfinite(q)
    return np.nan_to_num(np.take_along_axis(q, stated.argmax(axis=0)[None], axis=0)[0])


def last_moves(q: Array) -> IntArray:
    """Sign of the last motion of every axis on its way through some positions, (K, A).

    Example:
        >>> last_moves(np.array([[0.0], [1.0], [1.0], [0.5]]))[:, 0]
        array([ 0,  1,  1, -1])
    """
    step = np.diff(q, axis=0, prepend=q[:1])
    return last_signs(np.where(np.abs(step) > _SMALLEST_MOTION, np.sign(step), 0.0)).astype(
        np.int64
    )


def _between(
    before: tuple[float, Array, int, int, int],
    row: tuple[float, Array, int, int, int],
    rotary: list[int],
) -> list[tuple[float, Array, int, int, int]]:
    """Further positions of a turn."""
    (t, q, *_), (end, there, *what) = before, row
    pieces = int(np.ceil(np.abs(there - q)[rotary].max(initial=0.0) / _STEP))
    shares = np.linspace(0.0, 1.0, pieces + 1)[1:-1] if pieces > 1 else ()
    return [(t + s * (end - t), q + s * (there - q), what[0], what[1], what[2]) for s in shares]


def _against_motion(
    chain: Chain, programs: Sequence[ReadProgram], q: Array, touch: IntArray, which: IntArray
) -> Array:
    """Direction against which each touch is made, table frame, (K, 3): the normal it looks for."""
    out = np.zeros((len(q), 3))
    linear = chain.linear_columns
    for k, program in enumerate(programs):
        ways = {t.number: t.direction[linear] for t in program.touches if not t.is_air}
        rows = np.flatnonzero((which == k) & (touch > 0))
        if not len(rows):
            continue
        way = np.array([ways[int(number)] for number in touch[rows]])
        out[rows] = -unit(np.einsum("nij,nj->ni", linear_directions(chain, q[rows]), way))
    return out
