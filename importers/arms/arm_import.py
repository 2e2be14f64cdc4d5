"""A table of joints and reflectors as the run of an arm that is described by a machine or by DH."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.importers.arms.arm_mistakes import Mistake, coupled, likely_mistake
from matstd.importers.arms.serial_arm import arm_from_dh, joint_readings, misfit, tracker_run
from matstd.importers.sheets import Sheet
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Run


@dataclass(frozen=True, eq=False)
class ArmImport:
    """What a table of joints and reflectors became.

    Attributes:
        joints: Columns of the readings, in the order of the programmed axes of the arm.
        mistake: What its readings and its description may disagree about.
    """

    run: Run
    chain: Chain
    joints: tuple[str, ...]
    mistake: Mistake | None

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
        machine: The arm, where it is known; its axes may name the columns of joints.
        dh: Denavit and Hartenberg's parameters of the arm, where no machine is given.
        is_modified: Whether these are modified ones (Craig).
        couplings: Joints whose readings count from another link, `J3+J2`.
        reflector: Its place, mm, in the tool frame, or with `dh` in the frame of the flange; found
            where it is not stated.

    Raises:
        DesignError: Both descriptions or none, readings and places of another arm.
        NotEnoughData: Poses too few or too alike.
    """
    if (machine is None) == (dh is None):
        given = "both given" if dh else "neither given"
        raise DesignError(f"--machine, --dh: {given}; expected the arm by one of them")
    q, columns = joint_readings(sheet, machine.programmed_axes if machine else ())
    for how in couplings:
        q = coupled(q, how)
    chain, turned, other = machine, np.eye(3), None
    if dh is not None:
        chain, turned = arm_from_dh(dh, q, is_modified)
        other = arm_from_dh(dh, q, not is_modified)[0]
    assert chain is not None
    stated = None if reflector is None else turned @ np.array(reflector)
    mistake = likely_mistake(
        q, chain, other, lambda arm, readings: misfit(sheet, arm, readings, u, stated, columns)
    )
    try:
        run = tracker_run(sheet, chain, q, u, stated, columns)
    except DesignError as refusal:
        if mistake is None:
            raise
        raise DesignError(
            f"{refusal}; {mistake.left:.4g} mm rms are left if {mistake.words}"
        ) from refusal
    return ArmImport(run, chain, columns, mistake)
