"""Rendering of volumes, in the renderer's own process; reached through `volume_scene`."""

from pathlib import Path
from typing import Any

import numpy as np

from matstd.cad_out.meshes import read_stl
from matstd.report.scenes.renderer import FACTS, STL, screenshot
from matstd.report.scenes.volume_scene import COLOURS, IMAGE, PIXELS, eye
from matstd.report.style import INK, LINE
from matstd.twin.frames import Array

_LEVELS = 5  # iso-surfaces between smallest and largest value


def render(folder: str) -> None:
    """Render every scene of a folder, side by side in one image without any text."""
    import pyvista as pv

    place = Path(folder)
    with np.load(place / FACTS) as stored:
        facts = dict(stored)
    count = int(facts["count"])
    body = _body(place / STL) if (place / STL).exists() else None
    plotter = pv.Plotter(
        off_screen=True, shape=(1, count), window_size=(PIXELS * count, PIXELS), border=False
    )
    for k in range(count):
        plotter.subplot(0, k)
        scene = {name: facts[f"{name}_{k}"] for name in ("x", "y", "z", "values", "T", "camera")}
        _add_values(plotter, scene)
        if body is not None and np.isfinite(scene["T"]).all():
            placed = body.transform(scene["T"], inplace=False)
            plotter.add_mesh(placed, color=LINE, smooth_shading=True, ambient=0.25)
        _aim(plotter, scene["camera"])
    np.save(place / IMAGE, screenshot(plotter))


def _body(stl: Path) -> Any:
    """The standard with sharp edges, ready to be put anywhere."""
    import pyvista as pv

    corners, triangles = read_stl(stl)
    cells = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    return pv.PolyData(corners, cells).compute_normals(split_vertices=True, feature_angle=25.0)


def _add_values(plotter: Any, scene: dict[str, Array]) -> None:
    """Sections on the three far sides of the box, and iso-surfaces through it."""
    import pyvista as pv

    readings = [scene[name] for name in "xyz"]
    grid = pv.RectilinearGrid(*readings)
    values = scene["values"]
    grid["value"] = values.ravel(order="F")
    low, high = np.nanmin(values), np.nanmax(values)
    shown = {
        "scalars": "value",
        "cmap": COLOURS,
        "clim": (low, high),
        "show_scalar_bar": False,
        "lighting": False,
        "nan_opacity": 0.0,
    }
    for i, name in enumerate("xyz"):
        ends = scene[name][[0, -1]]
        origin = np.array([r.mean() for r in readings])
        # a hair inside, or the cut may miss the grid by rounding
        far, near = (ends[0], ends[1]) if eye()[i] > 0.0 else (ends[1], ends[0])
        origin[i] = far + 1e-6 * (near - far)
        plotter.add_mesh(grid.slice(normal=np.eye(3)[i], origin=origin), **shown)
    if high - low > 1e-9 * max(abs(high), 1e-300):
        levels = np.linspace(low, high, _LEVELS + 2)[1:-1]
        surfaces = grid.contour(levels, scalars="value")
        if surfaces.n_points:
            plotter.add_mesh(surfaces, opacity=0.3, **shown)
    plotter.add_mesh(grid.outline(), color=INK, line_width=2)


def _aim(plotter: Any, camera: Array) -> None:
    """Parallel view: middle of the picture (3,) and half its height."""
    middle = camera[:3]
    plotter.camera.position = tuple(middle + 10.0 * camera[3] * eye())
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.up = (0.0, 0.0, 1.0)
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = float(camera[3])
    plotter.reset_camera_clipping_range()
