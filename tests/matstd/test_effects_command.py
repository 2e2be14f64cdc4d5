"""`matstd effects`: complete, legible at 80 columns, quick, without scipy."""

import subprocess
import sys
from pathlib import Path

import pytest

import matstd.twin.library.catalogue as library
from matstd.cli import main


@pytest.fixture(autouse=True)
def eighty_columns(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")


def test_every_kind_with_formula_units_size_and_source(answer) -> None:
    words = "".join(answer(["effects"]).split())
    for kind in library.kinds():
        for text in (kind.usage, kind.summary, kind.formula, kind.units, kind.typical, kind.source):
            assert "".join(text.split()) in words


def test_lines_fit_the_console(capsys) -> None:
    main(["effects"])
    assert max(len(line) for line in capsys.readouterr().out.splitlines()) <= 80


def test_unknown_kind_is_one_line(refusal) -> None:
    error = refusal(["effects", "flux", "capacitor"])
    assert error.count("\n") == 1
    assert error.startswith(
        "matstd effects: unknown kind 'flux capacitor'; available: geometric, location"
    )


def test_own_effects_stand_in_the_table(answer, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(
        "from matstd.twin.model import Kind\n"
        "MINE = Kind('hose', '', 'EYZ = a X^2', 'a: µm', '5 µm', 'ours',\n"
        "            lambda chain, arguments: None, lambda touches: [])\n",
        encoding="utf-8",
    )
    assert "EYZ = a X^2" in answer(["effects", "--effects", str(file)])


def test_a_file_that_fails_is_one_line(refusal, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text("1/0\n", encoding="utf-8")
    assert "found ZeroDivisionError: division by zero" in refusal(
        ["effects", "--effects", str(file)]
    )


def test_no_scipy_is_loaded() -> None:
    code = (
        "import sys; from matstd.cli import main; main(['effects']); "
        "sys.exit('scipy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    assert done.returncode == 0
