"""The example with one wavy face, from the project file to every file of the design."""

import json
from pathlib import Path

import numpy as np
import pytest

from matstd.artefact.body import max_slope, read_standard
from matstd.artefact.brief import read_project
from matstd.cli import main
from matstd.twin.files import read_run
from matstd.twin.units import DEG

PROJECT = Path(__file__).parents[2] / "examples" / "wavy_face.toml"


def test_the_example_asks_for_a_wavy_face_and_a_scan():
    project = read_project(PROJECT)
    assert project.options.family == "wavy"
    assert project.options.scan is not None
    assert len(project.chain.rotary_axes) <= 1  # the spindle alone


@pytest.mark.slow
def test_a_wavy_face_is_designed_to_its_end(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["design", str(PROJECT), "-o", str(out)]) == 0
    assert "one wavy face" in capsys.readouterr().out
    standard = read_standard(out / "standard.toml")
    (face,) = standard.patches
    assert max_slope(face) > 44.0 * DEG
    assert len(standard.spheres) == 13
    found = json.loads((out / "conformity.json").read_text(encoding="utf-8"))
    assert not found["faults"]
    assert found["measured"]["is_watertight"]
    assert found["measured"]["triangles"] < 300_000
    assert (out / "standard.stl").stat().st_size < 15e6
    run = read_run(out / "run.csv")
    on_face = run.touches.feature == "FF1"
    assert 0.99 <= on_face.sum() / 150 <= 1.05
    normals = run.touches.normal[on_face]
    assert np.hypot(*normals[:, :2].T).mean() > np.sin(30.0 * DEG)  # on flanks, not on ridges
    proofs = json.loads((out / "identification.json").read_text(encoding="utf-8"))
    assert proofs
    lines = (out / "scan_path.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) > 1000
    for name in ("report.html", "drawing.pdf", "cmm.dmi", "setup/setup.html", "programs/MS_A_1.H"):
        assert (out / name).stat().st_size > 1000, name
