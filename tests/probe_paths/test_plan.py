"""Plans: what is refused and why, the order of poses, heights, rooms for the probe."""

from dataclasses import replace
from itertools import permutations
from types import SimpleNamespace

import numpy as np
import pytest
from unchanged import facts

from matstd.artefact.body import DatumSphere
from matstd.artefact.body.datum import STEM_CLEARANCE
from matstd.artefact.reach import Requests
from matstd.artefact.tool import Probe
from matstd.probe_paths.plan import (
    PlanOptions,
    plan_touches,
    planner,
    requests_at,
    short_order,
    waypoints,
)
from matstd.probe_paths.plan.order import LONGEST_TURN, nearest_neighbours, visits
from matstd.twin.errors import DesignError, NotReachable, ShapeMismatch
from matstd.twin.frames import apply, fixed_xyz
from matstd.twin.frames import pose as at_pose
from matstd.twin.machine import table_to_tool, tip
from matstd.twin.record import Setup
from matstd.twin.units import DEG

ROUNDING = 1e-9
"""Plain arithmetic on millimetres, mm."""


def planned(golden, feature, uv, b_c, setup=None, **options):
    small = golden.standard()
    rotary = np.array(b_c[::-1]) * DEG
    wanted = requests_at(small, feature, np.atleast_2d(uv), rotary)
    return plan_touches(
        small, golden.machine(), Probe(), setup or Setup("a"), wanted, PlanOptions(**options)
    )


def test_every_request_is_touched_once_or_refused(plan, golden):
    made = plan.request[plan.request >= 0]
    refused = [r.request for r in plan.refused]
    assert sorted([*made, *refused]) == list(range(len(golden.requests(golden.standard()))))
    assert len(refused) == 2


def test_the_plan_is_what_it_was(golden, small, chain, unchanged):
    """Made here, so that coverage.py knows which test executes its lines."""
    options = PlanOptions(tolerated=2)
    wanted = golden.requests(small)
    unchanged(facts(plan_touches(small, chain, Probe(), golden.setup(), wanted, options)))


def test_an_anchor_sphere_is_touched_first_on_every_visit_at_the_same_point(plan):
    for v, visit in enumerate(plan.visits):
        rows = np.flatnonzero(plan.visit == v)
        assert plan.request[rows[0]] == -1
        assert np.all(plan.request[rows[1:]] >= 0)
        assert plan.feature[rows[0]] == "SPH1"
        twins = [w for w, other in enumerate(plan.visits) if other.pose == visit.pose]
        for w in twins:
            other = np.flatnonzero(plan.visit == w)[0]
            assert np.abs(plan.point[other] - plan.point[rows[0]]).max() < ROUNDING


def test_rotary_positions_are_approached_from_both_sides_inside_the_travel(plan, chain):
    letters = chain.rotary_axes
    for pose in {visit.pose for visit in plan.visits}:
        sides = np.array([visit.side for visit in plan.visits if visit.pose == pose])
        assert len(sides) == 2
        assert np.array_equal(sides[0], -sides[1])
    for visit in plan.visits:
        assert np.array_equal(np.sign(visit.rotary - visit.before), visit.side)
        for value, letter in zip(visit.before, letters, strict=True):
            low, high = chain.link(letter).range
            assert low <= value <= high
    both = np.array([visit.side for visit in plan.visits])
    assert {tuple(row) for row in both} == {(1, 1), (1, -1), (-1, 1), (-1, -1)}


def test_where_the_travel_ends_the_other_side_is_taken(chain):
    rotary = np.array([[0.0, 30.0 * DEG]] * 8)
    for visit in visits(chain, rotary, 5.0 * DEG, 4):
        assert visit.side[1] == 1.0
    with pytest.raises(NotReachable, match=r"B\+31\.0000: outside the travel of B"):
        visits(chain, np.array([[0.0, 31.0 * DEG]]), 5.0 * DEG, 4)
    with pytest.raises(NotReachable, match="leaves no room to approach"):
        visits(chain, np.array([[0.0, 0.0]]), 150.0 * DEG, 4)


def test_a_linear_drift_drops_out_of_the_means_of_poses_visited_twice(chain):
    """Ordinal numbers of the two visits of a pose add up to the same sum for every pose."""
    rng = np.random.default_rng(3)
    poses = rng.uniform(-25.0, 25.0, (12, 2)) * DEG
    stops = visits(chain, np.repeat(poses, 6, axis=0), 5.0 * DEG, 4)
    sums = {}
    for place, stop in enumerate(stops):
        sums.setdefault(stop.pose, []).append(place)
    assert {sum(places) for places in sums.values()} == {len(stops) - 1}
    # and within a round, the order has little to do with the readings
    first = np.array([stop.rotary for stop in stops[:12]])
    for axis in range(2):
        assert abs(np.corrcoef(first[:, axis], np.arange(12))[0, 1]) < 0.5


def test_no_turn_is_half_a_turn_or_longer():
    path = waypoints(np.array([-350.0, 0.0]) * DEG, np.array([350.0, 10.0]) * DEG)
    steps = np.diff(np.vstack([np.array([-350.0, 0.0]) * DEG, path]), axis=0)
    assert np.abs(steps).max() <= LONGEST_TURN + 1e-12
    assert np.abs(path[-1] / DEG - [350.0, 10.0]).max() < ROUNDING


@pytest.mark.parametrize("count", [1, 2, 7])
def test_touches_come_in_nearly_the_shortest_order(count):
    """Against all orders; the slower axis of a move decides."""
    rng = np.random.default_rng(4)
    ratio = []
    for _ in range(12):
        places, first = rng.uniform(-100.0, 100.0, (count, 2)), rng.uniform(-100.0, 100.0, 2)
        orders = np.array(list(permutations(range(count))))
        ways = np.concatenate([np.tile(first, (len(orders), 1, 1)), places[orders]], axis=1)
        lengths = np.abs(np.diff(ways, axis=1)).max(axis=-1).sum(axis=1)
        order = short_order(places, first)
        assert sorted(order) == list(range(count))
        made = np.abs(np.diff(np.vstack([first, places[order]]), axis=0)).max(axis=-1).sum()
        ratio.append(made / lengths.min())
    assert min(ratio) > 1.0 - ROUNDING
    assert np.mean(ratio) < 1.02
    assert max(ratio) < 1.12


def test_nearest_neighbours_against_a_loop_in_words():
    places = np.array([[0.0, 0, 0], [9, 0, 0], [1, 0, 0], [5, 0, 0], [2, 0, 0]])
    assert nearest_neighbours(places, np.array([8.0, 0, 0])).tolist() == [1, 3, 4, 2, 0]


def test_safe_height_is_above_every_point_of_the_standard(plan, chain, small):
    """Surface points sampled from the standard itself, not from the planner's hull."""
    points = [p.point(p.grid(3.0)) for p in small.patches]
    for s in small.spheres:
        uv = np.random.default_rng(0).uniform([-np.pi, -1.5], [np.pi, 1.5], (300, 2))
        points.append(s.point(uv))
    solid = apply(plan.setup.T_table_artefact, np.concatenate(points))
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    rim = plan.options.workshop.table_radius * np.column_stack(
        [np.cos(angle), np.sin(angle), 0 * angle]
    )
    solid = np.concatenate([solid, rim])
    z = chain.axis_index("Z")
    for v, visit in enumerate(plan.visits):
        q = plan.start[plan.visit == v][:1].copy()
        q[0, z] = visit.height
        ball = tip(chain, q, plan.probe.length)[0]
        up = table_to_tool(chain, q)[0, :3, 2]
        gap = up @ ball - plan.probe.radius - (solid @ up).max()
        assert plan.options.clearance - 0.5 < gap < plan.options.clearance + 30.0


def test_a_standard_too_high_for_the_retract_is_refused(golden):
    high = Setup("a", golden.pose(t=np.array([0.0, 0.0, 290.0])))
    with pytest.raises(NotReachable, match="Z would have to rise"):
        planned(golden, "FF1", [0.0, 0.0], (0.0, 0.0), high)


@pytest.mark.parametrize(
    ("feature", "uv", "pose", "reason"),
    [
        ("FF2", [0.0, 0.0], (-70.0, 0.0), "degrees from the tool axis"),
        ("SPH1", [0.0, -0.6], (0.0, 0.0), "degrees from the tool axis"),
        ("DATUM_A", [70.0, 40.0], (-80.0, 0.0), "0.00 mm between probe and BASE at the touch"),
        ("DATUM_A", [27.0, 20.0], (0.0, 0.0), "meets the side of a column|between probe and"),
    ],
)
def test_a_touch_that_cannot_be_made_says_why(golden, feature, uv, pose, reason):
    with pytest.raises(NotReachable, match=reason):
        planned(golden, feature, uv, pose)


def test_a_standard_beyond_the_travel_is_refused(golden):
    far = Setup("a", golden.pose(t=np.array([420.0, 0.0, 0.0])))
    with pytest.raises(NotReachable, match="X would have to go to"):
        planned(golden, "FF1", [0.0, 0.0], (0.0, 0.0), far)


def test_refused_requests_are_kept_with_their_reason(golden):
    small = golden.standard()
    good = requests_at(small, "FF1", np.zeros((1, 2)), np.zeros(2))
    bad = requests_at(small, "SPH1", np.array([[0.0, -0.6]]), np.zeros(2))
    both = Requests(*(np.concatenate([getattr(good, k), getattr(bad, k)])
                           for k in ("feature", "point", "normal", "rotary")))  # fmt: skip
    plan = plan_touches(
        small, golden.machine(), Probe(), Setup("a"), both, PlanOptions(tolerated=1)
    )
    assert [r.request for r in plan.refused] == [1]
    assert str(plan.refused[0]).startswith("SPH1, C+0.0 B+0.0: the surface leans 124.4")


def test_requests_that_make_no_sense_are_refused(golden):
    small, chain = golden.standard(), golden.machine()
    good = requests_at(small, "FF1", np.zeros((1, 2)), np.zeros(2))
    with pytest.raises(DesignError, match="no feature 'FF9'"):
        plan_touches(small, chain, Probe(), Setup("a"), replace(good, feature=np.array(["FF9"])))
    with pytest.raises(ShapeMismatch, match="touch requests of shapes"):
        plan_touches(small, chain, Probe(), Setup("a"), replace(good, rotary=good.rotary[:, :1]))


def test_the_stylus_that_would_rub_is_refused(golden):
    """At B = -75 the outward side of the upper face's column stands beside the stylus."""
    small, chain = golden.standard(), golden.machine()
    q = np.array([0.0, -75.0]) * DEG
    wanted = requests_at(small, "SPH2", np.array([[np.pi, 0.3]]), q)
    slim = Probe(stack=((100.0, 2.0), (160.0, 8.0)))
    plan = plan_touches(small, chain, slim, Setup("a"), wanted, PlanOptions(anchor="SPH2"))
    assert np.sum(plan.request >= 0) == 1
    fat = Probe(stack=((15.0, 2.0), (160.0, 60.0)), nose_radius=60.0)
    with pytest.raises(NotReachable, match="between probe and"):
        plan_touches(small, chain, fat, Setup("a"), wanted, PlanOptions())


def test_an_anchor_stays_away_from_the_stem_though_the_machine_errs(chain):
    """A standard is turned over step by step: the tool axis points ever lower at its ball."""
    ball = DatumSphere("SPH1", np.array([0.0, 0.0, 100.0]), 12.5, 8.0, 9.1, 30.0)
    task = SimpleNamespace(
        options=PlanOptions(), standard=SimpleNamespace(spheres=(ball,)), chain=chain
    )
    stop, least, counts = SimpleNamespace(rotary=np.zeros(2), pose=0), [], []
    for angle in range(0, 180, 2):
        task.setup = Setup("a", at_pose(fixed_xyz(np.array([-angle, 0.0, 0.0]) * DEG)))
        wanted = planner._anchor_requests(task, stop)
        counts.append(len(wanted))
        least += np.arcsin(wanted.normal[:, 2]).tolist()
    allowed = ball.rim + STEM_CLEARANCE
    assert allowed + 5.0 * DEG <= min(least) < allowed + 7.0 * DEG
    assert (counts[0], counts[-1]) == (7, 0)
