"""Maps in three dimensions: values over three linear readings, drawn without a screen.

The values are rendered in a process of their own, as pictures of a standard are; ticks, names and
colour bars are put on them by matplotlib, where the view is one linear map.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from matstd.report.scenes.renderer import aim, picture_axes, rendered, surface
from matstd.report.style import INK, LINE, RED, WIDTH, Figure, figure, save
from matstd.twin.errors import DesignError, ShapeMismatch
from matstd.twin.frames import Array, apply
from matstd.twin.sampling import grid_points

PIXELS = 900  # height and width of one rendered scene
COLOURS = "viridis"  # even in lightness, and readable without red and green
_VIEW = (0.62, -0.74, 0.46)  # towards the eye: right of and in front of the machine, from above
_WIDEST = 5.0  # inch, of one scene
_FREE = 1.03  # of the half height: nothing touches the edge of the picture
_LEVELS = 5  # iso-surfaces between smallest and largest value


@dataclass(frozen=True, eq=False)
class Scene:
    """Values over a box of three readings."""

    title: str  # what is shown, and at which other readings
    unit: str  # label of the colour bar
    labels: tuple[str, str, str]  # of the three readings, with their unit
    readings: tuple[Array, ...]  # their values, three arrays, growing
    # in the unit of the label, one for every point, (n1, n2, n3); not a number where there is none
    values: Array
    # where the standard stands in the map, (4, 4); None to leave it out
    T_readings_artefact: Array | None = None
    # lines of rotary axes by name: a point and a unit direction each, (2, 3)
    lines: Mapping[str, Array] = field(default_factory=dict)
    # lowest and highest corner of the standard in its own frame, (2, 3), as `draw_volumes` finds it
    body: Array | None = None

    def __post_init__(self) -> None:
        shape = tuple(len(r) for r in self.readings)
        if self.values.shape != shape:
            raise ShapeMismatch(f"values of shape {self.values.shape}, expected {shape}")
        if not np.isfinite(self.values).any():
            raise DesignError(f"no picture: '{self.title}' has no value")

    @property
    def box(self) -> Array:
        """Lowest and highest corner, (2, 3)."""
        return np.array([[r[0] for r in self.readings], [r[-1] for r in self.readings]])


def eye() -> Array:
    """Unit vector from the middle of a picture towards who looks at it, (3,)."""
    view = np.array(_VIEW)
    return view / np.linalg.norm(view)


def draw_volumes(
    pictures: Mapping[Path, Sequence[Scene]], mesh: tuple[Array, np.ndarray] | None = None
) -> None:
    """PNGs of scenes side by side: sections on the far sides, iso-surfaces, standard, axes.

    Every scene has its own colour bar. All scenes are rendered together, because starting the
    renderer takes longer than rendering.

    Args:
        pictures: The scenes of every file to be written; each whole or not at all.
        mesh: Corners and triangles of the standard; None to draw none.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    scenes = [scene for each in pictures.values() for scene in each]
    if mesh is not None:
        extent = np.array([mesh[0].min(axis=0), mesh[0].max(axis=0)])
        scenes = [replace(scene, body=extent) for scene in scenes]
    image = rendered(_rendering, scenes, mesh, missing="map in three dimensions")
    images = np.split(image, len(scenes), axis=1)
    start = 0
    for path, own in pictures.items():
        end = start + len(own)
        save(composed(scenes[start:end], images[start:end]), path)
        start = end


def _rendering(scenes: Sequence[Scene], mesh: tuple[Array, np.ndarray] | None) -> Any:
    """Scenes side by side without any text, each of PIXELS by PIXELS."""
    import pyvista as pv

    if mesh is not None:
        body = surface(*mesh).compute_normals(split_vertices=True, feature_angle=25.0)
    size = (PIXELS * len(scenes), PIXELS)
    plotter = pv.Plotter(off_screen=True, shape=(1, len(scenes)), window_size=size, border=False)
    for k, scene in enumerate(scenes):
        plotter.subplot(0, k)
        _add_values(plotter, scene)
        if mesh is not None and scene.T_readings_artefact is not None:
            placed = body.transform(scene.T_readings_artefact, inplace=False)
            plotter.add_mesh(placed, color=LINE, smooth_shading=True, ambient=0.25)
        camera = _camera(scene)
        aim(plotter, eye(), camera[:3], float(camera[3]))
        plotter.reset_camera_clipping_range()
    return plotter


def _add_values(plotter: Any, scene: Scene) -> None:
    """Sections on the three far sides of the box, and iso-surfaces through it."""
    import pyvista as pv

    grid, values = pv.RectilinearGrid(*scene.readings), scene.values
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
    for i, ends in enumerate(scene.box.T):
        origin = np.array([r.mean() for r in scene.readings])
        # a hair inside, or the cut may miss the grid by rounding
        far, near = ends if eye()[i] > 0.0 else ends[::-1]
        origin[i] = far + 1e-6 * (near - far)
        plotter.add_mesh(grid.slice(normal=np.eye(3)[i], origin=origin), **shown)
    if high - low > 1e-9 * max(abs(high), 1e-300):
        levels = np.linspace(low, high, _LEVELS + 2)[1:-1]
        surfaces = grid.contour(levels, scalars="value")
        if surfaces.n_points:
            plotter.add_mesh(surfaces, opacity=0.3, **shown)
    plotter.add_mesh(grid.outline(), color=INK, line_width=2)


def _camera(scene: Scene) -> Array:
    """Middle of the picture and half its height, (4,)."""
    middle = scene.box.mean(axis=0)
    half = 0.5 * float(np.linalg.norm(np.ptp(scene.box, axis=0)))
    if scene.body is not None and scene.T_readings_artefact is not None:
        corners = grid_points(*scene.body.T)
        off = apply(scene.T_readings_artefact, corners) - middle
        half = max(half, float(np.abs(off @ picture_axes(eye()).T).max()))
    return np.append(middle, _FREE * half)


def composed(scenes: Sequence[Scene], images: Sequence[Array]) -> Figure:
    """Rendered scenes side by side with everything that is written on them."""
    n = len(scenes)
    width = min(WIDTH / n, _WIDEST)
    drawn = figure(1.2 * width, n * width, layout=None)
    for k, (scene, image) in enumerate(zip(scenes, images, strict=True)):
        axes = drawn.add_axes((k / n, 0.2 / 1.2, 1.0 / n, 1.0 / 1.2))
        axes.imshow(image, extent=(-1.0, 1.0, -1.0, 1.0), interpolation="antialiased")
        axes.set(xlim=(-1.2, 1.0), ylim=(-1.14, 1.06))  # room for ticks on the left, below
        axes.set_axis_off()
        axes.text(0.0, 0.96, scene.title, ha="center", va="top", fontsize=10.5, color=INK)
        _ticks(axes, scene)
        _axis_lines(axes, scene)
        _bar(drawn.add_axes(((k + 0.14) / n, 0.125, 0.72 / n, 0.022)), scene)
    return drawn


def _on_picture(scene: Scene, points: Array) -> Array:
    """Where points (N, 3) lie in a picture from -1 to 1 each way, (N, 2)."""
    camera = _camera(scene)
    return (points - camera[:3]) / camera[3] @ picture_axes(eye()).T


def _ticks(axes: Any, scene: Scene) -> None:
    """Readings along the outer edges of the box."""
    from matplotlib.ticker import MaxNLocator

    low, high = scene.box
    nice = MaxNLocator(4, steps=[1, 2, 2.5, 5, 10])
    # each edge starts where the box shows it free of the faces: below in front, right and left
    edges = ((0, (0, low[1], low[2])), (1, (high[0], 0, low[2])), (2, (low[0], low[1], 0)))
    centre = _on_picture(scene, scene.box.mean(axis=0)[None])[0]
    for i, start in edges:
        ticks = [t for t in nice.tick_values(low[i], high[i]) if low[i] <= t <= high[i]]
        points = np.tile(np.array(start, dtype=float), (len(ticks) + 1, 1))
        points[:, i] = [*ticks, 0.5 * (low[i] + high[i])]
        places = _on_picture(scene, points)
        along = np.diff(_on_picture(scene, np.stack([np.zeros(3), np.eye(3)[i]])), axis=0)[0]
        across = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        across *= np.sign(across @ (places[-1] - centre)) or 1.0
        for tick, place in zip(ticks, places[:-1], strict=True):
            axes.plot(*np.stack([place, place + 0.02 * across], axis=1), color=INK, lw=0.9)
            x, y = place + (0.09 if i == 2 else 0.065) * across
            axes.text(x, y, f"{tick:g}", ha="center", va="center", fontsize=8.5, color=INK)
        x, y = places[-1] + (0.26 if i == 2 else 0.16) * across
        turn = np.degrees(np.arctan2(along[1], along[0]))
        axes.text(
            x,
            y,
            scene.labels[i],
            ha="center",
            va="center",
            fontsize=9.5,
            color=INK,
            rotation=turn,
            rotation_mode="anchor",
        )


def _axis_lines(axes: Any, scene: Scene) -> None:
    """Rotary axes as dash-dotted lines through the box, as on a drawing."""
    from matplotlib.patheffects import withStroke

    size = 0.5 * np.linalg.norm(np.ptp(scene.box, axis=0))
    middle = scene.box.mean(axis=0)
    for name, (point, direction) in scene.lines.items():
        foot = point + ((middle - point) @ direction) * direction
        ends = _on_picture(scene, foot + np.outer([-0.75, 0.75], size * direction))
        if np.linalg.norm(ends[1] - ends[0]) < 0.05:
            continue  # seen along itself
        halo = [withStroke(linewidth=2.5, foreground="white")]
        axes.plot(ends[:, 0], ends[:, 1], color=RED, lw=1.3, ls=(0, (8, 2, 1.5, 2)))
        x, y = ends[1] + 0.05 * (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        look = {"color": RED, "fontsize": 10.5, "weight": "bold", "path_effects": halo}
        axes.text(x, y, name, ha="center", va="center", **look)


def _bar(axes: Any, scene: Scene) -> None:
    """Colour bar of one scene."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import MaxNLocator

    shown = Normalize(float(np.nanmin(scene.values)), float(np.nanmax(scene.values)))
    bar = axes.figure.colorbar(
        ScalarMappable(shown, COLOURS), cax=axes, orientation="horizontal", label=scene.unit
    )
    bar.ax.tick_params(labelsize=8.5)
    bar.ax.xaxis.label.set_size(9.5)
    bar.ax.xaxis.set_major_locator(MaxNLocator(5))
