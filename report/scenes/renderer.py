"""Pictures rendered without a screen, in a process of their own: a fault there ends no other."""

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from matstd.cad_out.kernel import run_apart
from matstd.twin.errors import DesignError, MissingLibrary
from matstd.twin.frames import Array

FACTS, STL = "facts.npz", "standard.stl"
"""Names of the files through which the two processes speak."""

SECONDS = 600.0  # after which the renderer is stopped

# Without this the renderer looks for an X server and complains when there is none.
_EGL = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"}


@contextmanager
def shared_folder(stl: Path | None, facts: Mapping[str, Any]) -> Iterator[Path]:
    """A folder for a renderer and who calls it, with what is to be drawn; gone afterwards.

    Raises:
        DesignError: No such STL file.
    """
    with tempfile.TemporaryDirectory(prefix="picture-", ignore_cleanup_errors=True) as name:
        place = Path(name)
        try:
            if stl is not None:
                shutil.copyfile(stl, place / STL)
        except OSError as error:
            raise DesignError(f"{stl}: cannot be read ({error.strerror})") from error
        np.savez(place / FACTS, **facts)
        yield place


def render(module: str, task: str, place: Path, what: str) -> None:
    """Let a task of `matstd.report.scenes` draw what stands in a folder.

    Args:
        module: Of `matstd.report.scenes`.
        task: Function that takes the folder.
        place: The folder.
        what: Is missing if it fails: `picture`.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The task refuses.
    """
    ending = run_apart(
        f"matstd.report.scenes.{module}", task, place, timeout=SECONDS, environment=_EGL
    )
    if ending.refusal:
        raise DesignError(ending.refusal)
    if not ending.is_good:
        # what follows the colon is the renderer's own log
        raise MissingLibrary(
            f"no {what}: the renderer {str(ending).partition(':')[0]}; it needs OpenGL without a "
            "screen, on Debian and Ubuntu: apt-get install libegl1 libgl1-mesa-dri",
            exit_code=ending.code,
        )


def screenshot(plotter: Any, path: Path | None = None) -> Array:
    """Image of a finished scene on white, and its PNG where a path is given."""
    plotter.set_background("white", all_renderers=True)
    plotter.enable_anti_aliasing("ssaa", all_renderers=True)
    image = plotter.screenshot(None if path is None else str(path), return_img=True)
    if image.std() < 1.0:
        raise DesignError("no picture: the renderer gives an empty image")
    return np.asarray(image)
