"""Correction of a face to measured points: a smooth change of its control heights.

A penalised least-squares fit of the deviations along the normal; `calibration_fit` has the
equation. It is repeated because the deviations change with the surface; foot points move by slope
times correction, micrometres, and stay where they are.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import FreeformPatch
from matstd.artefact.certify.waviness import dense_lines, u_waves
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

_WEIGHTS = np.logspace(-8.0, 4.0, 49)  # of the bending: from no penalty to a plane
_ROUNDS = 3  # constant after two
_UNIT, _RIDGE = 1e-4, 1e-12  # weight at which the fit is made diagonal; of its trace
_GRID = 3.0  # mm between the places over which the uncertainty of the surface is averaged


@dataclass(frozen=True, eq=False)
class CorrectedFace:
    """A face as measured.

    Attributes:
        u_form: Root mean square standard uncertainty of the surface over the face, with waves, mm.
        seen: Whether a line of points shows short waves along u and along v.
        u_tilt: Standard uncertainty of its rotations by its points, rad.
        moved: Largest deviation from the design along the normal, mm.
        offset: Mean of these deviations over the face, mm.
        left: Deviation of every point from the corrected face, (N,), mm.
    """

    patch: FreeformPatch
    u_form: float
    u_tilt: float
    moved: float
    offset: float
    left: Array
    seen: tuple[bool, bool]


def corrected_face(
    patch: FreeformPatch, points: Array, u_point: float, waviness: float = 0.0
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
    B = _basis(patch, uv) / tilt[:, None]
    smooth = _Smooth.of(B, _bending(patch), u_point)
    before = np.zeros(len(B))
    for _ in range(_ROUNDS):
        c, root, excess = smooth.fit(deviation + before)
        heights, before = patch.heights + c.reshape(heights.shape), B @ c
        _, deviation, _ = _deviations(replace(patch, heights=heights), fitted)
    made = replace(patch, heights=heights)
    grid = patch.grid(_GRID)
    slope = np.hypot(patch.jet(grid).hu, patch.jet(grid).hv)
    G = _basis(patch, grid) / np.sqrt(1.0 + slope**2)[:, None]
    u = np.linalg.norm(G @ root, axis=1)
    _, left, _ = _deviations(made, points)
    # what lines show contains the error of the fit; without lines residuals stand for it
    alone = float(np.hypot(rms(u), excess))
    u_form = u_waves(left[judging], u_point) if judging.any() else alone
    assumed = waviness * np.sqrt(0.5 * seen.count(False))
    plane = np.column_stack([np.ones(len(grid)), grid])
    tilts = np.linalg.lstsq(plane, _basis(patch, grid) @ root, rcond=None)[0][1:]
    return CorrectedFace(
        patch=made,
        u_form=float(np.hypot(u_form, assumed)),
        u_tilt=float(np.linalg.norm(tilts) / np.sqrt(2.0)),
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


def _basis(patch: FreeformPatch, uv: Array) -> Array:
    """Height at uv per unit of every control height, (N, poles)."""
    along_u, along_v = (_splines(patch, k, uv[:, k]) for k in (0, 1))
    return np.asarray((along_u[:, :, None] * along_v[:, None, :]).reshape(len(uv), -1))


def _splines(patch: FreeformPatch, k: int, x: Array, order: int = 0) -> Array:
    """Derivatives of all B-splines along u (0) or v (1), (N, poles along it)."""
    from scipy.interpolate import BSpline

    knots = (patch.knots_u, patch.knots_v)[k]
    return np.asarray(BSpline(knots, np.eye(patch.heights.shape[k]), patch.degree[k])(x, order))


def _bending(patch: FreeformPatch) -> Array:
    """Quadratic form of the bending, mean of ``h_uu^2 + 2 h_uv^2 + h_vv^2``, (poles, poles).

    It is relative to the size of the face.
    """
    gram = []
    for k in (0, 1):
        x = np.unique(patch.grid(_GRID, beyond=1.0)[:, k])
        ways = [_splines(patch, k, x, order) for order in (0, 1, 2)]
        gram.append([one.T @ one / len(x) for one in ways])
    (u0, u1, u2), (v0, v1, v2) = gram
    form = np.kron(u2, v0) + 2.0 * np.kron(u1, v1) + np.kron(u0, v2)
    return np.asarray(form * max(patch.half_size) ** 4)


@dataclass(frozen=True, eq=False)
class _Smooth:
    """A penalised fit at fixed foot points, solved for every weight at once.

    With the vectors V that make gram + w0 penalty the unit and gram diagonal (mu), the matrix of
    the fit with the weight w is ``mu + w / w0 (1 - mu)``, and so is its trace.

    Attributes:
        B: Deviations per coefficient, (N, M).
        V: The vectors, (M, M).
        mu: Share of the points in each, (M,).
        u_point: Smallest standard uncertainty of a point, mm.
    """

    B: Array
    V: Array
    mu: Array
    u_point: float

    @staticmethod
    def of(B: Array, penalty: Array, u_point: float) -> "_Smooth":
        """For deviations per coefficient (N, M) and a penalty (M, M)."""
        from scipy.linalg import eigh

        gram = B.T @ B / len(B)
        unit = gram + _UNIT * penalty + _RIDGE * np.trace(gram) * np.eye(len(gram))
        mu, V = eigh(gram, unit)
        return _Smooth(B, V, np.clip(mu, 0.0, 1.0), u_point)

    def fit(self, d: Array) -> tuple[Array, Array, float]:
        """Coefficients, square root of their covariance, and scatter beyond that of a point, mm.

        The weight minimises ``n |d - H d|^2 / (n - tr H)^2``.
        """
        n, best = len(d), None
        right, BV = self.V.T @ (self.B.T @ d) / n, self.B @ self.V
        for weight in _WEIGHTS:
            stiff = self.mu + weight / _UNIT * (1.0 - self.mu) + _RIDGE
            used = float(np.sum(self.mu / stiff))
            left = d - BV @ (right / stiff)
            score = n * float(left @ left) / max(n - used, 1e-3) ** 2
            if used < 0.8 * n and (best is None or score < best[0]):
                best = score, stiff, used, float(left @ left)
        assert best is not None
        _, stiff, used, squares = best
        scatter = float(np.sqrt(squares / max(n - used, 1.0)))
        noise = max(self.u_point, scatter)
        # the Bayesian covariance of the penalised fit includes the bias by the penalty
        root = self.V / np.sqrt(stiff) * noise / np.sqrt(n)
        return self.V @ (right / stiff), root, float(np.sqrt(max(scatter**2 - self.u_point**2, 0)))
