"""What runs in the kernel's own process: a crash there ends this process and nothing else."""

import json
from pathlib import Path

import numpy as np

from artefact.standard_file import read_standard
from cad_out.mesh import Mesh, chord_errors, welded
from twin.errors import DesignError, NotBuildable

STANDARD, STEP, MESH, FACTS, REFUSAL = (
    "standard.toml",
    "standard.step",
    "mesh.npz",
    "facts.json",
    "refusal.txt",
)
"""Names of the files through which the two processes speak."""

_ROUNDS = 5  # of refinement before the mesh is refused
_FINER = 0.6


def build(folder: str, chord: float) -> None:
    """Build the standard of a folder: STEP file, triangles, facts about the solid.

    Args:
        folder: Holds standard.toml; takes the results, or the reason of a refusal.
        chord: Largest distance of the mesh from the exact faces, mm.
    """
    _answered(Path(folder), lambda place: _build(place, chord))


def reread(folder: str) -> None:
    """Read the STEP file of a folder anew and write down what the kernel finds in it."""
    _answered(Path(folder), _reread)


def _answered(place: Path, task) -> None:  # type: ignore[no-untyped-def]
    try:
        task(place)
    except DesignError as refusal:
        (place / REFUSAL).write_text(str(refusal), encoding="utf-8")


def _build(place: Path, chord: float) -> None:
    from cad_out.exchange import write_step
    from cad_out.solid import build_solid

    standard = read_standard(place / STANDARD)
    solid = build_solid(standard)
    write_step(place / STEP, solid, standard)
    mesh = _mesh(standard, solid, chord)
    np.savez(place / MESH, corners=mesh.corners, triangles=mesh.triangles, owner=mesh.owner)
    (place / FACTS).write_text(json.dumps({"volume": solid.volume}), encoding="utf-8")


def _mesh(standard, solid, chord: float) -> Mesh:  # type: ignore[no-untyped-def]
    """Mesh with the chord error kept, which the kernel takes for a wish: measured and refined."""
    from cad_out.exchange import face_numbers, tessellate

    names = {number: name for name, number in face_numbers(solid).items()}
    asked = chord
    for _ in range(_ROUNDS):
        corners, triangles, numbers = tessellate(solid, asked)
        owner = np.array([names.get(number, "") for number in range(numbers.max() + 1)])[numbers]
        mesh = welded(corners, triangles, owner)
        errors = chord_errors(standard, mesh.corners, mesh.triangles, mesh.owner)
        worst = max(error.largest for error in errors.values())
        if worst <= chord:
            return mesh
        asked *= _FINER
    raise NotBuildable(
        f"the mesh stays {worst * 1e3:.1f} µm from the surface, asked were {chord * 1e3:.1f} µm"
    )


def _reread(place: Path) -> None:
    from dataclasses import asdict

    from cad_out.exchange import read_step

    facts = asdict(read_step(place / STEP))
    (place / FACTS).write_text(json.dumps(facts), encoding="utf-8")
