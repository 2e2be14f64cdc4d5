"""How a face is best milled: tilt of the cutter, contact angles, step-over for a roughness.

Between two passes of a ball of radius r, a step-over s apart on a surface of curvature k (positive
= convex), a cusp of height ``h = s^2 (1/r + k) / 8`` is left; its profile is a parabola, whose mean
deviation is ``Ra = 4 h / (9 sqrt 3)``. The tip of a ball-end mill does not cut, it rubs: the angle
between its axis and the normal, at which it touches, should stay away from zero.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.cad_out.making.cutting import RADIUS, TILTS, is_free
from matstd.twin.frames import Array
from matstd.twin.units import UM

ROUGHNESS = (0.2 * UM, 0.4 * UM, 0.8 * UM)  # Ra for which step-overs are listed, mm
_RA = 4.0 / (9.0 * np.sqrt(3.0))  # of the height of a parabolic cusp
_AZIMUTHS = 8
_PITCH = 10.0  # mm between the places that are tested


@dataclass(frozen=True, slots=True)
class FaceHint:
    """How one face is milled with the finishing cutter."""

    convex: float  # least convex radius of the trimmed face, mm; inf where it has none
    slope: tuple[float, float]  # least and largest angle between its normals and z, rad
    step_over: tuple[float, ...]  # for every roughness of `ROUGHNESS`, mm
    # tilts of the axis at which the cutter reaches all of it in some direction, rad
    tilts: tuple[float, ...]
    # tilt and azimuth of the axis that keeps farthest from cutting with the tip, rad; None where
    # the cutter reaches all of the face at no single tilt
    axis: tuple[float, float] | None
    contact: tuple[float, float] | None  # least and largest contact angle with that axis, rad


def step_over(roughness: float, radius: float, curvature: float) -> float:
    """Between two passes, mm.

    Args:
        roughness: Ra across the passes, mm.
        radius: Of the ball, mm.
        curvature: Of the surface across the passes, 1/mm, positive = convex.
    """
    return float(np.sqrt(8.0 * roughness / _RA / (1.0 / radius + curvature)))


def hints_of(standard: Standard) -> dict[str, FaceHint]:
    """For every face, by name."""
    return {patch.name: _hint(standard, patch) for patch in standard.patches}


def _hint(standard: Standard, patch: FreeformPatch) -> FaceHint:
    uv = patch.grid(_PITCH)
    normal = patch.normal(uv)
    centre = patch.point(uv) + (RADIUS + 0.01) * normal
    slope = np.arccos(np.clip(normal[:, 2], -1.0, 1.0))
    convex = max(-float(patch.curvature(patch.grid(2.0))[:, 1].min()), 0.0)
    tilts, axis, contact = _tilts(standard, centre, normal)
    return FaceHint(
        convex=1.0 / convex if convex > 1e-9 else float("inf"),
        slope=(float(slope.min()), float(slope.max())),
        step_over=tuple(step_over(ra, RADIUS, convex) for ra in ROUGHNESS),
        tilts=tilts,
        axis=axis,
        contact=contact,
    )


def _tilts(
    standard: Standard, centre: Array, normal: Array
) -> tuple[tuple[float, ...], tuple[float, float] | None, tuple[float, float] | None]:
    """Tilts at which the whole face is reached, the best axis, and its contact angles."""
    good: list[float] = []
    best: tuple[float, float] | None = None
    contact: tuple[float, float] | None = None
    for tilt in (0.0, *TILTS):
        for k in range(_AZIMUTHS if tilt else 1):
            azimuth = k * 2.0 * np.pi / _AZIMUTHS
            across = np.sin(tilt)
            axis = np.array([across * np.cos(azimuth), across * np.sin(azimuth), np.cos(tilt)])
            angle = np.arccos(np.clip(normal @ axis, -1.0, 1.0))
            if angle.max() > 0.5 * np.pi or not is_free(standard, centre, axis).all():
                continue
            good += [tilt] if tilt not in good else []
            if contact is None or angle.min() > contact[0] + 1e-9:
                best = (tilt, azimuth)
                contact = (float(angle.min()), float(angle.max()))
    return tuple(good), best, contact
