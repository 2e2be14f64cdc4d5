"""Drawing itself, in the renderer's own process; reached through `standard_scene` alone."""

from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard, read_standard
from matstd.cad_out.meshes import owners, read_stl
from matstd.report.scenes.renderer import STL, screenshot
from matstd.report.scenes.standard_scene import PICTURE, STANDARD
from matstd.report.style import series
from matstd.twin.frames import Array
from matstd.twin.sampling import grid_points

SIZE = (2000, 860)
_BODY = "#b9bec4"
_SPHERE = "#f0e442"  # a colour that no patch has
_PLANE = "#8fae8b"
_FAR, _STRIDE = 500.0, 2.0  # of a line of sight, mm
_PITCH = 0.8  # mm, of the drawn grid of a face
_VIEWS = ((38.0, 33.0), (218.0, 33.0))  # azimuth and elevation of the eye, deg


def draw_body(folder: str) -> None:
    """Two views of the standard, faces and spheres coloured and named."""
    import pyvista as pv

    place = Path(folder)
    standard = read_standard(place / STANDARD)
    corners, triangles = read_stl(place / STL)
    owner = owners(standard, corners, triangles)
    plotter = pv.Plotter(off_screen=True, shape=(1, 2), window_size=SIZE, border=False)
    faces = [_face(patch) for patch in standard.patches]
    for column, view in enumerate(_VIEWS):
        plotter.subplot(0, column)
        _add_body(plotter, standard, corners, triangles, owner)
        _add_faces(plotter, faces)
        _add_labels(plotter, standard, _eye(view))
        _aim(plotter, standard, _eye(view))
    screenshot(plotter, place / PICTURE)


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
                _surface(corners, triangles[mine]),
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


def _add_labels(plotter: Any, standard: Standard, eye: Array) -> None:
    """Names above the faces that are visible, on the balls that are, and on the plane.

    A name is drawn over everything: beside or above its ball it would stand on another one, and
    that of a hidden ball on what hides it.
    """
    right, up = _picture_axes(eye)
    places, names = [], []
    for patch in standard.patches:
        a, b = patch.half_size
        border = np.array([[a, 0.0], [-a, 0.0], [0.0, b], [0.0, -b]])
        if patch.normal(np.zeros((1, 2)))[0] @ eye > 0.15:
            sides = patch.point(border)
            places.append(sides[np.argmax(sides @ up)] + 5.0 * up)
            names.append(patch.name)
    for sphere in standard.spheres:
        if _is_seen(standard, sphere, eye):
            places.append(sphere.centre)
            names.append(sphere.name)
    places.append(_free_corner(standard, eye))
    names.append(standard.plane.name)
    plotter.add_point_labels(
        # Before everything else, or a label would be half sunk in the part.
        np.array(places) + 400.0 * eye - 6.0 * right,
        names,
        font_size=18,
        bold=True,
        text_color="black",
        shape_color="white",
        shape_opacity=0.6,
        margin=2,
        show_points=False,
        always_visible=True,
    )


def _is_seen(standard: Standard, sphere: DatumSphere, eye: Array) -> bool:
    """Whether nothing stands between the middle of a ball and the eye."""
    others = [body for name, body in standard.bodies.items() if name != sphere.name]
    return _room(others, sphere.centre + (sphere.radius + 0.5) * eye, eye) > 0.0


def _room(bodies: list[Any], point: Array, eye: Array) -> float:
    """Distance of the line from a point to the eye from some bodies, mm."""
    line = point + np.arange(0.0, _FAR, _STRIDE)[:, None] * eye
    return float(np.min([body.distance(line) for body in bodies]))


def _free_corner(standard: Standard, eye: Array) -> Array:
    """A place on the datum plane near the eye with nothing over it."""
    half = 0.86 * np.array(standard.base.half_size)
    sides = np.array([[sx, sy] for sx in (-1, -0.5, 0, 0.5, 1) for sy in (-1, -0.5, 0, 0.5, 1)])
    flat = np.column_stack([half * sides, np.full(len(sides), standard.base.thickness)])
    bodies = [body for name, body in standard.bodies.items() if name != "BASE"]
    room = np.array([_room(bodies, point + 8.0 * eye, eye) for point in flat])
    holes = np.array([[hole.x, hole.y] for hole in standard.holes]).reshape(-1, 2)
    for hole in holes:
        room = np.minimum(room, np.linalg.norm(flat[:, :2] - hole, axis=1) - 12.0)
    best: Array = flat[np.argmax(np.minimum(room, 15.0) + 0.1 * flat @ eye)]
    return best


def _aim(plotter: Any, standard: Standard, eye: Array) -> None:
    """Parallel view that just holds the whole standard with its labels."""
    right, up = _picture_axes(eye)
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
    plotter.camera.position = tuple(middle + 1000.0 * eye)
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.up = (0.0, 0.0, 1.0)
    plotter.camera.parallel_projection = True
    width = 1000.0 / 860.0  # of a view against its height
    plotter.camera.parallel_scale = 0.52 * max(np.ptp(y), np.ptp(x) / width)
    plotter.add_axes(line_width=4, color="black", viewport=(0.0, 0.0, 0.16, 0.2))


def _picture_axes(eye: Array) -> tuple[Array, Array]:
    """Directions to the right and upwards in a picture seen from `eye`."""
    right = np.cross([0.0, 0.0, 1.0], eye)
    right = right / np.linalg.norm(right)
    return right, np.cross(eye, right)


def _eye(view: tuple[float, float]) -> Array:
    azimuth, elevation = np.radians(view)
    return np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )


def _surface(corners: Array, triangles: np.ndarray) -> Any:
    import pyvista as pv

    return pv.PolyData(corners, np.column_stack([np.full(len(triangles), 3), triangles]).ravel())
