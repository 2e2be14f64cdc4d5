"""Whether the library explains what a law does: its effects, weighed by the same evidence."""

from typing import NamedTuple

import numpy as np

from matstd.diagnosis.evidence import tuned_variants
from matstd.diagnosis.laws.space import MIN_OWN, Space
from matstd.twin.library import proposals
from matstd.twin.model import Effect, columns, inner_values, traits
from matstd.twin.record import Touches

MOST_VARIANTS, WHOLE = 40, 3
"""Points of the grid of every effect that are tried, and the best effects that are tried at all of
theirs: of 40 instants the nearest to that of a slip lost 37 of 116 of its evidence."""

CHARGE = 5.0  # log evidence that choosing one of some hundred effects costs


class LibraryEffect(NamedTuple):
    """The effect of the library that explains most of what a model leaves."""

    effect: Effect
    score: float  # log evidence, parameters and the choice charged


def nearest_of_library(space: Space) -> LibraryEffect | None:
    """The best effect of the library beside the laws; None where it proposes none.

    Tables and effects that could imitate any other are left out: they are curves, too.
    """
    found = []
    for effect in proposals(space.touches):
        own = traits(effect)
        if not own.is_table and not own.is_shrunk:
            variants = tuned_variants(effect, space.touches)
            step = max(1, -(-len(variants) // MOST_VARIANTS))
            found.append((_best(space, variants[::step]), variants))
    found.sort(key=lambda one: -one[0].score)
    whole = [_best(space, variants) for _, variants in found[:WHOLE]]
    return max(whole, key=lambda one: one.score, default=None)


def charge_of(
    effect: Effect, touches: Touches, freedom: float, determined: float | None = None
) -> float:
    """Log evidence that an effect costs: its parameters by Schwarz's criterion, and its choice.

    Args:
        determined: How many of its parameters a run determines; all without it.
    """
    count = len(effect.parameters) if determined is None else determined
    count += len(inner_values(effect, touches))
    return 0.5 * count * float(np.log(max(freedom, 2.0))) + CHARGE


def _best(space: Space, variants: list[Effect]) -> LibraryEffect:
    """The variant that explains most."""
    k = len(variants[0].parameters)
    C = space.white(columns(variants, space.touches))
    size = np.linalg.norm(C, axis=0)
    C = C / np.maximum(size, 1e-300)
    U = space.basis.T @ C
    b = (C.T @ space.r).reshape(-1, k)
    blocks, own = (A.reshape(len(A), len(variants), k) for A in (C, U))
    G = np.einsum("nga,ngb->gab", blocks, blocks) - np.einsum("nga,ngb->gab", own, own)
    values, vectors = np.linalg.eigh(G)
    along = np.einsum("gab,ga->gb", vectors, b) ** 2
    seen = values > MIN_OWN
    explained = np.where(seen, along / np.where(seen, values, 1.0), 0.0).sum(axis=1)
    which = int(np.argmax(explained))
    charge = charge_of(variants[which], space.touches, space.freedom)
    return LibraryEffect(variants[which], float(space.gained(explained[which])) - charge)
