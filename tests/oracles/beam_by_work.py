"""Beams by virtual work: integrals over the beam, and forces at its far end that hold it there.

No stiffness matrix and no closed form of a deflection: shares nothing with `matstd.twin.elastic`.
"""

import numpy as np

COUNT = 4001


def flexibility(support, x, span, EI, GA):
    """Motions (deflection, rotation) at x by unit force, unit moment and unit load, (2, 3)."""
    far = {"cantilever": (), "supported": ("root", "force"), "clamped": ("force", "moment")}[
        support
    ]
    s = np.linspace(0.0, span, COUNT)

    def inner(kind, at):
        """Moment and shear of a cantilever from s = 0 under a unit action."""
        reach = s <= at
        if kind == "force":
            return (at - s) * reach, 1.0 * reach
        if kind == "moment":
            return 1.0 * reach, 0.0 * s
        return (span - s) ** 2 / 2.0, span - s

    def work(a, b):
        """Motion of action a in the state of action b; kinks lie on points of the grid."""
        (Ma, Va), (Mb, Vb) = inner(*a), inner(*b)
        return np.trapezoid(Ma * Mb / EI + Va * Vb / GA, s)

    assert np.isclose(s, x).any()
    if support == "supported":
        # pinned at both ends: the beam of statics, no redundant at all
        return _pinned(x, span, EI, GA, s)
    asked = [("force", x), ("moment", x)]
    given = [*asked, ("load", span)]
    F = np.array([[work(a, b) for b in given] for a in asked])
    if far:
        held = [(kind, span) for kind in far]
        H = np.array([[work(a, b) for b in held] for a in held])
        R = np.array([[work(a, b) for b in given] for a in held])
        F -= np.array([[work(a, b) for b in held] for a in asked]) @ np.linalg.solve(H, R)
    return F


def _pinned(x, span, EI, GA, s):
    """Moments and shears of a beam on two pins."""
    before = s <= x
    force = (
        np.where(before, s * (span - x), x * (span - s)) / span,
        np.where(before, span - x, -x) / span,
    )
    moment = (np.where(before, -s, span - s) / span, -np.ones_like(s) / span)
    load = (s * (span - s) / 2.0, span / 2.0 - s)
    out = np.empty((2, 3))
    for i, a in enumerate((force, moment)):
        for j, b in enumerate((force, moment, load)):
            out[i, j] = np.trapezoid(a[0] * b[0] / EI + a[1] * b[1] / GA, s)
    return out
