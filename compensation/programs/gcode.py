"""G-code of part programs as LinuxCNC and its kin take it: a reader, and the lines of motions."""

import re
from pathlib import Path

import numpy as np

from compensation.programs.language import Reading, centre_by_radius, checked_arc, numbers
from compensation.programs.motion import Arc, Motion
from twin.frames import Array

ENDING = ".ngc"
COMMENT = "; {}"
_DECIMALS = 5
"""Of a length in mm, and of an angle in degrees: 10 nm, and 9 nm at half a metre."""

_KEPT_G = {4.0, 17.0, 18.0, 19.0, 40.0, 49.0, 61.0, 61.1, 64.0, 80.0, 94.0, 21.0, 20.0}
_KEPT_M = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49}
_SIDES = {40.0: 0.0, 41.0: 1.0, 42.0: -1.0}
_TAKEN_G = {0.0, 1.0, 2.0, 3.0, 41.0, 42.0, 43.0, 53.0, 80.0, 90.0, 91.0, 90.1, 91.1}
_PLANES = {17.0: "XY", 18.0: "ZX", 19.0: "YZ"}
_CENTRES = dict(zip("XYZ", "IJK", strict=True))
_REFUSED = {
    92.0: "one datum for the whole program",
    10.0: "one datum for the whole program",
    52.0: "one datum for the whole program",
    93.0: "G94, feed per minute",
    95.0: "G94, feed per minute",
    28.0: "motions of the program itself",
    30.0: "motions of the program itself",
}


_REMARK = re.compile(r"\([^)]*\)|;.*")
_NOT_PLAIN = re.compile(r"[/$]|O\d|O<|.*[#\[=]")


class _Modes:
    """What stays in force from line to line."""

    motion: float | None = None
    plane = "XY"
    is_absolute = True
    centres_absolute = False
    datum: float | None = None


def read(text: str, reading: Reading) -> None:
    """Read a whole program into the items of `reading`.

    Raises:
        BadFile: A line that is not understood, with its number.
    """
    modes = _Modes()
    for number, raw in enumerate(text.splitlines(), start=1):
        remarks = _REMARK.findall(raw) if "(" in raw or ";" in raw else []
        bare = (_REMARK.sub("", raw) if remarks else raw).strip().upper()
        if not bare or bare == "%":
            reading.keep(number, raw.strip())
            continue
        if _NOT_PLAIN.match(bare):
            expected = "plain words: no parameters, expressions, subprograms or skipped blocks"
            raise reading.refusal(number, repr(raw.strip()), expected)
        try:
            words = numbers(bare)
        except ValueError as error:
            raise reading.refusal(number, repr(str(error)), "words of G-code") from None
        comment = "".join(remarks).strip()
        _line(number, [(k, float(v)) for k, v in words if k != "N"], comment, reading, modes)


def _line(
    number: int, words: list[tuple[str, float]], comment: str, reading: Reading, modes: _Modes
) -> None:
    """One line: modes first, then its motion."""
    kept = [comment] if comment else []
    is_machine, functions = False, [v for k, v in words if k == "G"]
    for g in functions:
        is_machine |= g == 53.0
        if not _mode(g, reading, modes):
            _refuse(number, g, reading, modes)
        if g in _KEPT_G or 54.0 <= g < 60.0 or g in (43.0,):
            kept.append(f"G{g:g}")
    other = {k: v for k, v in words if k not in "GM"}
    for m in (v for k, v in words if k == "M"):
        if m not in _KEPT_M:
            raise reading.refusal(number, f"M{m:g}", "M0 to M9, M30, M48 or M49")
        kept.append(f"M{m:g}")
    _tool(number, functions, other, reading)
    reading.feed = other.get("F", reading.feed / reading.unit) * reading.unit
    is_dwell = 4.0 in functions
    axes = {k: v for k, v in other.items() if k in "XYZABCUVW"}
    spent = set(axes) | (set("IJKRP") if axes or set("IJK") & set(other) else set())
    spent |= {"D"}
    spent -= {"P"} if is_dwell or 64.0 in functions else set()
    kept += [f"{k}{v:.10g}" for k, v in other.items() if k not in spent]
    if not axes and not (set("IJK") & set(other) and modes.motion in (2.0, 3.0)):
        if kept:
            reading.keep(number, " ".join(kept))
        return
    if modes.motion is None or is_dwell:
        raise reading.refusal(number, "axes without G0, G1, G2 or G3", "one of them before")
    _motion(number, axes, other, " ".join(kept), is_machine, reading, modes)


def _tool(number: int, modes: list[float], other: dict[str, float], reading: Reading) -> None:
    """Tool of a T word, and that whose radius a D word means."""
    if "T" in other:
        if reading.side:
            raise reading.refusal(number, f"T{other['T']:g}", "G40 before another tool")
        reading.tool = int(other["T"])
        called = reading.lengths.get(reading.tool, reading.frame.datum.length)
        reading.switch(False, called)
    if "D" in other:
        if not {41.0, 42.0}.intersection(modes):
            raise reading.refusal(number, f"D{other['D']:g}", "it with G41 or G42")
        reading.tool = int(other["D"])


def _refuse(number: int, g: float, reading: Reading, modes: _Modes) -> None:
    expected = _REFUSED.get(
        g, "G0 to G4, G17 to G21, G40 to G43, G49, G53 to G64, G80, G90, G91, G94"
    )
    if 54.0 <= g < 60.0:
        expected = f"G{modes.datum:g} alone: a compensated program holds for one datum"
    raise reading.refusal(number, f"G{g:g}", expected)


def _mode(g: float, reading: Reading, modes: _Modes) -> bool:
    """Take a G word; False where it is not understood."""
    if g in (0.0, 1.0, 2.0, 3.0):
        modes.motion = g
    elif g in _PLANES:
        modes.plane = _PLANES[g]
    elif g in (20.0, 21.0):
        reading.unit = 25.4 if g == 20.0 else 1.0
    elif g in (90.0, 91.0):
        modes.is_absolute = g == 90.0
    elif g in (90.1, 91.1):
        modes.centres_absolute = g == 90.1
    elif 54.0 <= g < 60.0:
        modes.datum = modes.datum or g
        return modes.datum == g
    elif g == 80.0:
        modes.motion = None
    elif g in _SIDES:
        reading.side = _SIDES[g]
    return g in _KEPT_G | _TAKEN_G or 54.0 <= g < 60.0


def _motion(
    number: int,
    axes: dict[str, float],
    other: dict[str, float],
    kept: str,
    is_machine: bool,
    reading: Reading,
    modes: _Modes,
) -> None:
    """The motion of a line."""
    assert modes.motion is not None
    if is_machine:
        words = " ".join(f"{k}{v:.10g}" for k, v in axes.items())
        reading.keep(number, f"{kept} G53 G{modes.motion:g} {words}".strip(), moves=True)
        for letter in axes:
            reading.at[reading.column(number, letter)] = np.nan
        return
    end = reading.at.copy()
    for letter, value in axes.items():
        k = reading.column(number, letter)
        step = value * reading.scale(letter)
        end[k] = step if modes.is_absolute else end[k] + step
    is_rapid = modes.motion == 0.0
    is_arc = modes.motion in (2.0, 3.0)
    if not reading.is_known(end, is_arc):
        if is_arc or not modes.is_absolute:
            found = "an arc or a step from where no axis is known to stand"
            raise reading.refusal(number, found, "a motion to X, Y and Z before it")
        words = " ".join(f"{k}{v:.10g}" for k, v in axes.items())
        reading.keep(number, f"{kept} G{modes.motion:g} {words}".strip(), moves=True)
        reading.at = end
        return
    reading.move(
        Motion(
            line=number,
            start=np.where(np.isnan(reading.at), end, reading.at),
            end=end,
            is_rapid=is_rapid,
            feed=reading.needed_feed(number, is_rapid),
            tcpm=False,
            length=reading.length,
            offset=reading.offset,
            unit=reading.unit,
            words=kept,
            turned=tuple(a for a in axes if not reading.is_linear(a)),
            arc=_arc(number, end, other, reading, modes) if is_arc else None,
            beside=reading.beside(number),
        )
    )


def _arc(number: int, end: Array, other: dict[str, float], reading: Reading, modes: _Modes) -> Arc:
    """Circle of a G2 or G3 line."""
    plane = [reading.column(number, letter) for letter in modes.plane]
    positive = modes.motion == 3.0
    if "R" in other:
        radius = other["R"] * reading.unit
        centre = centre_by_radius(reading, number, plane, end, radius, positive)
    else:
        named = [other.get(_CENTRES[letter], 0.0) * reading.unit for letter in modes.plane]
        centre = np.array(named) + (0.0 if modes.centres_absolute else reading.at[plane])
    return checked_arc(reading, number, plane, end, centre, positive, int(other.get("P", 1)))


def begin() -> list[str]:
    """First lines of a compensated program: absolute coordinates from here on."""
    return ["G90"]


def decimals(is_length: bool, unit: Array) -> Array:
    """Decimals of a coordinate, (N,)."""
    return np.where(is_length & (unit != 1.0), _DECIMALS + 2, _DECIMALS)


def lines(motion: Motion, axes: tuple[str, ...], shown: list[list[float]]) -> list[str]:
    """Straight lines to some places.

    Args:
        motion: Whose lines they are; what else stood in its block goes to the first.
        axes: That are named.
        shown: Program coordinates of these, mm and degrees.
    """
    places = _DECIMALS + 2 * (motion.unit != 1.0)
    form = "G0" if motion.is_rapid else "G1"
    form += "".join(f" {a}%.{places if a in 'XYZ' else _DECIMALS}f" for a in axes)
    if motion.unit != 1.0:
        shown = [
            [v / motion.unit if a in "XYZ" else v for a, v in zip(axes, row, strict=True)]
            for row in shown
        ]
    out = [form % tuple(row) for row in shown]
    if motion.words:
        out[0] = f"{motion.words} {out[0]}"
    return out


def listed(blocks: list[str], path: Path) -> str:
    """The whole file."""
    return "\n".join(blocks) + "\n"
