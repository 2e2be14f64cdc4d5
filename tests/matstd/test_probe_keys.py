"""The probe of a project: its keys reach the planner, and what cannot be is refused."""

from pathlib import Path

import pytest

from matstd.artefact.brief import read_project
from matstd.artefact.tool import Probe
from matstd.commands.machine.new import template
from matstd.twin.errors import BadFile

EXAMPLE = Path(__file__).parents[2] / "examples" / "hsm600u.toml"
LENGTH = "length_mm = 160.0"
WIDE = """
stylus_length_mm = 40.0
stylus_diameter_mm = 3.0
body_diameter_mm = 62.0
nose_diameter_mm = 100.0
"""


def project(folder, keys):
    text = EXAMPLE.read_text(encoding="utf-8")
    assert text.count(LENGTH) == 1
    path = folder / "project.toml"
    path.write_text(text.replace(LENGTH, f"{LENGTH}\n{keys}"), encoding="utf-8")
    machine = "hsm600u-machine.toml"
    (folder / machine).write_bytes((EXAMPLE.parent / machine).read_bytes())
    return read_project(path)


def test_without_keys_it_is_the_plain_probe(tmp_path):
    assert project(tmp_path, "").probe == Probe(3.0, 160.0)


def test_the_keys_reach_planner_and_placement(tmp_path):
    found = project(tmp_path, WIDE)
    expected = Probe(radius=3.0, length=160.0, stack=((40.0, 1.5), (160.0, 31.0)), nose_radius=50.0)
    assert found.probe == expected
    assert found.reach.shape.cylinders == ((40.0, 1.5), (160.0, 31.0), (310.0, 50.0))


@pytest.mark.parametrize(
    ("keys", "diameter", "is_stated"),
    [
        ("", 90.0, False),
        ("nose_diameter_mm = 90.0", 90.0, True),
        ('model = "om-63x76"', 100.0, False),
        ('model = "om-63x76"\nnose_diameter_mm = 120.0', 120.0, True),
    ],
)
def test_a_nose_that_is_not_stated_is_an_assumed_one(tmp_path, keys, diameter, is_stated):
    found = project(tmp_path, keys).probe
    assert (2.0 * found.nose_radius, found.nose_is_stated) == (diameter, is_stated)


def test_new_projects_state_the_nose():
    assert "\nnose_diameter_mm = 90.0  " in template("project")
    assert "nose or ram above the gauge line: measure yours" in template("project")


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ("stylus_length_mm = 170.0", "probe.stylus_length_mm: found 170, expected between"),
        ("stylus_length_mm = 2.0", "probe.stylus_length_mm: found 2, expected between"),
        ("stylus_diameter_mm = 6.0", "probe.stylus_diameter_mm: found 6, expected less"),
        ("body_diameter_mm = 0.0", "probe.body_diameter_mm"),
        ("body_mm = 50.0", "probe.body_mm"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, keys, reason):
    with pytest.raises(BadFile, match=reason):
        project(tmp_path, keys)
