"""One line for all that a table lacks, and for a table that stands in two places."""

from pathlib import Path

import pytest

from matstd.twin.errors import BadFile
from matstd.twin.files.error_file import read_errors
from matstd.twin.files.machine_file import read_machine
from matstd.twin.files.run_file import read_run

MACHINE = """format = "machine/1"
name = "small"
chain = "[w f X Y Z t]"
[axis.X]
range = [-100.0, 100.0]
[axis.Y]
range = [-100.0, 100.0]
[axis.Z]
range = [-100.0, 0.0]
"""


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE, encoding="utf-8")
    return path


def test_all_missing_keys_of_a_table_are_told_at_once(tmp_path: Path) -> None:
    path = tmp_path / "machine.toml"
    path.write_text('format = "machine/1"\nname = "small"\n', encoding="utf-8")
    with pytest.raises(BadFile, match=r"file: found nothing for .* expected the keys chain, axis$"):
        read_machine(path)


def test_missing_keys_within_a_table_are_told_with_its_name(machine: Path) -> None:
    run = machine.parent / "run.csv"
    head = '# format = "run/1"\n# machine = "machine.toml"\n# probe = {}\n'
    run.write_text(head + "X_mm\n1\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"probe: .* expected the keys radius_mm, length_mm$"):
        read_run(run)


def test_all_missing_columns_are_told_at_once(machine: Path) -> None:
    run = machine.parent / "run.csv"
    head = '# format = "run/1"\n# machine = "machine.toml"\n'
    head += "# probe = { radius_mm = 3.0, length_mm = 100.0 }\n"
    run.write_text(head + "X_mm,px_mm,py_mm,pz_mm,nx,ny\n1,1,1,1,0,0\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"line 4: .* expected columns Y_mm, Z_mm, nz$"):
        read_run(run)


def test_an_error_that_stands_twice_is_told_how_shapes_add_up(machine: Path) -> None:
    errors = machine.parent / "errors.toml"
    entry = '{}\nshape = "linear"\namplitude = 3.0\n'
    text = 'format = "errors/1"\n' + entry.format("[EXX]") + entry.format("[EXX]")
    errors.write_text(text, encoding="utf-8")
    chain = read_machine(machine)
    with pytest.raises(BadFile, match=r"line 5: found table \[EXX\] a second time, expected \[\["):
        read_errors(errors, chain)
    errors.write_text(text.replace("[EXX]", "[[EXX]]"), encoding="utf-8")
    assert len(read_errors(errors, chain)) == 2


def test_a_table_that_stands_twice_elsewhere_is_expected_once(machine: Path) -> None:
    machine.write_text(MACHINE + "[axis.X]\nrange = [0.0, 1.0]\n", encoding="utf-8")
    with pytest.raises(
        BadFile, match=r"line 10: found table \[axis\.X\] a second time, expected it"
    ):
        read_machine(machine)
