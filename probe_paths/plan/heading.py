"""What a program and its log say of themselves: standard, set-up, probe, features.

The operator needs these lines to mount the standard, and whoever reads the text back needs them to
know where it was believed to stand. They are comments of the program and literal lines of the log.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from probe_paths.plan.probe import Probe
from twin.errors import BadFile, DesignError
from twin.frames import Array, fixed_xyz, fixed_xyz_angles, pose
from twin.record import Setup
from twin.units import DEG

_NAME = re.compile(r"[A-Za-z0-9_.+-]{1,24}\Z")
_SERIAL = re.compile(r"SERIAL ([A-Za-z0-9_.+-]{1,24})")
_NUMBER = r"([+-]\d+\.\d+)"
_ORIGIN = re.compile(rf"ORIGIN X{_NUMBER} Y{_NUMBER} Z{_NUMBER}")
_TURNED = re.compile(rf"TURNED A{_NUMBER} B{_NUMBER} C{_NUMBER}")
_STYLUS = re.compile(rf"STYLUS L{_NUMBER} R{_NUMBER} BODY R{_NUMBER}")
_NOSE = re.compile(rf"NOSE R{_NUMBER} TABLE R{_NUMBER}")
_PROBE = re.compile(rf"PROBE RADIUS {_NUMBER} LENGTH TO BALL CENTRE {_NUMBER}")


@dataclass(frozen=True, eq=False)
class Heading:
    """Facts at the head of a program.

    Attributes:
        standard: Name of the standard, as its file has it.
        setup: Where it is believed to stand.
        probe: In the spindle.
        table_radius: Of the rotary table's face, mm; None where neither it nor the shape of the
            probe above its ball is stated, as in logs of earlier programs.
        serial: Number of the standard, as far as a program can state it; empty where it has none.
    """

    standard: str
    setup: Setup
    probe: Probe
    table_radius: float | None = None
    serial: str = ""

    @property
    def lines(self) -> list[str]:
        """Its lines, four at least; numbers with six decimals, mm and degrees."""
        for name in (self.standard, self.setup.name):
            if not _NAME.match(name):
                raise DesignError(
                    f"name '{name}' cannot stand in a program: expected 1 to 24 letters, digits, "
                    "_ . + or -"
                )
        T_table_artefact, probe = self.setup.T_table_artefact, self.probe
        angles = fixed_xyz_angles(T_table_artefact[:3, :3]) / DEG
        return [
            f"STANDARD {self.standard} SETUP {self.setup.name}",
            "ORIGIN " + _words("XYZ", T_table_artefact[:3, 3]),
            "TURNED " + _words("ABC", angles),
            f"PROBE RADIUS {probe.radius:+.6f} LENGTH TO BALL CENTRE {probe.length:+.6f}",
            *self._workshop,
            *([f"SERIAL {self.serial}"] if self.serial else []),
        ]

    @property
    def _workshop(self) -> list[str]:
        """The probe above its ball, and the table that it is kept clear of."""
        if self.table_radius is None:
            return []
        probe = self.probe
        return [
            f"STYLUS L{probe.stylus_length:+.6f} R{probe.stylus_radius:+.6f} "
            f"BODY R{probe.body_radius:+.6f}",
            f"NOSE R{probe.nose_radius:+.6f} TABLE R{self.table_radius:+.6f}",
        ]


def _words(letters: str, values: Array) -> str:
    # + 0.0 turns a negative zero, also one that rounding brings about, into a positive one
    return " ".join(f"{a}{round(v, 6) + 0.0:+.6f}" for a, v in zip(letters, values, strict=True))


def stated_serial(serial: str) -> str:
    """A serial number in the letters that a program can state."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", serial.strip())[:24]


def rounded_setup(setup: Setup) -> Setup:
    """The set-up as a program can state it, so that plan, program and log mean the same pose."""
    T_table_artefact = setup.T_table_artefact
    angles = np.round(fixed_xyz_angles(T_table_artefact[:3, :3]) / DEG, 6) * DEG
    return Setup(setup.name, pose(fixed_xyz(angles), np.round(T_table_artefact[:3, 3], 6)))


def parse_heading(lines: Sequence[tuple[int, str]], path: str | Path) -> Heading:
    """Heading from its lines, each with its line number in the file; further ones may follow.

    Raises:
        BadFile: A line missing or spelt otherwise.
    """
    where = f"line {lines[0][0]}" if lines else "head"
    if len(lines) < 4:
        raise BadFile(path, where, "an incomplete head", "STANDARD, ORIGIN, TURNED, PROBE lines")
    words = lines[0][1].split()
    if len(words) != 4 or words[0] != "STANDARD" or words[2] != "SETUP":
        raise BadFile(path, where, repr(lines[0][1]), "STANDARD <name> SETUP <name>")
    origin = _numbers(_ORIGIN, lines[1], path, "ORIGIN X.. Y.. Z..")
    angles = _numbers(_TURNED, lines[2], path, "TURNED A.. B.. C..")
    radius, length = _numbers(_PROBE, lines[3], path, "PROBE RADIUS .. LENGTH TO BALL CENTRE ..")
    T_table_artefact = pose(fixed_xyz(angles * DEG), origin)
    # programs of earlier versions stated neither shape and table nor the serial number
    more = [text for _, text in lines[4:]]
    shape, table_radius = {}, None
    if more and more[0].startswith("STYLUS "):
        expected = "STYLUS L.. R.. BODY R.., then NOSE R.. TABLE R.."
        stylus = _numbers(_STYLUS, lines[4], path, expected)
        around = _numbers(_NOSE, lines[min(5, len(lines) - 1)], path, expected)
        names = ("stylus_length", "stylus_radius", "body_radius", "nose_radius")
        shape = dict(zip(names, [*stylus.tolist(), float(around[0])], strict=True))
        table_radius, more = float(around[1]), more[2:]
    serial = _SERIAL.fullmatch(more[0]) if more else None
    return Heading(
        standard=words[1],
        setup=Setup(words[3], T_table_artefact),
        probe=Probe(float(radius), float(length), **shape),
        table_radius=table_radius,
        serial=serial[1] if serial else "",
    )


def _numbers(
    pattern: re.Pattern[str], line: tuple[int, str], path: str | Path, expected: str
) -> Array:
    match = pattern.fullmatch(line[1].strip())
    if match is None:
        raise BadFile(path, f"line {line[0]}", repr(line[1]), expected)
    return np.array([float(v) for v in match.groups()])
