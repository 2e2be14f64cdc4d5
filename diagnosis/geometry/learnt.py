"""What a fit has learnt of the machine's geometry, in the quantities that ISO 230-1 defines.

Single parameters of a model are rarely known: a slope of `EYX` and a rotation `EC0X` of the axis do
the same. What an engineer asks for is known: how much X and Y deviate from a right angle where it
was probed. So every quantity (`geometry_functionals`) is a linear function of all parameters,
``value = w . theta``, whatever they share among themselves, and its variance is ``w . C . w``.

Where the run leaves more than a third of what was expected beforehand, the estimate is mostly
expectation: such a quantity is no result, and what it cannot be separated from is reported.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from matstd.diagnosis.fit import Fit, Prior, fit_run
from matstd.diagnosis.geometry.changes import (
    changed_since,
    of_first,
    since_first_run,
    standing,
    state,
)
from matstd.diagnosis.geometry.corrections import Correction, corrections
from matstd.diagnosis.geometry.functionals import functionals
from matstd.diagnosis.geometry.model_choice import with_model_choice
from matstd.diagnosis.geometry.quantities import (
    Functional,
    Quantity,
    geometric_effects,
    is_geometry,
)
from matstd.diagnosis.geometry.rivals import FoundNumber
from matstd.diagnosis.geometry.rows import Estimate, GeometryRow, is_clear
from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array
from matstd.twin.model import Model, traits

LOCATIONS = (Quantity.ROTARY_LINE, Quantity.ROTARY_ZERO)
"""Quantities that one location error is named by, whose usual size is expected of them."""

MIN_SHARED_CORRELATION = 0.3
"""Correlation of estimates from which a parameter is named as one that a quantity is shared with;
four parameters that share one direction evenly have a third each."""

MAX_NAMED = 4  # parameters that are named so


class Rung(Enum):
    """Steps of the ladder from what a user starts with."""

    SETUP = "set-up alone"
    MODEL = "the geometry of the model"
    COMMON = "one geometry for all runs"
    GEOMETRY = "geometry"
    EFFECTS = "effects"


@dataclass(frozen=True, slots=True)
class LadderStep:
    """Errors of one step, mm."""

    rung: Rung
    rms: float
    test_rms: float


@dataclass(frozen=True, slots=True, eq=False)
class LearntGeometry:
    """What a run says of the geometry of its machine."""

    rows: tuple[GeometryRow, ...]  # every quantity, axis by axis
    ladder: tuple[LadderStep, ...]  # the error from the set-up alone to everything in the model
    corrections: tuple[Correction, ...]
    # numbers that each explain alone all lines far from where they are stated, where several keys
    # of the machine file would have to be changed instead
    together: tuple[FoundNumber, ...] = ()


def learnt_geometry(
    fit: Fit, before: Prior | None = None, start: Fit | None = None
) -> LearntGeometry:
    """What a fit says of the geometry of its machine.

    Args:
        fit: Fit of a model with component and location errors; others are no geometry.
        before: Estimates of the first parameters of that model by an earlier one; the machine is
            then fitted anew to this run alone, so that what is compared are two measurements.
        start: The same without further effects, if the fit has some.
    """
    rungs = ladder(fit) if start is None else ladder(start, fit)
    if before is not None:
        before = of_first(before, fit.model)
        fit = fit_run(fit.run, since_first_run(fit.model), gross=fit.gross)
    rows = with_model_choice(fit, geometry_rows(fit, before))
    return LearntGeometry(rows, rungs, *corrections(fit, rows))


def geometry_rows(fit: Fit, before: Prior | None = None) -> tuple[GeometryRow, ...]:
    """Every quantity of the geometry, axis by axis; arguments as of `learnt_geometry`."""
    theta = _machine(fit)
    has_course = bool(changed_since(fit.model))
    states = [state(fit.model, r) for r in range(len(fit.run.touches.runs) if has_course else 1)]
    # what changed is taken between the peaks of all states, so that choosing them favours none
    known = [L @ theta for L in states] + ([] if before is None else [_padded(before, len(theta))])
    stated, quantities = stated_sizes(fit), functionals(fit, np.mean(known, axis=0))
    return tuple(_row(fit, one, states, before, stated) for one in quantities)


def changed_runs(fit: Fit) -> tuple[int, ...]:
    """Runs in which a quantity differs by more than chance from a run since the last change."""
    fitted = [int(i) for i in np.unique(fit.run.touches.run[fit.used])]
    if len(fitted) < 2:
        return ()
    states = {i: state(fit.model, i) for i in fitted}
    prior = fit.prior.root[: len(fit.model.parameters), : len(fit.model.parameters)]
    quantities = list(functionals(fit, np.mean([L @ _machine(fit) for L in states.values()], 0)))
    out: list[int] = []
    alike = fitted[:1]
    for i in fitted[1:]:
        if any(
            _differs(fit, one.weights, states[j], states[i], prior)
            for one in quantities
            for j in alike
        ):
            out.append(i)
            alike = []
        alike.append(i)
    return tuple(out)


def _differs(fit: Fit, w: Array, one: Array, other: Array, prior: Array) -> bool:
    """Whether a quantity is determined in two states and differs between them."""
    most = float(np.linalg.norm(w @ prior)) / POLICY.determined_ratio
    is_known = max(_of(fit, w @ one).u, _of(fit, w @ other).u) < most
    return is_known and is_clear(_of(fit, w @ other - w @ one))


def _machine(fit: Fit) -> Array:
    return fit.theta[: len(fit.model.parameters)]


def _row(
    fit: Fit, one: Functional, states: Sequence[Array], before: Prior | None, stated: Array
) -> GeometryRow:
    """One quantity of the last state, with its course over all of them.

    A peak to valley is that of the state itself, and has no sign. A change is that between readings
    which are the same in all states: a curve that turned over has the same height as before.
    """
    machine = len(one.weights)
    every = np.stack([one.weights @ L for L in states])
    sd = float(np.linalg.norm(one.weights @ fit.prior.root[:machine, :machine]))
    theta = _machine(fit)
    values = [_of(fit, one.at(L @ theta) @ L) for L in states]
    is_known = [e.u * POLICY.determined_ratio < sd for e in values]
    usual = _usual(fit, one) if one.quantity in LOCATIONS else None
    of_all = expected_size(fit, one.weights, stated)
    # what all errors may add up to at a line is no size that a line of such a machine has
    expected = usual or of_all
    # a residual that widens what is expected makes no size of what the run leaves open
    is_known = [k and _is_size(e, expected) for k, e in zip(is_known, values, strict=True)]
    fitted = set(fit.run.touches.run[fit.used])
    course = tuple(e if is_known[i] and i in fitted else None for i, e in enumerate(values))
    # a difference is taken by its own weights, since the states share most of their errors
    steps = [
        _of(fit, every[i + 1] - every[i]) if is_known[i] and is_known[i + 1] else None
        for i in range(len(every) - 1)
    ]
    earlier = change = since_model = None
    if before is not None:
        earlier = _estimate(before, one.at(_padded(before, machine)))
        there = _estimate(before, one.weights)
        since_model, change = (_less(_of(fit, w), there) for w in (every[0], every[-1]))
    elif steps and is_known[0]:
        earlier, change = values[0], _of(fit, every[-1] - every[0])
    return GeometryRow(
        quantity=one.quantity,
        symbol=one.symbol,
        axes=one.axes,
        unit=one.unit,
        estimate=values[-1],
        lever=one.lever,
        expected=expected,
        is_determined=is_known[-1],
        shared_with=() if is_known[-1] else _shared_with(fit, every[-1]),
        before=earlier,
        change=change,
        since_model=since_model,
        course=course if steps else (),
        steps=tuple(steps),
        usual=usual,
        added_up=of_all if usual else 0.0,
        by_laws=_by_laws(fit, one, states[-1]),
    )


def _by_laws(fit: Fit, one: Functional, state: Array) -> Estimate | None:
    """The part of a quantity that is not of the ordinary errors, such as a learnt law."""
    kinds = [is_geometry(effect) for effect, _ in fit.model.parameters]
    if one.curve is not None or all(kinds):
        return None
    return _of(fit, np.where(kinds, 0.0, one.weights @ state))


def _is_size(estimate: Estimate, expected: float) -> bool:
    """Whether an estimate is sharper than what was expected of it, or clear by itself."""
    is_clear = abs(estimate.value) > POLICY.significant_ratio * estimate.u
    return is_clear or estimate.u * POLICY.determined_ratio < expected


def _usual(fit: Fit, one: Functional) -> float | None:
    """Usual size of the location error that a line is named by, if the model has it."""
    name = f"location({one.symbol})"
    return next((p.sd for e, p in fit.model.parameters if e.name == name), None)


def _of(fit: Fit, weights: Array) -> Estimate:
    """A linear function of the parameters of the model."""
    part = slice(len(weights))
    value = float(weights @ fit.theta[part])
    return Estimate(value, float(np.sqrt(weights @ fit.covariance[part, part] @ weights)))


def _less(one: Estimate, other: Estimate) -> Estimate:
    """One estimate less an independent one."""
    return Estimate(one.value - other.value, float(np.hypot(one.u, other.u)))


def _padded(known: Prior, count: int) -> Array:
    """Estimates with zeros for the effects that an earlier model did not have."""
    return np.concatenate([known.mean, np.zeros(count - len(known))])


def _estimate(known: Prior, weights: Array) -> Estimate:
    w = weights[: len(known)]
    return Estimate(float(w @ known.mean), float(np.linalg.norm(w @ known.root)))


def _shared_with(fit: Fit, weights: Array) -> tuple[str, ...]:
    """Names of the parameters whose estimates go with that of a quantity, the closest first."""
    w = np.zeros(len(fit.prior))
    w[: len(weights)] = weights
    along = fit.covariance @ w
    u = np.sqrt(np.diag(fit.covariance))
    r = np.abs(along) / np.maximum(u * np.sqrt(max(float(w @ along), 1e-300)), 1e-300)
    r[w != 0.0] = 0.0
    order = np.argsort(-r)[:MAX_NAMED]
    return tuple(dict.fromkeys(fit.names[k] for k in order if r[k] > MIN_SHARED_CORRELATION))


def ladder(geometry: Fit, effects: Fit | None = None) -> tuple[LadderStep, ...]:
    """How the error falls from where the standard stood alone to everything in the model.

    So the model is not credited with finding the standard on the table.

    Args:
        geometry: The starting model, fitted.
        effects: With further effects; None where there are none.
    """
    alone = fit_run(geometry.run, Model(geometry.model.chain, ()), gross=geometry.gross)
    fits = [(Rung.SETUP, alone)]
    fits += [(Rung.GEOMETRY, geometry)] if geometry.model.effects else []
    if changed_since(geometry.model):
        common = Model(geometry.model.chain, standing(geometry.model))
        own = slice(len(common.parameters))
        prior = Prior(geometry.prior.mean[own], geometry.prior.root[own, own])
        rung = Rung.COMMON if len(geometry.run.touches.runs) > 1 else Rung.MODEL
        fits.insert(1, (rung, fit_run(geometry.run, common, prior, gross=geometry.gross)))
    fits += [] if effects is None else [(Rung.EFFECTS, effects)]
    return tuple(LadderStep(rung, fit.rms, fit.test_rms) for rung, fit in fits)


def expected_size(fit: Fit, weights: Array, stated: Array) -> float:
    """Standard deviation before the run, as the axis or the class of the machine has it.

    Args:
        weights: Weights of the parameters, (P,).
        stated: `stated_sizes` of the fit.
    """
    part = slice(len(weights))
    sd = (weights / fit.prior.factor[part] / fit.widened) @ fit.prior.root[part, part]
    return float(np.linalg.norm(sd * stated))


def stated_sizes(fit: Fit) -> Array:
    """What the machine file expects of every parameter over what its class has, (P,)."""
    out = np.ones(len(fit.model.parameters))
    for start, effect in geometric_effects(fit):
        symbol = traits(effect).ordinary_component
        if symbol is not None and not symbol.is_angular:
            expected = fit.model.chain.link(symbol.link).expected
            if expected is not None:
                sizes = [p.sd for p in effect.parameters]
                out[start : start + len(sizes)] = expected / np.array(sizes)
    return out
