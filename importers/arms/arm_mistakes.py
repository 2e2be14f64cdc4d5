"""What a table of joint readings and a description of the arm may disagree about.

A tracker that stands anywhere and reflectors that sit anywhere are solved for with every mistake
undone in turn: what makes absurd deviations ordinary is told, and never applied.
"""

import re
from collections.abc import Callable, Iterator

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.machine import Chain

ABSURD = 5.0
"""Deviations (mm rms) beyond what an arm as it comes from its maker shows (about 1 mm)."""

BETTER = 0.2
"""Share of the deviations that may be left where a mistake explains them."""

_COUPLED = re.compile(r"J?(\d)\s*([+-])\s*J?(\d)\Z", re.IGNORECASE)


def coupled(q: Array, how: str) -> Array:
    """Readings of joints one of which counts from another one's link, (N, J).

    On arms with a parallel linkage, and in the readings of some controls without one, joint 3 is
    told from the horizontal: its angle against link 2 is J3 + J2 (or J3 - J2).

    Args:
        q: Readings as they stand, (N, J), rad.
        how: `J3+J2`.

    Raises:
        DesignError: Joints that are not there.
    """
    match = _COUPLED.match(how.strip())
    joint, other = (int(match[1]) - 1, int(match[3]) - 1) if match else (-1, -1)
    if match is None or not (0 <= joint < q.shape[1] and 0 <= other < q.shape[1]):
        raise DesignError(f"--coupled {how}: expected two of {q.shape[1]} joints such as J3+J2")
    out = q.copy()
    out[:, joint] += (1.0 if match[2] == "+" else -1.0) * q[:, other]
    return out


def likely_mistake(
    q: Array, chain: Chain, other: Chain | None, left: Callable[[Chain, Array], float]
) -> tuple[str, float] | None:
    """The mistake that explains absurd deviations, and what it leaves, mm rms; None for none.

    Args:
        q: Readings, (N, J), rad.
        chain: The arm.
        other: The arm with Denavit and Hartenberg's parameters read in the other convention.
        left: Deviations that an arm and readings leave, mm rms.
    """
    stated = left(chain, q)
    if stated < ABSURD:
        return None
    found = [(words, left(chain, readings)) for words, readings in _mistakes(q)]
    if other is not None:
        found.append(
            (
                "its parameters are read in the other convention (with or without --modified)",
                left(other, q),
            )
        )
    words, best = min(found, key=lambda pair: pair[1])
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
