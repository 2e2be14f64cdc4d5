"""One large wavy face: waves in two directions, as steep as cutter, probe and blank allow.

    h(u, v) = A ( g(k a + p) + g(k b + r) ),   g(x) = arcsin(c sin x),   k = 2 pi / wavelength

with a and b at right angles in the plane of the face. Its normals point everywhere within its
slope, so it shows errors in every direction, everywhere over its plane. c goes from a sine (0) to
straight flanks with round ridges (near 1): these are steep nearly everywhere, but need a longer
wave for the same concave radius. Long waves are easily milled, short ones turn their normals within
the width of what is searched for.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import FreeformPatch, Limits, graph_patch
from matstd.artefact.layout.blank import Blank
from matstd.artefact.layout.shapes import bent_to
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, pose
from matstd.twin.units import DEG

_POLES_PER_WAVE = 9.0  # of the control net: straight flanks need more than a sine
_GRID_MARGIN = 1.03  # on slope and radius: evaluated on a grid of a twentieth of the wave
_GRID = 20.0  # points of that grid in a wave
_LEAST_SLOPE = 15.0 * DEG  # of waves that see more than a plane: a quarter of what is across them
_VALLEY_CLEARANCE = 10.0  # mm between base and the lowest valley: fillet, and room for the ball


@dataclass(frozen=True)
class Wave:
    """Shape and place of a wavy face."""

    middle: tuple[float, float]  # of the face on the base, mm
    half_size: tuple[float, float]  # half sides, mm
    wavelength: float  # mm
    slope: float  # largest angle to its plane, rad; less where another limit binds first
    flatness: float = 0.0  # c of its flanks, 0 to below 1
    turn: float = 45.0 * DEG  # of the two directions of the waves against x and y, rad
    phase: tuple[float, float] = (0.0, 0.0)  # of the two waves at the middle, rad


def wavy_face(name: str, blank: Blank, wave: Wave) -> FreeformPatch:
    """The face with its lowest valley just above the base.

    Raises:
        NotBuildable: The blank is too low for it, or no cutter of the limits makes steep waves.
    """
    heights = _wave_heights(wave, blank.limits)
    rise, base = float(np.abs(heights).max()), blank.base.thickness
    origin = np.round([*wave.middle, base + _VALLEY_CLEARANCE + rise], 1)
    if origin[2] + rise > blank.height:
        raise NotBuildable(
            f"waves of {wave.wavelength:g} mm and {wave.slope / DEG:.0f} degrees rise to "
            f"{origin[2] + rise:.1f} mm, the blank is {blank.height:g} mm high"
        )
    depth = float(origin[2]) - 0.5 * base + _VALLEY_CLEARANCE
    return graph_patch(name, pose(t=origin), wave.half_size, np.round(heights, 6), depth=depth)


def _wave_heights(wave: Wave, limits: Limits) -> Array:
    """Control heights, mm, scaled until slope or concave radius reaches its limit."""
    pitch = wave.wavelength / _POLES_PER_WAVE
    flat = graph_patch("flat", np.eye(4), wave.half_size, np.zeros(_poles(wave, pitch)))
    u, v = flat.poles[..., 0], flat.poles[..., 1]
    cos, sin, k = np.cos(wave.turn), np.sin(wave.turn), 2.0 * np.pi / wave.wavelength
    h = _profile(k * (cos * u + sin * v) + wave.phase[0], wave.flatness)
    h += _profile(k * (cos * v - sin * u) + wave.phase[1], wave.flatness)
    one = graph_patch("one", np.eye(4), wave.half_size, h)
    plane, j = (
        flat.jet(one.grid(wave.wavelength / _GRID)),
        one.jet(one.grid(wave.wavelength / _GRID)),
    )
    steepest = np.tan(min(wave.slope, limits.max_slope) / _GRID_MARGIN)
    high, radius = (
        float(steepest / np.hypot(j.hu, j.hv).max()),
        _GRID_MARGIN * limits.min_concave_radius,
    )
    if radius * plane.plus(j, high).curvature[:, 0].max() > 1.0:
        high = bent_to(lambda f: plane.plus(j, f).curvature, high, radius)
    if (slope := np.arctan(high * np.hypot(j.hu, j.hv).max())) < _LEAST_SLOPE:
        raise NotBuildable(
            f"waves of {wave.wavelength:g} mm with a concave radius of {radius:.0f} mm rise by "
            f"{slope / DEG:.0f} degrees, expected {_LEAST_SLOPE / DEG:.0f} or more: see "
            "limits.min_concave_radius_mm and limits.max_slope_deg"
        )
    return h * high


def _profile(x: Array, flatness: float) -> Array:
    """A wave with flanks from a sine (0) to straight (1)."""
    return np.asarray(np.arcsin(flatness * np.sin(x)) if flatness > 0.0 else np.sin(x))


def _poles(wave: Wave, pitch: float) -> tuple[int, int]:
    """Numbers of control heights in u and v for one every `pitch` mm, a quintic's at least."""
    a, b = (max(8, int(np.ceil((2.0 * half + 12.0) / pitch)) + 5) for half in wave.half_size)
    return a, b
