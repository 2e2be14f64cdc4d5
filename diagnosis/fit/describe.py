"""Parameters of fitted effects as a user reads them: names with units, sizes, uncertainties."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.linalg import orth

from matstd.diagnosis.fit.identification import Fit
from matstd.information.identifiability import column_lengths
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Effect, Inner, columns, inner_values, traits
from matstd.twin.numbers import rms
from matstd.twin.record import Touches
from matstd.twin.units import DEG, MINUTE, UM, URAD

END_SHARE = 1e-3  # share of an end of a scan within which a value lies at it
MIN_UNSEEN_SHARE = 0.99  # share of its prior uncertainty that a parameter keeps if no touch sees it

RANK_TOLERANCE = 1e-6
"""Singular values of columns below this share of the largest are rounding: they say the same."""

MIN_LEVER_SHARE = 0.1
"""Share of the largest lever below which a row shows noise rather than the curve."""

SINE_PREFIX = "sine_"
"""Begins the amplitude of a sine of a period, before its number."""

_HEADS = {"mm": ("um", UM), "rad": ("urad", URAD), "s": ("ms", 1e-3)}


class Role(Enum):
    """What a number is among the numbers of an effect."""

    SIZE = "size"
    INNER = "inner parameter"
    COEFFICIENT = "coefficient"


@dataclass(frozen=True, slots=True)
class Reported:
    """One number of an effect as it stands in a file."""

    quantity: str  # what it is: `amplitude`, `tau`
    unit: str  # as the file spells it: `um`, `min`, `um_per_K`; "" for a pure number
    value: float
    u: float | None  # standard uncertainty, or None where the run gives none
    factor: float  # one of that unit in the base unit
    role: Role  # role of the number among those of its effect
    # -1 or 1 where it lies at the lower or upper end of what was scanned, and is no more than a
    # bound; 0 for an estimate
    bound: int = 0

    @property
    def name(self) -> str:
        """With its unit: `amplitude_um`, `tau_min`."""
        return f"{self.quantity}_{self.unit}" if self.unit else self.quantity


def file_unit(unit: str) -> tuple[str, float]:
    """Suffix of a linear parameter in files, and one of it in the base unit.

    Example:
        >>> file_unit("mm/K")
        ('um_per_K', 0.001)
    """
    if unit == "1/K":
        return "um_per_m_K", 1e-6
    head, _, tail = unit.partition("/")
    label, factor = _HEADS.get(head, (head, 1.0))
    return f"{label}_per_{tail}" if tail else label, factor


def inner_unit(inner: Inner) -> tuple[str, float]:
    """Suffix of an inner parameter in files, and one of it in the base unit.

    Spans of time such as time constants are reported in minutes, instants as the run states time.

    Example:
        >>> inner_unit(Inner("tau", "s", np.array([60.0, 600.0])))
        ('_min', 60.0)
    """
    if inner.unit == "s":
        return ("_s", 1.0) if inner.acts == "at an instant" else ("_min", MINUTE)
    return {"mm": ("_mm", 1.0), "rad": ("_deg", DEG)}.get(inner.unit, ("", 1.0))


def reported(
    fit: Fit,
    effect: Effect,
    wider: float = 1.0,
    without_tangent: Mapping[int, tuple[float, float]] | None = None,
) -> tuple[Reported, ...]:
    """Inner parameters, the size, and every linear parameter of a fitted effect.

    Args:
        fit: A fit with the effect, and with the tangents of its inner parameters where their
            uncertainty is wanted.
        wider: Factor on the uncertainties of the fit.
        without_tangent: Inner parameters that have none, with their uncertainties, by index.
    """
    place = fit.of_effect(effect.name)
    theta, covariance = fit.theta[place], fit.covariance[place, place] * wider**2
    out = list(_inner(fit, effect, wider, without_tangent or {}))
    own = traits(effect)
    if own.is_shrunk or own.is_tensor:
        out.append(explained_rms(fit, effect, theta, covariance))
    elif own.is_curve:
        out += curve_sizes(fit, effect)
    elif own.changes is not None:
        out += _changes(fit, effect, wider)
    elif len(theta) > 1 and not own.is_by_parameter:
        out.append(size(effect, theta, covariance, _is_seen(fit, place)))
    if own.wave is not None and own.wave.sines > 1:
        out += _sines(effect, own.wave.sines, theta, covariance)
    for i, parameter in enumerate(effect.parameters):
        suffix, factor = file_unit(parameter.unit)
        out.append(
            Reported(
                quantity=parameter.name.replace(" ", "_"),
                unit=suffix,
                value=float(theta[i]) / factor,
                u=float(np.sqrt(covariance[i, i])) / factor,
                factor=factor,
                # where nothing sums them up, the coefficient is the size
                role=Role.SIZE if len(theta) == 1 or own.is_by_parameter else Role.COEFFICIENT,
            )
        )
    return tuple(out)


def _sines(effect: Effect, sines: int, theta: Array, covariance: Array) -> Iterator[Reported]:
    """Amplitude of every sine of a period, `sine_1` that of the whole one."""
    for k in range(1, sines + 1):
        own = np.arange(len(theta)) // 2 == k - 1
        one = size(effect, theta, covariance, own)
        yield replace(one, quantity=f"{SINE_PREFIX}{k}", role=Role.COEFFICIENT)


def explained_rms(fit: Fit, effect: Effect, theta: Array, covariance: Array) -> Reported:
    """Deviation that an effect of many parameters explains, rms over the used rows that it moves.

    Of parameters that share what they know, and of the entries of a tensor, neither one nor their
    length means anything.
    """
    C = columns([effect], fit.run.touches)[fit.used]
    C = C[np.any(C != 0.0, axis=1)]
    explained = C @ theta
    size = rms(explained)
    # d rms / d theta = C^T C theta / (n size)
    slope = C.T @ explained / max(len(C) * size, 1e-300)
    return _reported_size("rms", "mm", size, slope, covariance)


def curve_sizes(fit: Fit, effect: Effect) -> Sequence[Reported]:
    """Peak to valley of the curve that an effect of many parameters is, and its reversal.

    Over the rows used, in the unit of the component error that it is: an angle of a rotary axis.
    Of a component error it is the whole curve that the model has of it, of a length without its
    straight line, which is a scale or where the standard stands: what is added where a parabola
    does not suffice has no size of its own. Of others (`is_reported_whole`) it is that of the
    effect alone.
    """
    touches = fit.run.touches[fit.used]
    own = _of_same_curve(fit, effect)
    every = np.concatenate([np.r_[fit.of_effect(e.name)] for e in own])
    theta, covariance = fit.theta[every], fit.covariance[np.ix_(every, every)]
    C = columns(own, touches)
    curve, unit = _curve(own, touches)
    lever = np.linalg.norm(C, axis=1) / np.maximum(np.linalg.norm(curve, axis=1), 1e-300)
    if not traits(effect).is_reported_whole:
        others = [e for e in fit.effects if e not in own]
        u = fit.u[fit.used][:, None]
        beside = columns(others, touches) / u
        Q = orth(beside / column_lengths(beside), rcond=RANK_TOLERANCE)
        # which side of it a lever is on shows where the curve is not freed of others yet
        side = np.sign(np.einsum("np,np->n", C, curve))
        C = C - u * (Q @ (Q.T @ (C / u)))
        curve = C * (side / np.maximum(lever, 1e-300))[:, None]
    seen = lever > MIN_LEVER_SHARE * lever.max()
    values = np.where(seen, curve @ theta, np.nan)
    across = curve[int(np.nanargmax(values))] - curve[int(np.nanargmin(values))]
    whole = _reported_size("peak_to_valley", unit, float(across @ theta), across, covariance)
    return [whole, *_reversals(fit, effect)]


def _changes(fit: Fit, effect: Effect, wider: float) -> Sequence[Reported]:
    """What an effect changed within the run, with what its inner parameters contribute.

    The largest first: a screw does not grow at its fixed bearing.
    """
    of = traits(effect).changes
    tangents = [t for t in fit.tangents if t.effect.name == effect.name]
    every = [effect, *tangents]
    place = np.concatenate([np.r_[fit.of_effect(e.name)] for e in every])
    theta, covariance = fit.theta[place], fit.covariance[np.ix_(place, place)] * wider**2
    out = []
    for name, pair in () if of is None else of(fit.run.touches[fit.used]):
        curve, unit = _curve(every, pair)
        w = curve[1] - curve[0]
        out.append(_reported_size(name, unit, float(w @ theta), w, covariance))
    return sorted(out, key=lambda one: -abs(one.value))


def _of_same_curve(fit: Fit, effect: Effect) -> list[Effect]:
    """An effect with what else the model holds of the same component error.

    Without its straight line where that is a scale or where the standard stands; of an angle it is
    part of the error.
    """
    symbol = traits(effect).symbol
    placed = ("constant",) if symbol is not None and symbol.is_angular else ("constant", "linear")
    alike = [
        e
        for e in fit.model.effects
        if symbol is not None
        and e.kind == "geometric"
        and traits(e).symbol == symbol
        and traits(e).distribution not in placed
        and e.name != effect.name
    ]
    return [effect, *alike]


def _reversals(fit: Fit, effect: Effect) -> Iterator[Reported]:
    """Reversal of a curve for either direction, on average over the readings used and at most.

    The difference of both curves, forward less backward: of a positioning test that of ISO 230-2.
    """
    own = traits(effect)
    if own.reversal is None or own.symbol is None:
        return
    place = fit.of_effect(effect.name)
    theta, covariance = fit.theta[place], fit.covariance[place, place]
    touches = fit.run.touches[fit.used]
    first = np.unique(np.round(touches.reading(own.symbol.link), 4), return_index=True)[1]
    reversal = own.reversal(touches[first])
    widest = reversal[int(np.argmax(np.abs(reversal @ theta)))]
    for name, w in (("on_average", reversal.mean(axis=0)), ("at_most", widest)):
        yield _reported_size(f"reversal_{name}", own.symbol.unit, float(w @ theta), w, covariance)


def _curve(effects: Sequence[Effect], touches: Touches) -> tuple[Array, str]:
    """The one error that all terms of some effects are, per unit of every parameter, (N, P).

    A joint whose line lies between the axes of the machine turns about a direction of its own.
    """
    blocks = []
    for effect in effects:
        A = np.zeros((6, len(touches), len(effect.parameters)))
        for term in effect.terms(touches):
            A[term.where.component, :, term.parameter] += term.amount
        blocks.append(A)
    A = np.concatenate(blocks, axis=2)
    U = np.linalg.svd(A.reshape(6, -1), full_matrices=False)[0]
    along = U[:, 0] * np.sign(U[np.argmax(np.abs(U[:, 0])), 0])
    return np.einsum("c,cnp->np", along, A), "rad" if np.any(along[3:]) else "mm"


def _reported_size(
    quantity: str, unit: str, value: float, slope: Array, covariance: Array
) -> Reported:
    """A size of an effect in files, with the uncertainty of a function with this slope."""
    return _size(quantity, unit, value, float(np.sqrt(slope @ covariance @ slope)))


def _size(quantity: str, unit: str, value: float, u: float) -> Reported:
    """A size of an effect in files, from value and uncertainty in its base unit."""
    suffix, factor = file_unit(unit)
    return Reported(
        quantity=quantity,
        unit=suffix,
        value=value / factor,
        u=u / factor,
        factor=factor,
        role=Role.SIZE,
    )


def _is_seen(fit: Fit, place: slice) -> Mask:
    """Which parameters the run determines at all; all, where it determines none."""
    u = np.sqrt(np.diag(fit.covariance[place, place]))
    seen = np.asarray(u < MIN_UNSEEN_SHARE * fit.prior.sd[place])
    return seen if seen.any() else np.ones(len(u), dtype=bool)


def size(effect: Effect, theta: Array, covariance: Array, seen: Mask | None = None) -> Reported:
    """Length of those parameters that share the unit of the first, with its uncertainty.

    Parameters that no touch sees, such as a slip across the only direction that was probed, are
    left out. Of a sine and a cosine it is the amplitude; of a displacement its length. Noise across
    a vector makes it longer, ``E|v|^2 = |v_true|^2 + tr C_across``: that is taken off, three
    quarters of the square at most, and its own scatter ``tr C_across^2 / (2 |v|^2)`` is in the
    uncertainty.

    Reference:
        Gudbjartsson and Patz, Magnetic Resonance in Medicine 34 (1995) 910 (Rician bias).
    """
    units = [p.unit for p in effect.parameters]
    seen = np.ones(len(units), dtype=bool) if seen is None else seen
    first = units[int(np.argmax(seen))]
    same = seen & np.array([unit == first for unit in units])
    part, C = theta[same], covariance[np.ix_(same, same)]
    squared = max(float(part @ part), 1e-300)
    direction = part / np.sqrt(squared)
    away = np.eye(len(part)) - np.outer(direction, direction)
    across = away @ C @ away
    length = np.sqrt(max(squared - float(np.trace(across)), 0.25 * squared))
    variance = direction @ C @ direction + float((across**2).sum()) / (2.0 * squared)
    return _size("amplitude", first, float(length), float(np.sqrt(max(variance, 0.0))))


def _inner(
    fit: Fit, effect: Effect, wider: float, without_tangent: Mapping[int, tuple[float, float]]
) -> Sequence[Reported]:
    """Inner parameters with the uncertainty that their tangents give."""
    u = {
        tangent.index: float(np.sqrt(fit.covariance[place, place][0, 0])) * wider
        for tangent in fit.tangents
        if tangent.effect.name == effect.name
        for place in [fit.of_effect(tangent.name)]
    }
    out = []
    for i, (inner, value) in enumerate(inner_values(effect, fit.run.touches)):
        suffix, factor = inner_unit(inner)
        bound = _bound(inner, value)
        value, own = without_tangent.get(i, (value, u.get(i)))
        out.append(
            Reported(
                quantity=inner.name,
                unit=suffix.removeprefix("_"),
                value=value / factor,
                u=None if own is None or bound else own / factor,
                factor=factor,
                role=Role.INNER,
                bound=bound,
            )
        )
    return out


def _bound(inner: Inner, value: float) -> int:
    """Whether a value, such as a time constant or a period, lies at an end of its scan."""
    grid = np.asarray(inner.grid, dtype=float)
    if not inner.continuous or inner.acts == "at an instant" or len(grid) < 2:
        return 0
    low, high = sorted((float(grid[0]), float(grid[-1])))
    # where a scan is finer than that share, what lies within it is still an estimate
    at_low = value - low < END_SHARE * min(low, high - low)
    at_high = high - value < END_SHARE * min(high, high - low)
    return -1 if at_low else 1 if at_high else 0
