"""Hidden effects in simulated runs: found, sized, or honestly not; nothing where nothing is.

The simulator is exact and knows its effects by their own formulas; the sizes asked for here are
those that it used.
"""

from dataclasses import replace

import numpy as np
import pytest
from simulator_experiment import random_experiment, random_noise
from unchanged import answer_text

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.remarks import What
from matstd.report.words import verdict_sentence
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.units import UM

WITHIN = 4.0
"""Standard uncertainties between a size found and the true one; by chance 1 in 16000."""
HELD_OUT = 0.05
"""Held-out RMS beside the RMS of the very noise that the simulator added, of which a fit of a
hundred parameters to seven hundred touches leaves a sample that differs by 2 %."""

NOTHING = (3, "hsm600u", (), True, (12.0, 40.0), 5)
SINGLE = {
    "backlash(X)": (2, "hsm600u"),
    "thermal-lag(EXC)": (5, "hsm600u"),
    "probe-lobing": (7, "fork"),
    "thermal-expansion(Y,scaleY)": (8, "hmc1995"),
    "coupling(EBX,C)": (9, "hsm600u"),
    "artefact-slip": (10, "hmc1995"),
}
SLOW = {*SINGLE} - {"thermal-lag(EXC)"}
"""Reversals and expansions are found by the default tests of signs and of the search's limit."""
TWO = (12, "hmc1995", ("backlash(Y)", "stylus-bending"))
UNKNOWN = (2, "hsm600u", ("?pump",))
WEAK = (14, "hmc1995", ("backlash(X)",), False, (1.5, 1.5), 5)


def added_noise(seed, machine):
    """RMS of the noise of a plain case, mm: drawn again as the case drew it."""
    rng = np.random.default_rng(seed)
    noise, _, _ = random_noise(rng, len(random_experiment(rng, machine).time), hard=False)
    return float(np.sqrt(np.mean(noise**2)))


def names_of(step):
    """A found effect and everything that it is said to be like."""
    return {step.effect.name, *(r.effect.name for r in step.confusion.rivals)}


def amplitude(reported):
    return next(r for r in reported if r.name.startswith("amplitude"))


def test_nothing_hidden_nothing_found(case, diagnosed) -> None:
    """Neither chips nor noise that is not as stated make an effect."""
    d = diagnosed(*NOTHING)
    assert d.verdict is Verdict.NONE
    assert d.found == ()
    assert len(d.steps) == 1
    assert d.steps[0].effect is None
    assert d.left == ()
    assert d.depends_on == ()
    assert d.plans == ()
    assert verdict_sentence(d).startswith("No effect is missing")
    assert min(c.p_value for c in d.candidates) > 1e-3
    assert np.flatnonzero(d.fit.gross.rows).tolist() == case(*NOTHING).truth["chips"]
    assert any(getattr(r, "what", None) is What.OUTLIERS_LEFT_OUT for r in d.remarks)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in SLOW else ()) for n in SINGLE]
)
def test_one_effect_is_named_with_its_size(case, diagnosed, name) -> None:
    key = (*SINGLE[name], (name,))
    (hidden,) = case(*key).truth["hidden"]
    assert hidden["detectable"]
    d = diagnosed(*key)
    assert d.verdict is Verdict.MISSING
    assert len(d.found) == 1
    (step,) = d.steps[1:]
    assert name in names_of(step)
    assert step.p_value < 1e-6
    assert d.fit.standardised_test_rms == pytest.approx(added_noise(*SINGLE[name]), rel=HELD_OUT)
    assert d.steps[0].fit.test_rms > d.fit.test_rms
    assert d.steps[0].fit.noise.chi2_ratio > 1.1
    if step.effect.name == name:  # of a rival the size means something else
        size = amplitude(step.reported)
        assert abs(abs(size.value) - hidden["amplitude"]) < WITHIN * size.u
        assert size.u < hidden["amplitude"] / 5.0  # else the line above says nothing
    assert verdict_sentence(d).startswith("The model lacks one effect: ")


@pytest.mark.slow
def test_most_single_effects_are_named_themselves_first(diagnosed) -> None:
    """Six of six, but for a lag, which any component of the same place and direction imitates."""
    first = [diagnosed(*SINGLE[n], (n,)).found[0].name == n for n in SINGLE]
    assert sum(first) >= len(first) - 1


@pytest.mark.parametrize(
    "key",
    [NOTHING, (*SINGLE["thermal-lag(EXC)"], ("thermal-lag(EXC)",)), WEAK],
    ids=["nothing", "lag", "weak"],
)
def test_the_answer_is_what_it_was(diagnosed, key, unchanged) -> None:
    unchanged(answer_text(diagnosed(*key)))


def test_signs(case) -> None:
    """The simulator's amplitudes are positive by its formulas, which are those of the contract."""
    for name in ("backlash(X)", "thermal-expansion(Y,scaleY)"):
        run = case(*SINGLE[name], (name,)).run
        chain = run.touches.chain
        model = Model(chain, (*ordinary_model(chain).effects, parse_effect(name, chain)))
        assert fit_run(run, model).theta[len(model.parameters) - 1] > 0.0
    run = case(2, "hsm600u", ("backlash(X)",)).run[::3]
    (hidden,) = case(2, "hsm600u", ("backlash(X)",)).truth["hidden"]
    turned = columns([parse_effect("backlash(X)", run.touches.chain)], run.touches)[:, 0]
    back = replace(run, deviation=run.deviation - 2.0 * hidden["amplitude"] * UM * turned)
    (step,) = diagnose(back, candidates=[parse_effect("backlash(X)", run.touches.chain)]).steps[1:]
    size = amplitude(step.reported)
    assert abs(size.value + hidden["amplitude"]) < WITHIN * size.u


def test_inner_parameters_are_found_with_their_uncertainty(case, diagnosed) -> None:
    """Time constant within what is stated for it; number of lobes exactly."""
    key = (*SINGLE["thermal-lag(EXC)"], ("thermal-lag(EXC)",))
    (hidden,) = case(*key).truth["hidden"]
    (step,) = diagnosed(*key).steps[1:]
    tau = next(r for r in step.reported if r.name == "tau_min")
    assert tau.u is not None
    assert abs(tau.value - hidden["inner"]["tau_min"]) < WITHIN * tau.u
    assert tau.u < 0.5 * tau.value
    key = (*SINGLE["probe-lobing"], ("probe-lobing",))
    run = case(*key).run[::3]
    few = [parse_effect(n, run.touches.chain) for n in ("probe-lobing", "backlash(X)")]
    (step,) = diagnose(run, candidates=few).steps[1:]
    lobes = next(r for r in step.reported if r.name == "lobes")
    assert lobes.value == case(*key).truth["hidden"][0]["inner"]["lobes"]


@pytest.mark.slow
def test_two_at_once(case, diagnosed) -> None:
    d = diagnosed(*TWO)
    assert d.verdict is Verdict.MISSING
    assert sorted(e.name for e in d.found) == sorted(TWO[2])
    hidden = {t["effect"]: t["amplitude"] for t in case(*TWO).truth["hidden"]}
    for step in d.steps[1:]:
        size = amplitude(step.reported)
        assert abs(abs(size.value) - hidden[step.effect.name]) < WITHIN * size.u
    rms = [step.fit.standardised_test_rms for step in d.steps]
    assert rms[0] > rms[1] > rms[2]
    assert rms[2] == pytest.approx(added_noise(*TWO[:2]), rel=HELD_OUT)


def test_an_effect_outside_the_library_is_called_unexplained(case, unchanged) -> None:
    """A pump that runs half of the time: no effect of the library, a pattern in time."""
    d = diagnose(case(*UNKNOWN).run[::3])
    assert d.verdict is Verdict.UNEXPLAINED
    assert d.found == ()
    assert "time_s" in [one.variable for one in d.depends_on]
    assert d.left
    assert d.depends_on[0].p_value < 1e-4
    assert verdict_sentence(d).startswith("A residual remains")
    unchanged(answer_text(d))


def test_below_the_limit_nothing_is_claimed_and_the_limit_is_reported(case, diagnosed) -> None:
    (hidden,) = case(*WEAK).truth["hidden"]
    d = diagnosed(*WEAK)
    assert not hidden["detectable"]
    assert d.verdict is Verdict.NONE
    assert d.fit.standardised_test_rms == pytest.approx(added_noise(*WEAK[:2]), rel=HELD_OUT)
    (limit,) = [x for x in d.detectable if x.effect.name == "backlash(X)"]
    assert limit.size is not None
    assert limit.size / UM > hidden["amplitude"]


def test_limits_are_those_of_visibility(case, diagnosed) -> None:
    """A reversal of the size reported as smallest has a signal-to-noise between 4 and 12.

    By the chi-square test alone, whose threshold pays for some hundred candidates, it would be
    sqrt(chi2(1e-3 / 400, 1)) = 4.7, and 0.84 for the power.
    """
    (hidden,) = case(*WEAK).truth["hidden"]
    (limit,) = [x for x in diagnosed(*WEAK).detectable if x.effect.name == "backlash(X)"]
    assert limit.size is not None
    visibility = hidden["signal_to_noise"] / hidden["amplitude"] * limit.size / UM
    assert 4.0 < visibility < 12.0


def test_what_no_touch_can_distinguish_comes_as_one_class(case, diagnosed) -> None:
    """A weight on B that tilts is 2 sin B cos B = sin 2B: harmonic 2 of EBB in other words."""
    run = case(*NOTHING).run[::2]
    chain = run.touches.chain
    sag = parse_effect("gravity(EBB)", chain)
    column = columns([sag], run.touches)
    hidden = column @ np.array([p.sd for p in sag.parameters]) * 3.0
    d = diagnose(
        replace(run, deviation=run.deviation + hidden),
        candidates=[
            parse_effect(n, chain) for n in ("gravity(EBB)", "periodic(EBB)", "backlash(X)")
        ],
        rng=np.random.default_rng(0),
    )
    assert d.verdict is Verdict.MISSING
    (step,) = d.steps[1:]
    assert names_of(step) == {"gravity(EBB)", "periodic(EBB)"}
    assert all(r.overlap > 0.99 for r in step.confusion.rivals)
