"""What was built, measured: the files are read anew and compared with the design."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artefact.body import Standard
from cad_out.build import (
    FACTS,
    STEP,
    chord_errors,
    face_areas,
    is_watertight,
    manifold_volume,
    mesh_volume,
    read_stl,
    run_kernel,
)
from cad_out.verify.part21 import SphereFace, SplineFace, file_unit_is_millimetre, read_faces
from twin.errors import NotBuildable
from twin.units import NM, UM

FACE_LIMIT = 0.01 * UM
"""Largest distance of a face in the STEP file from its design, mm."""

VOLUME_LIMIT = 1e-7
"""Relative difference of the volumes before and after the STEP file; the kernel's own scatter."""

AREA_LIMIT = 1e-3
"""Relative: a face that a neighbour's column cuts into, or that is trimmed elsewhere, is found."""

_SAMPLES = 61  # points along each side of a face that is compared


@dataclass(frozen=True, slots=True)
class Conformity:
    """Measured figures of a built standard, lengths in mm.

    Attributes:
        solids: In the STEP file.
        is_valid: The kernel finds no fault in the solid it has read.
        is_closed: All its shells are closed.
        shells: One, or more where the solid has closed pockets inside.
        is_millimetre: The file's length unit.
        volume: Of the solid that was read, mm^3.
        volume_built: Of the solid that was built, mm^3.
        mass: From volume and density, kg.
        names: Faces that carry a name in the file.
        missing: Faces that should and do not.
        face_deviation: Largest distance from the design by face, without any CAD kernel.
        area_error: Of every patch's trimmed face in the mesh against the design, relative.
        is_watertight: Of the STL file, by trimesh.
        mesh_volume: By the divergence theorem, mm^3.
        manifold_volume: By manifold3d, mm^3; nan where it refuses the mesh.
        triangles: In the STL file.
        chord: Asked for, mm.
        chord_error: Largest distance of the mesh from the exact surface by feature.
        step_bytes: Size of the STEP file.
        stl_bytes: Size of the STL file.
    """

    solids: int
    is_valid: bool
    is_closed: bool
    shells: int
    is_millimetre: bool
    volume: float
    volume_built: float
    mass: float
    names: tuple[str, ...]
    missing: tuple[str, ...]
    face_deviation: dict[str, float]
    area_error: dict[str, float]
    is_watertight: bool
    mesh_volume: float
    manifold_volume: float
    triangles: int
    chord: float
    chord_error: dict[str, float]
    step_bytes: int
    stl_bytes: int

    @property
    def worst_face(self) -> tuple[str, float]:
        """The face farthest from its design and its deviation, mm."""
        name = max(self.face_deviation, key=self.face_deviation.__getitem__)
        return name, self.face_deviation[name]

    @property
    def worst_chord(self) -> tuple[str, float]:
        """The feature whose mesh is farthest from its surface and that distance, mm."""
        name = max(self.chord_error, key=self.chord_error.__getitem__)
        return name, self.chord_error[name]

    def faults(self) -> list[str]:
        """Every figure that misses its limit, in words; empty for a standard that conforms."""
        face, deviation = self.worst_face
        feature, chord = self.worst_chord
        patch = max(self.area_error, key=self.area_error.__getitem__)
        cut = self.area_error[patch]
        drift = abs(self.volume / self.volume_built - 1.0)
        bulge = abs(self.mesh_volume / self.volume - 1.0)
        split = abs(self.manifold_volume / self.mesh_volume - 1.0)
        checks = (
            (self.solids == 1, f"{self.solids} solids in the STEP file, expected 1"),
            (self.is_valid, "the solid in the STEP file is not valid"),
            (self.is_closed, "the shell in the STEP file is not closed"),
            (
                self.shells == self.solids,
                f"{self.shells} shells in {self.solids} solid: closed pockets inside",
            ),
            (self.is_millimetre, "the STEP file is not in millimetres"),
            (not self.missing, f"faces without their name: {', '.join(self.missing)}"),
            (drift <= VOLUME_LIMIT, f"the volume changes by {drift:.1e} on re-reading"),
            (
                deviation <= FACE_LIMIT,
                f"{face} is {deviation / UM:.4f} µm from its design, limit {FACE_LIMIT / UM:g} µm",
            ),
            (cut <= AREA_LIMIT, f"{patch} has {cut:.1e} more or less area than its design"),
            (self.is_watertight, "trimesh finds the STL file not watertight"),
            # Written so that nan, manifold3d's refusal, is a fault.
            (split <= 1e-5, "manifold3d does not agree with trimesh about the STL file"),
            (bulge <= 1e-3, f"the mesh has {bulge:.1e} less or more volume than the solid"),
            (
                chord <= self.chord + NM,
                f"{feature}: mesh {chord / UM:.1f} µm off, limit {self.chord / UM:g} µm",
            ),
        )
        return [words for good, words in checks if not good]


def measure(
    standard: Standard, folder: Path, stl: Path, owner: np.ndarray, built: float, chord: float
) -> Conformity:
    """Read the STEP and STL files anew and compare them with the design.

    Args:
        standard: The design.
        folder: With the STEP file; the kernel's second process answers through it.
        stl: The STL file.
        owner: Feature of each of its triangles, (F,).
        built: Volume of the solid before it was written, mm^3.
        chord: Asked for, mm.

    Returns:
        All figures, good or bad.
    """
    run_kernel("reread", folder)
    found = json.loads((folder / FACTS).read_text(encoding="utf-8"))
    faces = read_faces(folder / STEP)
    corners, triangles = read_stl(stl)
    named = set(faces) & set(found["names"])
    return Conformity(
        solids=found["solids"],
        is_valid=found["is_valid"],
        is_closed=found["is_closed"],
        shells=found["shells"],
        is_millimetre=file_unit_is_millimetre(folder / STEP),
        volume=found["volume"],
        volume_built=built,
        mass=standard.material.density * found["volume"],
        names=tuple(sorted(named)),
        missing=tuple(name for name in standard.face_names if name not in named),
        face_deviation=face_deviations(standard, faces),
        area_error=_area_errors(standard, face_areas(corners, triangles, owner)),
        is_watertight=is_watertight(corners, triangles),
        mesh_volume=mesh_volume(corners, triangles),
        manifold_volume=manifold_volume(corners, triangles),
        triangles=len(triangles),
        chord=chord,
        chord_error=chord_errors(standard, corners, triangles, owner),
        step_bytes=(folder / STEP).stat().st_size,
        stl_bytes=stl.stat().st_size,
    )


def face_deviations(
    standard: Standard, faces: dict[str, SplineFace | SphereFace | None]
) -> dict[str, float]:
    """Largest distance of every patch and sphere in the file from its design, mm.

    Patches are compared point by point at equal parameters: the file's spline by scipy, the
    design by its own formula. A face that is missing or of another kind counts as infinitely far.
    """
    deviations = {}
    for patch in standard.patches:
        face, (a, b) = faces.get(patch.name), patch.half_size
        if not isinstance(face, SplineFace):
            deviations[patch.name] = np.inf
            continue
        axes = np.linspace(-a, a, _SAMPLES), np.linspace(-b, b, _SAMPLES)
        uv = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        apart = np.linalg.norm(face.points(uv) - patch.point(uv), axis=1)
        deviations[patch.name] = float(apart.max())
    for sphere in standard.spheres:
        face = faces.get(sphere.name)
        if not isinstance(face, SphereFace):
            deviations[sphere.name] = np.inf
            continue
        apart = np.linalg.norm(face.centre - sphere.centre) + abs(face.radius - sphere.radius)
        deviations[sphere.name] = float(apart)
    return deviations


def _area_errors(standard: Standard, areas: dict[str, float]) -> dict[str, float]:
    """Relative difference between the area of a face's triangles and that of its design."""
    errors = {}
    for patch in standard.patches:
        nodes, weights = np.polynomial.legendre.leggauss(40)
        a, b = patch.half_size
        u, v = np.meshgrid(a * nodes, b * nodes, indexing="ij")
        j = patch.jet(np.column_stack([u.ravel(), v.ravel()]))
        weight = a * b * np.outer(weights, weights).ravel()
        area = float(weight @ np.sqrt(1.0 + j.hu**2 + j.hv**2))
        errors[patch.name] = abs(areas.get(patch.name, 0.0) / area - 1.0)
    return errors


def refuse_faults(name: str, conformity: Conformity) -> None:
    """Raise NotBuildable, naming every figure that misses its limit, if there is one."""
    faults = conformity.faults()
    if faults:
        raise NotBuildable(
            f"standard '{name}' does not conform: {'; '.join(faults)}", conformity=conformity
        )
