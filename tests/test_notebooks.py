"""Notebooks run from top to bottom, and say what stands under their cells."""

import json
import re
from pathlib import Path

import pytest
from notebook import answers, cells, stored

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PLATFORM = 2e-2
"""Rounding of one linear algebra library or another, seen through searches and p-values."""


def test_there_is_one():
    assert NOTEBOOKS


FEW = 3
"""Cells that are run by every test run: the run and its comparison."""


@pytest.mark.parametrize("most", [FEW, pytest.param(None, marks=pytest.mark.slow)])
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_cells_say_what_stands_under_them(path, most):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    anew = f"python tests/fixtures/notebook.py {path.relative_to(ROOT)} writes it anew"
    for cell, found in zip(cells(notebook)[:most], answers(path, most), strict=True):
        for said, says in zip(stored(cell), found, strict=True):
            assert NUMBER.split(said) == NUMBER.split(says), anew
            numbers = [float(n) for n in NUMBER.findall(said)]
            now = [float(n) for n in NUMBER.findall(says)]
            large = [n for n in numbers if abs(n) > 1e-6]  # a p-value is not known to its digits
            assert [n for n in now if abs(n) > 1e-6] == pytest.approx(large, rel=PLATFORM), anew
