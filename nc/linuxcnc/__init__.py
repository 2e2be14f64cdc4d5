"""Files of LinuxCNC: its INI file read, HAL files read and written, variables and tools written."""

import configparser
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from matstd.twin.errors import BadFile
from matstd.twin.files import read_text

_SYSTEMS = 9  # coordinate systems G54 to G59.3


def variables(offsets: Mapping[int, Sequence[float]]) -> str:
    """Text of a file of variables with G54 in force.

    Offsets are X, Y and Z of the zero of coordinate systems by number, 1 is G54, mm; others have
    none.
    """
    # 5161, 5181: G28 and G30; 5210 to 5219: G92; 5220: system in force; 5221 + 20 k: its offsets
    values = [*enumerate([0.0] * 9, 5161), *enumerate([0.0] * 9, 5181)]
    values += [*enumerate([0.0] * 10, 5210), (5220, 1.0)]
    for system in range(_SYSTEMS):
        rest = [0.0] * 7  # A to W, and the rotation
        xyz = offsets.get(system + 1, (0.0, 0.0, 0.0))
        values += enumerate([*xyz, *rest], 5221 + 20 * system)
    return "".join(f"{number}\t{value:.6f}\n" for number, value in values)


def tool_table(number: int, length: float, radius: float) -> str:
    """Text of a tool table with one tool, mm."""
    return f"T{number} P{number} Z{length:.6f} D{2.0 * radius:.6f}\n"


def _signals(text: str) -> dict[str, str]:
    """Signals of a HAL file, by the pin: a pin is on one signal at most."""
    out: dict[str, str] = {}
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if words[:1] == ["net"]:
            out |= {pin: words[1] for pin in words[2:] if "." in pin}
    return out


def net(signal: str, source: str, *sinks: str) -> str:
    """Line that connects the pin of a value with those that read it."""
    return f"net {signal} {source} => {' '.join(sinks)}"


class Ini:
    """An INI file of LinuxCNC."""

    def __init__(self, path: Path) -> None:
        """Read it; raises BadFile."""
        self.path, self._text = path, read_text(path)
        self._ini = configparser.ConfigParser(
            strict=False, interpolation=None, inline_comment_prefixes=("#", ";")
        )
        try:
            self._ini.read_string(self._text)
        except configparser.MissingSectionHeaderError as error:
            expected = "a section such as [EMC]: an INI file of LinuxCNC"
            raise BadFile(path, error.lineno, repr(error.line), expected) from None
        except configparser.ParsingError as error:
            number, line = error.errors[0]
            raise BadFile(path, number, line, "an INI file of LinuxCNC") from None
        # axes of the control, in its order
        self.letters = self.value("TRAJ", "COORDINATES").replace(" ", "").upper()

    def value(self, section: str, key: str) -> str:
        """Text of a key; raises BadFile where it has none."""
        value = self._ini.get(section, key, fallback="").strip()
        if not value:
            raise BadFile(self.path, f"[{section}]", f"no {key}", f"{key} = ...")
        return value

    def number(self, section: str, key: str) -> float:
        """Number of a key; raises BadFile where it has none."""
        value = self.value(section, key)
        try:
            return float(value)
        except ValueError:
            raise BadFile(self.path, f"[{section}] {key}", value, "a number") from None

    def ends(self, axis: str) -> tuple[float, float]:
        """Limits of an axis, mm or degrees."""
        section = f"AXIS_{axis}"
        return self.number(section, "MIN_LIMIT"), self.number(section, "MAX_LIMIT")

    @property
    def hal_files(self) -> list[Path]:
        """HAL files of the control in their order; a key of that name may stand many times."""
        named = re.findall(r"(?mi)^\s*HALFILE\s*=\s*([^\s#]+)", self._text)
        return [self.path.parent / name for name in named]

    def signals(self, but: str = "") -> dict[str, str]:
        """Signals of all HAL files by the pin that is on them, but for one file."""
        out: dict[str, str] = {}
        for path in self.hal_files:
            if path.name != but and path.is_file():
                out |= _signals(read_text(path))
        return out
