"""Every command ends with the next one, which the command line understands."""

import shlex
from pathlib import Path

import pytest

from matstd.cli import COMMANDS, _parser, main
from matstd.next_steps import _AFTER, WITHOUT, next_line

CALLS = {
    "design": "project.toml -o OUT",
    "sensitivity": "project.toml -o STUDY",
    "calibrate": "standard.toml --points cmm.csv -o calibrated.toml",
    "uncertainty": "a.csv b.csv --standard s.toml -o u.json",
    "simulate": "MS_A_1.H --standard s.toml --machine m.toml -o run.csv",
    "control-test": "OUT -o tested",
    "evaluate": "MS_A_1.TXT --standard s.toml --machine m.toml -o run.csv",
    "replan": "LOG.TXT --design OUT -o again",
    "import": "laser.xlsx --positioning X -o run.csv",
    "compare": "run.csv -o OUT",
    "learn": "run.csv -o OUT",
    "thermal": "LOG.csv -o OUT",
    "compensate": "model.toml --tables DIR --tool-length 160",
    "contributions": "model.toml --tool-length 160 --program part.H -o OUT",
    "volumetric": "m.toml e.toml poses.csv -o table.csv",
    "show": "m.toml -o page.html",
    "new": "project -o project.toml",
}
"""A call of every command that has a next one."""


def parsed(words: list[str]):
    return _parser(words).parse_args(words)


def test_every_command_has_a_next_one_or_a_reason() -> None:
    assert _AFTER.keys() | WITHOUT.keys() >= COMMANDS.keys()
    assert not _AFTER.keys() & WITHOUT.keys()
    assert _AFTER.keys() == CALLS.keys()


@pytest.mark.parametrize("command", CALLS)
def test_the_next_command_is_one_that_the_command_line_reads(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text("", encoding="utf-8")
    Path("m.toml").write_text("", encoding="utf-8")
    Path("STUDY").mkdir()
    args = parsed([command, *shlex.split(CALLS[command])])
    line = next_line(args)
    assert line.startswith("next: matstd ")
    words = shlex.split(line.removeprefix("next: matstd ").partition("   (")[0])
    assert parsed(words).command in COMMANDS


def test_what_the_command_found_decides(tmp_path) -> None:
    args = parsed(["diagnose", "run.csv", "-o", "OUT"])
    assert next_line(args) == ""
    args.next = ("matstd compensate OUT/model.toml", "tables for the control")
    assert next_line(args) == "next: matstd compensate OUT/model.toml   (tables for the control)"


def test_the_line_stands_at_the_end(tmp_path, capsys) -> None:
    path = tmp_path / "a b.toml"
    assert main(["new", "machine", "-o", str(path)]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    beside = tmp_path / "project.toml"
    assert last == f"next: matstd new project --machine '{path}' -o {beside}"
    assert main(["new", "machine"]) == 0
    assert "next:" not in capsys.readouterr().out
