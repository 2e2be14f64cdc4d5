"""What runs in the kernel's own process: a crash there ends this process and nothing else."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from artefact.body import Standard, read_standard
from cad_out.build.mesh import Mesh, chord_errors, welded
from twin.errors import NotBuildable

if TYPE_CHECKING:
    from cad_out.build.solid import Solid

STANDARD, STEP, MESH, FACTS = "standard.toml", "standard.step", "mesh.npz", "facts.json"
"""Names of the files through which the two processes speak."""

_ROUNDS = 5  # of refinement before the mesh is refused
_FIRST = 0.75  # of the chord asked for at once: on spheres the kernel overshoots by a quarter
_FINER = 0.7  # of the last: five rounds end at a sixth of the first


def build(folder: str, chord: float, author: str, organisation: str) -> None:
    """Build the standard of a folder: STEP file, triangles, facts about the solid.

    Args:
        folder: Holds standard.toml; takes the results.
        chord: Largest distance of the mesh from the exact faces, mm.
        author: For the header of the STEP file.
        organisation: The same.
    """
    from cad_out.build.exchange import Origin, write_step
    from cad_out.build.solid import build_solid

    place = Path(folder)
    standard = read_standard(place / STANDARD)
    solid = build_solid(standard)
    design = hashlib.sha256((place / STANDARD).read_bytes()).hexdigest()
    write_step(place / STEP, solid, standard, Origin(design, author, organisation))
    mesh = _mesh(standard, solid, chord)
    np.savez(place / MESH, corners=mesh.corners, triangles=mesh.triangles, owner=mesh.owner)
    (place / FACTS).write_text(json.dumps({"volume": solid.volume}), encoding="utf-8")


def reread(folder: str) -> None:
    """Read the STEP file of a folder anew and write down what the kernel finds in it."""
    from cad_out.build.exchange import read_step

    facts = asdict(read_step(Path(folder) / STEP))
    (Path(folder) / FACTS).write_text(json.dumps(facts), encoding="utf-8")


def _mesh(standard: Standard, solid: Solid, chord: float) -> Mesh:
    """Mesh with the chord error kept, which the kernel takes for a wish: measured and refined."""
    from cad_out.build.exchange import face_numbers, tessellate

    names = {number: name for name, number in face_numbers(solid).items()}
    asked = _FIRST * chord
    for _ in range(_ROUNDS):
        corners, triangles, numbers = tessellate(solid, asked)
        owner = np.array([names.get(number, "") for number in range(numbers.max() + 1)])[numbers]
        mesh = welded(corners, triangles, owner)
        errors = chord_errors(standard, mesh.corners, mesh.triangles, mesh.owner)
        worst = max(errors.values())
        if worst <= chord:
            return mesh
        asked *= _FINER
    raise NotBuildable(
        f"the mesh stays {worst * 1e3:.1f} µm from the surface, asked were {chord * 1e3:.1f} µm"
    )
