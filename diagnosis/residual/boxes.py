"""Boxes of a few conditions on the columns of a run, and the search for the best of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property
from typing import NamedTuple, Protocol

import numpy as np

from matstd.diagnosis.evidence import ResidualSpace
from matstd.diagnosis.residual.patterns import variables
from matstd.twin.frames import Array, IntArray, Mask

MAX_VARIABLES = 3  # most variables that bound a region
MIN_TOUCHES_OF_REGION = 12  # fewest touches of a region

MAX_SHARE = 0.6
"""Largest share of the touches: an error that is off on most of a travel is the same as one that is
off the other way on the rest, since the model has its constant."""

MAX_BINS = 16  # bins of a variable between whose borders a region begins and ends
MAX_LABELS = 40  # features or set-ups beyond which they are not tried one by one
MAX_STARTS = 24  # carriers with one variable that are looked at with a second and a third


class Side(Enum):
    """On which side of its bound a condition holds; the values are those of the files."""

    BELOW = "<"
    FROM = ">="
    IS = "="


class Condition(NamedTuple):
    """One condition on a column of the run file: `B_deg >= 60`, `feature = pad4`."""

    variable: str
    side: Side
    bound: float | str


@dataclass(frozen=True, eq=False)
class Bounded:
    """A column of the run that may bound a region."""

    name: str
    bins: IntArray  # number of the bin of every touch of the run, (N,)
    cuts: tuple[float, ...]  # values between the bins; none of a label
    labels: tuple[str, ...] = ()  # names of the bins of a label

    @cached_property
    def size(self) -> int:
        """Number of bins."""
        return len(self.labels) or len(self.cuts) + 1

    @cached_property
    def ordered(self) -> IntArray:
        """Touches in the order of their bins, (N,)."""
        return np.argsort(self.bins, kind="stable")

    @cached_property
    def is_offered(self) -> Mask:
        """Whether bins i to k are a region, (B, B); of a label only single ones."""
        square = np.ones((self.size, self.size), dtype=bool)
        return np.eye(self.size, dtype=bool) if self.labels else np.triu(square)

    def inside(self, first: int, last: int) -> Mask:
        """Touches in some bins, both included, (N,)."""
        return np.asarray((self.bins >= first) & (self.bins <= last))

    def conditions(self, first: int, last: int) -> Iterator[Condition]:
        """What holds in some bins, both included."""
        if self.labels:
            yield Condition(self.name, Side.IS, self.labels[first])
            return
        if first > 0:
            yield Condition(self.name, Side.FROM, self.cuts[first - 1])
        if last < self.size - 1:
            yield Condition(self.name, Side.BELOW, self.cuts[last])


def bounded(space: ResidualSpace) -> Iterator[Bounded]:
    """Everything that a user can find on the machine.

    Temperatures only where time is not known: they follow it. Places on the standard and directions
    of the normal only where no axis moves.
    """
    touches = space.touches
    known = variables(touches)
    if "time_s" in known:
        known = {k: v for k, v in known.items() if not k.startswith("T_")}
    moves = any(link.column in known for link in map(touches.chain.link, touches.chain.axes))
    for name, values in known.items():
        if moves and name[0] in "pn":
            continue
        cuts = tuple(_cuts(values[space.used]))
        if cuts:
            yield Bounded(name, np.searchsorted(cuts, values, side="right"), cuts)
    setups = np.array([s.name for s in touches.setups])[touches.setup]
    for name, labels in (("feature", touches.feature), ("setup", setups)):
        present, number = np.unique(labels, return_inverse=True)
        if 1 < len(present) <= MAX_LABELS:
            yield Bounded(name, number.reshape(-1), (), tuple(str(p) for p in present))


def _cuts(values: Array) -> list[float]:
    """Round thresholds between the quantiles of some values."""
    unique = np.unique(values)
    if len(unique) < 2:
        return []
    at = np.unique(np.linspace(-1, len(unique) - 1, MAX_BINS + 1).astype(int))[1:-1]
    if not len(at):
        at = np.array([0])
    return [_round_between(float(unique[i]), float(unique[i + 1])) for i in at]


def _round_between(low: float, high: float) -> float:
    """The number with the fewest digits in (low, high].

    Example:
        >>> _round_between(2391.7, 2405.1)
        2400.0
    """
    middle = 0.5 * (low + high)
    for digits in range(-6, 12):
        rounded = round(middle, digits)
        if low < rounded <= high:
            return float(rounded) + 0.0  # no negative zero
    return high


Bins = tuple[int, int]
Box = dict[int, Bins]  # first and last bin of every variable that bounds a region, by its number


class Measure(Protocol):
    """What a region gains if something of its own is allowed in it."""

    def gains(self, rows: Mask, variable: Bounded) -> Array:
        """Log likelihood gained within some touches and bins i to k of a variable, (B, B)."""


class Found(NamedTuple):
    """A box, whose it is, what it gains, and how many such boxes there are."""

    measure: int
    box: Box
    gain: float
    tried: float


def best_box(measures: Sequence[Measure], known: Sequence[Bounded], n: int) -> Found | None:
    """The box that gains most log likelihood beyond the log of the number of boxes of its kind.

    One variable after the other: the best starts are continued with every other variable, and
    the bins of each are set again beside the rest.
    """
    count = [float(v.is_offered.sum()) for v in known]

    @cache
    def largest(m: int, v: int, beside: frozenset[tuple[int, Bins]]) -> tuple[float, Bins]:
        """The largest gain by bins of one variable within bins of others."""
        # boxes of the same touches gain alike: the first one counts, whatever rounding says
        gains = measures[m].gains(rows_in(known, dict(beside), n), known[v]).round(9)
        i, k = np.unravel_index(int(np.argmax(gains)), gains.shape)
        return float(gains[i, k]), (int(i), int(k))

    starts: list[Found] = []
    for m in range(len(measures)):
        for v in range(len(known)):
            gain, bins = largest(m, v, frozenset())
            starts.append(Found(m, {v: bins}, gain, len(measures) * sum(count)))
    starts = [s for s in sorted(starts, key=lambda s: -s.gain)[:MAX_STARTS] if s.gain > 0.0]
    best = max(starts, key=_worth, default=None)
    for size in range(2, MAX_VARIABLES + 1):
        tried = starts[0].tried * sum(count) ** (size - 1) if starts else 1.0
        longer = []
        for start in starts:
            for v in range(len(known)):
                if v not in start.box:
                    box, gain = dict(start.box), start.gain
                    for w in (v, *start.box):  # every variable set again beside the others
                        beside = frozenset((k, bins) for k, bins in box.items() if k != w)
                        gain, box[w] = largest(start.measure, w, beside)
                    longer.append(Found(start.measure, box, gain, tried))
        starts = sorted(longer, key=lambda s: -s.gain)[: MAX_STARTS // 4]
        best = max([*starts, *([best] if best else [])], key=_worth, default=None)
    return best if best is not None and _worth(best) > 0.0 else None


def _worth(found: Found) -> float:
    return found.gain - float(np.log(found.tried))


def rows_in(known: Sequence[Bounded], box: Box, n: int) -> Mask:
    """Of n touches those in a box, (N,)."""
    rows = np.ones(n, dtype=bool)
    for v, bins in box.items():
        rows &= known[v].inside(*bins)
    return rows


def _ends(parts: Array | IntArray) -> Array:
    """Sums of parts (B, ...) of all bins before each and of all, (B + 1, ...)."""
    ends = np.zeros((len(parts) + 1, *parts.shape[1:]))
    parts.cumsum(axis=0, out=ends[1:])
    return ends


def summed(parts: Array | IntArray) -> Array:
    """Sums over bins i to k, both included, of parts (B,), (B, B), or of each of parts (B, K)."""
    ends = _ends(parts).T
    return np.asarray(ends[..., None, 1:] - ends[..., :-1, None])


def squares(parts: Array) -> Array:
    """Squares of the sums of vectors (B, K) over bins i to k, both included, (B, B)."""
    ends = _ends(parts)
    G = ends @ ends.T
    own = np.diag(G)
    return np.asarray(own[None, 1:] + own[:-1, None] - 2.0 * G[:-1, 1:])
