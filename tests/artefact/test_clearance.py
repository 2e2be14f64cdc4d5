"""Room for the probe: never more than a dense sampling of its cylinders finds, rarely much less."""

import numpy as np
import pytest

from matstd.artefact.body import Limits
from matstd.artefact.body.solids import column
from matstd.artefact.layout import Blank, Wave, wavy_face
from matstd.artefact.reach import ProbeShape, Solid, clearance
from matstd.twin.errors import DesignError, ShapeMismatch
from matstd.twin.frames import unit
from matstd.twin.sampling import grid_points
from matstd.twin.units import DEG

PROBE = ProbeShape(3.0, ((50.0, 1.5), (80.0, 10.0), (160.0, 31.0)))
BALL = 3.0


def cloud_of(standard):
    """Points on faces, walls and spheres."""
    points = [
        s.point(np.random.default_rng(1).uniform([-3, -1], [3, 1.5], (500, 2)))
        for s in standard.spheres
    ]
    for patch in standard.patches:
        points.append(patch.point(patch.grid(1.0)))
        (a, b), T = patch.half_size, patch.T_artefact_patch
        u = np.linspace(-1.0, 1.0, 60)
        border = np.concatenate(
            [np.column_stack([s * np.ones(60) * a, u * b]) for s in (-1, 1)]
            + [np.column_stack([u * a, s * np.ones(60) * b]) for s in (-1, 1)]
        )
        for share in np.linspace(0.0, 1.0, 60):
            z = patch.height(border) * (1.0 - share) - patch.depth * share
            points.append(np.column_stack([border, z]) @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(points)


def cylinder_room(cloud, centre, axis):
    """Distance of the cloud from the nearest of the probe's cylinders, exact for each point."""
    along = (cloud - centre) @ axis
    across = np.sqrt(np.maximum(((cloud - centre) ** 2).sum(axis=1) - along**2, 0.0))
    rooms, low = [], BALL
    for end, radius in PROBE.cylinders:
        beside, beyond = across - radius, np.maximum(low - along, along - end)
        outside = np.hypot(np.maximum(beside, 0.0), np.maximum(beyond, 0.0))
        rooms.append((outside + np.minimum(np.maximum(beside, beyond), 0.0)).min())
        low = end
    return min(rooms)


def test_distance_from_a_wavy_lid_is_that_of_a_dense_sampling():
    """The bound by the steepest slope of a lid falls short by millimetres where it is gentle."""
    wave = Wave((0.0, 0.0), (60.0, 60.0), 60.0, 48.0 * DEG, 0.9)
    face = wavy_face(
        "FF1", Blank(limits=Limits(min_concave_radius=8.0, max_slope=50.0 * DEG)), wave
    )
    lid, rng = column(face), np.random.default_rng(3)
    place = rng.uniform(-50.0, 50.0, (40, 2))
    points = face.point(place) + np.outer(rng.uniform(0.5, 7.0, 40), [0.0, 0.0, 1.0])
    near = grid_points(*[np.arange(-8.0, 8.01, 0.1)] * 2)
    found, bound = lid.distance_from_lid(points), lid.distance(points)
    short = []
    for at, point, mine, low in zip(place, points, found, bound, strict=True):
        exact = np.linalg.norm(face.point(at + near) - point, axis=1).min()
        assert mine <= exact
        assert mine > min(exact, face.sharpest_valley) - 0.01
        short.append(exact - low)
    assert max(short) > 1.0


def test_clearance_is_from_below_and_close(standard):
    rng = np.random.default_rng(0)
    cloud = cloud_of(standard)
    losses, free = [], []
    for patch in standard.patches:
        uv = rng.uniform(-0.8, 0.8, (12, 2)) * np.array(patch.half_size)
        centre = patch.point(uv) + BALL * patch.normal(uv)
        axis = unit(patch.normal(uv) + 0.8 * rng.normal(size=(12, 3)))
        found = clearance(standard, centre, axis, PROBE)
        for c, a, room in zip(centre, axis, found.distance, strict=True):
            exact = cylinder_room(cloud, c, a)
            # half a millimetre is what the cloud misses between its points
            assert room <= exact + 0.5 if exact > 0.0 else room < 0.5
            if exact > 0.0 and room < 1.5:
                losses.append(exact - room)
            free.append(exact > 0.0 and room < 0.0)
    # the balls stand out by an eighth of the largest radius, the lower bounds take the rest
    assert len(losses) > 3
    assert np.median(losses) < 31.0 / 8.0 + 1.5
    assert np.mean(free) < 0.15  # seldom is a free touch called blocked


def test_free_from_above_and_blocked_from_aside(standard):
    top = standard.patches[0]
    centre = top.point(np.zeros((1, 2))) + BALL * top.normal(np.zeros((1, 2)))
    assert clearance(standard, centre, np.array([0.0, 0.0, 1.0]), PROBE).distance[0] > 0.5
    low = standard.patches[5]
    centre = low.point(np.zeros((1, 2))) + BALL * low.normal(np.zeros((1, 2)))
    inwards = unit(np.array([-1.0, 0.0, 0.6]))
    found = clearance(standard, centre, inwards, PROBE)
    assert found.distance[0] < 0.0
    assert found.body[0] in standard.bodies


def test_room_beside_a_sphere_in_closed_form(standard):
    # Upright over a sphere's shoulder: the stem of the stylus passes the ball on its way up only
    # at the touch itself, so the room is what the touching ball leaves: R - r of the stylus.
    sphere = standard.spheres[2]
    n = np.array([[np.cos(0.4), np.sin(0.4), 0.0]])
    centre = sphere.centre + (sphere.radius + BALL) * n
    probe = ProbeShape(BALL, ((60.0, 1.5),))
    found = clearance(standard, centre, np.array([0.0, 0.0, 1.0]), probe)
    # the first cover starts 0.7 R up and is no larger than needed
    assert found.distance[0] == pytest.approx(BALL - 1.5, abs=0.35)
    assert found.body[0] == sphere.name


def test_probe_shapes_that_make_no_sense_are_refused():
    with pytest.raises(ShapeMismatch, match="ascending ends beyond the ball radius 3 mm"):
        ProbeShape(3.0, ((50.0, 1.5), (40.0, 10.0)))
    with pytest.raises(ShapeMismatch, match="expected ascending ends"):
        ProbeShape(3.0, ())


@pytest.mark.parametrize("cover", [PROBE.rough_cover(), PROBE.fine_cover()])
def test_covers_hold_every_point_of_the_cylinders_surface(cover):
    centres, radii = cover
    rng = np.random.default_rng(2)
    low = BALL
    for end, radius in PROBE.cylinders:
        angle = rng.uniform(0.0, 2.0 * np.pi, 4000)
        height = rng.uniform(low, end, 4000)
        r = np.full(4000, radius)
        r[:2000], height[:2000] = radius * np.sqrt(rng.uniform(0.0, 1.0, 2000)), low
        points = np.column_stack([r * np.cos(angle), r * np.sin(angle), height])
        apart = np.linalg.norm(points[:, None] - centres, axis=2) - radii
        assert apart.min(axis=1).max() < 1e-9
        low = end


@pytest.mark.parametrize(
    ("half_size", "low", "high"),
    [((0.0, 5.0), 0.0, 1.0), ((5.0, -1.0), 0.0, 1.0), ((5.0, 5.0), 1.0, 1.0)],
)
def test_a_solid_without_volume_is_refused(half_size, low, high):
    assert Solid("CLAMP", (5.0, 5.0), low=0.0, high=1.0).plate.half_size == (5.0, 5.0)
    with pytest.raises(DesignError, match=r"CLAMP: .* expected positive sides"):
        Solid("CLAMP", half_size, low=low, high=high)
