"""Cells of foreign tables that no measurement has: refused with their place, or passed over."""

from pathlib import Path

import numpy as np
import pytest

from matstd.importers import read_positioning, read_sheet
from matstd.importers.arms import arm_from_dh
from matstd.importers.points import read_points
from matstd.importers.sheets import seconds
from matstd.twin.errors import BadFile


def sheet(folder: Path, text: str):
    (folder / "table.csv").write_text(text, encoding="utf-8")
    return read_sheet(folder / "table.csv")


def joints(table):
    return arm_from_dh(table, np.zeros((4, 2)))


def log_of_x(table):
    return read_positioning(table, "X", None, ("motor", "scale"))


def along_x(table):
    return read_positioning(table, "X")


@pytest.mark.parametrize(
    ("text", "read", "expected"),
    [
        ("Target [mm],1 up [µm]\n0,0.1\n50,1e300\n100,0.3\n", along_x,
         r"line 3, column '1 up \[µm\]': found 1e\+300"),
        (f"Target [mm],{'9' * 100} up [µm]\n0,0.1\n50,0.2\n100,0.3\n", along_x,
         "the number of a cycle"),
        ("time [s],motor [mm],scale [mm]\n0,1,\n1,,2\n2,3,\n", log_of_x,
         "no row with a target and a reading"),
        ("a,alpha,d,theta\n0,90,89.1,0\n-425,0,,0\n", joints,
         "line 3, column 'd': found nothing"),
        ("Zeit;a;b\n31.02.2024 08:00;1;2\n01.03.2024 08:00;1;2\n", lambda table: seconds(table, 0),
         r"'31.02.2024', expected dates such as"),
    ],
)  # fmt: skip
def test_cells_that_no_measurement_has_are_refused_with_their_place(
    tmp_path, text, read, expected
) -> None:
    with pytest.raises(BadFile, match=expected):
        read(sheet(tmp_path, text))


def test_a_target_that_is_missing_in_a_log_costs_its_row_alone(tmp_path) -> None:
    """Up and down again, with a gap on either way: strokes and signs of the others are kept."""
    at = [0.0, 1.0, None, 3.0, 4.0, 3.0, None, 1.0, 0.0]
    rows = [f"{k},{'' if v is None else v},{0.0 if v is None else v}" for k, v in enumerate(at)]
    table = sheet(tmp_path, "time [s],motor [mm],scale [mm]\n" + "\n".join(rows) + "\n")
    test = log_of_x(table)
    assert test.target.tolist() == [v for v in at if v is not None]
    assert test.direction.tolist() == [0, 1, 1, 1, -1, -1, -1]
    assert test.cycle.tolist() == [1, 1, 1, 1, 2, 2, 2]


def test_a_measured_coordinate_without_its_nominal_one_is_refused(tmp_path) -> None:
    wide = "name,x nom [mm],y nom [mm],x ist [mm],y ist [mm]\nA,0,0,0.1,0\nB,,5,1.1,5.1\nC,2,5,,5\n"
    with pytest.raises(BadFile, match=r"line 3, column 'x nom.*found nothing, expected the nom"):
        read_points(sheet(tmp_path, wide))
    points = read_points(sheet(tmp_path, wide.replace("1.1,", ",")))
    assert np.isnan(points.deviation[1:, 0]).all()
    assert points.nominal[1].tolist() == [0.0, 5.0, 0.0]
    long = "point,axis,nominal,actual,tol\n" + "".join(
        f"{row},0.1\n" for row in ("A,X,1,1.1", "A,Y,,2.1", "B,X,3,3.1", "B,Y,4,4.1")
    )
    with pytest.raises(BadFile, match="line 3, column 'nominal': found nothing"):
        read_points(sheet(tmp_path, long))
