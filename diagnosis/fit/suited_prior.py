"""The prior that suits a machine: its errors curve as expected, or clearly less.

What is expected of a class of machines is wide, since it must hold for the worst of them. On a good
machine, probed at few places, curves that the run hardly determines would be free to follow the
noise, and the model would predict worse than none. So the run may say that this machine is better
than its class: what bends over an axis (parabolas, waves), and what tilts or leads aside over it,
each get the one factor of a few under which the run is most likely,

    log p(y) = -1/2 log det(I + X^T X) - (N + nu)/2 log(|y|^2 - y^T X (I + X^T X)^-1 X^T y + nu),

with whitened columns X in units of the prior and nu observations for the noise that is stated. The
class keeps its word unless the run clearly says otherwise. Squareness, scale and lines of rotary
axes keep it always: hardly any run leaves them open, and they shall not be drawn to zero. Of a
serial arm the zeros and the places of its joints keep it, while the tilts of their lines, two a
joint that a workshop bores in one clamping, get the second factor.

Reference:
    MacKay, Neural Computation 4 (1992) 415 (the evidence for a scale of the prior).
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from matstd.diagnosis.fit.prior import Prior
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import PRIOR_DOF, Solution
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import LETTERS, Chain, error_class
from matstd.twin.model import Effect, Model, original_of, traits

FACTORS = (1.0, 1.0 / 4.0, 1.0 / 16.0, 1.0 / 64.0)
"""On what is expected: from the class down to a machine of a laboratory."""


def narrowed(prior: Prior, model: Model, X: Array, y: Array) -> Prior:
    """The prior with the factors under which a run is most likely.

    Args:
        prior: Prior of the model's parameters, from the class of the machine.
        X: Columns of the effects, then of the set-ups, in units of the prior and of the noise, rows
            in use, (M, P).
        y: Deviations in units of the noise, (M,).
    """
    kinds = np.repeat(
        [_kind(e, model.chain) for e in model.effects], [len(e.parameters) for e in model.effects]
    )
    G, g, square = X.T @ X, X.T @ y, float(y @ y)
    each = [np.ones(len(G)) for _ in range(len(FACTORS) ** 2)]
    for factor, (bends, tilts) in zip(each, product(FACTORS, repeat=2), strict=True):
        factor[: len(kinds)][kinds == "bends"] = bends
        factor[: len(kinds)][kinds == "tilts"] = tilts
    evidence = [_evidence(G, g, square, len(y), factor) for factor in each]
    best = int(np.argmax(evidence))
    if evidence[best] < evidence[0] + POLICY.log_evidence_gain:
        return prior
    chosen = _released(G, g, square, len(y), each[best], _errors_of(model, kinds))[: len(prior)]
    return Prior(prior.mean, chosen[:, None] * prior.root, chosen)


def evidence_of(X: Array, y: Array) -> float:
    """Log evidence of a fit up to a constant of its run; arguments as of `narrowed`."""
    return _evidence(X.T @ X, X.T @ y, float(y @ y), len(y), np.ones(X.shape[1]))


def _errors_of(model: Model, kinds: Array) -> list[IntArray]:
    """Numbers of the parameters that one error of one axis has of a kind, for every error, (K,)."""
    of: dict[tuple[object, ...], list[int]] = {}
    first = 0
    for effect in model.effects:
        numbers = range(first, first := first + len(effect.parameters))
        if len(numbers) and kinds[numbers[0]] != "stays":
            symbol = traits(original_of(effect)).symbol
            of.setdefault((traits(effect).since_run, symbol, kinds[numbers[0]]), []).extend(numbers)
    return [np.array(numbers) for numbers in of.values()]


def _released(
    G: Array, g: Array, square: float, count: int, factor: Array, errors: Sequence[IntArray]
) -> Array:
    """The factors with those errors left to the class, one by one, that are not as small.

    With variance v more for the parameters of one error, K and k the information and its vector
    about them that the others leave, the evidence changes as det(I + v K) and k^T (I/v + K)^-1 k
    say: one factorisation serves all errors.
    """
    factor = factor.copy()
    while True:
        M = factor[:, None] * G * factor
        M[np.diag_indices_from(M)] += 1.0
        low = cho_factor(M, lower=True)
        half = solve_triangular(low[0], factor[:, None] * np.column_stack([G, g]), lower=True)
        K, k = G - half[:, :-1].T @ half[:, :-1], g - half[:, :-1].T @ half[:, -1]
        left = max(square - float(half[:, -1] @ half[:, -1]), 0.0) + PRIOR_DOF
        gains = [_gain(K, k, left, count, of, 1.0 - factor[of[0]] ** 2) for of in errors]
        best = int(np.argmax(gains)) if gains else 0
        if not gains or gains[best] < POLICY.log_evidence_released:
            return factor
        factor[errors[best]] = 1.0


def _gain(K: Array, k: Array, left: float, count: int, of: IntArray, more: float) -> float:
    """Log evidence gained by so much more variance of some parameters."""
    wide = np.eye(len(of)) + more * K[np.ix_(of, of)]
    gained = more * float(k[of] @ np.linalg.solve(wide, k[of]))
    less = np.log(max(left - gained, PRIOR_DOF) / left)
    return float(-0.5 * np.linalg.slogdet(wide)[1] - 0.5 * (count + PRIOR_DOF) * less)


def _kind(effect: Effect, chain: Chain) -> str:
    """What an error of the ordinary model, or its change, does over its axis."""
    error = traits(original_of(effect) if traits(effect).since_run is not None else effect)
    if error.ordinary_constant is not None:
        return "tilts" if error_class(chain, error.ordinary_constant) == "arm_tilt" else "stays"
    symbol = error.ordinary_component
    if symbol is None:
        return "stays"
    if error.distribution in ("parabolic", "sinusoidal"):
        return "bends"
    is_scale = error.distribution == "linear" and LETTERS[symbol.component] == symbol.link[0]
    return "stays" if is_scale or error.distribution == "constant" else "tilts"


def _evidence(G: Array, g: Array, square: float, count: int, factor: Array) -> float:
    """Log evidence up to a constant; G, g: normal equations in units of the prior times factor."""
    M = factor[:, None] * G * factor
    M[np.diag_indices_from(M)] += 1.0
    low = cho_factor(M, lower=True)
    along = factor * g
    left = max(square - float(along @ cho_solve(low, along)), 0.0) + PRIOR_DOF
    return float(-np.log(np.diag(low[0])).sum() - 0.5 * (count + PRIOR_DOF) * np.log(left))


def widening(effects: Sequence[Effect], factor: float) -> Array:
    """Factor on the prior of every parameter, (P, 1): none where its size was chosen already."""
    counts = [len(e.parameters) for e in effects]
    if factor == 1.0:  # most fits
        return np.ones((sum(counts), 1))
    each = np.repeat([traits(e).is_shrunk for e in effects], counts)
    return np.where(each, 1.0, factor)[:, None]


def widened_by(solution: Solution, machine: int) -> float:
    """How much wider the prior of the machine must be for its own parameters to be likely."""
    decided = 1.0 - (solution.root[:machine] ** 2).sum(axis=1)
    ratio = float(solution.phi[:machine] @ solution.phi[:machine]) / max(float(decided.sum()), 1.0)
    return float(np.sqrt(ratio)) if ratio > POLICY.prior_exceeded else 1.0
