"""The border: what is read comes out in base units; every fault is one clear line."""

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from matstd.twin.effects import ComponentError
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import (
    errors_toml,
    read_errors,
    read_machine,
    read_poses,
    read_run,
    write_whole,
)
from matstd.twin.machine import Axis, make_chain
from matstd.twin.units import DEG, UM, URAD

MACHINE = """format = "machine/1"
name = "test"
chain = "[w C' B' X' f Y Z (C1) t]"
[axis.X]
range = [-400.0, 400.0]
[axis.B]
range = [-110.0, 30.0]
point = [0.0, 0.0, -420.0]
[axis.C]
range = [-360.0, 360.0]
[axis.Y]
range = [-300.0, 300.0]
[axis.Z]
range = [-500.0, 0.0]
[workpiece]
origin = [0.0, 0.0, -500.0]
"""
RUN = '# format = "run/1"\n# machine = "machine.toml"\nX_mm,Y_mm\n1,2\n'
ERRORS = """format = "errors/1"
[EXX]
shape = "linear"
amplitude = 12.0
[EC0Y]
amplitude = 15.0
[[EXC]]
shape = "sinusoidal"
amplitude = 10.0
periods = 2
phase_deg = 30.0
[[EXC]]
shape = "constant"
amplitude = 1.0
"""


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE)
    return path


def test_machine_in_base_units(machine: Path) -> None:
    chain = read_machine(machine)
    assert chain.axes == ("C", "B", "X", "Y", "Z", "C1")
    assert chain.programmed_axes == ("C", "B", "X", "Y", "Z")
    assert chain.link("B").range == (-110.0 * DEG, 30.0 * DEG)
    assert chain.table_origin.tolist() == [0.0, 0.0, -500.0]
    assert len(chain.symbols) == 71
    assert {chain.link(end).range for end in "wt"} == {(0.0, 0.0)}  # neither moves


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("[axis.B]", "[axis.Q]", r"axis\.Q: found an unknown axis, expected one of C, B, X, Y, Z"),
        ("f Y Z", "f Y Q", "chain: found unknown axis 'Q'"),
        ("C' B' X' f Y Z (C1) t", "C' B' X' f Y Z (C1 t", r"chain: found unknown axis '\(C1'"),
        ("[-300.0, 300.0]", "[300.0, -300.0]", r"axis\.Y\.range.*smaller reading first"),
        ("[-300.0, 300.0]", "[nan, 300.0]", r"axis\.Y\.range: found \[nan, 300\.0\]"),
        ("[-300.0, 300.0]", '["a", 300.0]', r"axis\.Y\.range"),
        ("[-300.0, 300.0]", "[-300.0]", r"axis\.Y\.range"),
        ("point", "pivot", r"axis\.B\.pivot: found an unknown key"),
        ("C' B' X' f Y", "C' B' X f Y", r"chain: found axis 'X' on the workpiece side.*a prime"),
        ("C' B' X' f Y Z", "C' C' X' f Y Z", "chain: found axis 'C' twice"),
        ('"machine/1"', '"machine/2"', 'format.*expected "machine/1"'),
        ("[-500.0, 0.0]", "[-500.0, 0.0", "TOML"),
        ("[-500.0, 0.0]", "[−500.0, 0.0]", "TOML file and - for a minus sign: "),
        ("[axis.Z]\nrange = [-500.0, 0.0]\n", "", r"axis\.Z\.range: found nothing"),
        (
            "[axis.Z]\n",
            "[axis.Z]\ndirection = [1.0, 0.0, 0.0]\n",
            "axis: found directions of X, Y, Z that lie in one plane",
        ),
        (
            "[axis.Z]\n",
            "[axis.Z]\ndirection = [0.0, 0.0, 0.0]\n",
            r"axis\.Z\.direction: found a vector of length 0",
        ),
        ("[-500.0, 0.0]", "[-2e6, 0.0]", r"axis\.Z\.range.*2 numbers within ±1000000"),
        (
            "point = [",
            "point = [1e7, 0.0, 0.0] # [",
            r"axis\.B\.point: .*3 numbers within ±1000000",
        ),
        ("[-500.0, 0.0]", "[-500.0, 0.0, 3.0]", r"axis\.Z\.range: .*such as \[-200\.0, 200\.0\]"),
        ("[-500.0, 0.0]", "[-500.0]", r"axis\.Z\.range: found \[-500\.0\].*2 numbers"),
        ("point = [", "point = 1e9 # [", r"axis\.B\.point.*3 numbers"),
        ("[axis.Z]\n", f"[axis.Z]\nrange = [{'9' * 5000}, 0]\n", "line .*fewer digits"),
        ("[axis.Z]\n", f"[axis.Z]\nrange = {'[' * 5000}\n", "brackets nested without end"),
    ],
)
def test_bad_machine(machine: Path, old: str, new: str, expected: str) -> None:
    assert old in MACHINE
    machine.write_text(MACHINE.replace(old, new))
    with pytest.raises(BadFile, match=expected) as caught:
        read_machine(machine)
    assert str(machine) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_axes_of_one_direction_are_no_fault() -> None:
    """W beside Z, as on a boring mill, and a slanted Y: three directions are spanned."""
    axes = {a: Axis((-100.0, 100.0)) for a in "XZW"}
    axes["Y"] = Axis((-100.0, 100.0), None, (0.0, 0.7, 0.7))
    assert len(make_chain("mill", "[w X' f Y Z W t]", axes).linear_axes) == 4


def test_missing_and_cut_off(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no such file"):
        read_machine(tmp_path / "none.toml")
    cut = tmp_path / "cut.toml"
    cut.write_text(MACHINE[: len(MACHINE) // 3])
    with pytest.raises(BadFile):
        read_machine(cut)


def test_errors_in_base_units_and_back(machine: Path, tmp_path: Path) -> None:
    chain = read_machine(machine)
    path = tmp_path / "errors.toml"
    path.write_text(ERRORS)
    errors = read_errors(path, chain)
    assert [e.name for e, _ in errors][:2] == ["geometric(EXX,linear)", "location(EC0Y)"]
    assert [float(t[0]) for _, t in errors] == [12 * UM, 15 * URAD, 10 * UM, 1 * UM]
    sine = errors[2][0]
    assert isinstance(sine, ComponentError)
    assert (sine.periods, sine.phase) == (2.0, 30.0 * DEG)
    again = tmp_path / "again.toml"
    again.write_text(errors_toml(errors))
    for (e, t), (f, s) in zip(errors, read_errors(again, chain), strict=True):
        assert e.name == f.name
        assert t == pytest.approx(s, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("[EXX]", "[EXQ]", "EXQ: found an unknown error name"),
        ("[EXX]", "[EX0Y]", "unknown error name"),  # displacing a linear axis along Y says nothing
        ("[EC0Y]", "[EC0Y]\nshape = 'linear'", "an amplitude alone"),
        ('"linear"\n', '"cubic"\n', r"EXX\.shape"),
        ('shape = "linear"\n', "", r"EXX\.shape: found nothing"),
        (
            '[EXX]\nshape = "linear"\namplitude = 12.0',
            "EXX = 3",
            "a table with the keys shape, ampl",
        ),
        ("12.0", "nan", r"EXX\.amplitude: found nan, expected a number"),
        ("12.0", "'12'", r"EXX\.amplitude"),
        ("12.0", "9" * 400, r"EXX\.amplitude"),
        ("12.0", "1e9", r"EXX\.amplitude.*1000000"),
        ("12.0", "1e300", r"line \d: found 1e300, expected numbers below 1e\+18"),
        ("periods = 2", "periods = 0", r"EXC\[0\]\.periods.*a number above 0"),
        ("amplitude = 12.0", "amplitudes = 12.0", "EXX"),
        ("amplitude = 12.0", "amplitude = 12.0\nphase_deg = 3.0", "only with shape"),
    ],
)
def test_bad_errors(machine: Path, tmp_path: Path, old: str, new: str, expected: str) -> None:
    path = tmp_path / "errors.toml"
    path.write_text(ERRORS.replace(old, new))
    with pytest.raises(BadFile, match=expected):
        read_errors(path, read_machine(machine))


def test_errors_in_mm_are_refused_where_the_largest_says_so(machine: Path, tmp_path: Path) -> None:
    path, small = tmp_path / "errors.toml", ERRORS.replace("12.0", "0.012")
    path.write_text(small)  # EXX small beside 10 µm of EXC: a good axis
    read_errors(path, read_machine(machine))
    path.write_text(small.replace("10.0", "0.01").replace("1.0", "0.001"))
    with pytest.raises(BadFile, match=r"EXX\.amplitude: found 0\.012, .*is it in mm\?"):
        read_errors(path, read_machine(machine))


def test_an_amplitude_that_looks_like_mm_may_be_confirmed(machine: Path, tmp_path: Path) -> None:
    path, chain = tmp_path / "errors.toml", read_machine(machine)
    keys = '[EYY]\nshape = "linear"\namplitude = 0.06\n'
    path.write_text(f'format = "errors/1"\n{keys}')
    words = (
        r'EYY\.amplitude: found 0\.06, .*mm\? \(if it is meant: (confirmed = \["EYY.amplitude"\])'
    )
    with pytest.raises(BadFile, match=words) as refusal:
        read_errors(path, chain)
    line = re.findall(words, str(refusal.value))[0]
    path.write_text(f'format = "errors/1"\n{line}\n{keys}')
    ((_, theta),) = read_errors(path, chain)
    assert theta == pytest.approx([0.06e-3])
    path.write_text(f'format = "errors/1"\n{line}\n{keys.replace("0.06", "6.0")}')
    with pytest.raises(BadFile, match=r"confirmed: found 'EYY\.amplitude', .*: none is"):
        read_errors(path, chain)


def test_poses(machine: Path, tmp_path: Path) -> None:
    path = tmp_path / "poses.csv"
    path.write_text("X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm\n100,50,-200,-90,0,160\n")
    q, length = read_poses(path, read_machine(machine))
    assert q == pytest.approx(np.array([[0.0, -90 * DEG, 100.0, 50.0, -200.0, 0.0]]))
    assert length.tolist() == [160.0]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("X_mm,Y_mm,Z_mm,B_deg\n1,2,-3,4\n", "line 1.*a column C_deg"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n1,2,-3,4,nan\n", "line 2, column C_deg.*finite"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n1,2,-3,4,\n", "line 2, column C_deg.*a number"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n1_0,2,-3,4,5\n", "line 2, column X_mm: found '1_0'"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n\u0661,2,-3,4,5\n", "line 2, column X_mm.*a number"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n1,2,-3,4,5\n1,2\n", "line 3: found 2 cells"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg,D\n1,2,-3,4,5,6\n", "line 1: found column 'D'"),
        ("X_mm,X_mm,Y_mm,Z_mm,B_deg,C_deg\n1,1,2,-3,4,5\n", "column X_mm twice"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n900,2,-3,4,5\n", "line 2, column X_mm: found 900.*travel"),
        ("X_mm,Y_mm,Z_mm,B_deg,C_deg\n", "no rows"),
        ("", "column names"),
    ],
)
def test_bad_poses(machine: Path, tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "poses.csv"
    path.write_text(text)
    with pytest.raises(BadFile, match=expected):
        read_poses(path, read_machine(machine))


def test_a_folder_in_the_way_of_an_output_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "out.csv").mkdir()
    with pytest.raises(DesignError, match=r"out\.csv: cannot be written"):
        write_whole(tmp_path / "out.csv", "text")
    assert [p.name for p in tmp_path.iterdir()] == ["out.csv"]


@pytest.mark.parametrize(
    ("read", "text", "expected"),
    [
        (read_machine, ERRORS, 'found a file of errors, expected a machine file, "machine/1"'),
        (read_machine, RUN, 'found a run file, expected a machine file, "machine/1"'),
        (
            partial(read_errors, chain=None),
            MACHINE,
            'found a machine file, expected a file of errors, "errors/1"',
        ),
        (
            read_run,
            f"# my notes\n{MACHINE}",
            "found a machine file, expected a run file, .* import",
        ),
        (read_run, "X,Y\n1,2\n", "line 1: found 'X,Y', expected a head that begins .* import"),
        (read_machine, MACHINE.replace("[axis.B]", "[axis.B"), "line 6: found '.axis.B', expected"),
    ],
)
def test_a_file_of_another_kind_is_named_as_what_it_is(read, text, expected, tmp_path):
    """Whether or not it is TOML; a damaged file of the right kind has its line instead."""
    path = tmp_path / "given.toml"
    path.write_text(text)
    with pytest.raises(BadFile, match=expected):
        read(path)
