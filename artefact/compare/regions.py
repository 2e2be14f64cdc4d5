"""How well the faces determine the regions where machines have their largest errors.

The Monte Carlo study finds the poses of the workspace that are among the worst of many machines.
The error of the tool point there that touches on the faces alone leave unknown is compared with the
expected error:

    before = sqrt(trace(G P G^T)),   after = sqrt(trace(G (P^-1 + W^T W)^-1 G^T))
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.information.criteria import prior_sd_of_tip
from matstd.sensitivity.montecarlo import WORST_SHARE
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.record import at_poses

_COVERED_BELOW = 0.1  # of the expected error: where less remains unknown, a pose counts as covered


@dataclass(frozen=True, slots=True)
class WorstRegions:
    """Poses most often among the worst of a machine, and how well touches determine them."""

    poses: int  # their number, a twentieth of all poses
    recurrence: float  # mean share of machines for which such a pose is among the worst 5 %
    before: float  # expected error there, rms, mm
    after: float  # error that remains unknown after the touches, rms, mm
    covered: float  # share of these poses at which at most a tenth of the error remains


def worst_regions(
    criterion: Criterion, touches: Requests, q: Array, recurrence: Array
) -> WorstRegions:
    """Error that touches on some features leave at the poses with the largest errors.

    Args:
        criterion: On the standard, so that the calibration of its features counts.
        q: Poses over the workspace, (N, A), of the probe.
        recurrence: Share of the machines for which each pose is among the worst, (N,).
    """
    count = max(int(np.ceil(WORST_SHARE * len(q))), 1)
    worst = np.argsort(-recurrence, kind="stable")[:count]
    reach, model = criterion.reach, criterion.model
    tip = model.tip_columns(at_poses(reach.chain, q[worst], reach.length))
    before = prior_sd_of_tip(tip, model.prior_sd)
    after = criterion.after(touches).predicted_sd(tip)
    return WorstRegions(
        poses=count,
        recurrence=float(recurrence[worst].mean()),
        before=rms(before),
        after=rms(after),
        covered=float(np.mean(after <= _COVERED_BELOW * before)),
    )
