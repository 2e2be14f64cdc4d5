"""What evenly spaced targets of a turn cannot show of a rotary axis."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array
from matstd.twin.model import original_of, traits

MAX_UNEVENNESS = 2e-3  # largest distance of a target from an even spacing, rad: a tenth of a degree
MIN_TARGETS = 3  # targets of a turn up to which no harmonics are distinguished


@dataclass(frozen=True, slots=True)
class HarmonicsAlike:
    """Harmonics of a turn that read as a found one at evenly spaced targets, the lowest first."""

    axis: str
    targets: int
    found: int  # 0 of a curve, whose harmonics are many
    others: tuple[int, ...]


def harmonics_alike(fit: Fit) -> list[HarmonicsAlike]:
    """Harmonics that n even targets cannot distinguish from a found one k: every m n ± k.

    Of a curve, which may be any of them, the number of targets alone.
    """
    out: list[HarmonicsAlike] = []
    for effect in fit.model.effects:
        own = traits(original_of(effect) if traits(effect).repetition > 1 else effect)
        if own.harmonic is None or own.symbol is None:
            continue
        axis, k = own.symbol.link, round(own.harmonic)
        if axis not in fit.run.touches.chain.rotary_axes:
            continue
        n = targets_a_turn(fit.run.touches.reading(axis)[fit.used])
        around = {m * n + side * k for m in (1, 2) for side in (-1, 1)} if k else set()
        others = tuple(h for h in sorted(around - {k}) if h > 0)
        if n:
            out.append(HarmonicsAlike(axis, n, k, others))
    return list(dict.fromkeys(out))


def targets_a_turn(q: Array) -> int:
    """Number of targets that stand evenly over a whole turn, rad; 0 where they do not.

    Example:
        >>> targets_a_turn(np.radians([0.0, 90.0, 180.0, 270.0, 360.0])), targets_a_turn(np.ones(3))
        (4, 0)
    """
    turn = 2.0 * np.pi
    places = np.unique(np.round(np.mod(q + MAX_UNEVENNESS, turn), 4))
    n = len(places)
    off = places - places[0] - turn / n * np.arange(n)
    return n if n > MIN_TARGETS and np.abs(off).max() < MAX_UNEVENNESS else 0
