"""Regions where a model fails: the box that was planted, its mean, and none in noise."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.files.diagnosis_file import conditions_text
from matstd.diagnosis.fit.identification import fit_run
from matstd.diagnosis.residual.failing_regions import Condition, Side, regions
from matstd.report.words.diagnosis_words import region_words
from matstd.twin.model.model import Model
from matstd.twin.units import DEG, UM

KEY = (2, "hsm600u")
SIGMAS = 4.0


@pytest.fixture
def fit_with(case):
    """A function: deviations (mm) beside noise -> fit of a model without any error."""

    def made(deviation, seed=0):
        run = case(*KEY).run
        noise = np.random.default_rng(seed).normal(0.0, 0.6 * UM, len(run))
        planted = replace(run, deviation=noise + deviation, split=np.full(len(run), "", "U5"))
        return fit_run(planted, Model(run.touches.chain, ()))

    return made


def test_a_box_of_two_conditions_is_found_with_its_mean(case, fit_with) -> None:
    t = case(*KEY).run.touches
    box = (t.reading("B") < -40.0 * DEG) & (t.reading("C") > 100.0 * DEG)
    fit = fit_with(np.where(box, 6.0 * UM, 0.0))
    first = regions(fit)[0]
    assert {(c.variable, c.side) for c in first.conditions} == {
        ("B_deg", Side.BELOW),
        ("C_deg", Side.FROM),
    }
    assert (first.rows & box).sum() > 0.85 * (first.rows | box).sum()
    # a set-up takes some of it: reported is what the residual has, over the poses that judge
    judges = np.unique(np.column_stack([t.setup, t.pose]), axis=0, return_inverse=True)[1] % 2 == 0
    seen = first.rows & fit.used & judges.reshape(-1)
    assert first.mean == pytest.approx(fit.residual[seen].mean())
    assert first.u == pytest.approx(0.6 * UM / np.sqrt(seen.sum()) * fit.noise.factor, rel=1e-6)
    assert first.mean > SIGMAS * first.u
    assert first.p_value < 1e-9


@pytest.mark.parametrize("seed", range(12))
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
