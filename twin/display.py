"""Display of results: a short text, in a notebook a table and a picture, a CSV table.

`text` and `html` dispatch by type; by default they show the name of a record and the sizes of its
fields. `report` registers sentences, tables and pictures when it is imported; `before_showing`
postpones such an import until the first result is shown.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sized
from dataclasses import fields, is_dataclass
from functools import singledispatch
from html import escape
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from matstd.twin.errors import MissingLibrary
from matstd.twin.text import csv_text

MAX_VALUE_CHARACTERS = 40  # longest value of a field that is shown in full, in characters
_BEFORE: list[Callable[[], object]] = []


def before_showing(prepare: Callable[[], object]) -> None:
    """Call something once, before the next result is shown."""
    _BEFORE.append(prepare)


def _prepared() -> None:
    while _BEFORE:
        _BEFORE.pop()()


@singledispatch
def text(result: object) -> str:
    """A result in one or a few lines: the name of its type, and its fields where it has some."""
    name = type(result).__name__
    if not is_dataclass(result):
        return f"<{name}>"
    shown = ", ".join(f"{f.name}={_brief(getattr(result, f.name))}" for f in fields(result))
    return f"{name}({shown})"


def _brief(value: object) -> str:
    """A value where it is short; else its shape, its length or its type."""
    if isinstance(value, np.ndarray):
        return f"<array {value.shape}>"
    if isinstance(value, Displayed):
        return f"<{type(value).__name__}>"
    if isinstance(value, Sized) and not isinstance(value, str):
        return f"<{len(value)} of {type(value).__name__}>"
    shown = value.name if isinstance(value, Path) else repr(value)
    return shown if len(shown) <= MAX_VALUE_CHARACTERS else f"<{type(value).__name__}>"


@singledispatch
def html(result: object) -> str:
    """A result for a notebook: its text."""
    return f"<p>{escape(text(result))}</p>"


class Displayed:
    """A result with a short text for `repr`, and more in a notebook."""

    def __repr__(self) -> str:
        _prepared()
        return text(self)

    def _repr_html_(self) -> str:
        _prepared()
        return html(self)


class Tabular(Displayed, ABC):
    """A result that is a table, units in the names of its columns.

    Attributes:
        number_format: Format of numbers in `to_csv`.
    """

    number_format = ".7g"

    @abstractmethod
    def columns(self) -> Mapping[str, Any]:
        """Columns by name, all of one length."""

    def to_csv(self, path: str | Path | None = None) -> str:
        """The table as CSV with a line of names; also written to a file, if one is named."""
        table = self.columns()
        rows = zip(*table.values(), strict=True)
        written = csv_text(table, ([self.cell(value) for value in row] for row in rows))
        if path is not None:
            from matstd.twin.files.whole import write_whole

            write_whole(path, written)
        return written

    def cell(self, value: Any) -> str:
        """One value as text."""
        if value is None:
            return ""
        if isinstance(value, float | np.floating):
            return format(float(value), self.number_format)
        return str(int(value)) if isinstance(value, bool | np.bool_) else str(value)

    def to_dataframe(self) -> Any:
        """The table as a data frame of pandas.

        Raises:
            MissingLibrary: pandas is not installed; `to_csv` does without.
        """
        try:
            pandas = import_module("pandas")
        except ImportError as error:
            raise MissingLibrary(
                f"a data frame needs pandas ({error}): pip install pandas, or use to_csv()"
            ) from error
        return pandas.DataFrame({name: list(v) for name, v in self.columns().items()})
