"""`standard` in the head of a run: expansion of the standard and its temperature, in and out."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from twin.errors import BadFile, ShapeMismatch
from twin.files.table import KELVIN, CsvTable
from twin.files.toml import Table
from twin.frames import Array
from twin.record import BODY, Body, Run, Touches
from twin.units import T_REF

U_SHARE = 0.1
"""Relative standard uncertainty of an expansion stated without one. JCGM 100:2008, H.1.3.3: steel
within 2e-6 of 11.5e-6 1/K, rectangular, u = 1.2e-6."""

U_KNOWN = 0.3
"""Standard uncertainty of a temperature stated without one, K: a resistance thermometer of class B
is within 0.4 K (IEC 60751), rectangular 0.23, and it sits on the standard, not in it."""

U_UNKNOWN = 2.0
"""Standard uncertainty, about 20 degC, of a temperature that is not stated, K: rooms of machine
tools keep within 3 or 4 K of it, and a standard that comes from elsewhere takes hours."""

COLDEST, HOTTEST = 0.0, 50.0
"""Temperatures of a standard (degC) lie between: beyond, it is another body's, or kelvin."""

LARGEST = 1e-3
"""Expansions (1/K) are below: rubber has 2e-4, steel 11.5e-6."""

LARGEST_U = 20.0
"""Standard uncertainties of a temperature (K) are below: it says nothing any more."""

APART = 2.0
"""Standard uncertainties by which two statements of one temperature may differ."""


class BodyTable(Table):
    """`standard`: what the calibrated piece expands by, and how its temperature is known."""

    expansion_1_K: float  # noqa: N815  (K is the kelvin)
    expansion_u_1_K: float | None = None  # noqa: N815
    body_degC: float | None = None  # noqa: N815
    body_u_K: float | None = None  # noqa: N815


def with_body(run: Run, table: BodyTable, path: str | Path, within: str = "standard.") -> Run:
    """A run whose deviations are those from its standard at its own temperature.

    The one place where the growth of a standard is taken off; `raw_deviation` gives it back.

    Args:
        run: Of calibrated points at 20 degC, sensors included.
        table: As stated; a column `T_body_degC` stands for `body_degC`.
        path: Where it was stated, for refusals.
        within: What stands before its keys there.

    Raises:
        BadFile: Key, what stood there, what was expected.
    """
    _check(table, path, within)
    touches = run.touches
    if not touches.instrument.is_ball_on_standard:
        found = f"the expansion of a standard, and readings of a {touches.instrument.value}"
        raise BadFile(path, within.rstrip("."), found, "it for a touch-probe alone")
    at, stated = touches.temperature.get(BODY), table.body_degC
    is_known = at is not None or stated is not None
    u = table.body_u_K
    if u is None:
        u = U_KNOWN if is_known else U_UNKNOWN
    if at is not None:
        _check_column(at, stated, u, run, path, within)
    elif is_known:
        at = np.full(len(touches), stated)
    u_alpha = table.expansion_u_1_K
    body = Body(
        alpha=table.expansion_1_K,
        u_alpha=U_SHARE * table.expansion_1_K if u_alpha is None else u_alpha,
        u_temperature=u,
        is_known=is_known,
    )
    touches = replace(
        touches,
        setups=tuple(replace(s, body=body) for s in touches.setups),
        body_temperature=np.full(len(touches), T_REF) if at is None else at,
    )
    return replace(run, touches=touches, deviation=run.raw_deviation - touches.growth)


def _check(table: BodyTable, path: str | Path, within: str) -> None:
    """Refuse numbers that are in another unit, or of something else."""
    for key, low, high, expected in (
        ("expansion_1_K", 0.0, LARGEST, f"from 0 to {LARGEST:g} 1/K: of steel 11.5e-6"),
        ("expansion_u_1_K", 0.0, LARGEST, f"from 0 to {LARGEST:g} 1/K: of steel 1.2e-6"),
        ("body_degC", COLDEST, HOTTEST, _TEMPERATURE),
        ("body_u_K", 0.0, LARGEST_U, f"a standard uncertainty from 0 to {LARGEST_U:g} K"),
    ):
        value = getattr(table, key)
        if value is not None and not low <= value <= high:
            raise BadFile(path, f"{within}{key}", f"{value:g}{_kelvin(key, value)}", expected)


_TEMPERATURE = f"the temperature of the standard, from {COLDEST:g} to {HOTTEST:g} degC"


def _kelvin(key: str, value: float) -> str:
    """What a temperature far off may be."""
    if key != "body_degC":
        return ""
    return ", which is kelvin?" if KELVIN[0] < value < KELVIN[1] else ", of another body?"


def _check_column(
    at: Array, stated: float | None, u: float, run: Run, path: str | Path, within: str
) -> None:
    """Refuse a sensor that is not on the standard, or says something else than the head."""
    off = np.flatnonzero((at < COLDEST) | (at > HOTTEST))
    if len(off):
        found = f"{at[off[0]]:g}{_kelvin('body_degC', float(at[off[0]]))}"
        where = f"line {run.line[off[0]]}, column T_{BODY}_degC"
        raise BadFile(path, where, found, _TEMPERATURE)
    mean = float(np.mean(at))
    if stated is not None and abs(stated - mean) > APART * u:
        raise BadFile(
            path,
            f"{within}body_degC",
            f"{stated:g}, where column T_{BODY}_degC has {mean:.2f} on average",
            f"one of the two, or both within {APART * u:g} K",
        )


def check_body_column(table: CsvTable, run: Run) -> None:
    """Refuse a column `T_body_degC` that could not be used; raises BadFile."""
    column = f"T_{BODY}_degC"
    if column in table and BODY not in run.touches.temperature:
        values, gaps = table.temperatures(column)
        row = int(np.argmax(gaps))
        raise table.bad(
            row, column, f"{values[row]:g}{_kelvin('body_degC', values[row])}", _TEMPERATURE
        )


def body_line(touches: Touches) -> str:
    """Line of the head that states the size of the standard; empty where nothing is stated.

    Raises:
        ShapeMismatch: Several standards: they stand in files of their own.
    """
    bodies = {s.body for s in touches.setups}
    if bodies == {None}:
        return ""
    body = bodies.pop()
    if bodies or body is None:
        raise ShapeMismatch("set-ups of several standards, expected a run file for each")
    line = f"expansion_1_K = {body.alpha!r}, expansion_u_1_K = {body.u_alpha!r}"
    if body.is_known and BODY not in touches.temperature:
        line += f", body_degC = {float(touches.body_temperature[0])!r}"
    return f"# standard = {{ {line}, body_u_K = {body.u_temperature!r} }}\n"
