"""Potential terms: effects of the library that a machine may have or not, as columns of a design.

Each effect's signature is brought to size one over free touches, freed of what the geometric model
can imitate of it, and given a small prior standard deviation: touches are then worth something for
showing it, and the less the better it is shown already.

Reference:
    DuMouchel and Jones, Technometrics 36 (1994) 37.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import block_diag

from matstd.information.identifiability import column_lengths
from matstd.twin.frames import Array
from matstd.twin.library import proposals
from matstd.twin.model import Effect, columns, is_tunable
from matstd.twin.record import Touches

MIN_VISIBLE_SHARE = 0.3  # share of the length of a signature that must survive the geometric model
_MIN_FREE_SURVIVAL = 0.1  # share that survives free touches, below which no design helps
_OF_FEATURES = ("artefact-form",)  # belong to one feature of one artefact: nothing to compare
_RANK_TOLERANCE = 1e-8  # relative singular value below which a direction is rounding


def library_effects(touches: Touches) -> list[Effect]:
    """Effects of the library that some touches could be asked about, their inner parameters set."""
    return [
        _with_middle_values(effect, touches)
        for effect in proposals(touches)
        if effect.name.split("(")[0] not in _OF_FEATURES
    ]


def _with_middle_values(effect: Effect, touches: Touches) -> Effect:
    """An effect with its inner parameters in the middle of their grids."""
    if not is_tunable(effect):
        return effect
    return effect.tuned(*(inner.grid[len(inner.grid) // 2] for inner in effect.inner(touches)))


def column_slices(effects: list[Effect]) -> list[slice]:
    """Columns of every effect among those of all."""
    edges = np.cumsum([0, *(len(e.parameters) for e in effects)]).tolist()
    return [slice(a, b) for a, b in pairwise(edges)]


def residual_after(C: Array, W: Array) -> Array:
    """Signatures (N, C) without what the rows of a model (N, P) can imitate of them."""
    U, s, _ = np.linalg.svd(W / column_lengths(W), full_matrices=False)
    U = U[:, s > _RANK_TOLERANCE * s[0]]
    return C - U @ (U.T @ C)


@dataclass(frozen=True, eq=False)
class Potential:
    """Potential terms of a design."""

    effects: tuple[Effect, ...]
    names: tuple[str, ...]  # effect of every term, (Q,)
    mix: Array  # terms as combinations of the effects' columns, (C, Q)
    imitation: Array  # what the model's rows imitate of them over free touches, (R, Q)

    def __len__(self) -> int:
        return len(self.names)

    def rows(self, touches: Touches, reduced: Array) -> Array:
        """Columns of the potential terms (N, Q) at touches with these rows of the model (N, R)."""
        signatures = columns(list(self.effects), touches) @ self.mix
        return signatures - reduced @ self.imitation


def potential(touches: Touches, reduced: Array, count: int) -> Potential:
    """Potential terms of a machine and a model.

    The prior standard deviation is such that `count` touches in which the share `MIN_VISIBLE_SHARE`
    of the signature survives halve its variance.

    Args:
        touches: Free touches: points anywhere, any normals.
        reduced: Rows of the model at them in the directions that matter, whitened, (N, R).
    """
    tried = library_effects(touches)
    C = columns(tried, touches)
    left, n = residual_after(C, reduced), len(touches)
    effects, names, mixes = [], [], []
    for effect, mine in zip(tried, column_slices(tried), strict=True):
        whole = float(np.sum(C[:, mine] ** 2))
        if whole <= 0.0:
            continue
        _, s, Vt = np.linalg.svd(left[:, mine] * np.sqrt(n / whole), full_matrices=False)
        if np.sum(s**2) / n < _MIN_FREE_SURVIVAL**2:
            continue
        effects.append(effect)
        names.append(effect.name)
        strongest = Vt[:1].T * np.sqrt(n / whole * np.sum(s**2)) / s[0]  # with the size of all
        mixes.append(strongest)
    sd = 1.0 / (MIN_VISIBLE_SHARE * np.sqrt(count))
    mix = sd * block_diag(np.zeros((0, 0)), *mixes)  # the empty one for no effects
    signatures = columns(effects, touches) @ mix
    length = column_lengths(reduced)
    imitation = np.linalg.lstsq(reduced / length, signatures, rcond=_RANK_TOLERANCE)[0]
    return Potential(tuple(effects), tuple(names), mix, imitation / length[:, None])
