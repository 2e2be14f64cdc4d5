"""Smooth random shapes of freeform faces, as pronounced as cutter and probe allow.

A shape is a paraboloid plus one wave; it is scaled until its slope, height or concave radius
reaches a limit, because larger differences of normals and heights carry more information.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from matstd.artefact.body import Limits, graph_patch
from matstd.twin.frames import Array
from matstd.twin.units import DEG

CONTROL_HEIGHTS = 8
"""Control heights of a patch in u and v: enough for one wave, too few for ripples."""

_LIMIT_MARGIN = 1.15
"""Safety factor on the limits of curvature and slope, which are evaluated on grids."""

_MAX_SLOPE = 60.0 * DEG  # of any face: a ball-end cutter can still finish it
_MAX_RISE = 7.0  # rise of a shape above its mean plane, mm
_PITCH = 2.5  # mm, of the grid on which shapes are scaled


def steepest_slope(limits: Limits) -> float:
    """Largest slope dh/du of a face, with a margin."""
    return float(np.tan(min(limits.max_slope, _MAX_SLOPE) / _LIMIT_MARGIN))


def smooth_heights(
    half_size: tuple[float, float],
    limits: Limits,
    rng: np.random.Generator,
    tallest: float = _MAX_RISE,
    plane: tuple[float, float] = (0.0, 0.0),
) -> Array:
    """Control heights of a random smooth shape on a plane, as pronounced as the limits allow.

    A random bowl, dome or saddle with a random wave of one to two times the patch's length on it.
    It is scaled until its slope or its smallest concave radius is 15 % from the limit.

    Args:
        half_size: Half sides of the face, mm.
        rng: Draws the shape.
        tallest: Largest height above or below its plane, mm.

    Returns:
        Shape (`CONTROL_HEIGHTS`, `CONTROL_HEIGHTS`), mm, with mean zero.
    """
    flat = graph_patch("flat", np.eye(4), half_size, np.zeros((CONTROL_HEIGHTS, CONTROL_HEIGHTS)))
    x, y = flat.poles[..., 0], flat.poles[..., 1]
    slanted = plane[0] * x + plane[1] * y
    ends = np.linspace(-1.0, 1.0, CONTROL_HEIGHTS)
    u, v = np.meshgrid(half_size[0] * ends, half_size[1] * ends, indexing="ij")
    size = float(np.mean(half_size))
    bend = rng.uniform(-1.0, 0.6, 2)  # more domes than bowls: every normal of a dome is accessible
    h = 0.5 * (bend[0] * u**2 + bend[1] * v**2 + rng.uniform(-0.7, 0.7) * u * v) / size
    direction, phase = rng.uniform(0.0, 2.0 * np.pi, 2)
    k = np.pi / (size * rng.uniform(1.0, 2.0))
    across = np.cos(direction) * u + np.sin(direction) * v
    h += rng.uniform(0.3, 0.9) / k * np.sin(k * across + phase)
    h -= h.mean()
    return slanted + h * _strength(half_size, h, limits, tallest, plane)


def _strength(
    half_size: tuple[float, float],
    heights: Array,
    limits: Limits,
    tallest: float,
    plane: tuple[float, float],
) -> float:
    """Factor that brings a shape on a plane to its limits.

    The triangle inequality bounds slope and height.
    """
    patch = graph_patch("trial", np.eye(4), half_size, heights)
    j = patch.jet(patch.grid(_PITCH))
    # the plane below it has slopes alone; its height is not looked at
    flat = replace(j.plus(j, -1.0), hu=plane[0] + 0.0 * j.hu, hv=plane[1] + 0.0 * j.hv)
    left = steepest_slope(limits) - float(np.hypot(*plane))
    high = min(left / float(np.hypot(j.hu, j.hv).max()), tallest / float(np.abs(j.h).max()))
    radius = _LIMIT_MARGIN * limits.min_concave_radius
    return bent_to(lambda f: flat.plus(j, f).curvature, high, radius)


def bent_to(curvature: Callable[[float], Array], high: float, radius: float) -> float:
    """Largest factor of a shape, from 0 to `high`, with which it keeps a concave radius, mm.

    Curvature (N, 2) is not linear in the factor, so the factor is bisected.
    """
    low = 0.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        if radius * float(curvature(middle)[:, 0].max()) > 1.0:
            high = middle
        else:
            low = middle
    return low
