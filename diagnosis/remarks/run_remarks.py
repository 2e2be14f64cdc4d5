"""What a user should know about a run besides the verdict: one record for each thing noticed.

Records carry the numbers; the sentences are made in `report`.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import MIN_POSES, Fit, UnitMistake, fit_run, unit_mistake
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.remarks.body_size import BodySize, body_sizes
from matstd.diagnosis.remarks.order import JumpInOrder, jump_in_order
from matstd.diagnosis.remarks.other_run import EffectOfOtherRun
from matstd.diagnosis.remarks.turns import HarmonicsAlike, harmonics_alike
from matstd.twin.elastic import short_beams
from matstd.twin.numbers import rms

MIN_DOF = 30.0
"""Below so many degrees of freedom only large effects can be seen."""

MAX_HELD_OUT_RATIO = 2.0
"""Error of held-out touches over the stated noise from which few touches leave all open."""

MIN_FELT = 1e-3
"""Effect of a parameter of its expected size on all touches together, over the noise, below which
they do not feel it: a rotary axis that stands still."""

LOAD_EFFECTS = ("stiffness", "tool-point-stiffness")
"""Kinds of effects that a touch shows only by its load."""

MAX_STILL_RANGE = 1e-3
"""Range of readings (rad) below which a joint of an arm stood still; jitter shows nothing."""


@dataclass(frozen=True, slots=True)
class ReaderRemark:
    """What the reader of the run file noticed, in its own words."""

    text: str


@dataclass(frozen=True, slots=True)
class FewTouches:
    """Fewer touches than parameters that they feel: the prior decides the rest."""

    touches: int
    parameters: int


@dataclass(frozen=True, slots=True)
class FewDegreesOfFreedom:
    """Hardly any degrees of freedom are left for the noise."""

    dof: float


@dataclass(frozen=True, slots=True)
class HeldOutInDoubt:
    """With few degrees of freedom: the held-out error, in units of the stated noise."""

    ratio: float


@dataclass(frozen=True, slots=True)
class FewPoses:
    """So few poses that errors of rotary axes, if any were set, can hardly be seen."""

    poses: int
    has_rotary: bool = True


@dataclass(frozen=True, slots=True)
class JointsStood:
    """Joints of a serial arm that stood still in all poses."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class WorseThanReplicates:
    """Residuals over the scatter of replicates, with the replicates' degrees of freedom."""

    ratio: float
    dof: int


@dataclass(frozen=True, slots=True)
class NoiseMisstated:
    """Scatter about the model, and the standard uncertainty stated, mm."""

    found: float
    stated: float


@dataclass(frozen=True, slots=True)
class OutliersKept:
    """More touches stand out than accidents can explain; none was left out."""


@dataclass(frozen=True, slots=True)
class OutliersLeftOut:
    """Gross errors that were left out.

    Attributes:
        lines: Of the run file, what stands out most first.
        largest: Largest distance from what the other touches predict, outwards positive, mm.
        runs: Names of the runs that the lines stand in, one each; empty for a single run.
    """

    lines: tuple[int, ...]
    largest: float
    runs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ManyStoodOut:
    """So many touches stood out that the error is reported with and without them.

    Attributes:
        touches: That stood out, of `of`.
        without: Error of held-out touches with them left out, mm.
        whole: With all touches in the fit, and judged, mm.
    """

    touches: int
    of: int
    left_out: bool
    without: float
    whole: float


@dataclass(frozen=True, slots=True)
class PriorWidened:
    """Factor by which the machine's errors exceed their stated distributions."""

    factor: float


@dataclass(frozen=True, slots=True)
class SearchEnded:
    """The search was ended after so many sets of effects."""

    sets: float


@dataclass(frozen=True, slots=True)
class NoiseRemembers:
    """Noise with memory, or a slow residual.

    Attributes:
        correlation: From one touch to the next, or over `step`.
        step: Time over which it is stated, s; 0 for from touch to touch.
        by_place: Whether touches remember the last one at the same place.
        independent: As many independent ones they count as.
        is_noise: Whether it is a property of the noise, rather than something slow that is left.
    """

    correlation: float
    step: float
    by_place: bool
    rows: int
    independent: float
    is_noise: bool


@dataclass(frozen=True, slots=True)
class ChosenByPrediction:
    """Ways that were tried with their plain errors of blocks left out, mm, and the one chosen.

    Attributes:
        is_empty: Whether no effect came of it with all rows in use.
    """

    chosen: str
    blocks: int
    tried: tuple[tuple[str, float], ...]
    is_empty: bool = False


@dataclass(frozen=True, slots=True)
class FieldShares:
    """What drives of a field of one axis explain, rms in mm, the largest first."""

    axis: str
    sizes: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class NotSignificant:
    """An effect that was added by name, with its size within twice its uncertainty.

    Attributes:
        u: Standard uncertainty, in `unit`.
    """

    effect: str
    quantity: str
    value: float
    u: float
    unit: str


@dataclass(frozen=True, slots=True)
class ShortBeam:
    """A beam whose length is so few times its depth that the theory of beams is doubtful."""

    effect: str
    slenderness: float


@dataclass(frozen=True, slots=True)
class LoadTooSmall:
    """An effect of loads that all touches together determine less well than its prior does."""

    effect: str
    load: float


Remark = (
    UnitMistake
    | BodySize
    | NoiseRemembers
    | ChosenByPrediction
    | FieldShares
    | ReaderRemark
    | FewTouches
    | FewDegreesOfFreedom
    | HeldOutInDoubt
    | FewPoses
    | JointsStood
    | WorseThanReplicates
    | NoiseMisstated
    | OutliersKept
    | OutliersLeftOut
    | ManyStoodOut
    | PriorWidened
    | SearchEnded
    | NotSignificant
    | HarmonicsAlike
    | JumpInOrder
    | ShortBeam
    | LoadTooSmall
    | EffectOfOtherRun
)


def remarks(fit: Fit, start: Fit | None = None) -> tuple[Remark, ...]:
    """Everything noteworthy in a fit: units, what the reader of the file noticed, the rest.

    Args:
        start: Of the model before effects were put in, which may stand in for a jump; None for
            that one itself.
    """
    units = unit_mistake(fit)
    out: list[Remark] = [] if units is None else [units]
    out += [ReaderRemark(text) for text in fit.run.remarks]
    out += body_sizes(fit.run.touches)
    out += _memory(fit)
    out += _touches(fit)
    jump = jump_in_order(start or fit)
    out += [] if jump is None else [jump]
    out += harmonics_alike(fit)
    out += _elastic(fit)
    out += ([] if units else _noise(fit)) + _outliers(fit)
    if fit.widened > 1.0:
        out.append(PriorWidened(fit.widened))
    return tuple(out)


def _touches(fit: Fit) -> list[Remark]:
    """Too few touches or poses."""
    out: list[Remark] = []
    n, felt = int(fit.used.sum()), np.linalg.norm(fit.X[fit.used], axis=0) > MIN_FELT
    p = int(felt.sum())
    if n < p:
        out.append(FewTouches(n, p))
    if fit.solution.dof < MIN_DOF:
        out.append(FewDegreesOfFreedom(fit.solution.dof))
        ratio = fit.standardised_test_rms / rms(fit.run.u)
        if ratio > MAX_HELD_OUT_RATIO:
            out.append(HeldOutInDoubt(ratio))
    t = fit.run.touches
    poses = len(np.unique(np.column_stack([t.setup, t.pose])[fit.used], axis=0))
    if poses < MIN_POSES:
        turns = bool(t.chain.rotary_axes) and not t.instrument.reads_angle
        out.append(FewPoses(poses, turns))
    stood = tuple(j for j in t.chain.joints if np.ptp(t.reading(j)[fit.used]) < MAX_STILL_RANGE)
    if stood:
        out.append(JointsStood(stood))
    return out


def _elastic(fit: Fit) -> list[Remark]:
    """Beams that are none, and loads that bend nothing."""
    touches = fit.run.touches
    out: list[Remark] = [
        ShortBeam(name, ratio) for name, ratio in short_beams(touches.chain, fit.model.effects)
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
            out.append(LoadTooSmall(effect.name, load))
    return out


def _memory(fit: Fit) -> list[Remark]:
    """Noise that remembers, or a residual that is slow."""
    memory = fit.memory
    if memory is None:
        return []
    rows = int(fit.used.sum())
    return [
        NoiseRemembers(
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
        ratio = noise.factor / noise.replicates
        if ratio > 1.0 + 3.0 * (0.5 / noise.replicates_dof) ** 0.5:
            return [WorseThanReplicates(ratio, noise.replicates_dof)]
    if noise.is_wrongly_stated:
        u = float(np.median(fit.run.u))
        return [NoiseMisstated(noise.factor * u, u)]
    return []


def _outliers(fit: Fit) -> list[Remark]:
    """Touches that were left out, or should have been if they were not so many."""
    gross = fit.gross
    both = _both_ways(fit)
    if gross.too_many:
        return [OutliersKept(), *both]
    rows = np.flatnonzero(gross.rows)
    if len(rows) == 0:
        return []
    rows = rows[np.argsort(-np.abs(gross.score[rows]))]
    largest = float(fit.residual[rows[np.argmax(np.abs(fit.residual[rows]))]])
    t = fit.run.touches
    of = tuple(t.runs[k] for k in t.run[rows]) if len(t.runs) > 1 else ()
    return [OutliersLeftOut(tuple(int(line) for line in fit.run.line[rows]), largest, of), *both]


def _both_ways(fit: Fit) -> list[Remark]:
    """The error without the touches that stand out, and with them, where they are many."""
    gross = fit.gross
    out = gross.standing if gross.too_many else gross.rows
    if out is None or not (gross.too_many or gross.are_many):
        return []
    other = replace(gross, rows=out & gross.too_many, too_many=False)
    beside = fit_run(fit.run, fit.model, gross=other, memory=fit.memory)
    without, whole = (beside, fit) if gross.too_many else (fit, beside)
    return [
        ManyStoodOut(
            touches=int(out.sum()),
            of=len(out),
            left_out=not gross.too_many,
            without=without.test_rms,
            whole=whole.test_rms,
        )
    ]
