"""Shapes, sites and touchable points that the placement chooses from."""

from itertools import combinations, product

import numpy as np
import pytest
from artefact.layout.candidates import TALLEST, random_sites, smooth_heights

from artefact.body.freeform import graph_patch
from artefact.body.limits import Limits, max_slope, min_concave_radius
from artefact.layout.side_by_side import most_side_by_side, neighbour_gaps
from artefact.layout.sites import Blank, Site
from artefact.layout.spread import spread
from artefact.reach.probe_clearance import ProbeShape
from artefact.reach.touchable import ProbeReach, Requests, joined
from artefact.worth.attribution import error_shares
from twin.errors import NotBuildable
from twin.frames import fixed_xyz, pose
from twin.machine.chain import Axis, make_chain
from twin.machine.kinematics import inverse_linear
from twin.record.touches import Setup
from twin.units import DEG, NM

PROBE = ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0)))
TRAVEL = {n: Axis(range=(-400.0, 400.0)) for n in "XYZ"}
HEAD = make_chain(
    "head",
    "[w C' X' f Y Z B t]",
    TRAVEL | {"B": Axis((-100.0 * DEG, 100.0 * DEG), (0.0, 0.0, 120.0)), "C": Axis((-7.0, 7.0))},
    (0.0, 0.0, -300.0),
)


def wanted(n=40, seed=1):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(n, 3))
    return Requests(
        np.full(n, "FF1"),
        rng.uniform(-80.0, 80.0, (n, 3)) + np.array([0.0, 0.0, 90.0]),
        normal / np.linalg.norm(normal, axis=1, keepdims=True),
        rng.choice([-0.5, 0.0, 1.0], (n, 2)),
    )


def test_shapes_keep_the_limits_and_use_them():
    limits = Limits()
    rng = np.random.default_rng(2)
    steep, tight = [], []
    for _ in range(40):
        half = tuple(rng.uniform(15.0, 24.0, 2))
        patch = graph_patch("FF1", np.eye(4), half, smooth_heights(half, limits, rng))
        assert min_concave_radius(patch) >= limits.min_concave_radius
        assert max_slope(patch) <= 35.0 * DEG
        assert np.abs(patch.jet(patch.grid(1.0)).h).max() <= 1.05 * TALLEST
        steep.append(max_slope(patch))
        tight.append(min_concave_radius(patch))
    assert np.median(steep) > 25.0 * DEG  # normals of a patch differ as much as they may
    assert max(steep) - min(steep) > 2.0 * DEG


def test_sites_that_overlap_do_not_fit():
    heights = np.zeros((8, 8))
    sites = [
        Site(0.0, 100.0, 80.0, 50.0 * DEG, (20.0, 20.0), heights),
        Site(10.0 * DEG, 100.0, 80.0, 50.0 * DEG, (20.0, 20.0), heights),
        Site(180.0 * DEG, 100.0, 80.0, 50.0 * DEG, (20.0, 20.0), heights),
    ]
    fits = neighbour_gaps(sites, Blank()) >= Blank().limits.gap
    assert not fits[0, 1]
    assert not fits[1, 0]
    assert fits[0, 2]
    assert fits[1, 2]
    assert not fits.diagonal().any()


def test_as_many_sites_stand_side_by_side_as_any_search_finds():
    """Against the largest clique of a graph in which the most sociable site is a bad beginning."""
    rng = np.random.default_rng(2)
    for _ in range(5):
        fits = rng.random((14, 14)) < 0.5
        fits &= fits.T
        np.fill_diagonal(fits, val=False)
        largest = max(
            size
            for size in range(1, 8)
            for some in combinations(range(14), size)
            if all(fits[a, b] for a, b in combinations(some, 2))
        )
        found = most_side_by_side(fits, 14)
        assert len(found) == largest
        assert all(fits[a, b] for a, b in combinations(found, 2))
        assert len(most_side_by_side(fits, 2)) == 2


def test_sites_cover_the_blank():
    sites = random_sites(Blank(), 100, np.random.default_rng(4))
    assert 95 <= len(sites) <= 105
    tilt = np.array([s.tilt for s in sites]) / DEG
    azimuth = np.array([s.azimuth for s in sites])
    assert tilt.min() < 15.0
    assert tilt.max() > 55.0
    flank = azimuth[[s.radius > 90.0 for s in sites]]
    assert np.diff(np.sort(flank)).max() < 35.0 * DEG
    lean = np.array([s.lean for s in sites]) / DEG
    assert np.abs(lean).max() > 90.0
    assert 0.3 < np.mean(lean > 0.0) < 0.7  # to both sides
    small = random_sites(Blank(height=110.0), 100, np.random.default_rng(4))
    assert max(s.height for s in small) < 0.6 * max(s.height for s in sites)


def test_readings_are_those_of_the_inverse():
    setup = Setup("b", pose(fixed_xyz(np.array([0.01, -0.02, 0.5])), np.array([5.0, -6.0, 7.0])))
    reach = ProbeReach(HEAD, setup, PROBE, 160.0)
    touches = wanted()
    for gap in (0.0, 5.0, -3.0):
        ball = touches.point + (3.0 + gap) * touches.normal
        q = np.zeros((40, len(HEAD.axes)))
        q[:, [HEAD.axis_index("C"), HEAD.axis_index("B")]] = touches.rotary
        T = setup.T_table_artefact
        expected = inverse_linear(HEAD, ball @ T[:3, :3].T + T[:3, 3], q, 160.0)
        np.testing.assert_allclose(reach.readings(touches, gap), expected, rtol=0, atol=NM)


def test_a_touch_from_behind_or_beyond_the_travel_is_not_reachable():
    reach = ProbeReach(HEAD, Setup("a"), PROBE, 160.0)
    up = Requests(
        np.full(4, "FF1"),
        np.array([[0.0, 0.0, 50.0]] * 3 + [[900.0, 0.0, 50.0]]),
        np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [np.sin(1.3), 0.0, np.cos(1.3)], [0.0, 0, 1]]),
        np.zeros((4, 2)),
    )
    # 1.3 rad are 74.5 degrees, just within 75; the last point lies beyond the travel of X
    assert reach.is_reachable(up).tolist() == [True, False, True, False]
    tilted = Requests(up.feature, up.point, up.normal, np.tile([0.0, 20.0 * DEG], (4, 1)))
    # the head leans by 20 degrees about y: its axis comes nearer to the third normal
    assert reach.is_reachable(tilted).tolist() == [True, False, True, False]
    away = Requests(up.feature, up.point, up.normal, np.tile([0.0, -20.0 * DEG], (4, 1)))
    assert reach.is_reachable(away).tolist() == [True, False, False, False]


def test_lots_of_touches_are_joined_in_order():
    a, b = wanted(3, seed=1), wanted(4, seed=2)
    both = joined([a, b])
    assert len(both) == 7
    np.testing.assert_array_equal(both.point[3:], b.point)
    np.testing.assert_array_equal(both[np.array([6, 0])].normal, [b.normal[3], a.normal[0]])


def test_shares_name_what_stands_out():
    symbols = np.array(["EXX", "EXX", "EYX", "EZX", "EX0w"])
    W = np.array([[3.0, 4.0, 1.0, 1.0, 50.0], [1.0, 1.0, 5.0, 1.0, 50.0]])
    shares = error_shares(W, ["FF1", "FF2"], symbols)
    first, second = shares["FF1"][0], shares["FF2"][0]
    assert (first.name, first.share) == ("EXX", pytest.approx(25 / 27, abs=1e-4))
    assert (second.name, second.share) == ("EYX", pytest.approx(25 / 28, abs=1e-4))
    assert "EX0w" not in {e.name for e in shares["FF1"]}


def test_a_machine_with_amplitudes_all_zero_is_refused_in_one_line():
    with pytest.raises(NotBuildable, match="amplitudes are all zero"):
        error_shares(np.zeros((2, 2)), ["FF1", "FF2"], np.array(["EXX", "EYY"]))


def test_spread_against_all_choices():
    rng = np.random.default_rng(5)
    options = [rng.uniform(-100.0, 100.0, (9, 3)) for _ in range(3)]

    def gap(places):
        return min(np.linalg.norm(a - b) for a, b in combinations(places, 2))

    farthest = max(gap(places) for places in product(*options))
    assert gap(spread(options)) == pytest.approx(farthest, rel=1e-12)
    # too many to compare all: no single place can be exchanged for a better one
    many = [rng.uniform(-100.0, 100.0, (90, 3)) for _ in range(4)]
    found = spread(many)
    for k, places in enumerate(many):
        for place in places[::9]:
            assert gap([*found[:k], place, *found[k + 1 :]]) <= gap(found) + NM
