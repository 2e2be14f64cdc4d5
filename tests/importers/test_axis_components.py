"""Straightness and tilts of a linear axis from tables, against the exact chain with such errors."""

import numpy as np
import pytest

from matstd.cli import main
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import geometry_rows
from matstd.importers import one_axis_machine, positioning_run, read_positioning, read_sheet
from matstd.twin.effects import backlash
from matstd.twin.effects.position_table import propose
from matstd.twin.files import read_run
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import Model
from matstd.twin.units import UM, URAD

POSITIONS = np.arange(0.0, 601.0, 50.0)


def table(tmp_path, heading: str, values: np.ndarray):
    """Two runs there and back, a row a reading."""
    rows = [f"Position [mm];Run;Direction;{heading}"]
    for run in (1, 2):
        for sign, order in (("+", 1), ("-", -1)):
            rows += [
                f"{POSITIONS[i]};{run};{sign};{values[i]:.4f}"
                for i in range(len(POSITIONS))[::order]
            ]
    (tmp_path / "table.csv").write_text("\n".join(rows))
    return read_sheet(tmp_path / "table.csv")


@pytest.mark.parametrize(
    ("component", "heading", "unit", "u"),
    [
        ("EYX", "Straightness [µm]", UM, 0.2 * UM),
        ("EZX", "Geradheit [µm]", UM, 0.2 * UM),
        ("EAX", "Roll [µrad]", URAD, 0.2 * URAD),
        ("EBX", "Pitch [µrad]", URAD, 0.2 * URAD),
        ("ECX", "yaw (arcsec)", np.pi / 648000.0, 0.2 * URAD),
    ],
)
@pytest.mark.parametrize("notation", ["[w f X t]", "[w X' f t]"])
def test_what_was_measured_is_what_the_axis_is_found_to_do(
    tmp_path, component, heading, unit, u, notation
) -> None:
    """A parabola: its sign and size, on a machine whose tool or whose table moves."""
    share = POSITIONS / 600.0
    shown = 30.0 * (4.0 * share * (1.0 - share))
    test = read_positioning(table(tmp_path, heading, shown), "X", component=component)
    np.testing.assert_allclose(np.ptp(test.deviation), 30.0 * unit, rtol=1e-6)
    chain = make_chain("axis", notation, {"X": Axis((0.0, 600.0))})
    run = positioning_run(test, chain, u)
    rows = {r.symbol: r for r in geometry_rows(fit_run(run, ordinary_model(chain)))}
    known = {name for name, r in rows.items() if r.is_determined}
    # a straightedge on a table that moves is seen with the lever of the table's yaw or pitch
    assert known - {"EBX", "ECX"} == {component} - {"EBX", "ECX"}
    assert component in known
    found = rows[component].estimate
    assert found.value == pytest.approx(30.0 * unit, rel=0.03)
    # the exact chain with that error sees what stands in the run, but for a constant
    bend = next(e for e in ordinary_model(chain).effects if f"{component},parabolic" in e.name)
    exact = Model(chain, (bend,)).deviation(run.touches, np.array([-15.0 * unit]))  # (1 - 2 s^2)/2
    assert np.ptp(run.deviation - exact) < 1e-3 * np.ptp(run.deviation)
    table_of = {e.name for e in propose(run.touches)}
    assert table_of == {f"position-table({component})", f"position-table({component},directions)"}
    (turning,) = backlash.propose(run.touches)
    assert turning == parse_effect(f"backlash({component})", chain)
    assert "reversal of the " in turning.title.text


def test_a_command_makes_the_run_and_shows_the_curve(tmp_path, answer, refusal) -> None:
    table(tmp_path, "Pitch [µrad]", 20.0 * np.cos(np.pi * POSITIONS / 600.0))
    out = tmp_path / "run.csv"
    words = ["import", str(tmp_path / "table.csv"), "--component", "EBX", "-o", str(out)]
    assert "angular error EBX: 40 µrad peak to valley" in answer([*words, "--u-urad", "0.5"])
    assert read_run(out).touches.deviation_unit == "µrad"
    assert main([*words, "--u-um", "0.5", "--force"]) == 2, "an angle has its uncertainty in µrad"
    words[3] = "EBC"
    assert "expected a component error of X, Y or Z" in refusal(
        [*words, "--u-urad", "0.5", "--force"]
    )


def test_positioning_asks_for_its_own_table(tmp_path) -> None:
    test = read_positioning(table(tmp_path, "Deviation [µm]", POSITIONS / 100.0), "X")
    run = positioning_run(test, one_axis_machine("X", test.target), UM)
    assert {e.name for e in propose(run.touches)} == {
        "position-table(EXX)",
        "position-table(EXX,directions)",
    }
