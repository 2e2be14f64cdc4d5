"""A standard seen from above: heights on a grid, and the height at which a ball stops.

The height map dilated by the lower half of a ball gives the centres of balls that come down on it.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from matstd.artefact.body import FreeformPatch, Standard
from matstd.twin.frames import Array
from matstd.twin.sampling import grid_points

PITCH = 1.0  # spacing of the places, mm; what is found on them is refined on the exact surfaces
_FINE = 0.4  # mm between points of a face: no place between them stays empty
_MARGIN = 60.0  # mm round the base that belongs to the picture
NO_SURFACE = -1e3  # height where there is nothing, mm


@dataclass(frozen=True, eq=False)
class Relief:
    """Heights over the artefact's x and y."""

    x0: Array  # smallest x and y, (2,), mm
    top: Array  # upper end of everything solid, (I, J), mm
    ball: Array  # centre of a ball that comes down from above and touches, (I, J), mm

    @classmethod
    def of(cls, standard: Standard, radius: float) -> "Relief":
        """Relief of a standard for a ball of some radius, mm."""
        base = standard.base
        half = np.array(base.half_size) + _MARGIN
        axes = [np.arange(-h, h + PITCH, PITCH) for h in half]
        xy = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        flat = xy.reshape(-1, 2)
        top = np.full(len(flat), NO_SURFACE)
        middle = np.column_stack([flat, np.full(len(flat), 0.5 * base.thickness)])
        on_base = base.body.distance(middle) <= 0.0
        top[on_base] = base.thickness
        if standard.core is not None:
            core, far = standard.core, np.linalg.norm(flat, axis=1)
            low, high = core.low_radius, core.high_radius
            rise = np.clip((low - far) / max(low - high, 1e-9), 0.0, 1.0)
            on_core = far <= low
            height = base.thickness + rise * (core.height - base.thickness)
            top[on_core] = np.maximum(top[on_core], height[on_core])
        for sphere in standard.spheres:
            beside = np.sum((flat - sphere.centre[:2]) ** 2, axis=1)
            cap = sphere.centre[2] + np.sqrt(np.maximum(sphere.radius**2 - beside, 0.0))
            inside = beside <= sphere.radius**2
            top[inside] = np.maximum(top[inside], cap[inside])
        shape = xy.shape[:2]
        for patch in standard.patches:
            points = _face_and_walls(patch)
            ij = np.round((points[:, :2] + half) / PITCH).astype(np.int64)
            is_in = np.all((ij >= 0) & (ij < shape), axis=1)
            at = np.ravel_multi_index(tuple(ij[is_in].T), shape)
            np.maximum.at(top, at, points[is_in, 2])
        steps = np.arange(-np.ceil(radius / PITCH), np.ceil(radius / PITCH) + 1) * PITCH
        beside = steps[:, None] ** 2 + steps**2
        under = beside <= radius**2
        lift = np.sqrt(np.maximum(radius**2 - beside, 0.0))
        picture = top.reshape(shape)
        # the centre of a ball over heights is their dilation by its lower half
        ball = ndimage.grey_dilation(picture, footprint=under, structure=lift)
        return cls(-half, picture, ball)

    def index(self, xy: Array) -> Array:
        """Fractional rows and columns (2, N) of places (N, 2)."""
        return ((xy - self.x0) / PITCH).T

    def ball_at(self, xy: Array) -> Array:
        """Height of the ball's centre at places (N, 2), (N,), mm."""
        return ndimage.map_coordinates(
            self.ball, self.index(xy), order=1, mode="nearest", prefilter=False
        )


def _face_and_walls(patch: FreeformPatch) -> Array:
    """Points of a face and of the walls of its column, (N, 3), mm."""
    half = patch.half_size
    u, v = (np.arange(-h, h + _FINE, _FINE).clip(-h, h) for h in half)
    uv = grid_points(u, v)
    face = patch.point(uv)
    rim = face[np.any(np.isclose(np.abs(uv), half), axis=1)]
    below = np.arange(0.0, patch.depth, _FINE)[:, None, None] * patch.T_artefact_patch[:3, 2]
    return np.concatenate([face, (rim - below).reshape(-1, 3)])
