"""Export of a standard to STEP and STL files, which are measured before they get their names."""

import json
import shutil
import tempfile
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard, write_standard
from matstd.cad_out.kernel import FACES, FACTS, MESH, SCENES, SHOP_PARTS, STANDARD, STEP, run_kernel
from matstd.cad_out.meshes import Mesh, write_stl
from matstd.cad_out.verify.conformity import Conformity, measure, refuse_faults, write_conformity
from matstd.twin.errors import DesignError

STL, CONFORMITY = "standard.stl", "conformity.json"
NOT_STATED = "not stated"

_CHORD, _RELATIVE_CHORD = 0.01, 1e-4
"""Distance of the mesh from the faces, mm; and relative to the largest side of a face: a wavy face
of 200 mm has 80 000 triangles at 0.02 mm and twice as many at 0.01 mm, in a file that shows a
shape. Tool paths come from the STEP file."""


def mesh_chord(standard: Standard) -> float:
    """Distance of the mesh from the faces that suits a standard, mm."""
    sides = (2.0 * half for patch in standard.patches for half in patch.half_size)
    return max(_CHORD, round(_RELATIVE_CHORD * max(sides, default=0.0), 3))


def export_standard(
    standard: Standard,
    out_dir: str | Path,
    chord: float | None = None,
    author: str = NOT_STATED,
    organisation: str = NOT_STATED,
) -> Conformity:
    """Build the standard, write STEP, STL, 3MF and glTF, and prove them against the design.

    All files are built and measured in a temporary folder and moved together to their place, so
    that a refusal or a crash leaves the former files.

    Args:
        chord: Largest distance of the mesh from the exact faces, mm; None for that of `mesh_chord`.
        author: Who is responsible for the design, for the header of the STEP file.
        organisation: The author's employer.

    Raises:
        NotBuildable: The kernel refuses or crashes, or a figure misses its limit.
        DesignError: The folder cannot be written to.
    """
    out_dir = Path(out_dir)
    try:
        out_dir.mkdir(parents=True, exist_ok=True)
        place = Path(tempfile.mkdtemp(prefix=".cad-", dir=out_dir))
    except OSError as error:
        raise DesignError(f"{out_dir}: cannot be written ({error.strerror})") from error
    try:
        kept = mesh_chord(standard) if chord is None else chord
        conformity, _ = build_and_measure(standard, place, kept, author, organisation)
        refuse_faults(standard.name, conformity)
        write_conformity(place / CONFORMITY, conformity)
        for name in (STEP, FACES, STL, *SCENES, CONFORMITY):
            (place / name).replace(out_dir / name)
        if conformity.parts:
            (place / SHOP_PARTS).replace(out_dir / SHOP_PARTS)
        else:  # a former design may have been of parts
            (out_dir / SHOP_PARTS).unlink(missing_ok=True)
    finally:
        shutil.rmtree(place, ignore_errors=True)
    return conformity


def build_and_measure(
    standard: Standard,
    place: Path,
    chord: float,
    author: str = NOT_STATED,
    organisation: str = NOT_STATED,
) -> tuple[Conformity, Mesh]:
    """Figures of a standard built into an empty folder, not yet refused, and its float64 mesh.

    Args:
        chord: Largest distance of the mesh from the exact faces, mm.
    """
    write_standard(place / STANDARD, standard)
    run_kernel("build", place, chord, author, organisation)
    built = json.loads((place / FACTS).read_text(encoding="utf-8"))
    with np.load(place / MESH) as arrays:
        mesh = Mesh(arrays["corners"], arrays["triangles"], arrays["owner"])
    write_stl(place / STL, mesh)
    return measure(standard, place, place / STL, mesh.owner, built, chord), mesh
