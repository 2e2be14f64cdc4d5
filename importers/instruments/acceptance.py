"""Figures of a positioning test as its standard defines them, straight from the readings."""

from dataclasses import dataclass

import numpy as np

from matstd.importers.instruments.positioning import PositioningTest
from matstd.twin.frames import Array


@dataclass(frozen=True)
class PositioningFigures:
    """Figures of ISO 230-2 of one axis, mm or rad.

    Attributes:
        reversal: B, the largest reversal error of a target, with its sign.
        mean_reversal: Mean of the reversal errors of all targets.
        mean_range: M, range of the mean bidirectional deviations.
        systematic: E, bidirectional systematic deviation.
        repeatability: R, bidirectional repeatability (k = 2).
        accuracy: A, bidirectional accuracy (k = 2).
    """

    reversal: float
    mean_reversal: float
    mean_range: float
    systematic: float
    repeatability: float
    accuracy: float


def positioning_figures(test: PositioningTest) -> PositioningFigures | None:
    """Figures of a bidirectional positioning test.

    With x the deviations of target i, mean xi and estimator si of every direction::

        Bi = xi_up - xi_down        B = the Bi of the largest size
        M = max (xi_up + xi_down)/2 - min (...)      E = max xi - min xi over both directions
        Ri = max(2 si_up + 2 si_down + |Bi|, 4 si_up, 4 si_down)      R = max Ri
        A = max (xi + 2 si) - min (xi - 2 si) over both directions

    Returns:
        None unless at least two targets were reached from both sides in two cycles and more.

    Reference:
        ISO 230-2:2014, clause 3 (which asks for five cycles).
    """
    targets = np.round(test.target, 9)
    groups = [
        (test.deviation[(targets == t) & (test.direction > 0)],
         test.deviation[(targets == t) & (test.direction < 0)])
        for t in np.unique(targets)
    ]  # fmt: skip
    pairs = [(u, d) for u, d in groups if len(u) >= 2 and len(d) >= 2]
    if len(pairs) < 2:
        return None
    mean = np.array([[u.mean(), d.mean()] for u, d in pairs])
    s = np.array([[u.std(ddof=1), d.std(ddof=1)] for u, d in pairs])
    reversal = mean[:, 0] - mean[:, 1]
    both = mean.mean(axis=1)
    repeatability = np.maximum(2.0 * s.sum(axis=1) + np.abs(reversal), 4.0 * s.max(axis=1))
    return PositioningFigures(
        reversal=float(reversal[np.argmax(np.abs(reversal))]),
        mean_reversal=float(reversal.mean()),
        mean_range=_range(both, both),
        systematic=_range(mean, mean),
        repeatability=float(repeatability.max()),
        accuracy=_range(mean - 2.0 * s, mean + 2.0 * s),
    )


def _range(low: Array, high: Array) -> float:
    return float(high.max() - low.min())
