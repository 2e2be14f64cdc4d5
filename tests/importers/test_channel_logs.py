"""Logs with a line a value: channels in turn, arrays, alarms between them."""

import json
import time as clock

import numpy as np
import pytest

from matstd.importers import read_sheet


def stamp(t: float) -> str:
    return f"2020-12-13 16:44:{56 + t:09.6f}" if t < 4.0 else f"2020-12-13 16:45:{t - 4.0:09.6f}"


def test_channels_sampled_at_other_times_are_brought_to_one_clock(tmp_path) -> None:
    t = np.arange(0.0, 6.0, 0.1)
    own = [(a, f"IOC:Cnt {stamp(a)} {2.0 * a:.6f}") for a in t]
    other = [(a, f"IOC:Res {stamp(a)} {3.0 * a:.6f}") for a in t[::3] + 0.04]
    noted = [(1.01, f"IOC:Lim {stamp(1.01)} 1 STATE MINOR"), (2.0, "*** disconnected")]
    text = "\n".join(line for _, line in sorted(own + other + noted))
    (tmp_path / "axis.log").write_text(text)
    sheet = read_sheet(tmp_path / "axis.log")
    assert sheet.columns == ("time [s]", "IOC:Cnt", "IOC:Res")
    time, counter, resolver = (sheet.numbers(i) for i in range(3))
    assert time[0] == pytest.approx(0.1), "before its first value a channel says nothing"
    assert time[-1] <= 5.8
    np.testing.assert_allclose(counter, 2.0 * time, atol=1e-5)
    np.testing.assert_allclose(resolver, 3.0 * time, atol=1e-5)


def test_arrays_behind_their_count_follow_one_another(tmp_path) -> None:
    frames = [[0.0, 0.1, 0.2], [0.3, 0.4, 0.5]]
    text = "".join(
        f"IOC:{name} {stamp(k)} 3 {' '.join(str(round(v + off, 6)) for v in frame)}\n"
        for k, frame in enumerate(frames)
        for name, off in (("Act", 0.0), ("Ref", 0.01))
    )
    (tmp_path / "axis.log").write_text(text)
    sheet = read_sheet(tmp_path / "axis.log")
    assert sheet.columns == ("IOC:Act", "IOC:Ref")
    np.testing.assert_allclose(sheet.numbers(0), np.arange(6) * 0.1, atol=1e-9)
    np.testing.assert_allclose(sheet.numbers(1), np.arange(6) * 0.1 + 0.01, atol=1e-9)


def test_objects_a_line_are_channels_of_one_clock(tmp_path) -> None:
    """A probing every 2 s, a temperature every 20 s with a list in it; alarms say nothing."""
    lines = []
    for k in range(60):
        if k % 10 == 0:
            lines.append({"ts": 1e9 + 2.0 * k, "bed": 20.0 + k, "air": [{"temp": 18.5, "id": "C"}]})
        lines.append({"ts": 1e9 + 2.0 * k + 1.0, "z": 0.001 * k, "ok": True})
    lines.append({"ts": 1e9 + 130.0, "bed": 85.0, "air": [{"temp": 18.5}]})
    (tmp_path / "probe.json").write_text("\n".join(json.dumps(line) for line in lines))
    sheet = read_sheet(tmp_path / "probe.json")
    assert sheet.columns == ("time [s]", "bed", "air.0.temp", "z")
    time, bed, air, z = (sheet.numbers(i) for i in range(4))
    np.testing.assert_allclose(time[:2], [1.0, 3.0])
    np.testing.assert_allclose(bed, 20.0 + 0.5 * time, atol=1e-9)
    np.testing.assert_allclose(z, 0.0005 * (time - 1.0), atol=1e-9)
    assert np.all(air == 18.5)


@pytest.mark.skipif(not hasattr(clock, "tzset"), reason="the zone of a process is fixed")
def test_the_clock_of_a_log_does_not_change_with_the_zone_of_its_reader(
    tmp_path, monkeypatch
) -> None:
    """In Berlin 2020-03-29 has no hour from two to three; a line with an impossible date goes."""
    monkeypatch.setenv("TZ", "Europe/Berlin")
    clock.tzset()
    hours = ("00:59:59", "01:59:59", "02:30:00", "03:30:00", "04:30:00")
    lines = [f"{c} 2020-03-29 {h} {k}.5" for k, h in enumerate(hours) for c in ("Act", "Ref")]
    (tmp_path / "axis.log").write_text("\n".join([*lines, "Ref 2020-03-41 05:00:00 9.5"]))
    time = read_sheet(tmp_path / "axis.log").numbers(0)
    monkeypatch.undo()
    clock.tzset()
    np.testing.assert_allclose(np.diff(time), [3600.0, 1801.0, 3600.0, 3600.0])
