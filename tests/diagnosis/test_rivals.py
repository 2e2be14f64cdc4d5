"""What to write into a file, and what else would explain the run: read from the console.

Runs come from the exact simulator; mistakes are written into the text of run or machine file.
"""

import json
import re

import numpy as np
import pytest
from simulator_case import simulate_case
from simulator_experiment import MACHINES
from simulator_runs import simulated_runs

from matstd.cli import main


def compared(tmp_path, capsys, run, machine):
    """Lines of the console of `matstd compare`, and its result."""
    (tmp_path / "machine.toml").write_text(machine, encoding="utf-8")
    (tmp_path / "run.csv").write_text(run, encoding="utf-8")
    out = tmp_path / "out"
    assert main(["compare", str(tmp_path / "run.csv"), "--no-report", "-o", str(out)]) == 0
    said = re.split(r"(?m)^- ", capsys.readouterr().out)
    table = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    return [" ".join(line.split()) for line in said], table["geometry"]


def numbers(pattern, line):
    match = re.search(pattern, line)
    assert match, line
    return float(match[1])


@pytest.mark.parametrize(
    ("machine", "stated", "longer"),
    [
        ("hsm600u", -420.0, 0.3),
        pytest.param("fork", 220.0, 1.0, marks=pytest.mark.slow),
    ],
)
def test_a_probe_too_long_is_reported_beside_the_pivot(tmp_path, capsys, machine, stated, longer):
    """A longer tool R_B l and a pivot (I - R_B) l add up to l, which is where the standard stands.

    So a probe stated 1 mm too long and a pivot 1 mm off are one to this run. 0.3 mm are named by no
    trial of the description, but the line of B is more than four usual sizes off.
    """
    run, text, _ = simulate_case(np.random.default_rng([5, 0]), machine, with_alike=False, poses=5)
    run = run.replace("length_mm = 160.0", f"length_mm = {160.0 + longer}")
    lines, geometry = compared(tmp_path, capsys, run, text)
    assert not [line for line in lines if line.startswith("to copy")]
    (pivot,) = [c for c in geometry["corrections"] if c["key"] == "axis.B.point"]
    assert "length" in [n["name"] for n in pivot["cannot_be_told_from"]]
    (line,) = [line for line in lines if line.startswith("this run cannot distinguish these")]
    assert "copy one at most" in line
    length = numbers(r"probe\.length_mm = ([\d.]+)", line)
    pivot = numbers(r"\[axis\.B\] point = \[[-\d.]+, [-\d.]+, ([-\d.]+)\]", line)
    assert length == pytest.approx(160.0, abs=0.2)
    assert pivot - stated == pytest.approx(length - 160.0 - longer, abs=0.05)


def test_a_pivot_that_the_run_knows_by_itself_is_one_to_copy(tmp_path, capsys):
    """The line of C in X turns with B, which nothing else of the description does."""
    rng = np.random.default_rng([5, 0])
    run, text, _ = simulate_case(rng, "hsm600u", with_alike=False, poses=5)
    wrong = re.sub(r"(\[axis\.C\]\nrange = [^\n]*\npoint = )\[[^\]]*\]", r"\1[2.0, 0.0, 0.0]", text)
    assert wrong != text
    lines, _ = compared(tmp_path, capsys, run, wrong)
    assert not [line for line in lines if "cannot distinguish" in line]
    (line,) = [line for line in lines if line.startswith("to copy: ")]
    assert numbers(r"\[axis\.C\] point = \[([-\d.]+)", line) == pytest.approx(0.0, abs=0.2)


@pytest.fixture
def planted(tmp_path, capsys):
    """Console of a run of a machine with planted location errors."""

    def made(machine, **errors):
        (run,) = simulated_runs(np.random.default_rng(3), machine, [errors])
        return compared(tmp_path, capsys, run, MACHINES[machine])

    return made


def test_a_line_of_a_rotary_axis_far_from_its_place_is_printed(planted):
    """350 sigma and 13 usual sizes, though within what all errors of a machine may add up to."""
    lines, geometry = planted("hsm600u", EB0C=874e-6, EX0C=-0.520)
    rows = {row["symbol"]: row for row in geometry["quantities"]}
    # root mean square of a peak between 20 and 100, of either sign
    usual = np.sqrt((20.0**2 + 20.0 * 100.0 + 100.0**2) / 3.0)
    assert rows["EB0C"]["expected_urad"] == pytest.approx(usual, abs=0.5)
    (tilt,) = [line for line in lines if "(EB0C)" in line]
    (place,) = [line for line in lines if "(EX0C)" in line]
    assert numbers(r"\(EB0C\): (\d+)", tilt) == pytest.approx(874.0, abs=60.0)
    assert numbers(r"\(EX0C\): (-\d+)", place) == pytest.approx(-520.0, abs=35.0)
    wrong = "the machine file or the set-up is wrong"
    assert re.search(rf"1[34] times what is usual \(± 64 µrad\): {wrong}", tilt)
    assert re.search(rf"8\.\d times what is usual \(± 64 µm\): {wrong}", place)
    (every,) = [line for line in lines if line.startswith("line and zero of C: ")]
    for symbol in ("EX0C", "EY0C", "EA0C", "EB0C"):
        assert re.search(rf"{symbol} -?[\d.]+ ± [\d.]+ µ", every)
    # a standard that is turned about C does the same
    assert "EC0C not determined" in every
    assert "usual ± 64 µm, ± 64 µrad" in every


def test_a_zero_of_b_is_reported_beside_the_two_lines_that_it_moves(planted):
    """B turned by 874 urad tilts C as much and moves its line by 874e-6 times 420 mm."""
    lines, geometry = planted("hsm600u", EB0B=874e-6)
    found = {c["key"]: c["found"] for c in geometry["corrections"]}
    assert abs(found["axis.C.point"][0]) == pytest.approx(874e-6 * 420.0, rel=0.1)
    assert not [line for line in lines if line.startswith("to copy")]
    (line,) = [line for line in lines if "cannot distinguish" in line]
    assert "together with [axis.C] direction" in line
    size = numbers(r"the zero of B is wrong by ([-\d.]+)", line)
    assert size == pytest.approx(np.degrees(874e-6), rel=0.1)
    assert "EB0B" in [n["name"] for n in geometry["all_far_lines_cannot_be_told_from"]]


def test_machines_of_the_class_have_no_line_that_is_far(planted):
    lines, geometry = planted("hsm600u")
    assert not [
        line for line in lines if "larger than" in line or "times what" in line or "copy" in line
    ]
    assert geometry["all_far_lines_cannot_be_told_from"] == []
