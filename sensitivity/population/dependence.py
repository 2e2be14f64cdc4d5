"""Errors with a common cause: correlated amplitudes, and shapes drawn together.

Every amplitude is drawn evenly from its range with a random sign. Where amplitudes depend on each
other, normal scores z of the right correlation are drawn and mapped to that distribution,

    a(z) = low sgn z + (high - low) (2 Phi(z) - 1).

The correlation of two amplitudes follows from that rho of their scores in closed form,

    E[a b] = 2/pi (l m arcsin(rho) + (l n + k m) arcsin(rho/sqrt 2) + k n arcsin(rho/2)),

with ranges [l, l + k] and [m, m + n]. It is solved for rho, so what is asked for is the correlation
of the amplitudes themselves, signs included.

Reference: Cario and Nelson, "Modeling and generating random vectors with arbitrary marginal
distributions and correlation matrix", 1997 (NORTA); JCGM 101:2008, 6.4.8, for normal ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.errors import DesignError, ShapeMismatch
from matstd.twin.frames import Array

_ROUNDING = 1e-9  # of a correlation as typed
_HALVINGS = 60  # of the correlation: to the last digit


@dataclass(frozen=True, eq=False)
class Dependence:
    """Correlated errors.

    Raises:
        DesignError: The matrix is no matrix of correlations, or a name stands twice.
    """

    names: tuple[str, ...]
    correlation: Array  # correlation of their signed amplitudes, (n, n)
    # groups of names whose members also have shape, periods and phase in common
    alike: tuple[tuple[str, ...], ...] = ()

    def __post_init__(self) -> None:
        n, r = len(self.names), np.asarray(self.correlation, dtype=float)
        if r.shape != (n, n):
            raise ShapeMismatch(f"a correlation matrix of shape {r.shape} for {n} errors")
        listed = ", ".join(self.names[:8]) + (" ..." if n > 8 else "")
        if len(set(self.names)) < n:
            raise DesignError(f"correlation of {listed}: expected every error once")
        if not np.isfinite(r).all() or np.abs(r - r.T).max() > _ROUNDING:
            raise DesignError(f"the correlation matrix of {listed} is not symmetric and finite")
        if np.abs(np.diag(r) - 1.0).max() > _ROUNDING or np.abs(r).max() > 1.0 + _ROUNDING:
            raise DesignError(
                f"the correlation matrix of {listed}: expected ones on its diagonal and nothing "
                "beyond -1 and 1"
            )
        if (smallest := float(np.linalg.eigvalsh(r)[0])) < -_ROUNDING * n:
            raise DesignError(
                f"the correlation matrix of {listed} is not positive semidefinite: its smallest "
                f"eigenvalue is {smallest:.3g}, so no machines can have these correlations"
            )
        object.__setattr__(self, "correlation", r)


@dataclass(frozen=True)
class Group:
    """Errors of one cause, every two of them equally correlated."""

    names: tuple[str, ...]  # of the errors; a minus before a name turns its sign
    correlation: float = 1.0  # of every two amplitudes, 0 to 1
    alike: bool = False  # whether they also have shape, periods and phase in common

    def __post_init__(self) -> None:
        if len(self.names) < 2 or not 0.0 <= self.correlation <= 1.0:
            raise DesignError(
                f"group of {', '.join(self.names) or 'nothing'} with correlation "
                f"{self.correlation:g}: expected two errors at least, and 0 to 1; write -EYX for "
                "an error of opposite sign"
            )


def grouped(groups: Sequence[Group]) -> Dependence:
    """Dependence of errors in separate groups.

    Example:
        >>> grouped([Group(("EXX", "-EYX"), 0.5)]).correlation
        array([[ 1. , -0.5],
               [-0.5,  1. ]])
    """
    names = tuple(name.removeprefix("-") for group in groups for name in group.names)
    r, start = np.eye(len(names)), 0
    for group in groups:
        sign = np.array([-1.0 if name.startswith("-") else 1.0 for name in group.names])
        rows = slice(start, start + len(sign))
        r[rows, rows] = group.correlation * np.outer(sign, sign)
        r[range(start, rows.stop), range(start, rows.stop)] = 1.0
        start = rows.stop
    alike = tuple(tuple(n.removeprefix("-") for n in g.names) for g in groups if g.alike)
    return Dependence(names, r, alike)


def amplitude(z: Array, low: Array, high: Array) -> Array:
    """Signed amplitudes for normal scores, shape of z."""
    from scipy.special import ndtr

    return np.sign(z) * low + (high - low) * (2.0 * ndtr(z) - 1.0)


def product_moment(rho: Array, low: Array, high: Array) -> Array:
    """E[a b] of two amplitudes whose scores have correlation rho, (n, n).

    Args:
        rho: Shape (n, n).
        low: Smallest amplitudes, (n,).
        high: Largest amplitudes, (n,).
    """
    wide = high - low
    mixed = np.outer(low, wide)
    return (2.0 / np.pi) * (
        np.outer(low, low) * np.arcsin(rho)
        + (mixed + mixed.T) * np.arcsin(rho / np.sqrt(2.0))
        + np.outer(wide, wide) * np.arcsin(0.5 * rho)
    )


def score_factor(dependence: Dependence, low: Array, high: Array) -> Array:
    """Factor F of the scores' correlations, ``z = F w`` with independent normal w, (n, n).

    Raises:
        DesignError: These ranges cannot have these correlations.
    """
    rho, reachable = _scores(dependence.correlation, low, high)
    if not reachable or _smallest(rho) < -1e-7:
        share = _possible(dependence.correlation, low, high)
        raise DesignError(
            f"correlation of {', '.join(dependence.names[:8])}: amplitudes of these ranges cannot "
            f"be correlated so much; {share:.3g} times these correlations are possible"
        )
    values, vectors = np.linalg.eigh(rho)
    # the root of a rounding of zero would be a difference of 1e-8 between errors that are equal
    rounding = len(values) * np.finfo(float).eps * values[-1]
    return vectors * np.sqrt(np.where(values > rounding, values, 0.0))


def _smallest(matrix: Array) -> float:
    return float(np.linalg.eigvalsh(matrix)[0])


def _scores(r: Array, low: Array, high: Array) -> tuple[Array, bool]:
    """Correlations of the scores by halving, and whether there are any."""
    one = np.ones_like(r)
    sd = np.sqrt((low * low + low * high + high * high) / 3.0)
    wanted = r * np.outer(sd, sd)
    reachable = bool((np.abs(wanted) <= product_moment(one, low, high) * (1.0 + 1e-9)).all())
    below, above = -one, one.copy()
    for _ in range(_HALVINGS):  # E[a b] rises with rho
        middle = 0.5 * (below + above)
        short = product_moment(middle, low, high) < wanted
        below, above = np.where(short, middle, below), np.where(short, above, middle)
    rho = np.where(np.outer(sd, sd) > 0.0, 0.5 * (below + above), 0.0)
    np.fill_diagonal(rho, 1.0)
    return 0.5 * (rho + rho.T), reachable


def _possible(r: Array, low: Array, high: Array) -> float:
    """Largest share of the correlations that these ranges can have."""
    below, above = 0.0, 1.0
    for _ in range(12):
        middle = 0.5 * (below + above)
        rho, reachable = _scores(middle * r + (1.0 - middle) * np.eye(len(r)), low, high)
        if reachable and _smallest(rho) >= 0.0:
            below = middle
        else:
            above = middle
    return below
