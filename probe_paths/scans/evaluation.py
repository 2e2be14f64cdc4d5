"""Points of a scan made rows of a run, no more of them than they are worth.

A control records a ball's place every few hundredths of a millimetre. Points so near share most of
their noise: 5000 of them are not 5000 measurements. So

1. points within `_AVERAGED` of each other become one (the surface is straight over such a length to
   a nanometre),
2. the sag of the face is taken off as of touches, the place of the standard is fitted to all of
   them, and the distance of every ball along the normal of its foot point, less the radius, is its
   deviation,
3. a row is the mean of a stretch of a line, `STRETCH` long. Noise and its correlation are those of
   the deviations about a parabola over a stretch; they give the standard uncertainty of the mean,

    var = s^2 / k^2 sum_ij r^|i - j|,   r the correlation of neighbours
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.probe_paths.campaign import LARGEST_GAPS, fitted_setup, touch_uncertainty
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray, apply, inverse
from matstd.twin.machine import Chain, linear_motion, tip
from matstd.twin.numbers import rms
from matstd.twin.record import Run, Setup, Touches, at_poses, computed_deviation, linear_approach
from matstd.twin.rows import picked
from matstd.twin.units import UM

STRETCH = 8.0
"""Length of line in one row, mm: less than half of the narrowest effect that is looked for."""

LARGEST_RMS = 0.1
"""Root mean square of the deviations with the set-up fitted, mm: no machine in use is that wrong,
and a radius that is taken off twice leaves more on a wavy face."""

_ON_SURFACE = 0.25  # of the radius: centres of a ball are farther from the face
_AVERAGED = 0.2  # mm; a curvature of 1/8 mm moves the mean of such an arc by 0.2 µm / 1000
_LARGEST_STEP, _USUAL_STEPS = 2.0, 10.0  # mm between points of a line; and median steps
_EDGE_TOLERANCE = 0.5  # mm that foot points may lie beyond the trimmed edge
_POINTS_A_ROW = 4  # points of a stretch that becomes a row
_ALIKE = np.linspace(0.0, 0.98, 99)  # correlations of neighbours that are tried
_LEAST_U = 0.01 * UM  # of a row


@dataclass(frozen=True, eq=False)
class ScanPoints:
    """Points of a scan on one machine, in the order of time."""

    path: Path  # of the file, for messages
    row: IntArray  # line of every point in it, (N,)
    line: IntArray  # number of the line of the scan, (N,)
    is_numbered: bool  # whether the file numbers its lines; if not they end where points stop
    q: Array  # readings of all axes, (N, A), mm and rad
    deflection: Array  # of the stylus along the normal, (N,), mm
    time: Array  # S, (N,)

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, rows: IntArray) -> "ScanPoints":
        return picked(self, rows)

    def refuse(self, at: int, found: str, expected: str) -> BadFile:
        """A refusal that names the line of a point."""
        return BadFile(self.path, self.row[at], found, expected)


@dataclass(frozen=True)
class ScanNoise:
    """What a scan shows of its own noise."""

    points: int  # recorded
    lines: int  # of the scan
    u: float  # standard deviation of a point of 0.2 mm, mm
    alike: float  # correlation of neighbouring ones
    pitch: float  # distance of these, mm
    u_mean: float  # standard uncertainty of a row by that noise, mm


def evaluate_scan(
    points: ScanPoints,
    standard: Standard,
    face: str,
    chain: Chain,
    radius: float,
    length: float,
    setup: Setup,
    u: float,
) -> tuple[Run, ScanNoise]:
    """Rows of a run from a scan of one freeform face; the set-up is fitted to it.

    Args:
        radius: Of the ball, mm.
        length: From the gauge point to its centre, mm.
        setup: Where the standard is believed to stand.
        u: Standard uncertainty of the probe beside its noise, mm: common to a stretch.

    Raises:
        BadFile: A line with a gap, points off the face or on another one, points whose radius is
            already taken off.
    """
    patch = _patch(standard, face, points.path)
    recorded = len(points)
    points, place = _averaged(points, tip(chain, points.q, length))
    # sag at the believed set-up: the fit hardly turns the direction of weight
    at = setup.T_table_artefact
    moved = standard.moved(chain, points.q, at, np.full(len(points), face))
    setup, uv = _fitted(points, place, standard, patch, radius, setup, moved)
    normal = patch.normal(uv)
    point = patch.point(uv) + moved
    moves = _touches(points, chain, (radius, length), setup, point, normal, face)
    gap = computed_deviation(moves) + points.deflection
    groups = _stretches(points.line, place)
    noise = _noise(gap, place, groups, recorded, len(np.unique(points.line)))
    middles = np.array([rows[len(rows) // 2] for rows in groups])
    means = np.array([_mean_at(gap[rows], place[rows], len(rows) // 2) for rows in groups])
    worse = np.sqrt([max(1.0, _usual(groups) / len(rows)) for rows in groups])
    rows = _with_deviations(moves[middles], means)
    total = touch_uncertainty(standard, rows, np.hypot(noise.u_mean * worse, u))
    return Run(rows, computed_deviation(rows), total, line=points.row[middles]), noise


def _patch(standard: Standard, face: str, path: Path) -> FreeformPatch:
    """The scanned face."""
    names = [patch.name for patch in standard.patches]
    if face not in names:
        raise BadFile(path, "--scan", face, f"a freeform face of the standard: {', '.join(names)}")
    return standard.patches[names.index(face)]


def _averaged(points: ScanPoints, place: Array) -> tuple[ScanPoints, Array]:
    """Means of points within a fifth of a millimetre, after lines were checked for gaps."""
    step = np.linalg.norm(np.diff(place, axis=0), axis=1)
    same = np.diff(points.line) == 0
    usual = float(np.median(step[same])) if same.any() else 0.0
    wide = same & (step > max(_LARGEST_STEP, _USUAL_STEPS * usual))
    if wide.any() and points.is_numbered:
        at = int(np.flatnonzero(wide)[0])
        raise points.refuse(
            at + 1, f"a gap of {step[at]:.1f} mm in line {points.line[at]} of the scan",
            f"points every {usual:.2f} mm, or another number for what follows",
        )  # fmt: skip
    # a log without line numbers begins a new line at a gap: the probe was lifted there
    line = np.cumsum([1, *(~same | wide).astype(int)])
    along = np.concatenate([[0.0], np.cumsum(step)])
    begins = along[np.searchsorted(line, line)]
    cell = np.floor((along - begins) / _AVERAGED).astype(np.int64)
    group = np.cumsum([0, *((np.diff(line) != 0) | (np.diff(cell) != 0)).astype(int)])
    count = np.bincount(group)
    first = np.searchsorted(group, np.arange(len(count)))

    def mean(values: Array) -> Array:
        sums = np.add.reduceat(values, first, axis=0)
        return sums / count.reshape(-1, *([1] * (values.ndim - 1)))

    q, deflection, time = mean(points.q), mean(points.deflection), mean(points.time)
    some = replace(points[first], line=line[first], q=q, deflection=deflection, time=time)
    return some, mean(place)


def _fitted(
    points: ScanPoints,
    place: Array,
    standard: Standard,
    patch: FreeformPatch,
    radius: float,
    setup: Setup,
    moved: Array,
) -> tuple[Setup, Array]:
    """The set-up that minimises the deviations, and the foot points (N, 2).

    Args:
        moved: Displacements of the face by its weight, artefact frame, (N, 3), mm.
    """

    def seen_from(stands: Setup, limit: float) -> tuple[Array, Array]:
        ball = apply(inverse(stands.T_table_artefact), place) - moved
        uv = patch.project(ball)
        return uv, _gaps(points, ball, uv, patch, radius, limit)

    seen_from(setup, LARGEST_GAPS[0])  # refuses what no fit brings to the face
    face = np.full(len(points), patch.name)
    setup = fitted_setup(setup, standard, face, place, radius - points.deflection, moved)
    uv, gap = seen_from(setup, LARGEST_GAPS[1])
    if rms(gap) > LARGEST_RMS:
        raise points.refuse(
            0, f"deviations of {rms(gap):.2f} mm rms with the set-up fitted",
            f"at most {LARGEST_RMS:g} mm: another face, radius of the ball, or a filter that "
            "takes off the radius of the tip",
        )  # fmt: skip
    return setup, uv


def _gaps(
    points: ScanPoints, ball: Array, uv: Array, patch: FreeformPatch, radius: float, limit: float
) -> Array:
    """Distances of balls from the face, less the radius, (N,), mm."""
    lost = ~np.all(np.isfinite(uv), axis=1)
    uv = np.where(lost[:, None], 0.0, uv)
    away = np.einsum("ni,ni->n", patch.normal(uv), ball - patch.point(uv))
    gap = np.where(lost, np.inf, away - radius + points.deflection)
    if np.median(np.abs(gap + radius)) < _ON_SURFACE * radius:
        raise points.refuse(
            0,
            f"points on {patch.name} itself: {radius:g} mm nearer than the centre of the ball",
            "centres of the ball; a log with the radius of the tip taken off has lost the "
            "direction in which it was",
        )
    beyond = np.any(
        np.abs(uv) > np.array(patch.half_size) + limit - LARGEST_GAPS[1] + _EDGE_TOLERANCE, axis=1
    )
    far = (np.abs(gap) > limit) | beyond
    if far.any():
        at = int(np.flatnonzero(far)[0])
        why = "another face, set-up, probe or unit" if far.mean() > 0.5 else "another face"
        raise points.refuse(
            at, f"a point {gap[at]:.1f} mm from {patch.name} or beyond its edge, as "
            f"{100.0 * far.mean():.0f} % of all",
            f"points within {limit:g} mm of it: this is {why}",
        )  # fmt: skip
    return gap


def _touches(
    points: ScanPoints,
    chain: Chain,
    probe: tuple[float, float],
    setup: Setup,
    point: Array,
    normal: Array,
    face: str,
) -> Touches:
    """The record of all points."""
    count = len(points)
    poses = points.q[:, chain.rotary_columns]
    label = np.unique(np.round(poses, 6), axis=0, return_inverse=True)[1].ravel()
    return replace(
        at_poses(chain, points.q, probe[1]),
        radius=np.full(count, probe[0]),
        point=point,
        normal=normal,
        setups=(setup,),
        setup=np.zeros(count, dtype=np.int64),
        time=points.time,
        approach=linear_approach(chain, points.q, normal @ setup.T_table_artefact[:3, :3].T),
        feature=np.full(count, face),
        pose=label.astype(np.int64) if poses.shape[1] else np.zeros(count, dtype=np.int64),
    )


def _with_deviations(touches: Touches, wanted: Array) -> Touches:
    """Touches whose readings say some deviations (N,): means, and the deflection of the stylus."""
    shift = (wanted - computed_deviation(touches))[:, None] * touches.normal_table
    return replace(touches, q=touches.q + linear_motion(touches.chain, touches.q, shift))


def _stretches(line: IntArray, place: Array) -> list[IntArray]:
    """Points of every stretch, in their order; too short ones are left out."""
    out = []
    for number in np.unique(line):
        rows = np.flatnonzero(line == number)
        step = np.linalg.norm(np.diff(place[rows], axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(step)])
        count = max(1, round(along[-1] / STRETCH))
        part = np.minimum((along / max(along[-1], 1e-9) * count).astype(int), count - 1)
        out += [rows[part == k] for k in range(count)]
    return [rows for rows in out if len(rows) >= _POINTS_A_ROW]


def _mean_at(gap: Array, place: Array, middle: int) -> float:
    """Mean of a stretch at its middle: of a line through its deviations."""
    along = np.linalg.norm(place - place[middle], axis=1) * np.sign(np.arange(len(gap)) - middle)
    return float(np.mean(gap) - np.polyfit(along, gap, 1)[0] * along.mean())


def _usual(groups: Sequence[IntArray]) -> float:
    return float(np.median([len(rows) for rows in groups]))


def _noise(
    gap: Array, place: Array, groups: Sequence[IntArray], points: int, lines: int
) -> ScanNoise:
    """Noise of points about parabolas over the stretches.

    A parabola takes a part of a correlated noise with it. With M what it leaves and R the
    correlations, the residuals have the covariance ``s^2 M R M``; r and s are those with which its
    trace and its sum beside the diagonal are those found.
    """
    k = max(int(_usual(groups)), _POINTS_A_ROW)
    some = np.array([gap[rows[:k]] for rows in groups if len(rows) >= k])
    shapes = np.vander(np.linspace(-1.0, 1.0, k), 3)
    M = np.eye(k) - shapes @ np.linalg.pinv(shapes)
    left = some @ M
    away = np.abs(np.subtract.outer(np.arange(k), np.arange(k)))
    tried = [M @ r**away @ M for r in _ALIKE]
    ratio = [np.trace(S, 1) / np.trace(S) for S in tried]
    found = np.sum(left[:, 1:] * left[:, :-1]) / max(np.sum(left**2), 1e-300)
    at = int(np.argmin(np.abs(np.array(ratio) - found)))
    s = float(np.sqrt(np.mean(np.sum(left**2, axis=1)) / np.trace(tried[at])))
    steps = [np.linalg.norm(np.diff(place[rows], axis=0), axis=1) for rows in groups]
    u_mean = s * float(np.sqrt(np.sum(_ALIKE[at] ** away))) / k
    return ScanNoise(
        points=points,
        lines=lines,
        u=s,
        alike=float(_ALIKE[at]),
        pitch=float(np.median(np.concatenate(steps))),
        u_mean=max(u_mean, _LEAST_U),
    )
