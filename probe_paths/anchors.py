"""Where each ball really met the surface: foot points of the balls where the machine had them.

A machine whose errors carry the ball a quarter of a millimetre along the surface touches it beside
the foot point of where the ball was believed to be, and the curvature in between, some
micrometres, would pass for a deviation. The ordinary model of the machine, fitted to the run
itself, says where the ball was to some micrometres, poses with few touches included; what it does
not know moves a foot point by as much as the error that it lacks, whose curvature is nothing.
"""

from dataclasses import replace

import numpy as np

from artefact.standard import Standard
from diagnosis.fit import MIN_TOUCHES, fit_run
from probe_paths.feet import foot_points
from twin.model import Model
from twin.ordinary import ordinary_model
from twin.run import Run
from twin.touches import computed_deviation

_ROUNDS = 3
_STILL = 1e-5
"""Deviations that change less than this in a round are settled, mm."""


def anchored(run: Run, standard: Standard) -> Run:
    """A run whose points and normals are those where the balls met the standard.

    ``p = foot point of (x + d)``, x the believed ball centre and d what the fitted model says of
    its displacement relative to the standard. The deviations ``n . (x - p) - radius`` remain those
    of the believed balls: only the point and the normal that they refer to are better.

    Args:
        run: With foot points of the believed balls.
        standard: As calibrated.

    Returns:
        The run anew; as it came with fewer than `MIN_TOUCHES` touches, which fit nothing, and with
        the old foot point where the moved ball has none.
    """
    if len(run) < MIN_TOUCHES:
        return run
    chain = run.touches.chain
    for _ in range(_ROUNDS):
        t, before = run.touches, run.deviation
        fit = fit_run(run, ordinary_model(chain))
        moved = Model(chain, fit.effects).relative_deviation(t, fit.theta)
        point, normal = foot_points(standard, t.feature, t.ball_artefact + moved)
        found = np.all(np.isfinite(point), axis=1, keepdims=True)
        t = replace(
            t, point=np.where(found, point, t.point), normal=np.where(found, normal, t.normal)
        )
        run = replace(run, touches=t, deviation=computed_deviation(t))
        if np.abs(run.deviation - before).max() < _STILL:
            break
    return run
