"""Picture of a standard from two sides, drawn without a screen."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.cad_out.meshes import owners
from matstd.report.scenes.renderer import aim, picture_axes, rendered, surface
from matstd.report.style import series
from matstd.twin.files import written_whole
from matstd.twin.frames import Array, outward
from matstd.twin.sampling import grid_points

SIZE = (2000, 860)
_BODY = "#b9bec4"
_SPHERE = "#f0e442"  # a colour that no patch has
_PLANE = "#8fae8b"
_FAR, _STRIDE = 500.0, 2.0  # of a line of sight, mm
_PITCH = 0.8  # mm, of the drawn grid of a face
_LARGE = 50.0  # mm, half a side of a face on which its name stands
_LETTER, _LINE = 11.0, 24.0  # width of a letter and height of a name with their margins, pixels

_NAME_OVER_BALL, _ASIDE = 10.0, 0.7
"""How much worse it is to cover another name than another ball; share of its area that a name may
cover of other balls before it leaves its best place."""

_VIEWS = ((38.0, 33.0), (218.0, 33.0))  # azimuth and elevation of the eye, deg


def draw_standard(standard: Standard, mesh: tuple[Array, np.ndarray], path: str | Path) -> None:
    """PNG of a standard from two sides: patches coloured and named, spheres, datum plane, axes.

    Args:
        standard: Whose exact faces are drawn.
        mesh: Corners and triangles of its body, as `read_stl` gives them.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    from PIL import Image

    image = Image.fromarray(rendered(_scene, standard, *mesh, missing="picture"))
    with written_whole(path) as part:
        image.save(part, format="PNG")


def _scene(standard: Standard, corners: Array, triangles: np.ndarray) -> Any:
    """Two views, faces and spheres coloured and named."""
    import pyvista as pv

    owner = owners(standard, corners, triangles)
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), window_size=SIZE, border=False)
    faces = [_face(patch) for patch in standard.patches]
    for column, view in enumerate(_VIEWS):
        plotter.subplot(0, column)
        _add_body(plotter, standard, corners, triangles, owner)
        _add_faces(plotter, faces)
        eye = outward(*np.radians(view))
        pixel = _aim(plotter, standard, eye)
        _add_labels(plotter, standard, eye, pixel)
    return plotter


def _add_body(
    plotter: Any, standard: Standard, corners: Array, triangles: np.ndarray, owner: np.ndarray
) -> None:
    """Body in grey, spheres in their colour, the datum plane in green, from the STL file."""
    sphere_names = [sphere.name for sphere in standard.spheres]
    spheres = np.isin(owner, sphere_names)
    heights = corners[triangles][:, :, 2]
    top = np.all(np.abs(heights - standard.base.thickness) < 1e-3, axis=1)
    patches = (owner != "") & ~spheres
    for mine, colour in (
        (~patches & ~spheres & ~top, _BODY),
        (top & ~patches, _PLANE),
        (spheres, _SPHERE),
    ):
        if mine.any():
            plotter.add_mesh(
                surface(corners, triangles[mine]),
                color=colour,
                smooth_shading=True,
                split_sharp_edges=True,
                feature_angle=25.0,
                specular=0.15,
                ambient=0.22,
            )


def _add_faces(plotter: Any, faces: list[Any]) -> None:
    for k, mesh in enumerate(faces):
        plotter.add_mesh(
            mesh,
            color=series(k),
            smooth_shading=True,
            specular=0.3,
            specular_power=12,
            ambient=0.15,
        )


def _face(patch: FreeformPatch) -> Any:
    """Fine grid over the exact face with its exact normals."""
    import pyvista as pv

    a, b = patch.half_size
    u = np.linspace(-a, a, int(2 * a / _PITCH) + 2)
    v = np.linspace(-b, b, int(2 * b / _PITCH) + 2)
    uv = grid_points(u, v)
    node = np.arange(len(uv)).reshape(len(u), len(v))
    quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1)
    cells = np.column_stack([np.full(quads.size // 4, 4), quads.reshape(-1, 4)])
    mesh = pv.PolyData(patch.point(uv), cells.ravel())
    mesh.point_data.active_normals = patch.normal(uv).astype(np.float32)
    return mesh


class _Box(NamedTuple):
    """A rectangle in the picture, mm along its right and upward directions."""

    x: float
    y: float
    width: float
    height: float

    def common(self, other: "_Box") -> float:
        """Area that two rectangles share, mm²."""
        along = 0.5 * (self.width + other.width) - abs(self.x - other.x)
        upward = 0.5 * (self.height + other.height) - abs(self.y - other.y)
        return max(min(along, self.width), 0.0) * max(min(upward, self.height), 0.0)


def _add_labels(plotter: Any, standard: Standard, eye: Array, pixel: float) -> None:
    """Names of the faces and balls that are visible, and of the plane.

    All are drawn over everything. The renderer leaves out a name that covers another.

    Args:
        pixel: mm.
    """
    right, up = picture_axes(eye)
    placed = _placed(standard, eye, pixel)
    half = [0.5 * pixel * (_LETTER * len(name) * right + _LINE * up) for name in placed]
    plotter.add_point_labels(
        # Lower left corners; before everything else, or a label would be half sunk in the part.
        np.array(list(placed.values())) - np.array(half) + 400.0 * eye,
        list(placed),
        font_size=18,
        bold=True,
        text_color="black",
        shape_color="white",
        shape_opacity=0.6,
        margin=2,
        show_points=False,
        always_visible=True,
    )


def _placed(standard: Standard, eye: Array, pixel: float) -> dict[str, Array]:
    """Middle of every name, mm, so that none covers another one if that can be."""
    right, up = picture_axes(eye)
    spheres = [(s.centre, 2.0 * s.radius) for s in standard.spheres]
    balls = [_Box(float(at @ right), float(at @ up), size, size) for at, size in spheres]
    placed, taken = dict[str, Array](), list[_Box]()
    for name, places in _wanted(standard, eye, pixel):
        size = _LETTER * pixel * len(name), _LINE * pixel
        boxes = [_Box(float(place @ right), float(place @ up), *size) for place in places]
        best = _freest(boxes, taken, balls)
        taken.append(boxes[best])
        placed[name] = places[best]
    return placed


def _wanted(standard: Standard, eye: Array, pixel: float) -> list[tuple[str, Array]]:
    """Names, each with the places of its middle that suit it, the best first, (N, 3), mm."""
    right, up = picture_axes(eye)
    height, wanted = _LINE * pixel, list[tuple[str, Array]]()
    for sphere in standard.spheres:
        if _is_seen(standard, sphere, eye):
            aside = sphere.radius + 0.5 * pixel * _LETTER * len(sphere.name)
            beside = [0.0 * up, (sphere.radius + 0.6 * height) * up, aside * right, -aside * right]
            wanted.append((sphere.name, sphere.centre + np.array(beside)))
    for patch in standard.patches:
        a, b = patch.half_size
        if patch.normal(patch.grid()).mean(axis=0) @ eye > 0.05:
            sides = patch.point(np.array([[a, 0.0], [-a, 0.0], [0.0, b], [0.0, -b]]))
            sides = sides[np.argsort(-(sides @ up))] + 0.7 * height * up
            places = [sides[:1], patch.point(np.zeros((1, 2))), sides[1:]]
            # a name hides a small face and is seen on a large one
            places = places if min(a, b) < _LARGE else [places[1], places[0], places[2]]
            wanted.append((patch.name, np.vstack(places)))
    return [*wanted, (standard.plane.name, _free_places(standard, eye))]


def _freest(boxes: Sequence[_Box], taken: Sequence[_Box], balls: Sequence[_Box]) -> int:
    """The first place of a name at which it covers least of other names, then of other balls."""
    cost = [
        _NAME_OVER_BALL * sum(box.common(one) for one in taken)
        + sum(box.common(one) for one in balls if not _is_on(one, box))
        + (_ASIDE * box.width * box.height if place else 0.0)
        for place, box in enumerate(boxes)
    ]
    return int(np.argmin(np.round(cost, 3)))


def _is_on(ball: _Box, name: _Box) -> bool:
    """Whether a name is that of a ball: it stands on its middle."""
    return abs(ball.x - name.x) < 1e-6 and abs(ball.y - name.y) < 1e-6


def _is_seen(standard: Standard, sphere: DatumSphere, eye: Array) -> bool:
    """Whether nothing stands between the middle of a ball and the eye."""
    others = [body for name, body in standard.bodies.items() if name != sphere.name]
    return _room(others, sphere.centre + (sphere.radius + 0.5) * eye, eye) > 0.0


def _room(bodies: list[Any], point: Array, eye: Array) -> float:
    """Distance of the line from a point to the eye from some bodies, mm."""
    line = point + np.arange(0.0, _FAR, _STRIDE)[:, None] * eye
    return float(np.min([body.distance(line) for body in bodies]))


def _free_places(standard: Standard, eye: Array) -> Array:
    """Places on the datum plane, the best first: nothing over them, near the eye, (N, 3)."""
    right, _ = picture_axes(eye)
    half = 0.86 * np.array(standard.base.half_size)
    sides = np.array([[sx, sy] for sx in (-1, -0.5, 0, 0.5, 1) for sy in (-1, -0.5, 0, 0.5, 1)])
    flat = np.column_stack([half * sides, np.full(len(sides), standard.base.thickness)])
    bodies = [body for name, body in standard.bodies.items() if name != "BASE"]
    across = [by * right + 8.0 * eye for by in (-18.0, 0.0, 18.0)]
    room = np.array([min(_room(bodies, point + by, eye) for by in across) for point in flat])
    holes = np.array([[hole.x, hole.y] for hole in standard.holes]).reshape(-1, 2)
    for hole in holes:
        room = np.minimum(room, np.linalg.norm(flat[:, :2] - hole, axis=1) - 12.0)
    return flat[np.argsort(-(np.minimum(room, 15.0) + 0.1 * flat @ eye))]


def _aim(plotter: Any, standard: Standard, eye: Array) -> float:
    """Parallel view that just holds the whole standard with its labels; the size of a pixel, mm."""
    right, up = picture_axes(eye)
    (a, b), top = standard.base.half_size, standard.base.thickness
    outline = np.array([[sx * a, sy * b, z] for sx in (-1, 1) for sy in (-1, 1) for z in (0, top)])
    spheres = [
        s.centre + (s.radius + 22.0) * side
        for s in standard.spheres
        for side in (up, right, -right)
    ]
    faces = [patch.point(patch.grid(10.0)) + 18.0 * up for patch in standard.patches]
    points = np.concatenate([outline, np.array(spheres).reshape(-1, 3), *faces])
    x, y = points @ right, points @ up
    middle = 0.5 * (x.max() + x.min()) * right + 0.5 * (y.max() + y.min()) * up
    width = 0.5 * SIZE[0] / SIZE[1]  # of a view against its height
    half = 0.52 * max(np.ptp(y), np.ptp(x) / width)
    aim(plotter, eye, middle, half)
    plotter.add_axes(line_width=4, color="black", viewport=(0.0, 0.0, 0.16, 0.2))
    return 2.0 * half / SIZE[1]
