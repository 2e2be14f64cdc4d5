"""Shapes, sites and touchable points that the placement chooses from."""

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from matstd.artefact.body import (
    Limits,
    Material,
    graph_patch,
    max_slope,
    min_concave_radius,
    outline_distance,
)
from matstd.artefact.compare.comparison import _scatter
from matstd.artefact.layout import (
    Blank,
    balls_fit,
    balls_on_posts,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    most_side_by_side,
    post_stiffness,
)
from matstd.artefact.layout.post import post_foot
from matstd.artefact.layout.shapes import smooth_heights
from matstd.artefact.layout.upright import ball_on_post
from matstd.artefact.place import identifying
from matstd.artefact.reach import ProbeReach, ProbeShape, Requests, joined
from matstd.artefact.worth import (
    TouchOptions,
    chosen_touches_on,
    poses_within,
    random_touches,
    repaired_touches,
)
from matstd.artefact.worth.attribution import error_shares
from matstd.artefact.worth.potential import residual_after
from matstd.twin.compute import silent
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.machine import Axis, inverse_linear, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG, NM

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


@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_shapes_keep_the_limits_and_use_them(lean):
    limits = Limits()
    rng = np.random.default_rng(2)
    steep, tight = [], []
    for _ in range(20):
        half = tuple(rng.uniform(15.0, 24.0, 2))
        heights = smooth_heights(half, limits, rng, plane=(lean, 0.0))
        patch = graph_patch("FF1", np.eye(4), half, heights)
        assert min_concave_radius(patch) >= limits.min_concave_radius
        assert max_slope(patch) <= limits.max_slope
        uv = patch.grid(1.0)
        assert np.abs(patch.height(uv) - lean * uv[:, 0]).max() <= 1.05 * 7.0
        steep.append(max_slope(patch))
        tight.append(min_concave_radius(patch))
    assert np.median(steep) > 28.0 * DEG  # normals of a patch differ as much as they may
    assert max(steep) - min(steep) > 2.0 * DEG


@pytest.fixture(scope="module")
def faces():
    return freeform_faces(Blank(), 6, 24, np.random.default_rng(4))


def test_faces_lie_within_the_blank_on_round_numbers(faces):
    base = Blank().base
    assert len(faces) == 24
    for face in faces:
        T, uv = face.T_artefact_patch, face.grid(4.0)
        np.testing.assert_array_equal(T[:3, :3], np.eye(3))
        np.testing.assert_allclose(10.0 * T[:3, 3], np.round(10.0 * T[:3, 3]), atol=1e-9)
        points = face.point(uv)
        assert outline_distance(points[:, :2], base.half_size, base.corner_radius).max() <= 1e-9
        assert points[:, 2].min() > base.thickness + 4.0
        assert points[:, 2].max() < Blank().height
    slopes = [max_slope(face) for face in faces]
    assert max(slopes) <= Limits().max_slope
    directions = np.array([face.normal(np.zeros((1, 2)))[0, :2] for face in faces])
    assert (directions.max(axis=0) > 0.2).all()  # they look to all sides
    assert (directions.min(axis=0) < -0.2).all()


def walls(face):
    """Points of the outline of a pillar from above, a millimetre apart."""
    (a, b), middle = face.half_size, face.T_artefact_patch[:2, 3]
    t = np.linspace(-1.0, 1.0, 61)
    sides = [np.column_stack([a * t, s * b + 0.0 * t]) for s in (-1, 1)]
    sides += [np.column_stack([s * a + 0.0 * t, b * t]) for s in (-1, 1)]
    return middle + np.concatenate(sides)


def test_bodies_that_fit_leave_a_cutter_between_them(faces):
    """Against the outlines point by point."""
    blank = Blank()
    holes = holes_on(replace(blank, limits=Limits(table_radius=160.0, slot_pitch=63.0)))
    fits = faces_fit(faces, holes, blank.limits)
    outlines = [walls(face) for face in faces]
    apart = np.array(
        [[np.linalg.norm(p[:, None] - q, axis=-1).min() for p in outlines] for q in outlines]
    )
    inside = np.abs(
        np.array([f.T_artefact_patch[:2, 3] for f in faces])[:, None]
        - np.array([f.T_artefact_patch[:2, 3] for f in faces])
    ) < np.array([f.half_size for f in faces])[:, None] + np.array([f.half_size for f in faces])
    apart[inside.all(axis=-1)] = 0.0
    clear = np.array(
        [min(np.linalg.norm(p - [h.x, h.y], axis=1).min() for h in holes) for p in outlines]
    )
    blocked = clear < 9.0 + 6.0
    expected = (apart >= 12.0) & ~blocked & ~blocked[:, None]
    off = np.abs(apart - 12.0) > 0.05  # outlines are sampled
    np.testing.assert_array_equal(fits[off], expected[off])
    balls = balls_on_posts(blank, 40, np.random.default_rng(1))
    beside = faces_beside(faces, balls[:3], blank)
    for good, outline in zip(beside, outlines, strict=True):
        for ball in balls[:3]:
            room = np.linalg.norm(outline - ball.centre[:2], axis=1).min()
            assert not good or room >= ball.foot_radius + 12.0 - 0.05
    pairs = balls_fit(balls, blank)
    for i, j in combinations(range(len(balls)), 2):
        one, other = balls[i], balls[j]
        room = np.linalg.norm(one.centre[:2] - other.centre[:2])
        if pairs[i, j]:
            assert room >= one.foot_radius + other.foot_radius + 12.0


def test_faces_drawn_beside_bodies_leave_them_room():
    """Against the outlines point by point."""
    blank = Blank()
    balls = balls_on_posts(blank, 60, np.random.default_rng(1))[::8]
    holes = holes_on(blank, balls)
    found = freeform_faces(blank, 6, 12, np.random.default_rng(2), balls, holes)
    assert len(found) == 12
    for outline in map(walls, found):
        for ball in balls:
            room = np.linalg.norm(outline - ball.centre[:2], axis=1).min()
            assert room >= max(ball.radius, ball.foot_radius) + 12.0 - 0.05
        for hole in holes:
            room = np.linalg.norm(outline - [hole.x, hole.y], axis=1).min()
            assert room >= hole.bore_radius + 6.0 - 0.05


@pytest.mark.parametrize("pitch", [0.0, 31.75, 63.0, 100.0])
def test_screws_stand_on_slots_within_table_and_base(pitch):
    blank = Blank(limits=Limits(table_radius=160.0, slot_pitch=pitch))
    holes = holes_on(blank)
    assert len(holes) == 3
    for hole in holes:
        assert np.hypot(hole.x, hole.y) + hole.radius <= 160.0 - 8.0
        inset = -outline_distance(np.array([[hole.x, hole.y]]), (140.0, 140.0), 25.0)[0]
        assert inset >= hole.bore_radius + 5.0
        if pitch:
            assert hole.y == pytest.approx(round(hole.y / pitch) * pitch, abs=0.051)
        assert [hole.x, hole.y] == [round(hole.x, 1), round(hole.y, 1)]
    sides = [np.hypot(a.x - b.x, a.y - b.y) for a, b in combinations(holes, 2)]
    assert min(sides) > 120.0
    with pytest.raises(NotBuildable, match="no three screw holes"):
        holes_on(Blank(limits=Limits(table_radius=20.0)))


def test_screws_in_a_row_are_none():
    """Slots so far apart that one alone is under the plate: the standard would rock on it."""
    with pytest.raises(NotBuildable, match="slot_pitch_mm = 150") as caught:
        holes_on(Blank(limits=Limits(table_radius=160.0, slot_pitch=150.0)))
    assert caught.value.facts["binding"] == ["slots"]


@pytest.mark.parametrize("length", [30.0, 90.0, 125.0])
def test_a_post_is_as_stiff_as_its_slices(length):
    """Against the sums over a thousand slices of the cone, each with its own section."""
    top, E = 8.0, 200e3
    foot = post_foot(length, top, 10e3, E, 0.3)
    s = (np.arange(1000) + 0.5) / 1000.0 * length
    r = top + (foot - top) * s / length
    G = E / 2.6
    slices = np.sum((s**2 / (E * np.pi / 4.0 * r**4) + 1.0 / (0.9 * G * np.pi * r**2)) * length)
    turn = length**2 / (8.0 * G * foot**3 / (3.0 * 0.7))
    assert post_stiffness(length, top, foot, E, 0.3) == pytest.approx(
        1.0 / (slices / 1000.0 + turn), rel=1e-4
    )
    assert post_stiffness(length, top, foot, E, 0.3) >= 10e3
    assert foot < top + 0.2 or post_stiffness(length, top, foot - 0.1, E, 0.3) < 10e3


def test_a_post_is_as_wide_as_its_material_asks_for():
    """The stiffness is proportional to the modulus: the softer, the wider the foot."""
    centre, foot = np.array([60.0, 60.0, 120.0]), {}
    for name, modulus in (("X40Cr14", 200e3), ("Aluminium", 70e3), ("1.2379", None)):
        stuff = Material(name, 7.8e-6, 1e-5).with_usual_modulus()
        assert stuff.modulus == modulus
        ball = ball_on_post(replace(Blank(), material=stuff), "SPH1", centre)
        foot[name] = ball.foot_radius
        drawn_for = stuff.modulus or 70e3, stuff.poisson
        assert post_stiffness(90.0, ball.stem_radius, ball.foot_radius, *drawn_for) >= 18e3
    assert foot["X40Cr14"] + 3.0 < foot["Aluminium"] == pytest.approx(foot["1.2379"], abs=0.2)


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


@pytest.mark.parametrize(
    ("c", "b", "wanted", "count", "first"),
    [
        # 6 poses over 1 and 90 degrees: sqrt(1) and sqrt(90) times sqrt(6 / sqrt(90)) = 0.795
        # are 1 and 8 readings. Eight from -90 to 0 are 12.86 degrees apart; those of the first C
        # are shifted by half of that and end at the limit
        ((0.0, 0.0), (-90.0, 0.0), 1, 8, [-90, -84, -71, -58, -45, -32, -19, -6]),
        # 24 poses over 360 and 110 degrees: 0.347 sqrt(360) = 7 and 0.347 sqrt(110) = 4
        ((-180.0, 180.0), (-90.0, 20.0), 4, 28, [-90, -72, -35, 2]),
    ],
)
def test_candidate_poses_by_hand(chain, c, b, wanted, count, first):
    poses = poses_within(chain, np.array([c, b]) * DEG, wanted) / DEG
    assert len(poses) == count
    assert poses[poses[:, 0] == c[0], 1] == pytest.approx(first)


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
    (alone,) = error_shares(W, ["FF1", "FF1"], symbols).values()
    assert [e.name for e in alone] == ["EXX", "EYX", "EZX"]  # 27, 26 and 2 of 55


def test_a_machine_with_amplitudes_all_zero_is_refused_in_one_line():
    with pytest.raises(NotBuildable, match="amplitudes are all zero"):
        error_shares(np.zeros((2, 2)), ["FF1", "FF2"], np.array(["EXX", "EYY"]))


def test_a_pose_from_which_a_head_reaches_nothing_takes_no_part_in_the_scatter():
    """Fork head over a standard on a low table: tilted by 100 degrees the ball stays above it."""
    fork = make_chain(
        "fork",
        "[w f X Y Z C A t]",
        {n: Axis((-400.0, 400.0)) for n in "XY"}
        | {"Z": Axis((-700.0, 0.0)), "C": Axis((-3.5, 3.5)), "A": Axis((-2.0, 2.0))},
        (0.0, 0.0, -900.0),
    )
    reach = ProbeReach(fork, Setup("a"), PROBE, 160.0)
    rotary = np.array([[-3.5, 3.5], [-2.0, 2.0]])
    volume = np.array([[-80.0, -80.0, 30.0], [80.0, 80.0, 120.0]])
    criterion = SimpleNamespace(reach=reach, volume=volume, rotary=rotary)
    poses = np.array([[0.0, 0.0], [0.0, 100.0 * DEG]])
    found = _scatter(criterion, poses, np.random.default_rng(1))
    np.testing.assert_array_equal(np.unique(found.rotary, axis=0), poses[:1])
    criterion.rotary = np.stack([poses[1], poses[1]], axis=-1)
    with pytest.raises(NotReachable, match="none of"):
        _scatter(criterion, poses[1:], np.random.default_rng(1))


def test_of_two_pillars_just_as_far_apart_as_needed_both_fit_or_none(chain):
    """Places and sizes are tenths of a millimetre: 12 mm exactly are common."""
    rng = np.random.default_rng(6)
    half = np.round(rng.uniform(8.0, 30.0, (60, 2)), 1)
    flat = np.zeros((7, 7))
    faces, x = [], 0.0
    for k, (a, b) in enumerate(half):
        x = round(x + a + (12.0 + half[k - 1, 0] if k else 0.0), 1)
        faces.append(
            graph_patch(f"{k}", pose(t=np.array([x, 0.0, 60.0])), (a, b), flat, depth=50.0)
        )
    fits = faces_fit(faces, (), Limits())
    np.testing.assert_array_equal(fits, fits.T)


def test_a_draw_of_faces_that_fails_costs_nothing_of_what_the_first_found(monkeypatch):
    def drawn(*values):
        ends = iter(values)

        def one(*_):
            value = next(ends)
            if value is None:
                raise NotBuildable("no room")
            return SimpleNamespace(value=value)

        monkeypatch.setattr(identifying, "_draw", one)
        site = SimpleNamespace(bases=[SimpleNamespace(value=alone)], progress=silent)
        return identifying._best_draw(site, None).value, len(list(ends))

    alone = 1.0
    assert drawn(1.5, None, 1.3, 1.4, None, 1.35, 1.2) == (1.3, 1)  # no more than six
    assert drawn(1.5, 1.009, 1.2) == (1.009, 1)  # near enough: no further draw
    alone = 0.0  # nothing to compare with
    assert drawn(1.5, 1.2) == (1.5, 1)


def test_what_is_left_of_a_choice_is_filled_up_and_exchanged_under_the_shares_of_poses(criterion):
    rng = np.random.default_rng(5)
    free = random_touches(criterion.reach, criterion.volume, criterion.rotary, 120, rng)
    poses = free.rotary[np.arange(120) % 6]
    tried, options = replace(free, rotary=poses), TouchOptions(touches=30, poses=6)
    chosen, nearness = chosen_touches_on(criterion, tried, options)
    like = tried[chosen]
    # all that was chosen can still be made, under other names: it stays, or betters itself
    named = replace(tried, feature=np.full(120, "SPH9"))
    same = repaired_touches(criterion, named, like, options)[1]
    assert same.value <= nearness.value * (1.0 + 1e-9)
    # a few are hidden: as many touches again, no pose crowded, near what the whole search finds
    open_ = np.ones(120, dtype=bool)
    open_[np.flatnonzero(chosen)[::6]] = False
    again, found = repaired_touches(criterion, tried[open_], like, options)
    rows = criterion.rows(tried[open_][again])
    assert found.value == pytest.approx(criterion.objective.value(rows.T @ rows), rel=1e-9)
    assert again.sum() == 30
    assert np.bincount(tried[open_][again].pose).max() <= np.ceil(1.6 * 30 / 6)
    searched = chosen_touches_on(criterion, tried[open_], options)[1]
    assert searched.bound <= found.value <= 1.03 * searched.value
    # a choice that is known stays where the search finds no better one
    known = chosen_touches_on(criterion, tried[open_], options, begin=again)[1]
    assert known.value == pytest.approx(min(found.value, searched.value), rel=1e-9)
    with pytest.raises(NotReachable, match="29 touches can be made on the standard, 30 are"):
        repaired_touches(criterion, tried[:29], like, options)


def test_what_a_model_imitates_does_not_depend_on_the_units_of_its_parameters():
    """Columns along X and Y, the second in a unit a billion times smaller: Z alone is left."""
    W = np.array([[1.0, 0.0], [0.0, 1e-9], [0.0, 0.0]])
    left = residual_after(np.array([[3.0], [4.0], [5.0]]), W)
    np.testing.assert_allclose(left, [[0.0], [0.0], [5.0]], atol=1e-12)


def test_rounding_is_no_direction_of_a_model():
    """A column that is zero but for rounding imitates nothing, wherever it points."""
    W = np.array([[1e3, 0.0], [0.0, 2e-16], [0.0, 3e-16]])
    left = residual_after(np.array([[3.0], [4.0], [5.0]]), W)
    np.testing.assert_allclose(left, [[0.0], [4.0], [5.0]], atol=1e-12)
