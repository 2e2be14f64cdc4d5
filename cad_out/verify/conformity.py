"""Conformity of the built files: they are re-read and compared with the design."""

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import BLEND, Standard
from matstd.cad_out.details import BALL, Details, Screw, details_of
from matstd.cad_out.kernel import FACES, STEP
from matstd.cad_out.meshes import (
    Mesh,
    aspects,
    chord_errors,
    face_areas,
    inner_folds,
    is_watertight,
    manifold_volume,
    mesh_volume,
    read_stl,
)
from matstd.cad_out.verify.face_figures import area_errors, face_deviations
from matstd.cad_out.verify.part21 import (
    Instance,
    file_unit_is_millimetre,
    read_entities,
    read_faces,
    read_instances,
)
from matstd.cad_out.verify.part21_tolerances import missing_annotations
from matstd.twin.errors import NotBuildable
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.units import NM, UM

FACE_LIMIT = 0.01 * UM  # largest distance of a face in the STEP file from its design, mm

VOLUME_LIMIT = 1e-7
"""Relative difference of the volumes before and after the STEP file; the kernel's own scatter."""

AREA_LIMIT = 1e-3
"""Relative: a face that a neighbour's column cuts into, or that is trimmed elsewhere, is found."""

LEAST_FACE, LEAST_EDGE = 1.0, 0.5
"""Smallest face, mm^2, and shortest edge, mm, of an upright standard: smaller ones are slivers,
which hinder tool-path programming and meshing."""

SHARP_LIMIT = 0.1  # length of sharp inner edges on an upright standard, mm

ASPECT_LIMIT = 20.0
"""Longest side of a triangle over the height on it: where programs for finite elements begin to
warn, and far from where 32-bit corners (15 nm at 400 mm) turn the normals of an STL."""

_SHARP_EDGE_ANGLE = 0.6  # rad between two triangles; those of a blend are half as far apart


@dataclass(frozen=True, slots=True)
class Conformity:
    """Measured figures of a built standard, lengths in mm."""

    solids: int
    expected: int  # solids that should be there: the body, balls and screws
    # parts that the text of the STEP file names, with the number of their instances
    products: dict[str, int]
    # instances of body or balls that do not stand where they were designed
    displaced: tuple[str, ...]
    is_valid: bool  # the kernel finds no fault in the solid it has read
    is_closed: bool  # all its shells are closed
    shells: int  # one a solid, or more where one has closed pockets inside
    is_millimetre: bool  # the file's length unit
    volume: float  # of body and balls as read, mm^3
    volume_built: float  # of them as built, mm^3
    mass: float  # of body and balls, kg; the screws stay with the table
    least_face: float  # area of the smallest face, mm^2
    least_edge: float  # length of the shortest edge, mm
    is_upright: bool  # all pillars and posts stand upright and are blended
    names: tuple[str, ...]  # faces that carry a name in the file
    # faces that should and do not, or are not parts in the file of single faces
    missing: tuple[str, ...]
    missing_details: tuple[str, ...]  # workshop details that found no room, in words
    # how often each part of `standard-parts.step` is there; none where a face leans
    parts: dict[str, int]
    # tolerances, notes and drawn signs that a reader does not find as designed
    misread: tuple[str, ...]
    # largest distance from the design by face, in both STEP files, without any CAD kernel
    face_deviation: dict[str, float]
    # of every patch's trimmed face in the mesh against the design, relative
    area_error: dict[str, float]
    is_watertight: bool  # of the STL file, by trimesh
    mesh_volume: float  # by the divergence theorem, mm^3
    manifold_volume: float  # by manifold3d, mm^3; nan where it refuses the mesh
    sharp: float  # length of inner edges that no ball-end cutter makes, bores left out, mm
    triangles: int
    chord: float  # asked for, mm
    chord_error: dict[str, float]  # largest distance of the mesh from the exact surface by feature
    body_chord_error: float  # the same of all faces of the body, by the kernel's projection
    aspect: float  # longest side of a triangle over the height on it, the largest
    step_bytes: int
    stl_bytes: int

    @property
    def worst_face(self) -> tuple[str, float]:
        """The face farthest from its design and its deviation, mm; none on balls alone."""
        return _largest(self.face_deviation)

    @property
    def worst_chord(self) -> tuple[str, float]:
        """The feature whose mesh is farthest from its surface and that distance, mm."""
        return _largest(self.chord_error)

    def faults(self) -> list[str]:
        """Every figure that misses its limit, in words; empty for a standard that conforms."""
        face, deviation = self.worst_face
        feature, chord = self.worst_chord
        patch, cut = _largest(self.area_error)
        drift = abs(self.volume / self.volume_built - 1.0)
        bulge = abs(self.mesh_volume / self.volume - 1.0)
        split = abs(self.manifold_volume / self.mesh_volume - 1.0)
        checks = (
            (
                self.solids == self.expected == sum(self.products.values()),
                f"{self.solids} solids in the STEP file, expected {self.expected}",
            ),
            (not self.displaced, f"not in its place: {', '.join(self.displaced)}"),
            (self.is_valid, "a solid in the STEP file is not valid"),
            (self.is_closed, "a shell in the STEP file is not closed"),
            (
                self.shells == self.solids,
                f"{self.shells} shells in {self.solids} solids: closed pockets inside",
            ),
            (self.is_millimetre, "the STEP file is not in millimetres"),
            (not self.missing, f"faces without their name: {', '.join(self.missing)}"),
            (not self.misread, f"not in the STEP file as meant: {', '.join(self.misread)}"),
            (drift <= VOLUME_LIMIT, f"the volume changes by {drift:.1e} on re-reading"),
            (
                deviation <= FACE_LIMIT,
                f"{face} is {deviation / UM:.4f} µm from its design, limit {FACE_LIMIT / UM:g} µm",
            ),
            (cut <= AREA_LIMIT, f"{patch} has {cut:.1e} more or less area than its design"),
            (self.is_watertight, "trimesh finds the STL file not watertight"),
            # Written so that nan, manifold3d's refusal, is a fault.
            (split <= 1e-5, "manifold3d does not agree with trimesh about the STL file"),
            (
                self.sharp <= SHARP_LIMIT,
                f"{self.sharp:.1f} mm of inner edges without a radius of {BLEND:g} mm",
            ),
            (
                self.least_face >= LEAST_FACE or not self.is_upright,
                f"a face of {self.least_face:.2g} mm^2, limit {LEAST_FACE:g} mm^2",
            ),
            (
                self.least_edge >= LEAST_EDGE or not self.is_upright,
                f"an edge of {self.least_edge:.2g} mm, limit {LEAST_EDGE:g} mm",
            ),
            (bulge <= 1e-3, f"the mesh has {bulge:.1e} less or more volume than the solid"),
            (
                chord <= self.chord + NM,
                f"{feature}: mesh {chord / UM:.1f} µm off, limit {self.chord / UM:g} µm",
            ),
            (
                self.body_chord_error <= self.chord + NM,
                f"body: mesh {self.body_chord_error / UM:.1f} µm off, limit {self.chord / UM:g} µm",
            ),
            (
                self.aspect <= ASPECT_LIMIT,
                f"a triangle of the mesh is {self.aspect:.0f} times as long as high, limit "
                f"{ASPECT_LIMIT:g}",
            ),
        )
        return [words for good, words in checks if not good]


def _largest(figures: dict[str, float]) -> tuple[str, float]:
    """Name and value of the largest figure; no name and 0 where there is none."""
    return max(figures.items(), key=lambda one: one[1], default=("", 0.0))


def measure(
    standard: Standard,
    folder: Path,
    stl: Path,
    owner: np.ndarray,
    built: dict[str, Any],
    chord: float,
) -> Conformity:
    """Re-read the STEP and STL files and compare them with the design.

    Args:
        folder: With the STEP files.
        owner: Feature of each of its triangles, (F,).
        built: Facts of the building process: volume of every product before it was written,
            mm^3, distance of the body's mesh from its faces, mm, and what a fresh reader of the
            kernel finds in the STEP file.
        chord: Asked for, mm.
    """
    found = built["reread"]
    entities, details = read_entities(folder / STEP), details_of(standard)
    faces, instances = read_faces(folder / STEP, entities), read_instances(entities)
    alone, wanted = read_faces(folder / FACES), face_names(standard, details)
    apart = [face_deviations(standard, every) for every in (faces, faces | alone)]
    corners, triangles = read_stl(stl)
    mesh = Mesh(corners, triangles, owner)
    named = set(faces) & set(found["names"])
    screws = {kind.name: kind for kind in details.screws}
    made = built["volumes"]
    # screws stay with the table and count neither in volume nor in mass
    bought = sum(len(kind.holes) * made[name] for name, kind in screws.items())
    volume = found["volume"] - bought
    balls = {sphere.name: made[sphere.name] for sphere in standard.spheres}
    steel = sum(balls.values())
    return Conformity(
        solids=found["solids"],
        expected=1 + len(standard.spheres) + sum(len(kind.holes) for kind in screws.values()),
        products=dict(Counter(instance.product for instance in instances.values())),
        displaced=_displaced(standard, instances, details.screws),
        is_valid=found["is_valid"],
        is_closed=found["is_closed"],
        shells=found["shells"],
        is_millimetre=file_unit_is_millimetre(folder / STEP),
        volume=volume,
        volume_built=sum(v for name, v in made.items() if name not in screws),
        mass=standard.material.density * (volume - steel) + BALL.density * steel,
        least_face=found["least_face"],
        least_edge=found["least_edge"],
        is_upright=_is_upright(standard),
        names=tuple(sorted(named)),
        missing=(
            *(name for name in wanted if name not in named),
            *(f"{name} by itself" for name in wanted if name not in {*alone, *balls}),
        ),
        missing_details=details.missing,
        parts=built["parts"],
        misread=missing_annotations(standard, details, entities, found),
        face_deviation={name: max(one[name] for one in apart) for name in apart[0]},
        area_error=area_errors(standard, face_areas(mesh)),
        is_watertight=is_watertight(corners, triangles),
        mesh_volume=mesh_volume(corners, triangles),
        manifold_volume=manifold_volume(corners, triangles),
        sharp=_sharp(standard, details, corners, triangles),
        triangles=len(triangles),
        chord=chord,
        chord_error=chord_errors(standard, mesh),
        body_chord_error=built["body_chord_error"],
        aspect=float(aspects(corners, triangles).max()),
        step_bytes=(folder / STEP).stat().st_size,
        stl_bytes=stl.stat().st_size,
    )


def _is_upright(standard: Standard) -> bool:
    """Whether all pillars and posts are blended, which leaning ones are not."""
    everything = {*(p.name for p in standard.patches), *(s.name for s in standard.spheres)}
    return bool(standard.blended) and standard.blended >= everything


def _sharp(standard: Standard, details: Details, corners: Array, triangles: np.ndarray) -> float:
    """Length of sharp inner edges outside bores, mm; 0 where columns lean and have no blends."""
    if not _is_upright(standard):
        return 0.0
    middle, length = inner_folds(corners, triangles, _SHARP_EDGE_ANGLE)
    inside = np.zeros(len(middle), dtype=bool)
    for hole in standard.holes:
        inside |= np.hypot(middle[:, 0] - hole.x, middle[:, 1] - hole.y) < hole.bore_radius + 0.1
    for bore in details.bores:
        off = np.linalg.norm(np.cross(middle - bore.mouth, bore.direction), axis=1)
        inside |= off < bore.radius + 0.1
    for sphere in standard.spheres:  # the tip of a countersink is a point, whatever its cutter
        seat = details.seats[sphere.name]
        tip = np.array([sphere.centre[0], sphere.centre[1], seat.bottom])
        inside |= np.linalg.norm(middle - tip, axis=1) < 0.5
    return float(length[~inside].sum())


def face_names(standard: Standard, details: Details) -> tuple[str, ...]:
    """Names that faces of body and balls carry."""
    holes = [name for hole in standard.holes for name in (hole.name, f"{hole.name}_BORE")]
    return (*standard.features, *details.face_names, *holes)


def _displaced(
    standard: Standard, instances: dict[str, Instance], screws: tuple[Screw, ...]
) -> tuple[str, ...]:
    """Instances that are missing or displaced from their designed place."""
    wanted = dict.fromkeys(("BODY", *(s.name for s in standard.spheres)), (0.0, 0.0, 0.0))
    for kind in screws:
        wanted |= {f"SCREW_{name}": (x, y, z) for name, x, y, z in kind.holes}
    return tuple(
        name
        for name, place in wanted.items()
        if name not in instances or np.abs(np.subtract(instances[name].moved, place)).max() > NM
    )


def write_conformity(path: Path, conformity: Conformity) -> None:
    """Every figure and every limit as JSON; what could not be measured is null."""
    limits = {
        "face_deviation_mm": FACE_LIMIT,
        "volume_change": VOLUME_LIMIT,
        "area_error": AREA_LIMIT,
        "chord_error_mm": conformity.chord,
        "sharp_mm": SHARP_LIMIT,
        "least_face_mm2": LEAST_FACE,
        "least_edge_mm": LEAST_EDGE,
        "aspect": ASPECT_LIMIT,
    }
    table = {
        "format": "conformity/2",
        "limits": limits,
        "faults": conformity.faults(),
        "measured": asdict(conformity),
    }
    write_json(path, table, sort_keys=True)


def refuse_faults(name: str, conformity: Conformity) -> None:
    """Raise NotBuildable, naming every figure that misses its limit, if there is one."""
    faults = conformity.faults()
    if faults:
        raise NotBuildable(
            f"standard '{name}' does not conform: {'; '.join(faults)}", conformity=conformity
        )
