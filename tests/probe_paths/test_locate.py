"""The search for a standard: always something under the ball, nothing hit, and the place found."""

import re
from dataclasses import replace

import numpy as np
import pytest
from programs import all_read, as_read, ran
from unchanged import facts, folded

from matstd.api.replanning import feeds_of
from matstd.artefact.body import Base, Core, contact
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import VirtualMachine, ball_centres, check_moves, simulate_search
from matstd.probe_paths.control import read_log, read_program
from matstd.probe_paths.emit import Feeds, make_programs, make_search
from matstd.probe_paths.locate import Spread, find_standard, plan_search
from matstd.probe_paths.locate.relief import Relief
from matstd.probe_paths.plan import ToolClearance
from matstd.twin.errors import BadFile, NotEnoughData, NotReachable
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

SPREAD = Spread(6.0, 1.5 * DEG)
"""Small, so that the first round of places is."""


@pytest.fixture(scope="module")
def search(small, chain, golden):
    plan = plan_search(small, chain, Probe(), golden.setup(), SPREAD)
    return make_search(plan, (SPREAD.distance, SPREAD.angle))


@pytest.fixture(scope="module")
def program(search, chain):
    return as_read(search, chain)


def placed(theta):
    """Pose of a standard beside its place: mm and degrees along and about x, y and z."""
    theta = np.array(theta)
    return pose(fixed_xyz(theta[3:] * DEG), theta[:3])


@pytest.mark.parametrize("theta", [[6, -6, 6, 1.5, 1.5, -1.5], [-6, 6, -6, -1.5, 1.5, 1.5]])
def test_at_the_ends_of_the_spread_every_touch_meets_something_and_nothing_else_is_near(
    theta, program, small, chain, golden
):
    beside = placed(theta)
    machine = VirtualMachine(chain, setup_error=beside)
    run = ran(program, small, machine)
    run.check_done()
    stands = Setup("a", golden.setup().T_table_artefact @ beside)
    room = ToolClearance(chain, small, stands, Probe(), program.heading.workshop)
    start = np.array([touch.q for touch in program.touches])
    assert room.swept_gap(start, run.q, with_ball=False, enough=1.0)[0].min() > 0.5


def test_the_relief_is_where_a_ball_stops(small):
    """Against first contacts, where the picture is not steep."""
    relief = Relief.of(small, 3.0)
    rng = np.random.default_rng(3)
    xy = rng.uniform(-70.0, 70.0, (60, 2))
    start = np.column_stack([xy, np.full(60, 150.0)])
    met = contact(small, start, np.array([0.0, 0.0, -1.0]), 3.0, 200.0)
    around = np.array([relief.ball_at(xy + s) for s in ([2, 0], [-2, 0], [0, 2], [0, -2])])
    flat = np.ptp(around, axis=0) < 3.0
    assert flat.sum() > 30
    assert np.abs(relief.ball_at(xy) - (150.0 - met.travel))[flat].max() < 1.0


@pytest.fixture(scope="module")
def log(program, small, chain, tmp_path_factory):
    """What the search logs where the standard stands elsewhere."""
    beside = placed([5.0, -4.0, 3.0, 1.0, -0.8, 1.4])
    machine = VirtualMachine(chain, setup_error=beside, noise=5.0 * UM)
    run = simulate_search(program, small, machine, np.random.default_rng(1))
    ((name, text),) = run.log.items()
    path = tmp_path_factory.mktemp("search") / name
    path.write_text(text, encoding="ascii")
    return path


def test_the_place_is_found_within_its_uncertainty(log, small, chain, golden):
    (part,) = read_log(log, chain.rotary_axes)
    balls, rng = ball_centres(part, chain), np.random.default_rng(0)
    found = find_standard(small, golden.setup(), balls, 3.0, rng, SPREAD)
    error = np.append(
        found.shift - [5.0, -4.0, 3.0], found.angles - np.array([1.0, -0.8, 1.4]) * DEG
    )
    assert np.abs(error[:3]).max() < 0.05
    assert np.abs(error[3:]).max() < 0.05 * DEG
    assert np.all(np.abs(error) < 4.0 * found.u)
    assert found.rms < 10.0 * UM
    np.testing.assert_allclose(
        found.setup.T_table_artefact,
        golden.setup().T_table_artefact @ pose(fixed_xyz(found.angles), found.shift),
    )


def test_search_and_place_are_what_they_were(search, program, log, small, chain, golden, unchanged):
    (part,) = read_log(log, chain.rotary_axes)
    rng = np.random.default_rng(0)
    found = find_standard(small, golden.setup(), ball_centres(part, chain), 3.0, rng, SPREAD)
    unchanged("\n".join([search.programs[0].text, folded(facts(program.steps)), facts(found)]))


def test_heights_over_a_core_are_those_of_a_frustum(small):
    """From above: flat within 20 mm of the axis, then a cone down to the plate at 30 mm."""
    bare = replace(small, patches=(), spheres=(), core=Core(30.0, 20.0, 60.0))
    relief = Relief.of(bare, 3.0)
    radius = np.array([0.0, 20.0, 25.0, 28.0, 30.0, 40.0])
    i, j = np.round(relief.index(np.column_stack([radius, np.zeros(6)]))).astype(int)
    assert relief.top[i, j] == pytest.approx([60.0, 60.0, 40.0, 28.0, 20.0, 20.0])
    assert relief.ball_at(np.array([[0.0, 0.0], [50.0, 0.0]])) == pytest.approx([63.0, 23.0])


def test_few_touches_are_refused(log, small, chain, golden):
    (part,) = read_log(log, chain.rotary_axes)
    balls, rng = ball_centres(part, chain), np.random.default_rng(0)
    with pytest.raises(NotEnoughData, match="8 touches of a search, expected at least 9"):
        find_standard(small, golden.setup(), balls[:8], 3.0, rng, SPREAD)


@pytest.mark.slow
def test_a_place_outside_the_spread_is_not_found(log, small, chain, golden):
    (part,) = read_log(log, chain.rotary_axes)
    balls, rng = ball_centres(part, chain), np.random.default_rng(0)
    spoilt = balls + np.random.default_rng(2).normal(0.0, 4.0, balls.shape) * [0.0, 0.0, 1.0]
    with pytest.raises(NotEnoughData, match="no place within the spread fits"):
        find_standard(small, golden.setup(), spoilt, 3.0, rng, SPREAD)


def test_a_probe_that_is_too_short_and_a_spread_out_of_travel_are_refused(small, chain, golden):
    stub = Probe(stack=((4.0, 1.5), (160.0, 31.0)))
    with pytest.raises(NotReachable, match=r"a stylus of 4 mm .*: a longer stylus"):
        plan_search(small, chain, stub, golden.setup(), Spread())
    with pytest.raises(NotReachable, match="within 90 mm and 1 degrees: a longer stylus"):
        plan_search(small, chain, Probe(), golden.setup(), Spread(90.0, 1.0 * DEG))


def test_a_search_on_flat_places_alone_is_refused(golden, chain):
    """Balls far from the only places that have room: all touches would meet the base."""
    small = golden.standard()
    bare = replace(
        small, patches=(), spheres=small.spheres[:1], base=Base((130.0, 130.0), 10.0, 20.0)
    )
    with pytest.raises(NotReachable, match="meets flat places: it would determine 0 of 60"):
        plan_search(bare, chain, Probe(), golden.setup(), Spread(3.0, 1.0 * DEG))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (";SEARCH FROM ABOVE", ";FROM ABOVE", "at most 10 mm beyond the surface"),
        ("IX+0.0000 IY+0.0000 IZ-1.0000", "IX+1.0000 IY+0.0000 IZ+0.0000", "at most 10 mm beyond"),
    ],
)
def test_only_a_search_may_go_far_and_only_down(old, new, expected, search, chain):
    text = search.programs[0].text.replace(old, new)
    with pytest.raises(BadFile, match=expected):
        as_read(search, chain, text=text)


@pytest.mark.slow
def test_programs_are_planned_again_where_the_standard_stands(
    log, design, chain, small, golden, tmp_path, answer
):
    out = tmp_path / "again"
    words = ["--within-mm", "6", "--within-deg", "1.5"]
    output = answer(["replan", str(log), "--design", str(design), *words, "-o", str(out)])
    number = r"([+-]\d+\.\d+) ± "
    shift = [float(re.search(rf"- {a} {number}", output)[1]) for a in "xyz"]
    assert np.abs(np.array(shift) - [5.0, -4.0, 3.0]).max() < 0.05
    programs = sorted((out / "programs").glob("*.H"))
    read = [read_program(path, chain) for path in programs]
    stands = golden.setup().T_table_artefact @ placed([5.0, -4.0, 3.0, 1.0, -0.8, 1.4])
    assert np.abs(read[0].heading.setup.T_table_artefact - stands).max() < 0.05
    for one in read:
        check_moves(one, small, chain)
    before = sum(len(read_program(p, chain).touches) for p in sorted(design.glob("programs/*.H")))
    assert sum(len(one.touches) for one in read) > 0.9 * before
    assert (out / "setup" / "setup.html").exists()
    assert (out / "setup" / "MS_A_DRY.H").exists()


def test_programs_keep_their_feeds_when_planned_again(plan, chain):
    feeds = Feeds(probing=120.0, approach=1500.0, turning=700.0)
    assert feeds_of(all_read(make_programs(plan, feeds=feeds), chain), chain) == feeds


def test_a_log_of_another_standard_is_refused(log, design, tmp_path, refusal):
    other = tmp_path / log.name
    other.write_text(log.read_text(encoding="ascii").replace("SMALL-1", "SMALL-2"), "ascii")
    out = tmp_path / "again"
    assert "was written for SMALL-2" in refusal(
        ["replan", str(other), "--design", str(design), "-o", str(out)]
    )
    assert not out.exists()
