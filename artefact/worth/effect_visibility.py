"""Which effects of the library some touches could show, if the machine had them.

A signature is what an effect does to the deviations along the normals. What the geometric model
can imitate of it is taken out, by projection with every parameter of the model free; the share of
the length that survives is all that a diagnosis can go by.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.reach import Requests
from matstd.artefact.worth.potential import (
    MIN_VISIBLE_SHARE,
    column_slices,
    library_effects,
    residual_after,
)
from matstd.artefact.worth.touch_criterion import Criterion
from matstd.twin.frames import Array
from matstd.twin.model import Effect, columns


@dataclass(frozen=True, eq=False)
class Visibility:
    """Effects that touches with any points and normals could show."""

    effects: tuple[Effect, ...]  # with a survival above `MIN_VISIBLE_SHARE` in the free touches

    def shown(self, criterion: Criterion, chosen: Requests) -> int:
        """How many of the effects some touches show."""
        return int(np.sum(survival(criterion, list(self.effects), chosen) > MIN_VISIBLE_SHARE))


def visibility(criterion: Criterion, free: Requests) -> Visibility:
    """Effects of the library that could be seen by touches without any artefact in the way.

    Args:
        free: As many random points and normals as an artefact has touches, or more.
    """
    touches = criterion.reach.touches(free)
    tried = library_effects(touches)
    left = survival(criterion, tried, free)
    return Visibility(tuple(e for e, s in zip(tried, left, strict=True) if s > MIN_VISIBLE_SHARE))


def survival(criterion: Criterion, effects: list[Effect], chosen: Requests) -> Array:
    """Share of the length of every effect's signature that the geometric model cannot imitate.

    Args:
        effects: E effects of any numbers of parameters; the shares of their columns are averaged by
            their squares.

    Returns:
        Shape (E,), 0 to 1; 0 for an effect that moves nothing here.
    """
    touches = criterion.reach.touches(chosen)
    C = columns(effects, touches)
    left = residual_after(C, criterion.whitened(chosen))
    out = np.zeros(len(effects))
    for i, mine in enumerate(column_slices(effects)):
        whole = float(np.sum(C[:, mine] ** 2))
        if whole > 0.0:
            out[i] = np.sqrt(np.sum(left[:, mine] ** 2) / whole)
    return out
