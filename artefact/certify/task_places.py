"""Touches on a standard that resemble a measuring task in slope, curvature and table pose."""

from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import Task
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, Mask
from matstd.twin.record import Touches
from matstd.twin.units import DEG, UM

_MAX_OFFSET = 2.0 * UM  # rms of touches off the standard that evaluated them: its sag
# is some tenths of a µm, a piece differs from its design by 5 to 50 µm
_OTHER_PIECE = 0.5  # touches farther off, mm, were made on another piece
_EDGE = 1e-6  # rad and 1/mm: ranges include their ends in spite of rounding


def that_prove(standard: Standard, touches: Touches) -> Mask:
    """Touches that are held out from the identification: on faces, and balls that prove, (N,).

    Raises:
        DesignError: A feature that the standard does not have.
    """
    unknown = sorted(set(touches.feature.tolist()) - set(standard.features))
    if unknown:
        raise DesignError(
            f"feature '{unknown[0]}' is not on standard '{standard.name}', which has "
            f"{', '.join(standard.features)}"
        )
    return np.isin(touches.feature, standard.proving)


def like_task(task: Task, standard: Standard, touches: Touches) -> Mask:
    """Touches that prove within all ranges of a task, (N,); raises DesignError for none."""
    chain = touches.chain
    for letter in task.rotary:
        if letter not in chain.rotary_axes:
            raise DesignError(
                f"task '{task.name}': poses.{letter}_deg, expected rotary axes of {chain.name}: "
                f"{', '.join(chain.rotary_axes) or 'none'}"
            )
    proof = that_prove(standard, touches)
    if not proof.any():
        raise DesignError(
            f"no touch on a feature of standard '{standard.name}' that proves the model "
            f"({', '.join(standard.proving) or 'it has none'}): task '{task.name}' cannot be "
            "evaluated"
        )
    asked = [
        ("slope_deg", DEG, np.arccos(np.clip(touches.normal[:, 2], -1.0, 1.0)), task.slope),
        ("curvature_1_m", 1e-3, curvature(standard, touches), task.curvature),
    ]
    for letter, limits in task.rotary.items():
        readings = touches.q[:, chain.axis_index(letter)]
        asked.append((f"poses.{letter}_deg", DEG, readings, limits))
    like, per_range = proof.copy(), []
    for key, unit, values, (low, high) in asked:
        # counted range by range, so that a refusal names the range that leaves no touch
        met = (values >= low - _EDGE) & (values <= high + _EDGE)
        like &= met
        there = values[proof] / unit
        per_range.append(
            f"{key} {int((met & proof).sum())} (they have {there.min():.3g} to {there.max():.3g})"
        )
    if not like.any():
        raise DesignError(
            f"task '{task.name}': none of {int(proof.sum())} touches that prove is within "
            f"all its ranges; within each: {', '.join(per_range)}"
        )
    return like


def check_places(standard: Standard, touches: Touches, path: str | Path) -> None:
    """Reject a run that was evaluated with another file than that of this standard.

    A touch lies on the surface that its evaluation assumed: designed or calibrated.

    Raises:
        BadFile: The touches lie off its surfaces.
    """
    off = off_surfaces(standard, touches)
    there = np.isfinite(off)
    rms = float(np.sqrt(np.mean(off[there] ** 2))) if there.any() else np.inf
    if rms > _MAX_OFFSET:
        other = "the design" if standard.known else "a calibration of it"
        raise BadFile(
            path,
            "px_mm, py_mm, pz_mm",
            f"touches {rms / UM:.1f} µm rms off the surfaces of standard '{standard.name}'",
            f"the file of the standard that the run was evaluated with: {other}, perhaps",
        )


def off_surfaces(standard: Standard, touches: Touches) -> Array:
    """Distance of every touch from the feature that it names, (N,), mm.

    A touch that names none is compared with all. It is infinite where a point is beside a face.

    Raises:
        DesignError: A feature that the standard does not have.
    """
    that_prove(standard, touches[touches.feature != ""])
    off = np.full(len(touches), np.inf)
    for name in dict.fromkeys(touches.feature.tolist()):
        rows = np.flatnonzero(touches.feature == name)
        points = touches.point[rows]
        for surface in [standard.features[name]] if name else standard.features.values():
            uv = surface.project(points)
            there = np.isfinite(uv).all(axis=1)
            foot = np.linalg.norm(points[there] - surface.point(uv[there]), axis=1)
            off[rows[there]] = np.minimum(off[rows[there]], foot)
    return off


def farthest_off(standard: Standard, touches: Touches, path: str | Path) -> float:
    """How far the touches of a run without a stamp lie off a standard at most, mm.

    Raises:
        DesignError: A feature that the standard does not have, or touches beside its features.
    """
    off = off_surfaces(standard, touches)
    far = np.flatnonzero(off > _OTHER_PIECE)
    if len(far):
        worst = int(np.argmax(off))
        raise DesignError(
            f"{path}: {len(far)} of {len(off)} touches lie off standard '{standard.name}', one of "
            f"them {f'{off[worst]:.1f} mm off' if np.isfinite(off[worst]) else 'beside'} "
            f"{touches.feature[worst] or 'all features'}; expected the standard that was probed"
        )
    return float(off.max())


def curvature(standard: Standard, touches: Touches) -> Array:
    """Larger principal curvature at every touch that proves, 0 elsewhere, (N,), 1/mm."""
    out = np.zeros(len(touches))
    for name in standard.proving:
        surface, rows = standard.features[name], np.flatnonzero(touches.feature == name)
        uv = surface.project(touches.point[rows])
        there = np.all(np.isfinite(uv), axis=1)
        out[rows[there]] = np.abs(surface.curvature(uv[there])).max(axis=1)
    return out
