"""Quantities of a machine's geometry as linear functions of the parameters of a model.

- lines along every linear axis through the middle of what was probed, all rotary axes at zero, give
  the scale (slope along the axis) and the straightness (across it, about the straight line of
  least squares);
- squareness, two by two, is that of the straight lines of two axes (ISO 230-1) by least squares
  over the probed readings, each with the others in the middle of theirs: a curved line has another
  slope in every part of it, and what one axis does is no slope of another that goes with it, as Z
  goes with Y below a head that tilts;
- the angular errors of a linear axis and all errors of a rotary one are curves of its reading, of
  which the peak-to-valley over the probed readings is reported;
- the line of a rotary axis is where the tool sees it, place and tilt, while the axis turns;
- of joints instead the lengths and twists of links and the zeros of joints (`arm_links`).

None of them depends on where the standard stands, nor on how parameters share what they have in
common.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import combinations

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.arm_links import arm_functionals
from matstd.diagnosis.geometry.quantities import (
    Functional,
    Quantity,
    effects_of_readings,
    geometric_effects,
    peak_to_valley,
)
from matstd.information.identifiability import column_lengths
from matstd.twin.frames import Array
from matstd.twin.machine import LETTERS, Chain, Family, Link, tip
from matstd.twin.model import Model, traits
from matstd.twin.record import Touches, at_poses
from matstd.twin.sampling import spread_rows

TRAVEL_POINTS = 21
"""Poses of a line along an axis: a sine over the travel has ten of them in every half wave."""

MAX_READINGS = 400
"""Probed readings over which a line is fitted: more do not move a slope by a per cent."""

ALONG = 0.9
"""Cosine from which a linear axis goes along the line of a rotary one: an axis at 45° to it goes
across, too."""

MIN_SEEN_SHARE = 1e-3
"""Share of what a location error does that the others must not do, if it is seen beside them."""


def functionals(fit: Fit, theta: Array) -> Iterator[Functional]:
    """All quantities that can be reported, axis by axis.

    Args:
        fit: Fit of a model with component and location errors; others are no geometry.
        theta: Parameters (P,) at which the peaks and valleys are looked for between which curves of
            several states are compared.
    """
    chain = fit.model.chain
    lines = _lines(fit)
    for line in lines.values():
        yield from line.functionals(theta)
    yield from _squarenesses(lines)
    probed = [axis for axis in chain.rotary_axes if _is_probed(fit, axis)]
    yield from arm_functionals(fit, probed)
    for axis in probed:
        yield from _rotary(fit, theta, axis)


def squarenesses(fit: Fit) -> Iterator[Functional]:
    """The squareness of every two linear axes."""
    return _squarenesses(_lines(fit))


def _lines(fit: Fit) -> "dict[str, _Line]":
    chain = fit.model.chain
    return {axis: _Line(fit, axis) for axis in chain.linear_axes if _is_probed(fit, axis)}


def _squarenesses(lines: "Mapping[str, _Line]") -> Iterator[Functional]:
    for first, second in combinations(sorted(lines), 2):
        yield from _squareness(lines[first], lines[second])


def _is_probed(fit: Fit, axis: str) -> bool:
    return bool(np.ptp(fit.run.touches.reading(axis)[fit.used]) > 0.0)


def _probed(fit: Fit, axis: str) -> tuple[float, float]:
    """Least and largest reading that was probed, of several runs that every one of them probed.

    Beyond what a run probed its geometry is anybody's guess, and so is what changed there.
    """
    t = fit.run.touches[fit.used]
    own = [t.reading(axis)[t.run == i] for i in np.unique(t.run)]
    low, high = max(float(q.min()) for q in own), min(float(q.max()) for q in own)
    if high <= low:  # runs that have nothing in common
        low, high = float(t.reading(axis).min()), float(t.reading(axis).max())
    return low, high


def _along_axis(fit: Fit, axis: str) -> Touches:
    """Poses along an axis over the probed readings: linear axes in the middle, rotary at zero.

    Of an axis that was read at few targets these are the targets: what a curve through five of them
    does in between is in no reading, and no scale of theirs.
    """
    t = fit.run.touches[fit.used]
    chain = t.chain
    low, high = _probed(fit, axis)
    targets = np.unique(np.round(t.reading(axis), 3))
    targets = targets[(targets > low - 1e-3) & (targets < high + 1e-3)]
    along = targets if 2 < len(targets) < TRAVEL_POINTS else np.linspace(low, high, TRAVEL_POINTS)
    q = np.zeros((len(along), len(chain.axes)))
    for name in chain.linear_axes:
        q[:, chain.axis_index(name)] = np.mean(_probed(fit, name))
    q[:, chain.axis_index(axis)] = along
    return at_poses(chain, q, float(np.mean(t.length)))


def _curves(fit: Fit, poses: Touches, link: Link) -> dict[int, Array]:
    """Error curves of one axis per unit of every parameter, by component, each (N, P)."""
    index = poses.chain.link_index(link.name)
    size = (len(poses), len(fit.model.parameters))
    out: dict[int, Array] = {}
    for start, effect in effects_of_readings(fit):
        for term in effect.terms(poses):
            if term.where.part == "twist" and term.where.link == index:
                curve = out.setdefault(term.where.component, np.zeros(size))
                curve[:, start + term.parameter] += term.amount
    return out


def _displacements(fit: Fit, poses: Touches) -> Array:
    """Displacement of the tool relative to the table per unit of every parameter, (N, 3, P)."""
    out = np.zeros((len(poses), 3, len(fit.model.parameters)))
    known = list(effects_of_readings(fit))
    places = [start + k for start, effect in known for k in range(len(effect.parameters))]
    model = Model(poses.chain, tuple(effect for _, effect in known))
    out[:, :, places] = model.relative_columns(poses)
    return out


class _Line:
    """Displacements along a line parallel to one linear axis, per unit of every parameter."""

    def __init__(self, fit: Fit, axis: str) -> None:
        self.fit, self.axis = fit, axis
        self.poses = _along_axis(fit, axis)
        chain = self.poses.chain
        self.link = chain.link(axis)
        place = tip(chain, self.poses.q, self.poses.length)
        self.direction = (place[-1] - place[0]) / np.linalg.norm(place[-1] - place[0])
        self.D = _displacements(fit, self.poses)  # (N, 3, P)
        q = self.poses.reading(axis)
        self.q = q - q.mean()
        self.travel = float(self.link.range[1] - self.link.range[0])

    def slope(self, direction: Array) -> Array:
        """Least-squares slope of the displacement in a direction, (P,), mm per mm."""
        return np.asarray(self.q @ np.einsum("nip,i->np", self.D, direction) / (self.q @ self.q))

    @cached_property
    def reference(self) -> Array:
        """Slope of the reference straight line over the probed readings, (3, P), mm per mm."""
        t, chain = self.fit.run.touches[self.fit.used], self.poses.chain
        own = [chain.axis_index(axis) for axis in chain.linear_axes]
        q = np.zeros((min(len(t), MAX_READINGS), len(chain.axes)))
        q[:, own] = t.q[:, own].mean(axis=0)
        q[:, chain.axis_index(self.axis)] = t.reading(self.axis)[spread_rows(len(t), len(q))]
        along = q[:, chain.axis_index(self.axis)] - q[:, chain.axis_index(self.axis)].mean()
        D = _displacements(self.fit, at_poses(chain, q, float(np.mean(t.length))))
        return np.asarray(np.tensordot(along, D, axes=1) / (along @ along))

    def functionals(self, theta: Array) -> Iterator[Functional]:
        """Scale, straightness, angular errors."""
        letter = LETTERS[self.link.own]
        yield Functional(
            quantity=Quantity.SCALE,
            symbol=f"E{letter}{self.axis}",
            axes=(self.axis,),
            unit="1",
            weights=self.slope(self.direction),
            lever=self.travel,
        )
        for i in (k for k in range(3) if k != self.link.own):
            across = np.eye(3)[i] - self.direction[i] * self.direction
            curve = np.einsum("nip,i->np", self.D, across)
            # a slope of the line is squareness, not straightness
            curve = curve - curve.mean(axis=0) - self.q[:, None] * self.slope(across)
            yield Functional(
                quantity=Quantity.STRAIGHTNESS,
                symbol=f"E{LETTERS[i]}{self.axis}",
                axes=(self.axis,),
                unit="mm",
                weights=peak_to_valley(curve, theta),
                lever=1.0,
                curve=curve,
            )
        lever = _longest_other(self.poses.chain, self.axis)
        for component, curve in sorted(_curves(self.fit, self.poses, self.link).items()):
            if component >= 3:
                yield Functional(
                    quantity=Quantity.ANGULAR,
                    symbol=f"E{LETTERS[component]}{self.axis}",
                    axes=(self.axis,),
                    unit="rad",
                    weights=peak_to_valley(curve, theta),
                    lever=lever,
                    curve=curve,
                )


def _longest_other(chain: Chain, axis: str) -> float:
    """Longest travel of the other linear axes, mm: the arm that an angular error may have."""
    others = [chain.link(a).range for a in chain.linear_axes if a != axis]
    return max((float(high - low) for low, high in others), default=0.0)


def _squareness(first: _Line, second: _Line) -> Iterator[Functional]:
    """Deviation of two axes from a right angle, as the rotation of the second about the third.

    ``EC0Y = -(slope of X over y) - (slope of Y over x)``, and so on by cyclic exchange.
    """
    about = np.cross(first.direction, second.direction)
    third = int(np.argmax(np.abs(about)))
    if abs(first.direction @ second.direction) > 0.5:  # parallel axes have no squareness
        return
    sign = float(np.cross(np.eye(3)[third], second.direction) @ first.direction)
    weights = first.direction @ second.reference + second.direction @ first.reference
    yield Functional(
        quantity=Quantity.SQUARENESS,
        symbol=f"E{LETTERS[3 + third]}0{second.axis}",
        axes=(first.axis, second.axis),
        unit="rad",
        weights=np.sign(sign) * weights,
        lever=second.travel,
    )


def _rotary(fit: Fit, theta: Array, axis: str) -> Iterator[Functional]:
    """Line, zero and error motions of a rotary axis."""
    t = fit.run.touches[fit.used]
    link = t.chain.link(axis)
    places = t.point_table
    if not link.carries_workpiece:  # a head turns the tool, however large the standard is
        head = [t.chain.axis_index(name) for name in t.chain.tool_rotary_axes]
        q = np.zeros_like(t.q)
        q[:, head] = t.q[:, head]
        places = tip(t.chain, q, t.length)
    reach = float(np.linalg.norm(np.ptp(places, axis=0)))
    if t.instrument.reads_angle:
        reach = float(np.median(np.linalg.norm(t.point, axis=1)))
    unit = {False: "mm", True: "rad"}
    # the line of a joint is known to its neighbours alone, and no angle shows where a line is
    is_unseen = link.is_joint or t.instrument.reads_angle
    for component, weights in () if is_unseen else sorted(_line_of(fit, axis).items()):
        yield Functional(
            quantity=Quantity.ROTARY_LINE,
            symbol=f"E{LETTERS[component]}0{axis}",
            axes=(axis,),
            unit=unit[component >= 3],
            weights=weights,
            lever=reach if component >= 3 else 1.0,
        )
    if not is_unseen:
        yield from _zero(fit, link, reach)
    for component, curve in sorted(_curves(fit, _along_axis(fit, axis), link).items()):
        if not np.any(np.round(curve @ theta, 12)):  # nothing that was measured feels it
            continue
        is_angle = component >= 3
        weights = peak_to_valley(curve, theta)
        yield Functional(
            quantity=Quantity.ROTARY_MOTION,
            symbol=f"E{LETTERS[component]}{axis}",
            axes=(axis,),
            unit=unit[is_angle],
            weights=weights,
            lever=reach if is_angle else 1.0,
            curve=curve,
        )


def _zero(fit: Fit, link: Link, reach: float) -> Iterator[Functional]:
    """Zero of a rotary axis; where a turned standard or a tilted neighbour does the same, open."""
    for start, effect in geometric_effects(fit):
        symbol = traits(effect).ordinary_constant
        if symbol and symbol.link == link.name and symbol.component == link.own_component:
            weights = np.zeros(len(fit.model.parameters))
            weights[start] = 1.0
            yield Functional(
                quantity=Quantity.ROTARY_ZERO,
                symbol=symbol.name,
                axes=(link.name,),
                unit="rad",
                weights=weights,
                lever=reach,
            )


def _line_of(fit: Fit, axis: str) -> dict[int, Array]:
    """Weights (P,) of the line of a rotary axis, by component of its location error.

    While the axis turns, with the others at rest, everything that the model holds displaces the
    tool relative to the table. Of that, what the location errors of the axis would do by least
    squares beside a rigid motion of the standard is where its line appears to be, as seen from the
    tool: `EX0C` and an opposite `EX0t` are the same there. With the tool at both ends of what was
    probed along the linear axes across the line, to which ISO 230-1 refers its squareness: from one
    place a turned standard looks like a displaced line.

    No linear axis moves the tool within a head. At one place beside the line of a head, a tilt is a
    displacement; where the head swings the tool away, it is not. Each swing displaces the tool by
    errors of its own, so that the displacement is that without a swing. A tilt that no swing shows
    is that of the model, and the displacement is that at the tool.
    """
    t = fit.run.touches[fit.used]
    chain = t.chain
    link = chain.link(axis)
    places = {f"location({s.name})": s for s in chain.symbols if s.family is Family.LOCATION}
    own = {
        places[effect.name].component: start
        for start, effect in geometric_effects(fit)
        if effect.name in places and places[effect.name].link == axis
    }
    own.pop(link.own_component, None)  # its zero is a rotation of the standard, or of the tool
    across = [a for a in chain.linear_axes if abs(chain.link(a).direction @ link.direction) < ALONG]
    left, size = [], np.zeros(len(fit.model.parameters))
    for i, sweep in enumerate(_swings(fit, axis)):
        ends_of_tool = []
        for linear in across or chain.linear_axes:
            for end in _probed(fit, linear):
                q = sweep.copy()
                q[:, chain.axis_index(linear)] = end
                ends_of_tool.append(q)
        poses = at_poses(chain, np.concatenate(ends_of_tool or [sweep]), float(np.mean(t.length)))
        D = _displacements(fit, poses).reshape(3 * len(poses), -1)
        rigid = [np.tile(np.eye(3), (len(poses), 1, 1)), _crossed(poses.point_table)]
        free = np.concatenate(rigid, axis=2).reshape(len(D), -1)
        if i > 0:
            free = np.column_stack([free, *(D[:, own[k]] for k in own if k < 3)])
        left.append(_beside(free, D))
        size = np.maximum(size, np.linalg.norm(D, axis=0))
    D = np.concatenate(left)
    seen: list[int] = []
    for component in sorted(own):
        column = D[:, own[component]]
        rest = _beside(D[:, [own[k] for k in seen]], column)
        if np.linalg.norm(rest) > MIN_SEEN_SHARE * size[own[component]]:
            seen.append(component)
    basis = D[:, [own[k] for k in seen]]
    scale = np.linalg.norm(basis, axis=0)
    found = np.linalg.lstsq(basis / scale, D, rcond=None)[0] / scale[:, None]
    out = {component: np.eye(1, D.shape[1], start)[0] for component, start in own.items()}
    return out | dict(zip(seen, found, strict=True))


def _swings(fit: Fit, axis: str) -> Iterator[Array]:
    """Readings (N, A) while an axis turns: others at rest, then each that swings its tool aside."""
    chain = fit.run.touches.chain
    rest = _along_axis(fit, axis).q
    yield rest
    head = chain.tool_rotary_axes
    for other in head[head.index(axis) + 1 :] if axis in head else ():
        q = rest.copy()
        q[:, chain.axis_index(other)] = max(_probed(fit, other), key=abs)
        yield q


def _beside(columns: Array, values: Array) -> Array:
    """What least squares by columns (M, K) leave of values (M, ...)."""
    unit = columns / column_lengths(columns)
    return np.asarray(values - unit @ np.linalg.lstsq(unit, values, rcond=1e-9)[0])


def _crossed(points: Array) -> Array:
    """Displacement of points (N, 3) per unit rotation about each direction, (N, 3, 3)."""
    return np.stack([np.cross(axis, points) for axis in np.eye(3)], axis=2)
