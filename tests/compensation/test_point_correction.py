"""Corrections of one point: against the second model, and against the inverse by arrays."""

from pathlib import Path

import numpy as np
import pytest
from bench import LENGTH, oracle_tip
from marks import slow

from matstd.compensation.field import MachineErrors, correction, sample_workspace
from matstd.compensation.service import PointCorrection
from matstd.compensation.service.tabulated import error_tables
from matstd.twin.errors import DesignError, OutsideTravel
from matstd.twin.files import read_machine
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.units import DEG, NM, UM

MACHINES = Path(__file__).parents[2] / "examples" / "machines"


@pytest.fixture(scope="module")
def quick(known):
    return PointCorrection(known, LENGTH)


def test_the_corrected_machine_stands_where_it_should(quick, poses, bench_chain):
    """Second model of the machine, second formulas of its errors."""
    columns = [bench_chain.axis_index(name) for name in quick.linear_axes]
    added = np.zeros_like(poses)
    added[:, columns] = [quick.at(q) for q in poses.tolist()]
    after = oracle_tip(poses + added, bench_chain) - oracle_tip(poses, bench_chain, False)
    assert np.abs(after).max() < quick.interpolation + 3 * NM
    assert quick.interpolation < 20 * NM


def test_a_datum_is_left_alone(known, datum):
    here = PointCorrection(known, LENGTH, datum)
    assert np.abs(here.at(datum.q.tolist())).max() < here.interpolation


@pytest.mark.parametrize(
    "name", ["gantry", "vertical", "head-table", *slow("trunnion", "horizontal")]
)
def test_every_chain_is_corrected_as_by_arrays(name):
    chain = read_machine(MACHINES / f"{name}-machine.toml")
    rng = np.random.default_rng(5)
    known = [
        (e, 0.2 * rng.normal(size=len(e.parameters)) * [p.sd for p in e.parameters])
        for e in ordinary_model(chain).effects
    ]
    errors = MachineErrors.of_errors(chain, known)
    quick = PointCorrection(errors, 120.0)
    q = sample_workspace(chain, {}, 40)
    exact = correction(errors, errors.touches(q, 120.0))
    columns = [chain.axis_index(axis) for axis in quick.linear_axes]
    found = np.array([quick.at(row) for row in q.tolist()])
    assert np.abs(exact).max() > 20 * UM
    np.testing.assert_allclose(found, exact[:, columns], atol=quick.interpolation + 2 * NM)


def test_reversal_and_errors_of_two_readings(bench_chain):
    known = [
        (parse_effect("backlash(X)", bench_chain), np.array([8.0 * UM])),
        (parse_effect("coupling(EYZ,X)", bench_chain), np.array([15.0 * UM])),
    ]
    errors = MachineErrors.of_errors(bench_chain, known)
    quick = PointCorrection(errors, LENGTH)
    q = sample_workspace(bench_chain, {}, 30)
    signs = np.random.default_rng(2).integers(-1, 2, q.shape)
    exact = correction(errors, errors.touches(q, LENGTH, signs.astype(float)))
    columns = [bench_chain.axis_index(axis) for axis in quick.linear_axes]
    found = [quick.at(row, sign) for row, sign in zip(q.tolist(), signs.tolist(), strict=True)]
    np.testing.assert_allclose(found, exact[:, columns], atol=quick.interpolation + 1 * NM)
    forward, backward = (quick.at(q[0].tolist(), [s] * len(q[0])) for s in (1, -1))
    assert abs(forward[0] - backward[0]) == pytest.approx(8.0 * UM, rel=1e-3)


def test_finer_tables_leave_less(known):
    coarse, fine = (sum(t.left for t in error_tables(known, LENGTH, c * NM)) for c in (50.0, 1.0))
    assert fine < 0.1 * coarse


def test_what_cannot_be_corrected_is_refused(known, quick, bench_chain):
    q = [0.0] * len(bench_chain.axes)
    q[bench_chain.axis_index("B")] = 1.0
    with pytest.raises(OutsideTravel, match=r"B 57\.2958 degrees, beyond its travel -110 to 30"):
        quick.at(q)
    for end, beyond in ((-110.0 * DEG, -1.0), (30.0 * DEG, 1.0)):
        q[bench_chain.axis_index("B")] = end
        quick.at(q)
        q[bench_chain.axis_index("B")] = end + 2e-9 * beyond
        with pytest.raises(OutsideTravel, match="B"):
            quick.at(q)
    q[bench_chain.axis_index("B")] = float("nan")
    with pytest.raises(OutsideTravel, match="B nan"):
        quick.at(q)
    with pytest.raises(DesignError, match="points leave"):
        PointCorrection(known, LENGTH, close=1e-6 * NM)
