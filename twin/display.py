"""How results show themselves: a short text, in a notebook a table and a picture, a CSV table.

Words and pictures are made in `report`, which lies above every result. It is looked up by its name
when somebody asks to see one, so nothing below imports it.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from matstd.twin.errors import MissingLibrary
from matstd.twin.text import csv_text

_MADE_BY = "matstd.report.pages.notebook"


class Shown:
    """A result with a short text for `repr`, and more in a notebook."""

    def __repr__(self) -> str:
        return str(import_module(_MADE_BY).text(self))

    def _repr_html_(self) -> str:
        return str(import_module(_MADE_BY).html(self))


class Tabular(Shown, ABC):
    """A result that is a table, units in the names of its columns.

    Attributes:
        number_format: Of numbers in `to_csv`.
    """

    number_format = ".7g"

    @abstractmethod
    def columns(self) -> Mapping[str, Any]:
        """Columns by name, all of one length."""

    def to_csv(self, path: str | Path | None = None) -> str:
        """The table as CSV with a line of names; written to a file, whole or not at all, if named.

        Returns:
            The text.
        """
        table = self.columns()
        rows = zip(*table.values(), strict=True)
        text = csv_text(table, ([self.cell(value) for value in row] for row in rows))
        if path is not None:
            import_module("matstd.twin.files").write_whole(path, text)
        return text

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
