"""`effect.py` of a law: what the file computes is what the law computes, whatever its form."""

import ast
import re
from dataclasses import replace

import numpy as np
import pytest
from unchanged import drawn

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.laws import places
from matstd.diagnosis.laws.beginning import Beginning
from matstd.report.laws import effect_text, law_sentence, short_words
from matstd.report.laws.law_page import draw_law
from matstd.report.laws.law_words import formula_words
from matstd.twin.library import parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.units import UM

SENSOR, COLUMN = "bed", "coolant"


@pytest.fixture(scope="module")
def measured(stylus):
    """A run of an ideal machine with a sensor and a column of its own, and what was learnt."""
    _, (run, *_), found = stylus
    n, rng = len(run), np.random.default_rng(2)
    touches = replace(
        run.touches,
        temperature={SENSOR: 20.0 + np.cumsum(rng.normal(0.0, 0.1, n))},
        value={COLUMN: rng.integers(0, 2, n).astype(float)},
    )
    return replace(run, touches=touches, deviation=rng.normal(0.0, run.u)), found


def learnt(measured, name, at):
    """The run with a law of known amplitudes, as if it had been learnt."""
    run, found = measured
    chain = run.touches.chain
    law = parse_effect(name, chain)
    law = law.tuned(*at) if at else law
    true = (400.0 if law.is_surface else 20.0) * UM * np.linspace(1.0, 0.5, len(law.parameters))
    run = replace(run, deviation=run.deviation + columns([law], run.touches) @ true)
    model = Model(chain, (law,))
    fit = fit_run(run, model)
    one = replace(found.laws[0], law=law, rivals=())
    tangent = fit_run(run, model, free_inner=fit.theta[: len(model.parameters)])
    start = Beginning.of_run(run, Model(chain, ()))
    return replace(found, beginning=start, after=fit, tangent=tangent, laws=(one,)), run, law


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


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("law(EXX,lin T-X,quad X)", ("t_x", "x", "lin", "quad")),
        ("law(EXX,lin T-X)", ("x",)),
        ("law(EXX,lin T-lin,quad X)", ("t_lin", "x", "lin", "quad")),
        ("law(EXX,lin T-1)", ("t_1",)),
        ("law(EXX,lin V-2nd_tank_bar)", ("v_2nd_tank_bar",)),
        ("law(EXX,lin T-class)", ("t_class",)),
        ("law(EXX,bump T-np)", ("t_np",)),
        ("law(EXX,hysteresis V-play)", ("v_play",)),
        ("law(EXX,play V-a,lin X)", ("a", "x", "play_2", "lin")),
        ("law(EXX,lin T-self)", ("t_self",)),
        ("law(EXX,lin T-touches)", ("t_touches",)),
        ("law(shift,lin T-carrier)", ("t_carrier", "carrier")),
        ("law(EXX,lin trend-T-driver_of)", ("trend_t_driver_of",)),
        ("law(EXX,bump T-x0)", ("x0",)),
        ("law(EXX,bump T-w,bump X)", ("w", "x", "bump", "bump_2")),
        ("law(EXX,lin T-bump_2,bump X)", ("bump_2", "x", "lin", "bump")),
        ("law(EXX,bump T-bump_2,bump X)", ("t_bump_2", "x", "bump", "bump_2")),
        ("law(EXX,lin T-tuple,sine X)", ("t_tuple", "x", "lin", "sine")),
        ("law(EXX,lin T-s,sine X)", ("t_s", "x", "lin", "sine")),
        ("law(EXX,sine X,sine Y)", ("x", "y", "sine", "sine_2")),
        ("law(EXX,sign last-X,lin T-last_X)", ("last_x", "t_last_x", "sign", "lin")),
        ("law(EXX,lin T-a,quad T-A)", ("a", "t_a", "lin", "quad")),
        ("law(EXX,lin T-a,quad V-A)", ("a", "v_a", "lin", "quad")),
        ("law(EXX,lin T-k,quad T-\N{KELVIN SIGN})", ("k", "t_k", "lin", "quad")),
        ("law(EXX,lin T-m\N{SUPERSCRIPT TWO},quad T-m2)", ("m2", "t_m2", "lin", "quad")),
        ("law(EXX,lin V-\N{VULGAR FRACTION ONE HALF}_bar)", ("v_1_2_bar",)),
        ("law(EXX,lin T-\N{LATIN CAPITAL LETTER O WITH DIAERESIS}l)", ("\u00f6l",)),
        ("law(EXX,surface T-one,surface V-shares)",
         ("t_one", "v_shares", "shares", "inside", "one", "other", "beyond", "kept", "C")),
    ],
)  # fmt: skip
def test_every_name_of_the_file_is_valid_and_its_own(name, written, measured) -> None:
    sensors = sorted(set(re.findall(r"\b[TV]-\w+", name)))
    run, found = measured
    values = {s: 25.0 + 3.0 * np.sin(run.touches.time / 900.0 + k) for k, s in enumerate(sensors)}
    own = {s[2:]: v for s, v in values.items() if s[0] == "V"}
    temperature = {s[2:]: v for s, v in values.items() if s[0] == "T"}
    run = replace(run, touches=replace(run.touches, temperature=temperature, value=own))
    learning, run, law = learnt((run, found), name, ())
    text = effect_text(learning, "run.csv")
    (method,) = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
    targets = [node.targets[0] for node in method.body if isinstance(node, ast.Assign)]
    assert tuple(
        name.id for t in targets for name in (t.elts if isinstance(t, ast.Tuple) else [t])
    ) == written  # fmt: skip
    effect = loaded(text, run.touches.chain)
    found, expected = columns([effect], run.touches), columns([law], run.touches)
    if law.is_surface:
        (size,) = [p.sd for p in effect.parameters]
        found = found * size
        expected = expected @ learning.after.theta[learning.after.of_effect(law.name)][:, None]
    atol = (0.05 if law.is_surface else 1e-3) * np.abs(expected).max()
    assert atol > 0.0
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=atol)


@pytest.mark.parametrize("name", ["law(EZX,curve Y)", "law(EYX,surface X,surface Y)"])
def test_a_law_without_a_formula_is_a_table(name, measured) -> None:
    learning, run, law = learnt(measured, name, ())
    text = effect_text(learning, 'new\\the "run".csv')
    assert max(len(line) for line in text.splitlines()) < 100
    assert "form without a formula is that of the run" in ast.get_docstring(ast.parse(text))
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


@pytest.mark.parametrize(
    ("name", "at", "formula", "words"),
    [
        ("law(EXX,saw X)", (37.0, 0.0), "EXX = a (2 frac(X/period + phase/(2 pi)) - 1)",
         r"a saw-tooth of .* µm over X \(period 37.\d+ ± 0.\d+ mm, phase 0\.?\d* ± \d.* °\)\.$"),
        ("law(EXX,square X)", (80.0, 0.5), "EXX = a sgn sin(2 pi X/period + phase)",
         r"a square wave of .* µm over X \(period 80.\d+ ± 0.\d+ mm, phase 28\.?\d* ± \d.* °\)\.$"),
        ("law(EXX,sine X)", (80.0,), "EXX = a sin(2 pi X/period) + b cos(2 pi X/period)",
         r"a sine of .* µm over X \(period 80.\d+ ± 0.\d+ mm\)\.$"),
        ("law(EZX,bump-after time)", (2000.0, 600.0),
         "EZX = a (exp(-((time - x0)/w)^2) for time > x0, else 0)",
         r"a bump that begins at its top of .* over time at 33.\d* ± .* min "
         r"\(w 10\.\d\d ± 0\.\d\d min\)\.$"),
        ("law(EYX,step X)", (35.0,), "EYX = a (1 for X > x0, else 0)", r"a step of .* at 35.* mm"),
        ("law(EXX,settling time)", (0.0, 900.0), "EXX = a (1 - exp(-time/w))", r"\(w 15.0* ± "),
        ("law(EXX,log time)", (0.0, 900.0), "EXX = a log(1 + time/w)", r"a logarithm of"),
        ("law(EXX,half-wave azimuth)", (0.2,), "EXX = a max(0, sin(azimuth + phase))",
         r"\(phase 11.* ± .* °\)"),
        ("law(EXX,pulse time)", (600.0, 900.0),
         "EXX = a max(0, time - x0)/w exp(1 - max(0, time - x0)/w)", "a pulse that dies away"),
        ("law(EYZ,lin Z)", (-250.0, 250.0), "EYZ = a ((Z + 250 mm)/250 mm)",
         r"µm per 250 mm over Z"),
        ("law(EXX,lin Z,step X)", (-250.0, 250.0, 0.0),
         "EXX = a [((Z + 250 mm)/250 mm)] [1 for X > x0, else 0]", r"µm per 250 mm\.$"),
        ("law(EYX,quad azimuth,quad-about latitude)", (0.0, 1.0, 0.0, 1.0),
         "EYX = a [(azimuth/rad)^2] [((latitude - x0)/rad)^2]", r" µm per rad² per rad²\.$"),
        ("law(EXX,kink azimuth)", (0.1, 1.0), "EXX = a max(0, azimuth - x0)/rad",
         r"µm per rad over azimuth of the contact at"),
        (f"law(EXX,lin V-{COLUMN}_bar)", (), f"EXX = a (V-{COLUMN}_bar/bar)", r"µm per bar over"),
        (f"law(EXX,lin V-{COLUMN}_l_min)", (), f"EXX = a (V-{COLUMN}_l_min/(l/min))",
         r"µm per \(l/min\) over"),
        (f"law(EXX,quad V-{COLUMN}_x)", (), f"EXX = a (V-{COLUMN}_x/x)^2", r"µm per x² over"),
        (f"law(EXX,quad V-{COLUMN}_l_x)", (), f"EXX = a (V-{COLUMN}_l_x/x)^2", r"µm per x² over"),
        (f"law(EXX,lin V-{COLUMN}_s)", (), f"EXX = a (V-{COLUMN}_s/s)", r"µm per s over"),
        (f"law(EXX,lin V-{COLUMN}_degC)", (), f"EXX = a (V-{COLUMN}_degC/°C)", r"µm per K over"),
        (f"law(EXX,lin V-{COLUMN}_1)", (), f"EXX = a (V-{COLUMN}_1/1)", r"µm per 1 over"),
        ("law(EXX,lin time)", (0.0, 3600.0), "EXX = a (time/h)", r"µm per h over time"),
    ],
)  # fmt: skip
def test_formula_and_sentence_of_a_law(name, at, formula, words, measured) -> None:
    (run, found), (column,) = measured, measured[0].touches.value.values()
    own = {COLUMN + unit: column for unit in ("_bar", "_l_min", "_x", "_l_x", "_s", "_degC", "_1")}
    run = replace(run, touches=replace(run.touches, value=own))
    learning, _, law = learnt((run, found), name, at)
    assert formula_words(law) == formula
    assert re.search(words, law_sentence(learning, learning.laws[0]))


def test_a_line_through_zero_and_one_with_a_constant_have_words_of_their_own(measured) -> None:
    chain = measured[0].touches.chain
    one, other = (
        parse_effect(f"law(EXX,{word} X,lin T-bed)", chain) for word in ("lin", "lin-from")
    )
    assert short_words(one) != short_words(other)


def test_a_phase_is_scanned_about_the_one_found_by_three_uncertainties(measured) -> None:
    """A wave of a phase near zero can be refitted: its scan is no share of its value."""
    learning, run, law = learnt(measured, "law(EXX,saw X)", (37.0, -0.03))
    effect = loaded(effect_text(learning, "run.csv"), run.touches.chain)
    (phase,) = [i for i in effect.inner(run.touches) if i.name == "phase"]
    (u,) = [e.u for e in places(learning, law) if e.name == "phase"]
    grid = -0.03 + 3.0 * u * np.linspace(-1.0, 1.0, 9)
    np.testing.assert_allclose(phase.grid, grid, atol=0.1 * u)
    assert phase.unit == "rad"
