"""Pictures rendered without a screen, in a process of their own: a fault there ends no other."""

import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from matstd.cad_out.kernel import run_apart
from matstd.twin.errors import DesignError, MissingLibrary
from matstd.twin.frames import Array

SECONDS = 600.0  # after which the renderer is stopped
_CALL, _IMAGE = "call.pickle", "image.npy"  # files through which the two processes speak

# Without this the renderer looks for an X server and complains when there is none.
_EGL = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"}


def rendered(draw: Callable[..., Any], *what: Any, missing: str) -> Array:
    """Image of a scene that a function gives as a plotter of pyvista, (height, width, 3).

    Args:
        draw: A function of a module, so that the other process finds it.
        what: Its arguments.
        missing: What is not drawn where it fails: `picture`.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    with tempfile.TemporaryDirectory(prefix="picture-", ignore_cleanup_errors=True) as name:
        place = Path(name)
        (place / _CALL).write_bytes(pickle.dumps((draw, what)))
        ending = run_apart(__name__, "answer", place, timeout=SECONDS, environment=_EGL)
        if ending.refusal:
            raise DesignError(ending.refusal)
        if not ending.is_good:
            # what follows the colon is the renderer's own log
            raise MissingLibrary(
                f"no {missing}: the renderer {str(ending).partition(':')[0]}; it needs OpenGL "
                "without a screen, on Debian and Ubuntu: apt-get install libegl1 libgl1-mesa-dri",
                exit_code=ending.code,
            )
        image: Array = np.load(place / _IMAGE)
    return image


def answer(folder: str) -> None:
    """What the other process does: draw the scene of a folder on white, and leave its image."""
    draw, what = pickle.loads((Path(folder) / _CALL).read_bytes())  # from our own process
    plotter = draw(*what)
    plotter.set_background("white", all_renderers=True)
    plotter.enable_anti_aliasing("ssaa", all_renderers=True)
    image = np.asarray(plotter.screenshot(None, return_img=True))
    if image.std() < 1.0:
        raise DesignError("no picture: the renderer gives an empty image")
    np.save(Path(folder) / _IMAGE, image)


def picture_axes(eye: Array) -> Array:
    """Directions to the right and upwards in a picture seen from `eye`, (2, 3)."""
    right = np.cross([0.0, 0.0, 1.0], eye)
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right)])


def surface(corners: Array, triangles: np.ndarray) -> Any:
    """Triangles as a mesh of pyvista."""
    import pyvista as pv

    return pv.PolyData.from_regular_faces(corners, triangles)


def aim(plotter: Any, eye: Array, middle: Array, half: float) -> None:
    """Parallel view from a direction: middle of the picture (3,) and half its height, mm."""
    plotter.camera.position = tuple(middle + 1000.0 * eye)
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.up = (0.0, 0.0, 1.0)
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = half
