"""Columns of a run file as arrays in base units; faults are corrected and reported, or refused."""

import re
import unicodedata
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.files.pose_file import FARTHEST
from matstd.twin.files.table import KELVIN, CsvTable
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.machine import Chain
from matstd.twin.record import BODY, Labels, Moved, Touches, implied_approach
from matstd.twin.units import DEG, UM

SENSOR = re.compile(r"T_(\w+)_degC\Z")
OWN = re.compile(r"V_(\w+_\w+)\Z")  # a column of the user's own: name and unit
POINT = ("px_mm", "py_mm", "pz_mm")
NORMAL = ("nx", "ny", "nz")
TARGET = ("tx_mm", "ty_mm", "tz_mm")
RADIUS = "radius_mm"
PROGRAM = ("program", "touch", "program_line")
FORCE = ("Fx_N", "Fy_N", "Fz_N")
MAX_GAP_SHARE = 0.5  # a sensor with gaps in a larger share of its rows is left out
MIN_SHUFFLED_SHARE = 0.25
"""Rows are shuffled if time goes back before at least this share of them (one half if fully
random)."""
MAX_RESTARTS = 3  # restarts of a clock; rows sorted by features or poses go back more often
LATEST = 1e11  # times (s) beyond this, three thousand years, are in another unit
MAX_STANDSTILL_SHARE = 0.05
"""Largest share of rows with direction 0 that counts as a momentary standstill, as at a quadrant of
a circle; with more, the direction is unknown."""
FINEST, COARSEST = 1e-6, 1e4
"""Standard uncertainties of a touch (µm) lie between: a picometre, and the largest deviation that
is a measurement."""
MAX_LENGTH_ERROR = 0.01  # a normal whose length is off by more is refused
ROUNDING_ERROR = 1e-5  # a normal whose length is off by less is rounded; this is not reported


def points(table: CsvTable) -> Array:
    """Contact points, (N, 3), mm."""
    return np.stack([table.numbers(c, largest=FARTHEST) for c in POINT], axis=-1)


def targets(table: CsvTable, common: Sequence[float]) -> Array:
    """Ball centre or reflector of every row in the tool frame, (N, 3), mm.

    A column or cell that is not there means the place `common` in the head of the file.
    """
    cells = [
        table.numbers(c, empty=v, largest=FARTHEST) if c in table else np.full(len(table), v)
        for c, v in zip(TARGET, common, strict=True)
    ]
    return np.stack(cells, axis=-1) + 0.0  # no negative zeros


def radii(table: CsvTable, common: float) -> Array:
    """Radius of the ball of every row, (N,), mm: its own, for several styli, or the head's."""
    if RADIUS not in table:
        return np.full(len(table), common)
    found = table.numbers(RADIUS, empty=common, largest=FARTHEST)
    below = np.flatnonzero(found < 0.0)
    if len(below):
        raise table.bad(int(below[0]), RADIUS, f"{found[below[0]]:g}", "a radius, or 0 for no ball")
    return found


def normals(table: CsvTable, remarks: list[str]) -> Array:
    """Unit normals; lengths off by rounding are corrected and reported, others refused."""
    normal = np.stack([table.numbers(c) for c in NORMAL], axis=-1)
    length = np.linalg.norm(normal, axis=-1)
    off = np.abs(length - 1.0)
    worst = int(np.argmax(off))
    if off[worst] > MAX_LENGTH_ERROR:
        raise table.bad(worst, "nx, ny, nz", f"a normal of length {length[worst]:.4g}", "length 1")
    if off[worst] > ROUNDING_ERROR:
        remarks.append(
            f"line {table.lines[worst]}: normal of length {length[worst]:.6f}; "
            "all normals were brought to length 1"
        )
    return np.asarray(normal / length[:, None])


def times(table: CsvTable) -> Array:
    """Time of every row, (N,), s; zero where none is recorded."""
    return table.numbers("time_s", largest=LATEST) if "time_s" in table else np.zeros(len(table))


def put_in_order(table: CsvTable, remarks: list[str]) -> None:
    """Sort the rows by time where they are in another order, and report it.

    A clock that restarted also goes back. Its times cannot be compared with the earlier ones, so
    the rows keep their order.
    """
    at = times(table)
    back = np.flatnonzero(np.diff(at) < 0.0)
    order = np.argsort(at, kind="stable")
    if len(back) and _is_one_clock(at, back, order):
        i = int(back[0])
        remarks.append(
            f"line {table.lines[i + 1]}: time_s goes back from {at[i]:g} to {at[i + 1]:g}: rows "
            "stand in another order than that of their times, in which they are taken"
        )
        table.reorder(order)


def _is_one_clock(at: Array, back: IntArray, order: IntArray) -> bool:
    """Whether times that go back are of one clock: rows shuffled, in stretches one after the other,
    or sorted by something else.

    Sorted rows of one machine have some time between them; where clocks began anew rows fall
    anywhere between one another.
    """  # noqa: D205
    if len(back) > MIN_SHUFFLED_SHARE * len(at):
        return True
    stretches = sorted(np.split(at, back + 1), key=lambda s: float(s[0]))
    if all(a[-1] <= b[0] for a, b in pairwise(stretches)):
        return True
    gaps = np.diff(at[order])
    gaps = gaps[gaps > 0.0]
    return len(back) > MAX_RESTARTS and bool(np.quantile(gaps, 0.05) > 0.1 * np.median(gaps))


def temperatures(table: CsvTable, at: Array, remarks: list[str]) -> dict[str, Array]:
    """Temperature of every sensor at times (N,); missing and impossible values are filled."""
    out, constant = {}, []
    for column in table.columns:
        match = SENSOR.match(column)
        if match is None:
            continue
        values, gaps = table.temperatures(column)
        filled = _mended(table, column, values, gaps, at, remarks)
        if filled is not None:
            out[match.group(1)] = filled
            if np.ptp(filled) == 0.0 and match.group(1) != BODY:
                constant.append(f"{column} is constant at {filled[0]:g} degC")
    if constant:
        words = (
            f"what varies within the run does not follow from {'them' if constant[1:] else 'it'}"
        )
        remarks.append(f"{', '.join(constant)}: {words}")
    return out


def own_columns(table: CsvTable, at: Array, remarks: list[str]) -> dict[str, Array]:
    """Columns `V_name_unit` of the user's own, (N,) each; missing values are filled."""
    out = {}
    for column in table.columns:
        match = OWN.match(column)
        if match is None:
            continue
        values = table.numbers(column, empty=np.nan, finite=False, largest=np.inf)
        filled = _mended(table, column, values, ~np.isfinite(values), at, remarks)
        if filled is not None:
            out[match.group(1)] = filled
    return out


def check_units(table: CsvTable) -> None:
    """Recorded columns say their unit, in letters, digits and `_`; raises BadFile."""
    for column in table.columns:
        pattern, name = {"T_": SENSOR, "V_": OWN}.get(column[:2]), column[2:]
        if pattern is None or pattern.match(column):
            continue
        found, expected = "no unit that is known", "its unit behind the name"
        if odd := re.search(r"\W", name):
            found = f"{odd.group()!r} ({unicodedata.name(odd.group(), 'unknown').lower()})"
            expected = "a name of letters, digits and _, its unit behind it"
        accepted = f"{column[:2]}{_plain(name)}"
        if "_" not in name or not pattern.match(accepted):
            accepted = (
                f"T_{_plain(name.partition('_')[0]) or 'bed'}_degC"
                if pattern is SENSOR
                else f"V_{_plain(name) or 'coolant'}_bar"
            )
        where = f"line {table.header_line}, column {column}"
        raise BadFile(table.path, where, found, f"{expected}, such as {accepted}")


def _plain(name: str) -> str:
    """A name with `_` for what is no letter or digit; a letter and its accent are one sign."""
    return re.sub(r"[\W_]+", "_", unicodedata.normalize("NFC", name)).strip("_")


def _mended(
    table: CsvTable, column: str, values: Array, gaps: Mask, at: Array, remarks: list[str]
) -> Array | None:
    """A record with its gaps interpolated in time and reported; None where more than half is
    missing.
    """  # noqa: D205
    if not gaps.any():
        return values
    fault = _record_fault(table, column, values, gaps)
    if gaps.mean() > MAX_GAP_SHARE:
        what = "sensor" if SENSOR.match(column) else "column"
        remarks.append(f"{fault}; the {what} is left out")
        return None
    remarks.append(f"{fault}; the readings before and after it are joined by a line")
    return _filled(values, gaps, at)


def _filled(values: Array, gaps: Mask, at: Array) -> Array:
    """A record with values between their neighbours in the gaps; rows count where no time does."""
    along = at if np.ptp(at) > 0.0 and np.all(np.diff(at) >= 0.0) else np.arange(len(at))
    out = values.copy()
    out[gaps] = np.interp(along[gaps], along[~gaps], values[~gaps])
    return out


def _record_fault(table: CsvTable, column: str, values: Array, gaps: Mask) -> str:
    """Description of the fault of a record at its gaps."""
    first = int(np.argmax(gaps))
    rows = f"{gaps.sum()} row{'s' if gaps.sum() > 1 else ''}"
    if not np.isfinite(values[gaps]).any():
        return f"line {table.lines[first]}: {column} has no number in {rows}"
    first = int(np.argmax(gaps & np.isfinite(values)))
    known = values[np.isfinite(values)]
    why = ": kelvin?" if np.all((known > KELVIN[0]) & (known < KELVIN[1])) else ""
    return (
        f"line {table.lines[first]}: {column} reads {values[first]:g} degC, as no machine does"
        f"{why} ({rows})"
    )


def force(table: CsvTable) -> Array | None:
    """Load on the tool, (N, 3), N; None where none is recorded."""
    if not any(c in table for c in FORCE):
        return None
    zero = np.zeros(len(table))
    return np.stack([table.numbers(c) if c in table else zero for c in FORCE], axis=-1)


def poses(table: CsvTable, chain: Chain, q: Array, setup: IntArray) -> IntArray:
    """Label of every row's table pose: the column, else equal rotary readings and set-up."""
    if "pose" in table:
        return np.unique(table.text("pose"), return_inverse=True)[1].astype(np.int64)
    rotary = chain.rotary_columns
    key = np.column_stack([np.round(q[:, rotary], 6), setup])
    return np.unique(key, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def approach(table: CsvTable, touches: Touches) -> Array:
    """Signs of the last motion of every axis, (N, A): as stated, else as implied."""
    out = implied_approach(touches)
    for i, axis in enumerate(touches.chain.axes):
        column = f"dir{axis}"
        if column in table:
            out[:, i] = signs = table.numbers(column)
            wrong = np.flatnonzero(~np.isin(signs, (-1.0, 0.0, 1.0)))
            if len(wrong):
                row = int(wrong[0])
                expected = "the sign of the last move: 1, -1, or 0 if unknown"
                raise table.bad(row, column, f"{signs[row]:g}", expected)
    return out


def standing(table: CsvTable, approach: Array, touches: Touches, remarks: list[str]) -> Array:
    """Signs of the last motion, (N, A), with momentary standstills filled.

    A logger that writes the sign of the speed writes 0 where an axis turns round; the motion before
    is still its last one. Rows stand in the order of time within a feature.
    """
    out = approach.copy()
    stroke = np.unique(touches.feature, return_inverse=True)[1].reshape(-1)
    for i, axis in enumerate(touches.chain.axes):
        still = (out[:, i] == 0.0) & (f"dir{axis}" in table)
        if not still.any() or still.mean() > MAX_STANDSTILL_SHARE or np.ptp(touches.q[:, i]) == 0.0:
            continue
        for k in range(stroke.max() + 1):
            rows = np.flatnonzero(stroke == k)
            known = np.flatnonzero(~still[rows])
            if len(known):
                place = np.searchsorted(known, np.arange(len(rows)), "right") - 1
                out[rows, i] = out[rows[known[np.maximum(place, 0)]], i]
        remarks.append(
            f"dir{axis} is 0 in {int(still.sum())} rows amid a motion: the sign before is taken"
        )
    return out


def uncertainties(table: CsvTable, common: float | None) -> Array:
    """Standard uncertainty of every row, (N,), mm: its own, else the head's (µm)."""
    if common is None and "u_um" not in table:
        raise BadFile(table.path, "u_um", "nothing", "the standard uncertainty of one touch in µm")
    if "u_um" not in table:
        return np.full(len(table), common) * UM
    u = table.numbers("u_um", empty=common)
    wrong = (u < FINEST) | (u > COARSEST)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise table.bad(row, "u_um", f"{u[row]:g}", f"a number of {FINEST:g} to {COARSEST:g} µm")
    return u * UM


def splits(table: CsvTable) -> Labels:
    """What a row is for: "train", "test", or "" where the file does not say."""
    if "split" not in table:
        return np.full(len(table), "", dtype="U5")
    out = table.text("split")
    for i, word in enumerate(out):
        if word not in ("train", "test", ""):
            raise table.bad(i, "split", repr(word), "train or test")
    if all(word == "test" for word in out):
        raise BadFile(table.path, "column split", "test in every row", "rows to fit: train")
    return np.array(out, dtype="U5")


def counted(table: CsvTable, column: str) -> IntArray:
    """A column of whole numbers, 0 for empty cells, (N,); empty where there is no such column."""
    if column not in table:
        return np.zeros(0, dtype=np.int64)
    numbers = table.numbers(column, empty=0.0)
    odd = np.flatnonzero(numbers != np.round(numbers))
    if len(odd):
        row = int(odd[0])
        raise table.bad(row, column, f"{numbers[row]:g}", "a whole number")
    return numbers.astype(np.int64)


def moved_setup_remark(moved: Moved) -> str:
    """Remark on a set-up that was moved to the position found from its touches."""
    return (
        f"set-up {moved.name} is {moved.shift:.2f} mm and {moved.turn / DEG:.2f}° from its "
        "position in the head, as its touches show; the position by the touches is used"
    )


def angle_remark(points: Array) -> str:
    """Remark on how an instrument of angles writes them as deviations."""
    arm = float(np.median(np.linalg.norm(points, axis=1)))
    return f"dev_um are angles times {arm:g} mm: 1 um is {1000.0 / arm:.3g} urad"
