"""Solid, STEP and triangles of a standard, built by the CAD kernel in a process of its own.

In: a folder with `standard.toml`. Out: STEP file, triangles and facts in the same folder. Nothing
here loads the kernel at import; `run_apart` serves any library that may crash.
"""

from matstd.cad_out.kernel.process import run_apart as run_apart
from matstd.cad_out.kernel.process import run_kernel as run_kernel
from matstd.cad_out.kernel.process import step_triangles as step_triangles
from matstd.cad_out.kernel.worker import FACES as FACES
from matstd.cad_out.kernel.worker import FACTS as FACTS
from matstd.cad_out.kernel.worker import MESH as MESH
from matstd.cad_out.kernel.worker import SCENES as SCENES
from matstd.cad_out.kernel.worker import SHOP_PARTS as SHOP_PARTS
from matstd.cad_out.kernel.worker import STANDARD as STANDARD
from matstd.cad_out.kernel.worker import STEP as STEP
