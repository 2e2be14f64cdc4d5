"""What is said beside a law: of the touches left out, of a second run, of the library."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulator_experiment import MACHINES

from matstd import learn
from matstd.api.learning import LearntLaws
from matstd.api.saved import extended
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.laws import POLICY, Learning, LearntLaw, SecondRun, places
from matstd.diagnosis.laws.beginning import Beginning
from matstd.diagnosis.laws.learn import _have_carrier
from matstd.diagnosis.laws.library import LibraryEffect
from matstd.diagnosis.laws.screening import field_of
from matstd.diagnosis.laws.search import _is_seen
from matstd.report.laws import second_run_sentence
from matstd.report.laws.law_page import law_sections
from matstd.report.laws.law_words import law_sentence, library_sentence
from matstd.report.laws.looks import looks_like
from matstd.twin.errors import BadArgument
from matstd.twin.files import read_machine
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.machine import parse_symbol
from matstd.twin.model import columns
from matstd.twin.units import UM


@pytest.mark.parametrize(
    ("second", "said"),
    [
        (SecondRun(90, 0.9 * UM, 0.6 * UM), "0.90 µm without the law, 0.60 µm with it."),
        (
            SecondRun(90, 0.6 * UM, 0.6 * UM, gross=(8, 5)),
            "Do not use it to predict. Left out as gross errors: 8 touches without the law, 5 with "
            "it.",
        ),
        (
            SecondRun(90, 0.9 * UM, 0.9 * UM, 0.6 * UM, is_clock=False),
            "0.60 µm with the laws that belong to the first run. They hold here, too.",
        ),
        (
            SecondRun(90, 0.9 * UM, 0.9 * UM, 1.1 * UM, is_clock=False, gross=(1, 1)),
            "They do not hold here. Left out as gross errors: 1 touch.",
        ),
    ],
)
def test_a_second_run_is_said_to_hold_or_not(second, said) -> None:
    assert second_run_sentence(second).endswith(said)


def test_a_run_is_no_second_run_of_itself(stylus, tmp_path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINES["hmc1995"], encoding="utf-8")
    for name, text in zip(("run", "two"), stylus[0], strict=False):
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    run, two = (tmp_path / f"{name}.csv" for name in ("run", "two"))
    for first in (run, [run, two]):
        with pytest.raises(BadArgument, match="second_run has touches that the laws are learnt"):
            learn(first, second_run=run)


def test_touches_left_out_are_named_by_their_lines(stylus) -> None:
    run = stylus[2].before.run
    deviation = run.deviation.copy()
    deviation[17] += 30.0 * UM
    after = fit_run(replace(run, deviation=deviation), ordinary_model(run.touches.chain))
    assert after.gross.rows[17]
    said = extended(LearntLaws, replace(stylus[2], after=after), title="run.csv").remarks
    (gross,) = [line for line in said if "left out" in line]
    assert "outside the prediction" in gross
    assert str(run.line[17]) in gross


def test_an_effect_of_the_library_has_its_row_and_its_word(stylus) -> None:
    """A law that an effect explains as well or better is not stated as if it stood alone."""
    found = stylus[2]
    one = replace(found.laws[0], rivals=(), law=replace(found.laws[0].law, is_of_run=False))
    one = replace(one, law=parse_effect("law(EZX,bump Y)", found.before.run.touches.chain))
    effect = parse_effect("backlash(X)", found.before.run.touches.chain)
    for ahead, said in ((-9.0, "nearest effect"), (0.5, "explains it as well"), (3.0, "better")):
        law = replace(one, library=LibraryEffect(effect, one.score + ahead))
        assert said in library_sentence(law)
        shares = {each.name: share for each, share in law.members(found.policy)}
        assert ("backlash(X)" in shares) == (ahead > -4.0)
    sections = law_sections(replace(found, laws=(found.laws[0],)), None)
    assert any(s.title == "Rivals" for s in sections)


@pytest.mark.parametrize(("width", "is_seen"), [(500.0, True), (20.0, False)])
def test_a_product_is_largest_near_a_touch(stylus, width, is_seen) -> None:
    """Of two exponentials into a corner the largest in the box, one, is at the corner itself."""
    touches = stylus[2].before.run.touches
    x, z = touches.reading("X"), touches.reading("Z")
    at_touches = np.exp(-(x.max() - x) / width - (z.max() - z) / width)
    assert (3.0 * at_touches.max() > 1.0) == is_seen
    places = (float(x.max()), -width, float(z.max()), -width)
    law = parse_effect("law(EXX,exp X,exp Z)", touches.chain).tuned(*places)
    np.testing.assert_allclose(law.amounts(touches)[0], at_touches)
    assert _is_seen(law, touches) == is_seen


def test_accidents_have_no_carrier_in_common(stylus) -> None:
    """Six touches that one carrier moved by one amount have; of random sizes and signs not."""
    fit = stylus[2].before
    field = field_of(fit.run.touches, fit.run.u)
    lever = next(b.C[:, 0] for b in field.bearers if b.carrier.symbol is not None)
    rng = np.random.default_rng(4)
    found = []
    for k in range(30):
        rows = np.zeros(len(lever), dtype=bool)
        rows[rng.choice(np.flatnonzero(np.abs(lever) > np.abs(lever).mean()), 6, False)] = True
        moved = lever * (10.0 / np.abs(lever).max()) + rng.normal(0.0, 1.0, len(lever))
        chips = rng.choice([-1.0, 1.0], len(lever)) * rng.uniform(5.0, 20.0, len(lever))
        score = np.where(rows, moved if k % 2 else chips, 0.0)
        found.append(_have_carrier(replace(fit.gross, score=score), rows, field))
    assert all(found[1::2])
    assert sum(found[::2]) <= 7


def test_a_wave_that_jumps_is_as_uncertain_as_its_touches_leave_it(stylus) -> None:
    """Far above the noise every period and phase is as good that gives all touches their sign."""
    found = stylus[2]
    run = found.before.run
    x, period, phase = run.touches.since_start, 2600.0, 0.7

    def signs(period, phase):
        return np.where(np.mod(x / period + phase / (2.0 * np.pi), 1.0) < 0.5, 1.0, -1.0)

    start = Beginning.of_run(replace(run, deviation=run.deviation + 0.1 * signs(period, phase)))
    law = parse_effect("law(bias,square time)", run.touches.chain).tuned(period, phase)
    one = replace(found.laws[0], law=law)
    learnt = replace(found, beginning=start, after=start.fitted([law]), laws=(one,))
    rng = np.random.default_rng(2)
    away = rng.uniform(-1.0, 1.0, (20000, 2)) * [60.0, 0.3]
    same = [np.array_equal(signs(period + p, phase + f), signs(period, phase)) for p, f in away]
    expected = np.sqrt((away[same] ** 2).mean(axis=0))
    stated = [e.u for e in places(learnt, law)]
    assert np.count_nonzero(same) > 50
    np.testing.assert_allclose(stated, expected, rtol=0.3)


def test_what_turns_with_the_contact_looks_like_the_form_of_the_standard() -> None:
    """Lobes of a ball on a table that turns; of a carriage alone it is cogging."""
    chain = read_machine(Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml")
    lobes = parse_effect("law(shift,harmonic C,sine azimuth)", chain)
    assert "form of the standard" in looks_like(lobes)
    assert "cogging" in looks_like(parse_effect("law(EXX,harmonic C,sine X)", chain))


@pytest.mark.parametrize("shape", ["saturation", "ramp"])
def test_a_change_between_two_levels_is_said_from_end_to_end(case, shape) -> None:
    """The Z slide stands 12 um higher after the middle of the run than before."""
    run = case(11, "hsm600u").run
    time = run.touches.time
    middle, width = float(np.median(time)), 0.002 * float(np.ptp(time))
    chain = run.touches.chain
    law = parse_effect(f"law(EZZ,{shape} time)", chain)
    places = (middle, width) if shape == "saturation" else (middle - width, middle + width)
    law = law.tuned(*places)
    late = columns([parse_effect("law(EZZ,step time)", chain).tuned(middle)], run.touches)
    start = Beginning.of_run(replace(run, deviation=run.deviation + 12.0 * UM * late[:, 0]))
    fits = start.fitted([law]), start.fitted([law], True)
    one = LearntLaw(law, (), 0.0, 0.0, 0.0, 0.0, ())
    said = law_sentence(Learning(start, *fits, (one,), None, None, (), POLICY), one)
    number, u = (float(x) for x in said.split(" of ")[1].split(" µm")[0].split(" ± "))
    assert abs(number - 12.0) < 4.0 * u < 4.0
    assert ("µm from end to end over time" in said) == (shape == "saturation")


@pytest.mark.parametrize("beside", ["", ",harmonic C"])
def test_a_reversal_is_said_from_end_to_end(case, beside) -> None:
    """X stands 8 um further after a positive motion, or by up to 8 um over a turn of C."""
    run = case(11, "hsm600u").run
    chain, touches = run.touches.chain, run.touches
    sides = np.where(np.arange(len(touches)) % 2, 1.0, -1.0)
    approach = touches.approach.copy()
    approach[:, chain.axis_index("X")] = sides
    touches = replace(touches, approach=approach)
    law = parse_effect(f"law(EXX,sign last-X{beside})", chain)
    law = law.tuned(1.0) if beside else law
    wave = np.cos(touches.reading("C") - 0.4) if beside else 1.0
    moved = touches.signature.of(chain.twist_of(parse_symbol("EXX"))) * 4.0 * UM * sides * wave
    start = Beginning.of_run(replace(run, touches=touches, deviation=run.deviation + moved))
    fits = start.fitted([law]), start.fitted([law], True)
    one = LearntLaw(law, (), 0.0, 0.0, 0.0, 0.0, ())
    said = law_sentence(Learning(start, *fits, (one,), None, None, (), POLICY), one)
    number, u = (float(x) for x in re.search(r"(-?[\d.]+) ± ([\d.]+) µm from end", said).groups())
    assert abs(number - 8.0) < 4.0 * u < 4.0
