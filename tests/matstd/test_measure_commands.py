"""compare and diagnose as a user meets them: models of other machines, of the same run, full disks.

The run is that of a three-axis machine with a reversal of Y, made by the simulator of the oracles.
"""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from run_text import every
from simulator_case import simulate_case

from matstd.cli import main
from matstd.diagnosis.files import read_model
from matstd.twin.files import read_run
from matstd.twin.units import UM

BAD = 2
SAME_U = 0.1
"""Touches that count twice would make an uncertainty smaller by 30 %."""

NARROW = ["--only", "backlash", "--no-report", "--no-learn"]
"""Where it does not matter what else might be found: half the time of a diagnosis."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """run.csv, machine.toml, and a model that was learnt from that run with the effect added."""
    place = tmp_path_factory.mktemp("measured")
    run, machine, _ = simulate_case(
        np.random.default_rng(21), "hmc1995", ("backlash(Y)",), with_alike=False
    )
    (place / "run.csv").write_text(every(2, run), encoding="utf-8")
    (place / "machine.toml").write_text(machine, encoding="utf-8")
    out = place / "added"
    out.mkdir()
    (out / "next_measurement_1.csv").write_text("of another day")
    (out / "notes.txt").write_text("mine")
    words = ["diagnose", str(place / "run.csv"), "--add", "backlash(Y)", *NARROW]
    assert main([*words, "-o", str(out), "--force"]) == 0
    return place


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('name = "hmc1995"', 'name = "next door"', "machine.name: found 'hmc1995', expected"),
        ("-375.0, 375.0", "-400.0, 375.0", "machine.axis.X.range: found [-375, 375]"),
        ("-150.0, -560.0", "-150.0, -561.0", "machine.workpiece.origin"),
    ],
)
def test_a_model_of_another_machine_is_refused(
    folder, tmp_path, capsys, old, new, expected
) -> None:
    machine = (folder / "machine.toml").read_text(encoding="utf-8")
    assert old in machine
    (tmp_path / "machine.toml").write_text(machine.replace(old, new, 1), encoding="utf-8")
    (tmp_path / "run.csv").write_text((folder / "run.csv").read_text(encoding="utf-8"))
    model = str(folder / "added" / "model.toml")
    for command in ("compare", "diagnose"):
        words = [command, str(tmp_path / "run.csv"), "--model", model, "-o", str(tmp_path / "o")]
        assert main(words) == BAD
        message = capsys.readouterr().err
        assert expected in message
        assert message.count("\n") == 1
    assert not (tmp_path / "o").exists()


def test_no_touch_counts_twice(folder, tmp_path, answer) -> None:
    """Begun with a model of the same run, the same estimates come out, not surer ones."""
    run, model = str(folder / "run.csv"), folder / "added" / "model.toml"
    again = tmp_path / "again"
    assert "learnt from this very run" in answer(
        ["diagnose", run, "--model", str(model), "-o", str(again), *NARROW]
    )
    first, second = read_model(model), read_model(again / "model.toml")
    u = [float(np.linalg.norm(m.estimates.root[-1])) for m in (first, second)]  # of the reversal
    assert u[1] == pytest.approx(u[0], rel=SAME_U)
    assert abs(second.estimates.mean[-1] - first.estimates.mean[-1]) < u[0]
    assert second.source.learnt_from == [read_run(run).fingerprint]
    words = ["compare", run, "--model", str(model), "-o", str(tmp_path / "c"), "--no-report"]
    assert "so the agreement is optimistic" in answer(words)


def test_a_model_says_what_it_rests_upon(folder, tmp_path) -> None:
    """A second run, here the first with another noise, makes the second revision."""
    lines = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    n = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    kept = [*lines[: n + 1], *lines[n + 1 :: 2]]
    (tmp_path / "half.csv").write_text("\n".join(kept) + "\n", encoding="utf-8")
    (tmp_path / "machine.toml").write_text((folder / "machine.toml").read_text(encoding="utf-8"))
    model = folder / "added" / "model.toml"
    words = ["diagnose", str(tmp_path / "half.csv"), "--model", str(model), *NARROW]
    assert main([*words, "-o", str(tmp_path / "o")]) == 0
    source = read_model(tmp_path / "o" / "model.toml").source
    assert source.revision == 2
    assert source.learnt_from == [
        read_run(folder / "run.csv").fingerprint,
        read_run(tmp_path / "half.csv").fingerprint,
    ]
    assert source.made_with.startswith("material-standard ")


@pytest.mark.parametrize(
    ("effects", "expected"),
    [
        (["backlash(Y)", "backlash( Y )"], "given twice"),
        (["artefact-form(nowhere)"], "has no effect at these touches"),
        (["location(EX0w)", "geometric(EXX,linear)"], "is already in the model"),
        (["backlash(Q)"], "an axis of X, Z, Y"),
        (["backlsh(Y)"], "did you mean backlash(Y)?"),
    ],
)
def test_effects_that_cannot_be_added(folder, tmp_path, capsys, effects, expected) -> None:
    words = ["diagnose", str(folder / "run.csv"), "--add", *effects, "-o", str(tmp_path / "o")]
    assert main(words) == BAD
    assert expected in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_named_effect_is_not_called_missing(folder, tmp_path, answer) -> None:
    words = ["diagnose", str(folder / "run.csv"), "--add", "probe-radius", *NARROW]
    message = answer([*words, "-o", str(tmp_path / "o")])
    assert "The model lacks one effect: reversal of Y" in message
    assert "Added by name: effective radius of the ball" in message


def test_a_file_is_no_folder(folder, tmp_path, capsys) -> None:
    out = tmp_path / "precious.csv"
    out.write_text("mine")
    words = ["compare", str(folder / "run.csv"), "-o", str(out), "--force", "--no-report"]
    assert main(words) == BAD
    assert "is a file, expected a folder" in capsys.readouterr().err
    assert out.read_text() == "mine"


def test_old_plans_do_not_outlive_their_diagnosis(folder) -> None:
    names = sorted(p.name for p in (folder / "added").iterdir())
    assert names == ["diagnosis.json", "model.toml", "notes.txt"]


def test_a_full_disk_is_one_line(folder, tmp_path, capsys, monkeypatch) -> None:
    """While a picture is drawn, which is where most of the bytes go."""

    def full(figure: object, path: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("matstd.report.style.save", full)
    monkeypatch.setattr("matstd.report.layout.html.save", full)
    words = ["compare", str(folder / "run.csv"), "-o", str(tmp_path / "o")]
    assert main(words) == BAD
    message = capsys.readouterr().err
    assert message.endswith("o: cannot be written (No space left on device)\n")
    assert list(tmp_path.iterdir()) == []


def test_a_stopped_command_leaves_nothing_half_written(folder, tmp_path) -> None:
    """Of both signals and of several kinds of work: `test_stop`."""
    out = tmp_path / "o"
    words = ["-m", "matstd", "diagnose", str(folder / "run.csv"), "-o", str(out)]
    process = subprocess.Popen([sys.executable, *words], stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 60.0
    while not list(tmp_path.iterdir()) and time.monotonic() < until:
        time.sleep(0.02)  # until the working folder is there, so that there is something to tidy
    process.send_signal(signal.SIGTERM)
    message = process.communicate(timeout=60.0)[1]
    assert process.returncode == 130
    assert message.strip().endswith("stopped, and nothing half-written is left")
    assert list(tmp_path.iterdir()) == []


def test_json_and_words_name_a_region_alike(folder, tmp_path, capsys) -> None:
    """A run whose first half hour is lifted by 9 um: columns in the file, words on the console."""
    lines = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    n = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    columns = lines[n].split(",")
    at = columns.index("time_s")
    rows = []
    for line, deviation in zip(lines[n + 1 :], read_run(folder / "run.csv").deviation, strict=True):
        lift = 9.0 if float(line.split(",")[at]) < 1800.0 else 0.0
        rows.append(f"{line},{lift + deviation / UM:.3f}")
    text = [*lines[:n], lines[n] + ",dev_um", *rows]
    (tmp_path / "lifted.csv").write_text("\n".join(text) + "\n", encoding="utf-8")
    (tmp_path / "machine.toml").write_text((folder / "machine.toml").read_text(encoding="utf-8"))
    out = tmp_path / "o"
    model = Path(folder / "added" / "model.toml")
    words = ["compare", str(tmp_path / "lifted.csv"), "--model", str(model), "--no-report"]
    assert main([*words, "-o", str(out)]) == 0
    saved = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert any("time_s" in region["region"] for region in saved["where"])
    assert "time < " in capsys.readouterr().out


LATE = '''"""Fails at one value of its inner parameter, which is not among those tried first."""
from dataclasses import dataclass, replace
import numpy as np
from matstd.twin.model import Inner, Parameter, Term, Where
from matstd.twin.model import Kind

@dataclass(frozen=True)
class Late:
    """Fails late."""
    place: float = 0.0
    name = kind = "late"
    parameters = (Parameter("size", "mm", 0.01),)
    def terms(self, touches):
        if 2.0 < self.place < 4.0:
            raise RuntimeError("no such place")
        bump = np.exp(-(((touches.reading("X") - self.place) / 50.0) ** 2))
        return (Term(0, Where("twist", touches.chain.link_index("Z"), 2), bump),)
    def inner(self, touches):
        return (Inner("place", "mm", np.array([0.0, 3.0, 5.0, 9.0, 20.0])),)
    def tuned(self, place):
        return replace(self, place=float(place))
    @property
    def tuning(self):
        return {"place": self.place}

LATE = Kind("late", "", "f", "u", "t", "s", lambda c, a: Late(), lambda t: (Late(),), (Late,))
'''


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", "late.py: line 15: found RuntimeError: no such place, expected a formula"),
        ("bump),)", "bump[1:]),)", "late.py: line 13, late: found an amount of shape"),
    ],
)
def test_a_users_formula_that_fails_is_a_line_of_his_file(
    folder, tmp_path, capsys, old, new, expected
) -> None:
    (tmp_path / "late.py").write_text(LATE.replace(old, new) if old else LATE, encoding="utf-8")
    words = ["diagnose", str(folder / "run.csv"), "--effects", str(tmp_path / "late.py")]
    assert main([*words, "-o", str(tmp_path / "o"), "--no-report"]) == BAD
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1
    assert not (tmp_path / "o").exists()


def test_copies_are_reported_where_few_touches_are_left(folder, tmp_path, capsys) -> None:
    lines = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    n = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    text = "\n".join([*lines[: n + 1], *[lines[n + 1]] * 50]) + "\n"
    (tmp_path / "run.csv").write_text(text, encoding="utf-8")
    (tmp_path / "machine.toml").write_text((folder / "machine.toml").read_text(encoding="utf-8"))
    assert main(["compare", str(tmp_path / "run.csv"), "-o", str(tmp_path / "o")]) == BAD
    message = capsys.readouterr().err
    assert "1 touch, expected at least 8" in message
    assert "49 rows stand twice" in message


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda t: t.replace("model/2", "model/0"), "files of other versions are not read"),
        (lambda t: t[: len(t) // 2], "expected a whole TOML file"),
        (lambda t: t.replace("amplitude_um", "amplitude_mm", 1), "estimate: found amplitude_mm"),
        (lambda t: t.replace('name = "backlash(Y)"', 'name = "backlsh(Y)"'), "did you mean backl"),
        (lambda t: t.replace("revision", "revison"), "unknown key; did you mean revision"),
    ],
)
def test_a_model_file_that_was_edited_badly_is_refused(
    folder, tmp_path, capsys, change, expected
) -> None:
    text = (folder / "added" / "model.toml").read_text(encoding="utf-8")
    assert change(text) != text
    (tmp_path / "model.toml").write_text(change(text), encoding="utf-8")
    words = ["compare", str(folder / "run.csv"), "--model", str(tmp_path / "model.toml")]
    assert main([*words, "-o", str(tmp_path / "o")]) == BAD
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1


@pytest.mark.parametrize("command", ["compare", "diagnose"])
def test_results_of_another_day_are_not_overwritten(folder, tmp_path, capsys, command) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main([command, str(folder / "run.csv"), "-o", str(tmp_path), "--no-report"]) == BAD
    assert "already exists; choose another folder or give --force" in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]
