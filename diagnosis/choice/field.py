"""A field of many drives in a fit: the size of its common prior is chosen by what it predicts.

All that is needed of a block of rows are the inner products of its columns, so that leaving blocks
out and changing the prior are sums of small matrices and never go through the rows again.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from matstd.diagnosis.evidence import ResidualSpace, ScaledEffect
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.search import FOUND_PRIOR_FACTOR, DiagnosisTask
from matstd.twin.frames import Array, IntArray
from matstd.twin.model import Effect

PRIOR_SIZES = 2.0 ** np.arange(-10.0, 3.0)
"""Sizes of the prior that are tried, in usual sizes: an octave apart, since the error of prediction
is flat around the best to a factor of two."""

NOISE_PASSES = 2
"""Fits until the noise beside the field has the size for which its prior was chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Inner products of one block: columns of model and field, then the deviation; K + 1."""

    weighted: Array  # over the noise, (K + 1, K + 1)
    plain: Array  # in mm, (K + 1, K + 1)
    rows: int


def sized_field(
    task: DiagnosisTask,
    gross: GrossErrors,
    warm: Effect,
    groups: Sequence[IntArray],
) -> ScaledEffect:
    """A field at the size of its prior with which left-out blocks are predicted best.

    Args:
        groups: Rows of the run in every block; rows not in use are passed over.
    """
    base = task.fit_found((), gross)
    blocks, model = _blocks(base, warm, groups)
    quiet = _quietest(blocks, model)
    errors = [_left_out(blocks, model, quiet, float(size)) for size in PRIOR_SIZES]
    size = float(PRIOR_SIZES[int(np.argmin(errors))])
    sized = ScaledEffect(warm, size / FOUND_PRIOR_FACTOR)
    for _ in range(NOISE_PASSES):
        noise = task.fit_found((sized,), gross).noise.factor / base.noise.factor
        sized = ScaledEffect(warm, size / FOUND_PRIOR_FACTOR * noise / quiet)
    return sized


def _blocks(base: Fit, warm: Effect, groups: Sequence[IntArray]) -> tuple[list[_Block], int]:
    """Inner products of every block that has rows in use, and the number of the model's columns."""
    complement = ResidualSpace.of(base)
    Z = complement.columns([warm])
    Z = Z[:, np.any(Z != 0.0, axis=0)]
    W = np.column_stack([base.X[base.used], Z, base.y[base.used]])
    u = base.u[base.used][:, None]
    place = np.full(len(base.used), -1)
    place[base.used] = np.arange(int(base.used.sum()))
    out = []
    for group in groups:
        rows = place[group]
        part = W[rows[rows >= 0]]
        if len(part):
            plain = part * u[rows[rows >= 0]]
            out.append(_Block(part.T @ part, plain.T @ plain, len(part)))
    return out, base.X.shape[1]


def _quietest(blocks: Sequence[_Block], model: int) -> float:
    """Noise with the field at its usual size, over that of the model without it."""
    G = np.sum([b.weighted for b in blocks], axis=0)
    noise = 1.0
    for _ in range(NOISE_PASSES + 1):
        phi = _solved(G, model, noise, 1.0)
        whole = np.append(-phi, 1.0)
        rows = sum(b.rows for b in blocks)
        noise = float(np.sqrt(max(whole @ G @ whole, 1e-12) / rows))
    return noise


def _solved(G: Array, model: int, noise: float, size: float) -> Array:
    """Parameters from inner products, (K,), with priors of 1 (model) and a size (field)."""
    precision = np.full(len(G) - 1, (noise / size) ** 2)
    precision[:model] = noise**2
    A = G[:-1, :-1] + np.diag(precision)
    return np.asarray(cho_solve(cho_factor(A, check_finite=False), G[:-1, -1], check_finite=False))


def _left_out(blocks: Sequence[_Block], model: int, noise: float, size: float) -> float:
    """Sum of the squared plain errors of all blocks, each predicted by the others, mm^2."""
    G = np.sum([b.weighted for b in blocks], axis=0)
    total = 0.0
    for block in blocks:
        phi = np.append(-_solved(G - block.weighted, model, noise, size), 1.0)
        total += float(phi @ block.plain @ phi)
    return total
