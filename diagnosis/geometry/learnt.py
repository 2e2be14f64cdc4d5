"""What a fit has learnt of the machine's geometry, in the quantities that ISO 230-1 defines.

Single parameters of a model are rarely known: a slope of `EYX` and a rotation `EC0X` of the axis do
the same. What an engineer asks for is known: how much X and Y deviate from a right angle where it
was probed. So every quantity (`geometry_functionals`) is a linear function of all parameters,
``value = w . theta``, whatever they share among themselves, and its variance is ``w . C . w``.

Where the run leaves more than a third of what was expected beforehand, the estimate is mostly
expectation: such a quantity is no result, and it is told what it cannot be separated from.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from diagnosis.fit import Fit, Prior, fit_run
from diagnosis.geometry.changes import changed_since, of_first, since_first_run, standing, state
from diagnosis.geometry.expected import expected_size, stated_sizes
from diagnosis.geometry.functionals import functionals
from diagnosis.geometry.quantities import Functional, Quantity
from twin.frames import Array
from twin.machine import LETTERS, Link
from twin.model import Model

DETERMINED = 3.0
"""Expected over remaining standard deviation from which a quantity is a result: with less the
expectation has a say of more than a tenth, ``1 / 3^2``, in the estimate."""

CLEAR = 3.0
"""Standard uncertainties from which what exceeds the expectation is no chance."""

CHANGED = 4.0
"""Standard uncertainties from which a change is none: some fifty quantities are looked at, of which
one in three hundred such tables exceeds this by chance; of 3 one in eight would."""

SHARED = 0.3
"""Correlation of estimates from which a parameter is named as one that a quantity is shared with;
four parameters that share one direction evenly have a third each."""

NAMED = 4
"""Parameters that are named so."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with its standard uncertainty."""

    value: float
    u: float


@dataclass(frozen=True, slots=True)
class GeometryRow:
    """One quantity of the machine's geometry.

    Attributes:
        quantity: What it is.
        symbol: Its ISO 230-1 name, such as EC0Y for the squareness of Y to X.
        axes: The axis, or the two of a squareness, the reference first.
        unit: "mm", "rad", or "1" for a scale.
        estimate: In that unit; of a straightness, an angular error or an error motion the
            peak-to-valley over the probed readings.
        lever: What the estimate is multiplied by to say what it does at the ends, mm per unit.
        expected: Standard deviation before the run.
        is_determined: Whether the run, rather than the expectation, decides it.
        shared_with: Parameters that it cannot be separated from, where it is not determined.
        before: The same in an earlier model, or in the first of several runs.
        change: Now less before; None without a before.
        course: The same in every run, in their order, where there are several; None in a run that
            does not determine it.
        steps: What changed into every run but the first; None where either is not determined.
    """

    quantity: Quantity
    symbol: str
    axes: tuple[str, ...]
    unit: str
    estimate: Estimate
    lever: float
    expected: float
    is_determined: bool
    shared_with: tuple[str, ...] = ()
    before: Estimate | None = None
    change: Estimate | None = None
    course: tuple[Estimate | None, ...] = ()
    steps: tuple[Estimate | None, ...] = ()

    @property
    def at_ends(self) -> Estimate:
        """What it does over the whole travel of its axis, mm."""
        return Estimate(abs(self.estimate.value) * self.lever, self.estimate.u * self.lever)

    @property
    def is_beyond_expected(self) -> bool:
        """Whether it exceeds what such a machine was expected to have by more than chance."""
        bound = CLEAR * float(np.hypot(self.expected, self.estimate.u))
        return self.is_determined and abs(self.estimate.value) > bound

    @property
    def has_changed(self) -> bool:
        """Whether it differs from before, or one run from the next, by more than chance."""
        return (self.is_determined and _is_clear(self.change)) or any(map(_is_clear, self.steps))

    @property
    def has_changed_since_model(self) -> bool:
        """Whether the first run differs from an earlier model by more than chance."""
        first = self.course[0] if self.course else self.estimate if self.is_determined else None
        if first is None or self.before is None:
            return False
        u = float(np.hypot(first.u, self.before.u))
        return _is_clear(Estimate(first.value - self.before.value, u))

    def has_changed_into(self, run: int) -> bool:
        """Whether it differs from the run before by more than chance; the first run is 0."""
        return run > 0 and _is_clear(self.steps[run - 1])


def _is_clear(change: Estimate | None) -> bool:
    return change is not None and abs(change.value) > CHANGED * change.u


class Rung(Enum):
    """Steps of the ladder from what a user starts with."""

    SETUP = "set-up alone"
    MODEL = "the geometry of the model"
    COMMON = "one geometry for all runs"
    GEOMETRY = "geometry"
    EFFECTS = "effects"


@dataclass(frozen=True, slots=True)
class LadderStep:
    """Errors of one step, mm.

    Attributes:
        rung: What is in the model.
        rms: Root mean square residual of the rows fitted.
        test_rms: Of the rows held out.
    """

    rung: Rung
    rms: float
    test_rms: float


@dataclass(frozen=True, slots=True)
class Correction:
    """A number of the machine file as the run has it.

    Attributes:
        key: `axis.C.point`, `axis.Y.direction`, `probe.length_mm`.
        stated: What the file says, mm.
        found: What the run says.
        u: Standard uncertainty of every number; of those that stay as stated it is None.
    """

    key: str
    stated: tuple[float, ...]
    found: tuple[float, ...]
    u: tuple[float | None, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LearntGeometry:
    """What a run says of the geometry of its machine.

    Attributes:
        rows: Every quantity, axis by axis.
        ladder: The error from the set-up alone to everything in the model.
        corrections: Numbers of the machine file as the run has them.
    """

    rows: tuple[GeometryRow, ...]
    ladder: tuple[LadderStep, ...]
    corrections: tuple[Correction, ...]


def learnt_geometry(
    fit: Fit, before: Prior | None = None, start: Fit | None = None
) -> LearntGeometry:
    """What a fit says of the geometry of its machine.

    Args:
        fit: Of a model with component and location errors; others are no geometry.
        before: Estimates of the first parameters of that model by an earlier one; the machine is
            then fitted anew to this run alone, so that what is compared are two measurements.
        start: The same without further effects, if the fit has some.
    """
    rungs = ladder(fit) if start is None else ladder(start, fit)
    if before is not None:
        before = of_first(before, fit.model)
        fit = fit_run(fit.run, since_first_run(fit.model), gross=fit.gross)
    rows = geometry_rows(fit, before)
    return LearntGeometry(rows, rungs, corrections(fit, rows))


def geometry_rows(fit: Fit, before: Prior | None = None) -> tuple[GeometryRow, ...]:
    """Every quantity of the geometry, axis by axis; arguments as of `learnt_geometry`."""
    theta = _machine(fit)
    has_course = bool(changed_since(fit.model))
    states = [state(fit.model, r) for r in range(len(fit.run.touches.runs) if has_course else 1)]
    # peaks are chosen between all states, so that choosing them favours none
    known = [L @ theta for L in states] + ([] if before is None else [_padded(before, len(theta))])
    stated, told = stated_sizes(fit), functionals(fit, np.mean(known, axis=0))
    return tuple(_row(fit, one, states, before, stated) for one in told)


def changed_runs(fit: Fit) -> tuple[int, ...]:
    """Runs in which a quantity differs by more than chance from a run since the last change.

    Args:
        fit: In which every run has its own geometry.
    """
    fitted = [int(i) for i in np.unique(fit.run.touches.run[fit.used])]
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
    most = float(np.linalg.norm(w @ prior)) / DETERMINED
    is_known = max(_of(fit, w @ one).u, _of(fit, w @ other).u) < most
    return is_known and _is_clear(_of(fit, w @ other - w @ one))


def _machine(fit: Fit) -> Array:
    return fit.theta[: len(fit.model.parameters)]


def _row(
    fit: Fit, one: Functional, states: Sequence[Array], before: Prior | None, stated: Array
) -> GeometryRow:
    """One quantity of the last state, with its course over all of them."""
    machine = len(one.weights)
    every = np.stack([one.weights @ L for L in states])
    sd = float(np.linalg.norm(one.weights @ fit.prior.root[:machine, :machine]))
    values = [_of(fit, w) for w in every]
    is_known = [e.u * DETERMINED < sd for e in values]
    fitted = set(fit.run.touches.run[fit.used])
    course = tuple(e if is_known[i] and i in fitted else None for i, e in enumerate(values))
    steps = [
        _of(fit, every[i + 1] - every[i]) if is_known[i] and is_known[i + 1] else None
        for i in range(len(every) - 1)
    ]
    earlier = None if before is None else _estimate(before, one.weights)
    change = None
    if earlier is not None:
        u = float(np.hypot(values[-1].u, earlier.u))
        change = Estimate(values[-1].value - earlier.value, u)
    elif steps and is_known[0]:
        earlier, change = values[0], _of(fit, every[-1] - every[0])
    return GeometryRow(
        quantity=one.quantity,
        symbol=one.symbol,
        axes=one.axes,
        unit=one.unit,
        estimate=values[-1],
        lever=one.lever,
        expected=expected_size(fit, one.weights, stated),
        is_determined=is_known[-1],
        shared_with=() if is_known[-1] else _shared_with(fit, every[-1]),
        before=earlier,
        change=change,
        course=course if steps else (),
        steps=tuple(steps),
    )


def _of(fit: Fit, weights: Array) -> Estimate:
    """A linear function of the parameters of the model."""
    part = slice(len(weights))
    value = float(weights @ fit.theta[part])
    return Estimate(value, float(np.sqrt(weights @ fit.covariance[part, part] @ weights)))


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
    order = np.argsort(-r)[:NAMED]
    return tuple(dict.fromkeys(fit.names[k] for k in order if r[k] > SHARED))


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


def corrections(fit: Fit, rows: Sequence[GeometryRow]) -> tuple[Correction, ...]:
    """Points and directions of axes as the run has them, where they differ clearly.

    A displacement of a rotary axis's line moves its point, a tilt and a squareness turn the
    direction, ``d' = d + omega x d``. Only what the run determines by itself.

    Args:
        fit: That the rows were made from.
        rows: As from `learnt_geometry`.
    """
    kinds = (Quantity.ROTARY_LINE, Quantity.SQUARENESS)
    clear = [
        r
        for r in rows
        if r.quantity in kinds and r.is_determined and abs(r.estimate.value) > CLEAR * r.estimate.u
    ]
    out = []
    for name in dict.fromkeys(r.axes[-1] for r in clear):
        link = fit.model.chain.link(name)
        own = {LETTERS.index(r.symbol[1]): r.estimate for r in clear if r.axes[-1] == name}
        moved = {c: e for c, e in own.items() if c < 3}
        turned = {c - 3: e for c, e in own.items() if c >= 3}
        if moved:
            out.append(_moved_point(link, moved))
        if turned:
            out.append(_turned_direction(link, turned))
    return tuple(out)


def _moved_point(link: Link, moved: Mapping[int, Estimate]) -> Correction:
    point = tuple(float(v) for v in link.point)
    return Correction(
        key=f"axis.{link.name}.point",
        stated=point,
        found=tuple(v + (moved[i].value if i in moved else 0.0) for i, v in enumerate(point)),
        u=tuple(moved[i].u if i in moved else None for i in range(3)),
    )


def _turned_direction(link: Link, turned: Mapping[int, Estimate]) -> Correction:
    omega = np.array([turned[i].value if i in turned else 0.0 for i in range(3)])
    u_omega = np.array([turned[i].u if i in turned else 0.0 for i in range(3)])
    d = link.direction
    found = d + np.cross(omega, d)
    found = found / np.linalg.norm(found)
    u = np.sqrt((np.abs(np.cross(np.diag(u_omega), d)) ** 2).sum(axis=0))
    return Correction(
        key=f"axis.{link.name}.direction",
        stated=tuple(float(v) for v in d),
        found=tuple(float(v) for v in found),
        u=tuple(float(v) if v > 0.0 else None for v in u),
    )
