"""A cube of eight nodes that bends as it should: three incompatible modes, condensed.

Cubes of trilinear elements are too stiff in bending; three quadratic modes inside every element
cure that, and a cube passes the patch test with them as it is.

Reference:
    Wilson, Taylor, Doherty, Ghaboussi, in: Numerical and Computer Methods in Structural Mechanics
    (1973) 43; Bathe, Finite Element Procedures, 4.4.
"""

from itertools import product

import numpy as np

from matstd.twin.frames import Array

CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))  # natural coordinates of the nodes, (8, 3)


def cube(side: float, modulus: float, poisson: float) -> Array:
    """Stiffness of a cube, (24, 24), N/mm; three displacements a node, in the order of `CORNERS`.

    Args:
        side: Mm.
        modulus: Young's, N/mm^2.
    """
    D = _elasticity(modulus, poisson)
    whole = np.zeros((33, 33))
    root = 1.0 / np.sqrt(3.0)
    for point in np.array(list(product((-root, root), repeat=3))):
        B = _strains(point, side)
        whole += B.T @ D @ B * (0.5 * side) ** 3
    kept, inner, across = whole[:24, :24], whole[24:, 24:], whole[:24, 24:]
    return kept - across @ np.linalg.solve(inner, across.T)


def _elasticity(modulus: float, poisson: float) -> Array:
    """Elasticity matrix, stress from strain with engineering shear, (6, 6)."""
    lame = modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * modulus / (1.0 + poisson)
    D = np.zeros((6, 6))
    D[:3, :3] = lame
    D[np.arange(3), np.arange(3)] += 2.0 * shear
    D[np.arange(3, 6), np.arange(3, 6)] = shear
    return D


def _strains(point: Array, side: float) -> Array:
    """Strain from the 24 displacements and the 9 incompatible modes at a point, (6, 33)."""
    terms = 1.0 + CORNERS * point
    slopes = np.empty((11, 3))
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        slopes[:8, axis] = 0.125 * CORNERS[:, axis] * terms[:, others].prod(axis=1)
    slopes[8:] = np.diag(-2.0 * point)
    slopes *= 2.0 / side
    B = np.zeros((6, 33))
    for node, (x, y, z) in enumerate(slopes):
        at = 3 * node
        B[:, at : at + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
    return B
