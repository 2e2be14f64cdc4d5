"""Collision check of every move of a program, as read from its text."""

import numpy as np

from matstd.artefact.body import Meeting, Standard, contact
from matstd.artefact.tool import solid_hull, swing_height, top_height
from matstd.probe_paths.control import Move, ProbeStep, ReadProgram
from matstd.probe_paths.plan import SMALLEST_GAP, ToolClearance, stroke_gaps
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray, Mask, apply, inverse, turn
from matstd.twin.machine import Chain, linear_directions, tip
from matstd.twin.record import Labels


def check_moves(program: ReadProgram, standard: Standard, chain: Chain) -> None:
    """Refuse a program that would drive the probe into an obstacle.

    Machine and set-up are nominal; probe and workshop are those stated in the head. Low moves of
    the linear axes are swept with ball and tool, and so is every touch: to its contact, beyond it
    if the surface is missed, and the retract. The ball must meet the stated feature first. Rotary
    moves are checked at all intermediate positions, and a head that carries the tool turns at one
    place.

    Raises:
        BadFile: Line of the first move that comes too close, and the obstacle.
    """
    probe, setup = program.heading.probe, program.heading.setup
    workshop = program.heading.workshop
    assert workshop is not None, "no program is read without it"
    standard = program.heading.touched(standard)
    clearance = ToolClearance(
        chain=chain, standard=standard, setup=setup, probe=probe, workshop=workshop
    )
    solid = solid_hull(standard, setup, workshop)
    _check_turning_place(program, chain)
    line, before, after = _moves(program)
    rotary = chain.rotary_columns
    z = chain.axis_index("Z")
    is_turning = np.any(np.abs(after - before)[:, rotary] > 0.0, axis=1)
    for i in np.flatnonzero(is_turning):
        path = np.stack([before[i, rotary], after[i, rotary]])
        level = min(before[i, z], after[i, z])
        over = level - swing_height(chain, path, solid, probe, level - SMALLEST_GAP)[0]
        _refuse(program, line[i : i + 1], np.array([over]), np.array(["what turns"]))
    lowest = np.minimum(before[:, z], after[:, z]) - SMALLEST_GAP
    is_low = lowest < top_height(chain, after[:, rotary], solid, probe)
    low = np.flatnonzero(is_low & ~is_turning)
    ends = np.round(np.concatenate([before[low], after[low]], axis=1), 6)
    # a move down and the same move up are swept once
    back = np.concatenate([after[low], before[low]], axis=1)
    is_later = [tuple(a) > tuple(b) for a, b in zip(ends, np.round(back, 6), strict=True)]
    ends[is_later] = back[is_later]
    _, first = np.unique(np.round(ends, 6), axis=0, return_index=True)
    low = low[np.sort(first)]
    gap, nearest = clearance.swept_gap(before[low], after[low])
    _refuse(program, line[low], gap, nearest)
    _check_touches(program, clearance)


def _check_turning_place(program: ReadProgram, chain: Chain) -> None:
    """Refuse a program whose head turns anywhere but at one commanded place; raises BadFile.

    A program of an earlier version turns its head elsewhere: its logs are evaluated, but it is not
    run again.
    """
    xy = [chain.axis_index(a) for a in "XY"]
    head = [chain.axis_index(a) for a in chain.tool_rotary_axes]
    before = place = np.full(len(chain.axes), np.nan)
    for step in program.steps:
        if not isinstance(step, Move | ProbeStep):
            continue
        # a head that stands at an unknown reading turns too
        is_same = np.array_equal(step.q[head], before[head], equal_nan=True)
        if isinstance(step, Move) and not is_same:
            place = step.q if np.isnan(place[xy]).any() else place
            if not np.array_equal(step.q[xy], place[xy]):
                names = " and ".join(chain.tool_rotary_axes)
                found = f"{names} turning at {_stated_place(step.q[xy])}"
                expected = f"{_stated_place(place[xy])}, the one place of its turns"
                if np.isnan(step.q[xy]).any():
                    expected = "X and Y commanded before, and one place for all turns"
                expected += ": emit the programs again"
                raise BadFile(program.path, step.line, found, expected)
        before = step.q


def _stated_place(xy: Array) -> str:
    """X and Y as words; unknown where they have not been commanded."""
    if np.isnan(xy).any():
        return "unknown X and Y"
    return " ".join(f"{a}{v:+.4f}" for a, v in zip("XY", xy, strict=True))


def _moves(program: ReadProgram) -> tuple[IntArray, Array, Array]:
    """Moves between known positions: line, readings before and after; spindle at zero."""
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
    return (
        np.array(lines, dtype=np.int64),
        np.nan_to_num(np.array(before).reshape(-1, width)),
        np.nan_to_num(np.array(after).reshape(-1, width)),
    )


def _check_touches(program: ReadProgram, clearance: ToolClearance) -> None:
    """Check every touch, its over-travel and its retract; raises BadFile."""
    touches, chain = program.touches, clearance.chain
    line = np.array([touch.line for touch in touches], dtype=np.int64)
    start = np.array([touch.q for touch in touches]).reshape(-1, len(chain.axes))
    direction = np.array([touch.direction for touch in touches]).reshape(start.shape)
    back = np.array([touch.back for touch in touches])
    distance = np.array([touch.distance for touch in touches])
    names = [program.features.get(touch.feature, "") for touch in touches]
    feature = np.array(names, dtype="U32")
    is_air = np.array([touch.is_air for touch in touches], dtype=bool)
    T_artefact_table = inverse(clearance.setup.T_table_artefact)
    along = linear_directions(chain, start)
    motion = np.einsum("nij,nj->ni", along, direction[:, chain.linear_columns])
    way = turn(T_artefact_table, motion)
    centre = apply(T_artefact_table, tip(chain, start, clearance.probe.length))
    met = contact(clearance.standard, centre, way, clearance.probe.radius, distance)
    # the touches of a search may meet any feature
    if program.is_search:
        words = np.array(
            [f"{what} {name}".rstrip() for what, name in zip(met.meeting, met.feature, strict=True)]
        )
        is_met = np.isfinite(met.travel) & (met.meeting != Meeting.INSIDE)
        _check_search(program, clearance, start + met.travel[:, None] * direction, is_met, words)
        return
    good = (met.meeting == Meeting.SURFACE) & (met.feature == feature)
    good = np.where(is_air, met.meeting == Meeting.NOTHING, good)
    for i in np.flatnonzero(~good)[:1]:
        found = f"a ball that {met.meeting[i]} {met.feature[i]}".rstrip()
        wanted = f"touch {touches[i].number} on {feature[i]}"
        raise BadFile(program.path, line[i], found, "a touch in the air" if is_air[i] else wanted)
    looks = stroke_gaps(clearance, start, direction, back, distance, feature, SMALLEST_GAP)
    for stage, (gap, nearest) in looks.items():
        least = stage.least_gap(clearance.probe.radius)
        _refuse(program, line, gap, np.array([f"{name} {stage}" for name in nearest]), least)


def _check_search(
    program: ReadProgram, clearance: ToolClearance, end: Array, is_met: Mask, met: Labels
) -> None:
    """Long touches from above: the ball meets something before the tool does; raises BadFile."""
    line = np.array([touch.line for touch in program.touches], dtype=np.int64)
    for i in np.flatnonzero(~is_met)[:1]:
        expected = "something of the standard under it"
        raise BadFile(program.path, line[i], f"a ball that {met[i]}", expected)
    start = np.array([touch.q for touch in program.touches])
    gap, nearest = clearance.swept_gap(start, end, with_ball=False)
    _refuse(program, line, gap, nearest)


def _refuse(
    program: ReadProgram, line: IntArray, gap: Array, nearest: Labels, least: float = SMALLEST_GAP
) -> None:
    """Raise BadFile for the first move whose gap is too small."""
    bad = np.flatnonzero(gap < least)
    if len(bad):
        i = bad[np.argmin(line[bad])]
        raise BadFile(
            program.path,
            line[i],
            f"a gap of {gap[i]:.2f} mm to {nearest[i]}",
            f"at least {least:.2g} mm between probe and anything solid",
        )
