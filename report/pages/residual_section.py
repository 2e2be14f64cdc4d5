"""What the pages of compare and diagnose share: pictures of residuals, outliers, what was run."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import Region, Structure, has_poses, rank_variables
from matstd.report.numbers import span
from matstd.report.pages.page import p_value
from matstd.report.plots import (
    draw_normal_plot,
    draw_over_variables,
    draw_pattern,
    draw_pose_arrows,
)
from matstd.report.words import microns, region_words, stated_noise, structure_words
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.record import Run, Touches
from matstd.twin.units import UM

FIRST = 12
"""Variables that are shown at once; the others are folded away."""

WHOLE = 40
"""Variables that are shown at most."""

PATTERNS = 3
"""Patterns that are drawn at most."""


class Picture(NamedTuple):
    """A picture of a page.

    Attributes:
        file: Name in the folder of pictures.
        caption: What there is to be seen.
        folded: Whether the page hides it until it is asked for.
    """

    file: str
    caption: str
    folded: bool = False


def residual_pictures(place: Path, name: str, fit: Fit, z: Array | None = None) -> list[Picture]:
    """Pictures of what a fit leaves.

    Args:
        place: Folder of the pictures.
        name: First word of their names.
        z: Residuals over their standard uncertainty where that is more than the touch's own, (N,).
    """
    out = []
    panels = rank_variables(fit)
    for part, word in ((panels[:FIRST], "over"), (panels[FIRST:WHOLE], "over_more")):
        if part:
            file = f"{name}_{word}.png"
            draw_over_variables(place / file, fit, part)
            out.append(Picture(file, _OVER if word == "over" else _MORE, word != "over"))
    if has_poses(fit):
        draw_pose_arrows(place / f"{name}_poses.png", fit)
        out.append(Picture(f"{name}_poses.png", _POSES))
    draw_normal_plot(place / f"{name}_normal.png", fit, z)
    out.append(Picture(f"{name}_normal.png", _NORMAL))
    return out


_OVER = (
    "Residual over everything that was recorded, what it depends on most first. Grey: touches. "
    "Dots: means with standard errors, orange beyond three of them. Right-hand scale: in stated "
    "uncertainties."
)
_MORE = "The same for the other variables"
_POSES = (
    "How the tool stood away from where the model has it, pose by pose. Left: an arrow along X and "
    "Y at the rotary readings, coloured by Z. Right: the components with their standard "
    "uncertainties."
)
_NORMAL = (
    "Residuals over their stated standard uncertainty, leverage allowed for, against the normal "
    "distribution. Touches that were left out stand at the edge, by line of the run file."
)


def pattern_pictures(
    place: Path, fit: Fit, found: Sequence[Structure], rng: np.random.Generator
) -> list[Picture]:
    """Pictures of what a residual varies with, each beside the same residual shuffled.

    Args:
        place: Folder of the pictures.
        found: Patterns in its residual, the most certain first.
        rng: Shuffles.
    """
    out: list[Picture] = []
    seen: set[tuple[tuple[str, ...], float]] = set()
    for k, one in enumerate(found):
        if (one.variables, one.period) in seen or len(out) >= PATTERNS:
            continue
        seen.add((one.variables, one.period))
        if draw_pattern(place / f"pattern_{k}.png", fit, one, rng):
            words = _capital(structure_words(one))
            words = f"{words}; probability by chance {p_value(one.p_value)}."
            out.append(Picture(f"pattern_{k}.png", words))
    return out


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]


def region_rows(found: Sequence[Region]) -> list[dict[str, Any]]:
    """Regions where a model fails, with their conditions in words; lengths in µm."""
    return [
        {
            "words": region_words(r.conditions),
            "touches": int(r.rows.sum()),
            "mean": r.mean / UM,
            "u": r.u / UM,
            "rms": r.rms / UM,
            "p": r.p_value,
        }
        for r in found
    ]


def gross_rows(fit: Fit) -> list[dict[str, Any]]:
    """Gross errors, the largest first, by line of the run file."""
    rows = np.flatnonzero(fit.gross.rows | fit.gross_test_rows)
    rows = rows[np.argsort(-np.abs(fit.residual[rows]))]
    t = fit.run.touches
    return [
        {
            "line": int(fit.run.line[i]),
            "feature": str(t.feature[i]),
            "setup": t.setups[t.setup[i]].name,
            "pose": int(t.pose[i]),
            "residual": float(fit.residual[i]) / UM,
            "score": float(abs(fit.gross.score[i])),
        }
        for i in rows
    ]


def _extent(t: Touches) -> str:
    """At how many poses and in what time the touches were made, as far as either says something."""
    poses = len(np.unique(np.column_stack([t.setup, t.pose]), axis=0))
    table = "table " if t.chain.turns_workpiece else ""
    at = f" at {poses} {table}pose{'s' if poses != 1 else ''}" if t.chain.rotary_axes else ""
    time = float(np.ptp(t.time))
    return f"{at} in {span(time)}" if time > 0.0 else at


def setting(run: Run, fit: Fit) -> dict[str, Any]:
    """What was run, in numbers for the head and the foot of a page."""
    t = run.touches
    return {
        "chain": t.chain,
        "touches": len(run),
        "extent": _extent(t),
        "setups": len(np.unique(t.setup)),
        "stated": microns(stated_noise(run)),
        "scatter": microns(stated_noise(run) * fit.noise.factor),
        "fingerprint": run.fingerprint,
        "u_um": rms(run.u) / UM,
        "parameters": len(fit.parameters),
        "held_out": int((run.split == "test").sum()),
    }
