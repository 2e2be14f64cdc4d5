"""Patches that could be made: smooth random shapes on sites all over a blank."""

from dataclasses import dataclass, replace

import numpy as np

from artefact.body import Base, Limits, graph_patch, overhang
from artefact.layout.sites import Blank, Site, patch_of_site
from twin.errors import NotBuildable
from twin.frames import Array
from twin.units import DEG

CONTROL = 8
"""Control heights of a patch each way: enough for one wave, too few for ripples."""

_MARGIN = 1.15
"""Shapes stay this far from the limits of curvature and slope, which are measured on grids."""

STEEPEST = 35.0 * DEG  # within a patch: beyond it a three-axis finishing cut leaves ridges
TALLEST = 7.0
"""What the shape of a patch may rise above its plane, mm, for the room that neighbours keep."""

_PITCH = 2.5  # mm, of the grid on which shapes are scaled


@dataclass(frozen=True, slots=True)
class Ring:
    """A zone of the standard in which sites are tried, each value drawn evenly.

    Attributes:
        share: Part of all sites that are tried here.
        radius: From the axis, mm.
        height: Above the seat, mm.
        tilt: Of the patch's own direction from the vertical, rad.
        lean: Away from outwards, to either side, rad.
        half_size: Half sides, mm.
    """

    share: float
    radius: tuple[float, float]
    height: tuple[float, float]
    tilt: tuple[float, float]
    lean: tuple[float, float]
    half_size: tuple[float, float]


RINGS = (
    Ring(
        share=0.08,
        radius=(0.0, 6.0),
        height=(130.0, 160.0),
        tilt=(0.0, 15.0 * DEG),
        lean=(0.0, 0.0),
        half_size=(17.0, 24.0),
    ),
    Ring(
        share=0.30,
        radius=(50.0, 90.0),
        height=(90.0, 150.0),
        tilt=(10 * DEG, 45 * DEG),
        lean=(40 * DEG, 100 * DEG),
        half_size=(15, 22),
    ),
    Ring(
        share=0.62,
        radius=(80.0, 122.0),
        height=(60.0, 120.0),
        tilt=(20 * DEG, 60 * DEG),
        lean=(35 * DEG, 110 * DEG),
        half_size=(15, 22),
    ),
)
"""Top, shoulder and flank of a blank of 280 mm; scaled to other blanks by their size.

Shoulder and flank lean sideways like the blades of a fan. Faces that all look straight outwards are
nearly a sphere, which hides every rotation about its centre: after as many touches on faces alone
they leave twice the uncertainty.
"""

_TRIES = 200  # draws for each site until its column stands within the blank


def smooth_heights(
    half_size: tuple[float, float],
    limits: Limits,
    rng: np.random.Generator,
    tallest: float = TALLEST,
) -> Array:
    """Control heights of a random smooth shape, as strong as the limits allow.

    A random bowl, dome or saddle with a random wave of one to two times the patch's length on it.
    The whole is scaled until its slope or its smallest concave radius is a seventh from the limit,
    so that the normals of a patch differ as much as a cutter and a probe can follow.

    Args:
        half_size: Half sides of the face, mm.
        limits: Of slope and concave radius.
        tallest: What a shape may rise above its plane or sink below it, mm.

    Returns:
        Shape (`CONTROL`, `CONTROL`), mm, with mean zero.
    """
    x = np.linspace(-1.0, 1.0, CONTROL)
    u, v = np.meshgrid(half_size[0] * x, half_size[1] * x, indexing="ij")
    size = float(np.mean(half_size))
    bend = rng.uniform(-1.0, 0.6, 2)  # more domes than bowls: every normal of a dome is in the open
    h = 0.5 * (bend[0] * u**2 + bend[1] * v**2 + rng.uniform(-0.7, 0.7) * u * v) / size
    direction, phase = rng.uniform(0.0, 2.0 * np.pi, 2)
    wave = 2.0 * size * rng.uniform(1.0, 2.0)
    across = np.cos(direction) * u + np.sin(direction) * v
    k = 2.0 * np.pi / wave
    h += rng.uniform(0.3, 0.9) / k * np.sin(k * across + phase)
    h -= h.mean()
    return h * strength(half_size, h, limits, tallest)


def strength(
    half_size: tuple[float, float], heights: Array, limits: Limits, tallest: float
) -> float:
    """Factor that brings a shape to its limits; derivatives grow in proportion, curvature does not.

    With ``w^2 = 1 + |grad h|^2`` the curvatures are the eigenvalues of ``I^-1 II``, so the factor
    is bisected on a grid of derivatives that is evaluated once.
    """
    patch = graph_patch("trial", np.eye(4), half_size, heights)
    j = patch.jet(patch.grid(_PITCH))
    steepest = np.tan(min(limits.max_slope, STEEPEST) / _MARGIN)
    high = float(min(steepest / np.hypot(j.hu, j.hv).max(), tallest / np.abs(j.h).max()))
    low = 0.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        largest = float(j.scaled(middle).curvature[:, 0].max())
        if largest * _MARGIN * limits.min_concave_radius > 1.0:
            high = middle
        else:
            low = middle
    return low


def random_sites(blank: Blank, count: int, rng: np.random.Generator) -> list[Site]:
    """Sites all over a blank, each with a random shape, its column within the blank's outline.

    Args:
        blank: Base, blank height and limits.
        count: Number of sites, shared out over the rings.

    Raises:
        NotBuildable: A blank on which no column of some ring can stand.
    """
    sites = []
    for ring in RINGS:
        n = max(1, round(ring.share * count))
        azimuth = 2.0 * np.pi * (rng.permutation(n) + rng.random(n)) / n
        sites += [_site(blank, ring, float(a), rng) for a in azimuth]
    return sites


def _site(blank: Blank, ring: Ring, azimuth: float, rng: np.random.Generator) -> Site:
    """One site of a ring, as near to an azimuth as its column can stand."""
    wide = min(blank.base.half_size) / 140.0
    tall = blank.height / 220.0
    for turn in range(_TRIES):
        half = rng.uniform(*ring.half_size, 2) * min(wide, 1.0)
        site = Site(
            azimuth=azimuth + turn * 2.0 * np.pi / _TRIES,
            radius=float(rng.uniform(*ring.radius)) * wide,
            height=float(rng.uniform(*ring.height)) * tall,
            tilt=float(rng.uniform(*ring.tilt)),
            half_size=(float(half[0]), float(half[1])),
            heights=np.zeros((CONTROL, CONTROL)),
            lean=float(rng.choice((-1.0, 1.0)) * rng.uniform(*ring.lean)),
        )
        if _is_within(site, blank.base):
            heights = smooth_heights(site.half_size, blank.limits, rng)
            return replace(site, heights=np.round(heights, 6))
    a, b = (2.0 * side for side in blank.base.half_size)
    raise NotBuildable(f"no column stands within the outline of a blank of {a:g} x {b:g} mm")


def _is_within(site: Site, base: Base) -> bool:
    """Whether the column of a site stands within the outline of a base."""
    try:
        return overhang(patch_of_site("trial", site, base), base) <= 0.0
    except NotBuildable:  # it meets neither base nor core
        return False
