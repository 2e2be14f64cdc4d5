"""The verdict in three parts: the geometry, the effects that have names, and what remains.

A run scatters by more than its repeats. The ordinary geometry takes a share of that, named effects
take theirs, and the remainder has its own size, beside which the noise is what repeats show. So a
good name and an open question stand beside one another, and neither hides the other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from matstd.diagnosis.accuracy import Repeatability
from matstd.diagnosis.answer.ambiguity import Rival
from matstd.diagnosis.answer.steps import Step
from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.geometry import GeometryRow, LearntGeometry
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import Structure
from matstd.twin.model import Effect


@dataclass(frozen=True, slots=True, eq=False)
class GeometryPart:
    """What the ordinary model learnt."""

    # quantities that differ from the earlier model, or from run to run
    changed: tuple[GeometryRow, ...]
    # quantities larger than such a machine has, which hint at the description
    beyond: tuple[GeometryRow, ...]
    hints: tuple[DescriptionFault, ...]  # mistakes of the description that explain the run better
    left: float  # scatter of the residual of the geometric model alone, mm


class Doubt(Enum):
    """Why an effect that was found stands in no headline."""

    CHANCE = "chance may make it"
    UNCERTAIN = "its size is within its uncertainty"
    SMALL = "it is small beside the stated noise"
    WITHDRAWN = "a law explains more"


@dataclass(frozen=True, slots=True, eq=False)
class NamedEffect:
    """An effect with a name, and its weight in this run."""

    effect: Effect
    p_value: float
    explained: float  # root mean square of the scatter that it takes away, mm
    share: float  # the same as a share of the mean square beyond repeatability, 0 to 1
    # the next best explanation of what it explains; None for one that the user named, and where no
    # other effect of the library acts on these touches
    runner_up: Rival | None
    doubt: Doubt | None  # why it stands in no headline; None for one that does
    # log odds of an effect that follows a sensor against a smooth drift in time whose cause is not
    # recorded; None for others
    against_drift: float | None = None

    @property
    def is_headline(self) -> bool:
        """Whether it is certain, larger than its uncertainty, and large enough to name."""
        return self.doubt is None


@dataclass(frozen=True, slots=True, eq=False)
class Remainder:
    """What is left beside geometry and names."""

    scatter: float  # of the whole residual, mm, degrees of freedom accounted for
    # of what is beyond repeatability, or of its strongest pattern where no repeats show that, mm
    size: float
    share: float  # the same as a share of the mean square beyond repeatability, 0 to 1
    # probability by chance of so much more scatter than that of repeats; 1 without
    lack_of_fit: float
    patterns: tuple[Structure, ...]  # what it varies with
    is_real: bool  # whether it is beyond chance


@dataclass(frozen=True, slots=True, eq=False)
class VerdictParts:
    """The three parts, and what the data themselves repeat by."""

    geometry: GeometryPart
    named: tuple[NamedEffect, ...]
    remains: Remainder
    repeatability: Repeatability

    @property
    def headline(self) -> tuple[NamedEffect, ...]:
        """Effects that may stand in a headline."""
        return tuple(n for n in self.named if n.is_headline)

    @property
    def explained(self) -> float:
        """Root mean square of the scatter that all names together take away, mm."""
        return float(np.sqrt(sum(n.explained**2 for n in self.named)))

    @property
    def is_unexplained(self) -> bool:
        """Whether nothing is named, or more remains than the names explain."""
        return self.remains.is_real and (not self.headline or self.remains.size > self.explained)


def geometry_part(
    geometry: LearntGeometry, faults: Sequence[DescriptionFault], left: float
) -> GeometryPart:
    """What a learnt geometry has that changed or is too large, and what that hints at."""
    return GeometryPart(
        changed=tuple(r for r in geometry.rows if r.has_changed),
        beyond=tuple(r for r in geometry.rows if r.is_beyond_expected or r.is_far),
        hints=tuple(faults),
        left=left,
    )


def _doubt(step: Step, explained: float, stated: float) -> Doubt | None:
    """The first reason against a headline; the scatter that an effect takes away is in mm."""
    if step.p_value >= POLICY.false_alarm:
        return Doubt.CHANCE
    if step.worth < POLICY.significant_ratio:
        return Doubt.UNCERTAIN
    return Doubt.SMALL if explained <= POLICY.headline_noise_share * stated else None


def verdict_parts(
    steps: Sequence[Step],
    left: Sequence[Structure],
    geometry: LearntGeometry,
    faults: Sequence[DescriptionFault],
    repeats: Repeatability,
    against_drift: Mapping[str, float],
) -> VerdictParts:
    """The three parts of a verdict.

    Shares are of the mean square beyond repeatability, ``s_0^2 - s_r^2``; without repeats, of that
    beyond what is left apart from its strongest pattern.

    Args:
        left: Patterns that count in the last residual, beyond doubt and beyond what is stated.
        against_drift: Log odds against a driver that was not recorded, by name.
    """
    scatters = [repeats.stated * step.fit.noise.factor for step in steps]
    scatter, known = scatters[-1], repeats.known
    chance = repeats.lack_of_fit(scatter, steps[-1].fit.noise.dof)
    is_beyond = known is not None and scatter > POLICY.repeat_ratio * known.size
    structured = scatter * float(np.sqrt(min(max((s.share for s in left), default=0.0), 1.0)))
    size = structured if known is None else max(repeats.excess(scatter), structured)
    whole = max(scatters[0] ** 2 - scatter**2 + size**2, 1e-300)
    named, before = [], scatters[0]
    for step, own in zip(steps[1:], scatters[1:], strict=True):
        assert step.effect is not None
        explained = float(np.sqrt(max(before**2 - own**2, 0.0)))
        named.append(
            NamedEffect(
                effect=step.effect,
                p_value=step.p_value,
                explained=explained,
                share=min(explained**2 / whole, 1.0),
                runner_up=step.confusion.runner_up if step.confusion else None,
                doubt=_doubt(step, explained, repeats.stated),
                against_drift=against_drift.get(step.effect.name),
            )
        )
        before = min(before, own)
    return VerdictParts(
        geometry=geometry_part(geometry, faults, scatters[0]),
        named=tuple(named),
        remains=Remainder(
            scatter=scatter,
            size=size,
            share=min(size**2 / whole, 1.0),
            lack_of_fit=chance,
            patterns=tuple(left),
            is_real=bool(left) or (is_beyond and chance < POLICY.false_alarm),
        ),
        repeatability=repeats,
    )
