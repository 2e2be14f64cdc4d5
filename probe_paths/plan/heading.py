"""Head of a program and of its log: standard, set-up, probe, workshop, features.

The operator needs these lines to mount the standard, the reader of the text to know its believed
place and the obstacles. They are comments of the program; the first of them are literal lines of
its log, which identifies the workshop by a hash only.
"""

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import TABLE, DatumBall, Solid, Workshop
from matstd.artefact.tool import Probe
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, fixed_xyz, fixed_xyz_angles, pose
from matstd.twin.machine import Chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG

_NAME = re.compile(r"[A-Za-z0-9_.+-]{1,24}\Z")
_SOLID_NAME = re.compile(r"[A-Za-z0-9_.+-]{1,16}\Z")
_NUMBER = r"([+-]\d+\.\d+)"
_ORIGIN = re.compile(rf"ORIGIN X{_NUMBER} Y{_NUMBER} Z{_NUMBER}")
_TURNED = re.compile(rf"TURNED A{_NUMBER} B{_NUMBER} C{_NUMBER}")
_PROBE = re.compile(rf"PROBE RADIUS {_NUMBER} LENGTH TO BALL CENTRE {_NUMBER}")
_STATED = re.compile(r"(SERIAL|CALIBRATION|MACHINE|WORKSHOP|FRAME) ([A-Za-z0-9_.+-]{1,24})")
_TILTED = "SPATIAL"
_STACK = re.compile(rf"STACK TO{_NUMBER} R{_NUMBER}")
_NOSE = re.compile(rf"NOSE R{_NUMBER}")
_SOLID = re.compile(rf"BODY (\S+) (BOX|DISC) A{_NUMBER} B{_NUMBER} Z{_NUMBER} TO{_NUMBER}")
_PLACE = re.compile(rf"AT X{_NUMBER} Y{_NUMBER} C{_NUMBER} ON (\S+)")
_SENSOR = re.compile(rf"SENSOR (\w{{1,16}}) Q(10[0-7]) FACTOR{_NUMBER} OFFSET{_NUMBER}")
_BALL = re.compile(rf"DATUM BALL X{_NUMBER} Y{_NUMBER} Z{_NUMBER}")
_BALL_SIZE = re.compile(rf"DATUM R{_NUMBER} S{_NUMBER} F{_NUMBER} U{_NUMBER}")
_EARLIER = re.compile(r"(STYLUS L.* BODY R.*|NOSE R.* TABLE R.*)")
_TABLE_WORD, _HASH = "TABLE", 12

_FIRST_PARAMETER = 100  # in which a PLC hands values to programs; there are eight


class Sensor(NamedTuple):
    """A temperature that the control itself knows, and logs with every touch."""

    name: str  # name of the sensor; its column in a run is `T_<name>_degC`
    parameter: int  # Q parameter in which the control's PLC hands it to programs
    factor: float  # degC per unit of the parameter
    offset: float  # degC at zero

    @property
    def line(self) -> str:
        """As a head states it."""
        scale = f"FACTOR{self.factor:+.6f} OFFSET{self.offset:+.6f}"
        return f"SENSOR {self.name} Q{self.parameter} {scale}"

    @property
    def word(self) -> str:
        """Before the reading in a log: TA for Q100, TB for Q101."""
        return f"T{chr(ord('A') + self.parameter - _FIRST_PARAMETER)}"


@dataclass(frozen=True, eq=False)
class Heading:
    """Facts at the head of a program."""

    standard: str  # name of the standard, as its file has it
    setup: Setup
    probe: Probe  # in the spindle; in a log its ball and length alone
    workshop: Workshop | None = None  # what stands beside the standard; None in a log
    # number of the standard, as far as a program can state it; empty where it has none
    serial: str = ""
    # hash of the faces and places of the standard; empty in logs of earlier programs
    calibration: str = ""
    arrangement: str = ""  # axes of the machine, `C-B-X-F-Y-Z`; empty in logs of earlier programs
    stated: str = ""  # hash of probe and workshop; empty in logs of earlier programs
    is_tilted: bool = False  # coordinates are those of planes that are tilted with the table
    sensors: tuple[Sensor, ...] = ()
    ball: DatumBall | None = None  # on the table beside the standard, where that is what is touched

    def touched(self, standard: Standard, T_table_artefact: Array | None = None) -> Standard:
        """What a program has before it: the standard, and the ball if that is touched.

        Args:
            T_table_artefact: Where it stands; None for where it is believed to.
        """
        if self.ball is None:
            return standard
        place = self.setup.T_table_artefact if T_table_artefact is None else T_table_artefact
        return self.ball.beside(standard, place)

    @property
    def stamp(self) -> str:
        """What the program was written for: `FFS-600U 001 (7A09B49B2AF2)`."""
        hashed = f" ({self.calibration})" if self.calibration else ""
        return f"{self.standard} {self.serial}".strip() + hashed

    def check_machine(self, chain: Chain, path: str | Path) -> None:
        """Refuse a machine whose axes stand in another order; raises BadFile.

        Places and travels may differ: a corrected description is of the same machine.
        """
        if self.arrangement and self.arrangement != chain.arrangement:
            raise BadFile(
                path,
                "MACHINE",
                f"axes {self.arrangement} from workpiece to tool",
                f"{chain.arrangement}, those of '{chain.name}': the program was written for "
                "another machine",
            )

    @property
    def log_lines(self) -> list[str]:
        """What the log repeats, four at least; numbers with six decimals, mm and degrees."""
        for name in (self.standard, self.setup.name):
            if not _NAME.match(name):
                expected = "1 to 24 letters, digits, _ . + or -"
                raise DesignError(f"name '{name}' cannot stand in a program: expected {expected}")
        T_table_artefact, probe = self.setup.T_table_artefact, self.probe
        angles = fixed_xyz_angles(T_table_artefact[:3, :3]) / DEG
        named = {
            "SERIAL": self.serial,
            "CALIBRATION": self.calibration,
            "MACHINE": self.arrangement,
            "WORKSHOP": self.workshop_hash,
            "FRAME": _TILTED if self.is_tilted else "",
        }
        return [
            f"STANDARD {self.standard} SETUP {self.setup.name}",
            "ORIGIN " + _words("XYZ", T_table_artefact[:3, 3]),
            "TURNED " + _words("ABC", angles),
            f"PROBE RADIUS {probe.radius:+.6f} LENGTH TO BALL CENTRE {probe.length:+.6f}",
            *(f"{name} {value}" for name, value in named.items() if value),
            *(sensor.line for sensor in self.sensors),
            *_ball_lines(self.ball),
        ]

    @property
    def lines(self) -> list[str]:
        """All lines of the program's head."""
        return [*self.log_lines, *self._workshop_lines]

    @property
    def workshop_hash(self) -> str:
        """Hash of probe and workshop; where only a log is read, as it states it, else empty."""
        if self.workshop is None:
            return self.stated
        ball = f"{self.probe.radius:.6f} {self.probe.length:.6f}"
        text = "\n".join([ball, *self._workshop_lines])
        return hashlib.sha256(text.encode("ascii")).hexdigest()[:_HASH].upper()

    @property
    def _workshop_lines(self) -> list[str]:
        """The probe above its ball, and the obstacles."""
        if self.workshop is None:
            return []
        return [
            *(f"STACK TO{end:+.6f} R{radius:+.6f}" for end, radius in self.probe.stack),
            f"NOSE R{self.probe.nose_radius:+.6f}",
            *(line for solid in self.workshop.solids for line in _solid_lines(solid)),
        ]


def _ball_lines(ball: DatumBall | None) -> list[str]:
    """The ball on the table in two lines."""
    if ball is None:
        return []
    size = _words("RSF", np.array([ball.radius, ball.stem, ball.low]))
    u = _words("U", np.array([ball.u]), 7)
    return ["DATUM BALL " + _words("XYZ", np.array([ball.x, ball.y, ball.z])), f"DATUM {size} {u}"]


def _solid_lines(solid: Solid) -> Iterator[str]:
    """A body in two lines."""
    name = _TABLE_WORD if solid.name == TABLE else solid.name
    if not _SOLID_NAME.match(name):
        expected = "1 to 16 letters, digits, _ . + or -"
        raise DesignError(f"body '{name}' cannot stand in a program: expected {expected}")
    shape, (a, b) = "DISC" if solid.is_disc else "BOX", solid.half_size
    yield f"BODY {name} {shape} A{a:+.3f} B{b:+.3f} Z{solid.low:+.3f} TO{solid.high:+.3f}"
    place = _words("XYC", np.array([solid.x, solid.y, solid.turn / DEG]), 3)
    yield f"AT {place} ON {solid.on or _TABLE_WORD}"


def _words(letters: str, values: Array, decimals: int = 6) -> str:
    # + 0.0 turns a negative zero, also one that rounding brings about, into a positive one
    return " ".join(
        f"{a}{round(float(v), decimals) + 0.0:+.{decimals}f}"
        for a, v in zip(letters, values, strict=True)
    )


def stated_serial(serial: str) -> str:
    """A serial number in the letters that a program can state."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", serial.strip())[:24]


def calibration_hash(standard: Standard) -> str:
    """Short hash of all faces and places of a standard: another calibration, another hash."""
    numbers: list[Array] = []
    for patch in standard.patches:
        numbers += [patch.T_artefact_patch, patch.heights, np.array(patch.half_size)]
    numbers += [np.append(sphere.centre, sphere.radius) for sphere in standard.spheres]
    numbers.append(np.array([standard.base.thickness]))
    text = " ".join(f"{v + 0.0:.6f}" for part in numbers for v in np.round(part, 6).ravel())
    return hashlib.sha256(text.encode("ascii")).hexdigest()[:_HASH].upper()


def rounded_setup(setup: Setup) -> Setup:
    """The set-up as a program can state it, so that plan, program and log mean the same pose."""
    T_table_artefact = setup.T_table_artefact
    angles = np.round(fixed_xyz_angles(T_table_artefact[:3, :3]) / DEG, 6) * DEG
    return Setup(setup.name, pose(fixed_xyz(angles), np.round(T_table_artefact[:3, 3], 6)))


def rounded_workshop(workshop: Workshop) -> Workshop:
    """The workshop as a program can state it."""
    ball = workshop.ball
    if ball is not None:
        ball = DatumBall(*(round(getattr(ball, field.name), 6) for field in fields(ball)))
    return Workshop(_rounded(workshop.table), tuple(map(_rounded, workshop.bodies)), ball)


def _rounded(solid: Solid) -> Solid:
    numbers = {name: round(getattr(solid, name), 3) for name in ("low", "high", "x", "y")}
    a, b = solid.half_size
    turn = round(solid.turn / DEG, 3) * DEG
    return replace(solid, half_size=(round(a, 3), round(b, 3)), turn=turn, **numbers)


def parse_heading(lines: Sequence[tuple[int, str]], path: str | Path) -> tuple[Heading, int]:
    """Heading from its lines, each with its line number, and how many lines it has.

    Raises:
        BadFile: A line missing or spelt otherwise, a workshop that is not the one of its hash.
    """
    where = lines[0][0] if lines else "head"
    if len(lines) < 4:
        raise BadFile(path, where, "an incomplete head", "STANDARD, ORIGIN, TURNED, PROBE lines")
    words = lines[0][1].split()
    if len(words) != 4 or words[0] != "STANDARD" or words[2] != "SETUP":
        raise BadFile(path, where, repr(lines[0][1]), "STANDARD <name> SETUP <name>")
    origin = _numbers(_ORIGIN, lines[1], path, "ORIGIN X.. Y.. Z..")
    angles = _numbers(_TURNED, lines[2], path, "TURNED A.. B.. C..")
    radius, length = _numbers(_PROBE, lines[3], path, "PROBE RADIUS .. LENGTH TO BALL CENTRE ..")
    T_table_artefact = pose(fixed_xyz(angles * DEG), origin)
    stated, sensors, count = _stated_lines(lines, path)
    ball = None
    if len(lines) > count + 1 and lines[count][1].startswith("DATUM BALL "):
        place = _numbers(_BALL, lines[count], path, "DATUM BALL X.. Y.. Z..")
        size = _numbers(_BALL_SIZE, lines[count + 1], path, "DATUM R.. S.. F.. U..")
        ball, count = DatumBall(*place.tolist(), *size.tolist()), count + 2
    head = Heading(
        standard=words[1],
        setup=Setup(words[3], T_table_artefact),
        probe=Probe(float(radius), float(length)),
        serial=stated.get("SERIAL", ""),
        calibration=stated.get("CALIBRATION", ""),
        arrangement=stated.get("MACHINE", ""),
        stated=stated.get("WORKSHOP", ""),
        is_tilted="FRAME" in stated,
        sensors=sensors,
        ball=ball,
    )
    if len(lines) == count or not lines[count][1].startswith("STACK "):
        return head, count
    try:
        return _with_workshop(head, list(lines), count, path)
    except BadFile:
        raise
    except DesignError as error:  # a probe or a body that cannot be
        raise BadFile(path, f"line {lines[count][0]} and after", str(error), "a probe") from None


def _stated_lines(
    lines: Sequence[tuple[int, str]], path: str | Path
) -> tuple[dict[str, str], tuple[Sensor, ...], int]:
    """Statements of the lines after the first four by first word; sensors; lines read."""
    stated: dict[str, str] = {}
    sensors: list[Sensor] = []
    count = 4
    for number, text in lines[4:]:
        if match := _SENSOR.fullmatch(text.strip()):
            scale = (float(match[3]), float(match[4]))
            sensors.append(Sensor(match[1], int(match[2]), *scale))
        elif match := _STATED.fullmatch(text.strip()):
            stated[match[1]] = match[2]
            if match[1] == "FRAME" and match[2] != _TILTED:
                raise BadFile(path, number, repr(text), f"FRAME {_TILTED}")
        elif not _EARLIER.fullmatch(text.strip()):
            break
        count += 1
    return stated, tuple(sensors), count


def _with_workshop(
    head: Heading, lines: list[tuple[int, str]], count: int, path: str | Path
) -> tuple[Heading, int]:
    """The heading with the shape of the probe and the bodies that follow."""
    first, stack = lines[count][0], []
    while count < len(lines) and lines[count][1].startswith("STACK "):
        end, radius = _numbers(_STACK, lines[count], path, "STACK TO.. R..").tolist()
        stack.append((end, radius))
        count += 1
    # ends the loops below at a head that breaks off
    lines.append((lines[-1][0], "the end of the head"))
    nose = _numbers(_NOSE, lines[count], path, "NOSE R..")
    probe = Probe(head.probe.radius, head.probe.length, tuple(stack), float(nose[0]))
    count += 1
    solids = []
    while lines[count][1].startswith("BODY "):
        solids.append(_solid(lines[count], lines[count + 1], path))
        count += 2
    if not solids or solids[0].name != TABLE:
        found = repr(lines[count][1])
        raise BadFile(path, lines[count][0], found, f"BODY {_TABLE_WORD} and others")
    whole = replace(head, probe=probe, workshop=Workshop(solids[0], tuple(solids[1:])))
    if whole.workshop_hash != head.stated:
        found = f"a probe and bodies of hash {whole.workshop_hash}"
        expected = f"WORKSHOP {head.stated or '<hash>'}, as stated: emit the program again"
        raise BadFile(path, first, found, expected)
    return whole, count


def _solid(shape: tuple[int, str], place: tuple[int, str], path: str | Path) -> Solid:
    """A body from its two lines."""
    found, at = _SOLID.fullmatch(shape[1].strip()), _PLACE.fullmatch(place[1].strip())
    if found is None:
        raise BadFile(path, shape[0], repr(shape[1]), "BODY <name> BOX|DISC A B Z TO")
    if at is None:
        raise BadFile(path, place[0], repr(place[1]), "AT X.. Y.. C.. ON <axis>|TABLE")
    a, b, low, high = (float(found[i]) for i in range(3, 7))
    return Solid(
        name=TABLE if found[1] == _TABLE_WORD else found[1],
        half_size=(a, b),
        is_disc=found[2] == "DISC",
        low=low,
        high=high,
        x=float(at[1]),
        y=float(at[2]),
        turn=float(at[3]) * DEG,
        on="" if at[4] == _TABLE_WORD else at[4],
    )


def _numbers(
    pattern: re.Pattern[str], line: tuple[int, str], path: str | Path, expected: str
) -> Array:
    match = pattern.fullmatch(line[1].strip())
    if match is None:
        raise BadFile(path, line[0], repr(line[1]), expected)
    return np.array([float(v) for v in match.groups()])
