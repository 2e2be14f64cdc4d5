"""Runs of tests of one axis: where the instrument looked, and along which direction."""

from dataclasses import replace

import numpy as np

from matstd.importers.instruments.positioning import PositioningTest
from matstd.twin.frames import Array, pose
from matstd.twin.machine import LETTERS, Axis, Chain, Link, make_chain, tip
from matstd.twin.record import Instrument, Run, Setup, at_poses
from matstd.twin.thermal import CYCLE, PROGRESS

ARM = 1000.0
"""Arm (mm) by which an angle is written as a length: 1 µrad is 1 µm."""

ENOUGH_CYCLES = 4
"""Cycles from which one can be held out: of fewer it would be more than a quarter of the test."""

SQUARE = 0.5
"""Sine below which an axis and the direction about which it turns are called parallel."""


def one_axis_machine(axis: str, target: Array) -> Chain:
    """A machine of one axis whose travel is that of the targets."""
    low, high = float(target.min()), float(target.max())
    turns = axis in "ABC"
    chain = f"[w {axis}' f t]" if turns else f"[w f {axis} t]"
    table = Axis(range=(low, high), point=(0.0, 0.0, 0.0) if turns else None)
    return make_chain(f"{axis} axis", chain, {axis: table})


def positioning_run(test: PositioningTest, chain: Chain, u: float) -> Run:
    """Run of a test of one axis on a machine that has it; raises UnknownAxis.

    Every reading is a distance along the motion: its direction is that in which the tool moves
    relative to the workpiece while the reading grows, its deviation the negative of what the
    instrument says; of a straightness the direction is that of the component. An angle is
    written times `ARM`, as an autocollimator reads it: neither an eccentric polygon nor an axis
    that wanders aside changes it.

    Args:
        chain: The machine; its other axes stand at zero.
        u: Standard uncertainty of one deviation, mm, or rad of an angle.
    """
    n = len(test.target)
    i = chain.axis_index(test.axis)
    q = np.zeros((n, len(chain.axes)))
    q[:, i] = test.target
    at, centre, motion = _seen(test, chain, q)
    point = tip(chain, q, at)
    per_unit = ARM if test.is_angle else 1.0
    approach = np.zeros(q.shape)
    approach[:, i] = test.direction
    # what repeats at the targets is what the test is for: held out are cycles, if it has some
    cycles = np.unique(test.cycle, return_inverse=True)[1].reshape(-1)
    targets = np.unique(np.round(test.target, 9), return_inverse=True)[1].reshape(-1)
    # a log hardly ever reads the same twice
    held_out = cycles if test.is_log or cycles.max(initial=0) + 1 >= ENOUGH_CYCLES else targets
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
        pose=held_out.astype(np.int64),
        value=_progress(test) if not test.is_log and cycles.max() > 1 else {},
        instrument=Instrument.AUTOCOLLIMATOR
        if test.is_angle
        else Instrument.ENCODER
        if test.is_log
        else Instrument.LASER,
    )
    # one line of the file may hold many readings: the rows of the run are what messages name
    u_of_row = np.full(n, u * per_unit)
    return Run(touches, -test.deviation * per_unit, u_of_row, repeat=test.cycle)


def _progress(test: PositioningTest) -> dict[str, Array]:
    """What stands in the place of times: a test has none, and yet what warms up moves.

    The cycle, and how much of the test was done: a cycle goes up over all targets and down again,
    whatever the order in which a table lists them.
    """
    done = np.zeros(len(test.target))
    numbers = np.unique(test.cycle)
    for k, number in enumerate(numbers):
        rows = np.flatnonzero(test.cycle == number)
        way = np.where(test.direction[rows] < 0, -1, 1)
        order = np.lexsort((way * test.target[rows], -way))
        done[rows[order]] = k + (np.arange(len(rows)) + 0.5) / len(rows)
    return {CYCLE: test.cycle.astype(float), PROGRESS: done}


def _seen(test: PositioningTest, chain: Chain, q: Array) -> tuple[Array, Array, Array]:
    """Target in the tool frame at every row, origin of the set-up, and direction of the reading.

    The other axes stand at zero, where all frames have the same directions.
    """
    link, n = chain.link(test.axis), len(q)
    if link.kind == "rotary":
        middle, target = _on_line(link)
        at, centre = np.tile(target, (n, 1)), middle - chain.table_origin
        return at, centre, np.cross(link.direction, tip(chain, q, at) - centre) / ARM
    if not test.is_angle:
        along = link.direction if test.is_own else np.eye(3)["XYZ".index(test.component[1])]
        return np.zeros((n, 3)), np.zeros(3), along
    about = np.eye(3)["ABC".index(test.component[1])]
    aside = np.cross(link.direction, about)
    if np.linalg.norm(aside) < SQUARE:  # of a roll any arm across the axis will do
        aside = np.roll(about, 1)
    aside = aside - (aside @ about) * about
    aside = aside / np.linalg.norm(aside)
    start = tip(chain, np.zeros_like(q[:1]), np.zeros((1, 3)))
    # a mirror's angle is the same wherever it is: the point stays, at the end of the arm
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
