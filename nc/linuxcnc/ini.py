"""The INI file of LinuxCNC: values by section and key; missing ones are refused."""

import configparser
import re
from pathlib import Path

from matstd.nc.linuxcnc.hal import signals
from matstd.twin.errors import BadFile
from matstd.twin.files import read_text


class Ini:
    """An INI file of LinuxCNC.

    Attributes:
        letters: Axes of the control, in its order.
    """

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
            raise BadFile(path, f"line {error.lineno}", repr(error.line), expected) from None
        except configparser.ParsingError as error:
            number, line = error.errors[0]
            raise BadFile(path, f"line {number}", line, "an INI file of LinuxCNC") from None
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
                out |= signals(read_text(path))
        return out
