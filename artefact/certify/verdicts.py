"""Conformity of a calibrated standard with its drawing, and common causes of its errors.

Every deviation from the design is compared with the tolerance of the drawing by ISO 14253-1, with a
guard band of 1.65 standard uncertainties. The points were aligned by the balls, not by the datums
of the drawing: the uncertainty of that alignment is part of every uncertainty.

The scale is the seventh parameter of the motion that aligns the balls. Its tolerance follows from
the stated uncertainties of CMM and temperature (k = 2), its uncertainty from the scatter of the
balls: a scale that their position errors can cause remains undecided.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from matstd.artefact.body import Standard, Verdict
from matstd.artefact.certify.calibration_fit import CalibrationFit
from matstd.twin.frames import Array, skew

_ON_FACES = 0.5  # of a common offset: largest difference of a face from it
_MOST_EXCEPTIONS = 0.5  # of the balls, below which those of another diameter are the exception
_SCALE_GUARD = 3.0 / 1.65
"""Widens the guard band of the scale to three standard uncertainties: its tolerance is far smaller
than the scatter of balls that conform, of which 1.65 would refuse one piece in twenty."""

_CORNERS = np.array([[x, y] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
_K, _ONE_SIDED = (
    2.0,
    0.95,
)  # coverage factor of the tolerance of the scale; confidence of its guard band


@dataclass(frozen=True, slots=True)
class Allowed:
    """Tolerances by drawing and calibration."""

    # largest deviations of `diameter` and `position` of a ball, `profile` of a face, mm
    drawing: Mapping[str, float]
    u_feature: float  # standard uncertainty that the points of a feature share, mm
    u_temperature: float  # standard uncertainty of the temperature of the piece about 20 degC, K
    u_scale: float  # relative standard uncertainty of the scales of the CMM

    def u_size(self, expansion: float) -> float:
        """Relative standard uncertainty of all lengths, which every feature shares."""
        return float(np.hypot(expansion * self.u_temperature, self.u_scale))


@dataclass(frozen=True, slots=True)
class CommonCause:
    """One cause of many deviations."""

    # `radius`: the same error of all radii; `scale`: of all distances; `ball`: of a few balls alone
    kind: str
    value: float  # mm of radius, the largest of `ball`; or the relative scale
    # largest difference of another ball from it, mm; standard uncertainty of the scale
    spread: float
    on_faces: bool = False  # whether all faces are offset by the same amount along their normals
    # above 20 degC that would explain the scale by expansion, K; nan if none
    temperature: float = float("nan")
    features: tuple[str, ...] = ()  # balls whose radii alone are wrong


def with_verdicts(
    nominal: Standard, found: CalibrationFit, allowed: Allowed
) -> tuple[CalibrationFit, tuple[CommonCause, ...]]:
    """Add verdicts on all measured features and on the scale; report common causes."""
    frame = _Frame(nominal, found)
    verdicts = [*_of_balls(nominal, found, allowed, frame)]
    verdicts += _of_faces(nominal, found, allowed, frame)
    scale = frame.scale(allowed, nominal.material.expansion)
    causes = []
    diameters = [v for v in verdicts if v.characteristic == "diameter"]
    if any(v.is_refused for v in diameters):
        causes += _cause_of_diameters(diameters, found)
    if scale.is_refused:
        causes.append(frame.cause(nominal.material.expansion))
    u_size = allowed.u_size(nominal.material.expansion)
    known = replace(found.known, verdicts=(*verdicts, scale), u_scale=u_size)
    return replace(found, standard=replace(found.standard, known=known)), tuple(causes)


class _Frame:
    """Uncertainty of the alignment, and the scale, from the measured balls."""

    def __init__(self, nominal: Standard, found: CalibrationFit) -> None:
        pairs = zip(nominal.spheres, found.standard.spheres, strict=True)
        measured = [(a, b) for a, b in pairs if a.name in found.u_radius]
        self.names = [a.name for a, _ in measured]
        self.places = np.array([a.centre for a, _ in measured])
        off = np.array([b.centre - a.centre for a, b in measured])
        self.middle = self.places.mean(axis=0)
        floor = min(found.known.features[name].u for name in self.names)
        J = _rigid(self.places - self.middle)
        scatter = _scatter(J, off.ravel(), floor)
        self.covariance = scatter**2 * np.linalg.inv(J.T @ J)
        S = np.column_stack([J, (self.places - self.middle).ravel()])
        fitted = np.linalg.lstsq(S, off.ravel(), rcond=None)[0]
        self.ppm = float(fitted[6])
        scatter = _scatter(S, off.ravel() - S @ fitted, floor)
        self.u_ppm = scatter * float(np.sqrt(np.linalg.inv(S.T @ S)[6, 6]))

    def u(self, points: Array, directions: Array | None = None) -> float:
        """Largest standard uncertainty of places (N, 3) by the alignment, mm.

        Along the directions (N, 3), or along the worst direction where none are given.
        """
        J = _rigid(points - self.middle).reshape(-1, 3, 6)
        covariance = J @ self.covariance @ J.transpose(0, 2, 1)
        if directions is None:
            return float(np.sqrt(np.linalg.eigvalsh(covariance).max()))
        along = np.einsum("ni,nij,nj->n", directions, covariance, directions)
        return float(np.sqrt(along.max()))

    def scale(self, allowed: Allowed, expansion: float) -> Verdict:
        """The scale over the longest distance between two balls."""
        apart = np.linalg.norm(self.places[:, None] - self.places, axis=-1)
        a, b = np.unravel_index(int(np.argmax(apart)), apart.shape)
        length = float(apart[a, b])
        common = allowed.u_size(expansion) * length
        return Verdict(
            feature=f"{self.names[a]} to {self.names[b]}",
            characteristic="scale",
            deviation=self.ppm * length,
            tolerance=_K * float(np.hypot(common, np.sqrt(2.0) * allowed.u_feature)),
            u=_SCALE_GUARD * self.u_ppm * length,
        )

    def cause(self, expansion: float) -> CommonCause:
        """The scale, with the temperature that would explain it."""
        warmer = self.ppm / expansion if expansion else float("nan")
        return CommonCause("scale", self.ppm, self.u_ppm, temperature=warmer)


def _rigid(places: Array) -> Array:
    """Displacement of places (N, 3) per small translation and rotation, (3 N, 6)."""
    blocks = [np.hstack([np.eye(3), -skew(place)]) for place in places]
    return np.concatenate(blocks)


def _scatter(J: Array, left: Array, floor: float) -> float:
    """Standard deviation of a coordinate of a ball, mm, not below the uncertainty of one ball.

    Few balls enlarge it by the ratio of Student's factors: with three balls 20 um out of place
    7 % of pieces with perfect faces are rejected without this factor, 3 % with it.
    """
    degrees = len(left) - J.shape[1]
    few = float(stdtrit(degrees, _ONE_SIDED) / stdtrit(1e6, _ONE_SIDED))
    return few * max(floor, float(np.sqrt(left @ left / degrees)))


def _of_balls(
    nominal: Standard, found: CalibrationFit, allowed: Allowed, frame: _Frame
) -> list[Verdict]:
    """Diameter and position of every measured ball."""
    known, out = found.known, []
    for drawn, made in zip(nominal.spheres, found.standard.spheres, strict=True):
        if drawn.name not in known.features:
            continue
        u_radius = np.hypot(found.u_radius[drawn.name], allowed.u_feature)
        u_place = np.hypot(known.features[drawn.name].u, frame.u(drawn.centre[None]))
        wider, beside = 2.0 * (made.radius - drawn.radius), found.moved[drawn.name]
        sizes = [("diameter", wider, 2.0 * u_radius), ("position", beside, u_place)]
        if drawn.name in found.form:
            # both ends of the range err, and the form of the probing itself is in it
            u_form = 2.0 * float(np.hypot(found.u_point, allowed.u_feature))
            sizes.append(("form", found.form[drawn.name], u_form))
        out += [
            Verdict(drawn.name, what, deviation, allowed.drawing[what], u=float(u))
            for what, deviation, u in sizes
        ]
    return out


def _of_faces(
    nominal: Standard, found: CalibrationFit, allowed: Allowed, frame: _Frame
) -> list[Verdict]:
    """Profile of every measured face."""
    known, out = found.known, []
    for face in nominal.patches:
        if face.name not in known.features:
            continue
        feature, corners = known.features[face.name], _CORNERS * face.half_size
        by_frame = frame.u(face.point(corners), face.normal(corners))
        u = float(np.linalg.norm([feature.u, feature.u_form, by_frame]))
        out.append(
            Verdict(
                feature=face.name,
                characteristic="profile",
                deviation=found.moved[face.name],
                tolerance=allowed.drawing["profile"],
                u=u,
            )
        )
    return out


def _cause_of_diameters(diameters: Sequence[Verdict], found: CalibrationFit) -> list[CommonCause]:
    """Whether all radii share an offset beside which every ball conforms, or a few balls differ.

    Balls differ among themselves within the tolerance of the drawing, and points of one ball share
    an error: what is left beside a common cause is judged as a diameter is.
    """
    off = 0.5 * np.array([v.deviation for v in diameters])
    common = float(np.median(off))
    beside = [replace(v, deviation=v.deviation - 2.0 * common) for v in diameters]
    wrong = [v for v in diameters if v.is_refused]
    if len(wrong) < _MOST_EXCEPTIONS * len(diameters):
        fine = [abs(v.deviation) for v in diameters if not v.is_refused]
        largest = 0.5 * max((v.deviation for v in wrong), key=abs)
        names = tuple(v.feature for v in wrong)
        return [CommonCause("ball", largest, 0.5 * max(fine), features=names)]
    if any(v.is_refused for v in beside):
        return []
    faces = np.array(list(found.offset.values()))
    on_faces = len(faces) > 0 and bool(np.abs(faces - common).max() < _ON_FACES * abs(common))
    return [CommonCause("radius", common, float(np.abs(off - common).max()), on_faces)]
