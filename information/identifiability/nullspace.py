"""Null space of the rows of a run or design, in sparse directions.

Columns are scaled to length one first, so the rank does not depend on units and expected sizes.
Parameters that share null directions form separate groups. In each group the directions with the
fewest parameters are found by the smallest sum of absolute weights (a linear program), which for
such geometry gives the pairs and triples that an engineer would name.

Reference:
    Coleman and Pothen, SIAM J. Alg. Disc. Meth. 7 (1986) 527 (sparse null bases, greedy and hard);
    Chen, Donoho and Saunders, SIAM Review 43 (2001) 129 (sparsity by the sum of absolute values).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse.csgraph import connected_components

from matstd.twin.frames import Array, Mask

MIN_SINGULAR_RATIO = 1e-8
"""Singular value over the largest, columns of length one, below which a direction is invisible: far
above rounding, far below the weakest visible direction of a probed run."""
_MIN_LENGTH_RATIO = 1e-12
"""Length of a column over the longest, in any units, below which it is rounding."""
_MIN_WEIGHT_RATIO = 1e-6  # part of a direction's largest weight that counts as zero


@dataclass(frozen=True, eq=False)
class RankAnalysis:
    """Rank analysis of rows, without any prior."""

    length: Array  # of every column, (P,)
    singular: Array  # singular values of the columns brought to length one, largest first, (P,)
    directions: Array  # right singular vectors, one a row, (P, P); silent columns have their own

    @property
    def rank(self) -> int:
        """Number of independent combinations that the rows see."""
        return int(np.sum(self.singular > MIN_SINGULAR_RATIO * self.singular.max()))

    @property
    def condition(self) -> float:
        """Largest over smallest visible singular value, columns of length one."""
        return float(self.singular[0] / self.singular[self.rank - 1]) if self.rank else 1.0

    @cached_property
    def null(self) -> Array:
        """Directions that no row sees, weights of the parameters as they stand in W, (G, P)."""
        rows = self.directions[self.rank :]
        return rows / np.where(_is_loud(self.length), self.length, 1.0)


def _is_loud(length: Array) -> Mask:
    """Columns of some lengths that move anything, (P,)."""
    return np.asarray(length > _MIN_LENGTH_RATIO * length.max(initial=0.0))


def column_lengths(W: Array) -> Array:
    """Lengths of the columns of W (N, P); infinite where only rounding is left, (P,).

    A column divided by it is a direction, or nothing: rounding that is brought to length one would
    count as a direction of the model, and another one on every processor.
    """
    length = np.linalg.norm(W, axis=0)
    return np.where(_is_loud(length), length, np.inf)


def rank_analysis(W: Array) -> RankAnalysis:
    """Rank, singular values and directions of rows (N, P)."""
    P = W.shape[1]
    length = np.linalg.norm(W, axis=0)
    loud, silent = np.flatnonzero(_is_loud(length)), np.flatnonzero(~_is_loud(length))
    singular, directions = np.zeros(P), np.zeros((P, P))
    if len(loud):
        _, s, Vt = np.linalg.svd(np.linalg.qr(W[:, loud] / length[loud], mode="r"))
        singular[: len(s)] = s
        directions[: len(loud), loud] = Vt
    directions[np.arange(len(loud), P), silent] = 1.0
    return RankAnalysis(length, singular, directions)


def condition(W: Array, rank: int) -> float:
    """Largest over smallest visible singular value of rows as they stand, `rank` being visible."""
    s = np.linalg.svd(np.linalg.qr(W, mode="r"), compute_uv=False)
    return float(s[0] / s[rank - 1]) if rank else 1.0


def groups(null: Array) -> list[list[int]]:
    """Parameters that share a null direction, directly or over others; silent ones alone."""
    if not len(null):
        return []
    basis = _basis(null)
    tied = np.abs(basis @ basis.T) > _MIN_WEIGHT_RATIO
    of = connected_components(tied, directed=False)[1]
    of[~np.diag(tied)] = -1  # parameters without a null direction
    return [np.flatnonzero(of == k).tolist() for k in dict.fromkeys(of[of >= 0].tolist())]


def _basis(null: Array) -> Array:
    """Orthonormal null directions, (P, G), where every parameter's largest weight was made one."""
    size = np.abs(null).max(axis=0)
    return np.linalg.qr((null / np.where(size > 0.0, size, 1.0)).T)[0]


def sparse(
    null: Array, last: Sequence[int] = (), inside: Array | None = None
) -> list[tuple[int, Array]]:
    """Independent null directions with few parameters, as many as there are.

    Args:
        null: Null directions, (G, P), in units in which the parameters are of like size.
        last: Parameters by which a direction is named where it has a choice, most wanted first.
        inside: Null directions, (H, P), that shall be spanned by the first of those returned; None
            for none.

    Returns:
        Pairs of the naming parameter, each used once if that can be, and weights (P,), one at that
        parameter.
    """
    P = null.shape[1]
    rank_of = {p: i for i, p in enumerate(last)}
    key = [(rank_of.get(p, len(rank_of)), -p) for p in range(P)]
    vectors: list[Array] = []
    for some in (inside, null):
        if some is None or not len(some):
            continue
        for group in groups(some):
            N = np.linalg.svd(some[:, group])[2][: _dimension(some, group)]
            have = [v[group] for v in vectors if set(np.flatnonzero(v).tolist()) <= set(group)]
            order = sorted(range(len(group)), key=lambda i: key[group[i]])
            for vector in _fewest(N, have, order):
                vectors.append(np.zeros(P))
                vectors[-1][group] = vector
    return _named(vectors, key)


def _named(vectors: list[Array], key: list[tuple[int, int]]) -> list[tuple[int, Array]]:
    """Directions with a naming parameter each, which has weight one."""
    out, taken = [], set()
    for vector in vectors:
        members = np.flatnonzero(vector).tolist()
        free = [p for p in members if p not in taken] or members
        lead = min(free, key=lambda p: key[p])
        taken.add(lead)
        out.append((lead, vector / vector[lead]))
    return out


def _dimension(null: Array, group: list[int]) -> int:
    """Null directions within a group: the trace of its block of the projection on all of them.

    No singular value is compared with rounding: the block of a whole group is a projection itself.
    """
    return round(float((_basis(null)[group] ** 2).sum()))


def _fewest(N: Array, have: list[Array], order: list[int]) -> list[Array]:
    """Independent directions of the span of rows N (g, p), those with the fewest weights first.

    Args:
        N: Orthonormal directions.
        have: Directions of the span that are there already.
        order: Of the parameters; of two that are the same but for size the earlier is eliminated.
    """
    g, p = N.shape
    pairs, gone = _pairs(N, order)
    rest = N
    if gone:
        rest = np.linalg.svd(N[:, gone].T)[2][len(gone) :] @ N  # without the eliminated parameters
    chosen = _independent([*have, *pairs], [], g)
    if len(chosen) < g:
        found = [z for lead in range(p) if (z := _smallest(rest, lead)) is not None]
        found.sort(key=lambda z: (np.count_nonzero(z), round(float(np.abs(z).sum()), 9)))
        chosen = _independent([*found, *N], chosen, g)
    return chosen[len(have) :]


def _independent(vectors: list[Array], chosen: list[Array], most: int) -> list[Array]:
    """Those chosen and of some vectors, in their order, as many as are independent."""
    chosen = list(chosen)
    basis = np.linalg.qr(np.array(chosen).T)[0].T if chosen else np.zeros((0, len(vectors[0])))
    for z in vectors:
        if len(chosen) == most:
            break
        left = z - basis.T @ (basis @ z)
        left = left - basis.T @ (basis @ left)
        if np.linalg.norm(left) > _MIN_WEIGHT_RATIO * np.linalg.norm(z):
            chosen.append(np.where(np.abs(z) > _MIN_WEIGHT_RATIO * np.abs(z).max(), z, 0.0))
            basis = np.vstack([basis, left / np.linalg.norm(left)])
    return chosen


def _pairs(N: Array, order: list[int]) -> tuple[list[Array], list[int]]:
    """Null directions of two parameters, and the parameter of each that they eliminate."""
    p = N.shape[1]
    seen_part = np.eye(p) - N.T @ N
    size = np.sqrt(np.maximum(np.diag(seen_part), 0.0))
    vectors, gone = [], []
    for at, i in enumerate(order):
        z = np.eye(p)[i]
        if size[i] >= 1e-7:  # else it moves nothing by itself
            alike = np.abs(seen_part[i]) > (1.0 - 1e-10) * size[i] * size
            j = next((j for j in reversed(order[at + 1 :]) if size[j] > 1e-7 and alike[j]), None)
            if j is None:
                continue
            z[j] = -np.sign(seen_part[i, j]) * size[i] / size[j]
        vectors.append(z)
        gone.append(i)
    return vectors, gone


def _smallest(N: Array, lead: int) -> Array | None:
    """Direction with weight one at a parameter and the smallest sum of absolute weights, (p,)."""
    g, p = N.shape
    if not g or np.abs(N[:, lead]).max() < 1e-9:
        return None
    # z = N^T c with -t <= z <= t, smallest sum of t
    unit = np.eye(p)
    from scipy.optimize import linprog

    found = linprog(
        np.concatenate([np.zeros(g), np.ones(p)]),
        A_ub=np.block([[N.T, -unit], [-N.T, -unit]]),
        b_ub=np.zeros(2 * p),
        A_eq=np.concatenate([N[:, lead], np.zeros(p)])[None],
        b_eq=[1.0],
        bounds=[(None, None)] * g + [(0.0, None)] * p,
        method="highs",
    )
    if found.status != 0:
        return None
    z = N.T @ found.x[:g]
    support = np.abs(z) > _MIN_WEIGHT_RATIO * np.abs(z).max()
    if not support[lead]:  # beside the others it is nothing but rounding
        return None
    # the same support again, exactly: what is outside it is made zero by least squares
    U, s, _ = np.linalg.svd(N[:, ~support], full_matrices=False)
    U = U[:, s > _MIN_WEIGHT_RATIO]  # less than that is rounding of the readings, not a weight
    c = found.x[:g] - U @ (U.T @ found.x[:g])
    z = np.where(support, N.T @ c, 0.0)
    return np.asarray(z / z[lead])
