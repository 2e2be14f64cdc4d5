"""Triangles of a STEP file that a user drew, read in the kernel's own process."""

import shutil
import tempfile
from pathlib import Path

import numpy as np

from matstd.cad_out.kernel.process import run_kernel
from matstd.cad_out.kernel.worker import MESH, STEP
from matstd.twin.frames import Array

CHORD = 0.3
"""Distance between triangles and faces that is asked for, mm: less than a pixel of a page."""


def step_triangles(path: Path, chord: float = CHORD) -> Array:
    """Corners of the triangles of all bodies of a STEP file, (T, 3, 3), mm.

    Raises:
        NotBuildable: A file that the kernel cannot read.
    """
    with tempfile.TemporaryDirectory(prefix="step-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        shutil.copyfile(path, folder / STEP)
        run_kernel("mesh_step", folder, chord)
        with np.load(folder / MESH) as mesh:
            return np.asarray(mesh["corners"][mesh["triangles"]], dtype=np.float64)
