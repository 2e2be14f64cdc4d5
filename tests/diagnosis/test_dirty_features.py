"""A face that was not cleaned, and a chip, are named with their offset; noise and laws are not."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.regression import Features, find_gross
from matstd.diagnosis.remarks import OffTogether, off_together
from matstd.report.words import remark_sentence, verdict_sentence
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM

PLACES, FEATURES = 40, 12
SEEDS = range(5)


def _touched(seed: int) -> tuple[np.ndarray, np.ndarray, Features]:
    """Columns, white deviations and features, each touched in turn at places 1 mm apart."""
    rng = np.random.default_rng(seed)
    n = PLACES * FEATURES
    number, place = np.arange(n) % FEATURES, np.arange(n) // FEATURES
    point = np.column_stack([100.0 * number + place, np.zeros(n), np.zeros(n)])
    return 10.0 * rng.standard_normal((n, 20)), rng.standard_normal(n), Features(number, point)


def _found(X: np.ndarray, y: np.ndarray, features: Features) -> np.ndarray:
    """Rows that are off together."""
    gross = find_gross(X, y, np.ones(len(y), dtype=bool), None, features)[1]
    return np.zeros(len(y), dtype=bool) if gross.together is None else gross.together & gross.rows


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("size", [40.0, -8.0])
def test_every_touch_of_a_dirty_face_is_set_aside(seed, size) -> None:
    """8 % of the touches at one distance are too many and too similar for accidents."""
    X, y, features = _touched(seed)
    rows = features.number == 3
    gross = find_gross(X, y + size * rows, np.ones(len(y), dtype=bool), None, features)[1]
    assert np.array_equal(gross.rows & gross.together, rows)
    assert not gross.too_many
    assert not gross.are_many


@pytest.mark.parametrize("seed", SEEDS)
def test_a_chip_is_its_place_on_the_face(seed) -> None:
    X, y, features = _touched(seed)
    rows = (features.number == 5) & (features.point[:, 0] % 100.0 < 5.0)
    assert np.array_equal(_found(X, y + 15.0 * rows, features), rows)


def test_what_some_touches_of_a_place_show_and_others_do_not_is_no_chip() -> None:
    """A cable pulls in the fourth pose of every seven: every seventh place of the feature."""
    X, y, features = _touched(1)
    rows = (features.number == 5) & (features.point[:, 0] % 7.0 == 3.0)
    assert rows.sum() >= 5
    assert not _found(X, y + 15.0 * rows, features).any()


def test_accidents_are_not_of_one_feature() -> None:
    X, y, features = _touched(2)
    rows = np.random.default_rng(0).choice(len(y), 9, replace=False)
    y[rows] += 20.0
    assert not _found(X, y, features).any()


def test_a_law_that_displaces_a_half_of_the_features_is_no_dirt() -> None:
    X, y, features = _touched(3)
    assert not _found(X, y + 20.0 * (features.number < 6), features).any()


def test_noise_alone_names_no_feature() -> None:
    assert not any(_found(*_touched(seed)).any() for seed in range(100, 220))


def test_an_offset_that_the_model_imitates_is_not_known() -> None:
    X, y, features = _touched(4)
    rows = features.number == 3
    X[:, 0] = 1e3 * rows
    assert not _found(X, y + 20.0 * rows, features).any()


def test_the_offset_and_its_uncertainty_are_those_of_a_fit_with_a_column_for_it(case) -> None:
    """A free column for the face, by least squares with the same prior, has both."""
    run = case(11, "hsm600u").run
    rows = run.touches.feature == "pad3"
    fit = fit_run(
        replace(run, deviation=run.deviation + 25.0 * UM * rows), ordinary_model(run.touches.chain)
    )
    (found,) = off_together(fit)
    assert (found.feature, len(found.lines), found.of) == ("pad3", rows.sum(), rows.sum())
    assert found.is_whole
    unit = fit.u * fit.weight
    A = np.vstack([np.column_stack([fit.X, 1.0 / unit * rows]), np.eye(fit.X.shape[1] + 1)])
    A[-1] = 0.0  # nothing is known of the offset
    inverse = np.linalg.inv(A.T @ A)
    offset = (inverse @ A.T @ np.append(fit.y, np.zeros(fit.X.shape[1] + 1)))[-1]
    assert found.size == pytest.approx(offset, rel=1e-6)
    assert found.u == pytest.approx(float(np.sqrt(inverse[-1, -1])), rel=0.2)
    assert abs(found.size - 25.0 * UM) < 3.0 * found.u


@pytest.mark.parametrize("hidden", [(), ("periodic(EZZ)",)])
def test_the_headline_names_the_face_and_no_law_is_learnt_from_it(case, hidden) -> None:
    run, truth = case(11, "hsm600u", hidden)
    rows = run.touches.feature == "pad3"
    found = diagnose(replace(run, deviation=run.deviation + 25.0 * UM * rows))
    (off,) = [r for r in found.remarks if isinstance(r, OffTogether)]
    assert found.verdict is (Verdict.MISSING if hidden else Verdict.NONE)
    assert [e.kind for e in found.found] == [h["kind"] for h in truth["hidden"]]
    assert not found.parts.remains.is_real
    count = int(rows.sum())
    said = f"{count} of {count} touches on pad3 lie {off.size / UM:.2f} ± {off.u / UM:.2f} µm"
    assert verdict_sentence(found).startswith(
        f"{said} outside: clean pad3, or check its calibration. "
    )
    assert remark_sentence(off).startswith(said)


def test_a_chip_is_said_with_its_place(case) -> None:
    run = case(11, "hsm600u").run
    touches = run.touches
    own = touches.feature == "pad3"
    middle = touches.point[own][0]
    rows = own & (np.linalg.norm(touches.point - middle, axis=1) < 8.0)
    dirty = replace(run, deviation=run.deviation - 15.0 * UM * rows)
    (off,) = off_together(fit_run(dirty, ordinary_model(touches.chain)))
    assert not off.is_whole
    assert set(off.lines) == set(run.line[rows].tolist())
    assert abs(off.size + 15.0 * UM) < 3.0 * off.u
    x, y, z = touches.point[rows].mean(axis=0)
    said = remark_sentence(off)
    assert f"{int(rows.sum())} of {int(own.sum())} touches on pad3 lie " in said
    assert f"µm inside, about ({x:.0f}, {y:.0f}, {z:.0f}) mm on the standard: look for" in said
