"""Pictures: faces have their colours; without OpenGL the way out is told."""

import numpy as np
import pytest

from report.scenes.standard_scene import draw_standard
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


def test_faces_spheres_and_plane_are_in_the_picture(upright, built, tmp_path):
    image = drawn(draw_standard, upright, built[0] / "standard.stl", tmp_path / "standard.png")
    if isinstance(image, str):
        assert "apt-get install libegl1" in image
        return
    assert image.shape == (860, 2000, 3)
    assert 0.3 < np.mean(image.min(axis=2) > 0.99) < 0.85  # white round the part
    r, g, b = image.transpose(2, 0, 1)
    assert np.mean((r > 0.5) & (g > 0.85 * r) & (b < 0.6 * r)) > 0.002  # spheres, yellow
    assert np.mean((g > r + 0.05) & (g > b + 0.1)) > 0.05  # datum plane


def test_without_opengl_the_package_is_named_and_nothing_written(
    upright, built, tmp_path, monkeypatch
):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
    with pytest.raises(MissingLibrary, match="apt-get install libegl1") as caught:
        draw_standard(upright, built[0] / "standard.stl", tmp_path / "standard.png")
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_a_missing_mesh_is_named(small, tmp_path):
    with pytest.raises(DesignError, match=r"none\.stl: cannot be read"):
        draw_standard(small, tmp_path / "none.stl", tmp_path / "standard.png")
