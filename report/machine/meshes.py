"""The user's drawings of machine bodies: STL and STEP files as triangles, thinned where many."""

from pathlib import Path

import numpy as np

from matstd.artefact.reach import mesh_triangles
from matstd.cad_out.kernel import step_triangles
from matstd.report.machine.solids import FOUNDATION, Drawn
from matstd.report.style import series
from matstd.twin.errors import BadFile, NotBuildable
from matstd.twin.frames import Array
from matstd.twin.machine import Chain

MAX_TRIANGLES = 20_000  # triangles of one body on a page: half a megabyte
FARTHEST = 1e5  # a corner that lies farther from the machine's origin is a slip of units, mm

_MESHES, _STEPS = (".stl", ".obj", ".ply"), (".step", ".stp")
_DIVISIONS = (160, 112, 80, 56, 40, 28, 20, 12, 6)  # cells a side, from fine to coarse
_BED = "#c3cad3"


def body_meshes(chain: Chain) -> list[Drawn]:
    """Bodies of a machine from its drawings, machine frame with every axis at zero.

    Raises:
        BadFile: A file that is no mesh and no STEP file, or has nothing in it.
    """
    colours = {name: series(k) for k, name in enumerate(chain.axes)} | {FOUNDATION: _BED}
    return [
        Drawn(on, colours.get(on, "#aeb6c0"), thinned(drawing_triangles(path)))
        for on, path in chain.drawings.items()
    ]


def drawing_triangles(path: Path) -> Array:
    """Triangles (T, 3, 3), mm, of an STL, OBJ, PLY or STEP file; raises BadFile for no mesh."""
    expected = f"one of {', '.join((*_MESHES, *_STEPS))}"
    kind = path.suffix.lower()
    if kind not in (*_MESHES, *_STEPS):
        raise BadFile(path, "name", path.suffix or "no ending", expected)
    if not path.is_file():
        raise BadFile(path, "file", "nothing", "a drawing of the body")
    if kind in _MESHES:
        corners = mesh_triangles(path, "a mesh")
    else:
        try:
            corners = step_triangles(path)
        except NotBuildable as error:
            raise BadFile(path, "file", f"no body ({error})", "a STEP file with a body") from None
        if not len(corners):
            raise BadFile(path, "file", "no body", "a STEP file with a body")
    far = float(np.abs(corners).max())
    if far > FARTHEST:
        found = f"a corner {far:.6g} mm from the origin"
        raise BadFile(path, "file", found, f"at most {FARTHEST:g} mm; is the file in mm?")
    return corners


def thinned(triangles: Array, most: int = MAX_TRIANGLES) -> Array:
    """Triangles of a body, corners gathered in cells until there are few enough.

    Clustering by quadrics keeps edges and works on meshes with holes; 400 000 triangles take 0.1 s,
    where removing edge by edge takes 3 s.

    Args:
        triangles: Corners, (T, 3, 3), mm.
    """
    if len(triangles) <= most:
        return triangles
    import pyvista
    from vtkmodules.vtkFiltersCore import vtkQuadricClustering

    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    whole = pyvista.PolyData.from_regular_faces(triangles.reshape(-1, 3), faces)
    for divisions in _DIVISIONS:
        cluster = vtkQuadricClustering()
        cluster.SetInputData(whole)
        cluster.SetNumberOfDivisions(divisions, divisions, divisions)
        cluster.Update()
        found = pyvista.wrap(cluster.GetOutput())
        if found.n_cells <= most:
            break
    return np.asarray(found.points, dtype=np.float64)[found.regular_faces]
