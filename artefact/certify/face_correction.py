"""Correction of a face to measured points: a smooth change of its control heights.

A penalised least-squares fit of the deviations along the normal; `calibration_fit` has the
equation. The linear fit is repeated because the foot points move with the surface.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import FreeformPatch
from matstd.artefact.certify.waviness import dense_lines, u_waves
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

_WEIGHTS = np.logspace(-8.0, 4.0, 49)  # of the bending: from no penalty to a plane
_ROUNDS = 3  # foot points move by slope times correction, micrometres: constant after two rounds
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
    bend = _bending(patch)
    heights = patch.heights
    judging, seen = dense_lines(patch.project(points), patch.half_size)
    fitted = points[~judging]
    for _ in range(_ROUNDS):
        uv, deviation, tilt = _deviations(replace(patch, heights=heights), fitted)
        B = (
            _basis(patch, uv) / tilt[:, None]
        )  # a change of height moves the surface along its normal by the cosine of the slope
        before = B @ (heights - patch.heights).ravel()
        c, root, excess = _smooth(B, deviation + before, bend, u_point)
        heights = patch.heights + c.reshape(heights.shape)
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
    nu, nv = patch.heights.shape
    columns = []
    for k in range(nu * nv):
        one = np.zeros(nu * nv)
        one[k] = 1.0
        columns.append(replace(patch, heights=one.reshape(nu, nv)).height(uv))
    return np.stack(columns, axis=1)


def _bending(patch: FreeformPatch) -> Array:
    """Root of the mean squared second derivatives of a correction, (3 M, poles), per mm."""
    nu, nv = patch.heights.shape
    grid = patch.grid(_GRID, beyond=1.0)
    rows = []
    for k in range(nu * nv):
        one = np.zeros(nu * nv)
        one[k] = 1.0
        j = replace(patch, heights=one.reshape(nu, nv)).jet(grid)
        rows.append(np.concatenate([j.huu, np.sqrt(2.0) * j.huv, j.hvv]))
    R = np.linalg.qr(np.stack(rows, axis=1), mode="r")
    return np.asarray(R / np.sqrt(len(grid)) * max(patch.half_size) ** 2)


def _smooth(B: Array, d: Array, bend: Array, u_point: float) -> tuple[Array, Array, float]:
    """Coefficients, square root of their covariance, and scatter beyond that of a point, mm.

    The weight minimises ``n |d - H d|^2 / (n - tr H)^2``.
    """
    n, best = len(d), None
    gram, right, penalty = B.T @ B / n, B.T @ d / n, bend.T @ bend
    ridge = 1e-12 * np.trace(gram) * np.eye(len(gram))
    for weight in _WEIGHTS:
        M = gram + weight * penalty + ridge
        c = np.linalg.solve(M, right)
        used = float(np.trace(np.linalg.solve(M, gram)))
        left = d - B @ c
        score = n * float(left @ left) / max(n - used, 1e-3) ** 2
        if used < 0.8 * n and (best is None or score < best[0]):
            best = score, c, M, used, float(left @ left)
    assert best is not None
    _, c, M, used, squares = best
    scatter = float(np.sqrt(squares / max(n - used, 1.0)))
    noise = max(u_point, scatter)
    # the Bayesian covariance of the penalised fit includes the bias by the penalty
    root = np.linalg.cholesky(np.linalg.inv(M)) * noise / np.sqrt(n)
    return c, root, float(np.sqrt(max(scatter**2 - u_point**2, 0.0)))
