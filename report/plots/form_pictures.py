"""Picture of the form of one patch of the standard, as the touches show it."""

from typing import Any

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.report.style import DIVERGING, INK, Figure, figure, plain, robust_limit
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Effect, columns
from matstd.twin.units import UM

LEVELS = 15


def is_form(fit: Fit, effect: Effect) -> bool:
    """Whether an effect is the form of one feature, with touches enough to draw a map of it."""
    return effect.kind == "artefact-form" and int(_on_patch(fit, effect).sum()) > 3


def draw_form(fit: Fit, effect: Effect) -> Figure:
    """Form of a patch: touches on the fitted form, and their residuals."""
    rows = _on_patch(fit, effect)
    touches = fit.run.touches
    explained = (columns([effect], touches) @ fit.theta[fit.of_effect(effect.name)])[rows] / UM
    left_over = fit.residual[rows] / UM
    place = _flat(touches.point[rows])
    drawn = figure(3.9)
    axes = drawn.subplots(1, 2, sharex=True, sharey=True)
    limit = robust_limit(explained + left_over, 0.98)
    style: dict[str, Any] = {"cmap": DIVERGING, "vmin": -limit, "vmax": limit}
    if np.linalg.matrix_rank(place - place.mean(axis=0)) == 2:
        levels = np.linspace(-limit, limit, LEVELS)
        axes[0].tricontourf(*place.T, explained, levels=levels, extend="both", alpha=0.75, **style)
    for ax, values, title in (
        (axes[0], explained + left_over, "residual plus effect, on the fitted form"),
        (axes[1], left_over, "the same touches with the effect in the model"),
    ):
        marks = ax.scatter(*place.T, c=values, s=34.0, edgecolors=INK, linewidths=0.5, **style)
        ax.set_title(title, fontsize=9.5, loc="left", color=INK)
        ax.set(xlabel="along the patch in mm", aspect="equal")
        ax.margins(0.06)
        plain(ax)
    axes[0].set_ylabel("across the patch in mm")
    bar = drawn.colorbar(marks, ax=list(axes), pad=0.02, shrink=0.9, extend="both")
    bar.set_label("deviation along the normal, µm", fontsize=8.5)
    return drawn


def _on_patch(fit: Fit, effect: Effect) -> Mask:
    """Touches in use that the effect moves, (N,)."""
    moved = np.any(columns([effect], fit.run.touches) != 0.0, axis=1)
    return np.asarray(moved & fit.used)


def _flat(point: Array) -> Array:
    """Places of points (M, 3) in the plane of their two longest directions, (M, 2), mm."""
    centred = point - point.mean(axis=0)
    return np.asarray(centred @ np.linalg.svd(centred, full_matrices=False)[2][:2].T)
