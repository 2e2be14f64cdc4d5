"""Another probe: what it cannot do is refused, and the rest keeps clear by a checker from outside.

The checker shares nothing with the clearance of plan and collision check: surfaces are clouds of
points, the tool is exact cylinders.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from programs import as_read

from matstd.artefact.reach import ProbeReach, Solid, Workshop, round_table
from matstd.artefact.tool import Probe, solid_hull, swing_height, top_height
from matstd.artefact.tool.heights import NOSE_HEIGHT
from matstd.probe_paths.campaign import check_moves
from matstd.probe_paths.control import Move, ProbeStep
from matstd.probe_paths.emit import Feeds, make_programs
from matstd.probe_paths.plan import Heading, PlanOptions, ToolClearance, parse_heading, plan_touches
from matstd.twin.errors import BadFile
from matstd.twin.frames import apply, turn
from matstd.twin.machine import linear_directions, table_to_tool, tip
from matstd.twin.record import Setup, linear_approach
from matstd.twin.units import DEG

WIDE = Probe(stack=((40.0, 1.5), (160.0, 31.0)), nose_radius=50.0)
"""A common one: stem of 3 x 40 mm, body of 62 mm, spindle nose of 100 mm."""

CLOUD = 2.0
"""Distance of neighbouring points of a cloud, mm."""
MISSED = 1.0
"""How much nearer than its points a surface with edges may be, mm; flat ones are by less."""
PITCH = 6.0
"""Of the places along a move that are looked at, mm."""


def plate(half_x, half_y, z):
    x, y = (np.arange(-h, h + CLOUD, CLOUD).clip(-h, h) for h in (half_x, half_y))
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return np.column_stack([grid, np.full(len(grid), z)])


def ring(radius, z):
    angle = np.linspace(0.0, 2.0 * np.pi, max(int(2.0 * np.pi * radius / CLOUD), 6))
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), z)])


def cloud(standard, setup, table_radius):
    """Points on base, faces, column walls, spheres, stems, and on the table, table frame."""
    base = standard.base
    points = [plate(*base.half_size, base.thickness)]
    for side in (-1.0, 1.0):
        for z in np.arange(0.0, base.thickness + CLOUD, CLOUD).clip(0.0, base.thickness):
            a, b = base.half_size
            x, y = np.arange(-a, a, CLOUD), np.arange(-b, b, CLOUD)
            points += [np.column_stack([x, np.full(len(x), side * b), np.full(len(x), z)])]
            points += [np.column_stack([np.full(len(y), side * a), y, np.full(len(y), z)])]
    for patch in standard.patches:
        a, b = patch.half_size
        uv = plate(a, b, 0.0)[:, :2]
        points.append(patch.point(uv))
        rim = uv[(np.abs(uv[:, 0]) == a) | (np.abs(uv[:, 1]) == b)]
        top = patch.height(rim)
        for share in np.linspace(0.0, 1.0, int((top.max() + patch.depth) / CLOUD)):
            z = -patch.depth + share * (top + patch.depth)
            points.append(apply(patch.T_artefact_patch, np.column_stack([rim, z])))
    for s in standard.spheres:
        for latitude in np.arange(-0.5 * np.pi, 0.5 * np.pi, CLOUD / s.radius):
            on_ball = ring(s.radius * np.cos(latitude), s.radius * np.sin(latitude))
            points.append(s.centre + on_ball)
        for z in np.arange(base.thickness, s.centre[2], CLOUD):
            points.append(ring(s.stem_radius, z) + np.append(s.centre[:2], 0.0))
    table = [ring(r, 0.0) for r in np.arange(CLOUD, table_radius + CLOUD, CLOUD)]
    return np.concatenate([apply(setup.T_table_artefact, np.concatenate(points)), *table])


def cylinder_gap(points, centre, axis, probe):
    """Smallest distance of points (K, 3) from the tool above its ball, exact, mm."""
    along = (points - centre) @ axis
    across = np.linalg.norm(points - centre - along[:, None] * axis, axis=1)
    low = 0.0
    gaps = []
    for high, radius in (*probe.stack, (probe.length + NOSE_HEIGHT, probe.nose_radius)):
        beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
        gaps.append(np.hypot(np.maximum(across - radius, 0.0), beyond).min())
        low = high
    return min(gaps)


def gap_at(points, chain, q, probe):
    centre = tip(chain, q[None], probe.length)[0]
    return cylinder_gap(points, centre, table_to_tool(chain, q[None])[0, :3, 2], probe)


@pytest.fixture(scope="module")
def wide(golden, small, chain):
    """The golden touches, planned for the wide probe."""
    wanted = golden.requests(small, each=4)
    options = PlanOptions(tolerated=len(wanted))
    return plan_touches(small, chain, WIDE, golden.setup(), wanted, options)


@pytest.fixture(scope="module")
def points(wide, small):
    return cloud(small, wide.setup, wide.options.workshop.table_radius)


def test_every_touch_keeps_its_gap_or_is_refused_by_name(wide, points, golden, small, chain):
    assert len(wide.refused) >= 2
    assert np.sum(wide.request >= 0) > 40
    done = {*wide.request[wide.request >= 0].tolist(), *(r.request for r in wide.refused)}
    assert done - {-1} == set(range(len(golden.requests(small, each=4))))
    for refusal in wide.refused:
        assert refusal.feature in str(refusal)
        assert len(refusal.reason) > 10
    for q in np.concatenate([wide.start, wide.contact]):
        assert gap_at(points, chain, q, WIDE) > wide.options.smallest_gap


def test_a_touch_without_room_along_its_normal_is_made_along_a_line_that_leans(wide, chain):
    """It ends where it would have ended, and every axis moves in the sense of the normal."""
    normal = turn(wide.setup.T_table_artefact, wide.normal)
    along = -np.einsum("nij,nj->ni", np.linalg.inv(linear_directions(chain, wide.contact)), normal)
    lean = np.arccos(np.clip(np.einsum("ni,ni->n", along, wide.direction), -1.0, 1.0)) / DEG
    leaning = np.flatnonzero(lean > 0.1)
    assert 1 <= len(leaning) < 0.2 * len(wide)
    assert np.all(np.isin(np.round(lean[leaning], 6), [15.0, 30.0]))
    linear = [chain.axis_index(a) for a in chain.linear_axes]
    way = (wide.contact - wide.start)[:, linear]
    np.testing.assert_allclose(way, wide.options.standoff * wide.direction, atol=1e-9)
    sides = linear_approach(chain, wide.contact, normal)[:, linear]
    assert np.array_equal(np.sign(np.round(wide.direction, 9)), sides)


def test_what_is_refused_for_want_of_room_has_none(wide, points, golden, small, chain):
    """The other way round: refusals are no false alarms."""
    tight = [r for r in wide.refused if r.reason.endswith("at the touch") and r.request >= 0]
    assert tight
    wanted = golden.requests(small, each=4)
    clearance = ToolClearance(chain, small, wide.setup, WIDE, wide.options.workshop)
    probing = ProbeReach(chain, wide.setup, WIDE.shape, WIDE.length)
    for refusal in tight:
        one = wanted[np.array([refusal.request])]
        way = [probing.readings(one, gap)[0] for gap in np.linspace(0.0, wide.options.standoff, 11)]
        assert min(gap_at(points, chain, q, WIDE) for q in way) < 1.0 + MISSED
        assert min(clearance.gap(np.array(way))[0]) < 1.0 + 1e-9


def test_every_move_of_the_program_keeps_clear(wide, points, small, chain):
    """The whole tool every six millimetres, from the text of the first program."""
    made = make_programs(wide, feeds=Feeds(touches_per_file=25))
    z = chain.axis_index("Z")
    highest = points[:, 2].max()
    read = as_read(made, chain)
    assert read.heading.probe == WIDE
    check_moves(read, small, chain)
    here = None
    seen = set()
    for step in read.steps:
        if not isinstance(step, Move | ProbeStep):
            continue
        there = np.nan_to_num(step.q)
        way = None if here is None else there - here
        if isinstance(step, ProbeStep):
            here, way = there, step.back * step.direction
        if way is not None and not np.any(way[[chain.axis_index(a) for a in "BC"]]):
            ends = (tuple(np.round(here, 4)), tuple(np.round(here + way, 4)))
            low = min(here[z], here[z] + way[z])
            if frozenset(ends) not in seen and low < WIDE.length + highest - 500.0:
                seen.add(frozenset(ends))
                count = int(np.linalg.norm(way) / PITCH) + 1
                for share in np.linspace(0.0, 1.0, count + 1):
                    assert gap_at(points, chain, here + share * way, WIDE) > 0.5
        here = there


def other_head(programs, change):
    """The first program with another probe or workshop in its head, and its masks, with hashes."""
    program = programs.programs[0]
    blocks = [re.sub(r"^\d+ ", "", line) for line in program.text.split("\r\n")]
    stated = [line[1:] for line in blocks if line.startswith(";")]
    first = next(i for i, line in enumerate(stated) if line.startswith("STANDARD"))
    heading, count = parse_heading(list(enumerate(stated[first:])), "A.H")
    changed = change(heading)
    old, new = heading.lines, changed.lines
    at = blocks.index(f";{old[0]}")
    assert count == len(old)
    blocks[at : at + count] = [f";{line}" for line in new]
    masks = dict(programs.masks)
    for name, text in masks.items():
        for line, other in zip(heading.log_lines, changed.log_lines, strict=True):
            text = text.replace(f'"{line}"', f'"{other}"')
        masks[name] = text
    return replace(programs, masks=masks), "\r\n".join(blocks)


def test_a_program_for_a_slim_probe_is_refused_with_a_wide_one_in_its_head(programs, small, chain):
    """The same moves, another probe: the check reads it from the text."""
    wide = replace(WIDE, stack=((25.0, 1.5), (160.0, 31.0)))
    made, text = other_head(programs, lambda head: replace(head, probe=wide))
    read = as_read(made, chain, text=text)
    assert read.heading.probe == wide
    with pytest.raises(BadFile, match="a gap of"):
        check_moves(read, small, chain)


def test_a_clamp_in_the_head_is_kept_clear_of(programs, small, chain):
    """A post that stands where the stylus of the third touch goes down."""
    plain = as_read(programs, chain)
    x, y, z = tip(chain, plain.touches[2].q[None], 160.0)[0]
    post = Solid(
        "POST", (6.0, 6.0), True, 0.0, round(z, 1) + 5.0, x=round(x, 1) + 8.4, y=round(y, 1)
    )

    def with_post(head):
        return replace(head, workshop=replace(head.workshop, bodies=(post,)))

    made, text = other_head(programs, with_post)
    read = as_read(made, chain, text=text)
    with pytest.raises(BadFile, match=r"a gap of .* to POST"):
        check_moves(read, small, chain)


def test_a_body_that_somebody_changed_by_hand_is_refused(programs, chain):
    text = programs.programs[0].text.replace("STACK TO+80.000000 R+2.0", "STACK TO+80.000000 R+1.0")
    with pytest.raises(BadFile, match=r"a probe and bodies of hash .* as stated: emit"):
        as_read(programs, chain, text=text)


def test_a_head_without_probe_and_table_is_refused(programs, chain):
    text = re.sub(r"(?m)^\d+ ", "", programs.programs[0].text)
    text = re.sub(r"(?m)^;(STACK|NOSE|BODY|AT) .*\r\n", "", text)
    with pytest.raises(BadFile, match="emit the program again"):
        as_read(programs, chain, text=text)


def test_a_heading_states_probe_and_workshop_and_reads_them_back():
    clamp = Solid("CLAMP", (20.0, 15.0), False, 0.0, 30.0, 100.0, -20.5, 30.0 * DEG, on="B")
    room = Workshop(round_table(175.0, -2.0), (clamp,))
    heading = Heading("S", Setup("a"), WIDE, room, "4711", "ABC")
    back, count = parse_heading(list(enumerate(heading.lines, start=3)), "A.H")
    assert count == len(heading.lines)
    assert (back.probe, back.serial, back.calibration) == (WIDE, "4711", "ABC")
    assert back.workshop_hash == heading.workshop_hash
    found = back.workshop.bodies[0]
    assert (found.name, found.half_size, found.on) == ("CLAMP", (20.0, 15.0), "B")
    assert abs(found.turn - clamp.turn) < 1e-9
    assert max(map(len, heading.lines)) < 64
    logged, _ = parse_heading(list(enumerate(heading.log_lines, start=3)), "A.TXT")
    assert (logged.workshop, logged.workshop_hash) == (None, heading.workshop_hash)
    broken = [*heading.lines[:7], "STACK L80", *heading.lines[8:]]
    with pytest.raises(BadFile, match=r"line 10: .*STACK TO"):
        parse_heading(list(enumerate(broken, start=3)), "A.H")


def test_logs_of_earlier_programs_are_read():
    older = Heading("S", Setup("a"), Probe(3.0, 160.0), None, "4711").lines
    older[4:4] = ["STYLUS L+80.000000 R+2.000000 BODY R+25.000000", "NOSE R+45.0 TABLE R+160.0"]
    back, count = parse_heading(list(enumerate(older, start=3)), "A.TXT")
    assert (back.workshop, back.serial, count) == (None, "4711", 7)


def test_a_swing_is_never_higher_than_stated(golden, small, chain):
    """Against 200 places of a turn of both axes, one after the other in either order."""
    solid = solid_hull(small, golden.setup(), Workshop())
    rng = np.random.default_rng(5)
    low, high = np.array([[-170.0, 170.0], [-100.0, 25.0]]).T * DEG
    for _ in range(20):
        start, end = rng.uniform(low, high), rng.uniform(low, high)
        stated = swing_height(chain, np.array([start, end]), solid, WIDE)[0]
        share = rng.uniform(0.0, 1.0, (200, 2))
        between = start + share * (end - start)
        assert top_height(chain, between, solid, WIDE).max() <= stated


def test_a_sideways_move_is_swept_with_the_whole_tool(read, small, chain):
    """The body meets what the ball passes below: a column beside the way."""
    first = read[0]
    setup = first.heading.setup
    clearance = ToolClearance(
        chain, small, setup, Probe(stack=((20.0, 2.0), (160.0, 25.0))), Workshop()
    )
    q = np.nan_to_num(first.touches[0].q)
    q[[chain.axis_index(a) for a in "BC"]] = 0.0
    before, after = q.copy(), q.copy()
    x, y, z = (chain.axis_index(a) for a in "XYZ")
    # the ball at z = 30 over the base of 20 mm passes beside a sphere's stem at x 72, y 32
    before[[x, y, z]] = [-140.0, 0.0, 160.0 - 500.0 + 30.0]
    after[[x, y, z]] = [160.0, 0.0, 160.0 - 500.0 + 30.0]
    ends, _ = clearance.gap(np.array([before, after]))
    swept, nearest = clearance.swept_gap(before[None], after[None])
    assert ends.min() > 0.5
    assert swept[0] < 0.5
    assert nearest[0]


def test_a_thin_probe_reaches_more_than_a_wide_one(golden, small, chain, wide):
    wanted = golden.requests(small, each=4)
    slim = Probe(stack=((80.0, 1.5), (160.0, 20.0)), nose_radius=40.0)
    options = PlanOptions(tolerated=len(wanted))
    plan = plan_touches(small, chain, slim, golden.setup(), wanted, options)
    assert len(plan.refused) < len(wide.refused)
