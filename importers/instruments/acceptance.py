"""Figures of a test of one axis as its standard defines them, from the readings alone."""

from dataclasses import dataclass

import numpy as np

from matstd.importers.instruments.positioning import PositioningTest


@dataclass(frozen=True)
class PositioningFigures:
    """Figures of ISO 230-2 of one axis, mm or rad."""

    reversal: float  # B, the largest reversal error of a target, with its sign
    mean_reversal: float  # mean of the reversal errors of all targets
    mean_range: float  # M, range of the mean bidirectional deviations
    systematic: float  # E, bidirectional systematic deviation
    repeatability: float  # R, bidirectional repeatability (k = 2)
    accuracy: float  # A, bidirectional accuracy (k = 2)


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
        [test.deviation[(targets == t) & (test.direction * way > 0)] for way in (1, -1)]
        for t in np.unique(targets)
    ]
    pairs = [(up, down) for up, down in groups if len(up) >= 2 and len(down) >= 2]
    if len(pairs) < 2:
        return None
    mean = np.array([[up.mean(), down.mean()] for up, down in pairs])
    s = np.array([[up.std(ddof=1), down.std(ddof=1)] for up, down in pairs])
    reversal = mean[:, 0] - mean[:, 1]
    repeatability = np.maximum(2.0 * s.sum(axis=1) + np.abs(reversal), 4.0 * s.max(axis=1))
    return PositioningFigures(
        reversal=float(reversal[np.argmax(np.abs(reversal))]),
        mean_reversal=float(reversal.mean()),
        mean_range=float(np.ptp(mean.mean(axis=1))),
        systematic=float(np.ptp(mean)),
        repeatability=float(repeatability.max()),
        accuracy=float((mean + 2.0 * s).max() - (mean - 2.0 * s).min()),
    )


def component_range(test: PositioningTest) -> float:
    """Peak to valley of the mean curve of a component error, mm or rad.

    That of a straightness is about its line of least squares.
    """
    targets, of = np.unique(np.round(test.target, 6), return_inverse=True)
    mean = np.bincount(of.ravel(), test.deviation) / np.bincount(of.ravel())
    if not test.is_angle:
        mean = mean - np.polyval(np.polyfit(targets, mean, 1), targets)
    return float(np.ptp(mean))
