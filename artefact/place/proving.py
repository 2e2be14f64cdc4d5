"""Touches that prove a model: on freeform faces, which had no part in identifying it."""

import numpy as np

from artefact.reach import Mask, Requests, joined
from artefact.worth import Criterion
from information.selection import Quota, Selection, fill
from twin.errors import NotReachable

_CROWDED = 1.5  # even shares of the touches that one feature may have


def proving_touches(
    criterion: Criterion, tried: Requests, identifying: Requests, count: int
) -> Requests:
    """Of touches that can be made those that tell most beside the ones that identify.

    Args:
        criterion: On the standard, faces and balls.
        tried: Touches to choose from, none of which identifies.
        identifying: Touches that do.
        count: How many prove.

    Raises:
        NotReachable: Too few can be made.
    """
    if len(tried) < count:
        raise NotReachable(f"{len(tried)} touches can be made for the proof, {count} are wanted")
    both = joined([identifying, tried])
    start = np.arange(len(both)) < len(identifying)
    selection = Selection(criterion.objective, criterion.rows(both), start)
    fill(selection, len(identifying) + count, (_quota(both, start, count),))
    return both[selection.chosen & ~start]


def _quota(both: Requests, start: Mask, count: int) -> Quota:
    """No feature has much more than its even share; what identifies is a kind of its own."""
    names, kind = np.unique(np.where(start, "", both.feature), return_inverse=True)
    there = np.bincount(kind[~start], minlength=len(names))
    most = int(np.ceil(_CROWDED * count / max(len(names) - 1, 1)))
    while np.minimum(there, most).sum() < count:
        most += 1
    return Quota(kind.reshape(-1), np.where(names == "", int(start.sum()), most))
