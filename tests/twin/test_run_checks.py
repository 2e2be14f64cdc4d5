"""Runs whose rows, all or single ones, cannot be measurements: refused, or left out and reported.

A ball of 3 mm touches a sphere of 50 mm from all sides on a machine without errors, so that every
deviation is known without any fit: zero, and what a test does to it.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.units import UM

MACHINE = """format = "machine/1"
name = "test"
chain = "[w f X Y Z t]"
[axis.X]
range = [-400.0, 400.0]
[axis.Y]
range = [-300.0, 300.0]
[axis.Z]
range = [-500.0, 200.0]
"""
HEAD = """# format = "run/1"
# machine = "machine.toml"
# probe = { radius_mm = %g, length_mm = 100.0 }
# u_um = 0.6
"""
COLUMNS = ["time_s", "X_mm", "Y_mm", "Z_mm", "px_mm", "py_mm", "pz_mm", "nx", "ny", "nz"]
COUNT = 60
SIZE = 20.0 * UM
"""Deviations of the run, drawn: sum of a machine's errors, root mean square."""


def rows() -> np.ndarray:
    """Rows of the columns above; the ball stands outside the sphere by the deviation."""
    rng = np.random.default_rng(3)
    normal = rng.normal(size=(COUNT, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    ball = normal * (50.0 + 3.0 + SIZE * rng.normal(size=COUNT))[:, None]
    reading = ball + np.array([0.0, 0.0, 100.0])
    reading[:, 2] = ball[:, 2] + 100.0
    return np.column_stack([10.0 * np.arange(COUNT), reading, 50.0 * normal, normal])


def write(
    folder: Path, table: np.ndarray, extra: dict[str, list] | None = None, radius=3.0
) -> Path:
    (folder / "machine.toml").write_text(MACHINE)
    columns = [*COLUMNS, *(extra or {})]
    cells = [[*(f"{v:.9f}" for v in row), *more] for row, more in _joined(table, extra or {})]
    lines = [",".join(columns), *(",".join(str(c) for c in row) for row in cells)]
    path = folder / "run.csv"
    path.write_text(HEAD % radius + "\n".join(lines) + "\n")
    return path


def _joined(table: np.ndarray, extra: dict[str, list]):
    more = zip(*extra.values(), strict=True) if extra else ([] for _ in table)
    return zip(table, more, strict=True)


def true_deviation() -> np.ndarray:
    table = rows()
    return np.linalg.norm(table[:, 1:4] - [0.0, 0.0, 100.0], axis=1) - 53.0


def stated(factor: float = 1.0 / UM, digits: int = 6) -> dict[str, list]:
    return {"dev_um": [f"{d * factor:.{digits}f}" for d in true_deviation()]}


def in_steps(table: np.ndarray) -> None:
    """Readings to 2 µm, deviations to 0.1 µm: rounded otherwise they are no slips."""
    table[:, 1:4] = np.round(table[:, 1:4] / 2e-3) * 2e-3


def nominal(table: np.ndarray) -> None:
    """Such readings agree with any stated deviation."""
    table[:, 1:4] = table[:, 7:10] * 53.0 + [0.0, 0.0, 100.0]


@pytest.mark.parametrize("change", [len, in_steps, nominal])
def test_a_right_run_is_taken_as_it_is(tmp_path: Path, change) -> None:
    table = rows()
    change(table)
    run = read_run(write(tmp_path, table, stated()))
    assert len(run) == COUNT
    assert run.remarks == ()
    np.testing.assert_allclose(run.deviation, true_deviation(), atol=1e-3 * UM)


@pytest.mark.parametrize(
    ("factor", "expected"),
    [
        (1.0, "column dev_um: found typically .*as the readings say: are these mm in a column of"),
        (1e6, "column dev_um: found .* mm and the like in .* of 60 rows, expected some µm"),
        (-1e3, "column dev_um: found typically .* are these of the other sign"),
    ],
)
def test_stated_deviations_in_another_unit(tmp_path: Path, factor: float, expected: str) -> None:
    with pytest.raises(BadFile, match=expected):
        read_run(write(tmp_path, rows(), stated(factor, 9)))


def test_deviations_of_another_instrument_are_its_own(tmp_path: Path) -> None:
    """Readings are nominal there, so that they say nothing of what the instrument read."""
    table = rows()
    found = np.random.default_rng(8).normal(size=COUNT)
    run = read_run(write(tmp_path, table, {"dev_um": [f"{d:.6f}" for d in found]}))
    np.testing.assert_allclose(run.deviation, found * UM, atol=1e-3 * UM)


def test_readings_that_belong_to_other_touches_are_refused(tmp_path: Path) -> None:
    """X is off by 80 mm in every other row: no place of the standard fits all of them."""
    table = rows()
    table[::2, 1] += 80.0
    with pytest.raises(BadFile, match=r"column dev_um: found .* µm where the readings say .* mm"):
        read_run(write(tmp_path, table, stated()))


@pytest.mark.parametrize(("column", "off"), [(1, 0.18), (1, 80.0), (2, -0.5), (3, 0.02)])
def test_one_reading_beside_its_deviation_is_left_out(
    tmp_path: Path, column: int, off: float
) -> None:
    """A slip of some hundredths along the normal, in a file where all else says the same twice."""
    table = rows()
    row = int(np.argmax(np.abs(table[:, 6 + column])))
    table[row, column] += off
    run = read_run(write(tmp_path, table, stated()))
    (remark,) = run.remarks
    assert re.search(
        rf"line {row + 6}, column dev_um: .* µm where the readings say .* cannot be", remark
    )
    assert len(run) == COUNT - 1
    assert row + 6 not in run.line


def test_readings_of_another_place_move_the_set_up_and_say_so(tmp_path: Path) -> None:
    table = rows()
    table[:, 1] += 80.0
    run = read_run(write(tmp_path, table, stated()))
    (remark,) = run.remarks
    assert re.search(r"set-up a is 80(\.0+)? mm", remark)
    np.testing.assert_allclose(run.deviation, true_deviation(), atol=1e-3 * UM)


def test_small_disagreement_with_the_readings_is_reported(tmp_path: Path) -> None:
    """Every deviation is stated 10 µm larger than readings give it: ten times its uncertainty."""
    more = {"dev_um": [f"{d / UM + 10.0:.6f}" for d in true_deviation()]}
    (remark,) = read_run(write(tmp_path, rows(), more)).remarks
    assert remark.startswith("dev_um and the deviations that follow from the readings differ by ")


@pytest.mark.parametrize(
    ("radius", "sign", "expected"),
    [
        (
            3.0,
            -1.0,
            "nx, ny, nz: found normals with which every side .* 6.* mm inside its position",
        ),
        (6.0, 1.0, "probe.radius_mm: found 6 with which every side .* 3 mm inside its position"),
        (0.0, 1.0, "probe.radius_mm: found 0 with which every side .* 3 mm outside its position"),
    ],
)
def test_sides_that_all_stand_off_alike(
    tmp_path: Path, radius: float, sign: float, expected: str
) -> None:
    table = rows()
    table[:, 7:] *= sign
    with pytest.raises(BadFile, match=expected):
        read_run(write(tmp_path, table, radius=radius))


@pytest.mark.parametrize("radius", [2.0, 2.4, 4.0])
def test_a_radius_that_stated_deviations_contradict_is_named(tmp_path: Path, radius: float) -> None:
    """The deviations are those of 3 mm: the readings say more or less by the radius everywhere."""
    with pytest.raises(BadFile, match=rf"probe\.radius_mm: found {radius:g}, expected 3\.00, with"):
        read_run(write(tmp_path, rows(), stated(), radius=radius))
    table = rows()
    table[:, 1] += 0.9  # a set-up elsewhere shows on two sides with opposite signs
    assert len(read_run(write(tmp_path, table, stated()))) == COUNT


def test_a_standard_somewhere_else_is_no_wrong_radius(tmp_path: Path) -> None:
    """The set-up is fitted later: a millimetre of it is no reason to refuse."""
    table = rows()
    table[:, 1] += 1.0
    assert len(read_run(write(tmp_path, table))) == COUNT


@pytest.mark.parametrize(
    ("column", "value", "expected"),
    [
        (1, -9999.0, "line 12, column X_mm: -9999 cannot be, expected a reading within the travel"),
        (4, 250.0, "line 12, deviation computed from the readings: .* mm cannot be, expected some"),
    ],
)
def test_a_slip_of_one_row_is_left_out_and_reported(
    tmp_path: Path, column: int, value: float, expected: str
) -> None:
    table = rows()
    table[6, column] = value
    run = read_run(write(tmp_path, table))
    assert len(run) == COUNT - 1
    assert 12 not in run.line
    (remark,) = run.remarks
    assert remark.endswith("the row is left out")
    assert re.match(expected, remark)


def test_slips_in_many_rows_are_no_slips(tmp_path: Path) -> None:
    table = rows()
    table[10:20, 1] *= 1000.0
    with pytest.raises(BadFile, match="and the like in 10 of 60 rows, expected a reading within"):
        read_run(write(tmp_path, table))


def test_a_touch_at_the_limit_is_used(tmp_path: Path) -> None:
    machine = MACHINE.replace("[-400.0, 400.0]", "[-400.0, 52.0]")
    path = write(tmp_path, rows())
    (tmp_path / "machine.toml").write_text(machine)
    furthest = rows()[:, 1].max()
    limit = furthest - 1.0
    (tmp_path / "machine.toml").write_text(machine.replace("52.0", f"{limit:.3f}"))
    run = read_run(path)
    assert len(run) == COUNT
    assert any("column X_mm" in remark and remark.endswith("used so") for remark in run.remarks)


@pytest.mark.parametrize(
    ("gaps", "is_asked"),
    [
        (np.random.default_rng(1).uniform(20e3, 80e3, COUNT), True),  # 20 to 80 s a touch, in ms
        (np.random.default_rng(1).uniform(20.0, 80.0, COUNT), False),
        (np.full(COUNT, 7.2e4), False),  # an indicator is read every twenty hours for 50 days
    ],
)
def test_a_clock_in_milliseconds_is_asked_about(tmp_path: Path, gaps, is_asked: bool) -> None:
    table = rows()
    table[:, 0] = np.cumsum(gaps)
    remarks = read_run(write(tmp_path, table)).remarks
    assert [r for r in remarks if "looks like milliseconds; nothing was changed" in r] == list(
        remarks
    )
    assert bool(remarks) == is_asked


@pytest.mark.parametrize(
    ("spindle", "ambient", "is_asked"),
    [
        ((68.0, 78.0), (20.0, 20.5), True),  # 20 to 25.6 °C
        ((68.0, 52.0), (20.0, 20.5), True),
        ((55.0, 45.0), (20.0, 20.5), False),  # a spindle that has run: 12.8 °C beside 20
        ((20.0, 38.0), (20.0, 20.5), False),
        ((68.0, 39.0), (20.0, 20.5), False),  # a hot one that cools: 3.9 °C in the end
    ],
)
def test_a_sensor_in_fahrenheit_is_asked_about(
    tmp_path: Path, spindle, ambient, is_asked: bool
) -> None:
    ends = {"T_spindle_degC": spindle, "T_ambient_degC": ambient}
    more = {name: np.linspace(*two, COUNT).tolist() for name, two in ends.items()}
    remarks = read_run(write(tmp_path, rows(), more)).remarks
    asked = [r for r in remarks if "T_spindle_degC begins with 68, which are 20 °C" in r]
    assert bool(asked) == is_asked
    assert not [r for r in remarks if "ambient" in r]


def test_a_clock_that_stands_still_is_reported(tmp_path: Path) -> None:
    table = rows()
    table[:, 0] = 0.0
    run = read_run(write(tmp_path, table))
    assert run.remarks == ("time_s is 0 in every row: no effect of time can be found",)


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"PK\x03\x04" + bytes(range(256)), "found a zip archive, such as a workbook of Excel"),
        (b"\x00\x01\x93\xff\x00", "found no text, expected a text file"),
        (b"MATSTD LOG 1\r\n", "line 1: found the log of a probing program, expected a run file"),
        ('# format = "run/1"\n'.encode("utf-16"), "found text in UTF-16"),
        (b'# format = "run/1"\n# # Pr\xfcfstand\n', "line 2: found byte 0xfc, which is no UTF-8"),
        (b'# format = "run/1"\n# u_um = 0,6\n', "line 2: found 'u_um = 0,6', .* a point in decim"),
        (b'# format = "run/1"\n# # \x00\n', "line 2: .*, expected a whole TOML file"),
    ],
)
def test_what_is_no_text_is_named(tmp_path: Path, data: bytes, expected: str) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(data)
    with pytest.raises(BadFile, match=expected):
        read_run(path)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda t: t.replace("time_s", "Time_s"), "column 'Time_s'; did you mean time_s"),
        (lambda t: t.replace("u_um = 0.6", "u_mm = 0.6"), "unknown key; did you mean u_um"),
        (lambda t: t.replace("radius_mm", "radius"), "unknown key; did you mean radius_mm"),
        (lambda t: t.replace("run/1", "run/2"), "files of other versions are not read"),
        (lambda t: t[: len(t) // 2], "cells under 10 column names .is the row cut off"),
        (lambda t: t.replace("0.000000000,", "0,000000000,", 1), "11 cells .*decimal comma"),
    ],
)
def test_what_was_meant_is_said(tmp_path: Path, change, expected: str) -> None:
    path = write(tmp_path, rows())
    path.write_text(change(path.read_text()))
    with pytest.raises(BadFile, match=expected):
        read_run(path)
