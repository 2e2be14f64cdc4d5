"""`matstd uncertainty` on the golden standard, of which one face stands 5 µm too high."""

import json
import re
from dataclasses import replace
from pathlib import Path

import make_programs as golden
import numpy as np
import pytest

from matstd.artefact.body import Known, Standard, read_standard, write_standard
from matstd.artefact.brief import Task
from matstd.artefact.certify import like_task
from matstd.artefact.certify.task_places import curvature
from matstd.cli import main
from matstd.diagnosis.files import model_text
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign import VirtualMachine, visits
from matstd.twin.errors import DesignError
from matstd.twin.files import read_run, write_run
from matstd.twin.frames import pose, rotation
from matstd.twin.library import parse_effect
from matstd.twin.machine import Contribution
from matstd.twin.model import Model
from matstd.twin.units import DEG, UM

HIGH = 5.0
"""How much too high FF1 stands along its own z, µm."""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three visits, the standard clamped anew for each, on a machine without errors."""
    folder = tmp_path_factory.mktemp("visits")
    small: Standard = golden.standard()
    low = small.patches[0]
    up = low.T_artefact_patch @ pose(np.eye(3), np.array([0.0, 0.0, HIGH * UM]))
    true = replace(small, patches=(replace(low, T_artefact_patch=up), *small.patches[1:]))
    visit(folder, 3, 4, true)
    return folder


def visit(folder: Path, count: int, seed: int, true: Standard, **disturbance: object) -> None:
    """Files of a campaign on the golden standard, which really is another."""
    small, chain, rng = golden.standard(), golden.machine(), np.random.default_rng(seed)
    stands = [
        VirtualMachine(
            chain,
            noise=0.2 * UM,
            setup_error=pose(rotation(rng.normal(0.0, 2e-4, 3)), rng.normal(0.0, 0.05, 3)),
            **disturbance,
        )
        for _ in range(count)
    ]
    write_standard(folder / "standard.toml", small)
    (folder / "machine.toml").write_text(golden.machine_text())
    programs = golden.programs().write(folder / "programs")
    for k, made in enumerate(visits(programs, true, stands, rng, calibrated=small)):
        write_run(folder / f"v{k}.csv", made.run, "machine.toml")


def call(place: Path, *more: str, runs: int = 3) -> int:
    files = [str(place / f"v{k}.csv") for k in range(runs)]
    out = ["-o", str(place / "u.json"), "--force"]
    return main(["uncertainty", *files, "--standard", str(place / "standard.toml"), *more, *out])


def test_the_high_face_is_reported(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(place) == 0
    (found,) = json.loads((place / "u.json").read_text())["budgets"]
    run = read_run(place / "v0.csv")
    rows = run.touches.feature == "FF1"
    felt = HIGH * float(run.touches.normal[rows, 2].mean())  # FF1 lies upright
    mean = {face["feature"]: face["mean_um"] for face in found["by_face"]}
    assert mean["FF1"] == pytest.approx(felt, abs=0.4)
    assert mean["FF2"] == pytest.approx(0.0, abs=0.4)
    # noise of 0.2 µm and what the datum balls' noise adds to it
    assert 0.15 < found["u_p_um"] < 0.45
    assert found["visits"] == 3
    assert found["places"] == int(np.isin(run.touches.feature, ["FF1", "FF2"]).sum())
    said = capsys.readouterr().out
    assert "ISO 15530-3 asks for 10" in said
    assert "u_w is 0" in said
    assert "2 faces, 5 table poses and 3 visits hardly determine how much the errors differ" in said
    assert found["k"] > 5.0  # as well as one number describes two faces
    assert found["U_um"] == pytest.approx(found["k"] * found["u_um"], rel=1e-3)


def test_a_page_shows_the_same(place: Path) -> None:
    page = place / "u.html"
    assert call(place, "--page", str(page)) == 0
    (found,) = json.loads((place / "u.json").read_text())["budgets"]
    text = page.read_text(encoding="utf-8")
    rows = {
        cells[0]: cells[1:]
        for cells in (
            re.findall(r"<td[^>]*>(.*?)</td>", r) for r in re.findall("<tr>(.*?)</tr>", text, re.S)
        )
        if cells
    }
    for face in found["by_face"]:
        mean, spread = (float(cell.replace("−", "-")) for cell in rows[face["feature"]])
        assert mean == pytest.approx(face["mean_um"], abs=0.005)
        assert spread == pytest.approx(face["spread_um"], abs=0.005)
    assert "u_w is 0" in text
    assert "v2.csv" in text
    assert "src=" not in text.replace('src="data:', "")


def test_a_task_chooses_places(place: Path) -> None:
    run = read_run(place / "v0.csv")
    standard = read_standard(place / "standard.toml")
    t = run.touches
    faces = np.isin(t.feature, ["FF1", "FF2"])
    slope = np.arccos(t.normal[:, 2])
    half = float(np.median(slope[faces]))
    like = like_task(Task(slope=(0.0, half)), standard, t)
    assert (like == (faces & (slope <= half))).all()
    b = t.q[:, t.chain.axis_index("B")]
    like = like_task(Task(rotary={"B": (-40 * DEG, -20 * DEG)}), standard, t)
    assert (like == (faces & (np.abs(b + 30 * DEG) < 1e-6))).all()
    # the curvature of a face at a touch, by differences of its normals
    row = int(np.flatnonzero(t.feature == "FF1")[0])
    patch = standard.features["FF1"]
    uv = patch.project(t.point[[row]])
    step = 1e-4
    S = [(patch.normal(uv + d) - patch.normal(uv - d))[0] for d in step * np.eye(2)]
    P = [(patch.point(uv + d) - patch.point(uv - d))[0] for d in step * np.eye(2)]
    shape = np.linalg.lstsq(np.array(P).T, np.array(S).T, rcond=None)[0]
    assert curvature(standard, t)[row] == pytest.approx(
        np.abs(np.linalg.eigvals(shape)).max(), rel=1e-4
    )


@pytest.mark.parametrize(
    ("task", "expected"),
    [
        ("slope_deg = [80.0, 85.0]", "none of"),
        ("slope_deg = [40.0, 10.0]", "smallest and largest"),
        ("[poses]\nZ_deg = [0.0, 1.0]", "rotary axes"),
        ("[poses]\nA_deg = [0.0, 1.0]", "expected rotary axes of trunnion: C, B"),
        ("tolerance_um = -3.0", "a number above 0"),
        ("sloop_deg = [0.0, 1.0]", "slope_deg"),
    ],
)
def test_a_task_that_says_nothing(
    place: Path, capsys: pytest.CaptureFixture[str], task: str, expected: str
) -> None:
    (place / "task.toml").write_text(f'format = "task/1"\nname = "t"\n{task}\n')
    assert call(place, "--task", str(place / "task.toml")) == 2
    error = capsys.readouterr().err
    assert expected in error
    assert error.count("\n") == 1


def test_too_little_and_the_same_twice(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(place, runs=1) == 2
    assert "expected at least 2" in capsys.readouterr().err
    file, out = str(place / "v0.csv"), str(place / "u2.json")
    standard = str(place / "standard.toml")
    code = main(["uncertainty", file, file, "--standard", standard, "-o", out])
    assert code == 2
    assert "every visit once" in capsys.readouterr().err
    assert not (place / "u2.json").exists()


def test_where_hardly_anything_was_touched(place: Path, answer, refusal, tmp_path: Path) -> None:
    files = []
    for k, keep in enumerate(("FF1", "FF1", "none")):
        text = (place / f"v{k}.csv").read_text(encoding="utf-8").splitlines(keepends=True)
        file = tmp_path / f"v{k}.csv"
        kept = [line for line in text if "FF" not in line or keep in line]
        file.write_text("".join(kept).replace("machine.toml", str(place / "machine.toml")))
        files.append(str(file))
    more = ["--standard", str(place / "standard.toml"), "-o", str(tmp_path / "u.json")]
    said = answer(["uncertainty", *files[:2], *more])
    assert "10 places on 1 face at 5 table poses in 2 visits" in said
    assert "only one face: U holds for workpieces at its place" in said
    assert "no touch on a feature of standard" in refusal(
        ["uncertainty", files[2], files[0], *more, "--force"]
    )


def test_a_run_of_another_standard(place: Path) -> None:
    run = read_run(place / "v0.csv")
    other = replace(run.touches, feature=np.full(len(run), "PAD9"))
    with pytest.raises(DesignError, match="PAD9"):
        like_task(Task(), read_standard(place / "standard.toml"), other)


def test_another_file_of_the_standard_than_the_run_was_evaluated_with_is_refused(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A calibration that found FF1 20 µm higher; then one of another design."""
    design = read_standard(place / "standard.toml")
    face = design.patches[0]
    up = face.T_artefact_patch @ pose(np.eye(3), np.array([0.0, 0.0, 20.0 * UM]))
    found = replace(
        design,
        patches=(replace(face, T_artefact_patch=up), *design.patches[1:]),
        known=Known("cmm.csv", "0123456789abcdef", {}),
    )
    piece, out = tmp_path / "piece.toml", tmp_path / "out"
    write_standard(piece, found)
    run = str(place / "v0.csv")
    assert main(["uncertainty", run, "--standard", str(piece), "-o", str(out)]) == 2
    message = capsys.readouterr().err
    off = float(re.search(r"v0.csv: .* touches ([0-9.]+) µm rms off the surfaces", message)[1])
    touches = read_run(run).touches
    share = np.mean(touches.feature == "FF1")
    upwards = np.mean(touches.normal[touches.feature == "FF1"][:, 2] ** 2)
    assert off == pytest.approx(20.0 * np.sqrt(share * upwards), rel=0.05)
    assert "the design, perhaps" in message
    program = str(next((place / "programs").glob("*.H")))
    real = ["--standard", str(place / "standard.toml"), "--real-standard", str(piece)]
    machine = ["--machine", str(place / "machine.toml"), "-o", str(out)]
    assert main(["simulate", program, *real, *machine]) == 2
    assert f"nominal: found 0123456789abcdef, expected {design.fingerprint}" in (
        capsys.readouterr().err
    )
    assert not out.exists()


def test_a_learnt_curve_corrects_where_it_has_been_alone(tmp_path: Path) -> None:
    """A worn stretch of Z lifts the reading by a bump; the curve knows all of it, or one side."""
    middle, width = -255.0, 20.0

    def worn(touches):
        out = Contribution.zeros(len(touches), len(touches.chain.links))
        bump = np.exp(-(((touches.reading("Z") - middle) / width) ** 2))
        return out._replace(bias=12.0 * UM * bump)

    visit(tmp_path, 4, 6, golden.standard(), disturbance=worn)
    first = read_run(tmp_path / "v3.csv")
    z = first.touches.reading("Z")
    budgets = {}
    for name, rows in (("whole", z < np.inf), ("part", z < -272.0)):
        part = first[rows]
        low, high = part.touches.reading("Z").min(), part.touches.reading("Z").max()
        curve = parse_effect("law(bias,curve Z)", part.touches.chain).tuned(
            low, high, 0.1, 20.0 * UM
        )
        fit = fit_run(part, Model(part.touches.chain, (curve,)))
        (tmp_path / f"{name}.toml").write_text(model_text(fit, "v3.csv"), encoding="utf-8")
        assert call(tmp_path, "--model", str(tmp_path / f"{name}.toml")) == 0
        plain, corrected = json.loads((tmp_path / "u.json").read_text())["budgets"]
        budgets[name] = corrected
    assert budgets["whole"]["U_um"] < 0.6 * plain["U_um"]
    # beyond its touches the curve dies away, and the budget has the bump again
    assert budgets["part"]["U_um"] > 0.8 * plain["U_um"]
    # places that a model does not know are no gross errors
    assert [one["places"] for one in (plain, *budgets.values())] == [plain["places"]] * 3
