"""Serial arms under a tracker: joint readings with measured places of reflectors.

The tracker measures where the reflector is; the nominal arm at the readings predicts it. The run
has the differences along x, y and z of the tracker. The pose of the tracker, and the place of the
reflector on the arm unless stated, are determined first, without linearisation. A target whose
orientation was measured gives six readings a pose (`orientation`). Targets that stand beside the
arm are no part of it: how far they moved from their first place, which is what tracker and base
did, becomes columns of the run.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from matstd.importers.arms.dh import arm_from_dh
from matstd.importers.arms.orientation import arms, check_orientations, target_rotation
from matstd.importers.arms.placement import Placement, located
from matstd.importers.arms.table import ArmTable, coupled, read_arm
from matstd.importers.sheets import TIME, Sheet, loads, own_columns, seconds, temperatures
from matstd.twin.errors import DesignError, NotEnoughData
from matstd.twin.frames import Array, IntArray, inverse
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.numbers import rms
from matstd.twin.record import Instrument, Labels, Run, Setup, at_poses, computed_deviation
from matstd.twin.units import UM

IMPLAUSIBLE_RMS = 5.0  # deviations (mm rms) beyond those of an uncalibrated arm (about 1 mm)
EXPLAINED_SHARE = 0.2  # a mistake explains the deviations if at most this share remains


def likely_mistake(
    q: Array, chain: Chain, other: Chain | None, residual: Callable[[Chain, Array], float]
) -> tuple[str, float] | None:
    """The mistake that explains implausible deviations, and the remaining ones, mm rms, or None.

    Args:
        q: Readings, (N, J), rad.
        other: The arm with Denavit and Hartenberg's parameters read in the other convention.
        residual: Deviations of an arm at some readings, mm rms.
    """
    stated = residual(chain, q)
    if stated < IMPLAUSIBLE_RMS:
        return None
    found = [(residual(chain, readings), words) for words, readings in _mistakes(q)]
    if other is not None:
        words = "its parameters are read in the other convention (with or without --modified)"
        found.append((residual(other, q), words))
    best, words = min(found)
    return (words, best) if best < EXPLAINED_SHARE * stated else None


def _mistakes(q: Array) -> Iterator[tuple[str, Array]]:
    """Readings with one mistake undone."""
    for k in range(q.shape[1]):
        turned = q.copy()
        turned[:, k] *= -1.0
        yield f"joint {k + 1} turns the other way", turned
    for k in range(1, q.shape[1]):
        for sign in "+-":
            how = f"J{k + 1}{sign}J{k}"
            words = f"joint {k + 1} counts from the link before joint {k} (--coupled {how})"
            yield words, coupled(q, how)
    yield "joints are in radians ([rad] behind the names of their columns)", np.rad2deg(q)
    yield "joints are in degrees ([deg] behind the names of their columns)", np.deg2rad(q)


SAME_READING = 1e-4  # readings that agree within this (mm, rad) are one pose, held out as a whole


@dataclass(frozen=True, eq=False)
class ArmImport:
    """Run and machine of a table of joints and reflectors."""

    run: Run
    chain: Chain
    # columns of the readings, in the order of the programmed axes of the arm
    joints: tuple[str, ...]
    # likely mistake in readings or description, and the remaining deviations, mm rms
    mistake: tuple[str, float] | None
    # range of the place of each target beside the arm, mm
    fixed: Mapping[str, float] = field(default_factory=dict)

    @property
    def rms(self) -> float:
        """Deviations of the arm as it is described, mm."""
        return rms(self.run.deviation)

    @property
    def reflectors(self) -> dict[str, Array]:
        """Place of every reflector in the tool frame, (3,), mm."""
        t = self.run.touches
        # of a target with an orientation the points lie about its place in pairs
        return {
            name: np.unique(np.round(t.target[t.feature == name], 9), axis=0).mean(axis=0)
            for name in sorted(set(t.feature.tolist()))
        }


def import_arm(
    sheet: Sheet,
    u: float,
    machine: Chain | None = None,
    dh: Sheet | None = None,
    is_modified: bool = False,
    couplings: Sequence[str] = (),
    reflector: Sequence[float] | None = None,
    u_angle: float | None = None,
) -> ArmImport:
    """Run of an arm under a tracker, with its machine.

    Args:
        sheet: Columns of joints and of x, y, z of reflectors.
        u: Standard uncertainty of one coordinate, mm.
        machine: The arm; its axes may name the columns of joints.
        dh: Denavit and Hartenberg's parameters in place of a machine.
        is_modified: Whether these are modified ones (Craig).
        couplings: Joints whose readings count from another link, `J3+J2`.
        reflector: Its place, mm, in the tool frame, or with `dh` in that of the flange, if known.
        u_angle: Standard uncertainty of the orientation of the target about any direction, rad;
            None leaves orientations out.

    Raises:
        DesignError: Both descriptions or none; also what `tracker_run` refuses.
    """
    if (machine is None) == (dh is None):
        given = "both given" if dh else "neither given"
        raise DesignError(f"--machine, --dh: {given}; expected the arm by one of them")
    table = read_arm(sheet, machine.programmed_axes if machine else (), u_angle is not None)
    if u_angle is not None and table.turn is None:
        raise sheet.lacking("columns qw qx qy qz, or rx ry rz with a unit, for --u-urad")
    for how in couplings:
        table = replace(table, q=coupled(table.q, how))
    chain, turned, other = machine, np.eye(3), None
    if dh is not None:
        chain, turned = arm_from_dh(dh, table.q, is_modified)
        # reading the parameters in the other convention is one of the likely mistakes
        other = arm_from_dh(dh, table.q, not is_modified)[0]
    assert chain is not None
    stated = None if reflector is None else turned @ np.array(reflector)

    def residual(arm: Chain, q: Array) -> float:
        return located(replace(table, q=q), arm, u, stated).rms

    mistake = likely_mistake(table.q, chain, other, residual)
    try:
        run = tracker_run(table, chain, u, stated, u_angle)
    except DesignError as refusal:
        if mistake is None:
            raise
        words, rms = mistake
        raise DesignError(f"{refusal}; {rms:.4g} mm rms are left if {words}") from refusal
    fixed = {name: float(np.nanmax(np.ptp(at, axis=0))) for name, at in table.fixed.items()}
    return ArmImport(run=run, chain=chain, joints=table.joints, mistake=mistake, fixed=fixed)


def tracker_run(
    table: ArmTable,
    chain: Chain,
    u: float,
    reflector: Array | None = None,
    u_angle: float | None = None,
) -> Run:
    """Run of an arm under a tracker: three rows a reflector and pose, along x, y, z of the tracker.

    Six rows a pose where the orientation of the target is used. The set-up is the tracker's frame,
    `touches.target` the reflector; times, temperatures, loads, motions of fixed targets and columns
    of other units (torques, currents, tilts) of the sheet go with it.

    Args:
        table: Readings in the order of the axes of the arm.
        u: Standard uncertainty of one coordinate, mm.
        reflector: In the tool frame, (3,), mm; None finds it.
        u_angle: Uncertainty of the target's orientation about any axis, rad; None leaves it out.

    Raises:
        DesignError: Readings of other joints than the arm has, or of another arm; orientations that
            are not the arm's.
        NotEnoughData: Poses too few or too alike to say where reflector and tracker are.
    """
    sheet = table.sheet
    if table.turn is None or u_angle is None:
        found = located(table, chain, u, reflector)
        _check_placed(sheet, found, reflector is not None)
        seen = _by_places(table, found, u)
    else:
        seen = _by_poses(table, chain, u, reflector, u_angle)
    clock, force = sheet.find(TIME), loads(sheet)
    which, n = seen.row, len(seen.row)
    # a pose that was visited again must not predict itself: both visits are held out together
    near = np.round(table.q[which] / SAME_READING).astype(np.int64)
    touches = replace(
        at_poses(chain, table.q[which], -seen.target[:, 2]),
        offset=seen.target[:, :2],
        point=seen.point,
        normal=seen.normal,
        setups=(Setup("tracker", seen.T_table_tracker),),
        time=np.zeros(n) if clock is None else seconds(sheet, clock)[which],
        temperature={name: values[which] for name, values in temperatures(sheet).items()},
        force=None if force is None else force[which],
        value={name: values[which] for name, values in _values(table).items()},
        feature=seen.feature,
        pose=np.unique(near, axis=0, return_inverse=True)[1].reshape(-1),
        instrument=Instrument.TRACKER,
    )
    lines = np.array(sheet.lines)[which]
    repeat = None if table.repeat is None else table.repeat[which]
    return Run(touches, computed_deviation(touches), seen.u, repeat=repeat, line=lines)


class _Seen(NamedTuple):
    """Rows of a run as the tracker saw them."""

    row: IntArray  # of the table, (N,)
    T_table_tracker: Array
    target: Array  # in the tool frame, (N, 3), mm
    point: Array  # in the tracker's frame, (N, 3), mm
    normal: Array  # (N, 3)
    feature: Labels
    u: Array  # (N,), mm


def _by_places(table: ArmTable, found: Placement, u: float) -> _Seen:
    """Three rows for every place of a reflector."""
    which, of = (np.repeat(k, 3) for k in np.nonzero(table.shots))
    return _Seen(
        row=which,
        T_table_tracker=found.T_table_tracker,
        target=found.reflector[of],
        point=table.place[which, of],
        normal=np.tile(np.eye(3), (len(which) // 3, 1)),
        feature=np.array(table.names)[of],
        u=np.full(len(which), u),
    )


def _by_poses(
    table: ArmTable, chain: Chain, u: float, reflector: Array | None, u_angle: float
) -> _Seen:
    """Six rows for every pose of a target with its orientation."""
    assert table.turn is not None
    rows = np.flatnonzero(table.shots[:, 0] & np.isfinite(table.turn).all(axis=(1, 2)))
    tool, measured = table_to_tool(chain, table.q)[:, :3, :3], table.turn
    check_orientations(table.sheet, tool[rows], measured[rows])
    own, along = arms(u / u_angle)
    points = table.place + np.einsum("nij,kj->nki", measured, own)  # (N, 6, 3)
    if reflector is None:
        # as six reflectors each of its own: their mean is the target's place
        names = tuple(f"reflector {k}" for k in range(len(own)))
        found = located(replace(table, place=points, names=names), chain, u, None)
        found = replace(found, free=_of_one_target(found.free))
        place = found.reflector.mean(axis=0)
    else:
        found, place = located(table, chain, u, reflector), reflector
    _check_placed(table.sheet, found, reflector is not None)
    tracker = inverse(found.T_table_tracker)[:3, :3]
    turned = target_rotation(tool[rows], measured[rows], tracker)
    n, k = len(rows), len(own)
    return _Seen(
        row=np.repeat(rows, k),
        T_table_tracker=found.T_table_tracker,
        target=np.tile(place + own @ turned.T, (n, 1)),
        point=points[rows].reshape(-1, 3),
        normal=np.einsum("nij,kj->nki", measured[rows], along).reshape(-1, 3),
        feature=np.full(n * k, table.names[0]),
        u=np.full(n * k, np.sqrt(2.0) * u),
    )


def _of_one_target(free: Sequence[str]) -> tuple[str, ...]:
    """Undetermined directions of points of one target, each once."""
    return tuple(dict.fromkeys(re.sub(r"(the reflector) \d+", r"\1", words) for words in free))


def _values(table: ArmTable) -> dict[str, Array]:
    """Quantities recorded beside: columns of other units, and motions of fixed targets, µm."""
    out = own_columns(table.sheet)
    for name, at in table.fixed.items():
        whole = np.flatnonzero(np.isfinite(at).all(axis=1))
        moved = at - at[whole[0]] if len(whole) else at
        word = re.sub(r"\W+", "_", name).strip("_")
        out |= {f"{word}_{c}_um": moved[:, i] / UM for i, c in enumerate("xyz")}
    return out


def _check_placed(sheet: Sheet, found: Placement, is_stated: bool) -> None:
    """Refuse undetermined positions, and places that are not those of an arm."""
    if found.is_unexplained:
        raise DesignError(
            f"{sheet.path}: {found.rms:.4g} mm rms are left of measured places that spread by "
            f"{found.spread:.4g} mm: these readings and places are not of one arm; expected joints "
            "and places in the stated order, signs and units"
        )
    if found.free:
        other = "" if is_stated else ", or --reflector X Y Z"
        poses = "off one line" if is_stated else "that turn the tool about lines not parallel"
        raise NotEnoughData(
            f"{sheet.path}: the poses leave open {' and '.join(found.free)}; expected poses "
            f"{poses}{other}"
        )
    if not found.is_settled:
        raise DesignError(
            f"{sheet.path}: the search for the reflector has not converged ({found.rms:.4g} mm rms "
            "are left); expected --reflector X Y Z, or poses farther apart"
        )
