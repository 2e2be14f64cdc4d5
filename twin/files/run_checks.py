"""Checks of a run file as a whole: copied rows, clocks, units, wrong radii, outliers."""

from dataclasses import replace

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.files.pose_file import beyond_travel
from matstd.twin.files.table import CsvTable
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.numbers import rms
from matstd.twin.record import Instrument, Run, computed_deviation, without_copies
from matstd.twin.units import DAY, UM

LARGEST_DEVIATION = 10.0
"""Deviations beyond this (mm) are refused: units are mixed up, or set-up or probe are wrong."""
LARGEST_OF_INSTRUMENT = 100.0
"""The same of a distance that an instrument beside the machine measured, mm: arms that were never
calibrated are off by centimetres, and no ball has to touch."""
LARGEST_ANGLE = 0.35
"""The same for an instrument that reads angles, rad; cheap encoders are off by some degrees."""
MAX_OVERTRAVEL = 0.1
"""Readings beyond the travel by more than this share of it are faults, not a touch at the limit."""
TRIGGER_OVERTRAVEL = 1e-3
"""Share of the travel by which a trigger may lie beyond it without a remark."""
MAX_SLIP_SHARE = 0.05
"""Up to this share of rows may be faults of single rows; with more the whole file is wrong."""
NOISE_LIMIT = 5.0
"""Standard uncertainties, plus 1 µm of rounding, by which stated deviations may differ from those
of the readings without a remark."""
MAX_LISTED_LINES = 10  # lines of a file that are listed one by one
SAME_READINGS = 0.999
"""From this squared correlation, stated deviations are those of the readings in another unit."""
LARGEST_OFFSET = 0.5
"""A larger deviation (mm), equal on every side of the standard, is refused: neither set-up nor
machine causes it, but a wrong ball radius or normals that point inwards do."""
LARGEST_GAP = 1.0
"""A stated deviation farther (mm) from that of the readings belongs to another touch. Set-ups are
moved to their touches from 0.3 mm and 1 mrad on, so at most half of it remains."""
ODD_GAP_RATIO = 20.0
"""Multiple of the median gap between stated and computed deviations beyond which a row is a
fault."""
LARGEST_ARM = 5.0
"""Distance (mm) of points from the tool, across the measured direction, that is reported: 50 µrad
on that arm are 0.25 µm."""
LONGEST_PAUSE = DAY  # a shorter pause is not reported, s
MIN_GAPS, LONGEST_RUN, SLOWEST_TOUCH = 30, 30.0, 1000.0
"""Times are asked about from so many gaps on, in runs of more days, with more seconds a touch. A
touch takes seconds; a standard stays clamped for days."""
SAME_ROOM, ROOMS = 1.0, (5.0, 45.0)
"""Temperatures (K) in one room when a run begins, and those (degC) of a machine in °F."""

_OTHER_UNITS = {
    1e-3: "mm in a column of µm",
    1e3: "nm in a column of µm",
    -1.0: "of the other sign",
}


def checked_run(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without impossible rows, which are reported; raises BadFile for too many."""
    run = without_copies(replace(run, remarks=tuple(remarks)))
    remarks[:] = run.remarks
    run = _without_slips(run, table, remarks)
    run = _with_clock(run, table, remarks)
    _ask_units(run, remarks)
    _check_units(run, table)
    _check_offset(run, table)
    _compare_with_readings(run, table, remarks)
    _compare_places(run, remarks)
    if not run.deviation.any():
        remarks.append("every deviation is zero: nothing was measured")
    return run


def _without_slips(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without single rows whose reading or deviation is impossible.

    One reading far beyond the travel would be fitted without any residual, because no other row
    determines the errors out there; a deviation of centimetres holds no information on micrometres.
    """
    astray = np.zeros(len(run), dtype=bool)
    for rows, column, found, wanted in beyond_travel(
        run.touches.chain, run.touches.q, MAX_OVERTRAVEL
    ):
        _report_slip(run, table, rows, f"column {column}", found, wanted, remarks)
        astray[rows] = True
    # an instrument of angles writes them times its arm, which may be a metre
    touches = run.touches
    arm = float(np.linalg.norm(touches.point, axis=1).max(initial=0.0))
    is_ball = touches.instrument.is_ball_on_standard
    largest = LARGEST_DEVIATION if is_ball else LARGEST_OF_INSTRUMENT
    absurd = LARGEST_ANGLE * arm if touches.instrument.reads_angle else largest
    far = np.flatnonzero((np.abs(run.deviation) > absurd) & ~astray)
    if len(far):
        where = "column dev_um" if "dev_um" in table else "deviation computed from the readings"
        found = f"{run.deviation[far[0]]:.4g} mm"
        wanted = "some µm: units are mixed up, or the set-up, the probe or the machine is another"
        _report_slip(run, table, far, where, found, wanted, remarks)
        astray[far] = True
    if "dev_um" in table and states_readings(run):
        computed = computed_deviation(run.touches)
        _check_radius(run[~astray], computed[~astray], table)
        apart = np.flatnonzero((_gap(run, computed) > LARGEST_GAP) & ~astray)
        if len(apart):
            row = apart[0]
            found = (
                f"{run.deviation[row] / UM:.4g} µm where the readings say {computed[row]:.4g} mm"
            )
            wanted = "dev_um, readings, point, set-up and probe of one touch, or nominal readings"
            _report_slip(run, table, apart, "column dev_um", found, wanted, remarks)
            astray[apart] = True
        astray |= _odd_ones(run, table, astray, computed, remarks)
    run = run[~astray] if astray.any() else run
    for rows, column, found, wanted in beyond_travel(
        run.touches.chain, run.touches.q, TRIGGER_OVERTRAVEL
    ):
        where = f"line {run.line[rows[0]]}, column {column}"
        remarks.append(f"{where}: found {found}, expected {wanted}; it is used so")
    return run


def _odd_ones(run: Run, table: CsvTable, astray: Mask, computed: Array, remarks: list[str]) -> Mask:
    """Single rows whose stated deviation is not that of their readings, where all others' are."""
    gap = _gap(run, computed)
    limit = np.maximum(NOISE_LIMIT * run.u + UM, ODD_GAP_RATIO * float(np.median(gap)))
    odd: Mask = (gap > limit) & ~astray
    rows = np.flatnonzero(odd)
    if not 0 < len(rows) <= MAX_SLIP_SHARE * len(run):
        return np.zeros(len(run), dtype=bool)
    stated, said = run.deviation[rows[0]] / UM, computed[rows[0]] / UM
    found = f"{stated:.4g} µm where the readings say {said:.4g} µm"
    _report_slip(run, table, rows, "column dev_um", found, "both alike as in other rows", remarks)
    return odd


def states_readings(run: Run) -> bool:
    """Whether deviations follow from readings and points, as those of a touching ball do.

    Distances of other instruments may stand anywhere beside the machine.
    """
    touches = run.touches
    return touches.instrument.is_ball_on_standard and bool(np.all(touches.radius > 0.0))


def _check_radius(run: Run, computed: Array, table: CsvTable) -> None:
    """Refuse a radius of the ball with which readings and stated deviations contradict."""
    offset = _offset_on_all_sides(run, computed - run.deviation)
    if abs(offset) >= LARGEST_OFFSET:
        radius = float(np.median(run.touches.radius))
        expected = f"{radius + offset:.2f}, with which the readings give dev_um"
        raise BadFile(table.path, "probe.radius_mm", f"{radius:g}", expected)


def _gap(run: Run, computed: Array) -> Array:
    """How far stated deviations are from those of the readings, (N,), mm.

    Readings of an instrument beside the machine are nominal: of them the deviation is zero.
    """
    return np.minimum(np.abs(computed - run.deviation), np.abs(computed))


def _compare_with_readings(run: Run, table: CsvTable, remarks: list[str]) -> None:
    """Report stated and computed deviations that differ by more than their noise."""
    if "dev_um" not in table or not states_readings(run):
        return
    gap = float(np.median(_gap(run, computed_deviation(run.touches))))
    if gap > NOISE_LIMIT * float(np.median(run.u)) + UM:
        remarks.append(
            f"dev_um and the deviations that follow from the readings differ by {gap / UM:.3g} µm "
            "in half of the rows: dev_um is used"
        )


def _compare_places(run: Run, remarks: list[str]) -> None:
    """Report points of an instrument that are far from the tool at the same readings."""
    t = run.touches
    if t.instrument.is_ball_on_standard:  # a ball's deviations would show it
        return
    apart = t.ball_artefact - t.point
    beside = apart - np.einsum("ni,ni->n", apart, t.normal)[:, None] * t.normal
    far = float(np.median(np.linalg.norm(beside, axis=1)))
    if far > LARGEST_ARM:
        remarks.append(
            f"p is {far:.3g} mm from the position of the tool at these readings (median): the "
            "lever arms of the machine are those of the tool; length_mm and offset_mm of probe, or "
            "tx_mm ty_mm tz_mm of each row, state where on the tool was measured"
        )


def _report_slip(
    run: Run,
    table: CsvTable,
    rows: IntArray,
    where: str,
    found: str,
    wanted: str,
    remarks: list[str],
) -> None:
    """Report rows that are left out; raise BadFile where they are too many for single faults."""
    line = f"line {run.line[rows[0]]}"
    if len(rows) > MAX_SLIP_SHARE * len(run):
        more = f" and the like in {len(rows)} of {len(run)} rows" if len(rows) > 1 else ""
        raise BadFile(table.path, f"{line}, {where}", f"{found}{more}", wanted)
    others = [str(n) for n in run.line[rows[1 : MAX_LISTED_LINES + 1]]]
    also = f", and so are lines {', '.join(others)}" if others else ""
    more = (
        f" and {len(rows) - 1 - MAX_LISTED_LINES} more" if len(rows) - 1 > MAX_LISTED_LINES else ""
    )
    remarks.append(
        f"{line}, {where}: {found} cannot be, expected {wanted}; the row is left out{also}{more}"
    )


def _with_clock(run: Run, table: CsvTable, remarks: list[str]) -> Run:
    """The run without its times if its clock goes back; a clock that stands still is reported."""
    time = run.touches.time
    is_timed = run.touches.instrument is not Instrument.CMM  # parts have no clock
    if "time_s" in table and len(run) > 1 and np.ptp(time) == 0.0 and is_timed:
        remarks.append(f"time_s is {time[0]:g} in every row: no effect of time can be found")
    gaps = np.sort(np.diff(time))
    if len(gaps) > 1 and gaps[-1] > max(LONGEST_PAUSE, 10.0 * float(np.abs(gaps[:-1]).sum())):
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


def _ask_units(run: Run, remarks: list[str]) -> None:
    """Report times that look like milliseconds, and temperatures that look like degrees Fahrenheit.

    Probing a standard takes seconds a touch, by paths of different length; who reads an instrument
    every hour for weeks does so at even intervals.
    """
    time, known = run.touches.time, run.touches.temperature
    gaps = np.diff(time)
    if len(gaps) >= MIN_GAPS:
        usual, days = float(np.median(gaps)), float(np.ptp(time)) / DAY
        is_even = float(np.std(gaps)) < 0.1 * usual
        if days > LONGEST_RUN and usual > SLOWEST_TOUCH and not is_even:
            remarks.append(
                f"touches are {usual:.0f} s apart for {days:.0f} days: time_s looks like "
                "milliseconds; nothing was changed"
            )
    for name, values in known.items():
        others = [float(v[0]) for other, v in known.items() if other != name]
        others.append(float(run.touches.body_temperature[0]))
        celsius = (values - 32.0) / 1.8
        meant = float(celsius[0])
        is_alike = any(abs(meant - v) < SAME_ROOM < values[0] - v for v in others)
        if is_alike and ROOMS[0] < celsius.min() and celsius.max() < ROOMS[1]:
            remarks.append(
                f"T_{name}_degC begins with {values[0]:.4g}, which are {meant:.3g} °C if it is in "
                "°F, as the others begin with; nothing was changed"
            )


def _check_units(run: Run, table: CsvTable) -> None:
    """Refuse stated deviations that are those of the readings, but in another unit or sign.

    ``stated = k * computed`` without residual; k = 1 is correct. Distances of an instrument beside
    the machine, whose readings are nominal, fit no k.
    """
    if "dev_um" not in table:
        return
    computed = computed_deviation(run.touches)
    power, stated = float(computed @ computed), float(run.deviation @ run.deviation)
    if power == 0.0 or stated == 0.0:
        return
    product = float(computed @ run.deviation)
    if product**2 < SAME_READINGS * power * stated:
        return
    for factor, words in _OTHER_UNITS.items():
        if abs(product / power / factor - 1.0) < 0.05:
            found = f"typically {np.median(np.abs(run.deviation)) / UM:.3g}"
            expected = f"{np.median(np.abs(computed)) / UM:.3g} as the readings say: are these"
            raise BadFile(table.path, "column dev_um", found, f"{expected} {words}?")


def _offset_on_all_sides(run: Run, values: Array) -> float:
    """What values along the normals have in common on every side of the standard, mm; 0 for none.

    ``value = offset + n . shift`` with a shift of each set-up: wrong radii of the ball make the
    offset, wrong places of the standard the shifts.
    """
    touches = run.touches
    sides = [touches.normal * (touches.setup == i)[:, None] for i in range(len(touches.setups))]
    shifts, one = np.column_stack(sides), np.ones(len(run))

    def beside_shifts(values: Array) -> Array:
        """What shifts of the set-ups leave of some values."""
        return np.asarray(values - shifts @ np.linalg.lstsq(shifts, values, rcond=None)[0])

    A = np.column_stack([one, shifts])
    offset = float(np.linalg.lstsq(A, values, rcond=None)[0][0])
    # an offset differs from shifts of the set-ups only where normals point to several sides
    if rms(beside_shifts(one)) <= 0.1 or rms(beside_shifts(values - offset)) > 0.2 * abs(offset):
        return 0.0
    return offset


def _check_offset(run: Run, table: CsvTable) -> None:
    """Refuse deviations that are large and equal on every side of the standard."""
    offset = _offset_on_all_sides(run, run.deviation)
    if abs(offset) < LARGEST_OFFSET:
        return
    radius = float(np.median(run.touches.radius))
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
