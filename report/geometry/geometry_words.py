"""The geometry of the machine in words: estimates, their effect over the travel, changes."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from matstd.diagnosis.geometry import (
    Correction,
    Estimate,
    GeometryRow,
    LearntGeometry,
    Quantity,
    Rung,
)
from matstd.diagnosis.policy import POLICY
from matstd.report.numbers import digits, microns, with_uncertainty
from matstd.twin.units import UM, URAD
from matstd.twin.words import listed

_UNITS = {"mm": ("µm", UM), "rad": ("µrad", URAD), "1": ("ppm", 1e-6)}

_LARGE = 2.0  # times its usual size from which on a line of a rotary axis is explained
_TURNS = {"A": "X", "B": "Y", "C": "Z"}  # direction of the rotation that a letter denotes

ARM = (Quantity.JOINT_ZERO, Quantity.LINK_LENGTH, Quantity.LINK_TWIST, Quantity.JOINT_OFFSET)
"""Results of the calibration of a serial arm."""

USUAL = (Quantity.SQUARENESS, Quantity.SCALE, *ARM)
"""The most requested quantities of a machine tool and of a serial arm."""

SPANS = (Quantity.STRAIGHTNESS, Quantity.ANGULAR, Quantity.ROTARY_MOTION)
"""Curves, reported by their peak to valley."""

MIN_SIGNIFICANCE = 2.0
"""Standard uncertainties from which on a quantity is worth a line on the console."""
MAX_REPORTED = 8  # quantities reported on the console

PART = "of this, laws or tables over a reading contribute {}"


@dataclass(frozen=True, slots=True)
class GeometryLine:
    """One row of the table."""

    name: str  # `squareness of Y to X (EC0Y)`
    value: str  # `3 ± 2 → 41 ± 2 µrad`; empty where the run does not determine it
    at_ends: str  # its effect over the travel
    expected: str  # its expected size
    note: str  # whether it exceeds its expected size, has changed, or shares its signature
    is_noted: bool  # whether the note should be read first

    @property
    def is_determined(self) -> bool:
        """Whether the run determines the quantity."""
        return bool(self.value)


def geometry_lines(geometry: LearntGeometry) -> list[GeometryLine]:
    """The whole table."""
    return [_line(row) for row in geometry.rows]


_NAMES = {
    Quantity.SCALE: "scale of {axis}",
    Quantity.STRAIGHTNESS: "straightness of {axis} in {letter}",
    Quantity.SQUARENESS: "squareness of {axis} to {first}",
    Quantity.JOINT_ZERO: "zero of joint {axis}",
    Quantity.LINK_LENGTH: "length of the link from {first} to {axis}",
    Quantity.JOINT_OFFSET: "length along the line of {axes}",
    Quantity.LINK_TWIST: "angle between the lines of {first} and {axis}",
}


class Named(Protocol):
    """What has a quantity with its symbol and axes."""

    @property
    def quantity(self) -> Enum:
        """Its kind."""

    @property
    def symbol(self) -> str:
        """Its ISO 230-1 name."""

    @property
    def axes(self) -> tuple[str, ...]:
        """Its axis, or two."""


def quantity_name(row: Named) -> str:
    """`squareness of Y to X (EC0Y)`."""
    axis, letter = row.axes[-1], row.symbol[1]
    about = _TURNS.get(letter)
    match row.quantity:
        case Quantity.ANGULAR:
            words = f"roll of {axis}" if about == axis[0] else f"tilt of {axis} about {about}"
        case Quantity.ROTARY_LINE:
            line = f"line of {axis}"
            words = f"tilt of the {line} about {about}" if about else f"{line} in {letter}"
        case Quantity.ROTARY_ZERO:
            words = f"zero of {axis}"
        case Quantity.ROTARY_MOTION if letter == axis[0]:
            words = f"positioning of {axis}"
        case Quantity.ROTARY_MOTION:
            words = f"error motion of {axis} {f'about {about}' if about else f'in {letter}'}"
        case plain:
            first, axes = row.axes[0], listed(list(row.axes))
            assert isinstance(plain, Quantity)
            words = _NAMES[plain].format(axis=axis, letter=letter, first=first, axes=axes)
    return f"{words} ({row.symbol})"


def _line(row: GeometryRow) -> GeometryLine:
    unit, factor = _UNITS[row.unit]
    expected = f"{digits(row.expected / factor, 2)} {unit}"
    name = quantity_name(row)
    if not row.is_determined:
        shared = f"; same signature as {listed(list(row.shared_with))}" if row.shared_with else ""
        return GeometryLine(
            name=name,
            value="",
            at_ends="",
            expected=expected,
            note=f"± {digits(row.estimate.u / factor, 2)} {unit}{shared}",
            is_noted=False,
        )
    notes = []
    if row.is_far:
        notes.append(
            f"{digits(row.times_usual, 2)} times what is usual (± {expected}): the machine file or "
            "the set-up is wrong"
        )
    elif row.is_beyond_expected:
        notes.append(f"larger than expected (± {expected})")
    if row.has_changed and row.change is not None:
        notes.append(f"changed by {_value(row.change.value, row.change.u, factor, unit)}")
    is_noted = bool(notes)
    at_ends = _value(row.at_ends.value, row.at_ends.u, UM, "µm")
    # an instrument of angles has an arm of one metre: both figures are the same; a single axis has
    # no arm at all
    in_um = at_ends.removesuffix("µm")
    is_same = row.unit == "mm" or not row.lever or in_um == value_words(row).removesuffix("µrad")
    part = row.by_laws
    if part is not None and abs(part.value) > row.estimate.u:
        notes.append(PART.format(_value(part.value, part.u, factor, unit)))
    if row.change is not None and not row.has_changed:
        difference = _value(row.change.value, row.change.u, factor, unit)
        notes.append(f"no change beyond chance ({difference})")
    return GeometryLine(
        name=name,
        value=value_words(row),
        at_ends="" if is_same else at_ends,
        expected=expected,
        note="; ".join(notes),
        is_noted=is_noted,
    )


def value_words(row: GeometryRow) -> str:
    """`41.0 ± 2.0 µrad`, or `3.0 ± 2.0 → 41.0 ± 2.0 µrad` where there was a value before."""
    unit, factor = _UNITS[row.unit]
    now = _value(row.estimate.value, row.estimate.u, factor, unit)
    if row.before is None:
        return now
    return f"{_value(row.before.value, row.before.u, factor, '')} → {now}"


def shown_unit(unit: str) -> tuple[str, float]:
    """Unit in which a quantity is reported, and its size in the base unit."""
    return _UNITS[unit]


def estimate_words(estimate: Estimate, unit: str) -> str:
    """`41.0 ± 2.0 µrad`, from an estimate in a base unit."""
    shown, factor = _UNITS[unit]
    return _value(estimate.value, estimate.u, factor, shown)


def _value(value: float, u: float, factor: float, unit: str) -> str:
    return with_uncertainty(value / factor, u / factor, unit)


def noted_lines(geometry: LearntGeometry) -> list[str]:
    """The largest quantities, by what they do at the tool; changed ones stand first.

    Lines of rotary axes always, of the others those that changed, exceed their expected size or
    are clear of their uncertainty. Without any, squareness and scales, zeros of joints and lengths
    of links; without these, all that the run determines.
    """
    known = [r for r in geometry.rows if r.is_determined]
    noted = [r for r in geometry.rows if r.has_changed or _is_beyond(r) or _is_of_arm(r)]
    noted += [r for r in known if r not in noted and (_is_line(r) or _is_clear(r))]
    noted = noted or [r for r in known if _is_usual(r)] or known
    by_size = sorted(noted, key=lambda r: (not r.has_changed, -r.at_ends.value))
    lines = [
        _noted(r) for i, r in enumerate(by_size) if i < MAX_REPORTED or r.is_far or _is_line(r)
    ]
    more = len(noted) - len(lines)
    lines += [f"and {more} more in the table"] if more > 0 else []
    if any(step.rung is Rung.MODEL for step in geometry.ladder) and not any(
        r.has_changed for r in noted
    ):
        lines.insert(
            0, "the geometry differs from the model, but no single quantity changed beyond chance"
        )
    return lines


def rotary_lines(geometry: LearntGeometry) -> list[str]:
    """Line and zero of every rotary axis with what is usual of them, one sentence for each axis."""
    rows = [r for r in geometry.rows if r.usual is not None]
    return [
        _rotary([r for r in rows if r.axes == axes]) for axes in dict.fromkeys(r.axes for r in rows)
    ]


def _rotary(rows: Sequence[GeometryRow]) -> str:
    """`line and zero of C: EX0C 12.3 ± 1.0 µm, ..., EC0C not determined; usual ± 64 µm, ...`."""
    parts = [f"{r.symbol} {value_words(r) if r.is_determined else 'not determined'}" for r in rows]
    large = [r for r in rows if r.is_determined and r.times_usual > _LARGE and not r.is_far]
    note = ""
    if large:
        named = ", ".join(f"{r.symbol} has {digits(r.times_usual, 2)} times that" for r in large)
        note = (
            f". {named}: the model corrects that; {POLICY.far_line:g} times and more is taken for "
            "a mistake in the machine file"
        )
    sizes = {}
    for row in rows:
        unit, factor = _UNITS[row.unit]
        sizes[unit] = f"± {digits(row.expected / factor, 2)} {unit}"
    return (
        f"line and zero of {rows[0].axes[0]}: {', '.join(parts)}; usual {', '.join(sizes.values())}"
        f"{note}"
    )


def far_lines(geometry: LearntGeometry) -> list[str]:
    """Lines of rotary axes far from their position in the machine file."""
    return [_noted(row) for row in geometry.rows if row.is_far]


def _noted(row: GeometryRow) -> str:
    """One quantity on the console."""
    line = _line(row)
    where = "at the end of the arm" if row.quantity in ARM else "over the travel"
    at_ends = f", {line.at_ends} {where}" if line.at_ends else ""
    span = ", peak to valley" if row.quantity in SPANS else ""
    note = f"; {line.note}" if line.note else ""
    return f"{line.name}{span}: {line.value}{at_ends}{note}"


def _is_beyond(row: GeometryRow) -> bool:
    return row.is_beyond_expected or row.is_far


def _is_line(row: GeometryRow) -> bool:
    """Whether it is the position of a rotary axis, the first that is asked of a five-axis machine.

    Arms have many lines and small uses of each: there these are the lengths and zeros.
    """
    is_place = row.quantity is Quantity.ROTARY_LINE and row.unit == "mm"
    return is_place and row.is_determined


def _is_clear(row: GeometryRow) -> bool:
    """Whether it exceeds its uncertainty by more than chance."""
    return row.is_determined and abs(row.estimate.value) > MIN_SIGNIFICANCE * row.estimate.u


def _is_of_arm(row: GeometryRow) -> bool:
    """Whether it is a zero or a length of an arm that clearly exceeds its uncertainty.

    All of these are entered in the control of an arm, whatever their size.
    """
    is_clear = abs(row.estimate.value) > POLICY.clear_excess * row.estimate.u
    return row.quantity in ARM and row.is_determined and is_clear


def _is_usual(row: GeometryRow) -> bool:
    """Whether it is requested most; for a rotary axis that is its positioning."""
    is_positioning = row.quantity is Quantity.ROTARY_MOTION and row.symbol[1] == row.axes[0][0]
    return row.quantity in USUAL or is_positioning


def ladder_sentence(geometry: LearntGeometry) -> str:
    """`Held-out error: set-up alone 20.5 µm, with geometry 0.60 µm, with effects 0.58 µm`."""
    steps = [
        f"{'with ' if i else ''}{step.rung.value} {microns(step.test_rms)}"
        for i, step in enumerate(geometry.ladder)
    ]
    return f"held-out error: {', '.join(steps)}"


def correction_line(correction: Correction) -> str:
    """A line to copy into the machine file: `point = [0.054, 0, -420]  # axis.B; was ...`."""
    table, _, key = correction.key.rpartition(".")
    places = 8 if key == "direction" else 4
    numbers = ", ".join(f"{v:.{places}f}" for v in correction.found)
    was = ", ".join(f"{v:g}" for v in correction.stated)
    unit, factor = ("µrad", URAD) if key == "direction" else ("µm", UM)
    u = ", ".join("-" if v is None else digits(v / factor, 2) for v in correction.u)
    if len(correction.found) == 1:
        return f"{correction.key} = {numbers}  # was {was}, ± {u} {unit}"
    return f"[{table}] {key} = [{numbers}]  # was [{was}], ± [{u}] {unit}"
