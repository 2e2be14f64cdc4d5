"""Which sites of a blank can stand beside each other, and how many of them at most."""

import numpy as np
from numpy.typing import NDArray

from artefact.layout.sites import Blank, Site, patch_of_site
from twin.frames import Array

_SPARE = 2.0  # mm beyond the gap: the finished standard is measured on its exact bodies


def neighbour_gaps(sites: list[Site], blank: Blank) -> Array:
    """Gap that the ball of the blank's limits would leave between every two sites, (S, S), mm.

    The ball must have room over every face before the other column, taken as a box as tall as the
    tallest shape. Columns may grow together behind the faces. The finished standard is measured on
    its exact bodies afterwards.

    Args:
        sites: S sites.
        blank: Base and ball radius.

    Returns:
        Symmetric, negative where the ball does not pass; minus infinity of a site with itself.
    """
    radius = blank.limits.ball_radius
    faces = np.stack([_face(site, radius) for site in sites])  # (S, K, 3)
    out = np.full((len(sites), len(sites)), np.inf)
    for j, site in enumerate(sites):
        T = site.T_artefact_patch
        local = (faces - T[:3, 3]) @ T[:3, :3]
        top, depth = float(site.heights.max()), patch_of_site("trial", site, blank.base).depth
        middle = np.array([0.0, 0.0, 0.5 * (top - depth)])
        half = np.array([*site.half_size, 0.5 * (top + depth)])
        beyond = np.abs(local - middle) - half
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        gap = (outside + np.minimum(beyond.max(axis=-1), 0.0)).min(axis=1)
        out[:, j] = np.minimum(out[:, j], gap)
        out[j, :] = np.minimum(out[j, :], gap)
    out -= 2.0 * radius + _SPARE
    np.fill_diagonal(out, -np.inf)
    return out


def most_side_by_side(fits: NDArray[np.bool_], wanted: int, starts: int | None = None) -> list[int]:
    """Sites all of which can stand beside each other: as many as wanted, else the most found.

    From sociable sites in turn, the next is always the one that leaves most others free: a lower
    bound of the largest clique, which nobody can afford.

    Args:
        fits: Which sites can stand beside each other, (S, S).
        wanted: With so many the search ends.
        starts: Most sociable sites from which it begins, None for all: 80 of 400 find as many in
            ten of twelve blanks, and one less in the others.
    """
    most: list[int] = []
    for first in np.argsort(-fits.sum(axis=1), kind="stable")[:starts]:
        chosen, free = [int(first)], fits[first].copy()
        while free.any() and len(chosen) < wanted:
            open_sites = np.flatnonzero(free)
            left = fits[np.ix_(open_sites, open_sites)].sum(axis=1)
            chosen.append(int(open_sites[np.argmax(left)]))
            free &= fits[chosen[-1]]
        if len(chosen) > len(most):
            most = chosen
        if len(most) >= wanted:
            break
    return most


def _face(site: Site, radius: float) -> Array:
    """Ball centres over a coarse grid of the face at the mean height, artefact frame, (25, 3)."""
    grid = np.linspace(-1.0, 1.0, 5)
    u, v = np.meshgrid(site.half_size[0] * grid, site.half_size[1] * grid, indexing="ij")
    local = np.stack([u.ravel(), v.ravel(), np.full(u.size, radius)], axis=-1)
    T = site.T_artefact_patch
    return local @ T[:3, :3].T + T[:3, 3]
