"""The set-up sheet: every alarm of the programs explained, every figure that of the plan."""

import re
from dataclasses import replace

import numpy as np
import pytest
from html_tables import shown_tables

from matstd.artefact.body import Meeting, contact
from matstd.artefact.reach import TABLE, Solid
from matstd.probe_paths.campaign import setup_tolerance
from matstd.probe_paths.campaign.tolerance import STEPS_MM
from matstd.probe_paths.emit import Feeds
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.locate import companions
from matstd.probe_paths.plan import Refusal
from matstd.probe_paths.stations import Station
from matstd.report.pages import write_setup_page
from matstd.report.pages.setup_page import PAGE, PICTURE
from matstd.report.plots import draw_setup
from matstd.twin.frames import apply, inverse, pose, turn
from matstd.twin.machine import linear_directions, tip


@pytest.fixture(scope="module")
def sheet(golden, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet") / "setup"
    programs = golden.programs()
    plan = golden.plan()
    others = companions(plan, Dialect(), Feeds(), 80.0)
    others.write(folder)
    page = write_setup_page(folder, [Station(plan, Dialect(), programs)], 0, others)
    assert page == folder / PAGE
    assert (folder / PICTURE).stat().st_size > 4_000
    assert "RAISED BY +80.0 MM" in (folder / "MS_A_DRY.H").read_text(encoding="ascii")
    assert "SEARCH FROM ABOVE" in (folder / "MS_A_LOC.H").read_text(encoding="ascii")
    return page.read_text(encoding="utf-8"), programs


def test_touches_left_out_for_one_reason_stand_in_one_line(golden, tmp_path):
    plan = golden.plan()
    here = Refusal(-1, "SPH1", {"B": -0.5 * np.pi}, "no room above")
    left_out = replace(plan, refused=(here, here, replace(here, feature="FF2"), here))
    others = companions(plan, Dialect(), Feeds(), 80.0)
    station = Station(left_out, Dialect(), golden.programs())
    page = write_setup_page(tmp_path / "setup", [station], 0, others).read_text(encoding="utf-8")
    assert page.count("SPH1, B-90.0: no room above") == 1
    assert "3 touches on SPH1, B-90.0: no room above" in page
    assert "1 touch on FF2, B-90.0: no room above" in page


def test_every_alarm_of_the_programs_is_explained(sheet):
    text, programs = sheet
    alarms = set(re.findall(r"LBL (\d+) ;(?:ALARM|NOTRIGGER)", programs.programs[0].text))
    assert len(alarms) == 10
    (table,) = [t for t in shown_tables(text) if t.section == "Alarms"]
    stated = {row[0]: row for row in table.rows[table.headings :]}
    assert set(stated) == alarms
    assert all(len(row[-1]) > 10 for row in stated.values())


def test_hashes_programs_and_place_are_those_of_the_head(sheet):
    text, programs = sheet
    head = programs.programs[0].text
    for word in ("CALIBRATION", "WORKSHOP"):
        assert re.search(rf";{word} (\w+)", head)[1] in text
    (table,) = [t for t in shown_tables(text) if t.section == "Run"]
    rows = table.rows[table.headings :]
    assert [(name, int(touches)) for name, touches, _ in rows] == [
        (p.name, p.touches) for p in programs.programs
    ]
    place = next(t for t in shown_tables(text) if t.section == "Mount")
    found = [float(cell.replace("−", "-")) for cell in place.rows[-1]]
    np.testing.assert_allclose(found[:3], [12.0, -8.0, 5.0])
    np.testing.assert_allclose(found[3:], [0.0, 0.0, np.degrees(0.35)], atol=1e-4)


def test_the_tolerance_is_where_the_first_touch_is_lost(golden):
    """With every touch and on its own: none is lost at the stated step, one at the next."""
    plan = golden.plan()
    tolerance = setup_tolerance(plan)
    assert set(tolerance) == set("XYZABC")
    assert all(0.0 < tolerance[a] <= STEPS_MM[-1] for a in "XYZ")
    columns = [plan.chain.axis_index(a) for a in plan.chain.linear_axes]
    direction = np.zeros((len(plan), len(plan.chain.axes)))
    direction[:, [plan.chain.axis_index(a) for a in "XYZ"]] = plan.direction
    along = linear_directions(plan.chain, plan.start)
    way = np.einsum("nij,nj->ni", along, direction[:, columns])
    centre = tip(plan.chain, plan.start, plan.probe.length)

    def lost(z):
        stands = inverse(plan.setup.T_table_artefact @ pose(t=np.array([0.0, 0.0, z])))
        path = np.full(len(plan), 8.0)
        met = contact(plan.standard, apply(stands, centre), turn(stands, way), 3.0, path)
        return np.sum((met.meeting != Meeting.SURFACE) | (met.feature != plan.feature))

    assert lost(tolerance["Z"]) == lost(-tolerance["Z"]) == 0
    if tolerance["Z"] < STEPS_MM[-1]:
        beyond = STEPS_MM[STEPS_MM.index(tolerance["Z"]) + 1]
        assert lost(beyond) + lost(-beyond) > 0
    assert lost(-9.0) > 0


@pytest.mark.parametrize(("half", "is_whole"), [(160.0, True), (1500.0, False)])
def test_the_picture_shows_the_standard_large_on_any_table(golden, half, is_whole) -> None:
    plan = golden.plan()
    shop = replace(plan.options.workshop, table=Solid(TABLE, (half, half), False, -60.0, 0.0))
    drawn = draw_setup(replace(plan, options=replace(plan.options, workshop=shop)))
    top = drawn.axes[0]
    width = np.ptp(top.get_xlim())
    assert (width > 2.0 * half) == is_whole
    assert width < 3.0 * 2.0 * plan.standard.base.body.half_size[0]
    assert ("the whole table, mm" in {ax.get_title("left") for ax in drawn.axes}) != is_whole
