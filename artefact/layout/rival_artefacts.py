"""Artefacts in use, modelled as bodies with the same obstacles to the probe as the standard."""

from collections.abc import Sequence

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard, graph_patch
from matstd.artefact.layout.blank import Blank
from matstd.artefact.layout.shapes import smooth_heights
from matstd.artefact.layout.upright import ball_on_post
from matstd.sensitivity.first_order import Box
from matstd.twin.frames import Array, pose, rotation
from matstd.twin.units import DEG

_SIDE_OFFSET = 2.0  # mm by which the sides of the block stand out beyond its top
_MAX_RISE = 40.0  # mm that the one face may rise above its plane
_COLUMN_END = 5.0  # mm above mid-base, where columns end


def rivals(volume: Box, blank: Blank, rng: np.random.Generator) -> dict[str, Standard]:
    """A five-sided block and one random freeform face in a volume (mm), on the same base."""
    return {
        "five-sided block": _standard("BLOCK", blank, _block(volume, blank)),
        "one freeform face": _standard("FACE", blank, (_one_face(volume, blank, rng),)),
    }


def _standard(
    name: str,
    blank: Blank,
    patches: tuple[FreeformPatch, ...],
    spheres: tuple[DatumSphere, ...] = (),
) -> Standard:
    return Standard(
        name=name,
        serial="",
        material=blank.material,
        base=blank.base,
        core=None,
        patches=patches,
        spheres=spheres,
        holes=(),
        blank_height=blank.height,
    )


def with_spheres(blank: Blank, centres: Sequence[Array]) -> Standard:
    """A standard of balls on posts alone, with centres (3,), SPH1 ..."""
    spheres = tuple(ball_on_post(blank, f"SPH{i}", c) for i, c in enumerate(centres, 1))
    return _standard("SPHERES", blank, (), spheres)


def _block(volume: Box, blank: Blank) -> tuple[FreeformPatch, ...]:
    """Five plane faces: the top, and four sides slightly outside it."""
    half, low, high = volume[1][0], blank.base.thickness, volume[1][2]
    depth = high - 0.5 * low
    faces = [_plane("TOP", pose(t=np.array([0.0, 0.0, high])), (half, half), depth)]
    tall = 0.5 * (high - low) - _SIDE_OFFSET
    middle = 0.5 * (low + high)
    for i in range(4):
        z, y = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
        R = rotation(i * 90 * DEG * z) @ rotation(90 * DEG * y)
        centre = R @ np.array([0.0, 0.0, half + _SIDE_OFFSET]) + np.array([0.0, 0.0, middle])
        # x of the patch runs downwards, y along the side
        faces.append(_plane(f"SIDE{i + 1}", pose(R, centre), (tall, half - _SIDE_OFFSET), half))
    return tuple(faces)


def _plane(name: str, T: Array, half_size: tuple[float, float], depth: float) -> FreeformPatch:
    return graph_patch(name, T, half_size, np.zeros((4, 4)), (3, 3), depth)


def _one_face(volume: Box, blank: Blank, rng: np.random.Generator) -> FreeformPatch:
    """One smooth face over the whole volume, as steep as the limits allow, in mid-height."""
    (x0, y0, z0), (x1, y1, z1) = volume
    half, middle = (0.5 * (x1 - x0), 0.5 * (y1 - y0)), 0.5 * (z0 + z1)
    place = pose(t=np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1), middle]))
    heights = smooth_heights(half, blank.limits, rng, tallest=_MAX_RISE)
    return graph_patch("FACE", place, half, heights, depth=middle - _COLUMN_END)
