"""How much of the regions where the machine is wrong again and again the faces see.

A freeform face is for errors that dominate. Which do follows from the Monte Carlo: poses of the
user's workspace that are among the worst of many machines. What touches on the faces alone, without
a ball, would leave unknown of the tool point there is compared with what is expected of it:

    before = sqrt(trace(G P G^T)),   after = sqrt(trace(G (P^-1 + W^T W)^-1 G^T))
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.information.criteria import Posterior, prior_sd_of_tip
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.record import at_poses

_SHARE = 0.05  # of the poses: as many as are the worst of one machine
_SEEN = 0.1  # of the expected error: where no more is left, the faces see the region


@dataclass(frozen=True, slots=True)
class WorstRegions:
    """Poses that are most often among the worst of a machine, and what touches determine of them.

    Attributes:
        poses: Their number, a twentieth of those looked at.
        recurrence: Share of the machines of which one of them is among the worst 5 %, on average.
        before: Expected error there, rms, mm.
        after: What the touches leave unknown of it, rms, mm.
        covered: Share of these poses at which they leave a tenth of the error at most.
    """

    poses: int
    recurrence: float
    before: float
    after: float
    covered: float


def worst_regions(
    criterion: Criterion, touches: Requests, q: Array, recurrence: Array
) -> WorstRegions:
    """What touches on some features alone determine of the poses that are wrong again and again.

    Args:
        criterion: On the standard, so that the calibration of its features counts.
        touches: On the features.
        q: Poses over the workspace, (N, A), of the probe.
        recurrence: Share of the machines of which each is among the worst, (N,).
    """
    count = max(int(np.ceil(_SHARE * len(q))), 1)
    worst = np.argsort(-recurrence, kind="stable")[:count]
    reach, model = criterion.reach, criterion.model
    tip = model.tip_columns(at_poses(reach.chain, q[worst], reach.length))
    known = Posterior(criterion.known_rows(touches), criterion.prior_sd, model.names)
    before, after = prior_sd_of_tip(tip, model.prior_sd), known.predicted_sd(tip)
    return WorstRegions(
        poses=count,
        recurrence=float(recurrence[worst].mean()),
        before=rms(before),
        after=rms(after),
        covered=float(np.mean(after <= _SEEN * before)),
    )
