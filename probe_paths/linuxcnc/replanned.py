"""Programs planned again with some of their touches, from nothing but their text."""

from collections.abc import Sequence

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign import foot_points
from matstd.probe_paths.control import Move, ProbeStep, ReadProgram
from matstd.probe_paths.plan import LINEAR, PlanOptions, TouchPlan, Visit
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, apply, inverse
from matstd.twin.machine import Chain, tip


def shortened(
    programs: Sequence[ReadProgram], standard: Standard, chain: Chain, count: int | None = None
) -> TouchPlan:
    """The plan that programs of one set-up carry out, or every so many-th touch of it.

    Args:
        count: How many touches are kept, spread evenly over all; None for all.

    Raises:
        DesignError: No touch, or none is to be kept.
    """
    all_touches = [touch for program in programs for touch in program.touches]
    if count is not None and count < 1:
        raise DesignError(f"{count} touches: expected at least 1")
    many = len(all_touches) if count is None else min(count, len(all_touches))
    kept = set(np.round(np.linspace(0, len(all_touches) - 1, many)).astype(int).tolist())
    stops = [stop for program in programs for stop in _stops(program, chain)]
    touches: list[ProbeStep] = []
    visits: list[Visit] = []
    visit: list[int] = []
    row = 0
    for stop, made in stops:
        mine = [t for i, t in enumerate(made, start=row) if i in kept]
        row += len(made)
        if mine:
            visit += [len(visits)] * len(mine)
            visits.append(stop)
            touches += mine
    names = {n: name for program in programs for n, name in program.features.items()}
    return _plan(programs[0], standard, chain, touches, visits, np.array(visit), names)


def _plan(
    program: ReadProgram,
    standard: Standard,
    chain: Chain,
    touches: Sequence[ProbeStep],
    visits: Sequence[Visit],
    visit: IntArray,
    names: dict[int, str],
) -> TouchPlan:
    heading, first = program.heading, touches[0]
    assert heading.workshop is not None, "no program is read without it"
    start = np.array([t.q for t in touches])
    way = np.array([t.direction for t in touches])
    contact = start + first.back * way
    feature = np.array([names[t.feature] for t in touches])
    ball = tip(chain, contact, heading.probe.length)
    ball = apply(inverse(heading.setup.T_table_artefact), ball)
    point, normal = foot_points(standard, feature, ball)
    # programs retract to their highest Z
    z = chain.axis_index("Z")
    retracted = np.nanmax([step.q[z] for step in program.steps if isinstance(step, Move)])
    options = PlanOptions(
        standoff=first.back,
        search=first.distance - first.back,
        retract=chain.link("Z").range[1] - float(retracted),
        workshop=heading.workshop,
    )
    return TouchPlan(
        chain=chain,
        probe=heading.probe,
        standard=standard,
        setup=heading.setup,
        options=options,
        visits=tuple(visits),
        visit=visit,
        request=np.arange(len(touches)),
        feature=feature,
        point=point,
        normal=normal,
        start=start,
        contact=contact,
        direction=way[:, [chain.axis_index(a) for a in LINEAR]],
    )


def _stops(program: ReadProgram, chain: Chain) -> list[tuple[Visit, list[ProbeStep]]]:
    """Visits of a program in order, each with its touches."""
    rotary, z = chain.rotary_columns, chain.axis_index("Z")
    found: list[tuple[Visit, list[ProbeStep]]] = []
    here: Array | None = None
    before, is_new = np.zeros(len(rotary)), True
    height: float | None = None
    for step in program.steps:
        if isinstance(step, Move):
            if here is not None and np.any(step.q[rotary] != here[rotary]):
                before, is_new, height = here[rotary], True, None
            elif height is None and here is not None and step.q[z] < here[z]:
                height = float(step.q[z])  # the first move down goes to the clearance height
            here = step.q
        elif isinstance(step, ProbeStep):
            if is_new:
                assert height is not None, "no touch without a move down"
                q = step.q[rotary]
                stop = Visit(
                    pose=step.pose - 1,
                    rotary=q,
                    side=step.side[rotary],
                    before=before,
                    rows=np.zeros(0, dtype=np.int64),
                    height=height,
                )
                found.append((stop, []))
                is_new = False
            found[-1][1].append(step)
            here = step.q
    return found
