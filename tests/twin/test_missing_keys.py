"""One line for all that a table lacks, and for a table that stands in two places."""

from pathlib import Path

import pytest

from matstd.twin.errors import BadFile
from matstd.twin.files import read_errors, read_machine, read_run

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


def test_all_missing_keys_of_a_table_are_reported_at_once(tmp_path: Path) -> None:
    path = tmp_path / "machine.toml"
    path.write_text('format = "machine/1"\nname = "small"\n', encoding="utf-8")
    with pytest.raises(BadFile, match=r"file: found nothing for .* expected the keys chain, axis$"):
        read_machine(path)


def test_missing_keys_within_a_table_are_reported_with_its_name(machine: Path) -> None:
    run = machine.parent / "run.csv"
    head = '# format = "run/1"\n# machine = "machine.toml"\n# probe = {}\n'
    run.write_text(head + "X_mm\n1\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"probe: .* expected the keys radius_mm, length_mm$"):
        read_run(run)


def test_all_missing_columns_are_reported_at_once(machine: Path) -> None:
    run = machine.parent / "run.csv"
    head = '# format = "run/1"\n# machine = "machine.toml"\n'
    head += "# probe = { radius_mm = 3.0, length_mm = 100.0 }\n"
    run.write_text(head + "X_mm,px_mm,py_mm,pz_mm,nx,ny\n1,1,1,1,0,0\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"line 4: .* expected columns Y_mm, Z_mm, nz$"):
        read_run(run)


def test_an_error_that_stands_twice_is_reported_how_shapes_add_up(machine: Path) -> None:
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


def test_a_value_in_the_place_of_a_table_shows_the_table(machine: Path) -> None:
    errors = machine.parent / "errors.toml"
    errors.write_text('format = "errors/1"\nEBX = "abc"\n', encoding="utf-8")
    words = r"EBX: found 'abc', expected a table .* such as \[EBX\] and then amplitude = 12\.0$"
    with pytest.raises(BadFile, match=words):
        read_errors(errors, read_machine(machine))


def test_an_error_without_a_shape_is_no_error(machine: Path) -> None:
    errors = machine.parent / "errors.toml"
    errors.write_text('format = "errors/1"\nEXX = []\n', encoding="utf-8")
    with pytest.raises(BadFile, match=r"EXX: found \[\], expected .*\[EXX\] and then"):
        read_errors(errors, read_machine(machine))


def test_all_faults_of_a_file_are_one_line(machine: Path) -> None:
    text = MACHINE.replace("[-100.0, 0.0]", '"x"').replace("name =", "nam =")
    machine.write_text(text + "pitch = true\n[axis.B]\npoint = [1.0]\n", encoding="utf-8")
    with pytest.raises(BadFile) as caught:
        read_machine(machine)
    message = str(caught.value)
    assert "4 faults: nam: found an unknown key; did you mean name?" in message
    for where in ("axis.Z.range: found 'x'", "axis.Z.pitch: found true", "axis.B.point: found [1"):
        assert where in message
    assert "name: found nothing" not in message
    assert "\n" not in message


def test_of_many_faults_some_are_shown_and_the_rest_is_counted(machine: Path) -> None:
    machine.write_text(MACHINE + "a = 1\nb = 1\nc = 1\nd = 1\ne = 1\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"5 faults: axis\.Z\.a: .*; and 1 more$"):
        read_machine(machine)


def test_a_number_is_expected_with_its_range_unit_and_an_example(machine: Path) -> None:
    run = machine.parent / "run.csv"
    head = '# format = "run/1"\n# machine = "machine.toml"\n'
    head += '# probe = { radius_mm = "3", length_mm = 100.0 }\n'
    run.write_text(head + "X_mm\n1\n", encoding="utf-8")
    words = r"radius_mm: found '3', expected a number from 0 to \d+ mm, such as 3\.0 \(radius of"
    with pytest.raises(BadFile, match=words):
        read_run(run)
