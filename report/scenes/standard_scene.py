"""Pictures of a standard, drawn without a screen in a process of their own."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from artefact.body import Standard, write_standard
from report.scenes.renderer import render, shared_folder
from twin.files import written_whole
from twin.frames import Array

STANDARD, PICTURE = "standard.toml", "picture.png"
"""Further files through which the two processes speak."""


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
    with shared_folder(stl, facts) as place:
        write_standard(place / STANDARD, standard)
        render("standard_render", task, place, "picture")
        with written_whole(path) as part:
            shutil.copyfile(place / PICTURE, part)
