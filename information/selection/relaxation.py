"""Nearly optimal design weights: the relaxed problem, fractions of touches.

Weight flows from the least useful touch that has some to the most useful one that has room, each
time as much as is best for the pair (vertex exchange), within the shares that have to be kept.
Where no single flow helps, a step towards the best corner of the shares is made (Frank and Wolfe).
A curved criterion is followed along its tangent in short steps, and the mean that replaces the
largest of several is sharpened as the search converges.

Reference:
    Boehning, Metrika 33 (1986) 337 (vertex exchange); Frank and Wolfe, Naval Research Logistics
    Quarterly 3 (1956) 95.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from matstd.information.criteria import DesignCriterion, Tangent
from matstd.information.selection.shares import cells, keeps, largest_sum, rank_in_cell
from matstd.information.selection.touch_selection import Quota, level
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, Mask


@dataclass(frozen=True, eq=False)
class Slope:
    """Slope of a criterion at one information."""

    inverse: Array  # ``M_s^-1``, (S, R, R)
    S: Array  # forms of the gains ``w^T S_s w``, (S, R, R)
    constant: float  # ``sum_s trace(S_s prior_s)``
    value: float  # of the tangent: the criterion itself, or below it
    degree: float  # ``sum_s trace(S_s M_s)``

    def gains(self, W: Array) -> Array:
        """Gain of every candidate, (N,)."""
        return np.asarray(np.einsum("nr,nr->n", W @ self.S.sum(axis=0), W))

    def bound(self, largest: float) -> float:
        """Bound for choices whose gains sum up to at most `largest`."""
        return self.value * self.degree / (self.constant + largest)


def slope(criterion: DesignCriterion, information: Array) -> Slope:
    """Slope of a criterion at an information (R, R)."""
    M = criterion.prior + information
    inverse = np.asarray(np.linalg.solve(M, np.broadcast_to(np.eye(M.shape[1]), M.shape)))
    tangents = criterion.tangents(information)
    S = np.stack([t.slope(i) for t, i in zip(tangents, inverse, strict=True)])
    raw = sum(t.value(m, i) for t, m, i in zip(tangents, M, inverse, strict=True))
    return Slope(
        inverse=inverse,
        S=S,
        constant=float(np.sum(S * criterion.prior)),
        value=criterion.measure.shown(raw),
        degree=sum(t.degree(i) for t, i in zip(tangents, inverse, strict=True)),
    )


_STEPS = 400  # vertex exchanges between two looks at all candidates
_STEPS_CURVED = 40  # the same along one tangent of a criterion that is curved
_ROUNDS = 100  # looks at all candidates, at most
_PAIRS = 8  # exchanges found by the same gains
_REFRESH = 200
_DIGITS_LEFT = 1e-3  # of the largest gain: below it updates have lost as many digits
_HALVINGS = 8
_PATIENCE = 3  # looks without progress before the mean is sharpened, or the search given up
_SHARPEST = 1000.0
_MIN_FLOW = 1e-12
_MIN_WEIGHT = 1e-9  # of a touch that counts; below it a weight is rounding


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Nearly optimal design weights, and a bound for every choice."""

    weight: Array  # fraction of every candidate, (N,), between 0 and 1
    value: float  # criterion of the fractions; smaller is better
    bound: float  # no choice of as many whole touches has a smaller criterion
    steps: int  # vertex exchanges that were made

    @property
    def gap(self) -> float:
        """Share of the value that could still be gained at most."""
        return 1.0 - self.bound / self.value


def relaxed(
    criterion: DesignCriterion,
    W: Array,
    count: int,
    start: Mask,
    tolerance: float,
    quotas: tuple[Quota, ...] = (),
) -> Relaxed:
    """Nearly the best fractions of touches, by vertex exchange on the candidates that matter.

    All candidates are looked at again every few hundred steps, and the best bound met on the way is
    kept; it is true however far the fractions are from the best.

    Args:
        W: Rows of all candidates, (N, R).
        start: A choice of as many rows to start from, (N,).
        tolerance: Relative gap between value and bound that is close enough.
        quotas: Shares that fractions and whole choices have to keep.

    Raises:
        DesignError: Fewer candidates than touches, a start of another number, or one that does not
            keep the shares.
    """
    if len(W) < count or int(start.sum()) != count:
        raise DesignError(f"{int(start.sum())} of {len(W)} touches to start from, {count} wanted")
    if not all(keeps(q, start) for q in quotas):
        raise DesignError("the touches to start from do not keep the shares")
    x = start.astype(np.float64)
    cell, lowest = cells(quotas, len(W)), np.inf
    bound, steps, stalled = 0.0, 0, 0
    for _ in range(_ROUNDS):
        there = np.flatnonzero(x > 0.0)
        information = (W[there] * x[there, None]).T @ W[there]
        here = slope(criterion, information)
        gain = here.gains(W)
        top = largest_sum(gain, count, quotas)
        bound = max(bound, here.bound(top.most))
        value = criterion.value(information)
        stalled = 0 if value < lowest * (1.0 - 0.05 * tolerance) else stalled + 1
        if value < lowest:
            lowest, best = value, x
        if bound >= (1.0 - tolerance) * lowest:
            break
        # a sharper mean gets nearer to the largest, but is harder to follow: only at a standstill
        if stalled >= _PATIENCE:
            if criterion.measure.sharpness > _SHARPEST:
                break
            criterion, stalled = criterion.sharper(2.0), 0
        few = _candidates_to_search(level(gain, gain.max()), there, count, cell)
        # the same quotas over some rows, among which all weight is
        own = tuple(Quota(q.kind[few], q.most, q.least) for q in quotas)
        after, made = _exchanged(criterion, W[few], x[few], own)
        steps += made
        new = x.copy()
        new[few] = after
        if criterion.is_curved or made == 0:
            new = _stepped(criterion, W, x, new if made else top.x)
        x = new
    return Relaxed(best, lowest, bound, steps)


def _candidates_to_search(gain: Array, there: IntArray, count: int, cell: IntArray) -> IntArray:
    """Candidates with weight, as many again of the largest gains, and the best of every cell."""
    size = min(len(gain), 2 * count)
    best = np.argpartition(-gain, size - 1)[:size]
    few = np.union1d(there, best)
    if not cell.any():
        return few
    each = 4 + 2 * count // (int(cell.max()) + 1)
    return np.union1d(few, np.flatnonzero(rank_in_cell(gain, cell) < each))


def _stepped(criterion: DesignCriterion, W: Array, x: Array, towards: Array) -> Array:
    """Some way from fractions towards others, as far as halving finds that the criterion falls."""
    ends = []
    for weight in (x, towards):
        there = np.flatnonzero(weight > 0.0)
        ends.append((W[there] * weight[there, None]).T @ W[there])
    best, part = criterion.merit(ends[0]), 0.0
    for k in range(_HALVINGS):
        t = 0.5**k
        merit = criterion.merit((1.0 - t) * ends[0] + t * ends[1])
        if merit < best:
            best, part = merit, t
        elif part > 0.0:
            break
    return np.clip((1.0 - part) * x + part * towards, 0.0, 1.0)


class _Board:
    """Which flows between cells keep the shares."""

    def __init__(self, quotas: tuple[Quota, ...], count: int) -> None:
        self.quotas = quotas
        self.cell = cells(quotas, count)
        self.order = np.argsort(self.cell, kind="stable")
        self.first = np.searchsorted(self.cell[self.order], np.arange(int(self.cell.max()) + 1))
        member = self.order[self.first]
        self.kinds = np.array([q.kind[member] for q in quotas])  # (Q, cells)

    def best(self, up: Array, down: Array, x: Array) -> tuple[int, int, float]:
        """The pair of rows between which a flow helps most, to and from, and its room.

        Args:
            up: Gain of every row that may take some; -inf of others, (N,).
            down: Gain of every row that may give some; inf of others, (N,).
        """
        if not self.quotas:
            i, j = int(np.argmax(up)), int(np.argmin(down))
            return i, j, np.inf
        high = np.maximum.reduceat(up[self.order], self.first)
        low = np.minimum.reduceat(down[self.order], self.first)
        rooms, spares = np.empty(self.kinds.shape), np.empty(self.kinds.shape)
        for i, (quota, kinds) in enumerate(zip(self.quotas, self.kinds, strict=True)):
            count = np.bincount(quota.kind, weights=x, minlength=len(quota.most))
            least = 0.0 if quota.least is None else quota.least
            rooms[i], spares[i] = (quota.most - count)[kinds], (count - least)[kinds]
        lowest, best = low.min(), (0, 0, -np.inf, np.inf)
        # a cell that cannot better the best pair even with the least useful row ends the search
        for a in np.argsort(-high, kind="stable"):
            if not high[a] - lowest > best[2]:
                break
            limit = np.minimum(rooms[:, a, None], spares)
            allowed = np.where(self.kinds == self.kinds[:, a, None], np.inf, limit).min(axis=0)
            free = np.where(allowed > 1e-9, low, np.inf)
            b = int(np.argmin(free))
            if high[a] - free[b] > best[2]:
                best = (int(a), b, high[a] - free[b], allowed[b])
        rows = [np.flatnonzero(self.cell == k) for k in best[:2]]
        i = int(rows[0][np.argmax(up[rows[0]])])
        j = int(rows[1][np.argmin(down[rows[1]])])
        return i, j, float(best[3])


def _exchanged(
    criterion: DesignCriterion, W: Array, x: Array, quotas: tuple[Quota, ...]
) -> tuple[Array, int]:
    """Vertex exchanges among a few candidates: their new weights, and how many were made.

    Pairs of different rows are found by the same gains, a few at a time; each flow is the best one
    after those before it, and all gains are then updated together.
    """
    x, gain, made, due, largest = x.copy(), np.zeros(len(x)), 0, 0, np.inf
    board = _Board(quotas, len(x))
    tangents = criterion.tangents((W * x[:, None]).T @ W)
    most_steps = _STEPS_CURVED if criterion.is_curved else _STEPS
    while made < most_steps:
        if made >= due or gain[x < 1.0].max(initial=0.0) < _DIGITS_LEFT * largest:
            here = slope(criterion, (W * x[:, None]).T @ W)
            inverse, gain, due = here.inverse.copy(), here.gains(W), made + _REFRESH
            largest = gain[x < 1.0].max(initial=0.0)
        even = level(gain, gain[x < 1.0].max(initial=0.0))
        up, down = np.where(x < 1.0, even, -np.inf), np.where(x > 0.0, even, np.inf)
        before, reaches, inners = inverse.copy(), list[Array](), list[np.ndarray]()
        for _ in range(_PAIRS):
            i, j, room = board.best(up, down, x)
            if not up[i] > down[j]:
                break
            up[[i, j]], down[[i, j]] = -np.inf, np.inf
            pair = W[[i, j]]
            reach = inverse @ pair.T  # (S, R, 2)
            h = pair @ reach
            k = np.stack([t.pair(r) for t, r in zip(tangents, reach, strict=True)])
            flow = _best_flow(tangents, h, k, min(1.0 - x[i], x[j], room))
            x[i], x[j] = _snapped(x[i] + flow), _snapped(x[j] - flow)
            turned = np.linalg.solve(np.diag([1.0 / flow, -1.0 / flow]) + h, np.eye(2)[None])
            for s, one in enumerate(reach):
                inverse[s] -= one @ turned[s] @ one.T
            reaches.append(reach)
            inners.append(turned)
        if not reaches:
            break
        made += len(reaches)
        together = np.concatenate(reaches, axis=2)
        for s, tangent in enumerate(tangents):
            inner = block_diag(*(turned[s] for turned in inners))
            gain = gain + tangent.after_flow(W, before[s], together[s], inner)
    return x, made


def _snapped(weight: float) -> float:
    """A weight, 0 or 1 where it is so but for rounding, which must not decide what may flow."""
    nearest = round(weight)
    return nearest if abs(weight - nearest) < _MIN_WEIGHT else weight


def _best_flow(tangents: Sequence[Tangent], h: Array, k: Array, most: float) -> float:
    """How much weight should flow from the second touch of a pair to the first.

    Along the flow t the determinant of a machine's information grows by ``1 + b t - d t^2``, and
    its share of the criterion falls by ``(a t - c t^2) / (1 + b t - d t^2)``, which is concave; the
    root of the slope of the sum is found. Of the pair h is ``w M^-1 w``, k ``w M^-1 K M^-1 w``,
    (S, 2, 2).
    """
    from scipy.optimize import brentq

    b = (h[:, 0, 0] - h[:, 1, 1]).tolist()
    d = (h[:, 0, 0] * h[:, 1, 1] - h[:, 0, 1] ** 2).tolist()
    a = (k[:, 0, 0] - k[:, 1, 1]).tolist()
    c = k[:, 0, 0] * h[:, 1, 1] + k[:, 1, 1] * h[:, 0, 0] - 2.0 * k[:, 0, 1] * h[:, 0, 1]
    terms = list(zip(tangents, a, b, c.tolist(), d, strict=True))

    def falls(t: float) -> float:
        return sum(tangent.flow_slope(t, *abcd) for tangent, *abcd in terms)

    if falls(most) >= 0.0:
        return float(most)
    if falls(0.0) <= 0.0:
        return _MIN_FLOW
    return max(float(brentq(falls, 0.0, most, xtol=_MIN_FLOW * most)), _MIN_FLOW)
