"""Mapping files: several readings a row, polar coordinates, times of a clock."""

import numpy as np
import pytest
from foreign_tables import SPINDLE, SPINDLE_MACHINE, SPINDLE_MAP

from matstd.importers import read_sheet
from matstd.importers.files import mapped_run
from matstd.importers.sheets import seconds
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.units import UM


@pytest.fixture
def folder(tmp_path):
    for name, text in (("machine.toml", SPINDLE_MACHINE), ("map.toml", SPINDLE_MAP)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "table.csv").write_text(SPINDLE, encoding="utf-16")
    return tmp_path


def test_a_row_of_five_probes_is_as_many_rows_of_one_pose(folder, answer):
    words = ["import", str(folder / "table.csv"), "--map", str(folder / "map.toml")]
    assert "1 reading left out" in answer([*words, "-o", str(folder / "run.csv")])
    run = read_run(folder / "run.csv")
    np.testing.assert_allclose(run.deviation / UM, [1.0, -2.0, 1.5, 2.0, -4.0])
    assert run.touches.pose.tolist() == [0, 0, 1, 2, 2]
    assert run.touches.time.tolist() == [0.0, 0.0, 90.0, 180.0, 180.0], "past midnight"
    x, y = run.touches.reading("X"), run.touches.reading("Y")
    np.testing.assert_allclose(x, [150.0, 150.0, 0.0, -150.0, -150.0], atol=1e-9)
    np.testing.assert_allclose(y, [0.0, 0.0, 150.0, 0.0, 0.0], atol=1e-9)
    assert run.touches.normal[3].tolist() == [1.0, 0.0, 0.0]


def test_a_row_with_one_reading_is_one_row(folder):
    """Without `[[rows]]`; one cell of its column is empty."""
    head, first, _ = SPINDLE_MAP.replace('"X1 [µm]"', '"Y1 [µm]"').split("[[rows]]\n")
    (folder / "map.toml").write_text(head + first, encoding="utf-8")
    text, left_out = mapped_run(read_sheet(folder / "table.csv"), folder / "map.toml")
    rows = [line for line in text.splitlines() if not line.startswith("#")]
    assert (len(rows), left_out) == (1 + 2, 1)
    assert [row.split(",")[rows[0].split(",").index("dev_um")] for row in rows[1:]] == ["2", "4"]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ('nz = 0.0\ndev_um = { from = "Y1', 'dev_um = { from = "Y1', "same columns in every one"),
        ("X1 [µm]", "X9 [µm]", "rows\\[0\\].dev_um"),
        ('of = "cos"', 'of = "tan"', "X_mm"),
    ],
)
def test_mistakes_name_their_key(folder, old, new, found):
    (folder / "map.toml").write_text(SPINDLE_MAP.replace(old, new), encoding="utf-8")
    with pytest.raises(BadFile, match=found):
        mapped_run(read_sheet(folder / "table.csv"), folder / "map.toml")


@pytest.mark.parametrize(
    ("cells", "wanted"),
    [
        (("2024-05-31 23:59:50", "2024-06-01 00:00:10.5"), [0.0, 20.5]),
        (("31.05.2024 23:59:50", "01.06.2024 00:00:10"), [0.0, 20.0]),
        (("5/31/2024 11:59:50 PM", "6/1/2024 12:00:10 AM"), [0.0, 20.0]),
        (("08:00", "09:30"), [0.0, 5400.0]),
        (("12,5", "13,0"), [12.5, 13.0]),
    ],
)
def test_clocks_of_instruments(tmp_path, cells, wanted):
    rows = "\n".join(f"{c};1;2" for c in cells)
    (tmp_path / "log.csv").write_text(f"Zeit;a;b\n{rows}\n", encoding="utf-8")
    np.testing.assert_allclose(seconds(read_sheet(tmp_path / "log.csv"), 0), wanted)


def test_a_date_that_may_be_read_in_two_ways_is_refused(tmp_path):
    text = "t;a;b\n5/6/2024 23:00:00;1;2\n6/6/2024 01:00:00;1;2\n"
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(BadFile, match="day or month first"):
        seconds(read_sheet(tmp_path / "log.csv"), 0)
