"""Correction of a face to measured points: a smooth change of its control heights.

A penalised least-squares fit of the deviations along the normal; `calibration_fit` has the
equation. It is repeated because the deviations change with the surface; foot points move by slope
times correction, micrometres, and stay where they are.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, kron

from matstd.artefact.body import FreeformPatch
from matstd.artefact.certify.block_tridiagonal import Blocks, Eliminated
from matstd.artefact.certify.waviness import dense_lines, u_waves
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

_WEIGHTS = np.logspace(-8.0, 4.0, 49)  # of the bending: from no penalty to a plane
_MOST_USED = 0.8  # of the points: a fit that follows every one shows no noise
_ROUNDS = 3  # constant after two
_RELATIVE_RIDGE = 1e-12  # of the trace
_GRID = 3.0  # mm between the places over which the uncertainty of the surface is averaged


@dataclass(frozen=True, eq=False)
class CorrectedFace:
    """A face as measured."""

    patch: FreeformPatch
    # root mean square standard uncertainty of the surface over the face, with waves, mm
    u_form: float
    u_tilt: float  # standard uncertainty of its rotations by its points, rad
    moved: float  # largest deviation from the design along the normal, mm
    offset: float  # mean of these deviations over the face, mm
    left: Array  # deviation of every point from the corrected face, (N,), mm
    seen: tuple[bool, bool]  # whether a line of points shows short waves along u and along v


def corrected_face(
    patch: FreeformPatch, points: Array, u_point: float, waviness: float
) -> CorrectedFace:
    """Fit a smooth correction to the deviations of points; dense lines judge it.

    Args:
        points: On the real face, artefact frame, (N, 3), mm.
        u_point: Smallest standard uncertainty of a point, mm; raised to the scatter of the points.
        waviness: Assumed root mean square of waves along a direction without a line, mm.
    """
    heights = patch.heights
    judging, seen = dense_lines(patch.project(points), patch.half_size)
    fitted = points[~judging]
    uv, deviation, tilt = _deviations(patch, fitted)
    # a change of height moves the surface along its normal by the cosine of the slope
    B = _basis(patch, uv, tilt)
    smooth = _Smooth.of(B, deviation, _bending(patch), patch.degree[0] * heights.shape[1])
    before = np.zeros(len(fitted))
    for _ in range(_ROUNDS):
        total = deviation + before
        c = smooth.coefficients(total)
        heights, before = patch.heights + c.reshape(heights.shape), B @ c
        _, deviation, _ = _deviations(replace(patch, heights=heights), fitted)
    scatter = smooth.scatter(total)
    # the Bayesian covariance of the penalised fit includes the bias by the penalty
    noise = max(u_point, scatter) / np.sqrt(len(fitted))
    excess = np.sqrt(max(scatter**2 - u_point**2, 0.0))
    made = replace(patch, heights=heights)
    grid = patch.grid(_GRID)
    flat, slope = _basis(patch, grid), np.hypot(patch.jet(grid).hu, patch.jet(grid).hv)
    G = _basis(patch, grid, np.sqrt(1.0 + slope**2))
    inverse = smooth.matrix.inverse().sparse()
    u = noise * np.sqrt((G @ inverse).multiply(G).sum(axis=1))
    _, left, _ = _deviations(made, points)
    # what lines show contains the error of the fit; without lines residuals stand for it
    alone = float(np.hypot(rms(u), excess))
    u_form = u_waves(left[judging], u_point) if judging.any() else alone
    assumed = waviness * np.sqrt(0.5 * seen.count(False))
    tilts = flat.T @ np.linalg.pinv(np.column_stack([np.ones(len(grid)), grid]))[1:].T
    u_tilts = noise * np.sqrt(np.sum(tilts * smooth.matrix.solve(tilts), axis=0))
    return CorrectedFace(
        patch=made,
        u_form=float(np.hypot(u_form, assumed)),
        u_tilt=rms(u_tilts),
        moved=float(np.abs(G @ c).max()),
        offset=float((G @ c).mean()),
        left=left,
        seen=seen,
    )


def _deviations(patch: FreeformPatch, points: Array) -> tuple[Array, Array, Array]:
    """Foot points, deviations along the normal, and the root of 1 + slope^2 there."""
    uv = patch.project(points)
    deviation = np.einsum("ni,ni->n", patch.normal(uv), points - patch.point(uv))
    jet = patch.jet(uv)
    return uv, deviation, np.sqrt(1.0 + jet.hu**2 + jet.hv**2)


def _basis(patch: FreeformPatch, uv: Array, over: Array | None = None) -> csr_array:
    """Height at uv per unit of every control height, over some numbers (N,), (N, poles)."""
    from scipy.interpolate import BSpline

    along = [
        BSpline.design_matrix(x, knots, k)
        for x, knots, k in zip(uv.T, (patch.knots_u, patch.knots_v), patch.degree, strict=True)
    ]
    (u, i), (v, j) = (
        (one.data.reshape(len(uv), -1), one.indices.reshape(len(uv), -1)) for one in along
    )
    values = u if over is None else u / over[:, None]
    values = values[:, :, None] * v[:, None, :]
    poles = i[:, :, None] * patch.heights.shape[1] + j[:, None, :]
    places = np.arange(len(uv) + 1) * values[0].size
    shape = len(uv), patch.heights.size
    return csr_array((values.ravel(), poles.ravel(), places), shape=shape)


def _splines(patch: FreeformPatch, k: int, x: Array, order: int = 0) -> Array:
    """Derivatives of all B-splines along u (0) or v (1), (N, poles along it)."""
    from scipy.interpolate import BSpline

    knots = (patch.knots_u, patch.knots_v)[k]
    return np.asarray(BSpline(knots, np.eye(patch.heights.shape[k]), patch.degree[k])(x, order))


def _bending(patch: FreeformPatch) -> csr_array:
    """Quadratic form of the bending, mean of ``h_uu^2 + 2 h_uv^2 + h_vv^2``, (poles, poles).

    It is relative to the size of the face.
    """
    gram = []
    for k in (0, 1):
        x = np.unique(patch.grid(_GRID, beyond=1.0)[:, k])
        ways = [_splines(patch, k, x, order) for order in (0, 1, 2)]
        gram.append([csr_array(one.T @ one / len(x)) for one in ways])
    (u0, u1, u2), (v0, v1, v2) = gram
    form = kron(u2, v0) + 2.0 * kron(u1, v1) + kron(u0, v2)
    return csr_array(form * max(patch.half_size) ** 4)


@dataclass(frozen=True, eq=False)
class _Smooth:
    """A penalised fit at fixed foot points."""

    B: csr_array  # deviations per coefficient, (N, M)
    matrix: Eliminated  # ``B^T B / N`` and the weighted penalty
    used: float  # trace of H, which makes fitted deviations of measured ones

    @staticmethod
    def of(B: csr_array, d: Array, penalty: csr_array, size: int) -> "_Smooth":
        """With the weight that cross-validation selects, ``N |d - H d|^2 / (N - tr H)^2``.

        Args:
            B: Deviations per coefficient, (N, M).
            d: Measured deviations, (N,), mm.
            penalty: Of coefficients, (M, M).
            size: Number of coefficients that make blocks which couple with their neighbours alone.
        """
        gram = csr_array(B.T @ B / B.shape[0])
        ridge, whole = _RELATIVE_RIDGE * float(gram.trace()), Blocks.of(gram, size)
        bending = Blocks.of(penalty, size)

        def weighted(weight: float) -> "_Smooth":
            matrix = Eliminated(whole.plus(bending, weight, ridge))
            return _Smooth(B, matrix, used=matrix.inverse().dot(whole))

        # every weight: a minimum of its own stands where the fit begins to follow single points
        return min(map(weighted, _WEIGHTS.tolist()), key=lambda fit: fit.score(d))

    def coefficients(self, d: Array) -> Array:
        """Coefficients for deviations (N,), (M,), mm."""
        return self.matrix.solve(self.B.T @ d) / len(d)

    def score(self, d: Array) -> float:
        """What cross-validation minimises; infinite where the fit follows every point."""
        n = len(d)
        if self.used >= _MOST_USED * n:
            return np.inf
        return n * self._squares(d) / (n - self.used) ** 2

    def scatter(self, d: Array) -> float:
        """Standard deviation of a point beside the fit, mm."""
        return float(np.sqrt(self._squares(d) / (len(d) - self.used)))

    def _squares(self, d: Array) -> float:
        left = d - self.B @ self.coefficients(d)
        return float(left @ left)
