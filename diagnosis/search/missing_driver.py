"""Laws of a driver that was not recorded: any smooth course in time may drive them.

All temperatures of a workshop rise in the morning. Where the sensor that matters is missing, a law
of another one describes some of what it did, with a coefficient that no material has and a
prediction that fails the next day. So every body that may follow a temperature is also offered with
an unrecorded temperature. It costs the freedom of a whole curve, so that a sensor that
does drive the body is preferred; it has no name and predicts nothing, so that it joins the patterns
that remain.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from matstd.diagnosis.evidence import EffectSet, Grid, ScaledEffect, ranked, score_all, signatures
from matstd.twin.frames import Array
from matstd.twin.library import proposals
from matstd.twin.model import Effect, Parameter, Term, original_of, traits
from matstd.twin.record import Touches
from matstd.twin.units import T_REF

AT_ONCE = ("thermal-static", "thermal-expansion", "artefact-expansion")
"""Kinds that are proportional to a temperature; a body that lags behind a smooth one follows
another smooth one."""

COURSES = {6: 0.12, 12: 0.05}
"""Half waves of a temperature over a run, and its correlation length as a share of the run: the
morning of a workshop, and what an air conditioner makes of it."""

SENSOR = "unrecorded"


@dataclass(frozen=True, eq=False)
class Courses:
    """The touches of a run at the courses that a temperature may take, shared by all laws."""

    touches: Touches

    @cached_property
    def driven(self) -> tuple[Touches, ...]:
        """The touches at 20 degC, and with every half wave above it."""
        waves = [half_wave(self.touches, k) for k in range(max(COURSES) + 1)]
        return tuple(
            replace(self.touches, temperature={SENSOR: T_REF + wave})
            for wave in (np.zeros(len(self.touches)), *waves)
        )


@dataclass(frozen=True)
class Unrecorded:
    """A law after a temperature ``T = 20 degC + sum_k a_k cos(pi k t/t_end)`` that is not known."""

    law: Effect  # the same after a sensor, `SENSOR`
    half_waves: int  # of the temperature over a run, one of `COURSES`
    courses: Courses = field(compare=False, repr=False)  # at the touches of its run

    kind = "unrecorded"

    @property
    def name(self) -> str:
        """`unrecorded-6: thermal-expansion(Z)`."""
        law = self.law.name.replace(f",{SENSOR}", "").replace(f"({SENSOR})", "")
        return f"unrecorded-{self.half_waves}: {law}"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Amplitudes of its mean and of the half waves; together a kelvin as expected."""
        one = self.law.parameters[0]
        k = np.arange(self.half_waves + 1)
        spectrum = np.exp(-0.5 * (np.pi * k * COURSES[self.half_waves]) ** 2)
        sizes = np.sqrt(spectrum / spectrum.sum())
        return tuple(
            Parameter(f"{one.name} {i}", one.unit, one.sd * float(s))
            for i, s in zip(k, sizes, strict=True)
        )

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Terms of the law, once for the mean and for every half wave."""
        own = self.courses if touches is self.courses.touches else Courses(touches)
        base, *driven = own.driven
        still = [t.amount for t in self.law.terms(base)]
        return tuple(
            term._replace(parameter=k, amount=term.amount - zero)
            for k in range(self.half_waves + 1)
            for term, zero in zip(self.law.terms(driven[k]), still, strict=True)
        )


def half_wave(touches: Touches, k: int) -> Array:
    """``cos(pi k t/t_end)`` over the time of a run, (N,)."""
    t = touches.time - touches.time.min()
    return np.asarray(np.cos(np.pi * k * t / max(float(t.max()), 1e-9)))


def unrecorded(touches: Touches) -> list[Unrecorded]:
    """Every body that a temperature may move at these touches, after one that was not recorded."""
    if not np.ptp(touches.time) > 0.0:
        return []
    rising = T_REF + half_wave(touches, 1)
    known = replace(touches, temperature={SENSOR: rising})
    courses = Courses(touches)
    return [Unrecorded(law, k, courses) for law in proposals(known, AT_ONCE) for k in COURSES]


def likeliest_drift(others: EffectSet) -> tuple[ScaledEffect, float] | None:
    """The likeliest law of a driver that was not recorded beside a set, and the evidence with it.

    None where the run has no times.
    """
    laws = unrecorded(others.complement.touches)
    if not laws:
        return None
    pool = signatures(others.complement, [Grid(one, (one,), 1) for one in laws], 1)
    scores = score_all(others, pool)
    best = ranked(scores.evidence)[0]
    return ScaledEffect(laws[best], float(scores.scale[best])), float(scores.evidence[best])


def is_unrecorded(effect: Effect) -> bool:
    """Whether an effect stands for a driver that was not recorded."""
    return isinstance(effect, Unrecorded)


def follows_driver(effect: Effect) -> bool:
    """Whether a temperature, the spindle speed or an own column drives an effect."""
    own = traits(original_of(effect))
    return bool(own.driver or own.parameter_drives)


def is_own_sensor(effect: Effect) -> bool:
    """Whether a law follows the sensor on what it moves, by name: `scaleY` for EYY, `artefact`."""
    own = traits(original_of(effect))
    if own.symbol is None:
        axis = own.axis
    else:
        axis = own.symbol.link if own.symbol.name[1] == own.symbol.link[:1] else ""
    is_of_standard = bool(own.driver) and effect.kind.startswith(own.driver)
    return is_of_standard or bool(axis and own.driver.endswith(axis))
