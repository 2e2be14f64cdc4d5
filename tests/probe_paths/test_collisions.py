"""Changes of a number that no grammar sees: the move itself shows them, or the log does."""

import re
from dataclasses import replace

import numpy as np
import pytest
from programs import as_read, parts_of, ran

from matstd.artefact.reach import Workshop
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import check_moves, evaluate
from matstd.probe_paths.campaign.collisions import SMALLEST_GAP
from matstd.probe_paths.control import Move
from matstd.probe_paths.plan import ToolClearance
from matstd.probe_paths.plan.bodies import Bodies
from matstd.probe_paths.plan.clearance import Stage
from matstd.twin.errors import BadFile
from matstd.twin.frames import apply, inverse
from matstd.twin.machine import tip
from matstd.twin.record import Setup
from matstd.twin.units import UM

HAND = 0.02
"""A gap by hand, mm."""


def test_programs_as_made_are_free(read, small, chain):
    for program in read:
        check_moves(program, small, chain)


def sideways(program, chain, up, q_to):
    """The program with a rapid move to the side, `up` above the start of its first touch."""
    touch = program.touches[0]
    above = touch.q.copy()
    above[chain.axis_index("Z")] += up
    there = above.copy()
    there[[chain.axis_index("X"), chain.axis_index("Y")]] += q_to
    steps = [Move(901, above, None), Move(902, there, None)]
    place = program.steps.index(touch)
    return replace(program, steps=(*program.steps[:place], *steps)), above, there


def test_a_move_through_the_standard_is_found_where_the_gap_closes(read, small, chain):
    """Against the smallest distance at 4001 places along the move."""
    T_artefact_table = inverse(read[0].heading.setup.T_table_artefact)
    found = []
    for up in (0.0, 10.0, 20.0, 30.0, 45.0, 60.0):
        program, above, there = sideways(read[0], chain, up, (150.0, -60.0))
        share = np.linspace(0.0, 1.0, 4001)[:, None]
        centre = tip(chain, above + share * (there - above), 160.0)
        gap = small.distance(apply(T_artefact_table, centre)).min() - 3.0
        try:
            check_moves(program, small, chain)
            found.append(False)
        except BadFile as error:
            found.append("line 902: found a gap of" in str(error))
        assert found[-1] or gap >= SMALLEST_GAP
    assert found[0]
    assert not found[-1]


def test_a_touch_begun_at_the_wrong_place_is_found(programs, chain, small):
    """X of a touch with its sign lost, at the clearance height and back to it alike."""
    first = programs.programs[0].text
    touches = re.findall(r"L (X([+-])(\S+)) Y\S+ R0 FMAX", first)
    found = []
    for word, sign, value in touches[:8]:
        other = f"X{'-' if sign == '+' else '+'}{value}"
        text = first.replace(f"{word} ", f"{other} ")
        read = as_read(programs, chain, text=text)
        try:
            check_moves(read, small, chain)
        except BadFile as error:
            found.append(str(error))
    assert len(found) >= 2
    assert all("a gap of" in line or " on " in line for line in found)


def test_a_start_inside_the_standard_is_found(programs, chain, small):
    """Twelve millimetres too deep: standoff 5, ball 3."""
    first = programs.programs[0].text
    word = re.search(r"L (Z\+(\S+)) R0 F2000", first)
    deeper = f"Z{float(word[2]) - 12.0:+.4f}"
    text = first.replace(word[1], deeper)
    read = as_read(programs, chain, text=text)
    with pytest.raises(BadFile, match="a gap of"):
        check_moves(read, small, chain)


@pytest.mark.parametrize(
    ("feature", "own"), [("S1", ["S1", "S1 stem"]), ("FF1", ["FF1"]), ("DATUM_A", ["BASE"])]
)
def test_a_touch_may_come_close_to_what_carries_its_feature(feature, own) -> None:
    names = np.array(["BASE", "CORE", "FF1", "S1", "S1 stem", "S2", "S2 stem"])
    bodies = Bodies(hulls=None, name=names, on=np.full(len(names), ""), parts={})
    assert names[bodies.rows_of(feature)].tolist() == own


def test_a_feature_number_mixed_up_is_found_when_the_log_is_evaluated(
    programs, chain, small, perfect
):
    first = programs.programs[0].text
    numbers = re.findall(r"Q1622 = \+(\d)", first)
    other = next(n for n in numbers if n != numbers[3])
    lines = first.split("\r\n")
    at = [i for i, line in enumerate(lines) if "Q1622" in line][3]
    lines[at] = lines[at].replace(f"+{numbers[3]}", f"+{other}")
    read = as_read(programs, chain, text="\r\n".join(lines))
    found = evaluate(parts_of([ran(read, small, perfect)], chain), small, chain, UM)
    assert len(found) == len(read.touches) - 1
    assert any("touch 4 with" in remark for remark in found.remarks)


def test_gaps_to_the_table_by_hand(chain, small):
    """At B = C = 0 the body hangs over the table: its lower face is its distance above it."""
    clearance = ToolClearance(
        chain, small, Setup("a"), Probe(stack=((60.0, 2.0), (160.0, 20.0))), Workshop()
    )
    # ball centre at x 120, y 120 and 5 mm above the table, beside the base of 80 x 80
    q = np.zeros((1, len(chain.axes)))
    q[0, [chain.axis_index(a) for a in "XYZ"]] = [110.0, 110.0, 160.0 - 500.0 + 5.0]
    gap, nearest = clearance.swept_gap(q, q, enough=np.inf)
    assert nearest[0] == "the table"
    assert abs(gap[0] - 2.0) < HAND
    # without the ball it is the stylus where it comes out of the ball
    assert abs(clearance.gap(q)[0][0] - (5.0 + np.sqrt(3.0**2 - 2.0**2))) < HAND
    # 50 mm beside a column wall of FF1, on the height of its middle; the body is 20 mm thick
    q[0, [chain.axis_index(a) for a in "XYZ"]] = [-65.0, 0.0, 160.0 - 500.0 + 35.0]
    gap, nearest = clearance.gap(q)
    assert nearest[0] in ("BASE", "FF1")
    assert gap[0] > 10.0


@pytest.mark.parametrize(("radius", "beside"), [(0.75, 0.25), (1.0, 1.0 / 3.0), (3.0, 0.5)])
def test_a_small_ball_has_less_room_where_it_touches_and_nowhere_else(radius, beside):
    """Its stylus of two thirds has a third of the radius beside a wall that the ball touches."""
    least = {stage: stage.least_gap(radius) for stage in Stage}
    assert least.pop(Stage.TOUCH) == pytest.approx(beside)
    assert set(least.values()) == {SMALLEST_GAP}
    stylus = Probe(radius=radius).stack[0][1]
    assert beside <= radius - stylus + 1e-12
