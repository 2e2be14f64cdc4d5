"""Canned cycles of G-code: a hole along Z, called once at its compensated place."""

from matstd.compensation.part_programs.gcode_modes import Modes
from matstd.compensation.part_programs.language import Reading
from matstd.compensation.part_programs.motion import Cycle
from matstd.twin.frames import Array

_ALLOWED = frozenset("XYZRPQFLHSTK")
_STICKY = "RZPQ"
MOST = 1000
"""Holes of one line; beyond it the word is no number of holes."""


def call(
    line: int,
    axes: dict[str, float],
    other: dict[str, float],
    words: str,
    reading: Reading,
    modes: Modes,
) -> None:
    """The holes of a line.

    Raises:
        BadFile: Another plane, rotary axes, a word of another cycle, no R or no Z.
    """
    if modes.plane != "XY":
        raise reading.refusal(line, f"G{modes.motion:g} outside G17", "G17 for canned cycles")
    if strange := sorted(set(other) - _ALLOWED):
        raise reading.refusal(line, f"{strange[0]} in a canned cycle", "X, Y, Z, R, P, Q, L and F")
    z = reading.column(line, "Z")
    assert modes.motion is not None
    if modes.cycle is None:
        modes.cycle, modes.height = {}, float(reading.at[z])
    if modes.cycle.get("G") != modes.motion:  # dwell and steps are those of one kind of cycle
        kept = {k: v for k, v in modes.cycle.items() if k in "RZ"}
        modes.cycle = {**kept, "G": modes.motion}
    modes.cycle |= {k: v for k, v in other.items() if k in _STICKY}
    if missing := [k for k in "RZ" if k not in modes.cycle]:
        raise reading.refusal(line, f"a canned cycle without {missing[0]}", "R and Z in its first")
    top = modes.cycle["R"] * reading.unit + (0.0 if modes.is_absolute else modes.height)
    bottom = modes.cycle["Z"] * reading.unit + (0.0 if modes.is_absolute else top)
    if bottom > top:
        raise reading.refusal(line, f"a bottom at Z{bottom:g} above R{top:g}", "it below")
    back = max(top, modes.height) if modes.is_back_to_start else top
    stay = "".join(f" {k}{v:.10g}" for k, v in modes.cycle.items() if k in "PQ")
    cycle = Cycle(f"G{modes.motion:g}{{place}} R{{top}}{stay}", top - bottom, 0)
    times = int(other.get("L", other.get("K", 1.0)))
    if not 1 <= times <= MOST:
        raise reading.refusal(line, f"{times} holes", f"1 to {MOST}")
    for _ in range(times):
        above = _moved(line, axes, reading, modes)
        levels = (_at(above, z, top), _at(above, z, bottom), _at(above, z, back))
        reading.hole(line, levels, words, cycle)
        words = ""


def _moved(line: int, axes: dict[str, float], reading: Reading, modes: Modes) -> Array:
    """Where the axes stand above the next hole, but for Z."""
    out = reading.at.copy()
    for letter in set(axes) - {"Z"}:
        k = reading.column(line, letter)
        step = axes[letter] * reading.unit
        out[k] = step if modes.is_absolute else out[k] + step
    return out


def _at(place: Array, column: int, value: float) -> Array:
    out = place.copy()
    out[column] = value
    return out
