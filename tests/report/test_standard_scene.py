"""Pictures: faces and values have their colours; without OpenGL the way out is told."""

import numpy as np
import pytest

from report.scenes.standard_scene import draw_standard, draw_values
from twin.errors import DesignError, MissingLibrary


def pixels(path):
    from matplotlib.image import imread

    return imread(str(path))[..., :3]


def drawn(draw, *arguments):
    """The picture; on a machine without OpenGL the error that says what to install."""
    try:
        draw(*arguments)
    except MissingLibrary as error:
        return str(error)
    return pixels(arguments[2])


def test_faces_spheres_and_plane_are_in_the_picture(small, built, tmp_path):
    image = drawn(draw_standard, small, built[0] / "standard.stl", tmp_path / "standard.png")
    if isinstance(image, str):
        assert "apt-get install libegl1" in image
        return
    assert image.shape == (860, 2000, 3)
    assert 0.3 < np.mean(image.min(axis=2) > 0.99) < 0.85  # white round the part
    r, g, b = image.transpose(2, 0, 1)
    assert np.mean((r > 0.5) & (g > 0.85 * r) & (b < 0.6 * r)) > 0.002  # spheres, yellow
    assert np.mean((g > r + 0.05) & (g > b + 0.1)) > 0.05  # datum plane


def test_positive_values_are_red_and_their_scale_is_drawn(small, built, tmp_path):
    patch = small.patches[0]
    uv = np.stack(np.meshgrid([-13.0, 0.0, 13.0], [-10.0, 0.0, 10.0]), axis=-1).reshape(-1, 2)
    stl, path = built[0] / "standard.stl", tmp_path / "values.png"
    image = drawn(draw_values, small, stl, path, patch.point(uv), np.full(9, 4.0), "µm")
    if isinstance(image, str):
        assert "apt-get install libegl1" in image
        return
    assert image.shape == (860, 2200, 3)
    r, _, b = image.transpose(2, 0, 1)
    red, blue = r > b + 0.3, b > r + 0.3
    assert red[:, :2000].mean() > 0.003
    assert blue[:, :2000].mean() < 0.1 * red[:, :2000].mean()
    assert blue[:, 2000:].mean() > 0.003  # the lower half of the scale


def test_without_opengl_the_package_is_named_and_nothing_written(
    small, built, tmp_path, monkeypatch
):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
    with pytest.raises(MissingLibrary, match="apt-get install libegl1") as caught:
        draw_standard(small, built[0] / "standard.stl", tmp_path / "standard.png")
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_a_missing_mesh_is_named(small, tmp_path):
    with pytest.raises(DesignError, match=r"none\.stl: cannot be read"):
        draw_standard(small, tmp_path / "none.stl", tmp_path / "standard.png")
