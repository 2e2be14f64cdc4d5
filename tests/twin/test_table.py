"""Tables of plain numbers are read fast, and mean what Python's own csv and float() say."""

import csv
from pathlib import Path

import numpy as np
import pytest

from matstd.twin.errors import BadFile
from matstd.twin.files import CsvTable, table

ROWS = 5000
"""More than two of the blocks in which numbers are converted."""


def numbers() -> list[str]:
    """Numbers of every size, as spreadsheets, instruments and Python write them."""
    rng = np.random.default_rng(3)
    values = rng.normal(size=2 * ROWS) * 10.0 ** rng.integers(-11, 11, 2 * ROWS)
    ways = ("{:.4f}", "{!r}", "{:.17e}", "{:.3E}", "{:.0f}", " {:g} ")
    return [ways[i % len(ways)].format(v) for i, v in enumerate(values.tolist())]


def written(cells: list[str], end: str = "\n") -> str:
    rows = [f"{a},{b}" for a, b in zip(cells[::2], cells[1::2], strict=True)]
    return "a,b\n" + "\n".join(rows) + end


@pytest.mark.parametrize("end", ["", "\n", "\n\n\n"])
@pytest.mark.parametrize("strange", ["", '"1.5"', "+1.5", ".5", "1.", "007", "-0"])
def test_numbers_are_those_of_float_to_the_bit(strange: str, end: str) -> None:
    cells = numbers()
    cells[-2] = strange or cells[-2]
    text = written(cells, end)
    rows = [row for row in csv.reader(text.splitlines()) if row][1:]
    read = CsvTable(text, "t.csv")
    for i, name in enumerate("ab"):
        expected = np.array([float(row[i]) for row in rows])
        np.testing.assert_array_equal(read.numbers(name), expected)
    assert len(read) == ROWS
    assert read.lines == list(range(2, ROWS + 2))


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("true", "line 4002, column a: found 'true', expected a number"),
        ("null", "line 4002, column a: found 'null', expected a number"),
        ("[1]", "line 4002, column a: found '.1.', expected a number"),
        ("1-2", "line 4002, column a: found '1-2', expected a number"),
        ("1,2", "line 4002: found 3 cells under 2 column names"),
        ("1],[2", "line 4002: found 3 cells under 2 column names"),
        ("1_0", "line 4002, column a: found '1_0', expected a number"),
        ("", "line 4002, column a: found '', expected a number"),
        ("nan", "line 4002, column a: found nan, expected a finite number"),
        ("1e999", "line 4002, column a: found 1e999, expected a finite number"),
        ("9" * 400, "line 4002, column a: found 9+.*, expected a finite number"),
        ("2e12", "line 4002, column a: found 2e12, expected at most 1e.12"),
        ("-7", "line 4002, column a: found -7, expected -5 or more"),
    ],
)
def test_a_fault_far_down_is_found_in_its_line(cell: str, expected: str) -> None:
    cells = ["1.5"] * (2 * ROWS)
    cells[8000] = cell
    with pytest.raises(BadFile, match=expected):
        CsvTable(written(cells), "t.csv").numbers("a", smallest=-5.0)


def test_plain_numbers_take_the_fast_way(monkeypatch: pytest.MonkeyPatch) -> None:
    text = written(numbers())
    monkeypatch.setattr(table, "_plain", lambda cell: pytest.fail(f"{cell} one by one"))
    assert len(CsvTable(text, Path("t.csv")).numbers("a")) == ROWS


def test_rows_in_another_order_keep_their_lines() -> None:
    read = CsvTable("a\n3\n\n2\n1\n", "t.csv")
    read.reorder(np.array([2, 1, 0]))
    assert read.numbers("a").tolist() == [1.0, 2.0, 3.0]
    assert read.text("a") == ["1", "2", "3"]
    assert read.lines == [5, 4, 2]
