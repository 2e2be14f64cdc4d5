"""Temperatures by the clock: joined to a run by interpolation, refused where they do not fit."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from matstd.twin.errors import BadFile
from matstd.twin.files import read_sensors
from matstd.twin.record import Run, at_poses

BEGIN = datetime(2031, 5, 6, 23, 59, 0)
TEXT = """clock,T_ram_degC,T_room_degC
2031-05-06T23:58:00,20.0,20.5
2031-05-07T00:00:00,24.0,20.5
2031-05-07T00:10:00,25.0,20.5
"""


@pytest.fixture
def run(chain) -> Run:
    """Three touches, one, one and a half and six minutes after the first reading."""
    touches = at_poses(chain, np.zeros((3, len(chain.axes))), 160.0)
    touches = replace(touches, time=np.array([0.0, 30.0, 300.0]))
    return Run(touches, np.zeros(3), np.full(3, 1e-3))


def record(folder, text=TEXT):
    path = folder / "sensors.csv"
    path.write_text(text, encoding="utf-8")
    return read_sensors(path)


def test_readings_between_two_times_are_shared_out(tmp_path, run):
    joined = record(tmp_path).joined(run, BEGIN)
    # 23:59:00 halfway from 20 to 24; 23:59:30 three quarters; 00:04:00 four tenths from 24 to 25
    np.testing.assert_allclose(joined.touches.temperature["ram"], [22.0, 23.0, 24.4], atol=1e-9)
    assert any("T_room_degC is constant" in remark for remark in joined.remarks)


def test_a_column_that_nothing_reads_is_said(tmp_path):
    text = TEXT.replace("T_room_degC", "S_spindle_rpm")
    (remark,) = record(tmp_path, text).remarks
    assert "column 'S_spindle_rpm' is not used" in remark


def test_a_record_of_another_day_is_refused(tmp_path, run):
    with pytest.raises(BadFile, match="expected readings over the run, 2031-05-08 23:59"):
        record(tmp_path).joined(run, datetime(2031, 5, 8, 23, 59, 0))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("clock,", "time,", "expected a column clock"),
        ("2031-05-07T00:00:00", "7.5.2031 0:00", "line 3, column clock: found '7.5.2031 0:00'"),
        ("2031-05-07T00:00:00", "2031-05-06T23:57:00", "line 3, column clock"),
        ("2031-05-07T00:00:00", "2031-05-07T00:00:00Z", "expected local date and time"),
        ("T_ram_degC,T_room_degC", "ram,room", "expected a column T_<sensor>_degC"),
        (TEXT[TEXT.index("2031-05-07") :], "", "expected two readings"),
    ],
)
def test_bad_input_gets_one_line(tmp_path, old, new, expected):
    assert old in TEXT
    with pytest.raises(BadFile) as caught:
        record(tmp_path, TEXT.replace(old, new))
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
