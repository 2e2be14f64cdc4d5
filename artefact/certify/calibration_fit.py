"""The standard as measured, from points of a coordinate measuring machine.

Balls are fitted with centre and radius. A least-squares rigid motion takes their centres, and with
them all points, to the frame of the design. Every face then receives a smooth correction of its
control heights,

    d = n . (p - foot point) = B c + noise,    c penalised by the bending of the correction,

with the weight of the penalty by generalised cross-validation; planes are never penalised, so
that position and tilts of a face are free. The residuals estimate the noise; with it the covariance
of c gives the uncertainty of the surface between the points.

Reference:
    Wahba, Spline Models for Observational Data, 4 (generalised cross-validation).
    JCGM 100:2008, F.2.4.5 (errors that the points of one feature share are stated, not found).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from matstd.artefact.body import (
    FreeformPatch,
    Known,
    KnownFeature,
    Standard,
    Verdict,
    fitted_sphere,
)
from matstd.artefact.certify.cmm_points_file import SIDES, CmmPoints
from matstd.artefact.certify.face_correction import corrected_face
from matstd.twin.errors import BadFile, NotEnoughData
from matstd.twin.frames import Array, Mask, apply
from matstd.twin.numbers import rms
from matstd.twin.record import rigid_motion
from matstd.twin.units import UM

MIN_BALL, MIN_FACE = 6, 20
"""Fewest points on a ball (four determine it) and on a face (six move it, the rest bend it)."""

MIN_BALLS = 3  # fewest balls that determine the alignment

_OUTLIER_LIMIT = 6.0
"""Robust standard deviations beyond which a point is left out as dust or mistake; not one of a
thousand good points lies so far out."""

_MAX_MISFIT = 0.5  # mm from its feature: a point of another feature, or a mistake
_UNITS = {"µm": 1e3, "m": 1e-3, "inches": 1.0 / 25.4, "cm": 0.1}
_UNIT_TOLERANCE = 0.01  # relative difference of distances: parts agree better, other units do not


@dataclass(frozen=True)
class CalibrationFit:
    """A calibrated standard and the results of its calibration."""

    standard: Standard  # calibrated
    moved: dict[str, float]  # largest deviation of every feature from the design, mm
    offset: dict[str, float]  # mean deviation of every face along the normal, mm
    u_radius: dict[str, float]  # standard uncertainty of the radius of every ball by its points, mm
    left: dict[str, float]  # root mean square of the residuals of every feature, mm
    # peak to valley of every ball by its points, less what their noise makes, mm
    form: dict[str, float]
    unseen: tuple[str, ...]  # faces on which dense lines are missing, so that `waviness` is assumed
    waviness: float  # assumed root mean square of waves that the points cannot show, mm
    u_point: float  # standard uncertainty of one point as stated, mm
    remarks: tuple[str, ...]  # unused points and other irregularities

    @property
    def known(self) -> Known:
        """What the calibration knows of the standard."""
        assert self.standard.known is not None
        return self.standard.known

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """Conformity of the features with the drawing, once evaluated."""
        return () if self.standard.known is None else self.standard.known.verdicts


def fit_calibration(
    nominal: Standard, cmm: CmmPoints, u_point: float, u_feature: float, waviness: float
) -> CalibrationFit:
    """Fit the standard to the points of a CMM.

    Args:
        u_point: Standard uncertainty of one point, independent between points, mm.
        u_feature: Standard uncertainty that the points of a feature share (scales and squareness of
            the CMM, qualification of its stylus), mm.
        waviness: Assumed root mean square of waves of faces that the points cannot show, mm.

    Raises:
        BadFile: Points in other units, or far from every feature.
        NotEnoughData: Too few points on a feature, or too few balls.
    """
    slips: list[str] = []
    balls = measured_balls(nominal, cmm, u_point, slips)
    T_artefact_cmm = alignment(nominal, cmm, {n: b.centre for n, b in balls.items()})
    point = apply(T_artefact_cmm, cmm.point)
    known, moved, left, offset, spheres, patches = {}, {}, {}, {}, [], []
    unseen: list[str] = []
    for sphere in nominal.spheres:
        if sphere.name not in balls:
            spheres.append(sphere)
            continue
        ball = balls[sphere.name]
        centre = apply(T_artefact_cmm, ball.centre[None])[0]
        spheres.append(replace(sphere, centre=centre, radius=ball.radius))
        known[sphere.name] = _known_ball(ball, T_artefact_cmm, u_feature)
        moved[sphere.name] = float(np.linalg.norm(centre - sphere.centre))
        left[sphere.name] = ball.left
    for patch in nominal.patches:
        rows = np.flatnonzero(cmm.feature == patch.name)
        if not len(rows):
            patches.append(patch)
            continue
        _check_face(nominal, patch, cmm, rows, point)
        found = corrected_face(patch, point[rows], u_point, waviness)
        far = _is_outlier(found.left, u_point)
        if far.any():
            slips.append(_outlier_remark(patch.name, cmm, rows[far]))
            rows = rows[~far]
            found = corrected_face(patch, point[rows], u_point, waviness)
        unseen += [] if all(found.seen) else [patch.name]
        patches.append(found.patch)
        known[patch.name] = KnownFeature(len(rows), u_feature, found.u_tilt, found.u_form)
        moved[patch.name], left[patch.name] = found.moved, rms(found.left)
        offset[patch.name] = found.offset
    standard = replace(
        nominal,
        patches=tuple(patches),
        spheres=tuple(spheres),
        known=Known(cmm.path.name, nominal.fingerprint, known),
    )
    return CalibrationFit(
        standard=standard,
        moved=moved,
        offset=offset,
        u_radius={name: ball.u_radius for name, ball in balls.items()},
        left=left,
        form={name: ball.form for name, ball in balls.items() if np.isfinite(ball.form)},
        unseen=tuple(unseen),
        waviness=waviness,
        u_point=u_point,
        remarks=(*cmm.remarks, *slips, *_remarks(nominal, cmm, known)),
    )


def _remarks(nominal: Standard, cmm: CmmPoints, known: dict[str, KnownFeature]) -> list[str]:
    """Remarks on features without points, and on points without use."""
    names = [s.name for s in nominal.spheres] + [p.name for p in nominal.patches]
    missing = [name for name in names if name not in known]
    out = []
    if missing:
        out.append(
            f"no points on {', '.join(missing)}: taken as designed, with the assumed uncertainty"
        )
    datums = (nominal.plane.name, *SIDES)
    if touched := int(np.isin(cmm.feature, datums).sum()):
        on = ", ".join(name for name in datums if name in cmm.feature)
        out.append(f"{touched} points on {on} are not used: the balls align the piece")
    return out


def _known_ball(ball: "Ball", T_artefact_cmm: Array, u_feature: float) -> KnownFeature:
    """Uncertainties of a ball's place in the frame of the design."""
    R = T_artefact_cmm[:3, :3]
    axes = np.sqrt(np.diag(R @ ball.covariance @ R.T) + u_feature**2)
    x, y, z = axes.tolist()
    return KnownFeature(ball.points, u=rms(axes), u_tilt=0.0, u_form=0.0, u_axes=(x, y, z))


class Ball(NamedTuple):
    """A measured ball in the frame of the CMM; lengths in mm."""

    centre: Array
    radius: float
    covariance: Array  # of the centre, (3, 3)
    u_radius: float
    left: float  # rms
    points: int
    form: float  # peak to valley, less what noise makes; nan where the CMM evaluated the ball


def _is_outlier(left: Array, u_point: float) -> Mask:
    """Points whose residual exceeds the outlier limit, (N,)."""
    usual = max(u_point, float(np.median(np.abs(left))) / 0.6745)
    return np.asarray(np.abs(left) > _OUTLIER_LIMIT * usual)


def _outlier_remark(name: str, cmm: CmmPoints, rows: np.ndarray) -> str:
    """Remark on points that were left out."""
    lines = ", ".join(str(line) for line in cmm.line[rows])
    return f"{name}: points that stand out are left out, lines {lines} of {cmm.path}"


def measured_balls(
    nominal: Standard, cmm: CmmPoints, u_point: float, slips: list[str]
) -> dict[str, Ball]:
    """Every measured ball in the frame of the CMM; remarks on outliers go to `slips`."""
    out: dict[str, Ball] = {}
    for sphere in nominal.spheres:
        rows = np.flatnonzero(cmm.feature == sphere.name)
        if not len(rows):
            continue
        whole = rows[np.isfinite(cmm.diameter[rows])]
        if len(rows) - len(whole) >= MIN_BALL:  # points hold the form, an evaluated ball does not
            rows, whole = np.setdiff1d(rows, whole), whole[:0]
        if len(whole):
            radius = 0.5 * float(cmm.diameter[whole].mean())
            centre = cmm.point[whole].mean(axis=0)
            u = u_point / np.sqrt(len(whole))
            out[sphere.name] = Ball(
                centre=centre,
                radius=radius,
                covariance=u**2 * np.eye(3),
                u_radius=0.5 * u,
                left=0.0,
                points=len(whole),
                form=float("nan"),
            )
        elif len(rows) < MIN_BALL:
            raise NotEnoughData(
                f"{cmm.path}: {sphere.name} has {len(rows)} points, expected at least {MIN_BALL}"
            )
        else:
            ball = fitted_ball(cmm.point[rows], u_point)
            left = np.linalg.norm(cmm.point[rows] - ball.centre, axis=1) - ball.radius
            far = _is_outlier(left, u_point)
            if far.any() and np.sum(~far) >= MIN_BALL:
                slips.append(_outlier_remark(sphere.name, cmm, rows[far]))
                ball = fitted_ball(cmm.point[rows[~far]], u_point)
            out[sphere.name] = ball
    if len(out) < MIN_BALLS:
        raise NotEnoughData(
            f"{cmm.path}: points on {len(out)} balls, expected at least {MIN_BALLS}: they "
            "align the standard"
        )
    _check_size(nominal, cmm, out)
    _check_radii(nominal, cmm, out)
    return out


def fitted_ball(points: Array, u_point: float) -> Ball:
    """Least-squares sphere; uncertainties from the larger of stated and estimated noise."""
    found = fitted_sphere(points)
    scatter = float(np.sqrt(found.left @ found.left / max(len(points) - 4, 1)))
    covariance = found.cofactor * max(u_point, scatter) ** 2
    return Ball(
        centre=found.centre,
        radius=found.radius,
        covariance=covariance[:3, :3],
        u_radius=float(np.sqrt(covariance[3, 3])),
        left=rms(found.left),
        points=len(points),
        form=_form(found.left, u_point),
    )


def _form(left: Array, u_point: float) -> float:
    """Peak to valley of residuals beyond that of noise alone, mm.

    Reference: Blom, Statistical Estimates (1958): expected largest of n normal numbers.
    """
    n = len(left)
    noise = 2.0 * float(ndtri((n - 0.375) / (n + 0.25))) * np.sqrt(max(n - 4, 1) / n)
    return float(np.sqrt(max(float(np.ptp(left)) ** 2 - (noise * u_point) ** 2, 0.0)))


def _check_size(nominal: Standard, cmm: CmmPoints, balls: dict[str, Ball]) -> None:
    """Reject points in other units or of another standard, by the distances between balls."""
    names = list(balls)
    stated = {s.name: s.centre for s in nominal.spheres}
    found = _distances(np.array([balls[name].centre for name in names]))
    wanted = _distances(np.array([stated[name] for name in names]))
    pairs = np.tril_indices(len(names), -1)
    ratio = float(np.median(found[pairs] / wanted[pairs]))
    for unit, factor in _UNITS.items():
        if abs(ratio / factor - 1.0) < _UNIT_TOLERANCE:
            raise BadFile(cmm.path, "x, y, z", f"distances of balls in {unit}", "mm")
    a, b = np.unravel_index(int(np.argmax(np.abs(found - wanted))), found.shape)
    if abs(found[a, b] - wanted[a, b]) <= _MAX_MISFIT:
        return
    if swapped := _swapped(found, wanted):
        mixed = ", ".join(f"{names[j]} under the name {names[i]}" for i, j in swapped)
        raise BadFile(cmm.path, "feature", f"points of {mixed}", "every ball under its own name")
    raise BadFile(
        cmm.path,
        f"{names[a]}, {names[b]}",
        f"{found[a, b]:.3f} mm between their centres",
        f"about {wanted[a, b]:.3f} mm: other balls, or another standard",
    )


def _distances(centres: Array) -> Array:
    return np.asarray(np.linalg.norm(centres[:, None] - centres, axis=-1))


def _swapped(found: Array, wanted: Array) -> list[tuple[int, int]]:
    """Balls (found, wanted) with swapped names, if all distances agree once they are corrected.

    A ball is recognised by its sorted distances from all others.
    """
    from scipy.optimize import linear_sum_assignment

    unlike = np.abs(np.sort(found, axis=1)[:, None] - np.sort(wanted, axis=1)).max(axis=-1)
    own = linear_sum_assignment(unlike)[1]
    if np.abs(found - wanted[np.ix_(own, own)]).max() > _MAX_MISFIT:
        return []
    return [(i, int(j)) for i, j in enumerate(own) if i != j]


def _check_radii(nominal: Standard, cmm: CmmPoints, balls: dict[str, Ball]) -> None:
    """Reject points of the tip centre: all balls are too large by the radius of the tip."""
    off = np.array([balls[s.name].radius - s.radius for s in nominal.spheres if s.name in balls])
    if np.abs(off).min() > _MAX_MISFIT and np.ptp(off) < _MAX_MISFIT:
        raise BadFile(
            cmm.path,
            "balls",
            f"radii that are all {abs(off.mean()):.3f} mm too {'large' if off[0] > 0 else 'small'}",
            "points on the surface: let the CMM compensate the radius of its tip",
        )


def alignment(nominal: Standard, cmm: CmmPoints, centres: dict[str, Array]) -> Array:
    """Pose (4, 4) from the frame of the CMM to that of the design."""
    stated = np.array([s.centre for s in nominal.spheres if s.name in centres])
    found = np.array([centres[s.name] for s in nominal.spheres if s.name in centres])
    if np.linalg.matrix_rank(stated - stated.mean(axis=0), tol=1.0) < 2:
        raise NotEnoughData(f"{cmm.path}: balls on one line, expected one beside it")
    return rigid_motion(found, stated, np.eye(4))


def _check_face(
    nominal: Standard, patch: FreeformPatch, cmm: CmmPoints, rows: np.ndarray, point: Array
) -> None:
    """Reject too few points, and points far from their face."""
    if len(rows) < MIN_FACE:
        raise NotEnoughData(
            f"{cmm.path}: {patch.name} has {len(rows)} points, expected at least {MIN_FACE}"
        )
    far = _distance_from_face(patch, point[rows])
    worst = int(np.argmax(far))
    if far[worst] > _MAX_MISFIT:
        line = cmm.line[rows[worst]]
        for other in nominal.patches:
            if other is not patch and _distance_from_face(other, point[rows]).max() <= _MAX_MISFIT:
                found = f"points of {other.name} under the name {patch.name}"
                raise BadFile(cmm.path, "feature", found, "every face under its own name")
        if neighbour := _on_another(nominal, patch, point[rows[worst]]):
            found, expected = f"a point of {neighbour}", f"a point of {patch.name}"
            raise BadFile(cmm.path, line, found, f"{expected}, whose name it bears")
        raise BadFile(
            cmm.path,
            line,
            f"a point {far[worst] / UM:.0f} µm from {patch.name}"
            if np.isfinite(far[worst])
            else f"a point beside {patch.name}",
            f"points within {_MAX_MISFIT:g} mm of their feature",
        )


def _on_another(nominal: Standard, patch: FreeformPatch, place: Array) -> str:
    """Name of another feature on which a point (3,) lies; empty for none."""
    for other in nominal.patches:
        if other is not patch and _distance_from_face(other, place[None])[0] <= _MAX_MISFIT:
            return other.name
    for ball in nominal.spheres:
        if abs(float(np.linalg.norm(place - ball.centre)) - ball.radius) <= _MAX_MISFIT:
            return ball.name
    return ""


def _distance_from_face(patch: FreeformPatch, point: Array) -> Array:
    """Distances of points (N, 3) from a face, (N,), mm; infinite beside it."""
    uv = patch.project(point)
    far = np.linalg.norm(point - patch.point(np.nan_to_num(uv)), axis=1)
    return np.where(np.isfinite(uv).all(axis=1), far, np.inf)
