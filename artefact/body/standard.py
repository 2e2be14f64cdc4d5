"""The whole standard: one body with freeform patches, datum spheres, datum plane and holes."""

import hashlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.artefact.body.datum import DatumPlane, DatumSphere, MountingHole, outline_distance
from matstd.artefact.body.freeform import FreeformPatch
from matstd.artefact.body.known import Known
from matstd.artefact.body.material import Material
from matstd.artefact.body.patch import Surface
from matstd.artefact.body.sag import Sag
from matstd.artefact.body.solids import BLEND, Ball, Body, Column, Cone, Plate, column
from matstd.twin.display import Displayed
from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, Mask
from matstd.twin.machine import Chain
from matstd.twin.record import Labels
from matstd.twin.sampling import grid_points
from matstd.twin.units import T_REF

DATUM_PLANE = "DATUM_A"

_HULL_MARGIN = 1e-6  # mm added to a hull: squares of coordinates have lost digits


@dataclass(frozen=True, slots=True)
class Base:
    """Plate whose lower face (z = 0) sits on the table and whose upper face is the datum plane."""

    half_size: tuple[float, float] = (140.0, 140.0)  # half sides of the outline, mm
    corner_radius: float = 25.0  # mm; equal to both half sides the base is a disc
    thickness: float = 30.0

    @property
    def body(self) -> Plate:
        """The plate as a solid, without its holes."""
        return Plate(self.half_size, self.corner_radius, 0.0, self.thickness)


@dataclass(frozen=True, slots=True)
class Core:
    """Upright cone frustum in the middle in which the columns of tilted patches meet."""

    low_radius: float  # in the middle of the base, where it begins, mm
    high_radius: float  # at the top, mm
    height: float  # of the top above the base's lower face, mm


@dataclass(frozen=True, eq=False, repr=False)
class Standard(Displayed):
    """A freeform material standard in its own frame: origin in the middle of the seat, z up."""

    name: str  # on drawing, programs and runs
    serial: str  # serial number of the piece; may be empty
    material: Material  # of the body
    base: Base  # plate with the seat and the datum plane
    core: Core | None  # body in which the columns meet, or None
    patches: tuple[FreeformPatch, ...]  # freeform faces
    spheres: tuple[DatumSphere, ...]  # balls
    holes: tuple[MountingHole, ...]  # by which it is screwed to the table
    blank_height: float  # of the blank above the seat, mm; its outline is that of the base
    known: Known | None = None  # its calibration; None for a standard as designed
    # displacements by its own weight as stated in its file; None where not computed
    sag: Sag | None = None

    def __post_init__(self) -> None:
        names = [DATUM_PLANE, "BASE", "CORE"]
        names += [patch.name for patch in self.patches]
        names += [sphere.name for sphere in self.spheres]
        names += [hole.name for hole in self.holes]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ShapeMismatch(f"standard '{self.name}': two features are named {twice[0]}")

    @cached_property
    def fingerprint(self) -> str:
        """Short digest of the surfaces; a calibration states the digest of its standard."""
        digest = hashlib.sha256(f"{self.name} {self.serial}".encode())
        for patch in self.patches:
            numbers = patch.T_artefact_patch, patch.knots_u, patch.knots_v, patch.heights
            for values in (*numbers, np.array(patch.half_size)):
                digest.update(np.ascontiguousarray(values).tobytes())
        for sphere in self.spheres:
            digest.update(np.array([*sphere.centre, sphere.radius]).tobytes())
        return digest.hexdigest()[:16]

    @property
    def stamp(self) -> str:
        """Name, serial number and digest of the design, which a calibration does not change."""
        digest = self.fingerprint if self.known is None else self.known.nominal
        return " ".join(filter(None, (self.name, self.serial, digest)))

    def sagging(
        self,
        source: str,
        down: str,
        share: float,
        per_weight: Mapping[str, Array],
        modulus: float | None = None,
    ) -> "Standard":
        """With displacements by its weight; arguments as of `Sag`."""
        sag = Sag(source, down, share, per_weight, modulus=modulus)
        return replace(self, sag=sag)

    @cached_property
    def top(self) -> float:
        """Height of the highest ball or face above the seat, mm."""
        tops = [float(p.point(p.grid())[:, 2].max()) for p in self.patches]
        return max([*tops, *(float(s.centre[2] + s.radius) for s in self.spheres)])

    @property
    def remarks(self) -> tuple[str, ...]:
        """Nonconforming characteristics that were accepted at its calibration, missing values."""
        if self.known is None:
            return ()
        lines = []
        if self.known.accepted:
            named = ", ".join(self.known.accepted)
            lines = [f"calibration of '{self.name}' accepted although not conforming: {named}"]
        if self.known.u_scale is None:
            lines.append(
                f"calibration of '{self.name}' states no uncertainty of its scale (scale_u_ppm): "
                "it is taken as exact; calibrate again to state it"
            )
        return tuple(lines)

    @cached_property
    def usable_sag(self) -> Sag | None:
        """The sag scaled to the modulus of the material; None where that modulus is unknown."""
        if self.sag is None or self.sag.modulus is None:
            return self.sag
        modulus = self.material.modulus
        return None if modulus is None else self.sag.with_modulus(modulus)

    def moved(self, chain: Chain, q: Array, T_table_artefact: Array, feature: Labels) -> Array:
        """Displacements of features by weight, as of `Sag.moved`; zeros if unknown."""
        if self.usable_sag is None:
            return np.zeros((len(q), 3))
        return self.usable_sag.moved(chain, q, T_table_artefact, feature)

    def at(self, temperature: float) -> "Standard":
        """The standard at a temperature, degC; stems and holes are not scaled.

        Uniformly warm and fixed at its origin, so that all surfaces grow by
        ``1 + expansion (temperature - 20)`` and keep their normals.
        """
        return self.scaled(1.0 + self.material.expansion * (temperature - T_REF))

    def scaled(self, k: float) -> "Standard":
        """Larger by a factor about its origin, as of `at`."""
        return replace(
            self,
            base=replace(self.base, thickness=k * self.base.thickness),
            patches=tuple(patch.scaled(k) for patch in self.patches),
            spheres=tuple(
                replace(s, centre=k * s.centre, radius=k * s.radius) for s in self.spheres
            ),
        )

    @property
    def plane(self) -> DatumPlane:
        """The datum plane: the upper face of the base."""
        base = self.base
        return DatumPlane(DATUM_PLANE, base.thickness, base.half_size, base.corner_radius)

    @cached_property
    def proving(self) -> tuple[str, ...]:
        """Features whose touches prove the model instead of identifying it."""
        balls = tuple(ball.name for ball in self.spheres if ball.proves)
        return tuple(patch.name for patch in self.patches) + balls

    @cached_property
    def features(self) -> dict[str, Surface]:
        """Every touchable surface by name: patches, spheres, datum plane."""
        surfaces: tuple[Surface, ...] = (*self.patches, *self.spheres, self.plane)
        return {surface.name: surface for surface in surfaces}

    @cached_property
    def blended(self) -> frozenset[str]:
        """Patches and spheres whose pillar or post has a fillet at its foot.

        On an upright standard all that leave room for the radius; none where columns lean or
        meet in a core.
        """
        if self.core is not None or not all(patch.is_upright for patch in self.patches):
            return frozenset()
        names = [p.name for p in self.patches] + [s.name for s in self.spheres]
        middle = [p.T_artefact_patch[:2, 3] for p in self.patches]
        middle += [s.centre[:2] for s in self.spheres]
        half = [p.half_size for p in self.patches] + [(s.foot_radius,) * 2 for s in self.spheres]
        p, a = np.array(middle).reshape(-1, 2), np.array(half).reshape(-1, 2)
        apart = np.linalg.norm(np.maximum(np.abs(p[:, None] - p) - a[:, None] - a, 0.0), axis=-1)
        np.fill_diagonal(apart, np.inf)
        free = apart.min(axis=1, initial=np.inf) > 2.0 * BLEND
        corners = np.array([[x, y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
        square = (np.arange(len(p)) < len(self.patches))[:, None, None]
        ends = (p[:, None] + corners * a[:, None] * square).reshape(-1, 2)
        rim = outline_distance(ends, self.base.half_size, self.base.corner_radius)
        beyond = rim.reshape(-1, 4).max(axis=1) + np.where(square[:, 0, 0], 0.0, a[:, 0])
        free &= beyond < -BLEND - 0.5
        return frozenset(n for n, good in zip(names, free, strict=True) if good)

    @cached_property
    def columns(self) -> dict[str, Column]:
        """The column under each patch, by the patch's name."""
        foot = {name: self.base.thickness for name in self.blended}
        return {patch.name: column(patch, foot.get(patch.name)) for patch in self.patches}

    @cached_property
    def stems(self) -> dict[str, Cone]:
        """The stem under each sphere, by the sphere's name; it ends in the ball's centre."""
        return {
            s.name: Cone(
                x=s.centre[0],
                y=s.centre[1],
                low=s.foot,
                high=s.centre[2],
                low_radius=s.foot_radius,
                high_radius=s.stem_radius,
            )
            for s in self.spheres
        }

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """All solids by the name of their feature; stems are called `SPH1 stem`."""
        bodies: dict[str, Body] = {"BASE": self.base.body}
        if self.core is not None:
            core, low = self.core, 0.5 * self.base.thickness
            bodies["CORE"] = Cone(
                x=0.0,
                y=0.0,
                low=low,
                high=core.height,
                low_radius=core.low_radius,
                high_radius=core.high_radius,
            )
        bodies.update(self.columns)
        bodies.update({s.name: Ball(s.centre, s.radius) for s in self.spheres})
        for name, stem in self.stems.items():
            bodies[f"{name} stem"] = replace(stem, blend=name in self.blended)
        return bodies

    def distance(self, points: Array) -> Array:
        """Distance of points (N, 3), (N,), mm; never too large; holes count as filled."""
        return np.min([body.distance(points) for body in self.bodies.values()], axis=0)

    def holds(self, points: Array, depth: float, without: Collection[str] = ()) -> Mask:
        """Whether points (N, 3) lie at least `depth` mm inside, (N,); holes count as filled.

        Bodies named in `without` are left out, such as balls before they are glued in.
        """
        bodies = [body for name, body in self.bodies.items() if name not in without]
        middles, reaches = (np.array(one) for one in zip(*(b.hull for b in bodies), strict=True))
        square = (points**2).sum(axis=1)[:, None] - 2.0 * points @ middles.T
        square += (middles**2).sum(axis=1)
        held = np.zeros(len(points), dtype=bool)
        for body, is_near in zip(bodies, (square < (reaches + _HULL_MARGIN) ** 2).T, strict=True):
            near = np.flatnonzero(is_near & ~held)
            held[near] = body.distance(points[near]) <= -depth
        return held

    def volume(self, step: float = 4.0) -> float:
        """Volume estimated on a grid of cells, mm^3; to about 1 % at the default step."""
        low = [-self.base.half_size[0], -self.base.half_size[1], 0.0]
        high = [self.base.half_size[0], self.base.half_size[1], self.blank_height]
        axes = [np.arange(a + 0.5 * step, b + step, step) for a, b in zip(low, high, strict=True)]
        cells = grid_points(*axes)
        filled = np.clip(0.5 - self.distance(cells) / step, 0.0, 1.0).sum() * step**3
        bored = sum(
            np.pi * (h.radius**2 * (self.base.thickness - h.bore_depth))
            + np.pi * h.bore_radius**2 * h.bore_depth
            for h in self.holes
        )
        return float(filled - bored)

    def mass(self, step: float) -> float:
        """Estimate of the mass, kg."""
        return self.material.density * self.volume(step)
