"""Logs of drift at the border, and the command that reads them."""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from unchanged import table_text

from matstd.cli import main
from matstd.diagnosis.drift import lead, read_law, read_log, read_probed, varying
from matstd.report.drift import clock_line
from matstd.twin.errors import BadFile
from matstd.twin.units import UM

ROOT = Path(__file__).parents[2]
HEAD = "time_min,T_nose_degC,spindle_rpm,z_um"


def rows_of(count=120, skip=()):
    t = np.arange(count) * 5.0
    nose = 20.0 + 5.0 * np.sin(t / 60.0)
    return [
        f"{m:g},{a:.4f},{1000 * (k % 30 > 15)},{3.0 * (a - 20.0):.4f}"
        for k, (m, a) in enumerate(zip(t, nose, strict=True))
        if k not in skip
    ]


def written(path, rows, head=HEAD):
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def test_units_and_means_over_steps(tmp_path):
    record = read_log(written(tmp_path / "a.csv", rows_of()), 600.0)
    assert (record.step, len(record)) == (600.0, 60)
    assert record.drives == ("nose", "spindle_rpm")
    assert record.components == ("z",)
    nose = 20.0 + 5.0 * np.sin(np.array([0.0, 5.0]) / 60.0).mean()
    assert record.drive[0, 0] == pytest.approx(nose, abs=1e-4)
    assert record.displacement[0, 0] == pytest.approx(3.0 * (nose - 20.0) * UM, abs=1e-6)


def test_a_short_gap_is_bridged_and_a_long_one_parts_the_log(tmp_path):
    short = read_log(written(tmp_path / "s.csv", rows_of(skip={40, 41})), 300.0)
    assert set(short.stretch) == {0}
    assert len(short) == 120
    long = read_log(written(tmp_path / "l.csv", rows_of(skip=range(40, 70))), 300.0)
    assert set(long.stretch) == {0, 1}
    assert "gaps, the longest of 155 min" in long.remarks[0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: r[:10], "10 rows"),
        (lambda r: [*r[:50], r[48], *r[51:]], "a later reading"),
        (lambda r: [*r[:50], "x,1,1,1", *r[51:]], "line 52, column time_min"),
        (lambda r: [f"{line.rpartition(',')[0]}," for line in r], "column z_um: found no reading"),
    ],
)
def test_what_is_wrong_in_a_log_is_one_line(tmp_path, change, words):
    path = written(tmp_path / "a.csv", change(rows_of()))
    with pytest.raises(BadFile, match=words):
        read_log(path, 300.0)


def test_a_log_without_a_displacement_is_refused(tmp_path):
    path = written(tmp_path / "a.csv", [r.rpartition(",")[0] for r in rows_of()], HEAD[:-5])
    with pytest.raises(BadFile, match="expected displacements"):
        read_log(path, 300.0)


def test_probings_stand_where_the_log_was(tmp_path):
    record = read_log(written(tmp_path / "a.csv", rows_of()), 300.0)
    ok = written(tmp_path / "p.csv", ["60,2.5,0.5", "121,3,0.5"], "time_min,z_um,u_um")
    rows, values, u = read_probed(ok, record)
    assert rows.tolist() == [11, 24]
    np.testing.assert_allclose(values[:, 0], [2.5 * UM, 3.0 * UM])
    np.testing.assert_allclose(u, 0.5)
    late = written(tmp_path / "late.csv", ["6000,2.5"], "time_min,z_um")
    with pytest.raises(BadFile, match="a time inside the log"):
        read_probed(late, record)


@pytest.mark.usefixtures("unrendered")
def test_the_command_writes_a_law_that_predicts_the_same_again(tmp_path, capsys, unchanged):
    log = written(tmp_path / "a.csv", rows_of())
    out = tmp_path / "out"
    assert main(["thermal", str(log), "--probe-every", "1", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "chosen by the blocks left out" in said
    assert "probed every" in said
    saved = json.loads((out / "thermal.json").read_text())
    left = {law["name"]: law["free_run"] for law in saved["laws"]}
    assert left["static-ridge"]["z_um"] < 0.05 * left["constant"]["z_um"]
    again = tmp_path / "again"
    law = str(out / "thermal.json")
    assert main(["thermal", str(log), "--law", law, "-o", str(again)]) == 0
    first, second = ((p / "drift.csv").read_text() for p in (out, again))
    assert first == second
    assert read_law(law).components == ("z",)
    unchanged(table_text(saved))


@pytest.mark.parametrize(
    ("law", "found"),
    [
        ({"kind": "network"}, "'network'"),
        ({"kind": "linear", "inputs": {"kind": "arx", "drives": ["T"]}}, "'arx'"),
    ],
)
def test_a_law_of_a_kind_that_is_no_longer_offered_is_refused(tmp_path, law, found):
    saved = {"format": "matstd-thermal/1", "chosen": "x", "law": law}
    path = tmp_path / "thermal.json"
    path.write_text(json.dumps(saved))
    with pytest.raises(BadFile, match=f"a law of kind {found}, expected .* learn it anew"):
        read_law(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--train-until", "0.1"], "rows to fit"),
        (["--probed", "p.csv"], "--law thermal.json"),
        (["--step-min", "0"], "--step-min 0"),
        (["--law", "a.csv"], "a.csv"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, capsys, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "a.csv", rows_of())
    assert main(["thermal", "a.csv", *options, "-o", "out"]) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_constant_sensor_is_left_out_and_reported(tmp_path):
    rows = [f"{r},21.5" for r in rows_of()]
    log = written(tmp_path / "a.csv", rows, f"{HEAD},T_dead_degC")
    record = varying(read_log(log, 300.0), np.arange(100))
    assert record.drives == ("nose", "spindle_rpm")
    assert "dead: constant in the training hours, left out" in record.remarks[0]


def test_displacements_that_answer_before_the_speed_are_reported(tmp_path):
    """A body of 40 min behind the speed; its logger's clock is 30 min ahead of the control's."""
    rpm = 1000.0 * np.array([k % 30 > 15 for k in range(150)])
    growth, course = 0.0, []
    for n in rpm:
        growth += (n / 100.0 - growth) * (1.0 - np.exp(-5.0 / 40.0))
        course.append(growth)
    said = {}
    for name, ahead in (("right", 0), ("wrong", 6)):
        rows = [
            f"{5 * k},{20.0 + 0.1 * course[k]:.4f},{rpm[k]:g},{course[k + ahead]:.4f}"
            for k in range(140)
        ]
        said[name] = lead(read_log(written(tmp_path / f"{name}.csv", rows), 300.0))
    assert said == {"right": 0.0, "wrong": 1800.0}
    assert "change 30 min before the speed does" in clock_line(said["wrong"])


@pytest.mark.slow
def test_the_real_spindle_is_predicted_within_3_2_um(tmp_path):
    """Five probes, 14 hours held out; what is chosen is chosen inside the training hours."""
    packed = ROOT / "examples" / "fl_thermal" / "fl_thermal_1min.csv.gz"
    log = tmp_path / "log.csv"
    log.write_bytes(gzip.decompress(packed.read_bytes()))
    out = tmp_path / "out"
    assert main(["thermal", str(log), "--train-until", "32.05", "-o", str(out)]) == 0
    laws = json.loads((out / "thermal.json").read_text())["laws"]
    (best,) = (law for law in laws if law["chosen"])
    assert np.sqrt(np.mean(np.square(list(best["free_run"].values())))) <= 3.2
