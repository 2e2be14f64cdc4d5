"""What runs in the kernel's own process: a crash there ends this process and nothing else."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from matstd.artefact.body import Standard, read_standard
from matstd.cad_out.details import Details, details_of
from matstd.cad_out.making import joints_if_any
from matstd.cad_out.meshes import (
    Mesh,
    Piece,
    ball_mesh,
    chord_errors,
    joined,
    welded,
    write_3mf,
    write_glb,
)
from matstd.twin.errors import NotBuildable

if TYPE_CHECKING:
    from matstd.cad_out.kernel.assembly import Product
    from matstd.cad_out.kernel.exchange import Origin
    from matstd.cad_out.kernel.solid import Solid

STANDARD, STEP, MESH, FACTS = "standard.toml", "standard.step", "mesh.npz", "facts.json"
FACES, SHOP_PARTS = "standard-faces.step", "standard-parts.step"
SCENES = ("standard.3mf", "standard.glb")
"""Names of the files through which the two processes speak."""

_SCREW_CHORD = 0.05  # mm
_ROUNDS = 3  # of meshes before the last is refused; the first one keeps the chord as a rule
_REFINEMENT_FACTOR = 0.7  # of the last


def build(folder: str, chord: float, author: str, organisation: str) -> None:
    """Build the standard of a folder: STEP file, triangles, facts about the solid and the file.

    Args:
        folder: Holds standard.toml; takes the results.
        chord: Largest distance of the mesh from the exact faces, mm.
    """
    from matstd.cad_out.kernel.assembly import face_products, products_of, whole_name
    from matstd.cad_out.kernel.exchange import Origin, write_step
    from matstd.cad_out.kernel.reader import read_step

    place = Path(folder)
    standard = read_standard(place / STANDARD)
    details = details_of(standard)
    solid, products = products_of(standard, details)
    design = hashlib.sha256((place / STANDARD).read_bytes()).hexdigest()
    origin, name = Origin(design, author, organisation), whole_name(standard)
    write_step(place / STEP, products, name, origin)
    write_step(place / FACES, face_products(solid), f"{name} FACES", origin)
    parts = _write_parts(standard, details, products, place / SHOP_PARTS, origin)
    mesh, farthest = _mesh(standard, solid, chord)
    np.savez(place / MESH, corners=mesh.corners, triangles=mesh.triangles, owner=mesh.owner)
    pieces = _pieces(standard, products, mesh)
    write_3mf(place / SCENES[0], standard.name, pieces)
    write_glb(place / SCENES[1], pieces)
    volumes = {product.name: product.volume for product in products}
    found = asdict(read_step(place / STEP))
    facts = {"volumes": volumes, "body_chord_error": farthest, "parts": parts, "reread": found}
    (place / FACTS).write_text(json.dumps(facts), encoding="utf-8")


def _write_parts(
    standard: Standard, details: Details, products: Sequence[Product], path: Path, origin: Origin
) -> dict[str, int]:
    """The standard as plate, studs and blocks, re-read; none where it cannot be made of parts.

    Returns:
        How often each part is there, by name.
    """
    from matstd.cad_out.kernel.assembly import whole_name
    from matstd.cad_out.kernel.exchange import write_step
    from matstd.cad_out.kernel.parts import parts_of
    from matstd.cad_out.kernel.reader import read_step

    joints = joints_if_any(standard, details)
    if joints is None:
        return {}
    bought = [replace(one, tolerances=(), notes=(), drawn={}) for one in products[1:]]
    parts = parts_of(standard, details, joints, [replace(b, diameter=None) for b in bought])
    write_step(path, parts, f"{whole_name(standard)} SHOP_PARTS", origin)
    found, wanted = read_step(path), sum(len(part.places) for part in parts)
    if found.solids != wanted or not found.is_valid or not found.is_closed:
        raise NotBuildable(f"{path.name}: {found.solids} solids of {wanted}, or one not closed")
    return dict(found.products)


def _pieces(standard: Standard, products: Sequence[Product], mesh: Mesh) -> list[Piece]:
    """Triangles of every product; a coarse chord suffices for the screws."""
    from matstd.cad_out.kernel.assembly import colour_of
    from matstd.cad_out.kernel.reader import tessellate

    balls, out = {sphere.name for sphere in standard.spheres}, []
    for product in products:
        if product.name in balls:
            mine = mesh.of(mesh.owner == product.name)
        elif product.faces:
            mine = mesh.of(~np.isin(mesh.owner, list(balls)))
        else:
            corners, triangles, numbers = tessellate(product.shape, _SCREW_CHORD)
            mine = welded(corners, triangles, np.full(len(numbers), ""))
        role = {name: colour_of(name) or product.colour for name in np.unique(mine.owner)}
        colours = [role[name] for name in mine.owner]
        out.append(Piece(product.name, mine, np.array(colours), product.places))
    return out


def mesh_step(folder: str, chord: float) -> None:
    """Triangles of all bodies of a STEP file in a folder, `chord` (mm) from its faces at most."""
    from matstd.cad_out.kernel.reader import read_shape, tessellate

    corners, triangles, _ = tessellate(read_shape(Path(folder) / STEP), chord)
    np.savez(Path(folder) / MESH, corners=corners, triangles=triangles)


def _mesh(standard: Standard, solid: Solid, chord: float) -> tuple[Mesh, float]:
    """Mesh of body and balls with the chord error kept, and the body's distance from it, mm.

    Both are measured at other places than those that the triangulation checks.
    """
    from matstd.cad_out.kernel.reader import face_numbers, farthest_from_faces, triangulate

    names = {number: name for name, number in face_numbers(solid.plain, solid.plain_faces).items()}
    balls = [ball_mesh(sphere, chord) for sphere in standard.spheres]
    asked = chord
    for _ in range(_ROUNDS):
        corners, triangles, numbers = triangulate(solid.plain, asked)
        owner = np.array([names.get(number, "") for number in range(numbers.max() + 1)])[numbers]
        mesh = joined([Mesh(corners, triangles, owner), *balls])
        errors = chord_errors(standard, mesh)
        farthest = farthest_from_faces(solid.plain, corners, triangles, numbers)
        worst = max(farthest, *errors.values())
        if worst <= chord:
            return mesh, farthest
        asked *= _REFINEMENT_FACTOR
    raise NotBuildable(
        f"the mesh stays {worst * 1e3:.1f} µm from the surface, asked were {chord * 1e3:.1f} µm"
    )
