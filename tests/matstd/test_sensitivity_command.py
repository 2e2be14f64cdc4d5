"""`matstd sensitivity PROJECT.toml`: a whole study as a folder, and one line on bad input."""

import csv
import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from unchanged import folded

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


def test_a_study_stands_in_a_folder_with_its_precision(
    project, tmp_path, answer, monkeypatch, unchanged
):
    """Without its maps, which `tests/sensitivity/test_study.py` and `tests/report` draw."""
    monkeypatch.setattr("matstd.stages.study_run.draw_maps", lambda *_: [])
    monkeypatch.setattr("matstd.report.pages.study_page.draw_study_volumes", lambda *_: [])
    add(project, '\n[[errors.groups]]\nnames = ["EXX", "-EYX"]\ncorrelation = 0.5\n')
    add(project, '[errors.shapes]\nEXX = { shapes = ["parabolic"] }\n')
    out = tmp_path / "out"
    said = answer(["sensitivity", str(project), "-o", str(out), "--tolerance-um", "300"])
    figures = json.loads((out / "montecarlo.json").read_text(encoding="utf-8"))
    assert figures["draws"] == 300
    assert figures["seed"] == "600/0.1"
    assert figures["achieved_um"] > 0.0
    assert figures["statement"] in said
    page = (out / "report.html").read_text(encoding="utf-8")
    assert figures["statement"] in page.replace(
        "\u00a0", " "
    )  # a page keeps number and unit together
    with (out / "trajectory.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {"X_mm", "p95_um", "exceedance", "errors_of_X_um", "errors_of_C_um"} <= set(rows[0])
    assert np.ptp([float(r["B_deg"]) for r in rows]) == pytest.approx(110.0, abs=0.1)
    for name in ("trajectory.png", "trajectory_X.png", "trajectory_C.png"):
        assert (out / name).stat().st_size > 4_000
    paths = sorted(p for p in out.rglob("*") if p.suffix in (".csv", ".json"))
    lines = [f"{p.name}\n{folded(p.read_text(encoding='utf-8'))}" for p in paths]
    unchanged("\n".join([folded(said), *lines]).replace(str(tmp_path), ""))


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
