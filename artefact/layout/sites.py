"""From a list of sites to a whole standard: columns, core, spheres and holes follow by rule."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.artefact.body import (
    Base,
    Core,
    DatumSphere,
    ErrorShare,
    FreeformPatch,
    Limits,
    Material,
    MountingHole,
    Standard,
    graph_patch,
)
from matstd.artefact.layout.spread import rim, spread
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, apply, pose, rotation

_ROOTED = 5.0  # mm a column runs on below mid-base, where it is cut off: no two faces coincide
_PASSES = 15.0  # mm from the axis within which a column ends in the core


@dataclass(frozen=True, eq=False)
class Site:
    """Where a patch sits, which way it looks, how large it is, and its shape.

    The patch frame is ``R = Rz(azimuth + lean) Ry(tilt) Rz(spin)`` at
    ``(radius cos azimuth, radius sin azimuth, height)``: with lean zero the patch looks outwards
    by its tilt, and its column runs back towards the middle of the standard.

    Attributes:
        azimuth: Of the site about the artefact's z axis, rad.
        radius: Distance from that axis, mm.
        height: Above the seat, mm.
        tilt: Of the patch's own direction from the vertical, rad.
        half_size: Half sides of the face, mm.
        heights: Control heights of the spline, shape (nu, nv), mm.
        spin: Turn of the rectangle about the patch's own direction, rad.
        lean: Azimuth in which it is tilted, counted from the site's own azimuth, rad.
        degree: Of the spline in u and v.
        errors: The error parameters the patch is for.
    """

    azimuth: float
    radius: float
    height: float
    tilt: float
    half_size: tuple[float, float]
    heights: Array
    spin: float = 0.0
    lean: float = 0.0
    degree: tuple[int, int] = (5, 5)
    errors: tuple[ErrorShare, ...] = ()

    @property
    def T_artefact_patch(self) -> Array:
        """Pose of the patch frame, shape (4, 4)."""
        z, y = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
        R = (
            rotation((self.azimuth + self.lean) * z)
            @ rotation(self.tilt * y)
            @ rotation(self.spin * z)
        )
        origin = [
            self.radius * np.cos(self.azimuth),
            self.radius * np.sin(self.azimuth),
            self.height,
        ]
        return pose(R, np.array(origin))


@dataclass(frozen=True, slots=True)
class Fittings:
    """Spheres and holes that every standard gets, wherever there is room for them.

    Attributes:
        sphere_radius: Of the precision balls, mm.
        sphere_heights: Of their centres above the seat, one a sphere, mm.
        post_radius: Of a post at the centre of its ball, mm.
        stem_radius: Of a stem made by hand at its ball, mm.
        foot_radius: Of a stem made by hand at the base, mm.
        hole_count: Number of mounting holes.
        hole_radius: Of the through hole, mm (M10: 5.5).
        bore_radius: Of the counterbore, mm (M10: 9).
        bore_depth: Mm (M10: 11).
    """

    sphere_radius: float = 12.5
    sphere_heights: tuple[float, ...] = (65.0, 80.0, 95.0)
    post_radius: float = 8.0
    stem_radius: float = 6.0
    foot_radius: float = 9.0
    hole_count: int = 4
    hole_radius: float = 5.5
    bore_radius: float = 9.0
    bore_depth: float = 11.0


@dataclass(frozen=True, slots=True)
class Blank:
    """Everything of a standard that is not its patches.

    Attributes:
        base: Plate.
        fittings: Spheres and holes.
        material: What it is made of.
        height: Of the blank above the seat, mm.
        limits: Room that spheres and holes are given.
    """

    base: Base = field(default_factory=Base)
    fittings: Fittings = field(default_factory=Fittings)
    material: Material = field(default_factory=lambda: Material().with_usual_modulus())
    height: float = 220.0
    limits: Limits = field(default_factory=Limits)


def standard_from_sites(
    name: str, sites: Iterable[Site], blank: Blank | None = None, serial: str = ""
) -> Standard:
    """A whole standard from its sites: patches FF1 ..., columns, core, SPH1 ..., HOLE1 ...

    Columns run back along their patch's own direction until they are rooted in the base or reach
    the axis of the standard, where a core as large as their ends receives them. Spheres and
    holes take the places along the rim that are free and as far from each other as possible.
    The result is not checked against the limits: call `matstd.artefact.body.limits.check`.

    Args:
        name: Type of the standard.
        sites: Of the patches, in the order of their names.
        blank: Base, fittings, material and limits; the defaults suit a 280 mm blank.
        serial: Of the piece.

    Returns:
        The standard.

    Raises:
        NotBuildable: No site at all, or no free place for a sphere or a hole.
    """
    blank = blank or Blank()
    sites = list(sites)
    if not sites:
        raise NotBuildable(f"standard '{name}': no site for a patch")
    patches = tuple(patch_of_site(f"FF{i}", site, blank.base) for i, site in enumerate(sites, 1))
    standard = Standard(
        name=name,
        serial=serial,
        material=blank.material,
        base=blank.base,
        core=_core(patches, blank.base),
        patches=patches,
        spheres=(),
        holes=(),
        blank_height=blank.height,
    )
    spheres = _spheres(standard, blank)
    return replace(standard, spheres=spheres, holes=_holes(standard, spheres, blank))


def patch_of_site(name: str, site: Site, base: Base) -> FreeformPatch:
    """The patch of one site, its column as long as the base and the axis ask for."""
    T = site.T_artefact_patch
    return graph_patch(
        name, T, site.half_size, site.heights, site.degree, _depth(T, site, base), site.errors
    )


def _depth(T_artefact_patch: Array, site: Site, base: Base) -> float:
    """Length of a column: to below mid-base, or to where it passes the axis of the standard."""
    origin, up = T_artefact_patch[:3, 3], T_artefact_patch[:3, 2]
    sideways = float(np.hypot(up[0], up[1]))
    to_base = np.inf
    if up[2] > 0.05:
        # The whole end must be below mid-base, its upper corner too.
        corner = np.hypot(*site.half_size) * sideways
        to_base = (origin[2] - 0.5 * base.thickness + corner) / up[2] + _ROOTED
    to_axis = np.inf
    if sideways > 1e-6:
        to_axis = float(origin[:2] @ up[:2]) / sideways**2
        passes_by = np.hypot(*(origin - to_axis * up)[:2])  # the core must not grow to meet it
        too_low = origin[2] - to_axis * up[2] < 0.5 * base.thickness
        if to_axis <= _ROOTED or too_low or passes_by > _PASSES:
            to_axis = np.inf
    depth = min(to_base, to_axis)
    if not np.isfinite(depth):
        raise NotBuildable(
            f"site at azimuth {site.azimuth:.3f} rad, height {site.height:g} mm: its column "
            "meets neither the base nor the axis"
        )
    return float(depth)


def _core(patches: tuple[FreeformPatch, ...], base: Base) -> Core | None:
    """A core that takes in the ends of all columns that end above the base."""
    corners = []
    for patch in patches:
        a, b = patch.half_size
        end = np.array([[x, y, -patch.depth] for x in (-a, a) for y in (-b, b)])
        corners.append(apply(patch.T_artefact_patch, end))
    above = [end for end in corners if end[:, 2].max() > base.thickness]
    if not above:
        return None
    ends = np.concatenate(above)
    radius = float(np.hypot(ends[:, 0], ends[:, 1]).max()) + 1.0
    return Core(radius + 4.0, radius, float(ends[:, 2].max()) + 1.0)


def _spheres(standard: Standard, blank: Blank) -> tuple[DatumSphere, ...]:
    fit, top = blank.fittings, blank.base.thickness
    places = rim(blank.base, fit.foot_radius + 3.0)
    around = fit.sphere_radius + 2.0 * blank.limits.ball_radius + blank.limits.gap
    options = []
    for number, height in enumerate(fit.sphere_heights, 1):
        centres = np.column_stack([places, np.full(len(places), height)])
        free = _room(standard, places, np.array([height])) >= around
        free &= _room(standard, places, np.linspace(top, height, 9)) >= fit.foot_radius + 3.0
        if not free.any():
            raise NotBuildable(
                f"standard '{standard.name}': no free place on the rim for SPH{number}, centre "
                f"{height:g} mm above the seat"
            )
        options.append(centres[free])
    return tuple(
        DatumSphere(
            name=f"SPH{i}",
            centre=c,
            radius=fit.sphere_radius,
            stem_radius=fit.stem_radius,
            foot_radius=fit.foot_radius,
            foot=top,
        )
        for i, c in enumerate(spread(options), 1)
    )


def _holes(
    standard: Standard, spheres: tuple[DatumSphere, ...], blank: Blank
) -> tuple[MountingHole, ...]:
    fit, base = blank.fittings, blank.base
    places = rim(base, fit.bore_radius + 5.0)
    for s in spheres:
        # A screw and its key come from above, past the ball.
        apart = np.linalg.norm(places - s.centre[:2], axis=1)
        places = places[apart >= fit.bore_radius + max(s.radius, s.foot_radius) + 2.0]
    heights = np.arange(base.thickness, blank.height + 4.0, 4.0)
    places = places[_room(standard, places, heights) >= fit.bore_radius + 2.0]
    if len(places) < fit.hole_count:
        raise NotBuildable(
            f"standard '{standard.name}': {len(places)} free places on the rim for "
            f"{fit.hole_count} mounting holes"
        )
    return tuple(
        MountingHole(
            name=f"HOLE{i}",
            x=float(x),
            y=float(y),
            radius=fit.hole_radius,
            bore_radius=fit.bore_radius,
            bore_depth=fit.bore_depth,
        )
        for i, (x, y) in enumerate(spread([places] * fit.hole_count), 1)
    )


def _room(standard: Standard, places: Array, heights: Array) -> Array:
    """Distance of columns and core from upright lines at places (K, 2), (K,), mm."""
    points = np.column_stack([np.repeat(places, len(heights), 0), np.tile(heights, len(places))])
    bodies = [body for name, body in standard.bodies.items() if name != "BASE"]
    room = np.min([body.distance(points) for body in bodies], axis=0)
    nearest: Array = room.reshape(len(places), len(heights)).min(axis=1)
    return nearest
