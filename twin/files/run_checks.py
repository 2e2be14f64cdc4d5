"""What is looked at in the rows of a run file as a whole: copies, clocks, units, slips."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from matstd.twin.errors import BadFile
from matstd.twin.files.pose_file import beyond_travel
from matstd.twin.files.table import CsvTable
from matstd.twin.frames import Array
from matstd.twin.record import Instrument, IntArray, Run, computed_deviation, without_copies
from matstd.twin.units import UM

Mask = NDArray[np.bool_]

ABSURD = 10.0
"""Deviations beyond this (mm) are no measurement: units mixed up, or a wrong set-up or probe."""

ABSURD_ANGLE = 0.35
"""The same of an instrument that reads angles, rad: cheap encoders are off by some degrees."""

ASTRAY = 0.1
"""Readings beyond the travel by more than this share of it are slips, not a touch at the limit."""

AT_LIMIT = 1e-3
"""A trigger may lie beyond the travel by so much of it without a word."""

FEW = 0.05
"""Up to this share of rows may be slips of single rows; of more something is wrong in all."""

NOISY = 5.0
"""Stated deviations may differ from those of the readings by so many standard uncertainties, and
1 µm of rounding, without a word."""

LISTED = 10
"""Lines of a file that are told one by one."""

ALIKE = 0.999
"""Squared correlation from which stated deviations are those of the readings in another unit."""

OFFSET = 0.5
"""A deviation (mm) that is alike on every side of the standard: no set-up and no machine does it,
a ball of another radius or normals that point inwards do."""

GAP = 1.0
"""A stated deviation this far (mm) from that of the readings is of another touch: set-ups are moved
to where their touches are from 0.3 mm and 1 mrad on, so that at most half of it is left."""

ODD = 20.0
"""Of the usual gap between stated deviations and those of the readings: what a slip is beyond."""

BESIDE = 5.0
"""Distance (mm) of points from the tool, across the direction that was measured, from which it is
told: 50 µrad on that arm are 0.25 µm."""

JUMP = 86400.0
"""A pause (s) shorter than a day is a night's rest and needs no word."""

_OTHER_UNITS = {
    1e-3: "mm in a column of µm",
    1e3: "nm in a column of µm",
    -1.0: "of the other sign",
}


def checked_run(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without what cannot be a measurement; whatever is left out is told.

    Raises:
        BadFile: What concerns too many rows to be a slip of single ones.
    """
    run = without_copies(replace(run, remarks=tuple(remarks)))
    remarks[:] = run.remarks
    run = _without_slips(run, table, remarks)
    run = _with_clock(run, table, remarks)
    _check_units(run, table)
    _check_offset(run, table)
    _compare_with_readings(run, table, remarks)
    _compare_places(run, remarks)
    if not run.deviation.any():
        remarks.append("every deviation is zero: nothing was measured")
    return run


def _without_slips(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without single rows whose reading or deviation is impossible.

    One reading far beyond the travel would be fitted without any residual, for nothing else tells
    how errors go on out there; a deviation of centimetres says nothing about micrometres.
    """
    astray = np.zeros(len(run), dtype=bool)
    for rows, column, found, wanted in beyond_travel(run.touches.chain, run.touches.q, ASTRAY):
        _tell_slip(run, table, rows, f"column {column}", found, wanted, remarks)
        astray[rows] = True
    touches = run.touches
    arm = float(np.linalg.norm(touches.point, axis=1).max(initial=0.0))
    absurd = ABSURD_ANGLE * arm if touches.instrument.reads_angle else ABSURD
    far = np.flatnonzero((np.abs(run.deviation) > absurd) & ~astray)
    if len(far):
        where = "column dev_um" if "dev_um" in table else "deviation computed from the readings"
        found = f"{run.deviation[far[0]]:.4g} mm"
        wanted = "some µm: units are mixed up, or the set-up, the probe or the machine is another"
        _tell_slip(run, table, far, where, found, wanted, remarks)
        astray[far] = True
    if "dev_um" in table and states_readings(run):
        computed = computed_deviation(run.touches)
        apart = np.flatnonzero((_gap(run, computed) > GAP) & ~astray)
        if len(apart):
            row = apart[0]
            found = (
                f"{run.deviation[row] / UM:.4g} µm where the readings say {computed[row]:.4g} mm"
            )
            wanted = "dev_um, readings, point, set-up and probe of one touch, or nominal readings"
            _tell_slip(run, table, apart, "column dev_um", found, wanted, remarks)
            astray[apart] = True
        astray |= _odd_ones(run, table, astray, computed, remarks)
    run = run[~astray] if astray.any() else run
    for rows, column, found, wanted in beyond_travel(run.touches.chain, run.touches.q, AT_LIMIT):
        where = f"line {run.line[rows[0]]}, column {column}"
        remarks.append(f"{where}: found {found}, expected {wanted}; it is used so")
    return run


def _odd_ones(run: Run, table: CsvTable, astray: Mask, computed: Array, remarks: list[str]) -> Mask:
    """Single rows whose stated deviation is not that of their readings, where all others' are."""
    gap = _gap(run, computed)
    limit = np.maximum(NOISY * run.u + UM, ODD * float(np.median(gap)))
    odd: Mask = (gap > limit) & ~astray
    rows = np.flatnonzero(odd)
    if not 0 < len(rows) <= FEW * len(run):
        return np.zeros(len(run), dtype=bool)
    stated, said = run.deviation[rows[0]] / UM, computed[rows[0]] / UM
    found = f"{stated:.4g} µm where the readings say {said:.4g} µm"
    _tell_slip(run, table, rows, "column dev_um", found, "both alike as in other rows", remarks)
    return odd


def states_readings(run: Run) -> bool:
    """Whether readings and points of a run are those of a touching ball, and tell its deviations.

    Distances of other instruments may stand anywhere beside the machine.
    """
    touches = run.touches
    return touches.instrument.is_ball_on_standard and bool(np.all(touches.radius > 0.0))


def _gap(run: Run, computed: Array) -> Array:
    """How far stated deviations are from those of the readings, (N,), mm.

    Readings of an instrument beside the machine are nominal: of them the deviation is zero.
    """
    return np.minimum(np.abs(computed - run.deviation), np.abs(computed))


def _compare_with_readings(run: Run, table: CsvTable, remarks: list[str]) -> None:
    """Say that stated deviations and those of the readings differ by more than their noise."""
    if "dev_um" not in table or not states_readings(run):
        return
    gap = float(np.median(_gap(run, computed_deviation(run.touches))))
    if gap > NOISY * float(np.median(run.u)) + UM:
        remarks.append(
            f"dev_um and the deviations that follow from the readings differ by {gap / UM:.3g} µm "
            "in half of the rows: dev_um is used"
        )


def _compare_places(run: Run, remarks: list[str]) -> None:
    """Say that an instrument's points are beside where the readings put the tool."""
    t = run.touches
    if t.instrument.is_ball_on_standard:  # whose deviations would tell
        return
    apart = t.ball_artefact - t.point
    beside = apart - np.einsum("ni,ni->n", apart, t.normal)[:, None] * t.normal
    far = float(np.median(np.linalg.norm(beside, axis=1)))
    if far > BESIDE:
        remarks.append(
            f"p is {far:.3g} mm from the position of the tool at these readings (median): the "
            "lever arms of the machine are those of the tool; length_mm and offset_mm of probe, or "
            "tx_mm ty_mm tz_mm of each row, state where on the tool was measured"
        )


def _tell_slip(
    run: Run,
    table: CsvTable,
    rows: IntArray,
    where: str,
    found: str,
    wanted: str,
    remarks: list[str],
) -> None:
    """Say that rows are left out, or raise BadFile where they are too many for slips."""
    line = f"line {run.line[rows[0]]}"
    if len(rows) > FEW * len(run):
        more = f" and the like in {len(rows)} of {len(run)} rows" if len(rows) > 1 else ""
        raise BadFile(table.path, f"{line}, {where}", f"{found}{more}", wanted)
    others = [str(n) for n in run.line[rows[1 : LISTED + 1]]]
    also = f", and so are lines {', '.join(others)}" if others else ""
    more = f" and {len(rows) - 1 - LISTED} more" if len(rows) - 1 > LISTED else ""
    remarks.append(
        f"{line}, {where}: {found} cannot be, expected {wanted}; the row is left out{also}{more}"
    )


def _with_clock(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without its times, if its clock goes back; one that stands still is told."""
    time = run.touches.time
    is_timed = run.touches.instrument is not Instrument.CMM  # who asks when a hole was drilled?
    if "time_s" in table and len(run) > 1 and np.ptp(time) == 0.0 and is_timed:
        remarks.append(f"time_s is {time[0]:g} in every row: no effect of time can be found")
    gaps = np.sort(np.diff(time))
    if len(gaps) > 1 and gaps[-1] > max(JUMP, 10.0 * float(np.abs(gaps[:-1]).sum())):
        i = int(np.argmax(np.diff(time)))
        remarks.append(
            f"line {run.line[i + 1]}: time_s jumps from {time[i]:g} to {time[i + 1]:g}, longer "
            "than all the rest of the run; if the clock was set, what follows time is wrong"
        )
    back = np.flatnonzero(np.diff(time) < 0.0)
    if not len(back):
        return run
    i = int(back[0])
    remarks.append(
        f"line {run.line[i + 1]}: time_s goes back from {time[i]:g} to {time[i + 1]:g}; "
        "a clock that began anew: time is left out, so that no effect of time can be found; "
        "everything else is used"
    )
    return replace(run, touches=replace(run.touches, time=np.zeros(len(run))))


def _check_units(run: Run, table: CsvTable) -> None:
    """Refuse stated deviations that are those of the readings, but in another unit or sign.

    ``stated = k * computed`` with nothing left over: k = 1 is a file that says the same twice; a
    distance of an instrument beside the machine, whose readings are nominal, fits no k.
    """
    if "dev_um" not in table:
        return
    computed = computed_deviation(run.touches)
    power, told = float(computed @ computed), float(run.deviation @ run.deviation)
    if power == 0.0 or told == 0.0:
        return
    product = float(computed @ run.deviation)
    if product**2 < ALIKE * power * told:
        return
    for factor, words in _OTHER_UNITS.items():
        if abs(product / power / factor - 1.0) < 0.05:
            found = f"typically {np.median(np.abs(run.deviation)) / UM:.3g}"
            expected = f"{np.median(np.abs(computed)) / UM:.3g} as the readings say: are these"
            raise BadFile(table.path, "column dev_um", found, f"{expected} {words}?")


def _check_offset(run: Run, table: CsvTable) -> None:
    """Refuse deviations that are large and alike on every side of the standard.

    ``dev = offset + n . shift`` with a shift of each set-up: wrong radii of the ball make the
    offset, wrong places of the standard the shifts.
    """
    touches = run.touches
    sides = [touches.normal * (touches.setup == i)[:, None] for i in range(len(touches.setups))]
    A = np.column_stack([np.ones(len(run)), *sides])
    offset = float(np.linalg.lstsq(A, run.deviation, rcond=None)[0][0])
    if abs(offset) < OFFSET or not _is_told_apart(A):
        return
    rest = run.deviation - offset
    rest = rest - A[:, 1:] @ np.linalg.lstsq(A[:, 1:], rest, rcond=None)[0]
    if np.sqrt(np.mean(rest**2)) > 0.2 * abs(offset):
        return
    radius = float(np.median(touches.radius))
    inwards = abs(offset / (2.0 * radius) + 1.0) < 0.1 if radius else False
    raise BadFile(
        table.path,
        "nx, ny, nz" if inwards else "probe.radius_mm",
        f"{'normals' if inwards else f'{radius:g}'} with which every side of the standard is "
        f"{abs(offset):.3g} mm {'inside' if offset < 0.0 else 'outside'} its position",
        "normals that point out of the standard"
        if inwards
        else "the radius of the ball, or deviations of some µm",
    )


def _is_told_apart(A: Array) -> bool:
    """Whether an offset is something else than shifts: normals point to several sides."""
    rest = A[:, 0] - A[:, 1:] @ np.linalg.lstsq(A[:, 1:], A[:, 0], rcond=None)[0]
    return bool(np.sqrt(np.mean(rest**2)) > 0.1)
