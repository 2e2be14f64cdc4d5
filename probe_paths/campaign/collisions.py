"""Looks at every move of a program, as read from its text, for something in its way."""

from dataclasses import dataclass

import numpy as np

from artefact.body import Meeting, Standard, contact
from probe_paths.control import Move, ProbeStep, ReadProgram
from probe_paths.plan import (
    SMALLEST_GAP,
    SMALLEST_STEP,
    ToolClearance,
    solid_hull,
    swing_height,
    top_height,
)
from twin.errors import BadFile
from twin.frames import Array, apply, inverse
from twin.machine import Chain, tip
from twin.record import IntArray, Labels

_MARCHES = 400  # steps as long as the clearance; a path that needs more grazes, and is refused


@dataclass(frozen=True, eq=False)
class _Moves:
    """Positioning moves between known positions: line in the file, readings before and after."""

    line: IntArray
    before: Array
    after: Array

    @property
    def fields(self) -> tuple[IntArray, Array, Array]:
        """Line, readings before, readings after."""
        return self.line, self.before, self.after

    def __getitem__(self, rows: IntArray) -> "_Moves":
        return _Moves(self.line[rows], self.before[rows], self.after[rows])


def check_moves(program: ReadProgram, standard: Standard, chain: Chain) -> None:
    """Refuse a program that would drive the probe into the standard or the table.

    The machine and the set-up are taken as nominal. Moves above everything are free; below that
    the ball and the whole tool are marched along each move, and along each touch until its expected
    contact, never further than their gaps. Turning moves are looked at over all positions between.
    Probe and table are those that the program's head states.

    Args:
        program: As read from its text.
        standard: What stands on the table.

    Raises:
        BadFile: Line of the first move that comes too near, and what it comes near to.
    """
    probe, setup = program.heading.probe, program.heading.setup
    workshop = program.heading.workshop
    assert workshop is not None, "no program is read without it"
    solid = solid_hull(standard, setup, workshop)
    moves = _moves(program)
    rotary = [chain.axis_index(name) for name in chain.rotary_axes]
    z = chain.axis_index("Z")
    turning = np.any(np.abs(moves.after - moves.before)[:, rotary] > 0.0, axis=1)
    for i in np.flatnonzero(turning):
        path = np.stack([moves.before[i, rotary], moves.after[i, rotary]])
        over = moves.after[i, z] - swing_height(chain, path, solid, probe)[0]
        _refuse(program, moves.line[i : i + 1], np.array([over]), np.array(["what turns"]))
    straight = moves[np.flatnonzero(~turning)]
    lowest = np.minimum(straight.before[:, z], straight.after[:, z])
    low = straight[
        np.flatnonzero(lowest < top_height(chain, straight.after[:, rotary], solid, probe))
    ]
    clearance = ToolClearance(
        chain=chain, standard=standard, setup=setup, probe=probe, workshop=workshop
    )
    strokes = _strokes(program, chain)
    if len(low.line):
        _refuse(program, low.line, _marched(clearance, low), np.full(len(low.line), "the standard"))
    swept = _Moves(*(np.concatenate(pair) for pair in zip(low.fields, strokes.fields, strict=True)))
    gap, nearest = clearance.swept_gap(swept.before, swept.after)
    _refuse(program, swept.line, gap, nearest)


def _moves(program: ReadProgram) -> _Moves:
    """Positioning moves of a program; the spindle's column stays at zero."""
    lines, before, after = [], [], []
    here = None
    for step in program.steps:
        if isinstance(step, Move):
            if here is not None and np.array_equal(np.isnan(here), np.isnan(step.q)):
                lines.append(step.line)
                before.append(here)
                after.append(step.q)
            here = step.q
        elif isinstance(step, ProbeStep):
            here = step.q
    width = 0 if here is None else len(here)
    return _Moves(
        np.array(lines, dtype=np.int64),
        np.nan_to_num(np.array(before).reshape(-1, width)),
        np.nan_to_num(np.array(after).reshape(-1, width)),
    )


def _strokes(program: ReadProgram, chain: Chain) -> _Moves:
    """Touches from their starts to the contacts that are expected, as far off as they retract."""
    touches = program.touches
    width = len(chain.axes)
    start = np.array([touch.q for touch in touches]).reshape(-1, width)
    way = np.array([touch.back * touch.direction for touch in touches]).reshape(-1, width)
    return _Moves(np.array([touch.line for touch in touches], dtype=np.int64), start, start + way)


def _marched(clearance: ToolClearance, moves: _Moves) -> Array:
    """Smallest gap of the ball along straight moves, (M,), mm; from below."""
    T_artefact_table = inverse(clearance.setup.T_table_artefact)
    start, end = (
        apply(T_artefact_table, tip(clearance.chain, q, clearance.probe.length))
        for q in (moves.before, moves.after)
    )
    length = np.linalg.norm(end - start, axis=1)
    direction = (end - start) / np.maximum(length, 1e-12)[:, None]
    travel, smallest = np.zeros(len(length)), np.full(len(length), np.inf)
    active = np.arange(len(length))
    for _ in range(_MARCHES):
        centre = start[active] + travel[active, None] * direction[active]
        gap = clearance.standard.distance(centre) - clearance.probe.radius
        smallest[active] = np.minimum(smallest[active], gap)
        # the gap cannot shrink faster than the ball moves
        travel[active] += np.maximum(gap - SMALLEST_GAP, SMALLEST_STEP)
        active = active[(travel[active] < length[active]) & (gap >= SMALLEST_GAP)]
        if not len(active):
            break
    # beside a steep face the distance is far from below: what seems tight is met on exact shapes
    tight = np.flatnonzero(smallest < SMALLEST_GAP)
    wide = clearance.probe.radius + SMALLEST_GAP
    met = contact(clearance.standard, start[tight], direction[tight], wide, length[tight])
    smallest[tight[met.meeting == Meeting.NOTHING]] = SMALLEST_GAP
    return smallest


def _refuse(program: ReadProgram, line: IntArray, gap: Array, nearest: Labels) -> None:
    """Raise BadFile for the first move whose gap is too small."""
    bad = np.flatnonzero(gap < SMALLEST_GAP)
    if len(bad):
        i = bad[np.argmin(line[bad])]
        raise BadFile(
            program.path, f"line {line[i]}", f"a gap of {gap[i]:.2f} mm to {nearest[i]}",
            f"at least {SMALLEST_GAP:g} mm between probe and anything solid",
        )  # fmt: skip
