"""What a comparison says of its residual, beside the figures that it states."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import gauge_touches
from scipy.stats import chi2

from matstd.diagnosis.accuracy import Promise
from matstd.diagnosis.answer import Comparison, compare
from matstd.diagnosis.residual import Condition, Region, Side, Wrong
from matstd.report.run_view.next_step import comparison_step
from matstd.report.verdict import promise_sentence
from matstd.report.verdict.meanings import comparison_meaning
from matstd.report.words import comparison_sentence
from matstd.twin.library import ordinary_model
from matstd.twin.record import Run
from matstd.twin.units import UM

N = 240


def compared(times: float) -> Comparison:
    """White noise of so many times its stated size, against a machine without errors."""
    noise = times * np.random.default_rng(7).normal(size=N) * UM
    touches = gauge_touches(60.0 * np.arange(N), temperature={"frame": np.full(N, 20.0)})
    return compare(Run(touches, noise, np.full(N, UM)), ordinary_model(touches.chain))


@pytest.fixture(scope="module")
def quiet() -> Comparison:
    return compared(1.0)


def test_noise_as_stated_looks_like_noise(quiet) -> None:
    assert not quiet.where
    assert not quiet.structure
    freedoms = quiet.counted.sum() - quiet.fit.solution.effective_parameters
    assert quiet.chance == pytest.approx(chi2.sf(quiet.chi2_ratio * freedoms, freedoms))
    assert comparison_sentence(quiet).endswith("The residual looks like noise.")
    assert comparison_step(quiet, "run.csv").startswith("Nothing;")
    assert "the model holds" in comparison_meaning(quiet)


def test_a_residual_that_is_larger_than_stated_is_not_said_to_be_noise() -> None:
    """1.5 um where 1 um is stated."""
    found = compared(1.5)
    assert not found.structure
    assert not found.where
    assert found.chance < 1e-6
    words = comparison_sentence(found)
    assert "looks like noise" not in words
    assert "is larger than the stated uncertainty (probability by chance" in words
    assert "matstd diagnose run.csv" in comparison_step(found, "run.csv")
    assert "the noise is larger than stated, or the machine" in comparison_meaning(found)


def test_a_region_that_is_off_is_said_with_the_verdict(quiet) -> None:
    """The region stood two lines below `The residual looks like noise`."""
    rows = np.arange(N) < 13
    off = Wrong("EZB", (), 3.54 * UM, 0.51 * UM, False)
    box = (Condition("X_mm", Side.FROM, 2.0), Condition("X_mm", Side.BELOW, 115.0))
    region = Region(box, rows, off, 3.0 * UM, 0.3 * UM, 3.2 * UM, 1e-9)
    found = replace(quiet, where=(region,))
    words = comparison_sentence(found)
    assert "The residual is not noise: EZB off by +3.54 ± 0.51 µm where X from 2 mm" in words
    assert "looks like noise" not in words
    assert "matstd diagnose run.csv" in comparison_step(found, "run.csv")
    assert "a pattern that is not due to chance" in comparison_meaning(found)
    here = Promise(found.rms, found.rms, ())
    assert "as good as promised over all touches, but not where" in promise_sentence(found, here)
    assert "as good as promised: " in promise_sentence(quiet, here)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_what_touches_share_of_a_prediction_is_no_proof_that_it_fails(share) -> None:
    """Errors drawn as stated exceed chance of 5 % in 5 % of all runs, however they are shared."""
    rng, count, draws = np.random.default_rng(2), 120, 4000
    root = np.sqrt(share / 6.0) * rng.normal(size=(count, 6))
    each = np.einsum("nk,nk->n", root, root)
    u = np.sqrt(1.0 - share + each)
    errors = root @ rng.normal(size=(6, draws)) + np.sqrt(1.0 - share) * rng.normal(
        size=(count, draws)
    )
    ratios = np.mean((errors / u[:, None]) ** 2, axis=0)
    stated = {"shared": root, "u": u, "counted": np.ones(count, dtype=bool), "_dof": float(count)}
    chances = [
        Comparison.chance.func(SimpleNamespace(**stated, chi2_ratio=float(r))) for r in ratios
    ]
    assert 0.03 < np.mean(np.array(chances) < 0.05) < 0.07
    assert np.mean(np.array(chances) < 1e-3) < 5e-3
    assert np.mean(chi2.sf(ratios * count, count) < 1e-3) > 1e-2 or share < 0.5
