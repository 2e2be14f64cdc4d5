"""Set-ups that stand elsewhere than their file says: any displacement, any rotation."""

import re

import numpy as np
import pytest
from simulator_case import simulate_case

from matstd.diagnosis.fit import fit_run
from matstd.twin.files import read_run
from matstd.twin.library import ordinary_model
from matstd.twin.record import aligned
from matstd.twin.units import UM

AWAY, ABOUT_Z = np.array([1.0, -1.0, 0.3]), np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def case_files():
    """A run with its machine, nothing hidden; deviations follow from the readings."""
    run, machine, _ = simulate_case(np.random.default_rng(5), "hsm600u", (), False, (12.0, 40.0))
    return run, machine


def read_with(tmp_path, case_files, change):
    """The run read back with the head's set-ups changed by a function of (origin, angles)."""
    run, machine = case_files
    (tmp_path / "machine.toml").write_text(machine, encoding="utf-8")

    def moved(match):
        origin = np.array([float(v) for v in match.group(1).split(",")])
        angles = np.array([float(v) for v in match.group(2).split(",")])
        origin, angles = change(origin, angles)
        return (
            f"origin_mm = {list(map(float, origin))}\n# rotation_deg = {list(map(float, angles))}"
        )

    text = re.sub(r"origin_mm = \[(.*?)\]\n# rotation_deg = \[(.*?)\]", moved, run)
    (tmp_path / "run.csv").write_text(text, encoding="utf-8")
    return read_run(tmp_path / "run.csv")


def left(run):
    """RMS of what the ordinary model with its free set-ups leaves, µm."""
    fit = fit_run(run, ordinary_model(run.touches.chain))
    return float(np.sqrt(np.mean(fit.solution.residual**2))) * float(run.u[0]) / UM


@pytest.mark.parametrize(("shift", "turn"), [(4.0, 0.0), (0.0, 5.0), (30.0, 137.0)])
def test_a_set_up_that_stands_elsewhere_is_found_at_any_size(tmp_path, case_files, shift, turn):
    right = read_with(tmp_path, case_files, lambda o, a: (o, a))
    there = read_with(tmp_path, case_files, lambda o, a: (o + shift * AWAY, a + turn * ABOUT_Z))
    assert any("position by the touches is used" in remark for remark in there.remarks)
    assert len(there) == len(right)
    assert left(there) == pytest.approx(left(right), rel=0.02)


def test_a_set_up_that_stands_where_it_should_is_not_touched(tmp_path, case_files):
    run = read_with(tmp_path, case_files, lambda o, a: (o, a))
    assert aligned(run) == (run, ())
    assert not any("position by the touches" in remark for remark in run.remarks)


def test_touches_on_a_line_do_not_turn_the_set_up(tmp_path, case_files):
    run = read_with(tmp_path, case_files, lambda o, a: (o, a))
    point = run.touches.point
    near = np.abs(point - point[0]).max(axis=1) < 0.5
    few, _ = aligned(run[near])
    for before, after in zip(run.touches.setups, few.touches.setups, strict=True):
        assert np.allclose(before.T_table_artefact[:3, :3], after.T_table_artefact[:3, :3])
