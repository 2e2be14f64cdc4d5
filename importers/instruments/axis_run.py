"""Runs of tests of one axis: the measured point, and the direction of measurement."""

from dataclasses import replace

import numpy as np

from matstd.importers.instruments.positioning import PositioningTest
from matstd.twin.frames import Array, pose
from matstd.twin.machine import LETTERS, Axis, Chain, Link, make_chain, tip
from matstd.twin.record import Instrument, Run, Setup, at_poses
from matstd.twin.thermal import CYCLE, PROGRESS

ARM = 1000.0  # arm (mm) by which an angle is written as a length: 1 µrad is 1 µm
MIN_CYCLES_TO_HOLD_OUT = 4
"""Cycles needed to hold one out; with fewer it would be more than a quarter of the test."""
MIN_SINE = 0.5  # sine below which an axis and the direction it turns about count as parallel


def one_axis_machine(axis: str, target: Array) -> Chain:
    """A machine of one axis whose travel is that of the targets."""
    low, high = float(target.min()), float(target.max())
    turns = axis in "ABC"
    chain = f"[w {axis}' f t]" if turns else f"[w f {axis} t]"
    table = Axis(range=(low, high), point=(0.0, 0.0, 0.0) if turns else None)
    return make_chain(f"{axis} axis", chain, {axis: table})


def positioning_run(test: PositioningTest, chain: Chain, u: float) -> Run:
    """Run of a test of one axis on a machine that has it; raises UnknownAxis.

    Every reading is a distance along the motion of the tool relative to the workpiece, for a
    straightness along the direction of the component; its deviation is the negative of the
    instrument's. An angle is written times `ARM`, as an autocollimator reads it: neither an
    eccentric polygon nor lateral motion of the axis changes it.

    Args:
        chain: The machine; its other axes stand at zero.
        u: Standard uncertainty of one deviation, mm, or rad of an angle.
    """
    n = len(test.target)
    i = chain.axis_index(test.axis)
    q = np.zeros((n, len(chain.axes)))
    q[:, i] = test.target
    at, centre, motion = _viewpoint(test, chain, q)
    point = tip(chain, q, at)
    per_unit = ARM if test.is_angle else 1.0
    approach = np.zeros(q.shape)
    approach[:, i] = test.direction
    # errors repeat at the targets, so whole cycles are held out where there are several
    cycles = np.unique(test.cycle, return_inverse=True)[1].reshape(-1)
    targets = np.unique(np.round(test.target, 9), return_inverse=True)[1].reshape(-1)
    # a log rarely repeats a reading exactly
    by_cycles = test.is_log or cycles.max(initial=0) + 1 >= MIN_CYCLES_TO_HOLD_OUT
    touches = replace(
        at_poses(chain, q, -at[:, 2]),
        offset=at[:, :2],
        point=point - centre,
        normal=np.broadcast_to(motion, (n, 3)),
        setups=(Setup("a", pose(t=centre)),),
        time=np.zeros(n) if test.time is None else test.time,
        approach=approach,
        temperature=test.temperature,
        feature=np.array([f"cycle{c}" for c in test.cycle]),
        pose=(cycles if by_cycles else targets).astype(np.int64),
        value=_progress(test) if not test.is_log and cycles.max() > 1 else {},
        instrument=Instrument.AUTOCOLLIMATOR
        if test.is_angle
        else Instrument.ENCODER
        if test.is_log
        else Instrument.LASER,
    )
    # one line of the file may hold many readings: messages name the rows of the run
    u_of_row = np.full(n, u * per_unit)
    return Run(touches, -test.deviation * per_unit, u_of_row, repeat=test.cycle)


def _progress(test: PositioningTest) -> dict[str, Array]:
    """Progress of the test in place of times, for effects of warming.

    The cycle, and the part of the test done: a cycle runs up over all targets and down again, in
    whatever order a table lists them.
    """
    done = np.zeros(len(test.target))
    numbers = np.unique(test.cycle)
    for k, number in enumerate(numbers):
        rows = np.flatnonzero(test.cycle == number)
        way = np.where(test.direction[rows] < 0, -1, 1)
        order = np.lexsort((way * test.target[rows], -way))
        done[rows[order]] = k + (np.arange(len(rows)) + 0.5) / len(rows)
    return {CYCLE: test.cycle.astype(float), PROGRESS: done}


def _viewpoint(test: PositioningTest, chain: Chain, q: Array) -> tuple[Array, Array, Array]:
    """Target in the tool frame at every row, origin of the set-up, and direction of the reading.

    The other axes stand at zero, where all frames have the same directions.
    """
    link, n = chain.link(test.axis), len(q)
    if link.kind == "rotary":
        middle, target = _on_line(link)
        at, centre = np.tile(target, (n, 1)), middle - chain.table_origin
        return at, centre, np.cross(link.direction, tip(chain, q, at) - centre) / ARM
    if not test.is_angle:
        along = link.direction if test.is_own else link.frame[:, "XYZ".index(test.component[1])]
        return np.zeros((n, 3)), np.zeros(3), along
    about = link.frame[:, "ABC".index(test.component[1])]
    aside = np.cross(link.direction, about)
    if np.linalg.norm(aside) < MIN_SINE:  # for a roll any arm across the axis is right
        aside = np.roll(about, 1)
    aside = aside - (aside @ about) * about
    aside = aside / np.linalg.norm(aside)
    start = tip(chain, np.zeros_like(q[:1]), np.zeros((1, 3)))
    # a mirror's angle does not depend on its place: the point stays at the end of the arm
    at = start + ARM * aside - tip(chain, q, np.zeros((n, 3)))
    return at, start[0], np.cross(about, aside)


def _on_line(link: Link) -> tuple[Array, Array]:
    """A point of a rotary axis's line, and one of the tool `ARM` beside it, below the spindle.

    Machine and tool frame coincide with every axis at zero.
    """
    d, point = link.direction, link.point
    if LETTERS[link.own] == "Z":
        point = point - d * point[2] / d[2]
    down = np.eye(3)[0] if LETTERS[link.own] == "Z" else -np.eye(3)[2]
    aside = down - (down @ d) * d
    return point, point + ARM * aside / np.linalg.norm(aside)
