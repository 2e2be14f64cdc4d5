"""Places along the rim of a base, and the choice of those that lie farthest apart."""

from collections.abc import Sequence

import numpy as np

from matstd.artefact.body import Base
from matstd.twin.frames import Array

_AZIMUTHS = 90  # places tried along the rim
_ALL = 4e6  # choices that are all compared
_SAME = 1e-9  # mm


def rim(base: Base, inset: float) -> Array:
    """Places (K, 2) on the outline of the base, moved inwards by `inset`, mm."""
    angle = 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    low, high = np.zeros(_AZIMUTHS), np.full(_AZIMUTHS, 2.0 * max(base.half_size))
    for _ in range(40):
        middle = 0.5 * (low + high)
        points = np.column_stack([middle[:, None] * ray, np.full(_AZIMUTHS, 0.5 * base.thickness)])
        inside = base.body.distance(points) < -min(inset, 0.5 * base.thickness - 1e-6)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return low[:, None] * ray


def spread(options: Sequence[Array]) -> list[Array]:
    """One place from each list, so that the smallest distance between two of them is largest.

    All choices are compared where there are few enough; otherwise it is the best that an exchange
    from several starts finds.
    """
    counts = [len(places) for places in options]
    chosen = _best_of_all(options) if np.prod(counts, dtype=float) <= _ALL else _exchanged(options)
    return [places[i] for places, i in zip(options, chosen, strict=True)]


def _best_of_all(options: Sequence[Array]) -> list[int]:
    counts = [len(places) for places in options]
    smallest = np.full(counts, np.inf)
    for k, places in enumerate(options):
        for other in range(k):
            apart = np.linalg.norm(options[other][:, None] - places, axis=-1)
            shape = [n if i in (other, k) else 1 for i, n in enumerate(counts)]
            smallest = np.minimum(smallest, apart.reshape(shape))
    # places that are as good but for rounding: the first of them on every machine
    first = np.flatnonzero(smallest.ravel() >= smallest.max() - _SAME)[0]
    return [int(i) for i in np.unravel_index(first, counts)]


def _exchanged(options: Sequence[Array]) -> list[int]:
    best: list[int] = []
    best_gap = -1.0
    for first in range(0, len(options[0]), 5):
        chosen = [first]
        for places in options[1:]:
            chosen.append(int(np.argmax(_gaps(places, options, chosen, skip=None))))
        for _ in range(10):
            before = list(chosen)
            for k, places in enumerate(options):
                chosen[k] = int(np.argmax(_gaps(places, options, chosen, skip=k)))
            if chosen == before:
                break
        gap = min(
            float(_gaps(places[[i]], options, chosen, skip=k)[0])
            for k, (places, i) in enumerate(zip(options, chosen, strict=True))
        )
        if gap > best_gap + _SAME:
            best, best_gap = chosen, gap
    return best


def _gaps(
    places: Array, options: Sequence[Array], chosen: Sequence[int], skip: int | None
) -> Array:
    """Distance of each place to the nearest of those chosen, slot `skip` left out, mm."""
    others = [options[k][i] for k, i in enumerate(chosen) if k != skip]
    if not others:
        return np.full(len(places), np.inf)
    gaps: Array = np.min([np.linalg.norm(places - other, axis=1) for other in others], axis=0)
    return gaps
