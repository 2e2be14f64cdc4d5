"""The tutorial is a session that runs, command by command, in an empty folder."""

import re
import shlex
from pathlib import Path

import pytest

from matstd.cli import _parser, main

PAGE = Path(__file__).parents[1] / "docs" / "tutorial.md"


def commands() -> list[list[str]]:
    """Words of every command of the page, without `matstd`."""
    lines = re.findall(r"^\$ matstd (.*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return [shlex.split(line) for line in lines]


@pytest.mark.parametrize("words", commands(), ids=lambda words: words[0])
def test_every_command_is_one_that_the_command_line_reads(words):
    assert _parser(words).parse_args(words).command == words[0]


@pytest.mark.slow
def test_the_session_ends_with_tables_for_the_control(tmp_path, monkeypatch, capsys):
    """The effect that was planted is found, and the tables are written."""
    monkeypatch.chdir(tmp_path)
    for words in commands():
        assert main(words) == 0, words
        if words[0] == "diagnose":
            assert "thermal-lag(EZ" in capsys.readouterr().out
    assert list(Path("mine/tables").rglob("*.csv"))
