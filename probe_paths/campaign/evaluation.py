"""From logs to measurements: calibrated foot points, deviations, and where the standard stands."""

from collections.abc import Sequence

import numpy as np

from artefact.body import Standard
from probe_paths.campaign.contact_points import at_true_contacts, foot_points
from probe_paths.control import LogPart
from probe_paths.language import Dialect
from probe_paths.plan import LINEAR, Probe, ProgramFrame
from twin.errors import BadFile, NotEnoughData
from twin.frames import Array, apply, inverse, pose, rotation
from twin.machine import Chain, tip
from twin.record import IntArray, Labels, Run, Setup, Touches, computed_deviation, linear_approach
from twin.units import DEG, NM

BESIDE = 10.0
"""Farthest that a ball can be from the surface it touched while the set-up is only believed, mm."""

ABSURD = 3.0
"""A ball still this far from its surface (mm) once the set-up is fitted touched something else."""

_ROUNDS = 10
_ARM = 100.0  # mm; scales rotations of the standard to lengths


def evaluate(
    parts: Sequence[LogPart],
    standard: Standard,
    chain: Chain,
    u: float,
    dialect: Dialect | None = None,
) -> Run:
    """Measurements from the logs of one probe.

    The ball centre that a nominal machine would have is taken into the frame of the standard. The
    set-up is fitted first (six parameters each, Gauss-Newton on the deviations, foot points anew
    every round), then the machine's errors as far as the touches tell
    (`probe_paths.campaign.contact_points`), as a
    ball that met the surface beside its foot point would have the curvature in between pass for a
    deviation. Then ``dev = n . (ball centre - p) - radius`` with the believed ball centre.

    Args:
        parts: Of one or several logs.
        standard: As calibrated.
        chain: The machine.
        u: Standard uncertainty of one touch, mm.
        dialect: Of the control.

    Raises:
        BadFile: A touch on a feature that the standard lacks, or far from it; logs of two probes.
        NotEnoughData: No touch at all.
    """
    parts = sorted(parts, key=lambda part: part.begin)
    if not parts or not sum(len(part.number) for part in parts):
        raise NotEnoughData("the logs hold no touch")
    radius, length = _probe(parts)
    q = np.concatenate([_readings(part, chain, dialect or Dialect()) for part in parts])
    feature = np.concatenate([_features(part, standard) for part in parts])
    setups, setup = _setups(parts)
    ball_table = tip(chain, q, length)
    point, normal, gap = _gaps(standard, setups, setup, feature, ball_table, radius)
    _check_near(parts, gap, BESIDE)
    for i, believed in enumerate(setups):
        rows = np.flatnonzero(setup == i)
        setups[i] = _fitted(believed, standard, feature[rows], ball_table[rows], radius)
    point, normal, gap = _gaps(standard, setups, setup, feature, ball_table, radius)
    _check_near(parts, gap, ABSURD)
    touches = _touches(parts, chain, q, (radius, length), setups, setup, feature, point, normal)
    run = Run(touches, computed_deviation(touches), np.full(len(q), u))
    # the anchor of a deviation is where the ball met the surface, not where it was believed to be
    return at_true_contacts(run, standard)


def _gaps(
    standard: Standard,
    setups: Sequence[Setup],
    setup: IntArray,
    feature: Labels,
    ball_table: Array,
    radius: float,
) -> tuple[Array, Array, Array]:
    """Foot points and normals in the artefact frame, and gaps between balls and surfaces, mm."""
    T_artefact_table = inverse(np.stack([s.T_table_artefact for s in setups])[setup])
    ball = apply(T_artefact_table, ball_table)
    point, normal = foot_points(standard, feature, ball)
    return point, normal, np.einsum("ni,ni->n", normal, ball - point) - radius


def _probe(parts: Sequence[LogPart]) -> tuple[float, float]:
    """Radius and length to the ball centre, the same in all logs, mm."""
    radius, tool_length = parts[0].radius, parts[0].tool_length
    for part in parts:
        if abs(part.radius - radius) > NM or abs(part.tool_length - tool_length) > NM:
            raise BadFile(
                part.path, f"program {part.program}",
                f"a probe of radius {part.radius:g} and length {part.tool_length:g} mm",
                f"{radius:g} and {tool_length:g} mm as in {parts[0].program}: one run file a probe",
            )  # fmt: skip
    return radius, tool_length - radius


def _readings(part: LogPart, chain: Chain, dialect: Dialect) -> Array:
    """Axis readings (N, A) of a log's touches, from what cycle 4 returned."""
    frame = ProgramFrame(chain, Probe(part.radius, part.tool_length - part.radius))
    q = np.zeros((len(part.number), len(chain.axes)))
    for i, letter in enumerate(LINEAR):
        word = part.xyz[:, i]
        if letter == "Z" and dialect.result_height == "gauge":
            word = word - part.tool_length
        q[:, chain.axis_index(letter)] = [frame.reading(letter, float(v)) for v in word]
    for letter, degrees in part.rotary.items():
        q[:, chain.axis_index(letter)] = degrees * DEG
    return q


def _features(part: LogPart, standard: Standard) -> Labels:
    """Feature names of a log's touches."""
    names = np.array(list(standard.features))
    wrong = (part.feature < 1) | (part.feature > len(names))
    if np.any(wrong):
        i = int(np.argmax(wrong))
        raise BadFile(
            part.path, f"line {part.line[i]}", f"feature {part.feature[i]}",
            f"1 to {len(names)}, a feature of {standard.name}",
        )  # fmt: skip
    if part.heading.standard != standard.name:
        raise BadFile(part.path, "STANDARD", part.heading.standard, standard.name)
    return names[part.feature - 1]


def _setups(parts: Sequence[LogPart]) -> tuple[list[Setup], IntArray]:
    """Set-ups by name, and the one of every touch."""
    setups: dict[str, Setup] = {}
    index: list[int] = []
    for part in parts:
        believed = part.heading.setup
        known = setups.setdefault(believed.name, believed)
        if not np.allclose(known.T_table_artefact, believed.T_table_artefact, rtol=0.0, atol=NM):
            raise BadFile(
                part.path, "ORIGIN, TURNED", f"another place for set-up {believed.name}",
                "one place for each set-up name",
            )  # fmt: skip
        index += [list(setups).index(believed.name)] * len(part.number)
    return list(setups.values()), np.array(index, dtype=np.int64)


def _fitted(
    setup: Setup, standard: Standard, feature: Labels, ball_table: Array, radius: float
) -> Setup:
    """The set-up that makes the deviations smallest.

    Displacing the standard by (e, r) in its own frame changes a deviation by
    ``-n . e - (c x n) . r``, c the ball centre. Directions that no touch sees stay as believed.
    """
    T_table_artefact = setup.T_table_artefact
    for _ in range(_ROUNDS):
        ball = apply(inverse(T_table_artefact), ball_table)
        point, normal = foot_points(standard, feature, ball)
        if not np.all(np.isfinite(point)):
            break
        deviation = np.einsum("ni,ni->n", normal, ball - point) - radius
        rows = np.concatenate([normal, np.cross(ball, normal) / _ARM], axis=1)
        step = np.linalg.lstsq(rows, deviation, rcond=1e-6)[0]
        e, r = step[:3], step[3:] / _ARM
        T_table_artefact = T_table_artefact @ pose(rotation(r), e)
        if np.abs(step).max() < 1e-3 * NM:
            break
    return Setup(setup.name, T_table_artefact)


def _check_near(parts: Sequence[LogPart], gap: Array, limit: float) -> None:
    """Every ball is near the surface that it is said to touch; raises BadFile."""
    wrong = ~(np.abs(gap) < limit)
    if not np.any(wrong):
        return
    row, first = int(np.argmax(wrong)), 0
    for part in parts:
        if row < first + len(part.number):
            i = row - first
            found = f"{gap[row]:.3f} mm" if np.isfinite(gap[row]) else "no way"
            raise BadFile(
                part.path,
                f"line {part.line[i]}",
                f"touch {part.number[i]} with {found} between ball and surface",
                f"less than {limit:g} mm: another feature, set-up, probe or meaning of Z",
            )
        first += len(part.number)


def _touches(
    parts: Sequence[LogPart],
    chain: Chain,
    q: Array,
    probe: tuple[float, float],
    setups: list[Setup],
    setup: IntArray,
    feature: Labels,
    point: Array,
    normal: Array,
) -> Touches:
    """The record of all touches; time counts from the start of the first program."""
    start = parts[0].begin
    T_table_artefact = np.stack([s.T_table_artefact for s in setups])[setup]
    normal_table = np.einsum("nij,nj->ni", T_table_artefact[:, :3, :3], normal)
    approach = linear_approach(chain, q, normal_table)
    for letter in chain.rotary_axes:
        approach[:, chain.axis_index(letter)] = np.concatenate([p.side[letter] for p in parts])
    number = np.concatenate([part.pose for part in parts])
    pose_label = np.unique(np.column_stack([setup, number]), axis=0, return_inverse=True)[1]
    return Touches(
        chain=chain,
        q=q,
        length=np.full(len(q), probe[1]),
        radius=np.full(len(q), probe[0]),
        point=point,
        normal=normal,
        setups=tuple(setups),
        setup=setup,
        time=np.concatenate([p.time + (p.begin - start).total_seconds() for p in parts]),
        approach=approach,
        feature=feature,
        pose=pose_label.reshape(-1).astype(np.int64),
    )
