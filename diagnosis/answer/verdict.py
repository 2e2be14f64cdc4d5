"""Result of a diagnosis: verdict, steps in which the error falls, and what stays open."""

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, Self

import numpy as np

from matstd.diagnosis.accuracy import Promise, promise
from matstd.diagnosis.answer.candidates import Candidate
from matstd.diagnosis.answer.detectable import Detectable
from matstd.diagnosis.answer.next_measurement import Plan
from matstd.diagnosis.answer.parts import Doubt, VerdictParts, geometry_part
from matstd.diagnosis.answer.steps import Step
from matstd.diagnosis.answer.trend import Trend
from matstd.diagnosis.choice import Choice
from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.fit import Fit, Prior
from matstd.diagnosis.geometry import LearntGeometry, learnt_geometry
from matstd.diagnosis.laws import Learning
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.remarks import Remark
from matstd.diagnosis.residual import Region, Structure
from matstd.twin.display import Tabular
from matstd.twin.frames import IntArray
from matstd.twin.model import Effect
from matstd.twin.record import Run
from matstd.twin.units import UM


class Verdict(Enum):
    """The outcome of a diagnosis; the values are the words of the file."""

    NONE = "no missing effect"
    MISSING = "missing effect"
    UNEXPLAINED = "unexplained"
    UNDECIDED = "undecided"


def verdict_of(parts: VerdictParts, is_found: bool, is_doubtful: bool) -> Verdict:
    """The word of the file.

    Args:
        is_found: Whether the diagnosis itself added an effect.
        is_doubtful: Whether the noise would have to be incredibly large.
    """
    if parts.is_unexplained:
        return Verdict.UNEXPLAINED
    if is_found and parts.headline:
        return Verdict.MISSING
    return Verdict.UNDECIDED if is_doubtful or is_found else Verdict.NONE


@dataclass(frozen=True, slots=True)
class Offer:
    """An effect close to the remaining residual, offered to be added by hand."""

    effect: str  # its name, for `--add`
    p_value: float  # probability by chance of so large a fall beside what was found
    test_rms: float  # error of held-out touches with it, mm


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """A variable on which a residual depends."""

    variable: str
    p_value: float
    structure: Structure


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Tabular):
    """All that a run shows about what its model lacks.

    Attributes:
        verdict: One of four; undecided where the noise would have to be far above the stated one
            and no repeats show it.
        steps: The error falling, effect by effect. Sizes to quote are `reported` of a step, which
            rest on the touches alone; estimates of `fit` lean on what is usual.
        parts: Geometry, named effects and remainder, each with its weight.
        predicting: The model that predicts: what was added, with every member of its classes that
            predicts differently.
        promise: Errors to expect of it, at the same touches and elsewhere; with laws that stand.
        promise_before: The same of the starting model.
        structure: What the residual of the starting model varies with.
        left: What the residual of the last step varies with; empty unless unexplained.
        depends_on: Variables of `structure`, or of `left` where the verdict is unexplained.
        where: Regions where the same residual fails, drawn by what the found effects explain.
        detectable: Smallest size of every effect that these touches would have shown.
        choice: How the set was chosen by prediction; None where the search left nothing to choose.
        trend: What changed between several runs; None for a single one.
        repeat: Rows of the touches whose repetition would decide, where the verdict is undecided.
        laws: Laws learnt from what remains; None where nothing remains, or none were looked for.
    """

    run: Run  # the measurements
    verdict: Verdict
    steps: tuple[Step, ...]
    parts: VerdictParts
    predicting: Fit
    promise: Promise
    promise_before: Promise
    candidates: tuple[Candidate, ...]  # every effect of the library by itself, the best first
    structure: tuple[Structure, ...]
    left: tuple[Structure, ...]
    depends_on: tuple[Dependence, ...]
    where: tuple[Region, ...]
    detectable: tuple[Detectable, ...]
    plans: tuple[Plan, ...]  # touches that would distinguish what this run does not
    geometry: LearntGeometry  # what the run says of the machine's geometry
    faults: tuple[
        DescriptionFault, ...
    ]  # mistakes of the machine file or the set-up that explain it
    remarks: tuple[Remark, ...]  # what else the user should know
    choice: Choice | None = None
    trend: Trend | None = None
    nearest: tuple[Offer, ...] = ()  # effects nearest to what remains, each with its gain
    repeat: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    laws: Learning | None = None

    def columns(self) -> dict[str, list[Any]]:
        """Every step in which the error falls; the first is the starting model."""
        fits = [step.fit for step in self.steps]
        return {
            "effect": [step.effect.name if step.effect else "" for step in self.steps],
            "p_value": [step.p_value for step in self.steps],
            "rms_um": [fit.rms / UM for fit in fits],
            "test_rms_um": [fit.test_rms / UM for fit in fits],
            "chi2_ratio": [fit.noise.chi2_ratio for fit in fits],
        }

    @property
    def start(self) -> Fit:
        """The starting model."""
        return self.steps[0].fit

    @property
    def fit(self) -> Fit:
        """The model with everything that was added."""
        return self.steps[-1].fit

    @property
    def found(self) -> tuple[Effect, ...]:
        """Effects that were added."""
        return tuple(step.effect for step in self.steps if step.effect is not None)

    @property
    def withdrawn(self) -> tuple[Effect, ...]:
        """Effects of `steps` in whose place laws stand, since they explain the run better."""
        return () if self.laws is None else self.laws.instead_of

    @property
    def standing(self) -> Fit:
        """The model with everything that stands: names, and laws beside them or in their place."""
        return self.laws.after if self.laws is not None and self.laws.laws else self.fit

    def _holds_names(self, laws: Learning) -> bool:
        """Whether the search did not distinguish the laws from the names that they would withdraw.

        Such laws are effects of the library themselves.
        """
        odds = {one.effect: one.log_odds for one in self.candidates}
        own = [odds.get(name, np.inf) for name in laws.of_library]
        named = [odds.get(effect.name, -np.inf) for effect in laws.instead_of]
        is_same = bool(own and named) and min(named) > max(own) - POLICY.log_odds_alike
        return is_same and not self.parts.remains.is_real

    @property
    def has_fallen(self) -> bool:
        """Whether anything stands beside the starting model."""
        return self.standing is not self.start

    def with_laws(self, laws: Learning, before: Prior | None = None) -> Self:
        """The same with laws of what remains.

        The geometry is that with them: what a law explains, the geometry imitates without it, as
        the straightness of an axis along which the run drifted. The errors to expect, before and
        after, are of touches left out of one fit each; after, of the average over laws that the run
        does not distinguish, which predicts. Names that the laws explain better are withdrawn: none
        of them stands in a headline, and no plan distinguishes a name withdrawn from its rivals. A
        law that is itself an effect of the library withdraws no name that the search did not
        distinguish from that effect.

        Args:
            before: Estimates of the starting model from an earlier run.
        """
        if self._holds_names(laws):
            return self
        found = replace(self, laws=laws)
        if found.standing is not self.fit:
            geometry = learnt_geometry(found.standing, before, self.start)
            part = geometry_part(geometry, self.faults, self.parts.geometry.left)
            found = replace(
                found,
                promise=promise(laws.saved),
                promise_before=promise(self.start),
                geometry=geometry,
                parts=replace(self.parts, geometry=part),
            )
        if not laws.instead_of:
            return found
        gone = {effect.name for effect in laws.instead_of}
        named = tuple(
            replace(one, doubt=Doubt.WITHDRAWN) if one.effect.name in gone else one
            for one in found.parts.named
        )
        parts = replace(found.parts, named=named)
        return replace(found, parts=parts, plans=())
