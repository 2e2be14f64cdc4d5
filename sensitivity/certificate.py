"""How near a choice of touches is to the best that any choice could be: a proven bound.

Every touch may be made by a fraction, ``0 <= x_i <= 1``, ``sum x_i = n``: a convex problem, whose
optimum no whole choice can beat. Both criteria have a concave form of degree one in the
information ``M = 1 + sum x_i w_i w_i^T``,

    I:  phi = 1 / trace(K M^-1)         D:  phi = det(M)^(1/R),

so at *any* M, near the optimum or not, the tangent bounds every choice of n rows:

    phi <= (trace(S) + sum of the n largest g_i) * phi(M) / trace(S M),   g_i = w_i^T S w_i,

with ``S = M^-1 K M^-1`` for I and ``S = M^-1`` for D. The efficiency that is certified is phi of a
choice over that bound. It is a proof and needs no faith in the search that found M.

Reference:
    Pukelsheim, Optimal Design of Experiments (1993), chapters 5 and 7 (information functions);
    Boehning, Metrika 33 (1986) 337 (vertex exchange).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sensitivity.design import Purpose, Selection, exchange
from twin.errors import DesignError
from twin.frames import Array
from twin.touches import IntArray

_STEPS = 400  # vertex exchanges between two looks at all candidates
_ROUNDS = 60
_REFRESH = 50


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Fractions of touches that are nearly the best possible, and what no choice can beat.

    Attributes:
        weight: Fraction of every candidate, (N,), between 0 and 1.
        value: Criterion of the fractions; smaller is better.
        bound: No choice of as many whole touches has a smaller criterion.
        steps: Vertex exchanges that were made.
    """

    weight: Array
    value: float
    bound: float
    steps: int

    @property
    def gap(self) -> float:
        """Share of the value that could still be gained at most."""
        return 1.0 - self.bound / self.value


def _slope(aim: Purpose, M: Array) -> tuple[Array, float]:
    """Weight matrix S of the gains ``w^T S w``, and the value, at an information M."""
    inverse = np.asarray(np.linalg.solve(M, np.eye(len(M))), dtype=np.float64)
    if aim.is_determinant:
        return inverse, aim.value(M - np.eye(len(M)))
    S = inverse @ aim.K @ inverse
    return 0.5 * (S + S.T), float(np.sum(inverse * aim.K))


def bound_at(aim: Purpose, W: Array, information: Array, count: int) -> tuple[float, Array]:
    """What no choice of rows can beat, by the tangent at some information.

    Args:
        aim: Criterion.
        W: Rows of all candidates, (N, R).
        information: ``W^T diag(x) W`` of fractions or of a choice, (R, R); any will do, the nearer
            to the best the tighter.
        count: Number of touches.

    Returns:
        The bound, and the gain g of every candidate, (N,).
    """
    M = np.eye(len(information)) + information
    S, value = _slope(aim, M)
    gain = np.einsum("nr,nr->n", W @ S, W)
    top = float(np.partition(gain, len(gain) - count)[len(gain) - count :].sum())
    return value * float(np.sum(S * M)) / (float(np.trace(S)) + top), gain


def relaxed(
    aim: Purpose, W: Array, count: int, start: NDArray[np.bool_], tolerance: float = 2e-3
) -> Relaxed:
    """Nearly the best fractions of touches, by vertex exchange on the candidates that matter.

    Weight flows from the least useful touch that has some to the most useful one that has room,
    each time as much as is best for the pair; all candidates are looked at again every few hundred
    steps, and the best bound met on the way is kept.

    Args:
        aim: Criterion.
        W: Rows of all candidates, (N, R).
        count: Number of touches.
        start: A choice of as many rows to start from, (N,).
        tolerance: Relative gap between value and bound that is close enough.

    Raises:
        DesignError: Fewer candidates than touches, or a start of another number.
    """
    if len(W) < count or int(start.sum()) != count:
        raise DesignError(f"{int(start.sum())} of {len(W)} touches to start from, {count} wanted")
    x = start.astype(np.float64)
    bound, steps = 0.0, 0
    for _ in range(_ROUNDS):
        there = np.flatnonzero(x > 0.0)
        information = (W[there] * x[there, None]).T @ W[there]
        here, gain = bound_at(aim, W, information, count)
        bound, value = max(bound, here), aim.value(information)
        if bound >= (1.0 - tolerance) * value:
            break
        few = _worth_looking_at(gain, there, count)
        x[few], made = _exchanged(aim, W[few], x[few])
        steps += made
    return Relaxed(x, value, bound, steps)


def _worth_looking_at(gain: Array, there: IntArray, count: int) -> IntArray:
    """Candidates with weight, and as many again of the largest gains."""
    size = min(len(gain), 2 * count)
    best = np.argpartition(-gain, size - 1)[:size]
    return np.union1d(there, best)


def _exchanged(aim: Purpose, W: Array, x: Array) -> tuple[Array, int]:
    """Vertex exchanges among a few candidates: their new weights, and how many were made."""
    x = x.copy()
    R = W.shape[1]
    for step in range(_STEPS):
        if step % _REFRESH == 0:
            M = np.eye(R) + (W * x[:, None]).T @ W
            inverse = np.asarray(np.linalg.solve(M, np.eye(R)), dtype=np.float64)
            S = inverse if aim.is_determinant else inverse @ aim.K @ inverse
            gain = np.einsum("nr,nr->n", W @ S, W)
        up = int(np.argmax(np.where(x < 1.0, gain, -np.inf)))
        down = int(np.argmin(np.where(x > 0.0, gain, np.inf)))
        if gain[up] <= gain[down] * (1.0 + 1e-9):
            return x, step
        pair = W[[up, down]]
        reach = inverse @ pair.T  # (R, 2)
        most = min(1.0 - x[up], x[down])
        moved = _best_flow(aim, pair @ reach, reach.T @ aim.K @ reach, most)
        x[up] = 1.0 if moved == 1.0 - x[up] else x[up] + moved
        x[down] = 0.0 if moved == x[down] else x[down] - moved
        inverse, gain = _after_flow(aim, W, inverse, reach, pair, moved, gain)
    return x, _STEPS


def _after_flow(
    aim: Purpose, W: Array, inverse: Array, reach: Array, pair: Array, moved: float, gain: Array
) -> tuple[Array, Array]:
    """Inverse of the information and gains of all after a flow, by a rank-two update."""
    inner = np.linalg.solve(np.diag([1.0 / moved, -1.0 / moved]) + pair @ reach, np.eye(2))
    along = W @ reach  # (N, 2)
    if aim.is_determinant:
        gain = gain - np.einsum("ni,ij,nj->n", along, inner, along)
    else:
        other = W @ (inverse @ (aim.K @ reach))
        kappa = inner @ (reach.T @ aim.K @ reach) @ inner
        gain = gain - 2.0 * np.einsum("ni,ij,nj->n", other, inner, along)
        gain = gain + np.einsum("ni,ij,nj->n", along, kappa, along)
    inverse = inverse - reach @ inner @ reach.T
    return inverse, gain


def _best_flow(aim: Purpose, h: Array, k: Array, most: float) -> float:
    """How much weight should flow from the second touch of a pair to the first.

    The criterion along the flow t is convex, with ``D = diag(t, -t)`` and ``B = (1 + D h)^-1 D``:
    for I it falls by ``trace(B k)``, for D the logarithm of ``det(1 + D h)`` grows. Found by
    bisection of the slope.

    Args:
        aim: Criterion.
        h: ``w M^-1 w`` of the pair, (2, 2).
        k: ``w M^-1 K M^-1 w`` of the pair, (2, 2).
        most: Largest flow.
    """
    d = h[0, 0] * h[1, 1] - h[0, 1] ** 2
    b = h[0, 0] - h[1, 1]
    if aim.is_determinant:  # det = 1 + b t - d t^2
        best = b / (2.0 * d) if d > 1e-15 else np.inf
        return float(min(max(best, 1e-12), most))
    # fall = (t (k00 - k11) - t^2 c) / (1 + b t - d t^2)
    a = k[0, 0] - k[1, 1]
    c = k[0, 0] * h[1, 1] + k[1, 1] * h[0, 0] - 2.0 * k[0, 1] * h[0, 1]

    def slope(t: float) -> float:
        det, fall = 1.0 + b * t - d * t * t, t * a - t * t * c
        return float((a - 2.0 * t * c) * det - fall * (b - 2.0 * d * t))

    if slope(most) >= 0.0:
        return float(most)
    low, high = 0.0, most
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slope(middle) > 0.0 else (low, middle)
    return float(max(low, 1e-12))


@dataclass(frozen=True)
class Certificate:
    """How near a choice is to the best that there can be.

    Attributes:
        candidates: Touches that could have been chosen.
        count: Touches that were.
        value: Criterion of the choice.
        bound: No other choice of as many of the candidates has a smaller one.
    """

    candidates: int
    count: int
    value: float
    bound: float

    @property
    def efficiency(self) -> float:
        """At least so near to the best possible choice, 0 to 1."""
        return self.bound / self.value

    def __str__(self) -> str:
        return (
            f"{self.count} of {self.candidates} candidate touches: at least "
            f"{100 * self.efficiency:.1f} % as good as any choice of as many"
        )


def certificate(
    aim: Purpose, W: Array, chosen: NDArray[np.bool_], tolerance: float = 2e-3
) -> Certificate:
    """Certified efficiency of a choice among candidates.

    Args:
        aim: Criterion.
        W: Rows of all candidates, (N, R).
        chosen: The choice, (N,).
        tolerance: Relative gap to which the relaxed problem is solved.
    """
    count = int(chosen.sum())
    best = relaxed(aim, W, count, chosen, tolerance)
    rows = W[chosen]
    return Certificate(len(W), count, aim.value(rows.T @ rows), best.bound)


def rounded(aim: Purpose, W: Array, weight: Array, count: int, most: int = 300) -> Selection:
    """A choice of whole touches from fractions: the heaviest, then exchanged until none helps.

    Args:
        aim: Criterion.
        W: Rows of all candidates, (N, R).
        weight: Fractions, (N,).
        count: Number of touches.
        most: Largest number of exchanges.
    """
    chosen = np.zeros(len(W), dtype=bool)
    chosen[np.argsort(-weight, kind="stable")[:count]] = True
    selection = Selection(aim, W, chosen)
    exchange(selection, most=most)
    return selection
