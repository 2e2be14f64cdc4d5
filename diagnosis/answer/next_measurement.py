"""What to measure next: the touches that would distinguish two effects, as a run plan."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.answer.alike import period_value
from matstd.diagnosis.answer.ambiguity import ConfusionClass
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.next_visit import candidate_targets, candidate_touches, greedy, separation
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.search import DiagnosisTask
from matstd.twin.model import columns
from matstd.twin.record import Touches, stacked

PLANNED_TOUCHES = 24  # touches of a plan
MAX_PERIODS_PLANNED = 8  # most periods that a plan of touches distinguishes, the longest ones
DEFAULT_PACE = 15.0  # time from touch to touch where the run does not state times, s
MIN_SEPARATION = 1.0  # least separation of a useful plan, standard deviations


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Touches that distinguish effects."""

    distinguishes: tuple[str, str]
    touches: Touches  # what to touch, in the order of probing
    # expected difference of the two explanations after these touches, in standard deviations;
    # before them it was nearly none
    separation: float
    periods_of: str = ""  # the effect whose periods are distinguished; empty for two effects


def plan(first: Fit, rivals: Sequence[Fit], names: tuple[str, str], offers: Touches) -> Plan | None:
    """The touches that would separate explanations of a run best.

    Greedy: the next touch is the one at which the two fitted models differ most, measured against
    noise and against what the uncertainty of the first could make up for; it then learns from it.
    Of several rivals it serves the one distinguished least so far.

    Returns:
        None where the run gives no touches to choose from, or they all agree.
    """
    run = first.run
    if len(offers) < PLANNED_TOUCHES:
        return None
    offers = _later(run.touches, offers)
    whole = stacked([run.touches, offers], run.touches.setups)
    u = float(np.median(first.u))
    own = columns(first.effects, whole)[len(run) :]
    spread = own @ first.spread / u
    others = [columns(f.effects, whole)[len(run) :] @ f.theta / u for f in rivals]
    predicted = [(mean, spread) for mean in (own @ first.theta / u, *others)]
    chosen = greedy(predicted[0], predicted[1:], PLANNED_TOUCHES)
    seen, *unlike = [(mean[chosen], root[chosen]) for mean, root in predicted]
    apart = min(separation(seen, other) for other in unlike)
    if apart <= MIN_SEPARATION:
        return None
    ordered = np.array(sorted(chosen, key=lambda i: (offers.setup[i], offers.pose[i])))
    picked = offers[ordered]
    pace = _pace(run.touches)
    start = float(run.touches.time.max()) + pace
    time = np.asarray(start + pace * np.arange(len(picked)), dtype=float)
    return Plan(names, replace(picked, time=time), apart)


def _pace(touches: Touches) -> float:
    """Usual time between touches, s."""
    steps = np.diff(np.sort(touches.time))
    return float(np.median(steps)) if np.any(steps > 0.0) else DEFAULT_PACE


def _later(touches: Touches, offers: Touches) -> Touches:
    """Offers after the run, one after the other; sensors and spindle as at its end."""
    pace = _pace(touches)
    last = int(np.argmax(touches.time))
    time = np.asarray(touches.time.max() + pace * np.arange(1, len(offers) + 1), dtype=float)
    temperature = {k: np.full(len(offers), v[last]) for k, v in touches.temperature.items()}
    own = {k: np.full(len(offers), v[last]) for k, v in touches.value.items()}
    rpm = None if touches.spindle_rpm is None else np.full(len(offers), touches.spindle_rpm[last])
    return replace(offers, time=time, temperature=temperature, value=own, spindle_rpm=rpm)


def plans(
    task: DiagnosisTask,
    classes: Sequence[ConfusionClass],
    gross: GrossErrors,
    rng: np.random.Generator | None,
) -> tuple[Plan, ...]:
    """For every found effect the touches that would distinguish it from its likeliest rival."""
    if rng is None:
        return ()
    heads = [c.sized for c in classes]
    out = []
    for i, confusion in enumerate(classes):

        def instead(rival: ScaledEffect, i: int = i) -> Fit:
            return task.fit_found((*heads[:i], rival, *heads[i + 1 :]), gross)

        name, alike = heads[i].effect.name, confusion.alike
        if alike is not None and alike.others:
            fits = [instead(other) for other in alike.others[:MAX_PERIODS_PLANNED]]
            periods = [f"{p:.4g}" for p in alike.periods[:MAX_PERIODS_PLANNED]]
            own = period_value(heads[i].effect)
            names = (f"{name}@{own:.4g}", f"{name}@{','.join(periods)}")
            offers = candidate_targets(task.run, alike.axis, rng)
            found = plan(instead(heads[i]), fits, names, offers)
            out += [replace(found, periods_of=name)] if found is not None else []
        # the likeliest rival may be inseparable by any offer; then the next one is tried
        for rival in confusion.rivals:
            offers = candidate_touches(task.run, rng)
            names = (name, rival.effect.name)
            found = plan(instead(heads[i]), [instead(rival.sized)], names, offers)
            if found is not None:
                out.append(found)
                break
    return tuple(out)
