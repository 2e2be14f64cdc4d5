"""Lists of points as runs: the frame they were measured in, the machine, the rows of the run."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.importers.points.other_frame import (
    OtherFrame,
    in_measured_frame,
    in_nominal_frame,
    measured_frames,
    places,
)
from matstd.importers.points.point_list import PointList, joined_points, misplaced
from matstd.importers.points.reading import Meaning, read_points
from matstd.importers.sheets import Sheet
from matstd.twin.frames import Array
from matstd.twin.machine import Axis, Chain, inverse_linear, linear_motion, make_chain, tip
from matstd.twin.record import Instrument, Run, Setup, at_poses

MIN_TRAVEL = 20.0
"""Travel (mm) of an axis along which the points lie in one place: no machine has a shorter one."""


@dataclass(frozen=True, eq=False)
class PointsImport:
    """Run and machine of lists of points."""

    run: Run
    chain: Chain
    count: int
    # set-ups that were measured in another frame than the nominal one
    frames: tuple[OtherFrame, ...]
    # points that were found nearer to where another one belongs, with its name
    misplaced: tuple[tuple[str, str], ...]


def import_points(
    sheets: Sequence[Sheet],
    meaning: Meaning,
    u: float,
    machine: Chain | None = None,
    unit: str | None = None,
) -> PointsImport:
    """Run of one list of points, or of several as runs of their own, with its machine.

    Args:
        meaning: Machined part or calibrated standard: see `reading`.
        u: Standard uncertainty of one coordinate, mm.
        machine: None makes one whose travels are those of the points.
        unit: Unit of columns whose name has none; None: mm for coordinates, deviations are refused.

    Raises:
        DesignError: Points that fit a mirrored frame alone; also what `read_points` refuses, and a
            point that the machine does not reach.
    """
    lists = [read_points(sheet, unit) for sheet in sheets]
    points = joined_points(lists, [sheet.path.stem for sheet in sheets])
    frames = measured_frames(points)
    wrong = misplaced(in_nominal_frame(points, frames))
    far = tuple(f for f in frames if f.is_far)
    is_part = meaning == "part"
    points = (in_nominal_frame if is_part else in_measured_frame)(points, far)
    stands = () if is_part else far  # only a part's list is moved to the nominal frame
    chain = linear_machine(points, stands) if machine is None else machine
    return PointsImport(
        run=points_run(points, meaning, chain, u, stands),
        chain=chain,
        count=len(points.line),
        frames=far,
        misplaced=tuple(wrong),
    )


def linear_machine(points: PointList, frames: Sequence[OtherFrame] = ()) -> Chain:
    """A machine of the linear axes along which the points extend, for a list without a machine.

    An axis along which points hardly extend travels `MIN_TRAVEL` about their middle. Frames are
    those in which the machine measured where it is not the nominal one.
    """
    at = places(points, frames)
    low, high = at.min(axis=0), at.max(axis=0)
    moves = (high > low) | ((high == low) & np.isfinite(points.deviation).any(axis=0))
    middle, half = 0.5 * (low + high), 0.5 * np.maximum(high - low, MIN_TRAVEL)
    travels = {
        letter: Axis(range=(float(middle[i] - half[i]), float(middle[i] + half[i])))
        for i, letter in enumerate("XYZ")
        if moves[i]
    }
    return make_chain("linear machine", f"[w f {' '.join(travels)} t]", travels, (0.0, 0.0, 0.0))


def points_run(
    points: PointList, meaning: Meaning, chain: Chain, u: float, frames: Sequence[OtherFrame] = ()
) -> Run:
    """Run of a list of points: a row a measured coordinate, with the direction of that coordinate.

    Readings are those that bring the tool point of the nominal machine to the nominal place, with
    its rotary axes at zero; table frame and list share their origin, the set-up is free in a fit.

    Args:
        points: The list, its deviations those in the frames.
        meaning: `part` or `standard`; it decides the sign.
        u: Standard uncertainty of one coordinate, mm.
        frames: Where the set-ups of a standard stand that are not where the list says.

    Raises:
        OutsideTravel: A point that the machine does not reach.
    """
    rows, axis = np.nonzero(np.isfinite(points.deviation))
    q = _readings(chain, places(points, frames)[rows])
    setups = points.setup.tolist()
    labels = list(dict.fromkeys(setups))  # in the order of the lists
    stands = {label: np.eye(4) for label in labels} | {f.setup: f.T for f in frames}
    turned = np.array([stands[label][:3, :3] for label in setups])[rows]
    of = dict(zip(setups, points.run.tolist(), strict=True)) if len(points.run) else {}
    sign = -1.0 if meaning == "part" else 1.0
    touches = replace(
        at_poses(chain, q, 0.0),
        point=points.nominal[rows],
        normal=turned[np.arange(len(rows)), axis],  # directions of the standard
        setups=tuple(Setup(_key(k), stands[k], run=of.get(k, "")) for k in labels),
        setup=np.array([labels.index(label) for label in setups], dtype=np.int64)[rows],
        approach=_approach(points, chain)[rows],
        feature=points.feature[rows],
        pose=rows.astype(np.int64),
        instrument=Instrument.CMM if meaning == "part" else Instrument.TOUCH_PROBE,
    )
    deviation = sign * points.deviation[rows, axis]
    return Run(touches, deviation, np.full(len(rows), u), line=points.line[rows])


def _readings(chain: Chain, place: Array) -> Array:
    """Readings that bring the nominal tool point to places of the table frame, (N, A)."""
    q = np.zeros((len(place), len(chain.axes)))
    if len(chain.linear_axes) == 3:
        return inverse_linear(chain, place, q, 0.0)
    # fewer axes reach places in their own directions only; the rest belongs to the set-up
    return linear_motion(chain, q, place - tip(chain, q, 0.0))


def _approach(points: PointList, chain: Chain) -> Array:
    """Signs of the last motion of every axis, (N, A)."""
    out = np.zeros((len(points.line), len(chain.axes)))
    for i, letter in enumerate("XYZ"):
        if letter in chain.axes:
            out[:, chain.axis_index(letter)] = points.approach[:, i]
    return out


def _key(name: str) -> str:
    """A name that may stand as a key of the run's head."""
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name) or "a"
