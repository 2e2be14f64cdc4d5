"""From logs to measurements: calibrated foot points, deviations, and where the standard stands."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign.contact_points import at_true_contacts, foot_points
from matstd.probe_paths.campaign.log_parts import (
    checked_parts,
    distinct_parts,
    logged_temperatures,
    without_rows,
)
from matstd.probe_paths.campaign.log_slips import log_slip
from matstd.probe_paths.control import UNDATED, LogPart
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import LINEAR, Probe, ProgramFrame
from matstd.twin.errors import BadFile, NotEnoughData
from matstd.twin.frames import Array, IntArray, apply, inverse, pose, rotation
from matstd.twin.machine import Chain, tip
from matstd.twin.record import (
    Labels,
    Run,
    Setup,
    Touches,
    at_poses,
    computed_deviation,
    linear_approach,
)
from matstd.twin.units import DEG, GPA, NM

LARGEST_GAPS = (10.0, 3.0)
"""Largest gap between a ball and its surface before and after the set-up is fitted, mm: a ball that
is farther off touched something else."""

LARGEST_OUTLIER_SHARE = 0.1
"""Share of such touches that may be left out; a larger share has a common cause."""

_ROUNDS = 20
_ARM = 100.0  # mm; scales rotations of the standard to lengths


def evaluate(
    parts: Sequence[LogPart],
    standard: Standard,
    chain: Chain,
    u: float,
    dialect: Dialect | None = None,
) -> Run:
    """Measurements from logs of one or several probes; the run's remarks list what was left out.

    Every touch has the length and radius that its own probe was calibrated with.

    Ball centres of a nominal machine are transformed to the frame of the standard. The set-up is
    fitted first (six parameters each, Gauss-Newton on the deviations, new foot points every round),
    then the machine's errors as far as the touches determine them (`contact_points`): the curvature
    between the true and the believed foot point would otherwise appear as a deviation. Finally
    ``dev = n . (ball centre - p) - radius`` with the believed ball centre.

    Args:
        parts: Parts of logs; those that measure nothing (`LogPart.is_measuring`) are left
            aside.
        u: Standard uncertainty of one touch, mm; that of the calibrated surface comes to it.

    Raises:
        BadFile: Many touches far from the features they are said to be on; a probe with two
            calibrations, logs of another standard or serial number, or two versions of one log.
        NotEnoughData: No touch at all.
    """
    measured = [part for part in parts if part.is_measuring]
    parts, remarks = checked_parts(distinct_parts(measured), standard, chain)
    if not sum(len(part.number) for part in parts):
        raise NotEnoughData("the logs hold no touch")
    _check_calibrations(parts)
    dialect = dialect or Dialect()
    touches = _touches_on(parts, standard, chain, dialect, is_fitted=False)

    def gaps(changed: Sequence[LogPart]) -> Array:
        return computed_deviation(_touches_on(changed, standard, chain, dialect, is_fitted=False))

    good, far = _split_by_gap(parts, computed_deviation(touches), LARGEST_GAPS[0], gaps)
    while True:
        parts, remarks = without_rows(parts, good), [*remarks, *far]
        touches = _touches_on(parts, standard, chain, dialect, is_fitted=True)
        good, far = _split_by_gap(parts, computed_deviation(touches), LARGEST_GAPS[1], gaps)
        if not far:
            break
    u_touch = touch_uncertainty(standard, touches, u)
    remarks += [*standard.remarks, *sag_remarks(standard)]
    remarks += logged_temperatures(parts)[1]
    begin = min(part.begin for part in parts)
    run = Run(
        touches,
        computed_deviation(touches),
        u_touch,
        remarks=tuple(remarks),
        date=None if begin.year == UNDATED.year else begin,
        standard=standard.stamp,
        program=np.concatenate([np.repeat(part.program, len(part.number)) for part in parts]),
        touch=np.concatenate([part.number for part in parts]),
    )
    # the anchor of a deviation is where the ball met the surface, not where it was believed to be
    return at_true_contacts(run, standard)


def sag_remarks(standard: Standard) -> list[str]:
    """How the sag of the standard is corrected, or why it is not."""
    sag, made_of = standard.usable_sag, standard.material
    if sag is not None:
        by = sag.source
        if made_of.modulus is not None and sag.modulus is not None:
            by += f" with {made_of.modulus / GPA:g} GPa ({made_of.modulus_source})"
        return [f"sag of the standard taken off: {by}, weight along {sag.down}"]
    if made_of.modulus is not None:
        return []
    return [
        f"sag of the standard not taken off: no modulus is stated of '{made_of.name}'; state "
        "material.modulus_MPa in the file of the standard, or design it again"
    ]


def touch_uncertainty(standard: Standard, t: Touches, u: Array | float) -> Array:
    """Standard uncertainty of every touch: its own `u`, calibration and sag, (N,), mm."""
    known = {} if standard.known is None else standard.known.features
    form = np.array([known[name].u_form if name in known else 0.0 for name in t.feature.tolist()])
    moved = standard.moved(t.chain, t.q, t.T_table_artefact, t.feature)
    share = 0.0 if standard.usable_sag is None else standard.usable_sag.share
    sag = share * np.einsum("ni,ni->n", t.normal, moved)
    return np.asarray(np.sqrt(u**2 + form**2 + sag**2))


def _touches_on(
    parts: Sequence[LogPart], standard: Standard, chain: Chain, dialect: Dialect, is_fitted: bool
) -> Touches:
    """Touches on the standard at its believed or fitted place."""
    count = [len(part.number) for part in parts]
    radius = np.repeat([part.radius for part in parts], count)
    length = np.repeat([part.tool_length - part.radius for part in parts], count)
    names = np.array(list(standard.features))
    q = np.concatenate([_readings(part, chain, dialect) for part in parts])
    feature = np.concatenate([names[part.feature - 1] for part in parts])
    setups, setup = _setups(parts)
    ball_table = tip(chain, q, length)
    stands = np.stack([s.T_table_artefact for s in setups])[setup]
    # sag at the believed set-up: the fit hardly turns the direction of weight
    moved = standard.moved(chain, q, stands, feature)
    for i, believed in enumerate(setups if is_fitted else ()):
        rows = np.flatnonzero(setup == i)
        setups[i] = fitted_setup(
            believed, standard, feature[rows], ball_table[rows], radius[rows], moved[rows]
        )
    touches = replace(
        at_poses(chain, q, length),
        radius=radius,
        setups=tuple(setups),
        setup=setup,
        feature=feature,
        time=np.concatenate([p.time + (p.begin - parts[0].begin).total_seconds() for p in parts]),
        temperature=logged_temperatures(parts)[0],
        pose=_pose_labels(parts, setup),
    )
    point, normal = foot_points(standard, feature, touches.ball_artefact, moved)
    touches = replace(touches, point=point, normal=normal)
    approach = linear_approach(chain, q, touches.normal_table)
    for letter in chain.rotary_axes:
        approach[:, chain.axis_index(letter)] = np.concatenate([p.side[letter] for p in parts])
    return replace(touches, approach=approach)


def _pose_labels(parts: Sequence[LogPart], setup: IntArray) -> IntArray:
    """Number of the table pose of every touch, (N,).

    A pose that two probes visit counts as two: they share the readings only.
    """
    families = list(dict.fromkeys(map(_probe_prefix, parts)))
    own, count = [families.index(_probe_prefix(p)) for p in parts], [len(p.number) for p in parts]
    number = np.concatenate([part.pose for part in parts])
    visited = np.column_stack([setup, np.repeat(own, count), number])
    return np.unique(visited, axis=0, return_inverse=True)[1].ravel().astype(np.int64)


def _check_calibrations(parts: Sequence[LogPart]) -> None:
    """Refuse a probe that was recalibrated between its programs."""
    first: dict[tuple[str, float, float], LogPart] = {}
    for part in parts:
        planned = part.heading.probe
        known = first.setdefault((_probe_prefix(part), planned.radius, planned.length), part)
        radius, length = known.radius, known.tool_length
        if abs(part.radius - radius) > NM or abs(part.tool_length - length) > NM:
            raise BadFile(
                part.path, f"program {part.program}",
                f"a probe of radius {part.radius:g} and length {part.tool_length:g} mm",
                f"{radius:g} and {length:g} mm as in {known.program}: one calibration a probe",
            )  # fmt: skip


def _probe_prefix(part: LogPart) -> str:
    """Name of a program without set-up and number, common to all programs of one probe."""
    return part.program.rsplit("_", 2)[0]


def ball_centres(part: LogPart, chain: Chain, dialect: Dialect | None = None) -> Array:
    """Where a nominal machine would have the balls of a log, table frame, (N, 3), mm."""
    q = _readings(part, chain, dialect or Dialect())
    return tip(chain, q, part.tool_length - part.radius)


def _readings(part: LogPart, chain: Chain, dialect: Dialect) -> Array:
    """Axis readings (N, A) of a log's touches from the results of cycle 4."""
    frame = ProgramFrame(chain, Probe(part.radius, part.tool_length - part.radius))
    q = np.zeros((len(part.number), len(chain.axes)))
    for letter, degrees in part.rotary.items():
        q[:, chain.axis_index(letter)] = degrees * DEG
    frames = [frame] * len(q)
    if part.heading.is_tilted:
        frames = [frame.tilted(rotary) for rotary in q[:, frame.rotary]]
    for i, letter in enumerate(LINEAR):
        word = part.xyz[:, i]
        if letter == "Z" and dialect.result_height == "gauge":
            word = word - part.tool_length
        values = zip(frames, word.tolist(), strict=True)
        q[:, chain.axis_index(letter)] = [f.reading(letter, v) for f, v in values]
    return q


def _setups(parts: Sequence[LogPart]) -> tuple[list[Setup], IntArray]:
    """Set-ups, and the index of that of every touch."""
    setups: dict[str, Setup] = {}
    index: list[int] = []
    for part in parts:
        believed = part.heading.setup
        known = setups.setdefault(believed.name, believed)
        if not np.allclose(known.T_table_artefact, believed.T_table_artefact, rtol=0.0, atol=NM):
            found = f"another place for set-up {believed.name}"
            raise BadFile(part.path, "ORIGIN, TURNED", found, "one place for each set-up name")
        index += [list(setups).index(believed.name)] * len(part.number)
    return list(setups.values()), np.array(index, dtype=np.int64)


def fitted_setup(
    setup: Setup,
    standard: Standard,
    feature: Labels,
    ball_table: Array,
    radius: Array,
    moved: Array,
) -> Setup:
    """The set-up that minimises the deviations; as it was where a ball has no foot point.

    Displacing the standard by (e, r) in its own frame changes a deviation by
    ``-n . e - (c x n) . r``, c the ball centre. Undetermined directions stay as believed.

    Args:
        ball_table: Centres of the balls, table frame, (N, 3), mm.
        radius: Distance of each from its feature, (N,), mm.
        moved: Displacements of the features by weight, artefact frame, (N, 3), mm.
    """
    T_table_artefact = setup.T_table_artefact
    for _ in range(_ROUNDS):
        ball = apply(inverse(T_table_artefact), ball_table)
        point, normal = foot_points(standard, feature, ball, moved)
        if not np.all(np.isfinite(point)):
            break
        deviation = np.einsum("ni,ni->n", normal, ball - point) - radius
        rows = np.concatenate([normal, np.cross(ball, normal) / _ARM], axis=1)
        # not least_squares: its steps also move undetermined directions, this cut-off none
        step = np.linalg.lstsq(rows, deviation, rcond=1e-6)[0]
        e, r = step[:3], step[3:] / _ARM
        T_table_artefact = T_table_artefact @ pose(rotation(r), e)
        if np.abs(step).max() < 1e-3 * NM:
            break
    return replace(setup, T_table_artefact=T_table_artefact)


def _split_by_gap(
    parts: Sequence[LogPart],
    gap: Array,
    limit: float,
    gaps: Callable[[Sequence[LogPart]], Array],
) -> tuple[np.ndarray, list[str]]:
    """Mask of touches near their stated surface, (N,), and remarks on the others.

    Args:
        gaps: Of other parts at their believed set-up, as of `log_slip`.

    Raises:
        BadFile: More distant touches than occasional mistakes explain.
    """
    good = np.abs(gap) < limit
    where = [(part, i) for part in parts for i in range(len(part.number))]
    remarks = []
    for row in np.flatnonzero(~good):
        part, i = where[row]
        found = f"{gap[row]:.3f} mm" if np.isfinite(gap[row]) else "no way"
        what = f"touch {part.number[i]} with {found} between ball and surface"
        if np.mean(~good) > LARGEST_OUTLIER_SHARE:
            slip = log_slip(parts, gaps, LARGEST_GAPS[0])
            cause = slip or "another feature, set-up, probe or meaning of Z"
            raise BadFile(
                part.path, part.line[i], f"{what}, one of {int(np.sum(~good))} such of {len(gap)}",
                f"less than {limit:g} mm: {cause}",
            )  # fmt: skip
        remarks.append(f"{part.path}: line {part.line[i]}: {what}; it is left out")
    return good, remarks
