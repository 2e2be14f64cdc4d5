"""What a table of joint readings and a description of the arm may disagree about.

A tracker that stands anywhere and reflectors that sit anywhere are solved for with every mistake
undone in turn: what makes absurd deviations ordinary is reported, and never applied.
"""

from collections.abc import Callable, Iterator

import numpy as np

from matstd.importers.arms.table import coupled
from matstd.twin.frames import Array
from matstd.twin.machine import Chain

ABSURD = 5.0
"""Deviations (mm rms) beyond what an arm as it comes from its maker shows (about 1 mm)."""

BETTER = 0.2
"""Share of the deviations that may be left where a mistake explains them."""


def likely_mistake(
    q: Array, chain: Chain, other: Chain | None, left: Callable[[Chain, Array], float]
) -> tuple[str, float] | None:
    """The mistake that explains absurd deviations, and what it leaves, mm rms; None for none.

    Args:
        q: Readings, (N, J), rad.
        other: The arm with Denavit and Hartenberg's parameters read in the other convention.
        left: Deviations that an arm and readings leave, mm rms.
    """
    stated = left(chain, q)
    if stated < ABSURD:
        return None
    found = [(left(chain, readings), words) for words, readings in _mistakes(q)]
    if other is not None:
        words = "its parameters are read in the other convention (with or without --modified)"
        found.append((left(other, q), words))
    best, words = min(found)
    return (words, best) if best < BETTER * stated else None


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
