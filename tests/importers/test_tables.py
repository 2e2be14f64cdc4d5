"""Foreign tables made runs: layouts, units, decimal marks, and above all signs."""

import importlib
import re
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from foreign_tables import REPORT

from matstd.cli import main
from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.fit import Role, fit_run
from matstd.importers import (
    one_axis_machine,
    positioning_run,
    read_circle,
    read_positioning,
    read_sheet,
)
from matstd.importers.arms import arm_from_dh
from matstd.importers.instruments import PositioningTest
from matstd.importers.points import linear_machine, points_run, read_points
from matstd.importers.sheets import bare, unit_of_column
from matstd.report.words import verdict_sentence
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.record import at_poses, without_copies
from matstd.twin.units import DEG, UM, URAD

BAD = 2
TARGETS = np.array([0.0, 25.0, 50.0, 75.0, 100.0])
GROWS = 0.1 * UM
"""Error of the axis per mm of travel: it goes too far, 10 µm at the end."""
REVERSAL = 2.0 * UM


def deviation(target, cycle, sign):
    """Actual minus target of the test axis, mm: too far, with reversal and a little scatter."""
    return GROWS * target + 0.5 * REVERSAL * sign + 0.01 * UM * (cycle - 2)


def wide_table(decimal=".", separator=","):
    """A row a target, a column a cycle and direction."""
    head = ["Target [mm]", *(f"{j} {d}" for j in (1, 2, 3) for d in ("up [µm]", "down [µm]"))]
    rows = [
        [f"{t:g}.0", *(f"{deviation(t, j, s) / UM:.4f}" for j in (1, 2, 3) for s in (1, -1))]
        for t in TARGETS
    ]
    lines = [separator.join(row).replace(".", decimal) for row in rows]
    return "\n".join([separator.join(head), *lines]) + "\n"


def long_table():
    """A row a reading."""
    rows = [
        f"{t:g},{j},{'+' if s > 0 else '-'},{deviation(t, j, s) / UM:.4f}"
        for j in (1, 2, 3)
        for s in (1, -1)
        for t in TARGETS[::s]
    ]
    return "target_mm,cycle,direction,deviation_um\n" + "\n".join(rows) + "\n"


def saved(tmp_path: Path, text: str, name="table.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (wide_table(), "wide.csv"),
        (wide_table(",", ";"), "semicolons.csv"),
        (wide_table(",", "\t"), "tabs.txt"),
        (long_table(), "long.csv"),
        ("Test of X\nLaser 5\n\n" + long_table() + "mean,,,3.1\n", "titled.csv"),
    ],
)
def test_layouts_of_a_positioning_test_say_the_same(tmp_path, text, name):
    test = read_positioning(read_sheet(saved(tmp_path, text, name)), "X")
    assert len(test.target) == 30
    for t, d, j, s in zip(test.target, test.deviation, test.cycle, test.direction, strict=True):
        assert d == pytest.approx(deviation(t, j, s), abs=1e-4 * UM)


def test_cycles_above_directions(tmp_path):
    text = ",1,1,2,2\ntarget_mm,up_um,down_um,up_um,down_um\n0,1,2,3,4\n10,5,6,7,8\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "X")
    picked = (test.cycle == 2) & (test.direction == -1)
    assert test.deviation[picked] / UM == pytest.approx([4.0, 8.0])


def test_actual_positions_stand_for_deviations(tmp_path):
    text = "target [mm],actual [mm]\n0,0.001\n10,10.002\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "Z")
    assert test.deviation / UM == pytest.approx([1.0, 2.0])


def fitted_tip(run, q):
    """Deviation of the tool point at readings, µm, as the ordinary model learns it from a run."""
    chain = run.touches.chain
    fit = fit_run(run, ordinary_model(chain))
    theta = fit.theta[: len(fit.model.parameters)]
    return fit.model.tip_deviation(at_poses(chain, q, 0.0), theta) / UM


def test_an_axis_that_goes_too_far_has_a_growing_positioning_error(tmp_path):
    """Sign, end to end: +10 µm over the travel in the table is EXX of +10 µm over the travel."""
    test = read_positioning(read_sheet(saved(tmp_path, wide_table())), "X")
    run = positioning_run(test, one_axis_machine("X", test.target), 0.1 * UM)
    ends = fitted_tip(run, np.array([[0.0], [100.0]]))
    assert ends[1, 0] - ends[0, 0] == pytest.approx(10.0, abs=0.2)


def test_an_axis_that_moves_from_cycle_to_cycle(tmp_path):
    """No times stand in a positioning test; 0.9 µm more in every cycle are found as such."""
    rng = np.random.default_rng(7)
    targets = np.sort(rng.uniform(0.0, 500.0, 15)).round(3)
    rows = [
        f"{t},{j},{s:+d},{0.004 * t + 0.9 * j + 0.75 * s + 0.3 * rng.standard_normal():.3f}"
        for j in range(1, 6)
        for s in (1, -1)
        for t in targets[::s]
    ]
    text = "target [mm],cycle,direction,deviation [um]\n" + "\n".join(rows) + "\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "X")
    result = diagnose(positioning_run(test, one_axis_machine("X", test.target), 0.3 * UM))
    steps = [s for s in result.steps if s.effect is not None]
    reported = {s.effect.name: next(r for r in s.reported if r.role is Role.SIZE) for s in steps}
    assert set(reported) == {"follows(EXX,cycle_1)", "backlash(X)"}
    for name, true in (("follows(EXX,cycle_1)", 0.9), ("backlash(X)", 1.5)):
        assert abs(reported[name].value) == pytest.approx(true, abs=4.0 * reported[name].u)
    # a growth that no reading changes is of the axis or of the laser; a reversal is no laser
    said = verdict_sentence(result)
    assert re.search(r"amplitude 0\.9\d* ± [\d.]+ µm per cycle; the laser itself may be", said)
    assert re.search(r"\(amplitude 1\.[45]\d* ± [\d.]+ µm\) \[backlash", said)


def test_a_screw_that_warms_over_the_cycles(tmp_path):
    """Readings in their order: up and down, cycle after cycle; 24 µm at the free end, 1.5 cycles.

    Without it the growth between the two ways of a cycle would pass for reversal.
    """
    rng = np.random.default_rng(5)
    targets = np.r_[0.0, np.sort(rng.uniform(0.0, 800.0, 10)).round(2), 800.0]
    lines = [f"target [mm],{','.join(f'{j} {way} [um]' for j in range(1, 6) for way in WAYS)}"]
    read = np.zeros((12, 10))
    for k in range(10):
        at = (k + (np.arange(12) + 0.5) / 12.0) / 2.0  # cycles done
        place = targets if k % 2 == 0 else targets[::-1]
        grown = 24.0 * (1.0 - np.exp(-at / 1.5)) * place / 800.0
        read[:, k] = (grown + 0.005 * place)[:: 1 - 2 * (k % 2)] + 1.5 * (0.5 - k % 2)
    read += 0.3 * rng.standard_normal(read.shape)
    lines += [
        f"{t},{','.join(f'{v:.2f}' for v in row)}" for t, row in zip(targets, read, strict=True)
    ]
    test = read_positioning(read_sheet(saved(tmp_path, "\n".join(lines))), "X")
    result = diagnose(positioning_run(test, one_axis_machine("X", test.target), 0.3 * UM))
    reported = {s.effect.name: s.reported for s in result.steps if s.effect is not None}
    assert set(reported) == {"axis-warming(X,V_cycles_done_1)", "backlash(X)"}
    first, last = 0.5 / 24.0, (9.0 + 11.5 / 12.0) / 2.0  # cycles done at the touches
    grown = 24.0 * (np.exp(-first / 1.5) - np.exp(-last / 1.5))
    true = {"change_at_highest_reading": grown, "change_at_lowest_reading": 0.0}
    true |= {"cycles": 1.5, "high_end": 24.0, "low_end": 0.0}
    assert within(reported["axis-warming(X,V_cycles_done_1)"], true)
    assert within(reported["backlash(X)"], {"amplitude": 1.5})
    # an effect that was found does not hide itself
    smallest = {d.effect.name: d.size for d in result.detectable}
    assert 0.1 * UM < smallest["backlash(X)"] < 0.4 * UM


WAYS = ("up", "down")


def within(reported, true):
    """Whether every number that has a truth agrees with it in 3.5 standard uncertainties."""
    numbers = {r.name.removesuffix("_um"): r for r in reported}
    numbers |= {r.quantity: r for r in reported}
    return all(abs(abs(numbers[k].value) - v) < 3.5 * numbers[k].u for k, v in true.items())


def test_counts_that_an_encoder_lost_are_a_jump_of_its_axis():
    """Four strokes of 80 readings; from reading 203 on 0.6 µm are missing."""
    rng = np.random.default_rng(6)
    way = np.repeat([1, -1, 1, -1], 80)
    there = np.sort(rng.uniform(0.0, 50.0, (4, 80)), axis=1)
    target = np.concatenate([row[::s] for row, s in zip(there, way[::80], strict=True)])
    time = 0.1 * np.arange(320)
    off = 0.005 * target + 0.2 * way + 0.6 * (np.arange(320) >= 203)
    test = PositioningTest(
        axis="X",
        target=target,
        deviation=(off + 0.05 * rng.standard_normal(320)) * UM,
        cycle=np.repeat([1, 2, 3, 4], 80),
        direction=way,
        line=np.arange(320),
        time=time,
    )
    chain = one_axis_machine("X", target)
    named = [parse_effect("jump(EXX)", chain)]
    result = diagnose(positioning_run(test, chain, 0.05 * UM), named=named)
    reported = {s.effect.name: s.reported for s in result.steps if s.effect is not None}
    assert set(reported) == {"jump(EXX)", "backlash(X)"}
    assert within(reported["jump(EXX)"], {"amplitude": 0.6, "instant": 20.25})
    assert result.fit.test_rms == pytest.approx(0.05 * UM, rel=0.15)


def test_equal_readings_of_two_cycles_are_no_copies(tmp_path):
    """An instrument that reads whole micrometres reads the same one in many cycles."""
    rows = [f"{t},{j},+,{round(0.02 * t)}" for j in range(1, 6) for t in range(0, 200, 10)]
    text = "target [mm],cycle,direction,deviation [um]\n" + "\n".join(rows) + "\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "X")
    run = positioning_run(test, one_axis_machine("X", test.target), 0.5 * UM)
    assert len(without_copies(run)) == 100


def test_a_rotary_axis_that_turns_too_far(tmp_path):
    """ECC grows by 100 µrad over 90 degrees: at 1 m that is 100 µm in its sense."""
    angles = np.linspace(0.0, 90.0, 13)
    rows = [f"{a},{1e-4 * a / 90.0 / (DEG / 3600.0)}" for a in angles]
    text = "target [deg],deviation [arcsec]\n" + "\n".join(rows) + "\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "C")
    assert test.deviation[-1] == pytest.approx(100.0 * URAD)
    chain = one_axis_machine("C", test.target)
    run = positioning_run(test, chain, 1.0 * URAD)
    assert run.deviation[-1] / UM == pytest.approx(-100.0)
    assert run.u[0] / UM == pytest.approx(1.0)
    moved = np.diff(run.touches.point, axis=0)
    along = np.einsum("ni,ni->n", moved, run.touches.normal[:-1])
    assert np.all(along > 0.0), "the direction is that of growing readings"


PLATE = """name;x nom [mm];y nom [mm];x ist [mm];y ist [mm]
H1;0,0;0,0;0,000;0,000
H2;100,0;0,0;100,010;0,001
H3;0,0;100,0;-0,002;100,000
H4;100,0;100,0;100,008;100,001
"""


def test_a_part_and_a_standard_have_opposite_signs(tmp_path):
    points = read_points(read_sheet(saved(tmp_path, PLATE)))
    assert list(points.feature) == ["H1", "H2", "H3", "H4"]
    assert points.deviation[1, 0] / UM == pytest.approx(10.0)
    chain = linear_machine(points)
    part = points_run(points, "part", chain, UM)
    standard = points_run(points, "standard", chain, UM)
    assert part.deviation == pytest.approx(-standard.deviation)
    assert len(part) == 8, "a row a measured coordinate; z was not measured"
    row = np.flatnonzero((part.touches.feature == "H2") & (part.touches.normal[:, 0] == 1.0))
    assert part.deviation[row] / UM == pytest.approx([-10.0])


def test_holes_too_far_apart_are_a_scale_that_is_too_long(tmp_path):
    """Sign, end to end, of a machined part: 100.009 mm drilled for 100 is +90 ppm of X."""
    points = read_points(read_sheet(saved(tmp_path, PLATE)))
    run = points_run(points, "part", linear_machine(points), 0.1 * UM)
    ends = fitted_tip(run, np.array([[0.0, 50.0], [100.0, 50.0]]))
    assert ends[1, 0] - ends[0, 0] == pytest.approx(10.0, abs=1.0)


def test_names_and_units_of_columns():
    assert unit_of_column("Abweichung (µm)") == "µm"
    assert unit_of_column("dev_um") == "um"
    assert unit_of_column("hole_name") is None
    assert bare("Abweichung (µm)") == "Abweichung"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("target,deviation\n0,1\n10,2\n", "unknown unit"),
        ("a,b\n0,1\n10,2\n", "a column of targets"),
        ("0,1\n10,2\n", "a line of column names"),
        ("no numbers\nat all\n", "no table of numbers"),
        (
            '<?xml version="1.0"?>\n<QIFDocument idMax="5">1 2</QIFDocument>\n',
            "QIF, expected a table",
        ),
        ("target_mm;deviation_um\n0,5;1.5\n10,5;2.5\n", "one decimal mark"),
        ("target_mm,cycle,deviation_um\n0,1.5,1\n10,2,2\n", "the number of a cycle"),
    ],
)
def test_what_is_not_understood_is_refused(tmp_path, text, expected):
    with pytest.raises(BadFile, match=expected):
        read_positioning(read_sheet(saved(tmp_path, text)), "X")


def _number(cell: str) -> float | str:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return cell


def workbook(path: Path) -> None:
    """The plate as a workbook, on its second sheet."""
    book = openpyxl.Workbook()
    book.active.append(["only", "words"])
    sheet = book.create_sheet("holes")
    for line in PLATE.splitlines():
        cells = line.split(";")
        sheet.append([_number(cell) for cell in cells])
    book.save(path)


def test_a_workbook_says_the_same_as_its_text(tmp_path):
    workbook(tmp_path / "plate.xlsx")
    one = read_points(read_sheet(tmp_path / "plate.xlsx"))
    other = read_points(read_sheet(saved(tmp_path, PLATE)))
    assert np.array_equal(one.nominal, other.nominal)
    assert one.deviation[:, :2] == pytest.approx(other.deviation[:, :2])
    with pytest.raises(BadFile, match="one of Sheet, holes"):
        read_sheet(tmp_path / "plate.xlsx", "plate")


def test_import_writes_a_run_and_a_machine_that_read_back(tmp_path, answer):
    table = saved(tmp_path, wide_table())
    out = tmp_path / "run.csv"
    words = ["import", str(table), "--positioning", "X", "--u-um", "0.3", "-o", str(out)]
    assert "-(actual - target)" in answer(words)
    run = read_run(out)
    assert len(run) == 30
    assert set(run.touches.last_move("X")) == {-1.0, 1.0}
    assert run.u == pytest.approx(0.3 * UM)
    travel = float(np.ptp(run.touches.reading("X")))
    assert run.touches.chain.link("X").expected == pytest.approx(UM + 15e-6 * travel, rel=0.05)
    assert main(words) == BAD, "an existing file stays"
    assert main([*words[:4], "-o", str(tmp_path / "b.csv")]) == BAD, "an uncertainty is asked for"
    assert not (tmp_path / "b.csv").exists()


MAPPING = """format = "import/1"
[head]
machine = "machine.toml"
probe = { radius_mm = 0.0, length_mm = 0.0 }
u_um = 1.0
[columns]
Z_mm = 0.0
px_mm = 0.0
py_mm = 0.0
pz_mm = 0.0
nx = 0.0
ny = 0.0
nz = 1.0
time_s = { from = "minutes", factor = 60.0 }
dev_um = { from = "steps", factor = -2.5 }
T_bed_degC = { from = "bed", missing = -180.0 }
"""
MACHINE = """format = "machine/1"
name = "printer"
chain = "[w f Z t]"
[axis.Z]
range = [-1.0, 1.0]
"""


def test_any_table_by_a_mapping_file(tmp_path):
    saved(tmp_path, MACHINE, "machine.toml")
    table = saved(tmp_path, "minutes\tsteps\tbed\n0\t1\t20.5\n1\t3\t21.5\n2\t2\t23.0\n", "log.txt")
    mapping = saved(tmp_path, MAPPING, "map.toml")
    out = tmp_path / "run.csv"
    assert main(["import", str(table), "--map", str(mapping), "-o", str(out)]) == 0
    run = read_run(out)
    assert run.touches.time == pytest.approx([0.0, 60.0, 120.0])
    assert run.deviation / UM == pytest.approx([-2.5, -7.5, -5.0])
    assert run.touches.temperature["bed"] == pytest.approx([20.5, 21.5, 23.0])


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('from = "steps"', 'from = "stepz"', "columns.dev_um"),
        ("import/1", "import/2", "format"),
        ('machine = "machine.toml"\n', "", "head.machine"),
        ("u_um = 1.0\n", "", "u_um"),
        ("factor = -2.5", "faktor = -2.5", "dev_um"),
    ],
)
def test_faults_of_a_mapping_file_are_one_line(tmp_path, capsys, old, new, expected):
    saved(tmp_path, MACHINE, "machine.toml")
    table = saved(tmp_path, "minutes\tsteps\tbed\n0\t1\t20.5\n1\t3\t21.5\n", "log.txt")
    mapping = saved(tmp_path, MAPPING.replace(old, new), "map.toml")
    out = tmp_path / "run.csv"
    assert main(["import", str(table), "--map", str(mapping), "-o", str(out)]) == BAD
    said = capsys.readouterr().err
    assert expected in said
    assert said.count("\n") == 1
    assert not out.exists()


def test_the_command_is_a_module_of_its_own():
    assert importlib.import_module("matstd.commands.measured.import").__doc__.startswith(
        "`matstd import`"
    )


def blocks_of_the_page(language: str) -> list[str]:
    page = (Path(__file__).parents[2] / "docs" / "import.md").read_text(encoding="utf-8")
    return [part.split("```", 1)[0] for part in page.split(f"```{language}\n")[1:]]


def test_the_examples_of_the_page_are_read(tmp_path):
    positioning, circle, plate = blocks_of_the_page("csv")
    assert len(read_circle(read_sheet(saved(tmp_path, circle)), "XY", 150.0).angle) == 6
    assert len(read_positioning(read_sheet(saved(tmp_path, positioning)), "X").target) == 12
    assert len(read_points(read_sheet(saved(tmp_path, plate))).nominal) == 3
    log, report, dh = blocks_of_the_page("text")
    sheet = read_sheet(saved(tmp_path, log))
    assert read_positioning(sheet, "X", named=("motor", "scale")).direction.tolist() == [0, 1, 1]
    assert read_points(read_sheet(saved(tmp_path, report))).feature.tolist() == ["HOLE1"]
    chain, _ = arm_from_dh(read_sheet(saved(tmp_path, dh)), np.zeros((2, 6)))
    assert chain.axes == ("C", "B", "B1", "B2", "C1", "B3")
    assert blocks_of_the_page("toml")[0].replace(" ", "").count("from=") == 3


def test_two_lists_are_two_set_ups(tmp_path):
    for year in ("2019", "2026"):
        saved(tmp_path, PLATE, f"{year}.csv")
    out = tmp_path / "run.csv"
    words = [str(tmp_path / "2019.csv"), str(tmp_path / "2026.csv"), "--part", "--u-um", "1"]
    assert main(["import", *words, "-o", str(out)]) == 0
    run = read_run(out)
    assert len(run.touches.setups) == 2
    assert len(run) == 16


def test_units_in_a_row_of_their_own_behind_a_blank_and_in_an_old_encoding(tmp_path):
    """What spreadsheets of laboratories hold besides: umlauts of Windows, means below the table."""
    text = (
        "Messprotokoll;;\nPosition;1 vor;1 rück\nmm;µm;µm\n0,0;1,0;2,0\n50,5;3,0;4,0\n"
        "99,0;5,0;6,0\nMittel;3,0;4,0\n"
    )
    path = tmp_path / "old.csv"
    path.write_bytes(text.encode("cp1252"))
    sheet = read_sheet(path)
    assert sheet.columns == ("Position [mm]", "1 vor [µm]", "1 rück [µm]")
    assert sheet.left_out == (7,)
    test = read_positioning(sheet, "X")
    assert test.deviation[test.direction < 0] / UM == pytest.approx([2.0, 4.0, 6.0])
    path.write_bytes(text.replace("mm;µm;µm\n", "").replace("vor;", "vor µm;").encode("utf-16"))
    sheet = read_sheet(path)
    assert [unit_of_column(c) for c in sheet.columns] == [None, "µm", None]


def test_a_wide_table_of_actual_positions(tmp_path):
    text = "target [mm];1+;1-\n0,0;0,0010;0,0020\n50,0;50,0030;50,0040\n100,0;100,0050;100,0060\n"
    test = read_positioning(read_sheet(saved(tmp_path, text)), "X")
    assert test.deviation[test.direction > 0] / UM == pytest.approx([1.0, 3.0, 5.0])
    assert test.deviation[test.direction < 0] / UM == pytest.approx([2.0, 4.0, 6.0])


ENCODERS = "\t".join(["time [ms]", "motor [mm]", "scale [mm]", "nut [°C]"])


def test_a_log_of_two_encoders(tmp_path):
    """Strokes and directions are those of the motion; a rest belongs to the stroke before it."""
    at = [0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.5]
    rows = [f"{20 * k}\t{x}\t{x + 1e-3 * k}\t{20 + k}" for k, x in enumerate(at)]
    sheet = read_sheet(saved(tmp_path, "\n".join([ENCODERS, *rows]) + "\n", "log.txt"))
    test = read_positioning(sheet, "X", named=("motor", "scale"))
    assert test.deviation / UM == pytest.approx(np.arange(7.0))
    assert test.direction.tolist() == [0, 1, 1, 1, -1, -1, 1]
    assert test.cycle.tolist() == [1, 1, 1, 1, 2, 2, 3]
    assert test.time == pytest.approx(0.02 * np.arange(7))
    assert test.temperature["nut"] == pytest.approx(20.0 + np.arange(7))
    run = positioning_run(test, one_axis_machine("X", test.target), 0.1 * UM)
    assert run.touches.pose.tolist() == [0, 0, 0, 0, 1, 1, 2], "strokes are held out"
    assert run.deviation / UM == pytest.approx(-np.arange(7.0))
    with pytest.raises(BadFile, match="--target"):
        read_positioning(sheet, "X")
    with pytest.raises(BadFile, match="no column 'motro'"):
        read_positioning(sheet, "X", named=("motro", "scale"))


def test_a_report_with_a_row_a_coordinate(tmp_path):
    points = read_points(read_sheet(saved(tmp_path, REPORT)))
    assert points.feature.tolist() == ["HOLE1", "HOLE2"]
    assert points.nominal.tolist() == [[0.0, 0.0, 0.0], [100.0, 50.0, 0.0]]
    np.testing.assert_allclose(points.deviation[:, :2] / UM, [[1.0, 2.0], [10.0, -5.0]], atol=1e-6)
    assert np.isnan(points.deviation[:, 2]).all(), "a diameter is no coordinate"


def test_measured_coordinates_go_before_deviations_without_a_unit(tmp_path):
    text = "name,x nom,x meas,dev x\nH1,0,0.001,1\nH2,50,50.002,2\n"
    points = read_points(read_sheet(saved(tmp_path, text)))
    assert points.deviation[:, 0] / UM == pytest.approx([1.0, 2.0])
