"""Looks at every move of a program, as read from its text, for something in its way."""

from dataclasses import dataclass

import numpy as np

from artefact.body import Meeting, Standard, contact
from artefact.reach import TABLE_RADIUS
from probe_paths.control import Move, ProbeStep, ReadProgram
from probe_paths.plan import Probe, ToolClearance, solid_hull, swing_height, top_height
from twin.errors import BadFile
from twin.frames import Array, apply, inverse
from twin.machine import Chain, tip
from twin.record import IntArray, Labels

SMALLEST_GAP = 0.5
"""Least gap between the probe and anything solid while it is positioned, mm."""

_SMALLEST_STEP = 0.25  # mm, of the march along a move
_MARCHES = 400


@dataclass(frozen=True, eq=False)
class _Moves:
    """Positioning moves between known positions: line in the file, readings before and after."""

    line: IntArray
    before: Array
    after: Array

    def __getitem__(self, rows: IntArray) -> "_Moves":
        return _Moves(self.line[rows], self.before[rows], self.after[rows])


def check_moves(
    program: ReadProgram, standard: Standard, chain: Chain, table_radius: float = TABLE_RADIUS
) -> None:
    """Refuse a program that would drive the probe into the standard or the table.

    The machine and the set-up are taken as nominal. Moves above everything are free; below that
    the ball is marched along each move, never further than its gap, and the whole tool is looked
    at where each move ends. Turning moves are looked at over all positions in between.

    Args:
        program: As read from its text.
        standard: What stands on the table.
        chain: The machine.
        table_radius: Of the table's face, mm.

    Raises:
        BadFile: Line of the first move that comes too near, and what it comes near to.
    """
    probe = Probe(program.heading.radius, program.heading.length)
    setup = program.heading.setup
    solid = solid_hull(standard, setup, table_radius)
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
    clearance = ToolClearance(chain, standard, setup, probe, table_radius)
    if len(low.line):
        gap, nearest = clearance.gap(low.after)
        _refuse(program, low.line, gap, nearest)
        _refuse(program, low.line, _marched(clearance, low), np.full(len(low.line), "the standard"))


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
        travel[active] += np.maximum(gap - SMALLEST_GAP, _SMALLEST_STEP)
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
