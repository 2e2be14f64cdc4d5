"""Whether the wanted patches stand side by side on the blank, before anything is chosen.

As many places are tried as the choice has later, with random shapes of their own: what does not fit
among these is not found later either, but for luck.
"""

from dataclasses import dataclass

import numpy as np

from artefact.layout import Blank, Site, most_side_by_side, neighbour_gaps, random_sites
from artefact.reach import ProbeReach, reach_of, spread_poses
from twin.frames import Array

_POSES = 20  # table poses at which a place has to be reached once
_HALVINGS = 5  # of the gap, until the one that would do is known to a thirtieth
_STARTS = 80  # of a search for it


@dataclass(frozen=True, eq=False)
class Room:
    """The most patches that were found to stand side by side.

    Attributes:
        sites: Where they stand.
        tried: Number of places that were tried, all of them within reach.
        gap: Largest gap, mm, with which as many as wanted would stand, rounded down; 0 where none
            was found.
    """

    sites: tuple[Site, ...]
    tried: int
    gap: float


def room_for(
    patches: int, reach: ProbeReach, blank: Blank, poses: Array, count: int, seed: int
) -> Room:
    """Places that stand side by side, as many as wanted or the most that are found.

    Args:
        patches: Number wanted.
        reach: Machine, probe, set-up.
        blank: With ball and gap.
        poses: Table poses that can be used, (K, R), rad.
        count: Number of random places.
        seed: Of them.
    """
    sites = random_sites(blank, count, np.random.default_rng(seed))
    frames = np.stack([site.T_artefact_patch for site in sites])
    tried = reach_of(reach, frames[:, :3, 3], frames[:, :3, 2], spread_poses(poses, _POSES))
    sites = [sites[i] for i in np.flatnonzero(tried.reached.any(axis=1))]
    gaps, wanted = neighbour_gaps(sites, blank), blank.limits.gap
    found = most_side_by_side(gaps >= wanted, patches)
    gap = wanted if len(found) >= patches else _gap_that_does(gaps, wanted, patches)
    return Room(tuple(sites[i] for i in found), len(sites), gap)


def _gap_that_does(gaps: Array, wanted: float, patches: int) -> float:
    low, high = 0.0, wanted
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        fits = len(most_side_by_side(gaps >= middle, patches, _STARTS)) >= patches
        low, high = (middle, high) if fits else (low, middle)
    return float(np.floor(10.0 * low) / 10.0)
