"""Deviations refer to where the ball met the surface, however far the machine carried it along."""

import numpy as np

from artefact.freeform import FreeformPatch
from artefact.sites import Frame, Site, standard_from_sites
from probe_paths.alignment import aligned_feet
from probe_paths.feet import foot_points
from twin.frames import rotation
from twin.units import UM

RADIUS = 3.0


def touched(seed: int) -> tuple[object, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A standard, features, true contact points, normals and true ball centres of one pose."""
    rng = np.random.default_rng(seed)
    sites = []
    for k in range(5):
        u, v = np.meshgrid(np.linspace(-1, 1, 8), np.linspace(-1, 1, 8), indexing="ij")
        a, b = rng.uniform(0.0, 2.0 * np.pi, 2)
        heights = 2.2 * (np.sin(2.4 * u + a) * np.cos(1.1 * v) + np.sin(2.2 * v + b))
        tilt = 0.0 if k == 0 else 0.6
        sites.append(Site(1.5 * k, 0.0 if k == 0 else 85.0, 120.0, tilt, (20.0, 20.0), heights))
    standard = standard_from_sites("curved", sites, Frame())
    feature, point, normal = [], [], []
    for patch in standard.patches:
        assert isinstance(patch, FreeformPatch)
        uv = rng.uniform(-15.0, 15.0, (6, 2))
        feature += [patch.name] * 6
        point.append(patch.point(uv))
        normal.append(patch.normal(uv))
    p, n = np.concatenate(point), np.concatenate(normal)
    return standard, np.array(feature), p, n, p + RADIUS * n


def test_curvature_does_not_pass_for_a_deviation() -> None:
    """The machine believes the balls 0.7 mm and 0.5 mrad beside: only -n.d may be left of it."""
    standard, feature, _, normal, true = touched(1)
    turn = rotation(np.array([3e-4, -4e-4, 2e-4]))
    displaced = (true - [0.0, 0.0, 100.0]) @ turn.T + [0.5, -0.4, 0.2] + [0.0, 0.0, 100.0]
    pose = np.zeros(len(true), dtype=np.int64)
    by_definition = np.einsum("ni,ni->n", normal, displaced - true)

    def deviation(feet: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        p, n = feet
        return np.einsum("ni,ni->n", n, displaced - p) - RADIUS

    plain = deviation(foot_points(standard, feature, displaced)) - by_definition
    aligned = deviation(aligned_feet(standard, feature, displaced, pose, RADIUS)) - by_definition
    assert np.abs(plain).max() > 1.0 * UM  # so the test has something to see
    assert np.abs(aligned).max() < 0.1 * np.abs(plain).max()


def test_few_touches_stay_where_they_are() -> None:
    """Two touches cannot place a pose: what they leave open is not moved."""
    standard, feature, point, _, true = touched(2)
    rows = np.array([0, 1])
    pose = np.zeros(2, dtype=np.int64)
    feet, _ = aligned_feet(standard, feature[rows], true[rows], pose, RADIUS)
    assert np.abs(feet - point[rows]).max() < 0.01 * UM


def test_noise_does_not_slide_a_pose_along_what_it_sees_badly() -> None:
    """Seven touches of one face: noise of a micrometre moves no foot point by twenty."""
    standard, feature, _, normal, true = touched(3)
    rows = np.flatnonzero(feature == feature[0])
    rows = np.append(rows, rows[-1] + 1)
    pose = np.zeros(len(rows), dtype=np.int64)
    believed = true[rows] + [0.1, -0.15, 0.05]
    noise = np.random.default_rng(3).normal(0.0, 1.0 * UM, (len(rows), 1))
    feet, _ = aligned_feet(standard, feature[rows], believed, pose, RADIUS)
    other = believed + normal[rows] * noise
    again, _ = aligned_feet(standard, feature[rows], other, pose, RADIUS)
    assert np.abs(feet - again).max() < 20.0 * UM
