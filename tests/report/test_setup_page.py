"""The set-up sheet: every alarm of the programs explained, every figure that of the plan."""

import re
from dataclasses import replace

import numpy as np
import pytest
from figures import render_alone
from html_tables import shown_tables
from unchanged import drawn, page_text

from matstd.artefact.body import Meeting, contact
from matstd.artefact.reach import TABLE, Solid
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import setup_tolerance
from matstd.probe_paths.emit import Feeds, make_programs
from matstd.probe_paths.language import Dialect, Label, read_dialect
from matstd.probe_paths.locate import companions
from matstd.probe_paths.plan import PlanOptions, Refusal, plan_touches, requests_at
from matstd.probe_paths.stations import Station
from matstd.report.pages import setup_page, write_setup_page
from matstd.report.pages.setup_page import PAGE
from matstd.report.plots import draw_order, draw_setup, draw_touches
from matstd.twin.frames import apply, fixed_xyz, inverse, pose, rotation, turn
from matstd.twin.machine import Axis, linear_directions, make_chain, tip
from matstd.twin.record import Setup
from matstd.twin.units import DEG


@pytest.fixture(scope="module")
def figures():
    """What the figures of the sheet consist of."""
    return {}


@pytest.fixture(scope="module")
def sheet(golden, figures, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet") / "setup"
    programs = golden.programs()
    plan = golden.plan()
    others = companions(plan, Dialect(), Feeds(), 80.0, False)
    others.write(folder)
    with pytest.MonkeyPatch.context() as patch:
        recorded = render_alone(patch)
        page = write_setup_page(folder, [Station(plan, Dialect(), programs)], 0, others)
    figures |= recorded
    assert page == folder / PAGE
    assert "RAISED BY +80.0 MM" in (folder / "MS_A_DRY.H").read_text(encoding="ascii")
    assert "SEARCH FROM ABOVE" in (folder / "MS_A_LOC.H").read_text(encoding="ascii")
    return page.read_text(encoding="utf-8"), programs


def test_the_whole_sheet_and_its_figures(sheet, figures, unchanged):
    unchanged("\n".join([page_text(sheet[0]), *figures.values(), ""]))


@pytest.mark.parametrize("draw", [draw_touches, draw_order])
def test_pictures_of_the_plan(draw, golden, unchanged):
    unchanged(drawn(draw(golden.plan())) + "\n")


def test_touches_left_out_for_one_reason_stand_in_one_line(golden, tmp_path):
    plan = golden.plan()
    here = Refusal(-1, "SPH1", {"B": -0.5 * np.pi}, "no room above")
    left_out = replace(plan, refused=(here, here, replace(here, feature="FF2"), here))
    others = companions(plan, Dialect(), Feeds(), 80.0, False)
    station = Station(left_out, Dialect(), golden.programs())
    page = write_setup_page(tmp_path / "setup", [station], 0, others).read_text(encoding="utf-8")
    assert page.count("SPH1, B-90.0: no room above") == 1
    assert "3 touches on SPH1, B-90.0: no room above" in page
    assert "1 touch on FF2, B-90.0: no room above" in page


@pytest.mark.parametrize(
    ("is_stated", "words"),
    [
        (True, "nose of the spindle, as stated in the project"),
        (False, "nose of the spindle, assumed; measure yours and state `nose_diameter_mm`"),
        (None, "nose of the spindle"),
    ],
)
def test_the_nose_is_stated_or_assumed(golden, is_stated, words):
    plan = golden.plan()
    plan = replace(plan, probe=replace(plan.probe, nose_is_stated=is_stated))
    _, cylinders = setup_page._probe(Station(plan, Dialect(), golden.programs()))
    assert cylinders.table.rows[-1] == [words, "90.0"]


def test_every_alarm_of_the_programs_is_explained(sheet):
    text, programs = sheet
    alarms = set(re.findall(r"LBL (\d+) ;(?:ALARM|NOTRIGGER)", programs.programs[0].text))
    assert len(alarms) == 11
    (table,) = [t for t in shown_tables(text) if t.section == "Alarms"]
    stated = {row[0]: row for row in table.rows[table.headings :]}
    assert set(stated) == alarms
    assert all(len(row[-1]) > 10 for row in stated.values())


def test_linuxcnc_has_a_sheet_with_its_own_alarms(golden, tmp_path):
    dialect, plan = read_dialect("linuxcnc"), golden.plan()
    others = companions(plan, dialect, Feeds(), 80.0, False)
    programs = golden.programs("linuxcnc")
    page = write_setup_page(tmp_path, [Station(plan, dialect, programs)], 0, others)
    text = page.read_text(encoding="utf-8")
    for word in ("masks", "Q1640", "ROT ", "preset's row", "row 1", "FN 14", "the label"):
        assert word not in page_text(text), word
    for word in ("#1640", "G54: table centre", "motion.probe-input", "INI_VARS", "G10 L2 R"):
        assert word in text, word
    (table,) = [t for t in shown_tables(text) if t.section == "Alarms"]
    stated = [row[0] for row in table.rows[table.headings :]]
    alarms = re.findall(r"O(\d+) SUB \((?:ALARM|NOTRIGGER)", programs.programs[0].text)
    assert sorted(stated) == sorted(alarms)


def test_hashes_programs_and_place_are_those_of_the_head(sheet):
    text, programs = sheet
    head = programs.programs[0].text
    for word in ("CALIBRATION", "WORKSHOP"):
        assert re.search(rf";{word} (\w+)", head)[1] in text
    assert "orientation of the spindle" in text
    (table,) = [t for t in shown_tables(text) if t.section == "Run"]
    rows = table.rows[table.headings :]
    assert [(name, int(touches)) for name, touches, _ in rows] == [
        (p.name, p.touches) for p in programs.programs
    ]
    place = next(t for t in shown_tables(text) if t.section == "Mount")
    found = [float(cell.replace("−", "-")) for cell in place.rows[-1]]
    np.testing.assert_allclose(found[:3], [12.0, -8.0, 5.0])
    np.testing.assert_allclose(found[3:], [0.0, 0.0, np.degrees(0.35)], atol=1e-4)


def lost(plan, angles=(0.0, 0.0, 0.0), shift=(0.0, 0.0, 0.0)):
    """Touches of a plan that miss their feature where the standard stands beside its pose."""
    columns = [plan.chain.axis_index(a) for a in plan.chain.linear_axes]
    direction = np.zeros((len(plan), len(plan.chain.axes)))
    direction[:, [plan.chain.axis_index(a) for a in "XYZ"]] = plan.direction
    along = linear_directions(plan.chain, plan.start)
    way = np.einsum("nij,nj->ni", along, direction[:, columns])
    centre = tip(plan.chain, plan.start, plan.probe.length)
    beside = pose(rotation(np.array(angles)), np.array(shift))
    stands = inverse(plan.setup.T_table_artefact @ beside)
    path = np.full(len(plan), plan.distance)
    met = contact(plan.standard, apply(stands, centre), turn(stands, way), 3.0, path)
    return int(np.sum((met.meeting != Meeting.SURFACE) | (met.feature != plan.feature)))


def test_the_sheet_states_one_offset_per_direction_and_why(sheet, golden):
    """By hand: 0.5 mm of clearance; the farthest corner is (80, 80, 80) mm from the seat's middle,
    so 0.5 mm is 0.25 degrees about each of its axes, 0.253 before rounding down."""
    plan = golden.plan()
    admissible = setup_tolerance(plan)
    for letter, one in admissible.items():
        assert one.is_clearance
        assert one.offset == pytest.approx(0.5 if letter in "XYZ" else 0.25 * DEG)
    for sign in (-1.0, 1.0):
        for unit in np.eye(3):
            assert lost(plan, angles=sign * 0.25 * DEG * unit) == 0
            assert lost(plan, shift=sign * 0.5 * unit) == 0
    text, _ = sheet
    (table,) = [t for t in shown_tables(text) if "Admissible offset" in t.caption]
    assert table.rows[table.headings :] == [
        ["at most ±", *["0.5"] * 3, *["0.25"] * 3],
        ["limited by", *["clearance"] * 6],
    ]
    assert "2.5" not in " ".join(table.rows[-2])


@pytest.mark.parametrize(
    ("angle", "axes", "presets"),
    [
        ((0.0, 0.0, 0.0), ("x", "y", "from above"), ("centre", "centre", "face")),
        ((-90.0, 0.0, 0.0), ("z", "x", "onto the face, which looks along y"),
         ("centre", "face", "centre")),
        ((0.0, 90.0, 0.0), ("y", "z", "onto the face, which looks along x"),
         ("face", "centre", "centre")),
        ((90.0, 0.0, 0.0), ("z", "-x", "onto the face, which looks along -y"),
         ("centre", "face", "centre")),
    ],
)  # fmt: skip
def test_the_directions_of_a_face_that_looks_elsewhere(golden, angle, axes, presets):
    """By the directions of its three axes; a body of the workshop is stated in them."""
    setup = Setup("a", pose(fixed_xyz(np.array(angle) * DEG)))
    plan = replace(golden.plan(), setup=setup)
    (top, *_) = draw_setup(plan).axes
    assert top.get_xlabel() == f"{axes[0]} of the table in mm"
    assert top.get_ylabel() == f"{axes[1]} of the table in mm"
    assert top.get_title(loc="left").startswith(axes[2])
    of_presets = setup_page._of_presets(plan, Dialect())
    for letter, expected in zip("XYZ", presets, strict=True):
        words = of_presets[Label[f"PRESET_{letter}"]]
        assert words == f"{letter} of the preset's row: the {expected} of the table"


def test_the_sheet_says_of_which_face_of_the_table_it_is_made(golden):
    """A table about Z, and a standard on a face that looks along Y: a rotation may be missing."""
    setup = Setup("a", pose(fixed_xyz(np.array([-90.0, 0.0, 0.0]) * DEG)))
    _, held = setup_page._mount(replace(golden.plan(), setup=setup))
    assert "stands on a face that looks along +Y of the table frame" in held.warnings[1]
    assert len(setup_page._mount(golden.plan())[1].warnings) == 1


def test_touches_that_look_less_far_than_the_clearance_limit_the_offset(golden):
    """A path that ends 0.25 mm beyond the surface admits 0.2 mm along Z, not 0.3."""
    plan = golden.plan()
    short = replace(plan, options=replace(plan.options, search=0.25))
    one = setup_tolerance(short)["Z"]
    assert one == (pytest.approx(0.2), False)
    assert lost(short, shift=(0.0, 0.0, -0.2)) == 0
    assert lost(short, shift=(0.0, 0.0, -0.3)) > 0


def test_a_machine_of_three_axes_has_no_word_of_turns(golden, tmp_path):
    axes = {a: Axis((-400.0, 400.0)) for a in "XY"} | {"Z": Axis((-600.0, 0.0))}
    chain = make_chain("three", "[w X' Y' f Z t]", axes, (0.0, 0.0, -500.0))
    small = golden.standard()
    wanted = requests_at(small, "FF1", np.array([[0.0, 3.0], [5.0, -4.0]]), np.zeros(0))
    plan = plan_touches(small, chain, Probe(), Setup("a"), wanted, PlanOptions())
    programs, others = make_programs(plan), companions(plan, Dialect(), Feeds(), 80.0, False)
    page = write_setup_page(tmp_path, [Station(plan, Dialect(), programs)], 0, others)
    visible = re.sub(r"(?s)<(script|style).*?</\1>", "", page.read_text(encoding="utf-8"))
    said = [visible, *(p.text for p in (*programs.programs, *others.dry_run.programs))]
    if others.first:
        said += [p.text for p in others.first.programs]
    for text in said:
        assert re.search(r"(?i)rotary|to turn\b|table poses", text) is None


@pytest.mark.parametrize(("half", "is_whole"), [(160.0, True), (1500.0, False)])
def test_the_picture_shows_the_standard_large_on_any_table(golden, half, is_whole) -> None:
    plan = golden.plan()
    shop = replace(plan.options.workshop, table=Solid(TABLE, (half, half), False, -60.0, 0.0))
    shown = draw_setup(replace(plan, options=replace(plan.options, workshop=shop)))
    top = shown.axes[0]
    width = np.ptp(top.get_xlim())
    assert (width > 2.0 * half) == is_whole
    assert width < 3.0 * 2.0 * plan.standard.base.body.half_size[0]
    assert ("the whole table, mm" in {ax.get_title("left") for ax in shown.axes}) != is_whole
