"""Every format of tables: made, written, read back and simulated."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.compensation.field import (
    CorrectionFunction,
    Datum,
    MachineErrors,
    Result,
    deviation_after,
    in_both_directions,
    relative_columns,
    result_of,
)
from matstd.compensation.tables import heidenhain_com, iso_csv, linuxcnc_comp, sinumerik_cec
from matstd.compensation.tables.along_axes import (
    MIN_GAIN,
    AxisTables,
    along_axes,
    harmless,
    left_out,
    line_bound,
    most_useful,
    unheld_along,
)
from matstd.compensation.tables.by_name import (
    NamedTables,
    interpolation_bound,
    sampled,
    unheld_by_name,
)
from matstd.compensation.tables.header import Header
from matstd.twin.display import Displayed
from matstd.twin.errors import DesignError
from matstd.twin.files import write_whole
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.numbers import rms_length
from matstd.twin.units import UM


@dataclass(frozen=True, eq=False)
class Acceptance:
    """The place on a line through the datum where a table moves the tool point most.

    An indicator is zeroed at the datum, one linear axis is moved, and the indicator is read again:
    a straightedge or a gauge block shows it, and the operator sees the whole way.
    """

    axis: str  # that is moved from the datum
    q: Array  # readings, (A,)
    without: Array  # deviation of the tool point relative to the datum without the table, (3,), mm
    with_table: Array  # the same with it
    wrong_sign: Array  # the same where the control takes its values with the opposite sign
    u: Array  # standard uncertainties from that of the model, (3,), mm


def acceptance(
    errors: MachineErrors, corrects: CorrectionFunction, datum: Datum, q: Array
) -> Acceptance:
    """The one-point test of a table.

    Args:
        datum: Pose to which everything refers.
        q: Poses of the workspace, (N, A): the axis is moved to a reading of one of them.
    """
    chain, count = errors.chain, len(q)
    lines = np.tile(datum.q, (len(chain.linear_axes), count, 1))
    for line, k in zip(lines, chain.linear_columns, strict=True):
        line[:, k] = q[:, k]
    q = lines.reshape(-1, len(datum.q))
    candidates = errors.touches(q, datum.length)
    best = int(np.argmax(np.abs(corrects(candidates)).sum(axis=1)))
    at, there = errors.touches(q[[best]], datum.length), datum.touches(errors)
    shown = []
    for sign in (0.0, 1.0, -1.0):
        moved = deviation_after(errors, at, sign * corrects(at)) - deviation_after(
            errors, there, sign * corrects(there)
        )
        shown.append(moved[0])
    spread = relative_columns(errors, at, datum)[0] @ errors.root
    return Acceptance(
        axis=chain.linear_axes[best // count],
        q=q[best],
        without=shown[0],
        with_table=shown[1],
        wrong_sign=shown[2],
        u=np.linalg.norm(spread, axis=1),
    )


Tables = NamedTables | AxisTables


@dataclass(frozen=True, slots=True)
class Format:
    """A control's tables."""

    name: str  # word of the command line, and folder
    make: Callable[[MachineErrors, Datum, Array], Tables]  # tables of some errors, for some poses
    write: Callable[[Any, Header], dict[str, str]]  # texts by file name
    read: Callable[[Path, Chain], tuple[Tables, Header]]  # tables and head from a folder


@dataclass(frozen=True, eq=False, repr=False)
class VerifiedTables(Displayed):
    """Tables that were written, read back and simulated on the exact twin."""

    format: str  # word of the format
    files: tuple[str, ...]
    result: Result  # before and after over the workspace, and what the format cannot hold
    # what interpolation and rounding leave at most, mm: over the workspace where tables hold errors
    # by name, on the lines through the datum where they hold axes
    interpolation: float
    by_name: bool  # whether tables hold errors by name
    # axes whose table would raise the error beside the line through the datum
    left_out: tuple[str, ...]
    acceptance: Acceptance


class Harmful(DesignError):
    """Tables that would make the machine worse."""


def refuse_harmful(verified: VerifiedTables) -> None:
    """Raise Harmful for tables that leave more than they found over the workspace."""
    before, after = rms_length(verified.result.before), rms_length(verified.result.after)
    if after > before + MIN_GAIN:
        raise Harmful(
            f"{verified.format}: the tables would leave {after / UM:.3g} µm rms in the workspace, "
            f"where the machine without them has {before / UM:.3g} µm; narrow the workspace "
            f"(--within) or compensate part programs instead (--program)"
        )


def _iso(errors: MachineErrors, datum: Datum, _: Array) -> Tables:
    return sampled(errors, datum, iso_csv.ISO_POINTS)


def _cec(errors: MachineErrors, datum: Datum, q: Array) -> Tables:
    made = along_axes(errors, datum, sinumerik_cec.CEC_POINTS, True)
    most = sinumerik_cec.PER_AXIS * len(errors.chain.programmed_axes)
    return most_useful(made, errors, datum, q, most)


def _comp(errors: MachineErrors, datum: Datum, q: Array) -> Tables:
    return harmless(along_axes(errors, datum, linuxcnc_comp.COMP_POINTS, False), errors, datum, q)


def _com(errors: MachineErrors, datum: Datum, _: Array) -> Tables:
    return sampled(errors, datum, heidenhain_com.COM_POINTS).positioning()


FORMATS: Mapping[str, Format] = {
    f.name: f
    for f in (
        Format("iso230", _iso, iso_csv.write, iso_csv.read),
        Format("sinumerik", _cec, sinumerik_cec.write, sinumerik_cec.read),
        Format("linuxcnc", _comp, linuxcnc_comp.write, linuxcnc_comp.read),
        Format("heidenhain", _com, heidenhain_com.write, heidenhain_com.read),
    )
}
"""By the word of the command line, that which holds most first."""


def write_tables(
    control_format: Format,
    folder: Path,
    errors: MachineErrors,
    datum: Datum,
    head: Header,
    q: Array,
) -> None:
    """Write the tables of a format into a folder of their own; arguments as of `verify_tables`."""
    for name, text in control_format.write(control_format.make(errors, datum, q), head).items():
        write_whole(folder / name, text)


def verify_tables(
    control_format: Format,
    folder: Path,
    errors: MachineErrors,
    datum: Datum,
    head: Header,
    q: Array,
) -> VerifiedTables:
    """Read tables back and simulate them on the exact twin.

    Raises:
        BadFile: Files that cannot be read, or are of another machine or datum.
    """
    tables, found = control_format.read(folder, errors.chain)
    found.check(head, folder)
    touches = in_both_directions(errors, q, datum.length)
    harmful: tuple[str, ...] = ()
    if isinstance(tables, NamedTables):
        unheld = unheld_by_name(tables, errors, datum, touches)
        bound = interpolation_bound(tables, errors, datum, q)
    else:
        unheld = unheld_along(tables, errors, datum, touches)
        bound = line_bound(tables, errors, datum)
        harmful = left_out(tables, errors, datum)
    return VerifiedTables(
        format=control_format.name,
        files=tuple(sorted(p.name for p in folder.iterdir())),
        result=result_of(errors, tables.correction, q, datum, unheld),
        interpolation=bound,
        by_name=isinstance(tables, NamedTables),
        left_out=harmful,
        acceptance=acceptance(errors, tables.correction, datum, q),
    )
