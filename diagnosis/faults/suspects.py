"""What users get wrong in the description of a machine or a run, as suspects to be tried.

A suspect is one mistake undone: the same readings with another machine, another sign or another
unit, or with one length of the description left free. `trial` says which of them makes the
run fit. None is ever applied silently.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import combinations

import numpy as np

from matstd.twin.effects import LocationError, ProbeRadius
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Link
from matstd.twin.model import Effect, traits
from matstd.twin.record import Run, Touches, aligned, computed_deviation
from matstd.twin.units import DEG, LENGTHS

FREE_LENGTH = 20.0
"""Standard deviation (mm) of a length that may be stated wrongly: a stylus of another length."""

FREE_ANGLE = 0.1  # the same of a zero position, rad
AS_COMPUTED = 1e-3  # deviations that follow from the readings do so within this, mm
POINT, NORMAL = ("px", "py", "pz"), ("nx", "ny", "nz")  # columns of a run, without their units
MIN_TOUCH_INTERVAL = 1.0  # least time between two touches of a probe, s


class Fault(Enum):
    """Mistakes in a description."""

    AXIS_REVERSED = "axis the other way"
    AXES_SWAPPED = "two columns exchanged"
    ROTARY_ORDER = "rotary axes in the other order"
    OTHER_SIDE = "axis on the other side of the chain"
    RADIANS = "radians in a column of degrees"
    INCHES = "inches in linear columns"
    FROM_INCHES = "converted as if from inches"
    NORMALS_INWARD = "normals into the standard"
    TOOL_LENGTH = "tool length"
    BALL_RADIUS = "ball radius"
    PIVOT = "point of a rotary axis"
    ZERO = "zero of a rotary axis"
    MINUTES = "minutes in a column of seconds"


@dataclass(frozen=True, slots=True, eq=False)
class Suspect:
    """One mistake undone."""

    fault: Fault
    axes: tuple[str, ...]
    run: Run  # as it is without the mistake, but for the free lengths
    # location errors, or the radius of the ball, left free where the mistake is a number
    free: tuple[Effect, ...] = ()


def suspects(run: Run, is_absurd: bool) -> Iterator[Suspect]:
    """Every mistake that is tried.

    Args:
        is_absurd: Whether the deviations are no errors of a machine; else only numbers are
            suspected, since an axis that runs the other way is never a matter of micrometres.
    """
    yield from _numbers(run)
    if not is_absurd or not _is_computed(run):
        return
    t = run.touches
    for axis in t.chain.programmed_axes:
        yield _with_touches(run, Fault.AXIS_REVERSED, (axis,), _reversed(t, axis))
    for kind in (t.chain.linear_axes, t.chain.rotary_axes):
        for pair in combinations(kind, 2):
            yield _with_touches(run, Fault.AXES_SWAPPED, pair, _swapped(t, *pair))
    for fault, axes, chain in _other_chains(t.chain):
        order = [t.chain.axis_index(name) for name in chain.axes]
        touches = replace(t, chain=chain, q=t.q[:, order], approach=t.approach[:, order])
        yield _with_touches(run, fault, axes, touches)
    rotary = t.chain.rotary_axes
    for axes in dict.fromkeys((rotary, *((axis,) for axis in rotary))) if rotary else ():
        q = t.q.copy()
        q[:, [t.chain.axis_index(axis) for axis in axes]] /= DEG
        yield _with_touches(run, Fault.RADIANS, axes, replace(t, q=q))
    inch = dict(LENGTHS)["inches"]
    q = t.q.copy()
    q[:, list(t.chain.linear_columns)] *= inch
    linear, points = t.chain.linear_axes, replace(t, point=inch * t.point)
    yield _with_touches(run, Fault.INCHES, linear, replace(t, q=q))
    yield _with_touches(run, Fault.INCHES, POINT, points)
    yield _with_touches(run, Fault.INCHES, (*linear, *POINT), replace(points, q=q))
    yield _with_touches(run, Fault.FROM_INCHES, POINT, replace(t, point=t.point / inch))
    yield _with_touches(run, Fault.NORMALS_INWARD, (), replace(t, normal=-t.normal))
    for i, j in combinations(range(3), 2):
        normal = t.normal.copy()
        normal[:, [i, j]] = t.normal[:, [j, i]]
        pair = NORMAL[i], NORMAL[j]
        yield _with_touches(run, Fault.AXES_SWAPPED, pair, replace(t, normal=normal))


def has_minutes_for_seconds(run: Run) -> bool:
    """Whether touches follow each other faster than a probe can make them."""
    if not run.touches.instrument.is_ball_on_standard:
        return False
    steps = np.diff(np.unique(run.touches.time))
    return bool(len(steps) > 1 and np.median(steps) < MIN_TOUCH_INTERVAL)


def corrected(suspect: Suspect, theta: Array) -> Suspect:
    """A suspect with the free numbers moved by what was found, exactly.

    Args:
        theta: Estimates of the parameters of its free effects, (K,).
    """
    run, t = suspect.run, suspect.run.touches
    for effect, value in zip(suspect.free, theta, strict=True):
        t = _moved(t, effect, float(value))
    return replace(suspect, run=recomputed(run, t))


def _numbers(run: Run) -> Iterator[Suspect]:
    """Lengths and zeros that may be stated wrongly."""
    chain = run.touches.chain
    if run.touches.radius.any():
        yield Suspect(Fault.BALL_RADIUS, (), run, (ProbeRadius(),))
    by_name = {s.name: s for s in chain.symbols}
    if not run.touches.offset.any():  # places of reflectors are found, no key states their length
        yield Suspect(Fault.TOOL_LENGTH, (), run, (LocationError(by_name["EZ0t"]),))
    for axis in chain.rotary_axes:
        own = [s for s in chain.symbols if s.link == axis and s.name[2] == "0"]
        lines = tuple(LocationError(s) for s in own if not s.is_angular)
        zero = chain.link(axis).own_component
        for free in (*((one,) for one in lines), lines):
            yield Suspect(Fault.PIVOT, (axis,), run, free)
        zeros = tuple(LocationError(s) for s in own if s.component == zero)
        yield Suspect(Fault.ZERO, (axis,), run, zeros)


def free_sd(effect: Effect) -> Array:
    """Standard deviations of a number of the description that is left free, (K,)."""
    lengths = [p.unit == "mm" for p in effect.parameters]
    return np.where(lengths, FREE_LENGTH, FREE_ANGLE)


def _moved(t: Touches, effect: Effect, value: float) -> Touches:
    """Touches with one number of the description as it was found."""
    own = traits(effect)
    if own.stated_number == "radius":
        return replace(t, radius=t.radius + value)
    symbol = own.symbol
    assert symbol is not None
    if symbol.link == "t":  # the ball stands higher than a tool of the stated length has it
        return replace(t, length=t.length - value)
    link = t.chain.link(symbol.link)
    if symbol.is_angular:
        q = t.q.copy()
        q[:, t.chain.axis_index(symbol.link)] += value
        return replace(t, q=q)
    point = link.point + value * np.eye(3)[symbol.component]
    return replace(t, chain=_with_link(t.chain, replace(link, point=point)))


def _with_link(chain: Chain, changed: Link) -> Chain:
    links = tuple(changed if link.name == changed.name else link for link in chain.links)
    return replace(chain, links=links)


def _is_computed(run: Run) -> bool:
    """Whether the deviations are those of the readings, rather than of another instrument.

    Where readings are nominal theirs are zero, which small deviations do not differ from by much.
    """
    difference = np.median(np.abs(run.deviation - computed_deviation(run.touches)))
    return bool(difference < min(AS_COMPUTED, 0.5 * np.median(np.abs(run.deviation))))


def recomputed(run: Run, touches: Touches) -> Run:
    """The run with its deviations as another description has them, its set-ups placed anew.

    Where the standard stands was perhaps found with the wrong description.
    """
    touches = replace(touches, commanded=None)
    if _is_computed(run):
        return with_setups_placed(
            replace(run, touches=touches, deviation=computed_deviation(touches))
        )
    before, after = computed_deviation(run.touches), computed_deviation(touches)
    return replace(run, touches=touches, deviation=run.deviation + after - before)


def with_setups_placed(run: Run) -> Run:
    """The run with its set-ups where its touches indicate, if its readings determine that."""
    return aligned(run)[0] if _is_computed(run) else run


def _with_touches(run: Run, fault: Fault, axes: Sequence[str], touches: Touches) -> Suspect:
    return Suspect(fault, tuple(axes), recomputed(run, touches))


def _reversed(t: Touches, axis: str) -> Touches:
    i = t.chain.axis_index(axis)
    q, approach = t.q.copy(), t.approach.copy()
    q[:, i], approach[:, i] = -q[:, i], -approach[:, i]
    return replace(t, q=q, approach=approach)


def _swapped(t: Touches, first: str, second: str) -> Touches:
    i, j = t.chain.axis_index(first), t.chain.axis_index(second)
    order = np.arange(t.q.shape[1])
    order[[i, j]] = j, i
    return replace(t, q=t.q[:, order], approach=t.approach[:, order])


def _other_chains(chain: Chain) -> Iterator[tuple[Fault, tuple[str, ...], Chain]]:
    """The machine with its rotary axes exchanged, or with one axis on the other side."""
    links = chain.links
    for first, second in combinations(chain.rotary_axes, 2):
        i, j = chain.link_index(first), chain.link_index(second)
        order = list(links)
        order[i] = replace(links[j], carries_workpiece=links[i].carries_workpiece)
        order[j] = replace(links[i], carries_workpiece=links[j].carries_workpiece)
        yield Fault.ROTARY_ORDER, (first, second), _chain_of(chain, order)
    for axis in chain.programmed_axes:
        i = chain.link_index(axis)
        moved = replace(links[i], carries_workpiece=not links[i].carries_workpiece)
        rest = [link for link in links if link.name != axis]
        border = sum(link.carries_workpiece for link in rest)
        places = range(1, border + 1) if moved.carries_workpiece else range(border, len(rest))
        for place in places:
            yield Fault.OTHER_SIDE, (axis,), _chain_of(chain, [*rest[:place], moved, *rest[place:]])


def _chain_of(chain: Chain, links: Sequence[Link]) -> Chain:
    """A machine of the same links in another order, with its notation."""
    words = ["f" if link is None else _token(link) for link in _with_foundation(links)]
    return replace(chain, links=tuple(links), notation=f"[{' '.join(words)}]")


def _with_foundation(links: Sequence[Link]) -> list[Link | None]:
    border = sum(link.carries_workpiece for link in links)
    return [*links[:border], None, *links[border:]]


def _token(link: Link) -> str:
    if link.kind == "fixed":
        return link.name
    name = f"{link.name}'" if link.carries_workpiece else link.name
    return name if link.programmed else f"({name})"
