"""What to measure next: the touches that would distinguish two effects, as a run plan."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array
from matstd.twin.model import columns
from matstd.twin.record import Touches

PLANNED_TOUCHES = 24
"""Touches of a plan."""

DEFAULT_PACE = 15.0
"""Time from touch to touch where the run does not state times, s."""

MIN_SEPARATION = 1.0
"""Least separation of a useful plan, standard deviations."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Touches that distinguish effects.

    Attributes:
        touches: What to touch, in the order of probing.
        separation: Expected difference of the two explanations after these touches, in standard
            deviations; before them it was nearly none.
        periods_of: The effect whose periods are distinguished; empty for two effects.
    """

    distinguishes: tuple[str, str]
    touches: Touches
    separation: float
    periods_of: str = ""


def plan(
    first: Fit,
    rivals: Sequence[Fit],
    names: tuple[str, str],
    offers: Touches,
) -> Plan | None:
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
    whole = _joined(run.touches, offers)
    u = float(np.median(first.u))
    own = columns(first.effects, whole)[len(run) :]
    others = [columns(f.effects, whole)[len(run) :] @ f.theta for f in rivals]
    difference = (own @ first.theta - np.array(others)) / u
    chosen, gained = _greedy(difference, own @ first.spread / u)
    if gained <= MIN_SEPARATION**2:
        return None
    ordered = np.array(sorted(chosen, key=lambda i: (offers.setup[i], offers.pose[i])))
    picked = offers[ordered]
    pace = _pace(run.touches)
    start = float(run.touches.time.max()) + pace
    time = np.asarray(start + pace * np.arange(len(picked)), dtype=float)
    return Plan(names, replace(picked, time=time), float(np.sqrt(gained)))


def _greedy(difference: Array, spread: Array) -> tuple[list[int], float]:
    """Choice of touches with the largest ``d^T (1 + S S^T)^-1 d``, and that value.

    Args:
        difference: Of every rival at every touch, (R, N).
        spread: Root of the covariance of the prediction, (N, P).
    """
    d, S = difference.copy(), spread.copy()
    chosen: list[int] = []
    gained = np.zeros(len(d))
    free = np.ones(d.shape[1], dtype=bool)
    for _ in range(min(PLANNED_TOUCHES, d.shape[1])):
        variance = 1.0 + np.einsum("np,np->n", S, S)
        i = int(np.argmax(np.where(free, d[int(np.argmin(gained))] ** 2 / variance, -1.0)))
        gained += d[:, i] ** 2 / variance[i]
        chosen.append(i)
        free[i] = False
        # what the touch teaches: covariance and expected difference of all others given this one
        along = S @ S[i] / variance[i]
        d = d - d[:, i][:, None] * along
        root = 1.0 / (1.0 + np.sqrt(1.0 / variance[i]))
        S = S - np.outer(along, S[i]) * root
    return chosen, float(gained.min())


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


def _joined(first: Touches, second: Touches) -> Touches:
    """Two records one after the other: effects that remember need what went before."""
    merged = {}
    for field in fields(Touches):
        a, b = getattr(first, field.name), getattr(second, field.name)
        if field.name in ("chain", "setups", "instrument") or a is None:
            merged[field.name] = a
        elif field.name in ("temperature", "value"):
            merged[field.name] = {k: np.concatenate([a[k], b[k]]) for k in a}
        else:
            merged[field.name] = np.concatenate([a, b])
    return Touches(**merged)
