"""What a user should know about a run besides the verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import MIN_POSES, Fit, UnitMistake, fit_run, unit_mistake
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.remarks.body_size import BodySize, body_sizes
from matstd.diagnosis.remarks.offsets import OffTogether, off_together
from matstd.diagnosis.remarks.order import JumpInOrder, jump_in_order
from matstd.diagnosis.remarks.remark_kinds import Noticed, What, noticed, short_beam
from matstd.twin.elastic import short_beams
from matstd.twin.frames import Array
from matstd.twin.model import Effect, original_of, traits
from matstd.twin.numbers import rms


@dataclass(frozen=True, slots=True)
class EffectOfOtherRun:
    """An effect that a saved model has of another run, and that is not applied as a rule."""

    effect: Effect
    owner: str  # what it belongs to, as its kind says: "machine", "probe" or "run"
    inner: Mapping[str, float]  # its inner parameters, as in the file
    run: str
    share: float  # what it made there, rms, mm, beside where the standard stood; 0 where unknown
    # whether the touches of this run show a law of that one, too: it is applied
    is_repeated: bool = False
    # whether they speak against a law of the machine: it is not expected here
    is_refuted: bool = False


MIN_DOF = 30.0  # below so many degrees of freedom only large effects can be seen

MAX_HELD_OUT_RATIO = 2.0
"""Error of held-out touches over the stated noise from which few touches leave all open."""

MIN_FELT = 1e-3
"""Effect of a parameter of its expected size on all touches together, over the noise, below which
they do not feel it: a rotary axis that stands still."""

LOAD_EFFECTS = ("stiffness", "tool-point-stiffness")
"""Kinds of effects that a touch shows only by its load."""

MAX_STILL_RANGE = 1e-3
"""Range of readings (rad) below which a joint of an arm stood still; jitter shows nothing."""


MAX_UNEVENNESS = 2e-3  # largest distance of a target from an even spacing, rad: a tenth of a degree
MIN_TARGETS = 3  # targets of a turn up to which no harmonics are distinguished


@dataclass(frozen=True, slots=True)
class HarmonicsAlike:
    """Harmonics of a turn that read as a found one at evenly spaced targets, the lowest first."""

    axis: str
    targets: int
    found: int  # 0 of a curve, whose harmonics are many
    others: tuple[int, ...]


def harmonics_alike(fit: Fit) -> list[HarmonicsAlike]:
    """Harmonics that n even targets cannot distinguish from a found one k: every m n ± k.

    Of a curve, which may be any of them, the number of targets alone.
    """
    out: list[HarmonicsAlike] = []
    for effect in fit.model.effects:
        own = traits(original_of(effect) if traits(effect).repetition > 1 else effect)
        if own.harmonic is None or own.symbol is None:
            continue
        axis, k = own.symbol.link, round(own.harmonic)
        if axis not in fit.run.touches.chain.rotary_axes:
            continue
        n = targets_a_turn(fit.run.touches.reading(axis)[fit.used])
        around = {m * n + side * k for m in (1, 2) for side in (-1, 1)} if k else set()
        others = tuple(h for h in sorted(around - {k}) if h > 0)
        if n:
            out.append(HarmonicsAlike(axis, n, k, others))
    return list(dict.fromkeys(out))


def targets_a_turn(q: Array) -> int:
    """Number of targets that stand evenly over a whole turn, rad; 0 where they do not.

    Example:
        >>> targets_a_turn(np.radians([0.0, 90.0, 180.0, 270.0, 360.0])), targets_a_turn(np.ones(3))
        (4, 0)
    """
    turn = 2.0 * np.pi
    places = np.unique(np.round(np.mod(q + MAX_UNEVENNESS, turn), 4))
    n = len(places)
    off = places - places[0] - turn / n * np.arange(n)
    return n if n > MIN_TARGETS and np.abs(off).max() < MAX_UNEVENNESS else 0


Remark = (
    Noticed | UnitMistake | BodySize | HarmonicsAlike | JumpInOrder | EffectOfOtherRun | OffTogether
)


def remarks(fit: Fit, start: Fit | None = None) -> tuple[Remark, ...]:
    """Everything noteworthy in a fit: units, what the reader of the file noticed, the rest.

    Args:
        start: Of the model before effects were put in, which may stand in for a jump; None for
            that one itself.
    """
    units = unit_mistake(fit)
    out: list[Remark] = [] if units is None else [units]
    out += [noticed(What.READER, text=text) for text in fit.run.remarks]
    out += body_sizes(fit.run.touches)
    out += _memory(fit)
    out += _touches(fit)
    jump = jump_in_order(start or fit)
    out += [] if jump is None else [jump]
    out += harmonics_alike(fit)
    out += _elastic(fit)
    out += _fixing(fit)
    out += ([] if units else _noise(fit)) + off_together(fit) + _outliers(fit)
    if fit.widened > 1.0:
        out.append(noticed(What.PRIOR_WIDENED, factor=fit.widened))
    return tuple(out)


def _touches(fit: Fit) -> list[Remark]:
    """Too few touches or poses."""
    out: list[Remark] = []
    n, felt = int(fit.used.sum()), np.linalg.norm(fit.X[fit.used], axis=0) > MIN_FELT
    p = int(felt.sum())
    if n < p:
        out.append(noticed(What.FEW_TOUCHES, touches=n, parameters=p))
    if fit.solution.dof < MIN_DOF:
        out.append(noticed(What.FEW_DEGREES_OF_FREEDOM, dof=fit.solution.dof))
        ratio = fit.standardised_test_rms / rms(fit.run.u)
        if ratio > MAX_HELD_OUT_RATIO:
            out.append(noticed(What.HELD_OUT_IN_DOUBT, ratio=ratio))
    t = fit.run.touches
    poses = len(np.unique(np.column_stack([t.setup, t.pose])[fit.used], axis=0))
    if poses < MIN_POSES:
        turns = bool(t.chain.rotary_axes) and not t.instrument.reads_angle
        out.append(noticed(What.FEW_POSES, poses=poses, has_rotary=turns))
    stood = tuple(j for j in t.chain.joints if np.ptp(t.reading(j)[fit.used]) < MAX_STILL_RANGE)
    if stood:
        out.append(noticed(What.JOINTS_STOOD, names=stood))
    return out


def _elastic(fit: Fit) -> list[Remark]:
    """Beams that are none, and loads that bend nothing."""
    touches = fit.run.touches
    out: list[Remark] = [
        short_beam(name, ratio) for name, ratio in short_beams(touches.chain, fit.model.effects)
    ]
    if touches.force is None:
        return out
    load = float(np.linalg.norm(touches.force, axis=1).max())
    felt = np.linalg.norm(fit.X[fit.used], axis=0)
    for effect in dict.fromkeys(e for e, _ in fit.parameters):
        rows = [
            p for p, (e, q) in enumerate(fit.parameters)
            if e is effect and (e.kind in LOAD_EFFECTS or (e.kind == "beam" and q.name == "load"))
        ]  # fmt: skip
        if rows and float(felt[rows].max()) < 1.0:
            out.append(noticed(What.LOAD_TOO_SMALL, effect=effect.name, load=load))
    return out


def _fixing(fit: Fit) -> list[Remark]:
    """Expansions of a standard from a point that the run does not state."""
    if all(setup.fixing is not None for setup in fit.run.touches.setups):
        return []
    names = (e.name for e in fit.model.effects if e.kind == "artefact-expansion")
    return [noticed(What.FIXING_NOT_STATED, effect=name) for name in names]


def _memory(fit: Fit) -> list[Remark]:
    """Noise that remembers, or a residual that is slow."""
    memory = fit.memory
    if memory is None:
        return []
    rows = int(fit.used.sum())
    return [
        noticed(
            What.NOISE_REMEMBERS,
            correlation=memory.correlation,
            step=memory.step,
            by_place=memory.by_place,
            rows=rows,
            independent=rows / memory.per_independent,
            is_noise=memory.is_filtered,
        )
    ]


def _noise(fit: Fit) -> list[Remark]:
    """Noise that is not what the file states."""
    noise = fit.noise
    if noise.replicates is not None and noise.replicates_dof >= POLICY.repeat_dof:
        most = noise.replicates * (1.0 + 3.0 * (0.5 / noise.replicates_dof) ** 0.5)
        if noise.factor > most > 0.0:  # equal readings say nothing
            ratio = noise.factor / noise.replicates
            return [noticed(What.WORSE_THAN_REPLICATES, ratio=ratio, dof=noise.replicates_dof)]
    if noise.is_wrongly_stated:
        u = float(np.median(fit.run.u))
        return [noticed(What.NOISE_MISSTATED, found=noise.factor * u, stated=u)]
    return []


def _outliers(fit: Fit) -> list[Remark]:
    """Touches that were left out, or should have been if they were not so many."""
    gross = fit.gross
    both = _both_ways(fit)
    if gross.too_many:
        return [noticed(What.OUTLIERS_KEPT), *both]
    rows = np.flatnonzero(gross.accidents)
    if len(rows) == 0:
        return []
    rows = rows[np.argsort(-np.abs(gross.score[rows]))]
    largest = float(fit.residual[rows[np.argmax(np.abs(fit.residual[rows]))]])
    t = fit.run.touches
    of = tuple(t.runs[k] for k in t.run[rows]) if len(t.runs) > 1 else ()
    lines = tuple(int(line) for line in fit.run.line[rows])
    return [noticed(What.OUTLIERS_LEFT_OUT, lines=lines, largest=largest, runs=of), *both]


def _both_ways(fit: Fit) -> list[Remark]:
    """The error without the touches that stand out, and with them, where they are many."""
    gross = fit.gross
    out = gross.standing if gross.too_many else gross.accidents
    if out is None or not (gross.too_many or gross.are_many):
        return []
    rows = (out | gross.rows) if gross.too_many else gross.rows & ~gross.accidents
    other = replace(gross, rows=rows, too_many=False)
    beside = fit_run(fit.run, fit.model, gross=other, memory=fit.memory)
    without, whole = (beside, fit) if gross.too_many else (fit, beside)
    sizes = {"touches": int(out.sum()), "of": len(out), "left_out": not gross.too_many}
    errors = {"without": without.test_rms, "whole": whole.test_rms}
    return [noticed(What.MANY_STOOD_OUT, **sizes, **errors)]
