"""How the error that is left falls with the number of touches, on every artefact by one rule.

The touches of an artefact are put into the order in which each helps most after those before it;
beyond their number every touch is made again, in the same way. So a curve passes through the
figures of the comparison at the designed number, and says what fewer touches, or more time on the
machine, would buy.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.reach import Requests
from matstd.artefact.worth.touch_criterion import Criterion
from matstd.information.criteria import mean_prediction, with_potential
from matstd.information.selection import Selection, fill
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array

COUNTS = (50, 70, 100, 140, 200, 300, 400, 550, 750, 1000)  # numbers of touches


@dataclass(frozen=True, eq=False)
class TouchCurve:
    """Error left on one artefact against the number of touches."""

    name: str
    designed: int  # number of touches that it was designed with
    counts: tuple[int, ...]  # numbers of touches, (K,), the designed one among them
    # predicted root mean square of the unknown tool point deviation over the probed volume, (K,),
    # mm
    rms: Array
    rms_user: Array  # the same over the user's workspace


def touch_curve(
    criterion: Criterion, name: str, touches: Requests, counts: Sequence[int] = COUNTS
) -> TouchCurve:
    """Error left after the best few of some touches, all of them, and each more than once.

    Args:
        criterion: Machine, noise, poses that are predicted, on the artefact.
        counts: Numbers of touches to look at; the designed one is added.

    Raises:
        DesignError: No touches, or a number below one.
    """
    if not len(touches) or min(counts, default=1) < 1:
        raise DesignError(f"{len(touches)} touches looked at by {list(counts)}, expected some")
    designed = len(touches)
    numbers = tuple(sorted({*counts, designed}))
    areas = (criterion.tip_volume, criterion.tip_user)
    rows = criterion.whitened(touches)
    predict = mean_prediction(np.concatenate(areas), rows, criterion.prior_sd)
    places = criterion.calibrated(touches)
    W = np.concatenate([predict.rows(rows), places], axis=1)
    unfelt = (0, places.shape[1])  # the tool point does not feel where a feature lies
    forms = [np.pad(_form(criterion, tip, predict.directions), unfelt) for tip in areas]
    if places.shape[1]:
        predict = with_potential(predict, places.shape[1], 0.0)
    left = np.empty((2, len(numbers)))
    rounds, part = np.zeros_like(forms[0]), np.empty(0)
    selection = Selection(predict, W)
    complete = 0  # times that all touches have been made
    for k, count in enumerate(numbers):
        while count > (complete + 1) * designed:
            complete += 1
            rounds = complete * (W.T @ W)
            selection = Selection(predict, W)
        fill(selection, count - complete * designed)
        part = W[selection.chosen]
        M = np.eye(W.shape[1]) + rounds + part.T @ part
        inverse = np.linalg.solve(M, np.concatenate(forms, axis=1))
        R = W.shape[1]
        left[:, k] = [np.sqrt(np.trace(inverse[:, i * R : (i + 1) * R])) for i in range(2)]
    return TouchCurve(name=name, designed=designed, counts=numbers, rms=left[0], rms_user=left[1])


def _form(criterion: Criterion, tip: Array, directions: Array) -> Array:
    """Mean square of the tool point's deviation in the directions that matter, (R, R), mm^2."""
    scaled = (tip * criterion.prior_sd).reshape(-1, len(criterion.prior_sd)) @ directions
    return scaled.T @ scaled / len(tip)
