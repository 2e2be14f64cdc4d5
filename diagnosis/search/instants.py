"""Rows of one instant: x, y and z of a reflector share whatever the machine did in that pose.

An arm that leaves play in its joints, or bends in a way that no effect has, is off by something of
its own in every pose, which the rows of the pose all show. They are not so many independent
observations, and an effect that follows a few hundred poses by chance explains three times as many
rows. So how much the explained part scatters is taken from instant to instant, not from row to row.
Only where every instant is held out by itself: stretches of a log that are held out as a whole say
how far an effect reaches, and what noise remembers from one instant to the next is another matter.
"""

import numpy as np

from matstd.diagnosis.evidence import EffectSet
from matstd.diagnosis.regression import f_tail

MIN_SHARED_ROWS = 0.5
"""Share of rows with the instant and readings of the row before, from which rows of an instant are
grouped."""


def p_by_instants(others: EffectSet, whole: EffectSet) -> float:
    """Probability by chance of what an effect explains, one variant, no correction; 0 for no say.

    ``F = g^T G^-1 g / tr(G^-1 V)`` of k and M - k degrees of freedom, with D the columns beside the
    others, ``G = D^T D``, ``g = D^T r``, and V the sum over M instants of the squares of
    ``D_m^T e_m``, e the errors of what was held out.

    Reference:
        Liang and Zeger, Biometrika 73 (1986) 13-22 (estimates of variance from clusters).
    """
    space = whole.complement
    q, t = space.touches.q[space.used], space.touches.time[space.used]
    begins = np.r_[True, np.any(np.diff(q, axis=0) != 0.0, axis=1) | (np.diff(t) != 0.0)]
    first = np.flatnonzero(begins)
    added = whole.A.shape[1] - others.A.shape[1]
    freedom = len(first) - added
    is_shared = len(first) <= (1.0 - MIN_SHARED_ROWS) * len(q)
    if not is_shared or freedom < 1 or len(first) > len(space.groups):
        return 0.0
    D = whole.A - others.A @ others.coefficients(whole.A) if others.A.shape[1] else whole.A
    error = whole.held_out.error
    each = np.add.reduceat(D[: len(error)] * error[:, None], first, axis=0)
    inverse = np.linalg.pinv(D.T @ D, rcond=1e-9, hermitian=True)  # of the others nothing is left
    g = D.T @ others.residual
    explained = float(g @ inverse @ g)
    scatter = float(np.einsum("mi,ij,mj->", each, inverse, each))
    return float(f_tail(explained / max(scatter, 1e-300), added, freedom))
