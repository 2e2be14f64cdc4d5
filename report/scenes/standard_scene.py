"""Picture of a standard, drawn without a screen in a process of their own."""

import shutil
from pathlib import Path

from matstd.artefact.body import Standard, write_standard
from matstd.report.scenes.renderer import render, shared_folder
from matstd.twin.files import written_whole

STANDARD, PICTURE = "standard.toml", "picture.png"
"""Further files through which the two processes speak."""


def draw_standard(standard: Standard, stl: str | Path, path: str | Path) -> None:
    """PNG of a standard from two sides: patches coloured and named, spheres, datum plane, axes.

    Args:
        standard: Whose exact faces are drawn.
        stl: Its STL file, for the body.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    with shared_folder(Path(stl), {}) as place:
        write_standard(place / STANDARD, standard)
        render("standard_render", "draw_body", place, "picture")
        with written_whole(path) as part:
            shutil.copyfile(place / PICTURE, part)
