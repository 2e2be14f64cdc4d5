"""Largest sets of bodies that fit beside each other: a greedy search for a large clique."""

from collections.abc import Sequence

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch
from matstd.artefact.layout.blank import Blank
from matstd.artefact.layout.upright import balls_fit, faces_beside, faces_fit, holes_on
from matstd.twin.frames import IntArray, Mask


def most_side_by_side(
    fits: Mask, *wanted: int, kind: IntArray | None = None, starts: int | None = None
) -> list[int]:
    """Sites that fit beside each other: the number wanted, or the largest set found.

    Starting from each site in turn, the next site is the one that leaves most others free. The
    result is a lower bound of the largest clique, which takes too long to find.

    Args:
        fits: Which sites fit beside each other, (S, S).
        wanted: Number of each kind; the search ends when all are found.
        kind: Of every site, (S,); the first kind is placed first. None for one kind.
        starts: Number of starting sites, those with most neighbours first; None for all. 80 of 400
            find the same number on ten of twelve blanks, one less on the others.
    """
    kinds = np.zeros(len(fits), dtype=np.int64) if kind is None else kind
    most: list[int] = []
    sociable = np.argsort(-fits.sum(axis=1), kind="stable")
    for first in sociable[kinds[sociable] == 0][:starts]:
        chosen, free = [int(first)], fits[first].copy()
        for one, count in enumerate(wanted):
            while np.sum(kinds[chosen] == one) < count and (free & (kinds == one)).any():
                open_sites = np.flatnonzero(free & (kinds == one))
                left = fits[open_sites][:, free].sum(axis=1)
                chosen.append(int(open_sites[np.argmax(left)]))
                free &= fits[chosen[-1]]
        if len(chosen) > len(most):
            most = chosen
        if len(most) >= sum(wanted):
            break
    return most


def beside_balls(
    faces: Sequence[FreeformPatch],
    balls: Sequence[DatumSphere],
    wanted: tuple[int, int],
    blank: Blank,
    seen: Mask | None = None,
) -> tuple[list[int], list[int]]:
    """Faces and balls that fit on a blank together: the number wanted, or the largest set found.

    Args:
        blank: With its limits; screws are placed as without balls.
        seen: Pairs of faces that can both be probed, (F, F); None for all.
    """
    kind = np.repeat([0, 1], [len(faces), len(balls)])
    fits = np.zeros((len(kind), len(kind)), dtype=bool)
    n = len(faces)
    fits[:n, :n] = faces_fit(faces, holes_on(blank), blank.limits)
    if seen is not None:
        fits[:n, :n] &= seen
    fits[n:, n:] = balls_fit(balls, blank)
    fits[:n, n:] = np.array([faces_beside(faces, [ball], blank) for ball in balls]).reshape(-1, n).T
    fits[n:, :n] = fits[:n, n:].T
    found = most_side_by_side(fits, *wanted, kind=kind)
    return [i for i in found if i < n], [i - n for i in found if i >= n]
