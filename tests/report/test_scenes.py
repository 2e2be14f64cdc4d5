"""Pictures in space: what is rendered, what is written on it, and what without OpenGL."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import trimesh
from scenes import scenes_alone

from matstd.cad_out.kernel.process import Ending
from matstd.report.scenes import Scene, draw_standard, draw_volumes, standard_scene
from matstd.report.scenes.renderer import picture_axes
from matstd.report.scenes.volume_scene import PIXELS, composed, eye
from matstd.twin.errors import DesignError, MissingLibrary, ShapeMismatch
from matstd.twin.frames import outward

READINGS = (
    np.linspace(-150.0, 150.0, 5),
    np.linspace(-100.0, 100.0, 4),
    np.linspace(-400, -200, 3),
)


def scene(values=None, **changes):
    """Values that grow with the first reading."""
    x = np.ones((1, 4, 3)) * np.linspace(10.0, 20.0, 5)[:, None, None]
    facts = {
        "title": "B 0°, C 0°",
        "unit": "95 % quantile in µm",
        "labels": ("X in mm", "Y in mm", "Z in mm"),
        "readings": READINGS,
        "values": x if values is None else values,
    }
    return Scene(**(facts | changes))


@pytest.fixture(scope="module")
def mesh(upright):
    """Base and balls alone as body: that real ones are drawn shows in `matstd/test_design`."""
    (a, b), thick = upright.base.half_size, upright.base.thickness
    body = [trimesh.creation.box(bounds=[[-a, -b, 0.0], [a, b, thick]])]
    for sphere in upright.spheres:
        ball = trimesh.creation.icosphere(subdivisions=4, radius=sphere.radius)
        body.append(ball.apply_translation(sphere.centre))
    whole = trimesh.util.concatenate(body)
    return np.array(whole.vertices), np.array(whole.faces)


@pytest.fixture(scope="module")
def pictures(mesh, tmp_path_factory):
    """Pixels by name, of one rendering; on a machine without OpenGL there are none."""
    from matplotlib.image import imread

    T = np.eye(4)
    T[2, 3] = -380.0
    flat = scene(np.full((5, 4, 3), 7.0))  # the same everywhere: sections, but no iso-surfaces
    wanted = {
        "bare": [scene()],
        "with the standard": [scene(T_readings_artefact=T)],
        "two": [scene(), flat],
    }
    place = tmp_path_factory.mktemp("volumes")
    paths = {name: place / f"{name}.png" for name in wanted}
    try:
        draw_volumes({paths[n]: w for n, w in wanted.items()}, mesh)
    except MissingLibrary:
        return None
    return {name: imread(path)[..., :3] for name, path in paths.items()}


def test_values_have_the_colours_of_the_scale_and_the_standard_is_grey(pictures):
    if pictures is None:
        return
    bare, full = pictures["bare"], pictures["with the standard"]
    assert bare.shape == full.shape

    def share(image, low, high):
        return np.mean(np.all((image > low) & (image < high), axis=-1))

    # viridis begins dark violet (0.27, 0, 0.33) and ends yellow (0.99, 0.91, 0.14)
    height = slice(0, int(0.8 * bare.shape[0]))  # without the colour bar
    assert share(bare[height], (0.2, -1, 0.25), (0.35, 0.2, 0.5)) > 0.005
    assert share(bare[height], (0.7, 0.8, -1), (1.0, 1.0, 0.3)) > 0.005
    grey = ((0.45, 0.45, 0.45), (0.93, 0.93, 0.93))
    assert share(full[height], *grey) > share(bare[height], *grey) + 0.02


def test_several_pictures_from_one_rendering(pictures):
    if pictures is None:
        return
    wide, single = pictures["two"], pictures["bare"]
    assert wide.shape[1] == pytest.approx(2 * single.shape[1], abs=2)
    assert wide[:, single.shape[1] :].std() > 0.1


def test_ticks_axes_and_bar_are_written_with_their_units():
    lines = {
        "B": np.array([[0.0, 0.0, -260.0], [0.0, 1.0, 0.0]]),
        "seen along itself": np.array([[0.0, 0.0, -260.0], eye()]),
    }
    drawn = composed([scene(lines=lines)], [np.full((PIXELS, PIXELS, 3), 255, dtype=np.uint8)])
    picture, bar = drawn.axes
    words = [t.get_text() for t in picture.texts]
    for word in ("B 0°, C 0°", "X in mm", "Y in mm", "Z in mm", "B", "-100", "100", "-300"):
        assert word in words
    assert "seen along itself" not in words
    assert bar.get_xlabel() == "95 % quantile in µm"
    assert bar.get_xlim() == (10.0, 20.0)
    places = {t.get_text(): np.array(t.get_position()) for t in picture.texts}
    # X runs to the right and towards the eye, Y to the right and away, Z up
    assert places["Z in mm"][0] < places["X in mm"][0] < places["Y in mm"][0]
    inside = [np.all(np.abs(p) < 1.2) for p in places.values()]
    assert all(inside)


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ShapeMismatch, match=r"expected \(5, 4, 3\)"):
        scene(np.zeros((3, 4, 5)))
    with pytest.raises(DesignError, match="has no value"):
        scene(np.full((5, 4, 3), np.nan))


def test_a_renderer_that_fails_names_the_package_and_nothing_is_written(tmp_path, monkeypatch):
    """As it fails without OpenGL, which a test below takes away."""
    failed = Ending(1, "", "libEGL warning")
    monkeypatch.setattr("matstd.report.scenes.renderer.run_apart", lambda *_, **__: failed)
    with pytest.raises(MissingLibrary, match="apt-get install libegl1") as caught:
        draw_volumes({tmp_path / "a.png": [scene()]})
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_whole_scenes(upright, mesh, monkeypatch, tmp_path, unchanged):
    """Of values that grow, of equal ones with the standard in them, and of the standard."""
    made, T = scenes_alone(monkeypatch), np.eye(4)
    T[2, 3] = -380.0
    lines = {"B": np.array([[0.0, 0.0, -260.0], [0.0, 1.0, 0.0]])}
    flat = scene(np.full((5, 4, 3), 7.0), T_readings_artefact=T)
    draw_volumes({tmp_path / "volumes.png": [scene(lines=lines), flat]}, mesh)
    draw_standard(upright, mesh, tmp_path / "standard.png")
    unchanged("\n".join([*made, ""]))


# the standard by itself


def test_without_opengl_the_package_is_named_and_nothing_written(
    upright, mesh, tmp_path, monkeypatch
):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
    with pytest.raises(MissingLibrary, match="apt-get install libegl1") as caught:
        draw_standard(upright, mesh, tmp_path / "standard.png")
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("view", range(2))
def test_every_visible_name_of_a_standard_has_room_of_its_own(upright, view):
    """Balls one behind the other, as on the post of another: no name covers another one's.

    The renderer leaves out names that meet.
    """
    eye_of, pixel = outward(*np.radians(standard_scene._VIEWS[view])), 0.6
    right, up = picture_axes(eye_of)
    first = upright.spheres[0]
    behind = first.centre - 40.0 * eye_of + (first.radius + 1.0) * up
    balls = (*upright.spheres, replace(first, name="SPH99", centre=behind))
    names = standard_scene._placed(replace(upright, spheres=balls), eye_of, pixel)
    wide = standard_scene._LETTER * pixel
    boxes = {name: (at @ right, at @ up, wide * len(name)) for name, at in names.items()}
    assert {"SPH99", first.name, upright.plane.name} <= set(boxes)
    tall = standard_scene._LINE * pixel
    for (a, (xa, ya, wa)), (b, (xb, yb, wb)) in combinations(boxes.items(), 2):
        apart = abs(xa - xb) >= 0.5 * (wa + wb) - 1e-9 or abs(ya - yb) >= tall - 1e-9
        assert apart, (a, b)
