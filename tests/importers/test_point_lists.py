"""Lists of points as CMMs and workshops write them: characteristics, directions, years."""

import numpy as np
import pytest
from foreign_tables import BLANKS, CHARACTERISTICS, DIRECTIONS

from matstd.cli import main
from matstd.importers import read_sheet
from matstd.importers.points import read_points
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.units import UM


@pytest.fixture
def imported(tmp_path):
    """A function: texts by file name, words -> run and what was printed."""

    def made(texts, capsys, *words):
        for name, text in texts.items():
            (tmp_path / name).write_text(text, encoding="cp1252")
        files = [str(tmp_path / name) for name in texts]
        out = tmp_path / "run.csv"
        assert main(["import", *files, "--part", "--u-um", "2", *words, "-o", str(out)]) == 0
        return read_run(out), capsys.readouterr().out

    return made


def test_a_report_of_characteristics_is_its_points(tmp_path):
    (tmp_path / "chr.txt").write_text(CHARACTERISTICS)
    points = read_points(read_sheet(tmp_path / "chr.txt"))
    assert points.feature.tolist() == ["Bohrung_01", "Bohrung_02"]
    np.testing.assert_allclose(points.nominal[:, :2], [[20.0, 15.0], [95.0, 15.0]])
    wanted = [[-29.0, 11.0], [-34.0, 7.0]]
    np.testing.assert_allclose(points.deviation[:, :2] / UM, wanted, atol=1e-6)
    assert np.isnan(points.deviation[:, 2]).all()


@pytest.mark.parametrize("lost", ["actual", "nominal"])
def test_a_report_without_one_of_its_two_values_is_refused(tmp_path, lost):
    (tmp_path / "chr.txt").write_text(CHARACTERISTICS.replace(lost, "remark"))
    with pytest.raises(BadFile, match="columns such as 'nominal' and 'measured'"):
        read_points(read_sheet(tmp_path / "chr.txt"))


def test_directions_are_taken_and_what_is_not_is_named(imported, capsys):
    run, said = imported({"holes.csv": DIRECTIONS}, capsys)
    of_hole = dict(zip(run.touches.feature, run.touches.last_move("Y"), strict=True))
    assert of_hole == {"H1": 1.0, "H2": -1.0, "H3": 1.0, "H4": -1.0}
    assert not run.touches.last_move("X").any()
    assert "not used: Prüfer" in said


def test_lists_of_several_years_are_runs_in_their_order(imported, capsys):
    run, _ = imported({"2026.csv": DIRECTIONS, "2019.csv": DIRECTIONS.replace("H", "L")}, capsys)
    assert run.touches.runs == ("2026", "2019")
    assert run.touches.feature[run.touches.run == 1].tolist() == [
        f"L{k // 2 + 1}" for k in range(8)
    ]


@pytest.mark.parametrize(
    "text",
    [
        BLANKS,
        BLANKS.replace("    ", "  "),
        BLANKS.replace("    Meas", "# Meas", 1).replace("\n", "\r\n"),
        BLANKS.replace(".", ","),
        # one blank between the columns, of the header as well
        "\n".join(
            " ".join(line.split()) for line in BLANKS.replace("  Round", "  R d").split("\n")
        ),
    ],
)
def test_a_report_in_columns_of_blanks(tmp_path, text):
    (tmp_path / "2005.txt").write_text(text)
    sheet = read_sheet(tmp_path / "2005.txt")
    points = read_points(sheet)
    np.testing.assert_allclose(points.nominal[0, :2], [-61.302, 140.215])
    wanted = [[-14.0, -3.0], [-2.0, -9.0], [3.0, 1.0]]
    np.testing.assert_allclose(points.deviation[:, :2] / UM, wanted, atol=1e-6)
    assert "Err X" in sheet.unused


def test_a_table_without_a_header_is_given_its_columns(tmp_path):
    (tmp_path / "log.txt").write_text("1.0e+01 1.00010e+01 0\n2.0e+01 2.00030e+01 0\n")
    with pytest.raises(BadFile, match="--columns"):
        read_sheet(tmp_path / "log.txt")
    sheet = read_sheet(tmp_path / "log.txt", None, ("target [mm]", "actual [mm]", "x"))
    assert sheet.numbers(1).tolist() == [10.001, 20.003]
    with pytest.raises(BadFile, match="found 3 columns, expected 2"):
        read_sheet(tmp_path / "log.txt", None, ("target [mm]", "actual [mm]"))


COORDINATES_APART = """axis,device,pin,value,nominal,upper,deviation
X,7,1,10.002,10.0,999,0.002
X,7,2,14.001,14.0,999,0.001
X,9,1,80.003,80.0,999,0.003
X,9,2,84.004,84.0,999,0.004
Y,7,1,5.001,5.0,999,0.001
Y,7,2,6.002,6.0,999,0.002
Y,9,1,5.003,5.0,999,0.003
Y,9,2,6.004,6.0,999,0.004
"""


def test_a_point_may_be_named_by_two_columns(tmp_path):
    (tmp_path / "pins.csv").write_text(COORDINATES_APART)
    points = read_points(read_sheet(tmp_path / "pins.csv"))
    assert points.feature.tolist() == ["7-1", "7-2", "9-1", "9-2"]
    wanted = [[10.0, 5.0], [14.0, 6.0], [80.0, 5.0], [84.0, 6.0]]
    np.testing.assert_allclose(points.nominal[:, :2], wanted)
    off = [[2.0, 1.0], [1.0, 2.0], [3.0, 3.0], [4.0, 4.0]]
    np.testing.assert_allclose(points.deviation[:, :2] / UM, off, atol=1e-6)


def test_points_whose_names_are_mixed_up_are_reported(imported, capsys):
    rows = ["name,x nom,y nom,x meas,y meas"]
    place = {"A": (0, 0), "B": (30, 0), "C": (0, 40), "D": (3, 42), "E": (90, 10)}
    found = {**place, "C": place["D"], "D": place["C"]}
    rows += [f"{n},{x},{y},{found[n][0] + 1.01},{found[n][1]}" for n, (x, y) in place.items()]
    _, said = imported({"list.csv": "\n".join(rows)}, capsys)
    assert "2 of 5 points are closer to the nominal position of another" in said
    assert "'C' at 'D', 'D' at 'C'" in said
    right = [rows[0], *(f"{n},{x},{y},{x + 1.01},{y}" for n, (x, y) in place.items())]
    _, said = imported({"list.csv": "\n".join(right)}, capsys, "--force")
    assert "closer" not in said
