"""`matstd sensitivity PROJECT.toml`: a whole study as a folder, and one line on bad input."""

from functools import partial
from pathlib import Path

import pytest

from matstd.sensitivity import montecarlo

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def project(tmp_path):
    text = (EXAMPLES / "hsm600u.toml").read_text(encoding="utf-8")
    machine = (EXAMPLES / "hsm600u-machine.toml").as_posix()
    text = text.replace("hsm600u-machine.toml", machine, 1).replace("poses = 2000", "poses = 100")
    path = tmp_path / "p.toml"
    path.write_text(text.replace("draws = 2000", "draws = 300"), encoding="utf-8")
    return path


def add(project, text):
    project.write_text(project.read_text(encoding="utf-8") + text, encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('\n[[errors.groups]]\nnames = ["EXX"]\n', "two errors at least"),
        (
            '\n[errors.correlation]\nnames = ["EXX", "EYX", "EZX"]\n'
            "matrix = [[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]]\n",
            "not positive semidefinite",
        ),
        ('\n[errors.shapes]\nEC0Y = { shapes = ["linear"] }\n', "it is a constant"),
        ('\n[errors.shapes]\nEXX = { shapes = ["linear"], weights = [1, 2] }\n', "weights"),
    ],
)
def test_errors_that_no_machine_can_have_are_one_line(project, tmp_path, refusal, text, words):
    add(project, text)
    line = refusal(["sensitivity", str(project), "-o", str(tmp_path / "out")])
    assert line.count("\n") == 1
    assert words in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--digits", "1"], "20480 or more"),
        (["--scheduler", "tcp://127.0.0.1:1"], "no answer within"),
        (["--draws", "5"], "montecarlo.draws"),
    ],
)
def test_settings_that_cannot_be_met_are_one_line(
    project, tmp_path, refusal, monkeypatch, options, words
):
    in_short = partial(montecarlo.cluster, answer=0.3)
    monkeypatch.setattr(montecarlo, "cluster", in_short)  # a scheduler has 5 s to answer
    line = refusal(["sensitivity", str(project), "-o", str(tmp_path / "out"), *options])
    assert line.count("\n") == 1
    assert words in line
    assert not (tmp_path / "out").exists()


def test_random_machines_need_a_project(tmp_path, refusal):
    machine, out = str(EXAMPLES / "hsm600u-machine.toml"), str(tmp_path / "out.csv")
    assert "followed by poses" in refusal(["sensitivity", machine, "-o", out])
    assert "--draws is for the random machines" in refusal(
        ["sensitivity", machine, "poses.csv", "-o", out, "--draws", "9"]
    )
