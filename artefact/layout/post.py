"""Stiffness of the post under a ball, and the foot that a stiffness requires.

A post is a cone frustum of radius ``b`` at the ball's centre and ``a`` at its foot, ``L`` below.
Under a force across it at the ball the compliance is the sum of bending, shear, and the turn of the
foot in the plate, which is taken as a half space under a rigid disc:

    bending   4 L^3 / (3 pi E a^3 b)
    shear     L / (kappa G pi a b),  kappa = 0.9
    foot      3 (1 - nu) L^2 / (8 G a^3)

The first two are the integrals of ``s^2 / E I(s)`` and ``1 / kappa G A(s)`` along the taper.

Reference:
    Timoshenko and Gere, Mechanics of Materials, ch. 9; the foot: Johnson, Contact Mechanics (1985).
"""

import numpy as np

_SHEAR = 0.9
_STEP = 0.1  # mm, resolution of drawings


def post_stiffness(length: float, top: float, foot: float, modulus: float, poisson: float) -> float:
    """Force across the ball per deflection, N/mm.

    Args:
        length: From foot to ball centre, mm.
        top: Radius at the ball's centre, mm.
        foot: Radius at the foot, mm.
        modulus: Young's, N/mm^2.
    """
    G = modulus / (2.0 * (1.0 + poisson))
    turn = 3.0 * (1.0 - poisson) * length**2 / (8.0 * G * foot**3)
    return float(1.0 / (1.0 / cantilever_stiffness(length, top, foot, modulus, poisson) + turn))


def cantilever_stiffness(
    length: float, top: float, foot: float, modulus: float, poisson: float
) -> float:
    """The same of a post on a rigid plate, by bending and shear alone, N/mm."""
    G = modulus / (2.0 * (1.0 + poisson))
    bending = 4.0 * length**3 / (3.0 * np.pi * modulus * foot**3 * top)
    shear = length / (_SHEAR * G * np.pi * foot * top)
    return float(1.0 / (bending + shear))


def post_foot(length: float, top: float, stiffness: float, modulus: float, poisson: float) -> float:
    """Smallest radius of a foot, in tenths of a millimetre, with which a post is stiff enough.

    Args:
        length: From foot to ball centre, mm.
        top: Radius at the ball's centre, mm.
        stiffness: Wanted, N/mm.
        modulus: Young's, N/mm^2.
    """
    foot = top + _STEP
    while post_stiffness(length, top, foot, modulus, poisson) < stiffness:
        foot += _STEP
    return round(foot, 1)
