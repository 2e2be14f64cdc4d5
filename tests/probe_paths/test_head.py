"""A head that carries the tool turns at one known place; distances by hand, from the text alone.

The gantry: pivot 650 mm above the gauge point, ball 240 mm below it, so 890 mm from pivot to ball;
table of 3000 x 2000 mm within the travels. With A and C the ball is at

    X + 890 sin(A) sin(-C),  Y + 890 sin(A) cos(C),  Z + 650 - 890 cos(A).
"""

import re

import numpy as np
import pytest
from programs import as_read, parts_of, ran

from matstd.artefact.reach import Solid, Workshop, joined
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import VirtualMachine, check_moves, evaluate
from matstd.probe_paths.emit import Feeds, make_dry_run, make_programs
from matstd.probe_paths.language import Dialect, read_dialect
from matstd.probe_paths.locate import companions
from matstd.probe_paths.plan import PlanOptions, plan_touches, requests_at
from matstd.probe_paths.stations import Station
from matstd.report.machine import head_sections
from matstd.report.pages.setup_page import write_setup_page
from matstd.twin.errors import BadFile, NotReachable
from matstd.twin.frames import pose
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

ARM = 890.0
"""From the pivot to the ball centre of the gantry, mm."""

SPARE = 2.5
"""What a stated space may be larger than by hand, mm: between samples, and whole millimetres."""

CONTROLS = ("itnc530", "linuxcnc")
POSES = ((0.0, 0.0), (-120.0, 30.0), (150.0, -35.0), (40.0, 20.0))
"""C and A of the gantry, degrees; each is approached from 5 degrees beside."""


def gantry(y: float = 2000.0):
    """A portal over a table with a fork head."""
    axes = {
        "X": Axis((0.0, 3000.0)),
        "Y": Axis((0.0, y)),
        "Z": Axis((-1000.0, 0.0)),
        "C": Axis((-200.0 * DEG, 200.0 * DEG), (0.0, 0.0, 650.0)),
        "A": Axis((-110.0 * DEG, 110.0 * DEG), (0.0, 0.0, 650.0)),
    }
    return make_chain("gantry", "[w f X Y Z C A (C1) t]", axes, (1500.0, 0.5 * y, -1100.0))


def head_table():
    """A tilting head over a table that X and C move."""
    axes = {
        "X": Axis((-600.0, 600.0)),
        "Y": Axis((-400.0, 400.0)),
        "Z": Axis((-650.0, 100.0)),
        "B": Axis((-30.0 * DEG, 110.0 * DEG), (0.0, 0.0, 200.0)),
        "C": Axis((-360.0 * DEG, 360.0 * DEG)),
    }
    return make_chain("head-table", "[w C' X' f Y Z B (C1) t]", axes, (0.0, 0.0, -500.0))


def planned(golden, chain, at=(0.0, 0.0), poses=POSES, length=240.0, bodies=()):
    """Touches on one face at some poses, the standard at a place of the table."""
    small, uv = golden.standard(), np.array([[0.0, 3.0], [5.0, -4.0], [2.0, 2.0], [-4.0, 1.0]])
    wanted = joined([requests_at(small, "FF1", uv, np.array(p) * DEG) for p in poses])
    setup = Setup("a", pose(np.eye(3), np.array([*at, 0.0])))
    options = PlanOptions(workshop=Workshop(bodies=tuple(bodies)))
    return plan_touches(small, chain, Probe(length=length), setup, wanted, options)


@pytest.fixture(scope="module")
def plan(golden):
    return planned(golden, gantry())


@pytest.fixture(scope="module", params=CONTROLS)
def made(request, plan):
    return make_programs(plan, read_dialect(request.param), Feeds(touches_per_file=14))


def turns_in(text, preset=(1500.0, 1000.0)):
    """X, Y, Z of the machine, and A and C before and after, of every turn of the head in a text."""
    here, out = {}, []
    for line in text.splitlines():
        line = re.sub(r"^\d+ ", "", line)
        words = dict(re.findall(r"(?<=[ ])([XYZAC])([+-][\d.]+)", line))
        if re.match(r"T\d+ M6|TOOL CALL", line):
            here = {a: v for a, v in here.items() if a in "AC"}
        if not re.match(r"L |G[01] |G53 G0 ", line) or not words:
            continue
        is_machine = line.endswith("M91") or line.startswith("G53")
        after = here | {a: float(v) for a, v in words.items()}
        for a, zero in zip("XY", preset, strict=True):
            if a in words and not is_machine:
                after[a] += zero
        if {"A", "C"} & set(words):
            assert set("XYZ") <= set(here), f"{line}: the head turns before X and Y are commanded"
            place = tuple(here[a] for a in "XYZ")
            out.append((place, {a: here.get(a) for a in "AC"}, after))
        here = after
    return out


def ball(place, c, a):
    """Ball centre, machine coordinates, from the closed form above."""
    x, y, z = place
    c, a = np.radians(c), np.radians(a)
    return np.stack(
        np.broadcast_arrays(
            x - ARM * np.sin(a) * np.sin(c),
            y + ARM * np.sin(a) * np.cos(c),
            z + 650.0 - ARM * np.cos(a),
        )
    )


def test_the_head_turns_at_one_place_and_keeps_the_ball_over_the_table(made, plan):
    """All turns of all files, in 30 x 30 positions of A and C between each pair of ends."""
    low, high = plan.head_turns.planned
    count = 0
    for program in made.programs:
        for place, before, after in turns_in(program.text):
            assert place == (1500.0, 1000.0, -1.0)
            if before["A"] is None:  # from wherever the tool change left it, only fed
                continue
            a, c = (np.linspace(before[n], after[n], 30) for n in "AC")
            swept = ball(place, c[:, None], a[None])
            assert np.all(swept[0] >= 0.0)
            assert np.all(swept[0] <= 3000.0)
            assert np.all(swept[1] >= 0.0)
            assert np.all(swept[1] <= 2000.0)
            ends = swept.reshape(3, -1)
            assert np.all(ends.min(axis=1) - 3.0 >= low)
            assert np.all(ends.max(axis=1) + 3.0 <= high)
            count += 1
    assert len(made.programs) > 1
    # past each position and towards it, and home
    assert count == 2 * len(plan.visits) + len(made.programs)


def test_the_first_turn_is_fed_and_the_head_states_the_place(made):
    for program in made.programs:
        lines = [re.sub(r"^\d+ ", "", line) for line in program.text.splitlines()]
        turns = [line for line in lines if re.search(r" A[+-]", line) and line[:1] in "LG"]
        assert re.search(r"A\+0\.0000 C\+0\.0000 (R0 )?F1000", turns[0])
        (said,) = [line for line in lines if "HEAD TURNS" in line]
        assert "X+1500 Y+1000 OF THE MACHINE" in said
        assert max(map(len, program.text.splitlines())) <= 72 or program.ending == ".ngc"


def test_the_stated_space_by_hand(plan):
    """A to 40 degrees either way, C from -125 to 155: the ball goes 890 sin 40 = 572.1 mm out.

    On X it reaches that at C = 90 and -90, on -Y at C = 0. On +Y it reaches 890 sin 40 cos 25 =
    518.5 mm at C = 155, more than 890 sin 35 at C = 0. The lowest place is the pole of the upright
    ball, 1 + 243 mm below the machine's zero.
    """
    turns = plan.head_turns
    np.testing.assert_allclose(turns.limits / DEG, [[-125.0, 155.0], [-40.0, 35.0]], atol=1e-9)
    out = ARM * np.sin(40.0 * DEG) + 3.0
    up = 1000.0 + 518.5 + 3.0
    hand = np.array([[1500.0 - out, 1000.0 - out, -244.0], [1500.0 + out, up, np.nan]])
    more = np.abs(turns.planned - hand)[~np.isnan(hand)]
    assert np.all(turns.planned[0] <= hand[0])
    assert np.all(turns.planned[1, :2] >= hand[1, :2])
    assert more.max() < SPARE
    # from any position: a quarter turn of A either way, at any C
    whole = np.array([1500.0 - ARM - 3.0, 1500.0 + ARM + 3.0])
    assert np.all(np.abs(turns.anywhere[:, 0] - whole) < SPARE)


@pytest.mark.parametrize(
    ("at", "y", "expected"),
    [
        ((0.0, 0.0), 2000.0, (1500.0, 1000.0)),
        # 893 mm from the pivot to the pole of the ball, and from there to the ends of the travels
        ((1300.0, 850.0), 2000.0, (3000.0 - 893.0, 2000.0 - 893.0)),
        ((-1300.0, -850.0), 2000.0, (893.0, 893.0)),
        # Y is shorter than 2 x 893 mm: its middle
        ((0.0, 200.0), 1400.0, (1500.0, 700.0)),
    ],
)
def test_the_place_is_over_the_standard_or_as_near_as_the_travels_allow(golden, at, y, expected):
    small = (POSES[0],)
    turns = planned(golden, gantry(y), at, small).head_turns
    assert np.all(np.abs(turns.place[:2] - expected) < SPARE)
    assert np.all(turns.place[:2] == np.round(turns.place[:2]))
    low, high = turns.anywhere
    assert low[0] >= 0.0
    assert high[0] <= 3000.0
    if y == 2000.0:
        assert low[1] >= 0.0
        assert high[1] <= y
    else:  # as far beyond one end as the other
        assert low[1] == pytest.approx(y - high[1], abs=1.0)


def test_a_head_over_a_table_that_moves(golden):
    """B to 35 degrees: 360 sin 35 = 206.5 mm to -X and, at -5 degrees, 31.4 mm to +X.

    There the rim of the nose decides, 45 mm from its axis: 200 sin 5 - 45 cos 5 and beyond it. To
    +Y and -Y the nose alone reaches, 45 mm. The table may turn anywhere.
    """
    plan = planned(golden, head_table(), (12.0, -8.0), ((0.0, 20.0), (-120.0, 30.0)), 160.0)
    turns = plan.head_turns
    assert turns.place.tolist() == [12.0, -8.0, 99.0]
    np.testing.assert_allclose(turns.limits / DEG, [[0.0, 35.0]], atol=1e-9)
    (x, y, z), (to_x, to_y, _) = turns.planned
    assert 12.0 - 360.0 * np.sin(35.0 * DEG) - 3.0 - SPARE < x < 12.0 - 209.4
    # the rear rim of the nose: 50 mm below the pivot, 45 mm beside the axis, upright and tilted
    assert 12.0 + 45.0 <= to_x < 12.0 + 45.0 + SPARE
    assert -8.0 - 45.0 - SPARE < y <= -53.0
    assert 37.0 <= to_y < 37.0 + SPARE
    assert 99.0 - 163.0 - SPARE < z <= 99.0 - 163.0
    program = make_programs(plan).programs[0]
    lines = [re.sub(r"^\d+ ", "", line) for line in program.text.splitlines()]
    for i, line in enumerate(lines):
        if re.match(r"L B", line) and not re.match(r"L [XB]", lines[i - 1]):
            raise AssertionError(f"{lines[i - 1]} before {line}")
    assert set(re.findall(r"L X\S+ Y\S+ R0 FMAX M91", program.text)) == {
        "L X+12.0000 Y-8.0000 R0 FMAX M91"
    }
    (section,) = head_sections(plan)
    assert "X moves the table, not the head" in " ".join(section.notes)
    assert not any("beyond" in warning for warning in section.warnings)


@pytest.mark.parametrize(("height", "is_clear"), [(842.0, True), (850.0, False)])
def test_a_body_below_the_upright_head_is_judged_where_only_tilted_poses_are_visited(
    golden, height, is_clear
):
    """The pole passes 1100 - 244 = 856 mm above the table, 10 mm of which are kept.

    At 30 degrees and more it would clear 900 mm.
    """
    tall = Solid("tower", (30.0, 30.0), False, 0.0, height, 700.0, 500.0)
    tilted = ((0.0, 30.0), (40.0, 35.0))
    if is_clear:
        plan = planned(golden, gantry(), poses=tilted, bodies=[tall])
        check_moves(make_programs(plan).programs[0].read, plan.standard, plan.chain)
        return
    with pytest.raises(NotReachable, match="while they turn"):
        planned(golden, gantry(), poses=tilted, bodies=[tall])


def test_every_program_of_a_head_is_read_checked_and_run(made, plan):
    """The twin finds what was planned: residuals of a machine without errors are its rounding."""
    machine, reads = VirtualMachine(plan.chain), []
    for number in range(len(made.programs)):
        read = as_read(made, plan.chain, number)
        check_moves(read, plan.standard, plan.chain)
        reads.append(ran(read, plan.standard, machine))
    found = evaluate(parts_of(reads, plan.chain), plan.standard, plan.chain, UM)
    assert len(found) == len(plan)


def test_programs_beside_them_turn_at_the_same_place(plan):
    others = companions(plan, Dialect(), Feeds(), 80.0, False)
    sets = [others.ball, others.search, others.first, make_dry_run(plan, 50.0)]
    for one in sets:
        assert one is not None
        places = {place for place, _, _ in turns_in(one.programs[0].text)}
        assert places == {(1500.0, 1000.0, -1.0)}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (r"\d+ L X\+1500\.0000 Y\+1000\.0000 R0 FMAX M91\r\n", "", "X and Y commanded before"),
        (r"(?s)(.*L X\+1500\.0)(?=000 Y\+1000\.0000 R0 FMAX M91)", r"\g<1>1", "the one place"),
        (r"(?m)^\d+ L Z-1\.0000 R0 FMAX M91\r\n(?=\d+ L X)", "", "a retract"),
    ],
)  # fmt: skip
def test_a_turn_elsewhere_is_refused(plan, old, new, expected):
    made = make_programs(plan)
    text = re.sub(old, new, made.programs[0].text)
    assert text != made.programs[0].text
    lines = [re.sub(r"^\d+ ", "", line) for line in text.split("\r\n")]
    with pytest.raises(BadFile, match=expected):
        check_moves(as_read(made, plan.chain, text="\r\n".join(lines)), plan.standard, plan.chain)


def test_logs_of_programs_that_turned_elsewhere_are_still_evaluated(plan):
    """Their text is read to compare a log with it; it is not run again."""
    made = make_programs(plan)
    older = re.sub(r"(?m)^\d+ L X\S+ Y\S+ R0 FMAX M91\r\n", "", made.programs[0].text)
    lines = [re.sub(r"^\d+ ", "", line) for line in older.split("\r\n")]
    read = as_read(made, plan.chain, text="\r\n".join(lines))
    assert [touch.number for touch in read.touches] == [*range(1, len(plan) + 1)]


def test_tables_turn_wherever_x_and_y_stand(golden, programs):
    assert golden.plan().head_turns is None
    assert head_sections(golden.plan()) == []
    assert not re.search(r"L X\S+ Y\S+ R0 FMAX M91|HEAD TURNS", programs.programs[0].text)


def test_the_set_up_sheet_states_place_and_space(plan, tmp_path):
    others = companions(plan, Dialect(), Feeds(), 80.0, False)
    station = Station(plan, Dialect(), make_programs(plan))
    page = write_setup_page(tmp_path, [station], 0, others).read_text(encoding="utf-8")
    assert "Turns of the head" in page
    (section,) = head_sections(plan)
    assert section.table is not None
    place, swept, anywhere, travel = (row[1:] for row in section.table.rows)
    assert place == ["1500", "1000", "-1"]
    assert swept[:2] == ["924 to 2076", "424 to 1522"]
    assert anywhere[0] == "606 to 2394"
    assert travel == ["0 to 3000", "0 to 2000", "-1000 to 0"]
    assert "C from -125° to 155° and A from -40° to 35°" in section.notes[0]
    assert "at least 10 mm higher" in section.notes[1]
    assert "fork" in section.warnings[-1]


def test_a_space_beyond_the_travel_is_warned_of(golden):
    plan = planned(golden, gantry(1000.0))
    (section,) = head_sections(plan)
    # 575.1 mm to either side of the middle of 1000 mm
    assert any(re.search(r"7[67] mm beyond the travel of Y", w) for w in section.warnings)
    assert not any("travel of X" in w for w in section.warnings)


def test_a_tool_that_looks_upwards_is_lowest_at_its_rear() -> None:
    """At 110 degrees the rear rim of the nose: 150 cos 110 - 45 sin 110 = -93.6 mm."""
    from matstd.artefact.tool.heights import SolidHull, top_height

    chain = head_table()
    q = np.array([[0.0, 110.0]]) * DEG
    flat = SolidHull(np.array([[0.0, 0.0, 0.0]]), np.zeros(1), np.array([""]))
    found = top_height(chain, q, flat, Probe())[0]
    # the gauge point stands 200 - 200 cos 110 above its place of the upright head
    rear = 150.0 * np.cos(110.0 * DEG) - 45.0 * np.sin(110.0 * DEG)
    gauge = 200.0 - 200.0 * np.cos(110.0 * DEG)
    assert found == pytest.approx(-500.0 - gauge - rear, abs=1.0)
