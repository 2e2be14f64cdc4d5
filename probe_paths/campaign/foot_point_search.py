"""Foot points of balls on the calibrated surfaces of a standard."""

import numpy as np

from artefact.body import Standard
from twin.frames import Array
from twin.record import Labels


def foot_points(standard: Standard, feature: Labels, ball: Array) -> tuple[Array, Array]:
    """Foot points (N, 3) of balls (N, 3) on their features, and outward normals, artefact frame.

    nan where a ball is so far off that its surface has no foot point for it.
    """
    point, normal = np.full(ball.shape, np.nan), np.full(ball.shape, np.nan)
    for name in dict.fromkeys(feature.tolist()):
        rows = np.flatnonzero(feature == name)
        surface = standard.features[name]
        uv = surface.project(ball[rows])
        there = np.all(np.isfinite(uv), axis=1)
        point[rows[there]] = surface.point(uv[there])
        normal[rows[there]] = surface.normal(uv[there])
    return point, normal
