"""Evidence of smooth curves and surfaces at every carrier of a run, all carriers at once.

Waves of one or two variables, times the columns of a carrier, are regressed on what a model leaves.
Their inner products are kept from one model of a run to the next: models with and without a law
differ in a dozen directions of the data, so that a second search costs a fifth of the first.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.residual import Bearer
from matstd.twin.frames import Array
from matstd.twin.laws import Driver

SIZES = np.geomspace(0.3, 300.0, 7)  # sizes of curves, in units of the noise at a touch

BETWEEN_SIZES = 5.0
"""Most log evidence that a size between two of every second one adds; less than 2 was seen."""

CURVE_CHARGE = 4.0  # log evidence that size and length of a curve cost
MOST_NUMBERS = 8_000_000  # numbers of a product that stand in memory at a time: 64 MB

SAME_IMITATION = 1e-9
"""Change of the share of a direction that a model imitates, below which it is rounding."""


class Waves(NamedTuple):
    """Waves of one or two variables."""

    drivers: tuple[Driver, ...]
    B: Array  # at all touches, (N, K)
    weights: Array  # prior deviations of their amplitudes for every correlation length, (L, K)
    lengths: Sequence[float]  # those lengths, as shares of the domain; 0 for a direction


class Evidence(NamedTuple):
    """Log evidence of curves at several carriers, (M,)."""

    value: Array
    explained: Array  # squared residual that the best explains
    which: Array  # number of the best length
    size: Array  # best size, in units of the noise


class Group:
    """Columns of carriers of one number of columns, scaled to one noise at a touch on average.

    Attributes:
        C: Scaled, (M, N, k).
        scale: What they were divided by, (M,).
    """

    def __init__(self, C: Array, bearers: Sequence[Bearer] = ()) -> None:
        self.bearers = tuple(bearers)
        self.scale = np.sqrt((C**2).sum(axis=2).mean(axis=1))
        self.C = C / np.maximum(self.scale, 1e-300)[:, None, None]

    def gram(self, B: Array) -> Array:
        """Inner products of all columns times waves (N, K), (M, k K, k K)."""
        M, N, k = self.C.shape
        K = B.shape[1]
        one, other = np.tril_indices(K)
        out = np.zeros((M * k * k, len(one)))
        for rows in _blocks(N, len(one)):
            C, waves = self.C[:, rows], np.ascontiguousarray(B[rows].T)
            squares = (C[:, :, :, None] * C[:, :, None, :]).transpose(0, 2, 3, 1)
            out += squares.reshape(M * k * k, -1) @ (waves[one] * waves[other]).T
        G = np.empty((M, k, k, K, K))
        G[..., one, other] = G[..., other, one] = out.reshape(M, k, k, -1)
        return G.transpose(0, 1, 3, 2, 4).reshape(M, k * K, k * K)

    def right_side(self, r: Array, B: Array) -> Array:
        """Inner products of columns times waves with a residual (N,), (M, k K)."""
        M, N, k = self.C.shape
        return ((self.C * r[:, None]).transpose(0, 2, 1).reshape(M * k, N) @ B).reshape(M, -1)


def _blocks(count: int, width: int) -> list[slice]:
    """Rows in blocks whose products stand in memory."""
    step = max(1, MOST_NUMBERS // max(width, 1))
    return [slice(at, at + step) for at in range(0, count, step)]


@dataclass(eq=False)
class Curves:
    """Inner products of all carriers with waves, freed of what a model imitates of the data."""

    groups: tuple[Group, ...]  # the carriers, by their number of columns
    waves: tuple[Waves, ...]  # of every variable and of pairs of them
    _taken: Array | None = None
    _grams: dict[tuple[int, int], Array] = field(default_factory=dict)

    @classmethod
    def of(cls, bearers: Sequence[Bearer], waves: Sequence[Waves]) -> "Curves":
        """Before any model."""
        counts = sorted({b.C.shape[1] for b in bearers})
        each = [[b for b in bearers if b.C.shape[1] == k] for k in counts]
        groups = [Group(np.stack([b.C for b in alike]), alike) for alike in each]
        return cls(tuple(groups), tuple(waves))

    def evidence(self, space: Space, least: float) -> list[tuple[Waves, Group, Evidence]]:
        """Of all waves at all carriers; exact above the least."""
        self._free_of(space)
        out = []
        for i, group in enumerate(self.groups):
            k = group.C.shape[2]
            for j, waves in enumerate(self.waves):
                b = group.right_side(space.r, waves.B)
                weights = np.tile(waves.weights, (1, k))
                found = curve_evidence(space, self._grams[i, j], b, weights, least)
                out.append((waves, group, found))
        return out

    def _free_of(self, space: Space) -> None:
        """Take from the inner products what another model takes away more than the last one.

        That is what it imitates, and rows that it does not use.
        """
        rows = np.flatnonzero(~space.used)
        unused = np.zeros((space.count, len(rows)))
        unused[rows, np.arange(len(rows))] = 1.0
        taken = np.hstack([space.basis, unused])
        V, more = _difference(self._taken, taken)
        for i, group in enumerate(self.groups):
            M, N, k = group.C.shape
            at_a_time = max(1, MOST_NUMBERS // max(N * k * len(more), 1))
            for first in range(0, M, at_a_time):
                own = slice(first, first + at_a_time)
                CV = np.einsum("mnk,nr->mkrn", group.C[own], V).reshape(-1, N)
                for j, waves in enumerate(self.waves):
                    if self._taken is None and first == 0:
                        self._grams[i, j] = group.gram(waves.B)
                    K = waves.B.shape[1]
                    U = (CV @ waves.B).reshape(-1, k, len(more), K)
                    U = U.transpose(0, 2, 1, 3).reshape(-1, len(more), k * K)
                    self._grams[i, j][own] -= (U * more[:, None]).transpose(0, 2, 1) @ U
        self._taken = taken


def _difference(before: Array | None, after: Array) -> tuple[Array, Array]:
    """V (N, R) and d (R,) with ``A2 A2^T - A1 A1^T = V diag(d) V^T``, rounding left out."""
    if before is None:
        return after, np.ones(after.shape[1])
    Q, R = np.linalg.qr(np.hstack([after, before]))
    sign = np.r_[np.ones(after.shape[1]), -np.ones(before.shape[1])]
    more, vectors = np.linalg.eigh((R * sign) @ R.T)
    kept = np.abs(more) > SAME_IMITATION
    kept[np.argmax(np.abs(more))] = True  # none would leave arrays without columns
    return Q @ vectors[:, kept], more[kept]


def curve_evidence(
    space: Space, G: Array, b: Array, weights: Array, least: float = -np.inf
) -> Evidence:
    """Best log evidence over lengths and sizes, with the number of the length and the size.

    Args:
        G: Inner products of the columns of every carrier, freed of the model, (M, K, K).
        b: Of the columns with the residual, (M, K).
        weights: Prior deviations for every length, (L, K).
        least: Evidence below which it need not be exact: every second size is tried there.
    """
    each = np.full((2, len(b), len(weights), len(SIZES)), -np.inf)
    each[..., ::2] = _by_size(space, G, b, weights, SIZES[::2])
    near = each[0].max(axis=(1, 2)) > least - BETWEEN_SIZES
    if near.any():
        each[:, near, :, 1::2] = _by_size(space, G[near], b[near], weights, SIZES[1::2])
    values, explained = each.reshape(2, len(b), -1)
    best = np.argmax(values, axis=1)
    return Evidence(
        value=values[np.arange(len(b)), best] - CURVE_CHARGE,
        explained=explained[np.arange(len(b)), best],
        which=best // len(SIZES),
        size=SIZES[best % len(SIZES)],
    )


def _by_size(space: Space, G: Array, b: Array, weights: Array, sizes: Array) -> Array:
    """Log evidence of curves, nothing charged, and what they explain, (2, M, L, sizes).

    ``log p(y) = -1/2 log det(1 + s^2 G) - nu/2 log(y^T (1 + s^2 C C^T)^-1 y)``, both from one
    Cholesky factor of ``1 + s^2 G`` bordered by ``s b``: its last pivot holds what is explained.
    """
    M, K = b.shape
    s2 = sizes**2
    out = np.empty((2, M, len(weights), len(sizes)))
    bordered = np.empty((M, len(sizes), K + 1, K + 1))
    for i, w in enumerate(weights):
        wb = w * b
        corner = 1.0 + s2 * (wb**2).sum(axis=1)[:, None]
        bordered[..., :K, :K] = s2[:, None, None] * (w[:, None] * G * w)[:, None] + np.eye(K)
        bordered[..., K, :K] = bordered[..., :K, K] = sizes[:, None] * wb[:, None]
        bordered[..., K, K] = corner
        pivots = np.diagonal(np.linalg.cholesky(bordered), axis1=2, axis2=3)
        explained = corner - pivots[..., K] ** 2
        out[0, :, i] = space.gained(explained) - np.log(pivots[..., :K]).sum(axis=2)
        out[1, :, i] = explained
    return out
