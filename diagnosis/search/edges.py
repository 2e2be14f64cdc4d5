"""Gross errors that a slip may explain: all touches on one side of it.

A standard that slips two touches before the end of its set-up leaves two touches that no other
agrees with. As accidents they would lie anywhere; where that is too unlikely they are put back into
the fit, the slip is offered beside all other effects, and the test for gross errors comes again.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.model import inner_values
from matstd.twin.record import Touches

MAX_EDGE_LENGTH = 8
"""Touches from an edge that are looked at; a slip farther inside is a crowd to begin with."""

MIN_EDGE_ERRORS = 2  # gross errors at an edge that may be no accidents


def unexplained_near_slip(
    touches: Touches, gross: GrossErrors, effects: Sequence[ScaledEffect]
) -> Mask:
    """Gross errors that a slip may explain, (N,).

    At the edges of a set-up those that so few accidents would hardly ever form; at the instant of a
    slip that was found, all that adjoin it, since the instant rests upon the touches without them.
    """
    instants = np.array(
        [
            value
            for scaled in effects
            for inner, value in inner_values(scaled.effect, touches)
            if inner.acts == "at an instant" and not inner.clock
        ]
    )
    out = np.zeros(len(touches), dtype=bool)
    bad = gross.rows
    edges = list(_edges(touches, instants))
    for rows, is_instant in edges:
        near = rows[:MAX_EDGE_LENGTH]
        if is_instant:
            stop = int(np.argmin(np.append(bad[near], False)))
            out[near[:stop]] = True
            continue
        count = np.cumsum(bad[near])
        for k in np.flatnonzero(bad[near] & (count >= MIN_EDGE_ERRORS)):
            p = _by_chance(len(touches), int(bad.sum()), int(k) + 1, int(count[k]))
            if p * len(edges) * MAX_EDGE_LENGTH < POLICY.false_alarm:
                out[near[: k + 1]] |= bad[near[: k + 1]]
    return out


def without(gross: GrossErrors, rows: Mask) -> GrossErrors:
    """Gross errors less some rows."""
    return replace(gross, rows=gross.rows & ~rows)


def _edges(touches: Touches, instants: Array) -> Iterator[tuple[IntArray, bool]]:
    """Rows from every edge inwards, and whether the edge is an instant inside a set-up."""
    for s in np.unique(touches.setup):
        rows = np.flatnonzero(touches.setup == s)
        rows = rows[np.argsort(touches.time[rows], kind="stable")]
        inside = touches.time[rows]
        cuts = [c for c in np.searchsorted(inside, np.sort(instants)) if 0 < c < len(rows)]
        yield rows, False
        yield rows[::-1], False
        for cut in cuts:
            yield rows[cut:], True
            yield rows[:cut][::-1], True


def _by_chance(touches: int, gross: int, length: int, found: int) -> float:
    """Probability that of some gross errors anywhere so many or more lie in one short row.

    Example:
        >>> round(_by_chance(4, 2, 2, 2) * 6, 9)
        1.0
    """
    from scipy.stats import hypergeom  # half a second, and few runs need it

    return float(hypergeom.sf(found - 1, touches, gross, length))
