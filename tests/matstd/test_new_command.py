"""`matstd new`: what it writes is read, designs, compares, and never replaces a user's file."""

import numpy as np
import pytest

from matstd.artefact.brief.project_file import read_project
from matstd.artefact.reach.touchable import ProbeReach
from matstd.artefact.worth.touch_criterion import random_touches
from matstd.cli import main
from matstd.commands.machine.new import TEMPLATES, template
from matstd.twin.files.machine_file import read_machine
from matstd.twin.files.run_file import read_run
from matstd.twin.library.catalogue import load_user_effects, parse_effect
from matstd.twin.library.trial import try_effect
from matstd.twin.units import UM


def written(kind, folder):
    path = folder / {"effect": "effect.py"}.get(kind, TEMPLATES[kind])
    assert main(["new", kind, "-o", str(path)]) == 0
    return path


def test_a_machine_is_read(tmp_path):
    chain = read_machine(written("machine", tmp_path))
    assert chain.programmed_axes == ("C", "B", "X", "Y", "Z")


def test_a_project_is_read_with_the_machine_that_is_written_beside_it(tmp_path):
    project = read_project(written("project", tmp_path))
    assert project.chain.name == "My machine"
    assert project.study.poses == 2000


def test_the_machine_of_a_new_project_reaches_touches_on_its_standard(tmp_path):
    """What a design begins with: touches that the machine reaches in the volume of the blank."""
    project = read_project(written("project", tmp_path))
    reach = project.reach
    assert isinstance(reach, ProbeReach)
    volume = ((-100.0, -100.0, 30.0), (100.0, 100.0, 150.0))
    assert len(random_touches(reach, volume, project.rotary, 200, np.random.default_rng(1))) == 200


def test_a_run_is_read_without_a_remark(tmp_path):
    run = read_run(written("run", tmp_path))
    np.testing.assert_allclose(run.deviation, np.array([0.4, -0.2, 0.9]) * UM)
    assert run.remarks == ()


def test_the_readings_of_a_new_run_stand_where_its_points_are(tmp_path):
    """Without the column of deviations the readings give them: zero, to the digits given."""
    path = written("run", tmp_path)
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line if line.startswith("#") else line.split(",") for line in lines]
    names = next(row for row in rows if isinstance(row, list))
    place = names.index("dev_um")
    kept = [r if isinstance(r, str) else ",".join(r[:place] + r[place + 1 :]) for r in rows]
    path.write_text("\n".join(kept) + "\n", encoding="utf-8")
    np.testing.assert_allclose(read_run(path).deviation, 0.0, atol=1e-9)


def test_an_effect_passes_the_trial_of_user_effects(tmp_path):
    path = written("effect", tmp_path)
    load_user_effects(path)
    run = read_run(written("run", tmp_path))
    effect = parse_effect("my-effect", run.touches.chain)
    try_effect(effect, run.touches, path)
    assert effect.tuned(12.0).tuning == {"x": 12.0}


@pytest.mark.parametrize("kind", list(TEMPLATES))
def test_without_an_output_the_file_is_printed(kind, capsys):
    assert main(["new", kind]) == 0
    assert capsys.readouterr().out == template(kind)


@pytest.mark.parametrize("kind", list(TEMPLATES))
def test_a_file_of_the_user_stays(kind, tmp_path, capsys):
    path = tmp_path / TEMPLATES[kind]
    path.write_text("mine\n", encoding="utf-8")
    assert main(["new", kind, "-o", str(path)]) == 2
    assert "--force" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine\n"
    assert main(["new", kind, "-o", str(path), "--force"]) == 0
    assert path.read_text(encoding="utf-8") == template(kind)


def test_a_machine_that_is_there_stays_beside_a_new_project(tmp_path):
    machine = tmp_path / "machine.toml"
    machine.write_text("mine\n", encoding="utf-8")
    written("project", tmp_path)
    assert machine.read_text(encoding="utf-8") == "mine\n"
