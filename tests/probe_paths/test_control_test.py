"""`matstd control-test`: one line where it cannot; where LinuxCNC is installed, the whole proof."""

import json
import os
import shutil

import numpy as np
import pytest
from programs import stand_in

from matstd.artefact.body import write_standard
from matstd.artefact.tool import Probe
from matstd.cli import main
from matstd.probe_paths.campaign import evaluate
from matstd.probe_paths.control import read_log
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.linuxcnc import session as session_module
from matstd.probe_paths.plan import PlanOptions, plan_touches
from matstd.twin.units import UM

LINUXCNC = shutil.which("linuxcnc")
LATCH = 0.2 * UM
"""12 mm/min in one period of 1 ms."""

NOISE = 0.2 * UM

MACHINE = """\
format = "machine/1"
name = "trunnion"
chain = "[w C' B' X' f Y Z (C1) t]"
axis.X.range = [-400.0, 400.0]
axis.Y.range = [-300.0, 300.0]
axis.Z.range = [-500.0, 0.0]
axis.B = { range = [-110.0, 30.0], point = [0.0, 0.0, -420.0] }
axis.C = { range = [-360.0, 360.0], point = [0.0, 0.0, 0.0] }
workpiece.origin = [0.0, 0.0, -500.0]
"""


@pytest.fixture(scope="module")
def design(golden, small, tmp_path_factory):
    """What `matstd design` leaves of the small standard, with some 300 touches for an iTNC."""
    out = tmp_path_factory.mktemp("design")
    wanted = golden.requests(small, 12)
    options = PlanOptions(tolerated=20)
    plan = plan_touches(small, golden.machine(), Probe(), golden.setup(), wanted, options)
    make_programs(plan).write(out / "programs")
    write_standard(out / "standard.toml", small)
    (out / "machine.toml").write_text(MACHINE)
    return out


def as_user(folder, monkeypatch, script):
    """A command that is called like the control, started by an ordinary user."""
    stand_in(folder, monkeypatch, script)
    monkeypatch.setattr(session_module.os, "geteuid", lambda: 12345)


def refused(capsys, *arguments):
    """The one line of a refusal."""
    assert main(["control-test", *map(str, arguments)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def test_a_control_that_is_not_installed_is_one_line(design, capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    error = refused(capsys, design, "-o", tmp_path / "out")
    assert "LinuxCNC is not installed here" in error
    assert "docs/controls.md" in error
    assert not (tmp_path / "out").exists()


def test_a_control_that_dies_leaves_its_log_and_one_line(design, capsys, monkeypatch, tmp_path):
    script = "echo MATSTD LOG 1 > MS_A_1.TXT; echo segmentation error >&2; kill -9 $$"
    as_user(tmp_path / "bin", monkeypatch, script)
    out = tmp_path / "out"
    error = refused(capsys, design, "-o", out, "--touches", 10)
    expected = f"LinuxCNC died in MS_A_1.ngc: segmentation error; what was logged is kept in {out}"
    assert expected in error
    assert (out / "MS_A_1.TXT").read_text() == "MATSTD LOG 1\n"
    assert not (out / "run.csv").exists()


def test_no_file_is_overwritten_without_being_asked(design, capsys, monkeypatch, tmp_path):
    as_user(tmp_path / "bin", monkeypatch, "exit 0")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine").write_text("x")
    assert "already exists" in refused(capsys, design, "-o", tmp_path / "out")
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["mine"]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--touches", "0"], "0 touches: expected at least 1"),
        (["--noise-um", "-1"], "expected noise from 0 to 1000"),
        (["--add", "backlash(Q)=10um"], "Q"),
    ],
)
def test_bad_options_are_one_line(options, reason, design, capsys, monkeypatch, tmp_path):
    as_user(tmp_path / "bin", monkeypatch, "exit 0")
    assert reason in refused(capsys, design, "-o", tmp_path / "out", *options)


def test_a_folder_without_programs_is_one_line(capsys, monkeypatch, tmp_path, design):
    as_user(tmp_path / "bin", monkeypatch, "exit 0")
    bare = tmp_path / "bare"
    shutil.copytree(design, bare)
    shutil.rmtree(bare / "programs")
    assert "no program" in refused(capsys, bare, "-o", tmp_path / "out")


def ordinary_user():
    """Options that let LinuxCNC run here: root needs somebody else for it."""
    import pwd

    if os.geteuid() != 0:
        return []
    others = [u.pw_name for u in pwd.getpwall() if 1000 <= u.pw_uid < 60000]
    return ["--user", others[0] if others else "nobody"]


@pytest.mark.slow
@pytest.mark.skipif(LINUXCNC is None, reason="LinuxCNC is not installed")
def test_a_hidden_effect_is_named_from_the_controls_own_log(design, golden, small, chain, tmp_path):
    """64 touches on LinuxCNC, the twin with 10 µm of backlash as its machine.

    The model is learnt before, by virtual probing of the whole programs without the effect.
    """
    standard, machine = str(design / "standard.toml"), str(design / "machine.toml")
    texts = [str(p) for p in sorted((design / "programs").glob("*.H"))]
    probing = ["--standard", standard, "--machine", machine, "--noise-um", "0.2"]
    assert main(["simulate", *texts, *probing, "-o", str(tmp_path / "known.csv")]) == 0
    quiet = ["--no-report", "-o"]
    assert main(["diagnose", str(tmp_path / "known.csv"), *quiet, str(tmp_path / "known")]) == 0

    out, hidden = tmp_path / "control", ["--add", "backlash(X)=10um", "--noise-um", "0.2"]
    arguments = ["control-test", str(design), "--touches", "64", *hidden, *ordinary_user()]
    assert main([*arguments, "-o", str(out)]) == 0

    # what the control logged, against the same programs probed virtually: noise is the same draw
    made = [str(p) for p in sorted(out.glob("*.ngc"))]
    virtual = ["simulate", *made, *probing, "--add", "backlash(X)=10um"]
    logs = tmp_path / "virtual"
    run_file = str(tmp_path / "virtual.csv")
    assert main([*virtual, "--logs", str(logs), "-o", run_file]) == 0
    parts = [read_log(folder / "MS_A_1.TXT", ("C", "B"))[0] for folder in (out, logs)]
    assert parts[0].number.tolist() == parts[1].number.tolist() == list(range(1, 65))
    beyond = np.linalg.norm(parts[0].xyz - parts[1].xyz, axis=1)
    assert beyond.max() < LATCH + 2e-3 * UM  # and the sixth decimal of both logs
    assert abs(beyond.mean() - 0.5 * LATCH) < 4.0 * LATCH / np.sqrt(12.0 * 64.0)
    runs = [evaluate([part], small, chain, NOISE) for part in parts]
    assert np.abs(runs[0].deviation - runs[1].deviation).max() < 2.0 * LATCH

    model = str(tmp_path / "known" / "model.toml")
    found = tmp_path / "found"
    compared = str(tmp_path / "compared")
    assert main(["compare", str(out / "run.csv"), "--model", model, *quiet, compared]) == 0
    assert main(["diagnose", str(out / "run.csv"), "--model", model, *quiet, str(found)]) == 0
    written = json.loads((found / "diagnosis.json").read_text())
    assert written["verdict"] == "missing effect"
    (effect,) = [step for step in written["steps"] if step["effect"]]
    assert effect["effect"] == "backlash(X)"
    size, u = (effect[key]["amplitude_um"] for key in ("parameters", "uncertainty"))
    assert abs(size - 10.0) < 4.0 * u < 2.0
