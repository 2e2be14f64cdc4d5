"""Reports of ISO 230-2 as they come: the readings among statistics, environment and other axes."""

import numpy as np
import pytest

from matstd.cli import main
from matstd.importers import read_positioning, read_sheet
from matstd.importers.sheets import most_read, read_tables
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.units import UM

BAD = 2
TARGETS = np.arange(0.0, 301.0, 50.0)
CYCLES = 5
UP = np.round(0.012 * TARGETS[:, None] + 0.3 * np.random.default_rng(1).normal(size=(7, 5)), 2)
DOWN = np.round(UP - 3.0 + 0.3 * np.random.default_rng(2).normal(size=(7, 5)), 2)
"""Deviations, µm, a row a target and a column a cycle."""


def rows(columns, separator=","):
    return "\n".join(separator.join(f"{v:g}" for v in row) for row in np.column_stack(columns))


def both():
    """Columns of both directions, cycle after cycle."""
    return [values[:, j] for j in range(CYCLES) for values in (UP, DOWN)]


NUMBERED = ",".join(f"{j} {way} [µm]" for j in range(1, 6) for way in ("up", "down"))
COMPUTED = [f(v, axis=1) for v in (UP, DOWN) for f in (np.mean, np.std, np.ptp, np.min, np.max)]
STATISTICS = (
    "Target [mm],"
    + ",".join(
        f"{name} {way} [µm]" for way in ("up", "down") for name in ("mean", "s", "R", "min", "max")
    )
    + ",B [µm],M [µm]\n"
    + rows([TARGETS, *COMPUTED, UP.mean(1) - DOWN.mean(1), 0.5 * (UP + DOWN).mean(1)])
)
"""Has more numbers than the readings."""

READINGS = f"Target [mm],{NUMBERED}\n{rows([TARGETS, *both()])}"


def in_two_parts():
    """One direction below the other, with means beside the readings."""
    head = "No,Target [mm]," + ",".join(f"Run {j} [µm]" for j in range(1, 6))
    out = "Axis X\n"
    for word, values in (("Forward", UP), ("Backward", DOWN)):
        out += f"{word}\n{head},Mean [µm],Std dev [µm],Mean+2s [µm]\n"
        computed = [values.mean(1), values.std(1), values.mean(1) + 2.0 * values.std(1)]
        out += rows([np.arange(1, 8), TARGETS, *values.T, *computed]) + "\n"
    return out


def by_reading():
    """A row a reading below a summary and a longer table of the environment."""
    out = "Parameter,Value [µm]\nReversal B,3.1\nAccuracy A,8.2\n\nTime [min],Air [°C],Mat [°C]\n"
    out += "".join(f"{k},20.{k % 10},20.3\n" for k in range(90)) + "\n"
    out += "Replicate,Target [mm],Approach,Deviation [µm]\n"
    for j in range(CYCLES):
        for word, values in (("+", UP), ("-", DOWN)):
            out += "".join(
                f"{j + 1},{t:g},{word},{v:g}\n" for t, v in zip(TARGETS, values[:, j], strict=True)
            )
    return out


def as_in_the_standard(is_merged=False):
    """A column a target and direction, a row a cycle, computed rows below (ISO 230-2, annex)."""
    pairs = [np.column_stack([DOWN[:, j], UP[:, j]]).ravel() for j in range(CYCLES)]
    at = "; ".join(f"{t:g};" if is_merged else f"{t:g};{t:g}" for t in TARGETS)
    at = at.replace(" ", "")
    ways = ";".join(["↓;↑" if is_merged else "down;up"] * len(TARGETS))
    own = ";".join if not is_merged else lambda cells: ";".join(cells).replace(".", ",")
    lines = ["Test report ISO 230-2;Axis X", f"Target position Pi;[mm];{at}"]
    lines.append(f"Approach direction;;{ways}")
    for j, values in enumerate(pairs):
        words = "Deviations [µm]" if j == 0 else ""
        lines.append(f"{words};j = {j + 1};{own([f'{v:.2f}' for v in values])}")
    for word in ("Mean unidirectional deviation [µm]", "Estimator s [µm]"):
        lines.append(f"{word};;{own([f'{v:.2f}' for v in pairs[0]])}")
    if not is_merged:
        numbers = ";".join(str(i // 2 + 1) for i in range(2 * len(TARGETS)))
        lines.insert(1, f"i;;{numbers}")
    return "\n".join(lines) + "\n"


REPORTS = {
    "statistics first": f"ISO 230-2 report,\nAxis,X\n\n{STATISTICS}\n\nReadings\n{READINGS}\n",
    "two parts": in_two_parts(),
    "a row a reading": by_reading(),
    "transposed": as_in_the_standard(),
    "transposed, merged cells": as_in_the_standard(is_merged=True),
    "two axes": f"Axis Y\nTarget [mm],{NUMBERED}\n{rows([TARGETS, *[v + 40.0 for v in both()]])}\n"
    f"{STATISTICS}\n\nAxis X\n{READINGS}\n\n{STATISTICS}\n",
}
REPORTS["two axes in German"] = (
    REPORTS["two axes"].replace("Axis Y", "Y-Achse").replace("Axis X", "Prüfung der X-Achse")
)


@pytest.mark.parametrize("kind", REPORTS)
def test_the_readings_of_a_report_are_found(tmp_path, kind):
    (tmp_path / "report.csv").write_text(REPORTS[kind], encoding="utf-8")
    tables = read_tables(tmp_path / "report.csv")
    test = read_positioning(
        most_read(tables, lambda t: len(read_positioning(t, "X").target), "X"), "X"
    )
    assert len(test.target) == UP.size + DOWN.size
    for way, values in ((1, UP), (-1, DOWN)):
        for j in range(CYCLES):
            own = (test.direction == way) & (test.cycle == j + 1)
            order = np.argsort(test.target[own])
            np.testing.assert_allclose(test.target[own][order], TARGETS)
            np.testing.assert_allclose(test.deviation[own][order] / UM, values[:, j], atol=1e-9)


def test_tables_are_listed_and_one_can_be_chosen(tmp_path, answer):
    path = tmp_path / "report.csv"
    path.write_text(REPORTS["two axes"], encoding="utf-8")
    words = ["import", str(path), "--positioning", "X", "--u-um", "0.3", "--force"]
    out = ["-o", str(tmp_path / "run.csv")]
    said = answer([*words, *out])
    assert "1 (line 3, 7 rows): Target [mm], 1 up [µm]" in said
    assert "table 3 is read" in said
    assert np.abs(read_run(tmp_path / "run.csv").deviation).max() < 10.0 * UM
    assert main([*words, "--table", "1", *out]) == 0
    assert np.abs(read_run(tmp_path / "run.csv").deviation).min() > 30.0 * UM
    assert main([*words, "--table", "9", *out]) == BAD
    with pytest.raises(BadFile, match=r"found 9, expected 1 to 4: 1 \(line 3"):
        read_sheet(path, table=9)


def test_a_plate_measured_in_three_directions_has_a_machine_that_is_read(tmp_path):
    """All points at one height: Z gets a travel that the reader of machine files takes for one."""
    rows = "\n".join(f"{100 * (k % 3)},{80 * (k // 3)},5,0.5,-0.3,0.2" for k in range(9))
    (tmp_path / "plate.csv").write_text(f"x,y,z,dx [um],dy [um],dz [um]\n{rows}\n")
    out = tmp_path / "run.csv"
    words = ["import", str(tmp_path / "plate.csv"), "--standard", "--u-um", "1", "-o", str(out)]
    assert main(words) == 0
    run = read_run(out)
    assert run.touches.chain.link("Z").range == (-5.0, 15.0)
    assert len(run) == 27
