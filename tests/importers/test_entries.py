"""Every kind of table as a run in three lines of Python, without the command."""

import numpy as np
import pytest

from matstd.importers import import_arm, import_mapped, import_points, read_positioning, read_sheet
from matstd.importers.instruments import component_range
from matstd.importers.sheets import timed_by_rows
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.units import UM, URAD

POINTS = "name,x nominal,y nominal,x measured,y measured\n"


def sheet(folder, text):
    (folder / "table.csv").write_text(text, encoding="utf-8")
    return read_sheet(folder / "table.csv")


def test_points_of_a_plate_that_lies_turned_are_compared_where_it_lies(tmp_path):
    """By hand: a quarter turn takes (x, y) to (-y, x); the last point is 30 um off along y."""
    nominal = [(0, 0), (100, 0), (0, 80), (100, 80), (50, 40)]
    off = [0.0, 0.0, 0.0, 0.0, 0.03]
    rows = [
        f"P{k},{x},{y},{200 - y},{x + d}"
        for k, ((x, y), d) in enumerate(zip(nominal, off, strict=True))
    ]
    found = import_points([sheet(tmp_path, POINTS + "\n".join(rows))], "standard", 1.0 * UM)
    assert found.count == len(nominal)
    assert found.misplaced == ()
    (frame,) = found.frames
    assert frame.turn == pytest.approx(np.pi / 2.0, abs=1e-3)
    # least squares spreads the one deviation over all points: its mean stays with the frame
    along = found.run.deviation[found.run.touches.feature == "P4"]
    assert np.linalg.norm(along) == pytest.approx(0.03 * 4.0 / 5.0, abs=1e-5)
    assert set(found.chain.axes) == {"X", "Y"}


def test_rows_in_order_are_moments(tmp_path):
    rows = "P0,0,0,0,0\nP1,100,0,100,0\nP2,0,80,0,80\nP3,100,80,100,80.02\n"
    run = import_points([sheet(tmp_path, POINTS + rows)], "part", 1.0 * UM).run
    timed = timed_by_rows(run, 20.0)
    assert sorted(set(timed.touches.time)) == [0.0, 20.0, 40.0, 60.0]
    with pytest.raises(DesignError, match="the table has times"):
        timed_by_rows(timed, 20.0)


def test_a_straightness_is_about_its_line_and_an_angle_as_it_is(tmp_path):
    """A parabola of 8 um at the ends of 400 mm: 8 um about its line, whatever slope is added."""
    x = np.linspace(-200.0, 200.0, 9)
    text = "Target [mm],1 up [µm]\n" + "".join(
        f"{v:g},{8.0 * (v / 200.0) ** 2 + 0.5 * v:.6f}\n" for v in x
    )
    straight = read_positioning(sheet(tmp_path, text), "X", component="EYX")
    assert component_range(straight) == pytest.approx(8.0 * UM)
    tilting = read_positioning(sheet(tmp_path, text.replace("µm", "µrad")), "X", component="EBX")
    assert component_range(tilting) == pytest.approx(200.0 * URAD, rel=0.05)


def test_an_arm_is_described_once(tmp_path):
    with pytest.raises(DesignError, match="neither given"):
        import_arm(sheet(tmp_path, "j1,j2\n1,2\n3,4\n"), 1.0 * UM)


def test_a_mapping_file_names_its_machine(tmp_path):
    table = sheet(tmp_path, "a,b\n1,2\n3,4\n")
    (tmp_path / "map.toml").write_text(
        'format = "import/1"\n[head]\nu_um = 1.0\n[columns]\nX_mm = { from = "a" }\n'
    )
    with pytest.raises(BadFile, match=r"head\.machine"):
        import_mapped(table, tmp_path / "map.toml", tmp_path)
