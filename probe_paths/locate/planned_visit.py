"""Touches planned again where the standard stands: those of programs, or of a planned visit.

`matstd learn` writes a planned visit as a table of touches with their order, sides and standstills.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import DatumBall, Requests, Workshop
from matstd.probe_paths.campaign import foot_points
from matstd.probe_paths.control import ReadProgram
from matstd.probe_paths.linuxcnc import shortened
from matstd.probe_paths.plan import StatedVisits, TouchPlan, plan_touches
from matstd.twin.errors import BadFile
from matstd.twin.files import CsvTable, read_text, reading_columns
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Setup

OFF_THE_SURFACE = 0.1
"""Distance from its feature beyond which a touch is that of another standard, mm."""


@dataclass(frozen=True, eq=False)
class PlannedVisit:
    """Touches of one set-up in the order in which they are wanted."""

    requests: Requests
    order: StatedVisits  # visits of the poses, with their sides and the standstills between them


@dataclass(frozen=True)
class VisitSchedule:
    """What the operator does besides the programs."""

    warm_up: float  # how long the machine has moved before the first touch, s
    pause: float  # how long it stands still, s
    slowness: float  # time from touch to touch over that of the programs


def read_visit(
    path: str | Path, chain: Chain, standard: Standard
) -> tuple[dict[str, PlannedVisit], VisitSchedule]:
    """The touches of every set-up by its name, and the schedule.

    Raises:
        BadFile: A column or number missing, or a touch that is not on a feature of the standard.
    """
    lines = read_text(path).splitlines()
    head = [line for line in lines if line.startswith("#")]
    table = CsvTable("\n".join(lines[len(head) :]), path, len(head) + 1)
    names = reading_columns(chain)
    rotary = [names[axis] for axis in chain.rotary_axes]
    sides = [f"dir{axis}" for axis in chain.rotary_axes]
    table.require(["feature", "setup", *_PLACES, *(name for name, _ in rotary), *sides])
    if not len(table):
        raise BadFile(path, "file", "no touch", "a row for every touch of the visit")
    requests = Requests(
        np.array(table.text("feature")),
        *_on_surfaces(table, standard),
        np.stack([table.numbers(name) * unit for name, unit in rotary], axis=1),
    )
    side = np.where(np.stack([table.numbers(name) for name in sides], axis=1) < 0.0, -1.0, 1.0)
    schedule, after = _schedule(" ".join(head))
    setup, out = np.array(table.text("setup")), {}
    stretch = (np.arange(len(table)) >= after).astype(int)
    stay = np.column_stack([requests.rotary, side, stretch])
    for name in dict.fromkeys(setup.tolist()):
        rows = np.flatnonzero(setup == name)
        starts = np.any(np.diff(stay[rows], axis=0) != 0.0, axis=1)
        number = np.concatenate([[0], np.cumsum(starts)])
        out[name] = PlannedVisit(requests[rows], StatedVisits(number, side[rows], stretch[rows]))
    return out, schedule


_PLACES = tuple(f"p{c}_mm" for c in "xyz")


def _on_surfaces(table: CsvTable, standard: Standard) -> tuple[Array, Array]:
    """Points and normals of the standard at the touches; they are stated to a nanometre."""
    stated = np.stack([table.numbers(name) for name in _PLACES], axis=1)
    feature = np.array(table.text("feature"))
    for i, name in enumerate(feature.tolist()):
        if name not in standard.features:
            where = f"line {table.lines[i]}, feature"
            raise BadFile(table.path, where, name, f"one of {', '.join(standard.features)}")
    point, normal = foot_points(standard, feature, stated)
    away = np.linalg.norm(point - stated, axis=1)
    for i in np.flatnonzero(~(away < OFF_THE_SURFACE))[:1]:
        where = f"line {table.lines[i]}, {_PLACES[0]} to {_PLACES[2]}"
        place = " ".join(f"{v:g}" for v in stated[i])
        raise BadFile(table.path, where, place, f"a place on {feature[i]} of this standard")
    return point, normal


def _schedule(head: str) -> tuple[VisitSchedule, float]:
    """The schedule of the first lines, and the number of touches before the standstill."""

    def number(pattern: str, otherwise: float) -> float:
        found = re.search(pattern + r"([\d.]+)", head)
        return float(found[1]) if found else otherwise

    warm_up, pause = number("warm_up_s = ", 0.0), number("pause_s = ", 0.0)
    schedule = VisitSchedule(warm_up, pause, number("slowness = ", 1.0))
    return schedule, number("after touch ", np.inf)


MAX_DROPPED_SHARE = 0.1
"""Share of the touches that may be refused at another place, each with its reason."""


def planned_again(
    programs: Sequence[ReadProgram],
    standard: Standard,
    chain: Chain,
    setup: Setup,
    ball: DatumBall | None = None,
    visit: PlannedVisit | None = None,
) -> TouchPlan:
    """Plan of the touches that programs make, for another place of the standard.

    Poses, places on the standard, probe and workshop are those of the programs; anchor touches,
    heights, ways and order are planned again.

    Args:
        ball: On the table, by which the probe is watched; programs state it as cylinders.
        visit: Touches that are made in place of theirs, in its order.

    Raises:
        NotReachable: More touches cannot be made there than may be dropped.
    """
    old = shortened(programs, standard, chain)
    wanted = _touches_of(old, standard) if visit is None else visit.requests
    options = replace(old.options, tolerated=int(MAX_DROPPED_SHARE * len(wanted)))
    if ball is not None:
        known = Workshop(options.workshop.table, (), ball)
        stated = {solid.name for solid in known.solids}
        others = tuple(s for s in options.workshop.bodies if s.name not in stated)
        options = replace(options, workshop=replace(known, bodies=others))
    order = None if visit is None else visit.order
    return plan_touches(standard, chain, old.probe, setup, wanted, options, order)


def _touches_of(old: TouchPlan, standard: Standard) -> Requests:
    """What a plan touches besides its anchors."""
    # a ball at the beginning of a visit is an anchor, which the new plan adds itself
    first = np.concatenate([[True], np.diff(old.visit) > 0])
    balls = [sphere.name for sphere in standard.spheres]
    rows = np.flatnonzero(~(first & np.isin(old.feature, balls)))
    return Requests(
        old.feature[rows],
        old.point[rows],
        old.normal[rows],
        np.array([visit.rotary for visit in old.visits])[old.visit[rows]],
    )
