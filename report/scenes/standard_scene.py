"""Pictures of a standard, drawn without a screen in a process of their own."""

import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from artefact.body import Standard, write_standard
from cad_out.build import run_apart
from twin.errors import DesignError, MissingLibrary
from twin.files import written_whole
from twin.frames import Array

STANDARD, STL, VALUES, PICTURE = "standard.toml", "standard.stl", "values.npz", "picture.png"
"""Names of the files through which the two processes speak."""


def draw_standard(standard: Standard, stl: str | Path, path: str | Path) -> None:
    """PNG of a standard from two sides: patches coloured and named, spheres, datum plane, axes.

    Args:
        standard: Whose exact faces are drawn.
        stl: Its STL file, for the body.
        path: The picture; written whole or not at all.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    _draw(standard, Path(stl), Path(path), "draw_body", {})


def draw_values(
    standard: Standard,
    stl: str | Path,
    path: str | Path,
    points: Array,
    values: Array,
    title: str,
    limit: float | None = None,
) -> None:
    """PNG of a standard whose faces are coloured by values at touched points, as residuals are.

    Between the points of a face the colour is interpolated linearly; outside them it stays
    grey, because nothing was measured there.

    Args:
        standard: Whose exact faces are drawn.
        stl: Its STL file, for the body.
        path: The picture; written whole or not at all.
        points: Touched points on the surfaces, shape (N, 3), artefact frame, mm.
        values: Of any unit, shape (N,).
        title: Of the colour bar, with the unit.
        limit: End of the symmetric scale; default the 98 % quantile of the absolute values.

    Raises:
        MissingLibrary: No OpenGL without a screen on this machine; names the system package.
        DesignError: The renderer fails otherwise.
    """
    values = np.asarray(values, dtype=float)
    if limit is None:
        limit = float(np.quantile(np.abs(values), 0.98)) if len(values) else 1.0
    facts: dict[str, Any] = {
        "points": points,
        "values": values,
        "title": np.array(title),
        "limit": limit or 1.0,
    }
    _draw(standard, Path(stl), Path(path), "draw_coloured", facts)


def _draw(standard: Standard, stl: Path, path: Path, task: str, facts: dict[str, Any]) -> None:
    place = Path(tempfile.mkdtemp(prefix="picture-"))
    try:
        write_standard(place / STANDARD, standard)
        try:
            shutil.copyfile(stl, place / STL)
        except OSError as error:
            raise DesignError(f"{stl}: cannot be read ({error.strerror})") from error
        np.savez(place / VALUES, **facts)
        # Without this the renderer looks for an X server and complains when there is none.
        egl = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"}
        ending = run_apart(
            "report.scenes.standard_render", task, place, timeout=90.0, environment=egl
        )
        if ending.refusal:
            raise DesignError(ending.refusal)
        if not ending.is_good:
            raise MissingLibrary(
                f"no picture: the renderer {_without_line(str(ending))}; it needs OpenGL without "
                "a screen, on Debian and Ubuntu: apt-get install libegl1 libgl1-mesa-dri",
                exit_code=ending.code,
            )
        with written_whole(path) as part:
            shutil.copyfile(place / PICTURE, part)
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _without_line(text: str) -> str:
    """The first clause: what follows the colon is the renderer's own log."""
    return text.split(":", 1)[0]
