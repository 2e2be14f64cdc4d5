"""Limits of a project that no workshop can meet, beside those that one can."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from briefs import project_with

from matstd.artefact.brief import Brief, read_project
from matstd.artefact.brief.contradictions import Faults, body_faults, material_faults
from matstd.artefact.brief.standard_tables import BlankTable, LimitsTable, MaterialTable
from matstd.cad_out.making.cutting import CUTTERS
from matstd.twin.errors import BadFile
from matstd.twin.files import checked


def check(**limits: float) -> None:
    """With a ball of 2 mm, on a table of 320 mm."""
    given = checked(LimitsTable, limits, "project.toml", "limits")
    table = ("limits.table_radius_mm", 320.0)
    path = Path("project.toml")
    Faults(body_faults(BlankTable(), given, MaterialTable(), 1.0, table, path)).refuse()


@pytest.mark.parametrize(
    ("limits", "expected"),
    [
        ({"min_concave_radius_mm": 0.5}, r"found 0\.5, expected a number, 3 mm or more"),
        ({"min_concave_radius_mm": 2.9}, r"found 2\.9, expected a number, 3 mm or more"),
        ({"slot_pitch_mm": 0.01}, "found 0.01, expected 20 mm or more, or 0"),
    ],
)
def test_what_no_cutter_or_table_has_is_refused(limits, expected):
    with pytest.raises(BadFile, match=expected):
        check(**limits)


def test_what_the_least_cutter_and_the_narrowest_table_have_is_taken():
    check(min_concave_radius_mm=0.5 * min(CUTTERS), slot_pitch_mm=20.0)


@pytest.mark.parametrize(
    ("name", "density", "expansion", "u"),
    [
        ("Invar", 8050.0, 1.3e-6, 0.4e-6),
        ("aluminum, EN AW-5083", 2700.0, 23.2e-6, 0.5e-6),
        ("Cast iron (EN-GJL-250)", 7200.0, 10.5e-6, 0.7e-6),
    ],
)
def test_a_known_name_completes_what_is_not_stated(name, density, expansion, u) -> None:
    made = MaterialTable(name=name).material()
    assert made.density == pytest.approx(density * 1e-9)
    assert (made.expansion, made.u_expansion) == pytest.approx((expansion, u))
    assert made.modulus is not None
    stated = MaterialTable(name=name, expansion_1_K=2e-6, hardness="60 HRC")
    own = stated.material()
    assert (own.expansion, own.u_expansion, own.hardness) == (2e-6, None, "60 HRC")


def test_a_material_without_data_names_those_that_have_some() -> None:
    found = material_faults(MaterialTable(name="ceramic"), Path("project.toml"))
    density, expansion = map(str, found)
    assert "material.expansion_1_K" in expansion
    assert re.search(r"material\.density_kg_m3: .*'ceramic'.*alumina, zirconia", density)


def test_as_few_touches_as_allowed_are_taken(tmp_path):
    text = "[standard]\nposes = 10\ntouches = {}\n"
    assert read_project(project_with(tmp_path, text.format(100))).options.choice.touches == 100
    with pytest.raises(BadFile, match=r"standard\.touches: found 99, expected .*100"):
        read_project(project_with(tmp_path, text.format(99)))


def test_all_limits_are_named_at_once_with_the_keys_of_the_file(tmp_path):
    text = "[workshop.table]\ndiameter_mm = 40.0\n[blank]\nbase_mm = [30.0, 30.0]\n"
    with pytest.raises(BadFile) as caught:
        read_project(project_with(tmp_path, text + "[standard]\nposes = 100\ntouches = 110\n"))
    message = str(caught.value)
    assert "3 faults: standard.poses: found 100 with touches = 110" in message
    assert "workshop.table.diameter_mm: found a table of 40 mm" in message
    assert "the smallest standard is 160 x 160 x 120 mm, so this machine is too small" in message
    assert "blank.base_mm: found [30.0, 30.0], expected sides of 160 mm or more" in message
    assert "table_radius_mm" not in message


def test_a_renamed_key_is_refused_by_the_name_that_was_written(tmp_path):
    with pytest.raises(BadFile, match=r"standard\.density_kg_m3: found 7\.8, expected a number fr"):
        read_project(project_with(tmp_path, "[standard]\ndensity_kg_m3 = 7.8\n"))


@pytest.mark.parametrize(
    ("workspace", "words"),
    [
        ("X = [-0.2, 0.2]", r"workspace\.X: .*not 0\.4 of them; is it in metres, \[-200, 200\]\?"),
        ("B = [-1.57, 0.35]", r"workspace\.B: .*is it in radians, \[-90, 20\]\?"),
    ],
)
def test_a_workspace_in_other_units_is_refused(tmp_path, workspace, words):
    with pytest.raises(BadFile, match=words):
        read_project(project_with(tmp_path, f"[workspace]\n{workspace}\n"))


@pytest.mark.parametrize("poses", ["99", "100001", "500.0"])
def test_poses_beyond_what_a_study_takes_are_refused(tmp_path, poses):
    with pytest.raises(BadFile, match=rf"workspace\.poses: found {poses}, expected a whole number"):
        read_project(project_with(tmp_path, f"[workspace]\nposes = {poses}\n"))


@pytest.mark.parametrize(
    "workspace",
    ["X = [0.0, 0.0]", "B = [-1.5, 0.5]", "X = [-5.0, 5.0]", "poses = 100", "poses = 100000"],
)
def test_a_narrow_workspace_is_read(tmp_path, workspace):
    read_project(project_with(tmp_path, f"[workspace]\n{workspace}\n"))


@pytest.mark.parametrize(
    ("material", "words"),
    [
        ("density_kg_m3 = 7.8", r"density_kg_m3: found 7\.8, expected a number from 500 to 23000"),
        ("expansion_1_K = 11.5", r"expansion_1_K: found 11\.5, .* from 0 to 0\.0003 1/K"),
        ("density_kg_m3 = 11300.0", r"density_kg_m3: found 11300 beside .*, expected about 7800"),
        ("expansion_1_K = 0.0", r"expansion_1_K: found 0 beside .*, expected about 1\.05e-05"),
        ("[standard]\nname = 'Prüf 1'", r"standard\.name: found 'Prüf 1', .* as programs can"),
    ],
)
def test_figures_of_a_material_in_other_units_are_refused(tmp_path, material, words):
    with pytest.raises(BadFile, match=words):
        read_project(project_with(tmp_path, f"[material]\n{material}\n"))


def test_a_brief_made_in_python_has_the_defaults_of_a_project_file(tmp_path):
    read = read_project(project_with(tmp_path, ""))
    made = Brief(read.chain)
    for name in (
        "probes", "table", "bodies", "ball", "overhang", "riser", "first_mode", "programs", "study",
        "task", "down", "author", "organisation", "approved", "date", "remarks",
    ):  # fmt: skip
        assert getattr(made, name) == getattr(read, name), name
    assert replace(made.options, name="FFS-1") == read.options
    assert (made.blank.base, made.blank.height) == (read.blank.base, read.blank.height)
    assert replace(made.blank.limits, table_radius=190.0) == read.blank.limits
    assert replace(made.blank.fittings, highest_sphere=130.0) == read.blank.fittings
    assert made.population.model.names == read.population.model.names
