"""Foot points of the balls at their true places.

Machine errors of a quarter of a millimetre along the surface move the contact away from the foot
point of the believed ball. The curvature in between, some micrometres, would appear as a deviation.
The ordinary model of the machine, fitted to the run itself, gives the place of the ball to some
micrometres, also at poses with few touches. An error that the model lacks moves a foot point by its
own size, over which the curvature is negligible.
"""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.twin.effects import further_styli, setup_errors
from matstd.twin.frames import Array
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model
from matstd.twin.record import Labels, Run, computed_deviation
from matstd.twin.units import UM

_NOISE = 2.0 * UM
"""Least uncertainty of a touch in the fit, mm: errors that the model lacks are of this size."""

_HUBER = 3.0  # multiple of the median residual beyond which Huber weights decrease

_DISPLACED = 50.0 * UM
"""Displacement of a feature that means it was moved or calibrated wrongly, mm: no machine model
leaves residuals of this size at all touches of one feature alone."""

_RADIUS_SD = 0.1  # standard deviation of a radius that may be stated wrongly, mm

_WRONG_RADIUS = 10.0 * UM
"""Error of the stated radius from which contacts allow for it, mm. The set-up moves by about as
much, and a foot point on a ball of 6 mm by the square of that over 12 mm: 0.8 um for 0.1 mm, which
the radius found would be wrong by, and 0.01 um here."""

_LEFT_BY_RADIUS = 0.5
"""Most that a wrong radius leaves of the sum of squares: a chip on one of few touches asks for one,
too, and takes a small part of it away."""

_SIGNIFICANT = 4.0  # least ratio of such a displacement to its standard error
_ROUNDS = 4  # with errors of ordinary size and a standard 1 mm beside its place three were enough
_CONVERGED = 1e-5  # change of deviations in a round below which the iteration has converged, mm


def foot_points(
    standard: Standard, feature: Labels, ball: Array, moved: Array | float = 0.0
) -> tuple[Array, Array]:
    """Foot points (N, 3) of balls (N, 3) on their features, and outward normals, artefact frame.

    nan where a ball is so far off that its surface has no foot point for it.

    Args:
        moved: Displacements of the features from their calibrated places, (N, 3), mm.
    """
    ball = ball - moved
    point, normal = np.full(ball.shape, np.nan), np.full(ball.shape, np.nan)
    for name in dict.fromkeys(feature.tolist()):
        rows = np.flatnonzero(feature == name)
        surface = standard.features[name]
        uv = surface.project(ball[rows])
        there = np.all(np.isfinite(uv), axis=1)
        point[rows[there]] = surface.point(uv[there])
        normal[rows[there]] = surface.normal(uv[there])
    return point + moved, normal


def at_true_contacts(run: Run, standard: Standard) -> Run:
    """A run with the points and normals at which the balls met the standard, where they exist.

    ``p = foot point of (x + d)``, x the believed ball centre and d its displacement relative to the
    standard by the fitted model. The deviations ``n . (x - p) - radius`` remain those
    of the believed balls, referred to better points and normals.
    """
    weight, t = np.ones(len(run)), run.touches
    moved = standard.moved(t.chain, t.q, t.T_table_artefact, t.feature)
    for _ in range(_ROUNDS):
        t, before = run.touches, run.deviation
        beside, residual, weight = _displacement(run, weight)
        point, normal = foot_points(standard, t.feature, t.ball_artefact + beside, moved)
        found = np.all(np.isfinite(point), axis=1, keepdims=True)
        t = replace(
            t, point=np.where(found, point, t.point), normal=np.where(found, normal, t.normal)
        )
        run = replace(run, touches=t, deviation=computed_deviation(t))
        if np.abs(run.deviation - before).max() < _CONVERGED:
            break
    remarks = (*_displaced_feature(run, residual), *_stylus_lines(run))
    return replace(run, remarks=(*run.remarks, *remarks))


def _displaced_feature(run: Run, residual: Array) -> list[str]:
    """Remark on the feature that is displaced most; none where all are in place.

    ``residual = n . e`` by least squares over the touches of each feature. The set-up absorbs a
    part of e, so the other features seem displaced too, but less.
    """
    t, largest, out = run.touches, _DISPLACED, []
    for name in dict.fromkeys(t.feature.tolist()):
        rows = np.flatnonzero(t.feature == name)
        n, r = t.normal[rows], residual[rows]
        if len(rows) < 2 * n.shape[1] or np.linalg.matrix_rank(n, tol=0.1) < n.shape[1]:
            continue
        e = np.linalg.lstsq(n, r, rcond=None)[0]
        left = np.sqrt(np.sum((r - n @ e) ** 2) / (len(rows) - n.shape[1]))
        error = left * np.sqrt(np.trace(np.linalg.inv(n.T @ n)))
        size = float(np.linalg.norm(e))
        if size > max(largest, _SIGNIFICANT * error):
            largest, (x, y, z) = size, e
            out = [
                f"{name} stands {size:.3f} mm beside its calibrated place on the standard, seen "
                f"from the others (x {x:+.3f}, y {y:+.3f}, z {z:+.3f} mm): moved, or calibrated "
                "wrongly"
            ]
    return out


def _stylus_lines(run: Run) -> list[str]:
    """Remarks on the offset of every further stylus from its calibration, by the same model."""
    t = run.touches
    styli = further_styli(t)
    free = (*(e for e in setup_errors(t) if e not in styli), *styli)
    model = Model(t.chain, (*ordinary_model(t.chain).effects, *free))
    sd = np.array([p.sd for effect in model.effects for p in effect.parameters])
    A, end, out = np.zeros((0, len(sd))), len(sd), []
    for stylus in reversed(styli):
        if not len(A):
            A = np.concatenate([model.columns(t) * sd / run.u[:, None], np.eye(len(sd))])
            y = np.concatenate([run.deviation / run.u, np.zeros(len(sd))])
            root = np.linalg.pinv(A)
        place = slice(end - len(stylus.parameters), end)
        found, u = sd[place] * (root[place] @ y), sd[place] * np.linalg.norm(root[place], axis=1)
        x, y_, z, r = (f"{a / UM:+.1f} ± {b / UM:.1f}" for a, b in zip(found, u, strict=True))
        out.append(
            f"stylus of length {stylus.length:.3f} mm and radius {stylus.radius:.3f} mm: against "
            f"the first its ball stands x {x}, y {y_}, z {z} µm beside its calibration (tool "
            f"frame), its radius is {r} µm larger; both are free in every fit"
        )
        end = place.start
    return out[::-1]


def _displacement(run: Run, weight: Array) -> tuple[Array, Array, Array]:
    """Displacements of the balls relative to the standard, artefact frame, (N, 3), mm.

    Least squares with the prior of the model as further rows: minimises
    ``weight |A theta - dev|^2 / noise^2 + |theta / sd|^2``. Undetermined parameters stay
    zero. Also returns the residuals (N,) and Huber weights (N,) of the next round, which limit the
    influence of a chip.
    """
    t = run.touches
    model = Model(t.chain, (*ordinary_model(t.chain).effects, *setup_errors(t)))
    sd = np.array([p.sd for effect in model.effects for p in effect.parameters])
    root = np.sqrt(weight) / np.maximum(run.u, _NOISE)
    # last a radius of the ball that is stated wrongly, which the set-up would imitate
    columns, sd = np.column_stack([model.columns(t), np.ones(len(t))]), np.append(sd, _RADIUS_SD)
    theta, with_radius = _fitted(columns, sd, root, run.deviation)
    usual, without = _fitted(columns[:, :-1], sd[:-1], root, run.deviation)
    if abs(theta[-1]) < _WRONG_RADIUS or with_radius > _LEFT_BY_RADIUS * without:
        theta = np.append(usual, 0.0)
    residual = run.deviation - columns @ theta
    left = np.abs(residual)
    most = _HUBER * max(float(np.median(left)), _NOISE)
    return model.relative_deviation(t, theta[:-1]), residual, most / np.maximum(left, most)


def _fitted(columns: Array, sd: Array, root: Array, deviation: Array) -> tuple[Array, float]:
    """Parameters (P,) by weighted least squares with their prior, and what is left of its sum.

    Undetermined ones are zero.
    """
    A = np.concatenate([columns * sd * root[:, None], np.eye(len(sd))])
    y = np.concatenate([deviation * root, np.zeros(len(sd))])
    phi = np.linalg.lstsq(A, y, rcond=None)[0]
    return np.asarray(sd * phi), float(np.sum((y - A @ phi) ** 2))
