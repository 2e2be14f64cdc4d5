"""Process forces: by blocks of a program, and what loads cannot determine."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.cli import main
from matstd.compensation.field import MachineErrors, State, datum_of, deviation
from matstd.compensation.part_programs import Frame, read_loads, read_part_program
from matstd.compensation.part_programs.program import Load
from matstd.compensation.programs import compensated, passed
from matstd.compensation.tables import header_of
from matstd.twin.errors import BadFile
from matstd.twin.library import parse_effect
from matstd.twin.machine import Axis, make_chain
from matstd.twin.units import UM

PROGRAM = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 X50 F500\nG1 X100\nG1 Y50\nM30\n"
MACHINE = """format = "machine/1"
name = "m"
chain = "[w Y' f X Z t]"
[axis.X]
range = [-300, 300]
[axis.Y]
range = [-300, 300]
[axis.Z]
range = [-300, 300]
"""
RAM = "beam(Z,cantilever,180x180,at:500,sense:-1,mass:60,offset:0:200:0)"


@pytest.fixture(scope="module")
def errors():
    axes = {a: Axis(range=(-300.0, 300.0)) for a in "XYZ"}
    chain = make_chain("m", "[w Y' f X Z t]", axes)
    effect = parse_effect("stiffness(t)", chain)
    ram = parse_effect("stiffness(X)", chain)
    known = [(effect, np.array([1e-4, 0.0])), (ram, np.array([5e-5]))]
    return MachineErrors.of_errors(chain, known, State(force=(0.0, 0.0, 0.0)))


def test_a_load_bends_its_own_blocks_alone(errors, tmp_path):
    """50 nm/N of X and 200 N of cut in line 3: 10 um, taken back by the compensation."""
    path = tmp_path / "a.ngc"
    path.write_text(PROGRAM)
    datum = datum_of(errors.chain, {}, 100.0)
    program = read_part_program(path, Frame(errors.chain, datum))
    loaded = replace(program, loads=(Load(3, 3, (-200.0, 0.0, 0.0)),))
    at, _ = passed(loaded, errors)
    moved = deviation(errors, at)[:, 0] / UM
    lines = np.array([m.line for m in loaded.motions])
    assert set(np.round(moved, 6)) == {0.0, -10.0}
    done = compensated(loaded, errors, header_of(errors.chain, "m", datum, errors.state))
    np.testing.assert_allclose(done.before[lines[done.motion] == 3, 0] / UM, -10.0)
    assert np.abs(done.after).max() / UM < 0.6
    assert "X50.01" in done.text


def test_loads_are_read_by_line(tmp_path):
    path = tmp_path / "l.csv"
    path.write_text("first_line,last_line,Fx_N,Fy_N,Fz_N\n3,4,-200,0,50\n7,7,0,0,-30\n")
    assert read_loads(path)[1] == Load(7, 7, (0.0, 0.0, -30.0))


@pytest.mark.parametrize(
    ("rows", "words"),
    [("3,2,1,0,0", "3 or more"), ("3,5,1,0,0\n4,6,1,0,0", "no other row"), ("", "a row for every")],
)
def test_loads_that_make_no_sense_are_refused(tmp_path, rows, words):
    path = tmp_path / "l.csv"
    path.write_text(f"first_line,last_line,Fx_N,Fy_N,Fz_N\n{rows}\n")
    with pytest.raises(BadFile, match=words):
        read_loads(path)


def test_a_beam_is_added_on_the_command_line_and_a_short_one_is_reported(tmp_path, answer):
    (tmp_path / "m.toml").write_text(MACHINE)
    (tmp_path / "e.toml").write_text(
        'format = "errors/1"\n[EXX]\nshape = "linear"\namplitude = 5\n'
    )
    (tmp_path / "p.csv").write_text("X_mm,Y_mm,Z_mm,tool_length_mm\n0,0,-200,100\n0,0,200,100\n")
    asked = ["contributions", str(tmp_path / "m.toml"), "--errors", str(tmp_path / "e.toml")]
    asked += ["--tool-length", "100", "--poses", str(tmp_path / "p.csv")]
    out = tmp_path / "out"
    added = [f"--add={RAM}=weight=1", "--add=beam(X,supported,300x300,at:350,span:700)=weight=1"]
    said = answer([*asked, *added, "-o", str(out)])
    assert "beam(Z" in said
    assert "2.3 times as long as deep" in said
    assert main([*asked, "--add=beam(Q)", "-o", str(tmp_path / "no")]) == 2
