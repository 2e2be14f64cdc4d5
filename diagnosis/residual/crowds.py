"""Do gross errors lie together? Accidents do not; a cause of its own does."""

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import gammainc

from matstd.diagnosis.regression import shots
from matstd.diagnosis.residual.patterns import pairs, variables
from matstd.twin.frames import Mask
from matstd.twin.record import Touches

NEIGHBOURS = 5  # neighbours of a touch that are looked at
MIN_GROSS = 3  # fewer gross errors than this make no crowd


def crowds(touches: Touches, allowed: Mask, gross: Mask) -> dict[tuple[str, str], float]:
    """Probability, pair of variables by pair, that gross errors lie so close to one another.

    Counted are the pairs of gross errors that are among each other's nearest touches; if every
    touch is as likely a gross error as every other, that number is nearly Poisson distributed with
    the mean ``links g (g - 1) / (n (n - 1))``. Coordinates of one shot, which are left out
    together, count once. Not corrected for the number of pairs.

    Args:
        allowed: Those that could have been found out, (N,).
        gross: Those that were, (N,).
    """
    shot = shots(touches)
    rows = np.flatnonzero(allowed)
    rows = rows[np.unique(shot[rows], return_index=True)[1]]
    bad = np.isin(shot[rows], shot[gross])
    n, g = len(rows), int(bad.sum())
    known = variables(touches)
    out: dict[tuple[str, str], float] = {}
    if g < MIN_GROSS or n <= 2 * NEIGHBOURS:
        return out
    for names in pairs(touches, known):
        place = np.column_stack([known[name][rows] for name in names])
        place = (place - place.min(axis=0)) / np.ptp(place, axis=0)
        near = cKDTree(place).query(place, k=NEIGHBOURS + 1)[1]
        own = np.repeat(np.arange(n), NEIGHBOURS + 1)
        # a link either way is one number: a unique column is found ten times sooner than a pair
        links = np.unique(np.minimum(own, near.ravel()) * n + np.maximum(own, near.ravel()))
        low, high = links // n, links % n
        links = links[low < high]
        together = int((bad[low] & bad[high])[low < high].sum())
        mean = len(links) * g * (g - 1) / (n * (n - 1))
        out[names] = float(gammainc(together, mean)) if together else 1.0
    return out
