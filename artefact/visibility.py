"""Which effects of the library some touches could show, if the machine had them.

A signature is what an effect does to the deviations along the normals. What the geometric model
can imitate of it is taken out, by projection with every parameter of the model free; the share of
the length that survives is all that a diagnosis can go by.
"""

from dataclasses import dataclass

import numpy as np

from artefact.criterion import Criterion
from artefact.touchable import Requests
from twin.effect import Effect, Tunable
from twin.frames import Array
from twin.library import proposals
from twin.model import columns
from twin.touches import Touches

VISIBLE = 0.3
"""Share of the length of a signature that must survive."""

_OF_FEATURES = ("artefact-form",)  # belong to one feature of one artefact: nothing to compare
_DEPENDENT = 1e-8  # relative singular value below which a direction is rounding


@dataclass(frozen=True, eq=False)
class Visibility:
    """Effects that touches with any points and normals could show.

    Attributes:
        effects: With a survival above `VISIBLE` in the free touches.
        hidden: Effects that no touches could tell from the geometric model.
    """

    effects: tuple[Effect, ...]
    hidden: tuple[Effect, ...]

    def shown(self, aim: Criterion, chosen: Requests) -> int:
        """How many of the effects some touches show."""
        return int(np.sum(survival(aim, list(self.effects), chosen) > VISIBLE))


def visibility(aim: Criterion, free: Requests) -> Visibility:
    """Effects of the library that could be seen by touches without any artefact in the way.

    Args:
        aim: Machine and geometric model.
        free: As many random points and normals as an artefact has touches, or more.
    """
    touches = aim.probing.touches(free)
    tried = [
        _tuned(effect, touches)
        for effect in proposals(touches)
        if effect.name.split("(")[0] not in _OF_FEATURES
    ]
    left = survival(aim, tried, free)
    return Visibility(
        tuple(e for e, s in zip(tried, left, strict=True) if s > VISIBLE),
        tuple(e for e, s in zip(tried, left, strict=True) if s <= VISIBLE),
    )


def _tuned(effect: Effect, touches: Touches) -> Effect:
    """An effect with its inner parameters in the middle of their grids."""
    if not isinstance(effect, Tunable):
        return effect
    return effect.tuned(*(inner.grid[len(inner.grid) // 2] for inner in effect.inner(touches)))


def survival(aim: Criterion, effects: list[Effect], chosen: Requests) -> Array:
    """Share of the length of every effect's signature that the geometric model cannot imitate.

    Args:
        aim: Machine and geometric model.
        effects: E effects of any numbers of parameters; the shares of their columns are averaged by
            their squares.
        chosen: The touches.

    Returns:
        Shape (E,), 0 to 1; 0 for an effect that moves nothing here.
    """
    touches = aim.probing.touches(chosen)
    C = columns(effects, touches)
    W = aim.whitened(chosen)
    U, s, _ = np.linalg.svd(W / np.maximum(np.linalg.norm(W, axis=0), 1e-300), full_matrices=False)
    U = U[:, s > _DEPENDENT * s[0]]
    left = C - U @ (U.T @ C)
    out, start = np.zeros(len(effects)), 0
    for i, effect in enumerate(effects):
        mine = slice(start, start + len(effect.parameters))
        whole = float(np.sum(C[:, mine] ** 2))
        if whole > 0.0:
            out[i] = np.sqrt(np.sum(left[:, mine] ** 2) / whole)
        start = mine.stop
    return out
