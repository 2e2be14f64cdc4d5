"""Mistakes in a table of joint readings, or in the description of the arm.

Tracker and reflectors are located again with each possible mistake undone. A mistake that explains
implausible deviations is reported, but not applied.
"""

from collections.abc import Callable, Iterator

import numpy as np

from matstd.importers.arms.table import coupled
from matstd.twin.frames import Array
from matstd.twin.machine import Chain

IMPLAUSIBLE_RMS = 5.0
"""Deviations (mm rms) beyond those of an uncalibrated arm (about 1 mm)."""

EXPLAINED_SHARE = 0.2
"""A mistake explains the deviations if at most this share remains."""


def likely_mistake(
    q: Array, chain: Chain, other: Chain | None, residual: Callable[[Chain, Array], float]
) -> tuple[str, float] | None:
    """The mistake that explains implausible deviations, and the remaining ones, mm rms, or None.

    Args:
        q: Readings, (N, J), rad.
        other: The arm with Denavit and Hartenberg's parameters read in the other convention.
        residual: Deviations of an arm at some readings, mm rms.
    """
    stated = residual(chain, q)
    if stated < IMPLAUSIBLE_RMS:
        return None
    found = [(residual(chain, readings), words) for words, readings in _mistakes(q)]
    if other is not None:
        words = "its parameters are read in the other convention (with or without --modified)"
        found.append((residual(other, q), words))
    best, words = min(found)
    return (words, best) if best < EXPLAINED_SHARE * stated else None


def _mistakes(q: Array) -> Iterator[tuple[str, Array]]:
    """Readings with one mistake undone."""
    for k in range(q.shape[1]):
        turned = q.copy()
        turned[:, k] *= -1.0
        yield f"joint {k + 1} turns the other way", turned
    for k in range(1, q.shape[1]):
        for sign in "+-":
            how = f"J{k + 1}{sign}J{k}"
            words = f"joint {k + 1} counts from the link before joint {k} (--coupled {how})"
            yield words, coupled(q, how)
    yield "joints are in radians ([rad] behind the names of their columns)", np.rad2deg(q)
    yield "joints are in degrees ([deg] behind the names of their columns)", np.deg2rad(q)
