"""`matstd show` from the command line: what it writes, and what it refuses in one line."""

from pathlib import Path

import pytest

import matstd
from matstd.cli import main

ROOT = Path(__file__).parents[2]
HSM = str(ROOT / "matstd" / "machines" / "hsm600u.toml")
ERRORS = str(ROOT / "matstd" / "machines" / "hsm600u-errors.toml")
ARM = """format = "machine/1"
name = "lathe"
chain = "[w (C') f Z X t]"
[axis.X]
range = [-100, 100]
[axis.Z]
range = [-300, 0]
"""


@pytest.fixture
def part(tmp_path):
    path = tmp_path / "part.ngc"
    path.write_text("G21 G90\nG0 X0 Y0 Z20\nG1 X60 F600\nM2\n")
    return path


def shown(tmp_path, *arguments, machine=HSM):
    out = tmp_path / "out.html"
    return main(["show", str(machine), *arguments, "-o", str(out)]), out


def test_a_machine_without_errors_lists_what_it_can_have(tmp_path, capsys):
    code, out = shown(tmp_path)
    assert code == 0
    said = capsys.readouterr().out
    assert "49 errors" in said  # 71 without eleven of the spindle and eleven of set-up
    assert "switch them on" in said
    assert "not to scale" in out.read_text(encoding="utf-8")
    # an earlier page is not overwritten unasked
    assert shown(tmp_path)[0] == 2
    assert "--force" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("program", "found"),
    [
        ("G21 G90\nG0 X0 Y0 Z20\nG1 A10 F600\nM2\n", "line 3"),
        ("G21 G90\nG0 X9000 Y0 Z20\nM2\n", "X at a reading of 9000.000"),
        ("G21 G90\nM2\n", "no motion from a known place"),
        ("STANDARD S SETUP 1\n", "line 1"),
    ],
)
def test_programs_that_the_machine_cannot_run(tmp_path, part, capsys, program, found):
    part.write_text(program)
    code, out = shown(tmp_path, "--program", str(part), "--datum", "Z=-400")
    said = capsys.readouterr().err
    assert (code, said.count("\n")) == (2, 1), said
    assert found in said
    assert not out.exists()


def test_a_program_on_a_machine_without_its_axes(tmp_path, part, capsys):
    machine = tmp_path / "lathe.toml"
    machine.write_text(ARM)
    code, out = shown(tmp_path, "--program", str(part), machine=machine)
    assert code == 2
    assert "programs need X, Y, Z" in capsys.readouterr().err
    assert not out.exists()
    assert shown(tmp_path, machine=machine)[0] == 0  # the machine itself moves


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["--tool-length", "-1"], "--tool-length '-1'|--tool-length -1"),
        (["--standard", "standard.toml"], "--standard"),
        (["--model", HSM], "format"),
        (["--datum", "Q=1"], "Q"),
        (["--add", "nonsense=1um"], "nonsense"),
        (["--program", "missing.ngc"], "missing.ngc"),
    ],
)
def test_options_that_make_no_sense(tmp_path, capsys, arguments, found):
    import re

    code, out = shown(tmp_path, *arguments)
    said = capsys.readouterr().err
    assert code == 2, said
    assert said.count("\n") == 1
    assert re.search(found, said), said
    assert not out.exists()


def test_a_page_shows_itself_in_a_notebook():
    page = matstd.show(HSM, ERRORS)
    assert page._repr_html_().startswith("<iframe")
    assert "Mikron HSM 600U" in repr(page)


def test_errors_and_model_do_not_go_together():
    with pytest.raises(matstd.BadArgument, match="only one of"):
        matstd.show(HSM, ERRORS, model=ERRORS)
