"""What a machine file leaves open is said by every command that goes on without it."""

from pathlib import Path

import pytest

from matstd.cli import main

MACHINE = """\
format = "machine/1"
name = "bare"
chain = "[w C' B' X' f Y Z (C1) t]"
[axis.X]
range = [-200.0, 200.0]
[axis.Y]
range = [-200.0, 200.0]
[axis.Z]
range = [-300.0, 0.0]
[axis.B]
range = [-90.0, 20.0]
point = [0.0, 0.0, -300.0]
[axis.C]
range = [-180.0, 180.0]
"""
POSES = "X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm\n10,20,-100,0,30,160\n"
LINE = (
    "- axis C has no point in the machine file: it is assumed to turn about a line through the "
    "origin"
)


@pytest.fixture
def place(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("machine.toml").write_text(MACHINE)
    Path("errors.toml").write_text(
        'format = "errors/1"\n[EXX]\nshape = "linear"\namplitude = 1.0\n'
    )
    Path("poses.csv").write_text(POSES)
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        ["volumetric", "machine.toml", "errors.toml", "poses.csv", "-o", "out.csv"],
        ["sensitivity", "machine.toml", "poses.csv", "-o", "out.csv"],
    ],
)
def test_tables_say_it(place, answer, words) -> None:
    assert LINE in answer(words)


@pytest.mark.slow
def test_a_study_says_it_on_the_console_and_on_its_page(place, answer) -> None:
    project = 'format = "project/1"\nseed = 1\nmachine = "machine.toml"\n[workspace]\nposes = 500\n'
    project += "[montecarlo]\ndraws = 100\n[probe]\nradius_mm = 3.0\nlength_mm = 160.0\n"
    Path("project.toml").write_text(project)
    assert answer(["sensitivity", "project.toml", "-o", "out"]).startswith(LINE)
    assert LINE.removeprefix("- ") in Path("out/report.html").read_text(encoding="utf-8")


def test_a_refused_design_says_it_first(place, capsys) -> None:
    project = 'format = "project/1"\nseed = 1\nmachine = "machine.toml"\n'
    project += "[probe]\nradius_mm = 3.0\nlength_mm = 160.0\n"
    project += "[blank]\nbase_mm = [280.0, 280.0]\nheight_mm = 220.0\n"
    project += "[setup.a]\norigin_mm = [5000.0, 0.0, 0.0]\n"
    Path("project.toml").write_text(project)
    assert main(["design", "project.toml", "-o", "out"]) == 2
    assert capsys.readouterr().out.startswith(LINE)
