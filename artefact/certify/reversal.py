"""Measurements of one standard in several orientations on a coordinate measuring machine.

Squareness of the CMM, and differences between its scales, act along its axes. On a piece that is
turned by 90 degrees they act along other directions of the piece, so that their mean over four
orientations vanishes. The spread of the ball centres between orientations shows their size; it
replaces what the certificate states if it is larger; the mean of m orientations has a share of
``1/sqrt m`` of it.

Reference:
    ISO/TS 15530-2 (several orientations of the uncalibrated object).
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.certify.calibration_fit import alignment, measured_balls
from matstd.artefact.certify.cmm_points_file import CmmPoints
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import apply
from matstd.twin.numbers import rms


def merged_orientations(
    nominal: Standard, measured: Sequence[CmmPoints], u_point: float, u_feature: float
) -> tuple[CmmPoints, float]:
    """Points of all orientations in the frame of the design, and the uncertainty that they share.

    Returns:
        The points, and the standard uncertainty of a feature's mean place, mm.

    Raises:
        BadFile: Points in other units, or of another standard.
        NotEnoughData: Too few balls, or balls that only some orientations have.
    """
    if len(measured) == 1:
        return measured[0], u_feature
    points, places = [], []
    for one in measured:
        balls = measured_balls(nominal, one, u_point, [])
        T = alignment(nominal, one, {name: ball.centre for name, ball in balls.items()})
        points.append(apply(T, one.point))
        places.append({n: apply(T, ball.centre[None])[0] for n, ball in balls.items()})
    if any(place.keys() != places[0].keys() for place in places):
        raise NotEnoughData(
            f"{measured[0].path}: balls that other orientations have not, expected every ball in "
            "every orientation"
        )
    centres = np.array([list(place.values()) for place in places])
    count = len(measured)
    between = rms(centres - centres.mean(axis=0)) * np.sqrt(count / (count - 1))
    first = measured[0]
    together = replace(
        first,
        path=Path(", ".join(one.path.name for one in measured)),
        feature=np.concatenate([one.feature for one in measured]),
        point=np.concatenate(points),
        diameter=np.concatenate([one.diameter for one in measured]),
        line=np.concatenate([one.line for one in measured]),
        remarks=tuple(dict.fromkeys(r for one in measured for r in one.remarks)),
    )
    return together, float(max(between, u_feature) / np.sqrt(count))
