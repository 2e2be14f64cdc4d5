"""The program that finds a standard: long touches from above, wherever it may stand.

Every touch comes straight down on a place that is above the standard, and beside which nothing is
high enough to meet the body of the probe first, wherever the standard stands within the stated
spread. No touch misses, and none depends on which feature it meets.
"""

import numpy as np
from scipy import ndimage

from matstd.artefact.body import Standard
from matstd.artefact.reach import Workshop
from matstd.artefact.tool import readings_at
from matstd.probe_paths.locate.find import KNOWN, KNOWN_ANGLE, Spread, lifted
from matstd.probe_paths.locate.relief import NO_SURFACE, PITCH, Relief
from matstd.probe_paths.plan import PlanOptions, Probe, TouchPlan, Visit, home_readings
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, apply
from matstd.twin.machine import Chain, inverse_linear, linear_directions
from matstd.twin.record import Setup
from matstd.twin.units import DEG

TOUCHES = 20  # touches of the search; about five minutes of machine time

_FEWEST_TOUCHES = 9
"""Fewer touches cannot distinguish a false place from the true one: six numbers are sought."""

_TRIED, _DETERMINED = 60, 0.6
"""Placements that are tried, and the share that the touches must determine by slopes alone, without
the more informative edges. For 15 mm and 4 degrees 18 of the example's 20 touches meet the flat
base, and determine 0.5; for 10 mm and 3 degrees, 1.0."""

_NOISE = 0.03  # standard uncertainty of a touch of a search, the errors of the machine included, mm
_FREE_BESIDE = 3.0  # kept free beside the ball's way and under the body besides everything else, mm

_UPRIGHT = np.cos(1.0 * DEG)
RETRACT = 5.0  # retract after a contact, mm


def plan_search(
    standard: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    spread: Spread | None = None,
    workshop: Workshop | None = None,
    retract: float = PlanOptions.retract,
) -> TouchPlan:
    """Touches from above, at the readings at which programs begin and end.

    Raises:
        NotReachable: The table is not level there, the stylus is too short for the steps of the
            standard, travel does not suffice, a clamp stands under the tool, or the touches would
            not determine the place.
    """
    spread, workshop = spread or Spread(), workshop or Workshop()
    home = home_readings(chain)
    relief = Relief.of(standard, probe.radius)
    place, high, low = _places(relief, standard, probe, spread)
    _refuse_undetermined_place(relief, place, spread)
    T = setup.T_table_artefact
    q = readings_at(chain, home[None])
    down = -linear_directions(chain, q)[0][:, chain.linear_axes.index("Z")]
    if -down @ T[:3, 2] < _UPRIGHT:
        raise NotReachable("the standard does not stand upright where programs begin and end")
    # largest rise or drop of each place within the spread
    lift = spread.distance + np.linalg.norm(place, axis=1) * np.sin(spread.angle)
    top = high + lift + probe.radius + _FREE_BESIDE
    path = float((top - low + lift).max()) + _FREE_BESIDE
    start = apply(T, np.column_stack([place, top]))
    # sideways above the highest place of all, lifted as far as the corner of the base can be
    lift = spread.distance + np.linalg.norm(standard.base.half_size) * np.sin(spread.angle)
    above = apply(T, np.append(place[0], relief.top.max() + lift + probe.radius + _FREE_BESIDE))
    q = np.repeat(q, len(place) + 1, axis=0)
    q = inverse_linear(chain, np.concatenate([start, above[None]]), q, probe.length)
    height = float(np.ceil(q[-1, chain.axis_index("Z")]))
    options = PlanOptions(
        standoff=RETRACT, search=path - RETRACT, retract=retract, workshop=workshop
    )
    plan = _plan(standard, chain, probe, setup, options, q[:-1], height)
    _refuse_out_of_travel_or_collision(plan, path)
    return plan


def _places(
    relief: Relief, standard: Standard, probe: Probe, spread: Spread
) -> tuple[Array, Array, Array]:
    """Places (N, 2) that are safe within the spread, and the surface heights under each, mm."""
    sin, base = np.sin(spread.angle), standard.base.thickness
    # where the standard leans, what is high moves sideways from what is low
    beside = _FREE_BESIDE + (float(relief.top.max()) - base) * sin
    is_bad = relief.top <= NO_SURFACE
    begins = [end for end, _ in probe.stack]
    radii = [*(radius for _, radius in probe.stack[1:]), probe.nose_radius]
    for begin, radius in zip(begins, radii, strict=True):
        step = _most(relief.top, radius + beside) - relief.ball
        is_bad |= step > begin - _FREE_BESIDE - radius * sin
    room = ndimage.distance_transform_cdt(~is_bad, metric="chessboard") * PITCH
    xy = relief.x0 + PITCH * np.moveaxis(np.indices(is_bad.shape), 0, -1)
    side = spread.distance + (np.linalg.norm(xy, axis=-1) + base + begins[0]) * sin
    ij = np.argwhere(room > side + probe.radius)
    place = relief.x0 + ij * PITCH
    if len(place) < _FEWEST_TOUCHES:
        raise NotReachable(
            f"a search from above finds no places where a stylus of {begins[0]:g} mm comes down to "
            f"something wherever the standard stands within {spread.distance:g} mm and "
            f"{spread.angle / DEG:g} degrees: a longer stylus finds more"
        )
    rows = _far_apart(place, TOUCHES)
    at = tuple(ij[rows].T)
    high = _most(relief.top, float(side[at].max()) + probe.radius)[at]
    return place[rows], high, np.full(len(rows), base)


def _refuse_undetermined_place(relief: Relief, place: Array, spread: Spread) -> None:
    """Refuse touches at places (N, 2) that leave most placements undetermined."""
    limit = np.repeat([spread.distance, spread.angle], 3)
    step = np.array([0.5, 0.5, 0.5, 0.005, 0.005, 0.005])
    drawn = np.random.default_rng(0).uniform(-limit, limit, (_TRIED, 6))
    level = np.column_stack([place, np.zeros(len(place))])
    determined = 0
    for theta, height in zip(drawn, lifted(relief, level, drawn), strict=True):
        ball = level + height[:, None] * np.array([0.0, 0.0, 1.0])
        both = lifted(relief, ball, theta + np.concatenate([np.diag(step), -np.diag(step)]))
        # a jump over an edge of the relief is not counted as more informative than a slope
        slope = np.clip(both[:6] - both[6:], -5.0, 5.0).T / (2.0 * step)
        H = slope.T @ slope / _NOISE**2 + np.diag(limit**-2)
        u = np.sqrt(np.diag(np.linalg.inv(H)))
        determined += bool(u[:3].max() < KNOWN and u[3:].max() < KNOWN_ANGLE)
    if determined < _DETERMINED * _TRIED:
        raise NotReachable(
            f"a search from above meets flat places: it would determine {determined} of {_TRIED} "
            f"places within {spread.distance:g} mm and {spread.angle / DEG:g} degrees"
        )


def _most(values: Array, half: float) -> Array:
    """Largest value within a square of the given half side, mm."""
    size = 2 * int(np.ceil(half / PITCH)) + 1
    return ndimage.maximum_filter(values, size=size, mode="nearest")


def _far_apart(place: Array, count: int) -> list[int]:
    """Rows of places (N, 2), each as far as possible from those before it."""
    rows = [int(np.argmax(np.linalg.norm(place - place.mean(axis=0), axis=1)))]
    far = np.full(len(place), np.inf)
    while len(rows) < min(count, len(place)):
        far = np.minimum(far, np.linalg.norm(place - place[rows[-1]], axis=1))
        rows.append(int(np.argmax(far)))
    return rows


def _plan(
    standard: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    options: PlanOptions,
    start: Array,
    height: float,
) -> TouchPlan:
    """The touches as a plan; their features are placeholders."""
    n, z, home = len(start), chain.axis_index("Z"), home_readings(chain)
    lows = np.array([chain.link(name).range[0] for name in chain.rotary_axes])
    # home is approached from within the travel
    side = np.where(lows < home, 1.0, -1.0)
    before = home - side * options.overshoot
    contact = start.copy()
    contact[:, z] -= options.standoff
    return TouchPlan(
        chain=chain,
        probe=probe,
        standard=standard,
        setup=setup,
        options=options,
        visits=(
            Visit(pose=0, rotary=home, side=side, before=before, rows=np.arange(n), height=height),
        ),
        visit=np.zeros(n, dtype=np.int64),
        request=np.arange(n),
        feature=np.full(n, next(iter(standard.features))),
        point=np.zeros((n, 3)),
        normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
        start=start,
        contact=contact,
        direction=np.tile([0.0, 0.0, -1.0], (n, 1)),
    )


def _refuse_out_of_travel_or_collision(plan: TouchPlan, path: float) -> None:
    """Refuse a search that exceeds the travel or brings the tool to what stands on the table."""
    z = plan.chain.axis_index("Z")
    low, high = plan.chain.travels.T
    end = plan.start.copy()
    end[:, z] -= path
    is_out = np.any((end < low - 1e-9) | (plan.start > high + 1e-9))
    if is_out or plan.visits[0].height > plan.top:
        raise NotReachable(
            f"a search from above would go from Z {plan.start[:, z].max():.0f} to "
            f"{end[:, z].min():.0f} mm, out of the travel {low[z]:.0f} to {high[z]:.0f}: a probe "
            "of another length begins elsewhere"
        )
    # the standard is spared, as the touches are to meet it
    stands = [solid.name for solid in plan.options.workshop.solids[1:]]
    ours = np.isin(plan.clearance.bodies.name, stands)
    spared = np.broadcast_to(~ours, (len(end), len(ours)))
    gap, nearest = plan.clearance.swept_gap(plan.start, end, spared=spared)
    worst = int(np.argmin(gap))
    if gap[worst] < 0.5:
        raise NotReachable(
            f"a search from above comes within {gap[worst]:.1f} mm of {nearest[worst]}"
        )
