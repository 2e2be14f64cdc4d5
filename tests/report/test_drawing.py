"""The sheet for the workshop: everything is on it, to scale, and on the paper."""

import re
from dataclasses import replace

import numpy as np
import pytest
from demo import waves
from unchanged import drawn as parts_of

from matstd.artefact.body import graph_patch
from matstd.artefact.price import Construction
from matstd.cad_out.details import DOT, details_of
from matstd.report.drawing import Issuer, write_drawing
from matstd.report.drawing.drawing import draw_sheet
from matstd.report.drawing.marks import Views, draw_datums
from matstd.report.drawing.sections import draw_screw
from matstd.report.drawing.sheet import A2, Sheet, View
from matstd.report.drawing.tables import COLUMN
from matstd.report.drawing.views import draw_from
from matstd.twin.frames import pose

ISSUER = Issuer("A. Müller", "Workshop & Co", 6.2)


@pytest.fixture(scope="module")
def drawn(upright):
    return draw_sheet(upright, details_of(upright), ISSUER)


def test_the_whole_sheet(drawn, unchanged) -> None:
    unchanged(parts_of(drawn.figure) + "\n")


def test_the_whole_sheet_of_a_large_hard_face_and_parts(upright, unchanged) -> None:
    """The face has a section of its own."""
    at, size = pose(t=np.array([0.0, 0.0, 52.0])), (55.0, 45.0)
    face = graph_patch("FF1", at, size, waves(1, 6.0), (5, 5), 44.0)
    balls = tuple(replace(s, centre=s.centre * [1.15, 1.4, 1.0]) for s in upright.spheres)
    hard = replace(upright.material, hardness="50 to 54 HRC")
    wide = replace(upright, patches=(face,), spheres=balls, material=hard)
    issuer = replace(ISSUER, approved="B. A", date="2026-11-23", make=Construction.PARTS)
    unchanged(parts_of(draw_sheet(wide, details_of(wide), issuer).figure) + "\n")


def words_of(sheet):
    return [text.get_text() for text in sheet.axes.texts]


def test_every_feature_tolerance_and_party_is_on_the_sheet(upright, drawn):
    words = words_of(drawn)
    for name in ("FF1", "FF2", "SPH1", "SPH2", "SPH3", "HOLE1", "HOLE2", "HOLE3", "THERMO"):
        assert name in words
    assert {"A", "B", "C", "0.05", "0.02", "SØ0.2", "A. Müller", "Workshop & Co"} <= set(words)
    assert {"B1", "B2", "C1", "0.01 CZ", "3 x pad", "2 x FF", "3 x SØ25 ±0.0025"} <= set(words)
    assert {
        "170",
        "150",
        "4 x R15",
        "25",
        "pad Ø26, R3, 1 high",
        "3 x ISO 4762 M10x30",
        "6.2 kg",
    } <= set(words)
    x, y, z = upright.spheres[1].centre
    row = words.index("SPH2")
    assert words[row + 1 : row + 4] == [f"{x:.1f}", f"{y:.1f}", f"{z:.1f}"]
    details, row = details_of(upright), words.index("land")
    land, z = (
        f"{v:.2f}" for v in (2 * details.seats["SPH1"].top_radius, details.seats["SPH1"].top)
    )
    assert (words[row + 11], words[row + 12]) == (f"Ø{land}", z)
    (thermo,) = (bore for bore in details.bores if bore.name == "THERMO")
    row = words.index("THERMO", words.index("pad"))
    assert words[row + 3 : row + 5] == [f"{thermo.mouth[2]:g}", "Ø6.2 x 40"]
    assert upright.fingerprint in words
    assert not [w for w in words if "Omitted for lack of space" in w]


def test_a_frame_points_at_what_it_holds_for(upright, drawn):
    """The leader of the balls ends on the top of the highest circle of the view."""
    lines = [p.get_path().vertices for p in drawn.axes.patches]
    sizes = 2.0 * max(s.radius for s in upright.spheres) * np.array([0.5, 1.0, 2.0])
    circles = [v for v in lines if len(v) in (97, 98) and np.ptp(v[:, 1]) > 0.9 * sizes[0]]
    tops = [v[np.argmax(v[:, 1])] for v in circles]
    leaders = [v[1] for v in lines if len(v) == 2]
    assert any(np.allclose(end, top, atol=0.1) for end in leaders for top in tops)


def test_every_engraved_dot_is_drawn(upright, drawn):
    """From above, to scale: as many small circles as letters that look up have dots."""
    details = details_of(upright)
    dots = [line.dots for line in details.lettering if line.T_artefact_text[2, 2] > 0.5]
    wide = [np.ptp(p.get_path().vertices[:, 0]) for p in drawn.axes.patches]
    scale = min(s for s in (0.5, 1.0, 2.0) if np.isclose(wide, 2.0 * s * DOT).any())
    assert np.isclose(wide, 2.0 * scale * DOT).sum() == sum(map(len, dots)) > 20


def test_no_words_leave_their_column(drawn):
    """Tables and notes end where their column ends, and the title block where the sheet does."""
    drawn.figure.set_dpi(36)
    drawn.figure.draw_without_rendering()
    edge = drawn.axes.transData.transform((drawn.right, 0.0))[0]
    column = drawn.axes.transData.transform((drawn.right - COLUMN, 0.0))[0]
    inside = drawn.axes.transData.transform((drawn.right + 1.0, 0.0))[0]
    boxes = [text.get_window_extent() for text in drawn.axes.texts]
    rows = [box for box in boxes if column < box.x0 < inside]
    assert len(rows) > 60
    assert max(box.x1 for box in rows) < edge + 4.0  # the letters of the fields stand beside it


def test_frames_keep_clear_of_targets_on_a_small_plate(upright):
    """On any plate the frame of datum B stands below its targets, not on them."""
    small = replace(upright, base=replace(upright.base, half_size=(60.0, 60.0)))
    sheet, views = Sheet(), Views(*(View(x, 200.0, 0.5) for x in (100.0, 250.0, 400.0)))
    draw_datums(sheet, views, small, details_of(small))
    (target,) = (t for t in sheet.axes.texts if t.get_text() == "B2")
    frame = next(t for t in sheet.axes.texts if t.get_text() == "0.02")
    assert frame.get_position()[1] < target.get_position()[1] - 6.0


def test_a_name_that_something_hides_is_not_written(upright):
    """Of two posts one behind the other only the nearer has its number."""
    first, second, *_ = upright.spheres
    behind = replace(second, centre=np.add(first.centre, [0.0, 30.0, 0.0]))
    both = replace(upright, patches=(), spheres=(first, behind))
    sheet = Sheet()
    draw_from(sheet, View(200.0, 100.0, 0.5), both, details_of(both), np.array([0.0, 1.0, 0.0]))
    names = [word for word in words_of(sheet)[-2:] if word in ("1", "2")]
    assert names[-1:] == ["1"]
    assert names.count("2") == 0


def test_pads_of_two_sizes_are_not_said_to_be_alike(upright):
    """The outline leaves less relief beside the last."""
    near = replace(upright.holes[2], y=upright.base.half_size[1] - 15.0)
    moved = replace(upright, holes=(*upright.holes[:2], near))
    pads = [2.0 * pad.radius for pad in details_of(moved).pads]
    assert pads[2] < pads[0] == pytest.approx(26.0)
    assert 10.0 * pads[2] == pytest.approx(round(10.0 * pads[2]), abs=1e-9)
    sheet = Sheet()
    draw_screw(sheet, View(200.0, 100.0, 1.0), moved.holes[0], moved, details_of(moved))
    words = words_of(sheet)
    assert f"pad Ø{pads[0]:g}, R3, 1 high" in words
    assert any("others with pads as in the table" in w for w in words)


def test_a_name_keeps_clear_of_what_is_drawn():
    """Whatever is beside the circle but on one side, the words stand on that side."""
    for turn in (0.0, 2.2, 4.3):
        sheet, middle = Sheet(), np.array([200.0, 100.0])
        sheet.circle(middle, 5.0)
        for angle in turn + np.radians(np.arange(60.0, 301.0, 5.0)):
            sheet.circle(middle + 9.0 * np.array([np.cos(angle), np.sin(angle)]), 2.5)
        sheet.label(middle, 5.0, "HOLE3")
        sheet.figure.set_dpi(72)
        box = sheet.axes.texts[-1].get_window_extent().transformed(sheet.axes.transData.inverted())
        at = np.array([0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)]) - middle
        assert at @ [np.cos(turn), np.sin(turn)] > 0.5 * np.linalg.norm(at)
        assert np.hypot(*np.maximum(np.abs(at) - 0.5 * np.array([box.width, box.height]), 0)) > 5.0


def test_nothing_leaves_the_paper(drawn):
    drawn.figure.set_dpi(36)  # as good as any: what is looked at scales with it
    drawn.figure.draw_without_rendering()
    sheet = drawn.figure.bbox
    for artist in (*drawn.axes.texts, *drawn.axes.patches):
        box = artist.get_window_extent()
        assert box.x0 >= 0.0 and box.y0 >= 0.0, artist  # noqa: PT018
        assert box.x1 <= sheet.x1 and box.y1 <= sheet.y1, artist  # noqa: PT018


def test_a_view_is_to_scale_and_looks_the_right_way(upright):
    """From -x one has +y on the left; a pillar is as wide as its side, a ball as its diameter."""
    sheet, view = Sheet(), View(200.0, 100.0, 0.5)
    draw_from(sheet, view, upright, details_of(upright), np.array([1.0, 0.0, 0.0]))
    boxes = [p.get_path().get_extents() for p in sheet.axes.patches[1:]]
    for sphere in upright.spheres:
        middle = view.at([-sphere.centre[1], sphere.centre[2]])[0]
        wide = [b for b in boxes if np.allclose([(b.x0 + b.x1) / 2, (b.y0 + b.y1) / 2], middle)]
        assert [b.width for b in wide] == pytest.approx([sphere.radius])
    for patch in upright.patches:
        middle = view.at([-patch.T_artefact_patch[1, 3], 0.0])[0, 0]
        sides = [b for b in boxes if b.width == pytest.approx(patch.half_size[1])]
        assert any((b.x0 + b.x1) / 2 == pytest.approx(middle) for b in sides)


@pytest.mark.slow
def test_files_are_one_a2_page_and_the_same_bytes_again(upright, tmp_path):
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        write_drawing(tmp_path / folder, upright, ISSUER)
    pdf = (tmp_path / "one" / "drawing.pdf").read_bytes()
    assert pdf == (tmp_path / "two" / "drawing.pdf").read_bytes()
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf)
    assert [float(v) * 25.4 / 72.0 for v in box.groups()] == pytest.approx(A2.size, abs=0.1)
    svg = (tmp_path / "one" / "drawing.svg").read_text()
    assert svg == (tmp_path / "two" / "drawing.svg").read_text()
    assert "<svg" in svg
