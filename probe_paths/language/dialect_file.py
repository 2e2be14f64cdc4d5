"""Dialect files (TOML, format "dialect/1"): the words of a control, ours or a user's own."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, Strict

from matstd.probe_paths.language.dialect import CYCLE_NAMES, DISTANCE_WORDS, Dialect
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import Table, checked, read_toml

_SHIPPED = Path(__file__).parent / "dialects"
_DIALOG = r"^[A-Z][A-Z0-9 -]{0,23}$"


class DialectTable(Table):
    """The whole file."""

    format: str
    title: str
    language: Literal["klartext", "gcode"]
    cycle_name: str = Field(default=CYCLE_NAMES[0], pattern=_DIALOG)
    distance_word: str = Field(default=DISTANCE_WORDS[0], pattern=_DIALOG)
    folder: str = Field(default="", pattern=r"^([A-Z0-9_:\\.-]*[A-Z0-9_])?$")
    tool: int = Field(default=30, ge=1, le=32767)
    preset: int = Field(default=1, ge=1, le=9999)
    prefix: str = Field(default="MS", pattern=r"^[A-Z][A-Z0-9_]{0,5}$")
    result_height: Literal["gauge", "tip"] = "gauge"
    log_decimals: int = Field(default=6, ge=4, le=6)
    slow_feed: float = Field(default=0.0, ge=0.0, le=100.0)
    step_back: float = Field(default=0.0, ge=0.0, le=2.0)
    has_planes: bool = False
    is_oriented: bool = False
    head_off: Annotated[tuple[Literal["M115", "M145"], ...], Strict(False)] = ("M115", "M145")


def known_controls() -> list[str]:
    """Names of the controls whose dialects come with us."""
    return sorted(path.stem for path in _SHIPPED.glob("*.toml"))


def read_dialect(control: str, folder: str | Path = ".") -> Dialect:
    """Dialect by the name of a control, or from a `.toml` file; raises DesignError."""
    is_own = control.endswith(".toml")
    path = Path(folder) / control if is_own else _SHIPPED / f"{control}.toml"
    if not is_own and control not in known_controls():
        raise DesignError(
            f"control '{control}': expected one of {', '.join(known_controls())}, or a dialect "
            "file (.toml)"
        )
    table = checked(DialectTable, read_toml(path, "dialect/1"), path)
    _check(table, path)
    return Dialect(**{k: v for k, v in table.model_dump().items() if k not in ("format", "title")})


def _check(table: DialectTable, path: Path) -> None:
    """Refuse keys that contradict each other; raises BadFile."""
    if table.language == "klartext":
        for key in ("slow_feed", "step_back"):
            if getattr(table, key):
                raise BadFile(path, key, getattr(table, key), "0: cycle 4 touches once")
        if not table.folder:
            raise BadFile(path, "folder", "nothing", "a folder of the control such as TNC:\\MATSTD")
        return
    for key in ("preset", "log_decimals"):
        if getattr(table, key) > 6:
            raise BadFile(path, key, getattr(table, key), "6 at most")
    if table.folder:
        raise BadFile(path, "folder", table.folder, "nothing: LinuxCNC logs where it was started")
    if not (table.slow_feed >= 1.0 and table.step_back >= 0.1):
        found = f"{table.slow_feed:g}, {table.step_back:g}"
        raise BadFile(path, "slow_feed, step_back", found, "at least 1 mm/min and 0.1 mm")
