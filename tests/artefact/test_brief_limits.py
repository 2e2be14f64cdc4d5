"""Limits of a project that no workshop can meet, beside those that one can."""

from pathlib import Path

import pytest

from matstd.artefact.brief.standard_tables import BlankTable, LimitsTable, MaterialTable, check_body
from matstd.cad_out.making.cutting import CUTTERS
from matstd.twin.errors import BadFile


def check(**limits: float) -> None:
    """With a ball of 2 mm, on a table of 320 mm."""
    table = LimitsTable(**limits)
    check_body(BlankTable(), table, MaterialTable(), 1.0, 160.0, Path("project.toml"))


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
