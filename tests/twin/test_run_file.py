"""Run files: read, mended where it can be done without guessing, refused where it cannot."""

from pathlib import Path

import numpy as np
import pytest
from run_text import COLUMNS, HEAD, ROW, later, write

from matstd.twin.errors import BadFile
from matstd.twin.files import read_run, write_run
from matstd.twin.machine import Where
from matstd.twin.record import computed_deviation
from matstd.twin.units import NM, UM, URAD


def test_deviation_by_hand(tmp_path: Path) -> None:
    run = read_run(write(tmp_path, [ROW]))
    assert run.deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
    assert run.u.tolist() == [0.6 * UM]
    assert run.touches.ball_artefact[0] == pytest.approx([0.0, -10.0, 40.0], abs=NM)
    assert run.touches.last_move("C").tolist() == [1.0]
    # the probe comes down: Z ran towards minus, X and Y stood
    assert [run.touches.last_move(a)[0] for a in "XYZ"] == [0.0, 0.0, -1.0]
    (remark,) = run.remarks
    assert remark.startswith("T_s_degC is constant at 20.5 degC: what varies within the run")


def test_a_reflector_beside_the_tool_axis_by_hand(tmp_path: Path) -> None:
    """30 mm out in x and -12 in y of the tool frame, which a spindle at zero leaves as they are.

    In the artefact frame, turned by 90 deg, (20 + 30, 0 - 12, 40) is (-12, -40, 40).
    """
    head = HEAD.replace("160.0 }", "160.0, offset_mm = [30.0, -12.0] }")
    row = ROW.replace(",0.0,-10.0,36.998,", ",-12.0,-40.0,36.998,")
    run = read_run(write(tmp_path, [row], head=head))
    assert run.touches.ball_artefact[0] == pytest.approx([-12.0, -40.0, 40.0], abs=NM)
    assert run.deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
    write_run(tmp_path / "again.csv", run, "machine.toml")
    assert "offset_mm = [30.0, -12.0]" in (tmp_path / "again.csv").read_text()
    np.testing.assert_array_equal(read_run(tmp_path / "again.csv").touches.offset, [[30.0, -12.0]])
    # a longer arm turns more: 100 urad of roll of Z move 30 mm out by 3 um in y
    roll = Where("twist", run.touches.chain.link_index("Z"), 5)
    moved = run.touches.reach.of(roll)[0] * 100 * URAD
    np.testing.assert_allclose(moved / UM, [1.2, 3.0, 0.0], atol=1e-6)


def test_several_reflectors_on_one_tool(tmp_path: Path) -> None:
    """Every row says its own; an empty cell means that of the head."""
    columns = COLUMNS + ",tx_mm,ty_mm,tz_mm,dev_um"
    rows = [ROW + ",30.0,-12.0,-170.0,5.0", later(ROW, 9.0) + ",,,,7.0"]
    head = HEAD.replace("# [setup.a]", '# instrument = "tracker"\n# [setup.a]')
    run = read_run(write(tmp_path, rows, head=head, columns=columns))
    expected = [[30.0, -12.0, -170.0], [0.0, 0.0, -160.0]]
    np.testing.assert_array_equal(run.touches.target, expected)
    write_run(tmp_path / "again.csv", run, "machine.toml")
    np.testing.assert_array_equal(read_run(tmp_path / "again.csv").touches.target, expected)
    np.testing.assert_array_equal(run.touches[[1]].target, expected[1:])


def test_a_stated_deviation_goes_before_the_readings(tmp_path: Path) -> None:
    run = read_run(write(tmp_path, [ROW + ",7.25"], columns=COLUMNS + ",dev_um"))
    assert run.deviation == pytest.approx([7.25 * UM], abs=0.001 * NM)


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    columns = COLUMNS + ",u_um,split,spindle_rpm,repeat"
    rows = [ROW + ",0.5,train,600,1", later(ROW, 9.0) + ",0.7,test,1200,2"]
    run = read_run(write(tmp_path, rows, columns=columns))
    write_run(tmp_path / "again.csv", run, "machine.toml")
    again = read_run(tmp_path / "again.csv")
    assert again.deviation == pytest.approx(run.deviation, abs=0.001 * NM)
    assert computed_deviation(again.touches) == pytest.approx(run.deviation, abs=0.1 * NM)
    assert again.u == pytest.approx(run.u)
    assert again.split.tolist() == ["train", "test"]
    assert again.touches.spindle_rpm is not None
    assert again.touches.spindle_rpm.tolist() == [600.0, 1200.0]
    assert again.touches.temperature["s"].tolist() == [20.5, 20.5]
    np.testing.assert_allclose(
        again.touches.setups[0].T_table_artefact, run.touches.setups[0].T_table_artefact, atol=NM
    )


@pytest.mark.parametrize(
    ("rows", "remark"),
    [
        ([ROW, ROW], "line 10: 1 row stands twice; copies are left out"),
        ([later(ROW, 5.0), later(ROW, 2.0)], "line 10: time_s goes back from 5 to 2"),
        ([ROW.replace("20.5", ""), later(ROW, 2.0)], "line 9: T_s_degC has no number in 1 row;"),
        ([ROW.replace("20.5", "nan"), later(ROW, 2.0)], "before and after it are joined by"),
        ([ROW, later(ROW, 3.0)], "T_s_degC is constant at 20.5"),
        ([ROW.replace("20.5", "-9999"), later(ROW, 2.0)], "T_s_degC reads -9999 degC"),
        ([ROW.replace("20.5", "293.6")], "T_s_degC reads 293.6 degC, as no machine does: kelvin?"),
        ([ROW.replace(",0.0,0.0,1.0,", ",0.0,0.0,1.0005,")], "normal of length 1.0005"),
    ],
)
def test_what_can_be_mended_is_mended_and_reported(
    tmp_path: Path, rows: list[str], remark: str
) -> None:
    run = read_run(write(tmp_path, rows))
    if "constant" in remark or len(rows) > 1:
        assert any(remark in stated for stated in run.remarks), run.remarks
    else:
        assert remark in run.remarks[0]
    assert len(run) >= 1


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("nz,", "", ""), "a column nz"),
        (("dirC", "dirQ", ""), "column 'dirQ'"),
        (("", "", "0.0,0.0,1.0,|0.0,0.0,2.0,"), "normal of length 2"),
        (("", "", ",a,0,|,b,0,"), "column setup: found 'b'"),
        (("", "", "36.998|nan"), "finite"),
        (("", "", "-300.0|-0.3"), "units are mixed up"),
        (("", "", "20.0|1e300"), "line 9, column X_mm: found 1e300, expected at most 100000"),
        (("", "", "20.0|twenty"), "line 9, column X_mm: found 'twenty', expected a number"),
        (("", "", "1.5|1e300"), "line 9, column time_s: found 1e300"),
        (("", "", "1.0,1,|1.0,45,"), "column dirC: found 45, expected the sign of the last move"),
        (("", "", '20.0|"20,0"'), "found '20,0', expected a decimal point"),
        (("", "", 'a,a,|"a,a,'), "cells"),
        (("dirC", "split", "1.0,1,|1.0,test,"), "test in every row"),
        (("dirC", "repeat", "1.0,1,|1.0,1.5,"), "column repeat: found 1.5, expected a whole"),
    ],
)
def test_refused(tmp_path: Path, change: tuple[str, str, str], expected: str) -> None:
    old, new, cell = change
    row = ROW.replace(*cell.split("|")) if cell else ROW
    columns = COLUMNS.replace(old, new) if old else COLUMNS
    if "column nz" in expected:
        row = row.replace(",1.0,1,", ",1,")
    path = write(tmp_path, [row], columns=columns)
    with pytest.raises(BadFile, match=expected):
        read_run(path)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("# u_um = 0.6\n", "", "u_um.*standard uncertainty"),
        ("# u_um = 0.6\n", "# u_um = -1.0\n", "u_um"),
        ("radius_mm = 3.0, ", "", r"probe\.radius_mm"),
        ("run/1", "run/9", "format"),
        ("# machine", "# colour = 1\n# machine", "colour"),
    ],
)
def test_bad_head(tmp_path: Path, old: str, new: str, expected: str) -> None:
    with pytest.raises(BadFile, match=expected):
        read_run(write(tmp_path, [ROW], head=HEAD.replace(old, new)))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "line 1: found an empty file, expected a head"),
        (COLUMNS + "\n" + ROW + "\n", "line 1: found 'feature.*', expected a head"),
        (HEAD, "line 8: found nothing, expected a line of column names"),
        (HEAD + COLUMNS + "\n", "table: found no rows"),
        (HEAD + COLUMNS.replace(",", ";") + "\n", "line 8: found columns separated by semicolons"),
        (HEAD + COLUMNS.replace(",", "\t") + "\n", "line 8: found columns separated by tabs"),
        (HEAD + COLUMNS + '\n"' + ROW * 3000, "as many opening as closing quotes"),
        (
            HEAD.replace("machine.toml", "none.toml"),
            "machine: found 'none.toml', and .* is no file",
        ),
    ],
)
def test_what_is_no_run_file(tmp_path: Path, text: str, expected: str) -> None:
    path = write(tmp_path, [ROW])
    path.write_text(text)
    with pytest.raises(BadFile, match=expected):
        read_run(path)


@pytest.mark.parametrize("mark", ["\r\n", "\r", "bom", "blank"])
def test_line_ends_and_marks_do_not_matter(tmp_path: Path, mark: str) -> None:
    path = write(tmp_path, [ROW, later(ROW, 9.0)])
    text = path.read_text()
    text = {"bom": "\ufeff" + text, "blank": text.replace("\n", "\n\n")}.get(
        mark, text.replace("\n", mark)
    )
    path.write_bytes(text.encode("utf-8"))
    assert read_run(path).deviation == pytest.approx([2.0 * UM] * 2, abs=0.001 * NM)


def test_a_file_that_was_appended_to_itself_keeps_its_clock(tmp_path: Path) -> None:
    rows = [ROW, later(ROW, 9.0)]
    run = read_run(write(tmp_path, rows + rows))
    assert run.touches.time.tolist() == [1.5, 9.0]
    assert any("2 rows stand twice; copies are left out" in r for r in run.remarks)


def test_a_run_without_any_deviation_is_reported(tmp_path: Path) -> None:
    run = read_run(write(tmp_path, [ROW + ",0"], columns=COLUMNS + ",dev_um"))
    assert "every deviation is zero: nothing was measured" in run.remarks


def with_temperatures(cells: list[str]) -> list[str]:
    """Rows ten seconds apart with these temperatures."""
    return [later(ROW, 10.0 * k).replace("20.5", cell) for k, cell in enumerate(cells)]


@pytest.mark.parametrize("gap", ["", "nan", "-9999", "inf"])
def test_a_gap_drops_a_value_and_not_its_sensor(tmp_path: Path, gap: str) -> None:
    """21 and 22 degC twenty seconds apart: half-way in time there were 21.5."""
    run = read_run(write(tmp_path, with_temperatures(["20", "21", gap, "22", "23"])))
    assert run.touches.temperature["s"] == pytest.approx([20.0, 21.0, 21.5, 22.0, 23.0])
    (remark,) = run.remarks
    assert remark.startswith("line 11: T_s_degC ")
    assert remark.endswith("; the readings before and after it are joined by a line")


def test_a_sensor_of_gaps_is_left_out(tmp_path: Path) -> None:
    run = read_run(write(tmp_path, with_temperatures(["20", "", "", "", "23"])))
    assert run.touches.temperature == {}
    (remark,) = run.remarks
    assert remark.endswith("T_s_degC has no number in 3 rows; the sensor is left out")


def test_a_line_without_a_place_is_said(tmp_path: Path) -> None:
    path = write(tmp_path, [ROW])
    machine = path.parent / "machine.toml"
    text = machine.read_text(encoding="utf-8")
    machine.write_text(text.replace("point = [0.0, 0.0, 0.0]\n", ""), encoding="utf-8")
    remark = read_run(path).remarks[0]
    assert remark.startswith("axis C has no point in the machine file: it is assumed to turn about")


@pytest.mark.parametrize("u", ["1e300", "1e-300", "0", "-1", "nan"])
def test_uncertainties_that_no_touch_has_are_refused(tmp_path: Path, u: str) -> None:
    with pytest.raises(BadFile, match=r"line 9, column u_um: found"):
        read_run(write(tmp_path, [ROW + f",{u}"], columns=COLUMNS + ",u_um"))


def run_of_rows(count: int = 40) -> list[str]:
    """Touches a little apart in time and place, eight features again and again."""
    return [
        ROW.replace("a,a,", f"f{k % 8},a,", 1)
        .replace(",1.5,", f",{9.0 * k + (k % 3)},")
        .replace(",20.5", f",{20.0 + 0.01 * k}")
        .replace("36.998", f"{36.998 + 1e-4 * (k % 7):.4f}")
        for k in range(count)
    ]


@pytest.mark.parametrize("order", ["shuffled", "by feature", "last half first"])
def test_rows_in_another_order_are_the_same_run(tmp_path: Path, order: str) -> None:
    rows = run_of_rows()
    (tmp_path / "one").mkdir()
    one = read_run(write(tmp_path / "one", rows))
    if order == "shuffled":
        mixed = [rows[i] for i in np.random.default_rng(1).permutation(len(rows))]
    elif order == "by feature":
        mixed = sorted(rows, key=lambda row: row.split(",")[0])
    else:
        mixed = rows[20:] + rows[:20]
    other = read_run(write(tmp_path, mixed))
    assert other.fingerprint == one.fingerprint
    np.testing.assert_array_equal(other.touches.time, one.touches.time)
    np.testing.assert_array_equal(other.touches.temperature["s"], one.touches.temperature["s"])
    (remark,) = [r for r in other.remarks if "time_s goes back" in r]
    assert "another order" in remark
    assert not any("goes back" in r for r in one.remarks)


def test_a_clock_that_began_anew_is_no_other_order(tmp_path: Path) -> None:
    """Twice from zero: what is sorted by such times is the order of nothing."""
    rows = run_of_rows()
    again = [
        row.replace(f",{9.0 * (k + 20) + (k + 20) % 3},", f",{9.0 * k + 4.0},")
        for k, row in enumerate(rows[20:])
    ]
    run = read_run(write(tmp_path, rows[:20] + again))
    assert not run.touches.time.any()
    assert any("a clock that began anew" in r for r in run.remarks)
    assert run.line.tolist() == list(range(9, 49))


def test_a_clock_that_was_set_is_reported(tmp_path: Path) -> None:
    rows = run_of_rows()
    rows[30:] = [
        r.replace(f",{9.0 * k + k % 3},", f",{1.7e9 + 9.0 * k},")
        for k, r in enumerate(rows[30:], start=30)
    ]
    run = read_run(write(tmp_path, rows))
    assert any("time_s jumps from" in r and "line 39" in r for r in run.remarks)


def test_sensors_that_stay_constant_are_one_remark(tmp_path: Path) -> None:
    rows = [ROW + ",20.1,22", later(ROW, 3.0) + ",20.1,22"]
    columns = COLUMNS + ",T_bed_degC,T_column_degC"
    (remark,) = read_run(write(tmp_path, rows, columns=columns)).remarks
    known = ("T_s_degC", 20.5), ("T_bed_degC", 20.1), ("T_column_degC", 22)
    assert remark == ", ".join(f"{name} is constant at {t} degC" for name, t in known) + (
        ": what varies within the run does not follow from them"
    )
