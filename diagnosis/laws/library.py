"""Whether the library explains what a law does: its effects, weighed by the same evidence."""

from typing import NamedTuple

import numpy as np

from matstd.diagnosis.evidence import tuned_variants
from matstd.diagnosis.laws.space import MIN_OWN, Space
from matstd.twin.library import proposals
from matstd.twin.model import Effect, columns, inner_values, traits
from matstd.twin.record import Touches

MOST_VARIANTS = 40  # points of the grid of one effect: a law that lies between them loses little
CHARGE = 5.0  # log evidence that choosing one of some hundred effects costs


class LibraryEffect(NamedTuple):
    """The effect of the library that explains most of what a model leaves."""

    effect: Effect
    score: float  # log evidence, parameters and the choice charged


def nearest_of_library(space: Space) -> LibraryEffect | None:
    """The best effect of the library beside the laws; None where it proposes none.

    Tables and effects that could imitate any other are left out: they are curves, too.
    """
    best: LibraryEffect | None = None
    for effect in proposals(space.touches):
        own = traits(effect)
        if own.is_table or own.is_shrunk:
            continue
        variants = tuned_variants(effect, space.touches)
        variants = variants[:: max(1, -(-len(variants) // MOST_VARIANTS))]
        explained, which = _best(space, variants)
        charge = charge_of(variants[0], space.touches, space.freedom)
        score = float(space.gained(np.array(explained))) - charge
        if best is None or score > best.score:
            best = LibraryEffect(variants[which], score)
    return best


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


def _best(space: Space, variants: list[Effect]) -> tuple[float, int]:
    """Most squared residual that a variant explains, and its number."""
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
    return float(explained[which]), which
