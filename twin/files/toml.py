"""TOML at the border: read with one clear line for whatever is wrong in it."""

import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from twin.errors import BadFile


class Table(BaseModel):
    """A table of a user's file: unknown keys, NaN, infinity and numbers in quotes are refused."""

    model_config = ConfigDict(
        extra="forbid", allow_inf_nan=False, strict=True, frozen=True, populate_by_name=True
    )


T = TypeVar("T", bound=BaseModel)


def read_text(path: str | Path) -> str:
    """Text of a user's file; raises BadFile if it is missing or not UTF-8."""
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadFile(path, f"byte {error.start}", "bytes that are no UTF-8", "text") from error
    except OSError as error:
        raise BadFile(path, "file", error.strerror, "a file that can be read") from error


def parse_toml(text: str, path: str | Path, first_line: int = 1) -> dict[str, Any]:
    """Tables of a TOML text; raises BadFile with the line."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BadFile(path, "TOML", str(error), "a whole, valid TOML file") from error


def checked(model: type[T], data: object, path: str | Path, within: str = "") -> T:
    """A table checked against its model; the first fault is told in one line.

    Args:
        model: Pydantic model with the units in its field names.
        data: What was read.
        path: The file, for the message.
        within: Key under which the data stood.

    Raises:
        BadFile: File, key, what stood there, what was expected.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _as_bad_file(error, model, path, within) from None


def _as_bad_file(
    error: ValidationError, model: type[BaseModel], path: str | Path, within: str
) -> BadFile:
    """First fault of a table in one line."""
    first = error.errors(include_url=False)[0]
    steps = [str(step) for step in first["loc"] if not str(step).startswith("function-")]
    key = ".".join(([within] if within else []) + steps) or "file"
    if first["type"] == "extra_forbidden":
        known = ", ".join(field.alias or name for name, field in model.model_fields.items())
        return BadFile(
            path,
            key,
            "an unknown key",
            f"one of {known}" if len(steps) == 1 else "a key of the format",
        )
    if first["type"] == "missing":
        return BadFile(path, key, "nothing", "this key")
    message = first["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    return BadFile(path, key, repr(first["input"]), message)


def check_format(data: dict[str, Any], wanted: str, path: str | Path) -> None:
    """Raise BadFile unless `format` says what the reader understands."""
    if data.get("format") != wanted:
        found = repr(data["format"]) if "format" in data else "nothing"
        raise BadFile(path, "format", found, f'"{wanted}"')
