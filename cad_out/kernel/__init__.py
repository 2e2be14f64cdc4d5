"""Solid, STEP and triangles of a standard, built by the CAD kernel in a process of its own.

In: a folder with `standard.toml`. Out: STEP file, triangles and facts in the same folder. Nothing
here loads the kernel at import; `run_apart` serves any library that may crash.
"""

from matstd.cad_out.kernel.process import run_apart, run_kernel
from matstd.cad_out.kernel.step_mesh import step_triangles
from matstd.cad_out.kernel.worker import FACES, FACTS, MESH, SCENES, SHOP_PARTS, STANDARD, STEP

__all__ = [
    "FACES",
    "FACTS",
    "MESH",
    "SCENES",
    "SHOP_PARTS",
    "STANDARD",
    "STEP",
    "run_apart",
    "run_kernel",
    "step_triangles",
]
