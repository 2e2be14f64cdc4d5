"""Pictures and pages of a diagnosis: what they are made of by hand, and what stands in them."""

import re
from dataclasses import replace
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest
from figures import render_alone
from unchanged import page_text

from matstd.diagnosis.answer import Verdict, compare, diagnose
from matstd.diagnosis.residual import (
    binned,
    has_poses,
    partial,
    pose_vectors,
    rank_variables,
    standardised,
)
from matstd.diagnosis.residual.partial_residuals import roughness
from matstd.report.numbers import p_value, with_uncertainty
from matstd.report.pages import write_compare_page, write_diagnosis_page
from matstd.report.plots import draw_on_standard, draw_pattern, draw_rivals, is_spread
from matstd.report.plots.effect_pictures import shown_partial
from matstd.report.style import save
from matstd.report.words import region_sentence, structure_words, verdict_sentence
from matstd.report.words.diagnosis_words import named_value
from matstd.twin.effects.backlash import KIND as BACKLASH
from matstd.twin.effects.periodic import KIND as PERIODIC
from matstd.twin.library import ordinary_model
from matstd.twin.thermal.thermal_lag import KIND as LAG
from matstd.twin.units import HOUR, NM, UM

ROUNDING = 1e-9
SAME = 1e-6  # of quantities of order one, after a second solution of the same equations
BLANK = 0.02  # standard deviation of the grey values of an empty sheet, 0 to 1
ANY_ADDRESS = re.compile(r"(?:https?:)?//[\w.]+")


@pytest.fixture(scope="module")
def strange(case):
    """A run that hides what no library has, diagnosed among a few candidates."""
    run = case(32, "hsm600u", ("?cable",), False, (30.0, 35.0)).run[::3]
    return diagnose(run, candidates=list(BACKLASH.propose(run.touches)))


@pytest.fixture(scope="module")
def compared(strange):
    """The same run beside the ordinary model."""
    return compare(strange.run, ordinary_model(strange.run.touches.chain))


@pytest.fixture(scope="module")
def figures():
    """What the figures of the page consist of."""
    return {}


@pytest.fixture(scope="module")
def written(warm, figures, tmp_path_factory):
    """Folder of its page."""
    place = tmp_path_factory.mktemp("page")
    with pytest.MonkeyPatch.context() as patch:
        recorded = render_alone(patch, "")
        write_diagnosis_page(warm, place, "run & file.csv", np.random.default_rng(0))
    figures |= recorded
    return place


@pytest.fixture(scope="module")
def page(written):
    return (written / "report.html").read_text(encoding="utf-8")


def test_the_page_is_what_it_was(page, unchanged):
    unchanged(page_text(page))


def test_its_figures_are_what_they_were(written, figures, unchanged):
    unchanged("\n".join(f"{name}: {figures[name]}" for name in sorted(figures)))


def addresses(page):
    """What looks like an address outside the page, packed data aside."""
    return ANY_ADDRESS.findall(re.sub(r'data:[^"]+|id="live-arrays">[^<]*', "", page))


def text_of(page):
    """Words of a page as a reader sees them without scripts, white space made even."""
    without = re.sub(r"<style.*?</style>|<script.*?</script>|<[^>]+>", " ", page, flags=re.DOTALL)
    return re.sub(r"\s+", " ", unescape(without)).replace("−", "-")


# what the pictures are computed from


def test_standardised_residual_is_the_error_of_a_fit_without_the_row(warm):
    """Of any row the prediction error by all the other rows over its own standard deviation."""
    fit, scale = warm.start, warm.start.noise.factor
    rows = np.flatnonzero(fit.used)
    left_out = rows[[3, 100, 300]]
    for i in left_out:
        others = rows[rows != i]
        X = np.vstack([fit.X[others], np.eye(fit.X.shape[1])])  # the prior as further rows
        y = np.concatenate([fit.y[others], np.zeros(fit.X.shape[1])])
        phi = np.linalg.lstsq(X, y, rcond=None)[0]
        variance = 1.0 + fit.X[i] @ np.linalg.inv(X.T @ X) @ fit.X[i]
        by_hand = (fit.y[i] - fit.X[i] @ phi) / np.sqrt(variance)
        assert standardised(fit)[i] == pytest.approx(scale * by_hand, rel=SAME, abs=SAME)


def test_standardised_residual_of_a_gross_error_is_its_prediction_error(warm):
    fit = warm.fit
    (i, *_) = np.flatnonzero(fit.gross.rows)
    X = np.vstack([fit.X[fit.used], np.eye(fit.X.shape[1])])
    variance = 1.0 + fit.X[i] @ np.linalg.inv(X.T @ X) @ fit.X[i]
    by_hand = fit.residual[i] / (fit.run.u[i] * np.sqrt(variance))
    assert standardised(fit)[i] == pytest.approx(by_hand, rel=SAME)
    assert abs(by_hand) > fit.gross.limit


def test_bins_hold_weighted_means_with_the_scatter_of_their_touches():
    values = np.array([0.0, 0.0, 0.0, 1.0, 1.0])
    r, weight = np.array([1.0, 2.0, 6.0, 4.0, 4.0]), np.array([1.0, 1.0, 2.0, 1.0, 3.0])
    x, mean, error = binned(values, r, weight)
    # (1 + 2 + 12)/4 = 3.75; squares (7.5625 + 3.0625 + 2 * 5.0625)/4 = 5.1875, over n - 1 = 2
    np.testing.assert_allclose(x, [0.0, 1.0])
    np.testing.assert_allclose(mean, [3.75, 4.0])
    np.testing.assert_allclose(error, [np.sqrt(5.1875 / 2.0), 0.0], atol=ROUNDING)


def test_bins_of_a_continuous_variable_hold_equally_many():
    rng = np.random.default_rng(5)
    values = rng.normal(size=1200)
    x, mean, _ = binned(values, 3.0 * values, np.ones(1200), most=10)
    assert len(x) == 10
    np.testing.assert_allclose(mean, 3.0 * x, atol=ROUNDING)
    edges = np.quantile(values, np.linspace(0.1, 0.9, 9))
    assert np.all((x[:-1] < edges) & (edges < x[1:]))


def test_roughness_of_what_is_known_by_hand():
    x = np.arange(8.0)
    assert roughness(x, x) == pytest.approx(0.5 / np.var(x))  # every step is 1
    assert roughness(x, (-1.0) ** x) == pytest.approx(2.0)  # every step is 2, the variance 1
    assert roughness(x, np.full(8, 3.0)) == 0.0
    noise = np.random.default_rng(6).normal(size=4000)
    assert roughness(np.arange(4000.0), noise) == pytest.approx(1.0, abs=0.1)


def test_pose_vector_is_the_displacement_that_was_put_in(case):
    """Without a rotary axis the table's directions are the machine's, and dev = -n . d."""
    run = case(33, "hmc1995").run
    t = run.touches
    rows = (t.setup == t.setup[0]) & (t.pose == t.pose[0])
    d = np.array([3.0, -2.0, 5.0]) * UM
    residual = np.where(rows, -t.normal_table @ d, 0.0)
    fit = SimpleNamespace(
        run=run, used=np.ones(len(run), bool), u=run.u, residual=residual, rms=1.0
    )
    starts, vectors, u = pose_vectors(fit)
    assert np.all(np.diff(t.time[starts]) >= 0.0)
    (here,) = np.flatnonzero(rows[starts])
    np.testing.assert_allclose(vectors[here], d, atol=NM)
    information = t.normal_table[rows].T @ t.normal_table[rows] / run.u[0] ** 2
    np.testing.assert_allclose(u[here], np.sqrt(np.diag(np.linalg.inv(information))), rtol=1e-4)
    assert np.abs(np.delete(vectors, here, axis=0)).max() < NM


def test_partial_residual_of_a_lag_is_its_formula_over_time(warm):
    fit = warm.fit
    (effect,) = warm.found
    found, variable, quantity = shown_partial(partial(fit, effect))
    (amplitude,) = fit.theta[fit.of_effect(effect.name)]
    t = fit.run.touches
    by_hand = amplitude * (1.0 - np.exp(-t.time[found.rows] / effect.tau)) / UM
    assert variable == "time in h"
    assert quantity in {
        f"EZ{axis}, µm" for axis in "XYZBC"
    }  # the run does not say which body carries it
    np.testing.assert_allclose(found.x, t.time[found.rows] / HOUR)
    np.testing.assert_allclose(found.explained, by_hand, atol=ROUNDING)
    # the lag acts along Z between table and tool; its deviation along the normal is c . explained
    c = (fit.model.columns(t)[:, -1] * amplitude)[found.rows] / (by_hand * UM)
    left = (found.observed - found.explained) * c * UM
    np.testing.assert_allclose(left, fit.residual[found.rows], atol=NM * 1e-3)
    assert set(found.rows) == set(np.flatnonzero(fit.used))


@pytest.mark.parametrize(
    ("kind", "arguments", "tuning", "variable"),
    [
        (BACKLASH, ["X"], (), "direction of approach of X"),
        (PERIODIC, ["EXX"], (8.0,), "X within a period of 8 mm"),
        (PERIODIC, ["EXC"], (2.0,), "C in °"),
        (LAG, ["EXX", "ambient"], (1200.0,), "time in h"),
    ],
)
def test_an_effect_is_drawn_over_what_drives_it(fitted, kind, arguments, tuning, variable):
    base = fitted(34)
    effect = kind.make(base.model.chain, arguments)
    effect = effect.tuned(*tuning) if tuning else effect
    theta = np.full(len(effect.parameters), 5.0 * UM)
    fit = SimpleNamespace(
        run=base.run,
        theta=theta,
        used=base.used,
        test_rows=base.test_rows,
        residual=base.residual,
        of_effect=lambda name: slice(0, len(theta)),
    )
    found = partial(fit, effect)
    assert shown_partial(found)[1] == variable
    # without a variable it is drawn over what it explains, in the same unit
    bare = replace(found, driver=found.driver._replace(column=""), x=found.explained)
    drawn, nothing, _ = shown_partial(bare)
    assert nothing == ""
    np.testing.assert_allclose(drawn.x, found.explained / UM)
    np.testing.assert_allclose(drawn.explained, drawn.x)


# pictures


def is_drawn(path):
    """Whether a picture file holds more than an empty sheet."""
    from matplotlib.image import imread

    assert path.read_bytes().startswith(b"\x89PNG")
    return float(imread(path)[..., :3].mean(axis=2).std()) > BLANK


def test_every_picture_of_the_page_renders(written, warm):
    """Of the starting model, of the model with what was found, and of what was found."""
    assert is_spread(warm.run.touches)
    assert has_poses(warm.fit)
    drawn = {p.name for p in (written / "pictures").iterdir()}
    fits = {
        f"{fit}_{kind}.png" for fit in ("before", "after") for kind in ("over", "poses", "normal")
    }
    assert fits | {"fall.png", "candidates.png", "effect_1.png", "on_standard.png"} <= drawn
    for name in drawn:
        assert is_drawn(written / "pictures" / name), name


def test_a_fit_by_itself_and_rivals_that_coincide_are_drawn(warm, tmp_path):
    save(draw_rivals(warm.steps[1].confusion), tmp_path / "picture.png")
    assert is_drawn(tmp_path / "picture.png")
    save(draw_on_standard((("before", warm.start),)), tmp_path / "picture.png")
    assert is_drawn(tmp_path / "picture.png")
    assert [p.name for p in tmp_path.iterdir()] == ["picture.png"]


def test_a_pattern_is_drawn_over_two_variables_and_over_one(strange, compared, tmp_path):
    path = tmp_path / "picture.png"
    shapes = set()
    for found in compared.structure:
        if len(found.variables) not in shapes:
            shapes.add(len(found.variables))
            drawn = draw_pattern(strange.fit, found, np.random.default_rng(1))
            assert (drawn is not None) == (len(found.variables) <= 2)
            if drawn is not None:
                save(drawn, path)
                assert is_drawn(path)
    assert {1, 2} <= shapes


def test_the_variable_that_matters_comes_first(warm):
    """A lag from the start of the run shows over time and over what warms with it."""
    first = [panel.name for panel in rank_variables(warm.start)[:6]]
    assert "time_s" in first
    strengths = [panel.strength for panel in rank_variables(warm.start)]
    assert strengths == sorted(strengths, reverse=True)


# pages


def test_the_page_stands_alone(page):
    assert addresses(page) == []
    sources = re.findall(r'(?:src|href)="([^"]{0,60})', page)
    assert sources
    places = {f"#{name}" for name in re.findall(r'id="([^"]+)"', page)}
    assert all(s.startswith("data:image/png;base64,") or s in places for s in sources)
    assert len(re.findall("<script", page)) == 3
    assert "url(" not in page


def test_numbers_of_the_steps_stand_on_the_page_as_in_the_result(page, warm):
    text = text_of(page)
    for step in warm.steps:
        fit = step.fit
        row = rf"{fit.rms / UM:.3f} {fit.test_rms / UM:.3f} "
        assert row in text
    (step,) = warm.steps[1:]
    assert "+ growth along Z after switching on [thermal-lag(EZ" in text
    assert p_value(step.p_value) in text
    for one in step.reported:
        assert " ".join(named_value(one)).lower() in text.lower()


def test_verdict_opens_the_page(page, warm):
    text = text_of(page)
    assert warm.verdict is Verdict.MISSING
    assert warm.verdict.value in text
    assert "run & file.csv" in text
    sentence = verdict_sentence(warm)
    assert text.index(sentence) < text.index("Error after each step")
    (effect,) = warm.found
    assert effect.name in sentence
    before, after = warm.promise_before.elsewhere / UM, warm.promise.elsewhere / UM
    assert f"at other places falls from {before:.2f} µm to {after:.2f} µm" in sentence


def test_gross_errors_and_rivals_are_listed(page, warm):
    tail = text_of(page.split("Outliers</h2>")[1])
    fit = warm.fit
    rows = np.flatnonzero(fit.gross.rows)
    assert len(rows) > 2
    for i in rows:
        t = fit.run.touches
        place = f"{fit.run.line[i]} {t.feature[i]} {t.setups[t.setup[i]].name} {t.pose[i]}"
        assert f"{place} {fit.residual[i] / UM:+.1f} " in tail
    apart = text_of(page.split("Indistinguishable effects</h2>")[1].split("<h2")[0])
    for rival in warm.steps[1].confusion.rivals[:8]:
        assert rival.effect.name in apart


def test_every_detectable_effect_is_in_the_table(page, warm):
    table = text_of(page.split("Every effect</summary>")[1].split("</details>")[0])
    for found in warm.detectable:
        assert found.effect.name in table
    hidden = [d.effect.name for d in warm.detectable if d.largest is None]
    assert table.count("never: the model can imitate it") == len(hidden)


@pytest.mark.usefixtures("unrendered")
def test_an_unexplained_run_says_what_is_left(strange, tmp_path):
    assert strange.verdict is Verdict.UNEXPLAINED
    path = write_diagnosis_page(strange, tmp_path, "run.csv", np.random.default_rng(0))
    text = text_of(path.read_text(encoding="utf-8"))
    sentence = verdict_sentence(strange)
    assert sentence in text
    stated = np.sqrt(np.mean(strange.run.u**2))
    left = stated * np.sqrt(strange.fit.noise.factor**2 - 1.0) / UM
    assert f"{left:.2f} µm rms beyond the stated noise of {stated / UM:.2f} µm" in sentence
    assert structure_words(strange.depends_on[0].structure) in text
    assert (tmp_path / "pictures" / "pattern_0.png").exists()


@pytest.mark.usefixtures("unrendered")
def test_a_run_without_anything_hidden_says_so(case, tmp_path):
    run = case(35, "hmc1995", poses=5).run
    result = diagnose(run, candidates=list(BACKLASH.propose(run.touches)))
    assert result.verdict is Verdict.NONE
    text = text_of(
        write_diagnosis_page(result, tmp_path, "run.csv", np.random.default_rng(0)).read_text(
            encoding="utf-8"
        )
    )
    assert "No effect is missing that this run could show" in text
    assert f"{result.promise.same / UM:.2f} µm), and the noise is" in text


@pytest.mark.slow
@pytest.mark.usefixtures("unrendered")
def test_page_of_a_comparison_has_its_numbers(compared, tmp_path):
    found = compared
    path = write_compare_page(found, tmp_path, "run.csv", np.random.default_rng(0))
    page = path.read_text(encoding="utf-8")
    text = text_of(page)
    assert addresses(page) == []
    assert f"{found.rms / UM:.2f} µm rms remain after the fit" in text
    line = found.run.line[found.worst]
    assert f"line {line}" in text
    for region in found.where:
        assert region_sentence(region) in text
    for group in (*found.poses, *found.features):
        row = f"{group.name} {group.touches} {group.mean / UM:+.2f} {group.rms / UM:.2f}"
        assert row in text


@pytest.mark.usefixtures("unrendered")
def test_readings_of_one_place_have_no_picture_in_space(case, tmp_path):
    """A single instrument in front of one point: nothing to draw in space, and nothing breaks."""
    run = case(33, "hmc1995").run[:60]
    t = run.touches
    object.__setattr__(t, "point", np.zeros_like(t.point))
    assert not is_spread(t)
    found = compare(run, ordinary_model(t.chain))
    write_compare_page(found, tmp_path, "run.csv", np.random.default_rng(0))
    assert not (tmp_path / "pictures" / "on_standard.png").exists()
    assert (tmp_path / "pictures" / "residual_normal.png").exists()


@pytest.mark.parametrize(
    ("value", "u", "unit", "shown"),
    [
        (11.137, 0.538, "µm", "11.14 ± 0.54 µm"),
        (1234.6, 87.3, "s", "1235 ± 87 s"),
        (0.0123, 0.00045, "", "0.01230 ± 0.00045"),
        (-3.0, None, "µm", "-3.00 µm"),
        (5.0, 0.0, "µm", "5.00 µm"),
    ],
)
def test_numbers_have_two_digits_of_their_uncertainty(value, u, unit, shown):
    assert with_uncertainty(value, u, unit) == shown
