"""Lists of nominal and measured coordinates: a machined part, or a calibrated plate.

Both compare where a point is with where it should be, and mean opposite things:

- ``part``: the machine under test made the point, a better one measured it. Measured minus nominal
  is where the tool really went relative to the workpiece: the machine's own deviation. A controller
  that believes in the nominal machine sees such a surface outside its place by the negative.
- ``standard``: the point is calibrated, the machine under test measured it. Measured minus
  calibrated is what the controller believes, with its sign.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from matstd.importers.points.coordinate_rows import (
    letters_of_rows,
    nominal_and_measured,
    points_of_rows,
)
from matstd.importers.points.other_frame import OtherFrame, places
from matstd.importers.points.point_list import PointList
from matstd.importers.sheets import MM, Sheet, signs
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.machine import Axis, Chain, inverse_linear, linear_directions, make_chain, tip
from matstd.twin.record import Instrument, Run, Setup, at_poses

Meaning = Literal["part", "standard"]
"""Who made a list: see the module."""

_NOMINAL = re.compile(r"nom|soll|target|calib|ref|theor|théor|cad", re.IGNORECASE)
_MEASURED = re.compile(r"meas|act|ist\b|\bist|gemessen|mesur|réel|cmm|found", re.IGNORECASE)
_DEVIATION = re.compile(r"dev|err|abweich|fehler|écart|\bd[xyz]\b|delta", re.IGNORECASE)
_AFTER_DIR = re.compile(r"\b(dir)(?=[xyz]\b)", re.IGNORECASE)
_LETTER = re.compile(r"(?<![a-z])d?([xyz])(?![a-z])", re.IGNORECASE)
_APPROACH = re.compile(r"dir|richtung|approach|anfahr|revers|umkehr", re.IGNORECASE)
_ROLES = (
    ("approach", _APPROACH),
    ("measured", _MEASURED),
    ("deviation", _DEVIATION),
    ("nominal", _NOMINAL),
)
"""What a column of a coordinate holds, by its name: the first that fits."""
_NAME = re.compile(
    r"name|label|feature|hole|point|element|bohrung|merkmal|élément|trou|alésage|\bid\b",
    re.IGNORECASE,
)
_SETUP = re.compile(r"set-?up|part|session|date|day|aufspannung|werkst", re.IGNORECASE)


def read_points(sheet: Sheet, unit: str | None = None) -> PointList:
    """Points from a table with columns such as `x nominal [mm]`, `x measured [mm]`.

    Deviations (`dx [µm]`) may stand in place of measured coordinates. A coordinate without a
    column is zero and not measured. A row may also hold one coordinate of a point, whose letter
    stands in a column of its own, as reports of CMMs are laid out.

    Args:
        unit: Of columns whose name has none; None takes mm for coordinates and refuses deviations.

    Raises:
        BadFile: No nominal or no measured coordinate; a deviation without a unit.
    """
    letters = letters_of_rows(sheet)
    if letters is not None:
        return _by_coordinate(sheet, letters, unit)
    nominal = np.zeros((len(sheet), 3))
    deviation = np.full((len(sheet), 3), np.nan)
    approach = np.zeros((len(sheet), 3), dtype=np.int64)
    found = _roles(sheet)
    for i, letter in enumerate("xyz"):
        if ("approach", letter) in found:
            approach[:, i] = signs(sheet, found["approach", letter])
        if ("nominal", letter) in found:
            nominal[:, i] = sheet.quantity(found["nominal", letter], MM, unit or "mm")
        if ("measured", letter) in found:
            measured = sheet.quantity(found["measured", letter], MM, unit or "mm")
            deviation[:, i] = measured - nominal[:, i]
        elif ("deviation", letter) in found:
            deviation[:, i] = sheet.quantity(found["deviation", letter], MM, unit)
    if not np.isfinite(deviation).any() or not any(role == "nominal" for role, _ in found):
        expected = "columns such as 'x nominal [mm]' and 'x measured [mm]', or a mapping file"
        raise sheet.lacking(expected)
    return PointList(
        nominal=nominal,
        deviation=deviation,
        feature=np.array(_texts(sheet, _NAME, "")),
        setup=np.array(_texts(sheet, _SETUP, "a")),
        line=np.array(sheet.lines),
        approach=approach,
    )


def _by_coordinate(sheet: Sheet, letters: list[str], unit: str | None) -> PointList:
    """Points of a table with a row a coordinate."""
    nominal, measured = (
        sheet.quantity(c, MM, unit or "mm")
        for c in nominal_and_measured(sheet, _NOMINAL, _MEASURED)
    )
    setup = _texts(sheet, _SETUP, "a")
    label, points = points_of_rows(sheet, letters, _texts(sheet, _NAME, ""), setup)
    at, off = np.zeros((len(points), 3)), np.full((len(points), 3), np.nan)
    for p, point in enumerate(points):
        for letter, k in point.items():
            i = "XYZ".index(letter)
            at[p, i], off[p, i] = nominal[k], measured[k] - nominal[k]
    first = [next(iter(point.values())) for point in points]
    return PointList(
        nominal=at,
        deviation=off,
        feature=np.array([label[k] for k in first]),
        setup=np.array([setup[k] for k in first]),
        line=np.array([sheet.lines[k] for k in first]),
        approach=np.zeros((len(points), 3), dtype=np.int64),
    )


def _roles(sheet: Sheet) -> dict[tuple[str, str], int]:
    """Column of every role and letter."""
    found: dict[tuple[str, str], int] = {}
    for i, name in enumerate(sheet.names):
        letter = _LETTER.search(_AFTER_DIR.sub(r"\1 ", name.replace("_", " ")))
        if letter is None:
            continue
        is_plain = name.strip().lower() == letter[1].lower()
        words = name.replace("_", " ")
        role = next((role for role, pattern in _ROLES if pattern.search(words)), None)
        role = "nominal" if role is None and is_plain else role
        if role is None:
            continue
        key = (role, letter[1].lower())
        if key in found:
            both = f"{sheet.columns[found[key]]!r} and {sheet.columns[i]!r}"
            raise BadFile(sheet.path, "header", both, f"one column of {role} {key[1]}")
        found[key] = i
    return found


def _texts(sheet: Sheet, pattern: re.Pattern[str], empty: str) -> list[str]:
    """Cells of the first column that a pattern names and that holds no coordinate."""
    found = sheet.find(pattern, _LETTER)
    cells = [""] * len(sheet) if found is None else sheet.text(found)
    return [text or empty for text in cells]


def linear_machine(points: PointList, frames: Sequence[OtherFrame] = ()) -> Chain:
    """A machine of the linear axes along which the points extend, for a list without a machine.

    An axis along which points were measured but do not extend gets a travel of 2 mm.

    Args:
        frames: In which the machine measured them where it is not the nominal frame.
    """
    at = places(points, frames)
    low, high = at.min(axis=0), at.max(axis=0)
    moves = (high > low) | ((high == low) & np.isfinite(points.deviation).any(axis=0))
    travels = {
        letter: Axis(range=(float(low[i]), float(high[i])))
        if high[i] > low[i]
        else Axis(range=(float(low[i]) - 1.0, float(low[i]) + 1.0))
        for i, letter in enumerate("XYZ")
        if moves[i]
    }
    return make_chain("linear machine", f"[w f {' '.join(travels)} t]", travels, (0.0, 0.0, 0.0))


def points_run(
    points: PointList,
    meaning: Meaning,
    chain: Chain,
    u: float,
    frames: Sequence[OtherFrame] = (),
) -> Run:
    """Run of a list of points: a row a measured coordinate, with the direction of that coordinate.

    Readings are those that bring the tool point of the nominal machine to the nominal place, with
    its rotary axes at zero; table frame and list share their origin, the set-up is free in a fit.

    Args:
        points: The list.
        meaning: `part` or `standard`; it decides the sign.
        u: Standard uncertainty of one coordinate, mm.
        frames: Where the set-ups of a standard stand that are not where the list says; deviations
            are those in these frames.

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
        normal=turned[np.arange(len(rows)), axis],  # of the machine, as the standard sees it
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
    # fewer axes reach places in their own directions only: what is beside them is the set-up's
    columns = [chain.axis_index(name) for name in chain.linear_axes]
    back = np.linalg.pinv(linear_directions(chain, q))
    q[:, columns] = np.einsum("nmi,ni->nm", back, place - tip(chain, q, 0.0))
    return q


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
