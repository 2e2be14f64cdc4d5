"""Datum spheres, plane and holes against closed forms."""

import numpy as np
import pytest
from scipy.optimize import brentq

from matstd.artefact.body import DatumSphere, MountingHole, outline_distance
from matstd.artefact.body.datum import DatumPlane
from matstd.twin.errors import ShapeMismatch
from matstd.twin.units import NM

SPHERE = DatumSphere("SPH1", np.array([10.0, -20.0, 80.0]), 12.5, 6.0, 9.0, 30.0)
PLANE = DatumPlane("DATUM_A", 30.0, (100.0, 80.0), 20.0)


def test_sphere_points_normals_and_feet():
    rng = np.random.default_rng(0)
    uv = rng.uniform([-3.1, -1.5], [3.1, 1.5], (200, 2))
    p, n = SPHERE.point(uv), SPHERE.normal(uv)
    assert np.abs(np.linalg.norm(p - SPHERE.centre, axis=1) - 12.5).max() < NM
    assert np.abs(p - SPHERE.centre - 12.5 * n).max() < NM
    assert np.abs(SPHERE.project(p + rng.uniform(-5, 30, 200)[:, None] * n) - uv).max() < 1e-12
    assert np.isnan(SPHERE.project(SPHERE.centre[None])).all()
    assert np.all(SPHERE.curvature(uv) == -1 / 12.5)


def test_rim_is_where_cone_and_ball_have_one_radius():
    def apart(z):
        cone = 6.0 + 3.0 * (80.0 - z) / 50.0
        return cone - np.sqrt(12.5**2 - (z - 80.0) ** 2)

    z = brentq(apart, 80.0 - 12.49, 75.0)
    assert np.sin(SPHERE.rim) * 12.5 == pytest.approx(z - 80.0, abs=1e-9)
    low = np.array([[0.0, SPHERE.rim + np.radians(14.9)], [0.0, SPHERE.rim + np.radians(15.1)]])
    assert SPHERE.contains(low).tolist() == [False, True]
    edge = np.array([[0.0, SPHERE.rim - 1e-9], [0.0, SPHERE.rim + 1e-9]])
    assert SPHERE.is_bare(edge).tolist() == [False, True]


def test_sphere_contact_is_at_the_sum_of_the_radii():
    start = SPHERE.centre + np.array([[40.0, 6.0, 0.0]])
    hit = SPHERE.contact(start, np.array([-1.0, 0.0, 0.0]), 3.0)
    assert hit.travel[0] == pytest.approx(40.0 - np.sqrt(15.5**2 - 36.0), abs=NM)
    missed = SPHERE.contact(start + np.array([0.0, 10.0, 0.0]), np.array([-1.0, 0.0, 0.0]), 3.0)
    assert np.isnan(missed.travel[0])
    gone_by = SPHERE.contact(start, np.array([1.0, 0.0, 0.0]), 3.0)
    assert np.isnan(gone_by.travel[0])


def test_plane_contact_and_outline():
    start = np.array([[0.0, 0.0, 60.0], [99.0, 79.0, 60.0], [0.0, 0.0, 60.0]])
    d = np.array([[0.0, 0.6, -0.8], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    hit = PLANE.contact(start, d, 3.0)
    assert hit.travel[0] == pytest.approx(27.0 / 0.8, abs=NM)
    assert hit.uv[0] == pytest.approx([0.0, 0.6 * 27.0 / 0.8], abs=NM)
    # (99, 79) lies in the rounded-off corner; away from the plane nothing is met
    assert np.isnan(hit.travel[1:]).all()
    assert PLANE.contains(np.array([[94.0, 74.0], [95.0, 75.0]])).tolist() == [True, False]


def test_outline_distance_by_hand():
    xy = np.array([[0.0, 0.0], [103.0, 10.0], [80.0 + 30.0, 60.0 + 40.0], [98.0, 0.0]])
    assert outline_distance(xy, (100.0, 80.0), 20.0) == pytest.approx([-80.0, 3.0, 30.0, -2.0])
    disc = np.array([[30.0, 40.0]])
    assert outline_distance(disc, (60.0, 60.0), 60.0) == pytest.approx([-10.0])


def test_parts_that_cannot_be_are_refused():
    with pytest.raises(ShapeMismatch, match="SPH1: stem radius 13 mm, expected between 0 and"):
        DatumSphere("SPH1", np.zeros(3), 12.5, 13.0, 15.0, -50.0)
    with pytest.raises(ShapeMismatch, match="SPH1: foot at 75 mm, expected below the ball"):
        DatumSphere("SPH1", SPHERE.centre, 12.5, 6.0, 9.0, 75.0)
    with pytest.raises(ShapeMismatch, match="HOLE1: hole radius 9 mm"):
        MountingHole("HOLE1", 0.0, 0.0, 9.0, 5.5, 10.0)
