"""Serial arms under a tracker: joint readings with measured places of reflectors.

The tracker measures where the reflector is; the nominal arm at the readings predicts it. The run
has the differences along x, y and z of the tracker. The pose of the tracker, and the place of the
reflector on the arm unless stated, are determined first, without linearisation.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.importers.arms.dh import arm_from_dh
from matstd.importers.arms.mistakes import likely_mistake
from matstd.importers.arms.placement import Placement, located
from matstd.importers.arms.table import ArmTable, coupled, read_arm
from matstd.importers.sheets import Sheet, loads, own_columns, seconds, temperatures
from matstd.twin.errors import DesignError, NotEnoughData
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Instrument, Run, Setup, at_poses, computed_deviation

_TIME = re.compile(r"time|zeit|clock", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class ArmImport:
    """Run and machine of a table of joints and reflectors."""

    run: Run
    chain: Chain
    # columns of the readings, in the order of the programmed axes of the arm
    joints: tuple[str, ...]
    # likely mistake in readings or description, and the remaining deviations, mm rms
    mistake: tuple[str, float] | None

    @property
    def rms(self) -> float:
        """Deviations of the arm as it is described, mm."""
        return float(np.sqrt(np.mean(self.run.deviation**2)))

    @property
    def reflectors(self) -> dict[str, Array]:
        """Place of every reflector in the tool frame, (3,), mm."""
        places = dict(zip(self.run.touches.feature.tolist(), self.run.touches.target, strict=True))
        return {name: places[name] for name in sorted(places)}


def import_arm(
    sheet: Sheet,
    u: float,
    machine: Chain | None = None,
    dh: Sheet | None = None,
    is_modified: bool = False,
    couplings: Sequence[str] = (),
    reflector: Sequence[float] | None = None,
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

    Raises:
        DesignError: Both descriptions or none; also what `tracker_run` refuses.
    """
    if (machine is None) == (dh is None):
        given = "both given" if dh else "neither given"
        raise DesignError(f"--machine, --dh: {given}; expected the arm by one of them")
    table = read_arm(sheet, machine.programmed_axes if machine else ())
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
        run = tracker_run(table, chain, u, stated)
    except DesignError as refusal:
        if mistake is None:
            raise
        words, rms = mistake
        raise DesignError(f"{refusal}; {rms:.4g} mm rms are left if {words}") from refusal
    return ArmImport(run, chain, table.joints, mistake)


def tracker_run(table: ArmTable, chain: Chain, u: float, reflector: Array | None = None) -> Run:
    """Run of an arm under a tracker: three rows a reflector and pose, along x, y, z of the tracker.

    Its set-up is the tracker's frame, `touches.target` the reflector; times, temperatures, loads
    and columns of other units (torques, currents) of the sheet go with it.

    Args:
        table: Readings in the order of the axes of the arm.
        u: Standard uncertainty of one coordinate, mm.
        reflector: In the tool frame, (3,), mm; None finds it.

    Raises:
        DesignError: Readings of other joints than the arm has, or of another arm.
        NotEnoughData: Poses too few or too alike to say where reflector and tracker are.
    """
    found = located(table, chain, u, reflector)
    _check_placed(table.sheet, found, reflector is not None)
    sheet = table.sheet
    clock, force = sheet.find(_TIME), loads(sheet)
    which, of = (np.repeat(k, 3) for k in np.nonzero(table.shots))
    n = len(which)
    touches = replace(
        at_poses(chain, table.q[which], -found.reflector[of, 2]),
        offset=found.reflector[of, :2],
        point=table.place[which, of],
        normal=np.tile(np.eye(3), (n // 3, 1)),
        setups=(Setup("tracker", found.T_table_tracker),),
        time=np.zeros(n) if clock is None else seconds(sheet, clock)[which],
        temperature={name: values[which] for name, values in temperatures(sheet).items()},
        force=None if force is None else force[which],
        value={name: values[which] for name, values in own_columns(sheet).items()},
        feature=np.array(table.names)[of],
        pose=np.unique(which, return_inverse=True)[1],
        instrument=Instrument.TRACKER,
    )
    lines = np.array(sheet.lines)[which]
    return Run(touches, computed_deviation(touches), np.full(n, u), line=lines)


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
