"""What a moving ball meets on a whole standard, against a march along its way."""

import numpy as np
import pytest

from matstd.artefact.body import Meeting, Standard, contact
from matstd.twin.units import NM, UM

BALL = 3.0
STANDOFF = 5.0


def touches(patch, rng, count, margin):
    uv = rng.uniform(-1.0, 1.0, (count, 2)) * (np.array(patch.half_size) - margin)
    n = patch.normal(uv)
    return uv, patch.point(uv) + (BALL + STANDOFF) * n, -n


def test_every_patch_is_met_where_it_is_aimed_at(standard):
    rng = np.random.default_rng(0)
    for patch in standard.patches:
        uv, start, d = touches(patch, rng, 200, margin=1.0)
        found = contact(standard, start, d, BALL, travel=10.0)
        assert found.is_surface.all()
        assert set(found.feature) == {patch.name}
        assert np.abs(found.uv - uv).max() < 1e-8
        assert np.abs(found.travel - STANDOFF).max() < NM
        assert np.abs(found.point - patch.point(uv)).max() < NM
        assert np.abs(found.normal + d).max() < 1e-9


def test_touch_beyond_the_border_is_an_edge_and_not_the_patch(standard):
    patch = standard.patches[6]
    a = patch.half_size[0]
    for beyond, expected in ((-0.5, Meeting.SURFACE), (0.5, Meeting.EDGE), (2.5, Meeting.EDGE)):
        uv = np.array([[a + beyond, 2.0]])
        n = patch.normal(uv)
        found = contact(standard, patch.point(uv) + (BALL + STANDOFF) * n, -n, BALL, travel=10.0)
        assert found.meeting[0] == expected
        assert found.feature[0] == patch.name
        assert np.isnan(found.uv).all() == (expected != Meeting.SURFACE)


def test_edge_travel_against_a_fine_sampling_of_the_edge(standard):
    patch = standard.patches[2]
    a, b = patch.half_size
    rng = np.random.default_rng(4)
    s = np.linspace(-b, b, 40_001)
    edge = patch.point(np.column_stack([np.full_like(s, a), s]))
    outward = patch.T_artefact_patch[:3, 0]
    edges = 0
    for _ in range(20):
        target = patch.point(np.array([[a, rng.uniform(-0.7, 0.7) * b]]))[0]
        d = -(patch.direction + rng.normal(size=3) * 0.2)
        d /= np.linalg.norm(d)
        start = target - 15.0 * d + rng.uniform(1.0, 0.6 * BALL) * outward
        to_edge = edge - start
        along = to_edge @ d
        across2 = (to_edge**2).sum(axis=1) - along**2
        reached = across2 < BALL**2
        travel = (along[reached] - np.sqrt(BALL**2 - across2[reached])).min()
        found = contact(standard, start[None], d, BALL)
        assert found.travel[0] < travel + 0.5 * UM
        if found.meeting[0] == Meeting.EDGE:
            edges += 1
            assert abs(found.travel[0] - travel) < 0.5 * UM
        else:  # where the face rises inwards it may come first
            assert patch.contains(found.uv).all()
    assert edges > 12


def test_wall_and_upright_edge_of_a_column(standard):
    patch = standard.patches[7]
    T, (a, b) = patch.T_artefact_patch, patch.half_size
    level = float(patch.height(patch.grid()).min()) - 8.0
    out = T[:3, 0]
    start = T[:3, 3] + (a + BALL + 7.0) * out + 1.0 * T[:3, 1] + level * T[:3, 2]
    found = contact(standard, start[None], -out, BALL)
    assert (found.feature[0], found.meeting[0]) == (patch.name, Meeting.SIDE)
    assert found.travel[0] == pytest.approx(7.0, abs=NM)
    # half a radius beside the corner the ball meets the upright edge: the chord is cos 30 deg
    start = start + (b + 0.5 * BALL - 1.0) * T[:3, 1]
    found = contact(standard, start[None], -out, BALL)
    assert (found.feature[0], found.meeting[0]) == (patch.name, Meeting.SIDE)
    assert found.travel[0] == pytest.approx(7.0 + BALL * (1.0 - np.sqrt(0.75)), abs=NM)


def test_spheres_stems_plane_holes_and_rim(standard):
    sphere = standard.spheres[0]
    top = sphere.centre + np.array([0.0, 0.0, sphere.radius + BALL + 4.0])
    down = np.array([0.0, 0.0, -1.0])
    found = contact(standard, top[None], down, BALL)
    assert (found.feature[0], found.meeting[0]) == (sphere.name, Meeting.SURFACE)
    assert found.travel[0] == pytest.approx(4.0, abs=NM)
    assert np.abs(found.normal[0] + down).max() < 1e-12

    sideways = -np.array([*sphere.centre[:2], 0.0]) / np.hypot(*sphere.centre[:2])
    low = np.array([*sphere.centre[:2], sphere.foot + 15.0]) - 40.0 * sideways
    found = contact(standard, low[None], sideways, BALL)
    assert (found.feature[0], found.meeting[0]) == (sphere.name, Meeting.SIDE)
    # a cone is met along its own slope: radius there and ball radius over cos of the half angle
    k = (sphere.foot_radius - sphere.stem_radius) / (sphere.centre[2] - sphere.foot)
    stem = sphere.foot_radius - 15.0 * k
    assert found.travel[0] == pytest.approx(40.0 - stem - BALL * np.hypot(1.0, k), abs=NM)

    hole = standard.holes[0]
    above = np.array([[hole.x, hole.y, standard.base.thickness + BALL + 6.0]])
    found = contact(standard, above, down, BALL)
    assert (found.feature[0], found.meeting[0]) == (hole.name, Meeting.SIDE)
    beside = above + np.array([-np.sign(hole.x), -np.sign(hole.y), 0.0]) * (hole.bore_radius)
    found = contact(standard, beside, down, BALL)
    assert (found.feature[0], found.meeting[0]) == ("DATUM_A", Meeting.SURFACE)
    assert found.travel[0] == pytest.approx(6.0, abs=NM)

    half = standard.base.half_size[0]
    found = contact(standard, np.array([[half + 20.0, 0.0, 10.0]]), np.array([-1.0, 0, 0]), BALL)
    assert (found.feature[0], found.meeting[0]) == ("BASE", Meeting.SIDE)
    assert found.travel[0] == pytest.approx(20.0 - BALL, abs=NM)


def test_underside_of_a_sphere_near_its_stem_is_no_sphere_touch(standard):
    sphere = standard.spheres[1]
    elevation = sphere.rim + 0.05
    n = sphere.normal(np.array([[0.3, elevation]]))
    found = contact(standard, sphere.centre + 20.0 * n, -n, BALL)
    assert (found.feature[0], found.meeting[0]) == (sphere.name, Meeting.SIDE)


def test_nothing_met_and_starts_in_the_material(standard):
    patch = standard.patches[0]
    up = patch.point(np.zeros((1, 2))) + np.array([0.0, 0.0, 60.0])
    found = contact(standard, up, np.array([0.0, 0.0, 1.0]), BALL)
    assert found.meeting[0] == Meeting.NOTHING
    assert found.feature[0] == ""
    assert np.isnan(found.travel[0])
    short = contact(standard, up, np.array([0.0, 0.0, -1.0]), BALL, travel=20.0)
    assert short.meeting[0] == Meeting.NOTHING
    deep = patch.point(np.zeros((1, 2))) - 5.0 * patch.direction
    assert contact(standard, deep, -patch.direction, BALL).meeting[0] == Meeting.INSIDE
    grazing = patch.point(np.zeros((1, 2))) + (BALL - 0.2) * patch.normal(np.zeros((1, 2)))
    found = contact(standard, grazing, -patch.direction, BALL)
    assert found.meeting[0] == Meeting.INSIDE
    assert found.travel[0] == 0.0


def sampled(standard: Standard, pitch: float) -> np.ndarray:
    """Points on every patch face and the walls under it, by loops of this test's own."""
    points = []
    for patch in standard.patches:
        a, b = patch.half_size
        T = patch.T_artefact_patch
        points.append(patch.point(patch.grid(pitch)))
        border = []
        for u in np.arange(-a, a + 1e-9, pitch):
            border += [(u, -b), (u, b)]
        for v in np.arange(-b, b + 1e-9, pitch):
            border += [(-a, v), (a, v)]
        border = np.array(border)
        top = patch.height(border)
        for share in np.arange(0.0, 1.0, pitch / 40.0):
            z = top * (1.0 - share) - patch.depth * share
            points.append(np.column_stack([border, z]) @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(points)


def test_random_shots_agree_with_a_cloud_of_the_whole_surface(standard):
    # Every point of the cloud is on or in the standard, so no ball may travel on past a point of
    # it; and where faces and walls are met, a point of the cloud is nearby.
    pitch = 1.0
    cloud = sampled(standard, pitch)
    cloud = cloud[cloud[:, 2] > standard.base.thickness]
    rng = np.random.default_rng(3)
    count = 150
    d = rng.normal(size=(count, 3))
    d[:, 2] = -np.abs(d[:, 2])
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    target = rng.uniform([-110, -110, 40], [110, 110, 150], (count, 3))
    start = target - 250.0 * d
    found = contact(standard, start, d, BALL)
    assert not np.any(found.meeting == Meeting.UNRESOLVED)
    slack = pitch**2 / (2.0 * BALL)  # how much deeper a ball sinks between the nodes of the cloud
    hits = 0
    for k in range(count):
        to_cloud = cloud - start[k]
        along = to_cloud @ d[k]
        across2 = (to_cloud**2).sum(axis=1) - along**2
        reached = across2 < BALL**2
        entry = (along - np.sqrt(np.maximum(BALL**2 - across2, 0.0)))[reached]
        first = entry.min() if len(entry) else np.inf
        travel = np.inf if np.isnan(found.travel[k]) else found.travel[k]
        assert travel <= first + UM
        if found.feature[k].startswith("FF"):
            hits += 1
            # sinking grows where the ball grazes: its way runs along the surface there
            assert first - travel < slack + 3.0
    assert hits > 60


def test_distance_to_the_bodies_never_exceeds_that_to_the_cloud(standard):
    cloud = sampled(standard, 2.0)
    rng = np.random.default_rng(5)
    points = rng.uniform([-140, -140, 35], [140, 140, 200], (400, 3))
    to_cloud = np.array([np.linalg.norm(cloud - p, axis=1).min() for p in points])
    assert np.all(standard.distance(points) <= to_cloud + UM)
    # and it is of use: above a face it is not much smaller than the truth
    patch = standard.patches[1]
    uv = patch.grid(4.0)
    lifted = patch.point(uv) + 10.0 * patch.normal(uv)
    assert standard.columns[patch.name].distance(lifted).min() > 6.0
