"""Height maps of printers: every head that RepRapFirmware has had, and Klipper's meshes."""

import numpy as np
import pytest
from foreign_tables import KLIPPER

from matstd.importers import read_sheet
from matstd.importers.points import read_points
from matstd.twin.errors import BadFile

HEADS = {
    "v1": ("xmin,xmax,ymin,ymax,radius,spacing,xnum,ynum", "-20,20.1,5,45.1,-1,20,3,3"),
    "v2": (
        "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum",
        "-20,20,5,45,-1,20.00,20.00,3,3",
    ),
    "3.3": (
        "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1",
        "X,Y,-20,20,5,45,-1,20.00,20.00,3,3",
    ),
}
MATRIX = "  0.011,  0.021,      0\n -0.012,  0.000, -0.032\n  0.013,  0.023,  0.033\n"


def reprap(head: str) -> str:
    names, numbers = HEADS[head]
    return f"RepRapFirmware height map file v2 generated at 2020\n{names}\n{numbers}\n{MATRIX}"


@pytest.mark.parametrize("head", HEADS)
def test_a_matrix_becomes_points_and_what_was_not_probed_is_none(tmp_path, head) -> None:
    (tmp_path / "heightmap.csv").write_text(reprap(head))
    points = read_points(read_sheet(tmp_path / "heightmap.csv"))
    assert len(points.line) == 8, "a bare 0 was not probed, 0.000 was"
    np.testing.assert_allclose(points.nominal[:3], [[-20, 5, 0], [0, 5, 0], [-20, 25, 0]])
    np.testing.assert_allclose(points.deviation[:4, 2], [0.011, 0.021, -0.012, 0.0])
    assert points.line[2] == 5
    assert np.isnan(points.deviation[:, :2]).all()


def test_every_mesh_of_klipper_is_a_set_up_of_its_own(tmp_path) -> None:
    (tmp_path / "printer.cfg").write_text(KLIPPER)
    points = read_points(read_sheet(tmp_path / "printer.cfg"))
    assert list(points.setup) == ["cold"] * 6 + ["hot"] * 4
    np.testing.assert_allclose(points.nominal[4], [30.0, 90.0, 0.0])
    np.testing.assert_allclose(points.deviation[[4, 9], 2], [-1.5, -1.3])
    count, bare = "#*# x_count = 3\n", KLIPPER.replace("#*# version = 1\n", "")
    first = bare.replace(count, "").replace("cold]\n", f"cold]\n{count}")
    (tmp_path / "other.cfg").write_text(first)  # keys may stand in any order
    other = read_points(read_sheet(tmp_path / "other.cfg"))
    np.testing.assert_array_equal(other.nominal, points.nominal)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (reprap("v2").replace(",3,3\n", ",3,4\n"), "3 rows of heights, expected 4 rows"),
        (reprap("v2").replace("  0.000, -0.032", " -0.032"), "line 5: found 2 heights, expected 3"),
        (reprap("3.3").replace("X,Y", "X,U"), "line 3: found axes X and U, expected X and Y"),
        (reprap("v1").replace(",20,3,3", ",,3,3"), "xspacing: nothing, expected a number"),
        (KLIPPER.replace("x_count = 3", "x_count = x"), "x_count: x, expected a number"),
        (KLIPPER.replace("-1.3\n", "-1.3, -1.4\n"), "found 3 heights, expected 2"),
        (reprap("v2").replace("0.023", "high"), "expected a number"),
    ],
)
def test_a_map_that_is_not_whole_is_refused_by_its_line(tmp_path, text, message) -> None:
    (tmp_path / "map.csv").write_text(text)
    with pytest.raises(BadFile) as caught:
        read_points(read_sheet(tmp_path / "map.csv"))
    assert message in str(caught.value)
