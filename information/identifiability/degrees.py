"""Highest degree of every component error that touches support."""

from dataclasses import dataclass

import numpy as np

from matstd.twin.effects import HigherOrder
from matstd.twin.frames import Array, Mask
from matstd.twin.machine import Family, Link, Symbol
from matstd.twin.model import Model, columns, traits
from matstd.twin.record import Touches

MAX_DEGREE = 8  # highest degree that is tried
MAX_POSTERIOR_SHARE = 0.5
"""A coefficient is supported when the touches leave less than this part of its expected size."""


@dataclass(frozen=True)
class Degree:
    """Supported degrees of one component error."""

    symbol: str
    # degrees (harmonics on a rotary axis) whose coefficients the touches determine, all of them
    # free together; the first may be 2, where degree 1 is tied to a location error or the set-up
    supported: tuple[int, ...]
    largest: int  # largest of them; 0 where there is none
    # standard uncertainty of the coefficient of that degree, mm or rad; 0 where there is none
    u: float
    unit: str  # base unit of u


def supported_degrees(model: Model, touches: Touches, W: Array, noise: float) -> tuple[Degree, ...]:
    """Largest degree of every component error of an axis that a program positions.

    The error's own distributions are replaced by Chebyshev polynomials, or harmonics, of expected
    size ``sd/k^1.5``; all other errors and the set-up stay free. Of the variance of the
    coefficients up to degree n ``(1 + C^T C - C^T W M^-1 W^T C)^-1`` is left. A degree is supported
    if all lower degrees stay supported with it: one coefficient too many over a part of the travel
    spoils the others.

    Args:
        W: Their whitened rows with the set-up free, (N, P).
        noise: Standard deviation of a touch, mm.
    """
    symbols = [traits(effect).symbol for effect, _ in model.parameters]
    out = []
    for symbol in model.chain.symbols:
        link = model.chain.link(symbol.link)
        own = np.array([s == symbol for s in symbols])
        if symbol.family is not Family.COMPONENT or not link.programmed or not own.any():
            continue
        sd = float(model.prior_sd[own].max())
        effect = HigherOrder(symbol, MAX_DEGREE, sd, link.kind == "rotary")
        size = np.array([p.sd for p in effect.parameters])
        C = columns([effect], touches) * size / noise
        rest = W[:, ~own]
        shared = rest.T @ C
        M = np.eye(rest.shape[1]) + rest.T @ rest
        A = C.T @ C - shared.T @ np.linalg.solve(M, shared)
        out.append(_degree(symbol, link, A, size))
    return tuple(out)


def _degree(symbol: Symbol, link: Link, A: Array, size: Array) -> Degree:
    """Degrees that an information A supports, in units of the expected sizes."""
    each = 2 if link.kind == "rotary" else 1
    left = np.ones((MAX_DEGREE, MAX_DEGREE))  # of degree k + 1 in column k, with n + 1 degrees free
    for n in range(MAX_DEGREE):
        free = each * (n + 1)
        covariance = np.linalg.solve(np.eye(free) + A[:free, :free], np.eye(free))
        left[n, : n + 1] = np.sqrt(np.diag(covariance)).reshape(n + 1, each).max(axis=1)
    supported = _run(left < MAX_POSTERIOR_SHARE)
    u = 0.0
    if supported:
        last = supported[-1] - 1
        u = float(left[last, last] * size[each * last])
    largest = max(supported, default=0)
    unit = "rad" if symbol.is_angular else "mm"
    return Degree(symbol=symbol.name, supported=supported, largest=largest, u=u, unit=unit)


def _run(is_supported: Mask) -> tuple[int, ...]:
    """Degrees that are supported together, the first being 1 or else 2.

    Degree k + 1 (columns) with n + 1 degrees free (rows), (n, k).
    """
    for first in (0, 1):
        n = first
        while n < len(is_supported) and is_supported[n, first : n + 1].all():
            n += 1
        if n > first:
            return tuple(range(first + 1, n + 1))
    return ()
