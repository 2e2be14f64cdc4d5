"""Limits of a project that no workshop can meet, beside those that one can."""

from pathlib import Path

import pytest

from matstd.artefact.body.material import STEEL
from matstd.artefact.brief.material_table import MaterialTable
from matstd.artefact.brief.standard_tables import BlankTable, LimitsTable, check_body
from matstd.cad_out.making.cutting import CUTTERS
from matstd.twin.errors import BadFile


def check(**limits: float) -> None:
    """With a ball of 2 mm, on a table of 320 mm."""
    table = LimitsTable(**limits)
    check_body(BlankTable(), table, STEEL, 1.0, 160.0, Path("project.toml"))


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ({"min_concave_radius_mm": 0.5}, "a radius that the ball fits into"),
        ({"min_concave_radius_mm": 2.9}, "found 2.9, expected 3 mm or more: a finishing"),
        ({"slot_pitch_mm": 0.01}, "found 0.01, expected 20 mm or more, or 0"),
    ],
)
def test_what_no_cutter_or_table_has_is_refused(limits, told):
    with pytest.raises(BadFile, match=told):
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
    made = MaterialTable(name=name).material(Path("project.toml"))
    assert made.density == pytest.approx(density * 1e-9)
    assert (made.expansion, made.u_expansion) == pytest.approx((expansion, u))
    assert made.modulus is not None
    stated = MaterialTable(name=name, expansion_1_K=2e-6, hardness="60 HRC")
    own = stated.material(Path("project.toml"))
    assert (own.expansion, own.u_expansion, own.hardness) == (2e-6, None, "60 HRC")


def test_a_material_without_data_names_those_that_have_some() -> None:
    with pytest.raises(BadFile, match=r"material\.density_kg_m3: .*'ceramic'.*alumina, zirconia"):
        MaterialTable(name="ceramic").material(Path("project.toml"))
