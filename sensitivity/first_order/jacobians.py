"""Sensitivity of the tool point to every error parameter of a machine, anywhere."""

from collections.abc import Sequence

import numpy as np

from matstd.sensitivity.first_order.by_parameter import jacobian_by_parameter
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Symbol


def jacobian(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """First-order deviation of the tool point per unit of every error parameter.

    ``dp/dE`` in closed form: a component error by the twist of its axis, a location or set-up
    error by the displacement of its link (`matstd.sensitivity.first_order.by_parameter`). A
    component error counts with the value it has at the reading of the pose, whatever its
    distribution.

    Args:
        q: Readings, shape (N, A), mm and rad.
        length: Tool length, scalar or (N,), mm.
        symbols: P parameters; None for all of `chain.symbols`, in that order.

    Returns:
        Shape (N, P, 3), table frame, mm/mm and mm/rad.

    Reference:
        D-MT paper, eq. (3); the influence matrix of Bringmann and Knapp.
    """
    return np.moveaxis(jacobian_by_parameter(chain, q, length, symbols), -1, 0)


def sensitivity(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """``S = |dp/dE|`` of every error parameter at every pose.

    It is one for every translational component error, and the distance from the axis of rotation
    for an angular one. What a touch can determine follows from the signed ``n . dp/dE``
    (`matstd.information.criteria.posterior`).

    Args:
        q: Readings, shape (N, A), mm and rad.
        length: Tool length, scalar or (N,), mm.
        symbols: P parameters; None for all of `chain.symbols`.

    Returns:
        Shape (N, P), mm/mm (the same in µm/µm) and mm/rad.

    Reference:
        D-MT paper, eq. (3).
    """
    return np.linalg.norm(jacobian(chain, q, length, symbols), axis=-1)
