"""`effect.py` of a law: what the file computes is what the law computes, whatever its form."""

from dataclasses import replace

import numpy as np
import pytest
from unchanged import drawn

from matstd.diagnosis.fit import fit_run
from matstd.report.laws import effect_text, law_sentence
from matstd.report.laws.law_page import draw_law
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.units import UM

SENSOR, COLUMN = "bed", "coolant"


@pytest.fixture(scope="module")
def measured(stylus):
    """A run with a sensor and a column of its own, and what was learnt from it."""
    _, (run, *_), found = stylus
    n, rng = len(run), np.random.default_rng(2)
    touches = replace(
        run.touches,
        temperature={SENSOR: 20.0 + np.cumsum(rng.normal(0.0, 0.1, n))},
        value={COLUMN: rng.integers(0, 2, n).astype(float)},
    )
    return replace(run, touches=touches), found


def learnt(measured, name, at):
    """The run with a law of known amplitudes, as if it had been learnt."""
    run, found = measured
    chain = run.touches.chain
    law = parse_effect(name, chain)
    law = law.tuned(*at) if at else law
    true = 20.0 * UM * np.linspace(1.0, 0.5, len(law.parameters))
    run = replace(run, deviation=run.deviation + columns([law], run.touches) @ true)
    model = Model(chain, (*ordinary_model(chain).effects, law))
    fit = fit_run(run, model)
    one = replace(found.laws[0], law=law, rivals=())
    tangent = fit_run(
        run, model, free_inner=fit.theta[: sum(len(e.parameters) for e in model.effects)]
    )
    return replace(found, after=fit, tangent=tangent, laws=(one,)), run, law


def loaded(text, chain):
    """The effect of the text of a file, as its kind makes it."""
    names: dict = {}
    exec(compile(text, "effect.py", "exec"), names)
    return names["LEARNT_LAW"].make(chain, ())


@pytest.mark.parametrize(
    ("name", "at"),
    [
        ("law(EZX,bump Y)", (20.0, 50.0)),
        (f"law(EXX,lin T-{SENSOR})", ()),
        (f"law(EXX,square V-{COLUMN})", ()),
        ("law(shift,exp time)", (0.0, 3000.0)),
        ("law(EZX,lin X,step time)", ()),
        ("law(bias,bump X,bump Y)", (0.0, 90.0, 20.0, 50.0)),
        ("law(EYX,sine Y,lin X)", ()),
        ("law(EXX,step last-X)", ()),
    ],
)
def test_the_file_computes_what_the_law_computes(name, at, measured, unchanged) -> None:
    learning, run, law = learnt(measured, name, at)
    text = effect_text(learning, "run.csv")
    unchanged(f"{text}{law_sentence(learning, learning.laws[0])}\n")
    effect = loaded(text, run.touches.chain)
    found, expected = columns([effect], run.touches), columns([law], run.touches)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["law(EZX,curve Y)", "law(EYX,surface X,surface Y)"])
def test_a_law_without_a_formula_is_a_table(name, measured) -> None:
    learning, run, law = learnt(measured, name, ())
    text = effect_text(learning, "run.csv")
    assert max(len(line) for line in text.splitlines()) < 100
    effect = loaded(text, run.touches.chain)
    (size,) = [p.sd for p in effect.parameters]
    expected = (
        columns([law], run.touches) @ learning.after.theta[learning.after.of_effect(law.name)]
    )
    found = columns([effect], run.touches)[:, 0] * size  # its expected size is the one found
    assert np.abs(found - expected).max() < 0.05 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["law(EYX,surface X,surface Y)", "law(EXX,lin Y,sign last-Y)"])
def test_a_surface_is_drawn_as_a_map_and_a_reversal_from_one_side_to_the_other(
    name, measured, unchanged
) -> None:
    learning, _, law = learnt(measured, name, ())
    unchanged(drawn(draw_law(learning, law)) + "\n")
