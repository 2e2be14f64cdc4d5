"""Regions where a model fails: the box that was planted, its mean, and none in noise."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from marks import slow
from simulator import probe, run_text
from simulator_case import read_back
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment
from simulator_laws import local_law

from matstd.diagnosis.files.diagnosis_file import conditions_text
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.residual import Condition, Side, observed_error, regions
from matstd.diagnosis.residual.boxes import Bounded
from matstd.diagnosis.residual.failing_regions import _Constant
from matstd.importers import one_axis_machine, positioning_run
from matstd.importers.instruments import PositioningTest
from matstd.report.words.diagnosis_words import region_words
from matstd.twin.laws import carrier_of
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model
from matstd.twin.record import with_commanded
from matstd.twin.units import UM, URAD

KEY = (2, "hsm600u")


class Readings:
    """Readings as a law of the simulator asks for them."""

    def __init__(self, q) -> None:
        self.q = q

    def __len__(self) -> int:
        return len(next(iter(self.q.values())))


@pytest.fixture
def fit_with(case):
    """A function: deviations (mm) beside noise -> fit of a model without any error."""

    def made(deviation, seed=0):
        run = case(*KEY).run
        noise = np.random.default_rng(seed).normal(0.0, 0.6 * UM, len(run))
        planted = replace(run, deviation=noise + deviation, split=np.full(len(run), "", "U5"))
        return fit_run(planted, Model(run.touches.chain, ()))

    return made


def test_a_box_of_two_conditions_is_found_with_its_error(case, fit_with) -> None:
    """EBY off by 25 µrad in a corner: the deviation changes its sign with the normal."""
    t = case(*KEY).run.touches
    box = (t.reading("X") >= 10.0) & (t.reading("Y") < -5.0)
    lever = carrier_of("EBY", t.chain).columns(t)[:, 0]
    fit = fit_with(np.where(box, 25.0 * URAD * lever, 0.0))
    first = regions(fit)[0]
    assert first.wrong is not None
    assert "EBY" in (first.wrong.carrier, *first.wrong.alike)
    assert {(c.variable, c.side) for c in first.conditions} == {
        ("X_mm", Side.FROM),
        ("Y_mm", Side.BELOW),
    }
    assert (first.rows & box).sum() > 0.85 * (first.rows | box).sum()
    assert first.p_value < 1e-9
    rows, observed, weight = observed_error(fit, first)
    # the free set-up takes up a part of it: plain least squares says how much is left
    planted = np.where(box, 25.0 * URAD * lever, 0.0)
    left = planted - fit.X @ np.linalg.lstsq(fit.X, planted, rcond=None)[0]
    for inside in (box[rows], ~box[rows]):
        mean = np.average(observed[inside], weights=weight[inside])
        expected = np.average((left / lever)[rows[inside]], weights=weight[inside])
        assert mean == pytest.approx(expected, abs=2.0 * URAD)
    expected = np.average((left / lever)[box], weights=lever[box] ** 2)
    assert expected < 20.0 * URAD  # 25 is what was planted, and not what the fit leaves
    assert first.wrong.size == pytest.approx(expected, abs=4.0 * first.wrong.u)


@pytest.fixture(scope="module")
def warming():
    """200 readings at one place while it warms: regions of time that share touches."""
    time = 60.0 * np.arange(200)
    drift = 4.0 * UM * 3.0 * (1.0 - np.exp(-time / 2400.0))
    noise = np.random.default_rng(0).normal(0.0, 0.4 * UM, len(time))
    test = PositioningTest(
        axis="X",
        target=np.full(len(time), 50.0),
        deviation=drift + noise,
        cycle=np.ones(len(time), dtype=np.int64),
        direction=np.ones(len(time), dtype=np.int64),
        line=np.arange(len(time)),
        time=time,
    )
    run = positioning_run(test, one_axis_machine("X", np.array([0.0, 100.0])), 0.5 * UM)
    return fit_run(run, ordinary_model(run.touches.chain))


def test_a_size_is_the_mean_of_its_touches_whatever_other_regions_were_found(warming) -> None:
    """Readings of one axis see EXX with a lever of one: the mean deviation from their mean."""
    found = regions(warming)
    assert len(found) > 1
    time, deviation = warming.run.touches.time, warming.run.deviation
    # a deviation along the outward normal is positive where the tool stays behind
    beside, shares = deviation.mean() - deviation, False
    for region in found:
        (low, high) = (
            next((float(c.bound) for c in region.conditions if c.side is side), end)
            for side, end in ((Side.FROM, -np.inf), (Side.BELOW, np.inf))
        )
        inside = (time >= low) & (time < high)
        shares |= any((other.rows & inside).any() for other in found if other is not region)
        assert region.wrong is not None
        assert region.wrong.carrier == "EXX"
        assert region.wrong.size == pytest.approx(beside[inside].mean(), rel=1e-3)
        # the noise alone is least; what the regions leave of the drift comes on top
        assert region.wrong.u > 0.4 * UM / np.sqrt(inside.sum())
    assert shares


@pytest.mark.parametrize("index", [0, *slow(4)])
def test_a_local_law_of_the_simulator_is_found_by_its_carrier(index) -> None:
    """Its own formula beside all geometric errors of a machine, exactly simulated."""
    rng = np.random.default_rng([1, index])
    label = ("hsm600u", "fork", "hsm600u")[index % 3]
    e = random_experiment(rng, label)
    effect, carrier, part = local_law(rng, e.machine)
    effect.amplitude = 40.0 if carrier[1] in "XYZ" else 150.0
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    run = with_commanded(read_back(run_text(e, probe(e, [effect], noise), False), MACHINES[label]))
    first = regions(fit_run(run, ordinary_model(run.touches.chain)))[0]
    assert first.wrong is not None
    assert carrier in (first.wrong.carrier, *first.wrong.alike)
    readings = {a: run.touches.reading(a) for a in run.touches.chain.programmed_axes}
    where = part(Readings(readings)) >= 0.5
    assert (first.rows & where).sum() > 0.5 * (first.rows | where).sum()


@pytest.mark.parametrize("seed", [0, 1, *slow(2, 3, 4, 5)])
def test_noise_has_no_region(fit_with, seed) -> None:
    """Said of noise once in a thousand runs."""
    assert regions(fit_with(0.0, seed)) == ()


def test_a_label_with_both_signs_is_found_by_its_scatter(case, fit_with) -> None:
    t = case(*KEY).run.touches
    feature = np.unique(t.feature)[0]
    here = t.feature == feature
    rng = np.random.default_rng(5)
    fit = fit_with(np.where(here, rng.normal(0.0, 4.0 * UM, len(t)), 0.0))
    first = regions(fit)[0]
    assert Condition("feature", Side.IS, str(feature)) in first.conditions
    assert first.rms > 2.0 * 0.6 * UM


def test_conditions_in_files_and_in_words() -> None:
    two = (
        Condition("B_deg", Side.FROM, 60.0),
        Condition("time_s", Side.FROM, 1200.0),
        Condition("time_s", Side.BELOW, 2400.0),
    )
    assert conditions_text(two) == "B_deg >= 60 and 1200 <= time_s < 2400"
    assert region_words(two) == "B > 60 deg and time from 20 min to 40 min"
    on = (Condition("feature", Side.IS, "pad4"), Condition("X_mm", Side.BELOW, -12.5))
    assert conditions_text(on) == "feature = pad4 and X_mm < -12.5"
    assert region_words(on) == "on pad4 and X < -12.5 mm"


@pytest.mark.parametrize("has_memory", [False, True])
def test_sums_over_bins_are_those_of_the_column_in_each_region(has_memory) -> None:
    """By one region after the other: its column over the noise, beside the model, along what is."""
    rng, n = np.random.default_rng(3), 37
    used = np.arange(40) % 16 != 5
    u, mixed = rng.uniform(0.5, 2.0, n), np.tril(rng.normal(size=(n, n)))

    def white(columns):
        return mixed @ columns[used] if has_memory else columns[used] / u[:, None]

    space = SimpleNamespace(
        used=used,
        u=u,
        whitener=white if has_memory else None,
        Q=np.linalg.qr(rng.normal(size=(n + 2, 4)))[0],
        residual=rng.normal(size=n + 2),
    )
    column, rows = rng.normal(size=40), rng.random(40) < 0.8
    variable = Bounded("X_mm", rng.integers(0, 5, 40), (1.0, 2.0, 3.0, 4.0))
    found = _Constant(space, column, None)._sums(rows, variable)
    for i, k in zip(*np.triu_indices(5), strict=True):
        inside = rows & variable.inside(i, k)
        c = white((column * inside)[:, None])[:, 0]
        beside = space.Q[:n].T @ c
        expected = [(inside & used).sum(), c @ c - beside @ beside, c @ c, c @ space.residual[:n]]
        np.testing.assert_allclose([sums[i, k] for sums in found], expected, atol=1e-9)
