"""`matstd sensitivity` and `matstd volumetric`: numbers in, numbers out, one line on bad input."""

import csv

import pytest
from simulator_experiment import MACHINES

from matstd.cli import main

ERRORS = """format = "errors/1"
[EBX]
shape = "constant"
amplitude = 10.0
[EC0Y]
amplitude = 10.0
"""
POSES = "X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm\n100,50,-200,0,0,160\n100,50,-200,-90,0,160\n"


@pytest.fixture
def files(tmp_path):
    for name, text in (("m.toml", MACHINES["hsm600u"]), ("e.toml", ERRORS), ("p.csv", POSES)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def rows_of(path):
    with path.open(encoding="utf-8") as stream:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(stream)]


def run(command, files, *extra):
    machine, poses, out = (str(files / n) for n in ("m.toml", "p.csv", "out.csv"))
    errors = [str(files / "e.toml")] if command == "volumetric" else []
    return main([command, machine, *errors, poses, "-o", out, *extra])


def test_volumetric_writes_the_deviation(files):
    assert run("volumetric", files) == 0
    first, second = rows_of(files / "out.csv")
    # EBX 10 urad: -3.6, 0, -1.0 um; EC0Y 10 urad: -0.5 um in X (worked examples)
    assert first == pytest.approx({"dx_um": -4.1, "dy_um": 0.0, "dz_um": -1.0}, abs=1e-3)
    # at B = -90 machine directions read (-z, y, x) on the table
    assert second == pytest.approx({"dx_um": 1.0, "dy_um": 0.0, "dz_um": -4.1}, abs=1e-3)


def test_sensitivity_writes_a_column_a_parameter(files):
    assert run("sensitivity", files) == 0
    rows = rows_of(files / "out.csv")
    assert len(rows) == 2
    assert len(rows[0]) == 71
    assert rows[0]["EXX"] == pytest.approx(1.0)
    assert rows[0]["EC0Y"] == pytest.approx(0.05)  # 50 mm: um/urad
    assert rows[1]["EX0B"] == pytest.approx(2**0.5)


def test_an_output_is_not_overwritten_unasked(files, capsys):
    (files / "out.csv").write_text("mine", encoding="utf-8")
    assert run("sensitivity", files) == 2
    assert "--force" in capsys.readouterr().err
    assert (files / "out.csv").read_text(encoding="utf-8") == "mine"
    assert run("sensitivity", files, "--force") == 0
    assert len(rows_of(files / "out.csv")) == 2


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("p.csv", "B_deg", "A_deg", ["p.csv", "A_deg"]),
        ("p.csv", "100,50,-200,-90", "100,50,nan,-90", ["p.csv", "line 3", "Z_mm"]),
        ("p.csv", "100,50,-200,-90", "100,50,200,-90", ["p.csv", "line 3", "-500 to 0"]),
        ("p.csv", ",160\n100,50,-200,-90,0,160\n", "", ["p.csv", "line 2"]),
        ("e.toml", "EBX", "EQX", ["e.toml", "EQX"]),
        ("e.toml", "amplitude = 10.0\n[", "amplitude = \n[", ["e.toml"]),
        ("m.toml", "[-400.0, 400.0]", "[400.0, -400.0]", ["m.toml", "axis.X.range"]),
        ("m.toml", "C' B'", "C' Q'", ["m.toml", "Q'"]),
    ],
)
def test_bad_input_gets_one_line_and_leaves_nothing(files, capsys, name, old, new, words):
    path = files / name
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    assert run("volumetric", files) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    for word in words:
        assert word in line
    assert sorted(p.name for p in files.iterdir()) == ["e.toml", "m.toml", "p.csv"]
