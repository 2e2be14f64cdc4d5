"""Effects in sentences: the words of a workshop first, a class as a class, names behind."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up import made_up

from matstd.commands.measured.diagnose import _row
from matstd.diagnosis.fit import Reported, Role
from matstd.report.effects import (
    class_words,
    effect_cell,
    effect_words,
    plan_words,
    rival_words,
    words_of_name,
)
from matstd.report.identifiability.identification_file import identification_table
from matstd.report.plots.effect_pictures import _named
from matstd.twin.library import parse_effect
from matstd.twin.units import UM

LAGS = ["thermal-lag(EZZ)", "thermal-lag(EZY)", "thermal-lag(EZX)", "thermal-lag(EZB)"]


def step(*names):
    """A step whose effect cannot be distinguished from the ones behind it."""
    chain = made_up("hsm600u").chain
    first, *rest = [parse_effect(name, chain) for name in names]
    rivals = [SimpleNamespace(effect=e) for e in rest]
    return SimpleNamespace(effect=first, confusion=SimpleNamespace(rivals=rivals))


def test_a_class_that_differs_in_its_body_alone_is_reported_as_one() -> None:
    assert class_words(step(*LAGS), ["time constant 12 min"]) == (
        "growth along Z after switching on (time constant 12 min; carried by Z, Y, X or B, which "
        "this run cannot distinguish) [thermal-lag(EZZ) or one of 3 more]"
    )
    assert effect_cell(step(*LAGS)) == (
        "growth along Z after switching on",
        "[thermal-lag(EZZ) or one of 3 more]",
    )
    assert rival_words(step(*LAGS)) == (
        "thermal-lag(EZZ) cannot be distinguished from thermal-lag(EZY), thermal-lag(EZX) and "
        "thermal-lag(EZB)"
    )


def test_a_bar_has_its_title_above_its_name_and_a_name_alone_once() -> None:
    effect = parse_effect("backlash(X)", made_up("hsm600u").chain)
    assert _named(effect) == "reversal of X\nbacklash(X)"
    assert _named(SimpleNamespace(name="own", kind="own")) == "own"


def test_what_else_it_may_be_is_reported_beside_the_bodies() -> None:
    assert class_words(step("backlash(X)", "geometric(EXX,3)")) == (
        "reversal of X (or instead positioning error of X) [backlash(X) or geometric(EXX,3)]"
    )
    words = class_words(step(*LAGS[:2], "drift", "backlash(X)"))
    assert (
        "carried by Z or Y, which this run cannot distinguish; or instead drift of the set-up or "
        "reversal of X)" in words
    )


def test_other_titles_that_share_their_words_are_reported_once() -> None:
    words = class_words(step(*LAGS[:2], "thermal-static(EZZ,room)", "thermal-static(EZY,room)"))
    assert "or instead growth along Z with room (carried by Z or Y)) [" in words


def test_an_effect_alone_names_its_body_where_its_title_does_not() -> None:
    assert class_words(step("thermal-lag(EZB)")) == (
        "growth along Z after switching on, carried by B [thermal-lag(EZB)]"
    )
    assert effect_cell(step("backlash(X)")) == ("reversal of X", "[backlash(X)]")
    assert rival_words(step("backlash(X)")) == ""


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("gravity(EYZ)", "sag of Z along Y [gravity(EYZ)]"),
        ("coupling(EBX,Z)", "tilt of X about Y, which changes with Z [coupling(EBX,Z)]"),
        ("stiffness(t)", "compliance of the tool [stiffness(t)]"),
        ("probe-lobing", "lobes of the probe [probe-lobing]"),
        ("gravity(EBB,C)", "tilt under a load off the centre of C, carried by B [gravity(EBB,C)]"),
    ],
)
def test_names_in_words(name, words) -> None:
    chain = made_up("hsm600u").chain
    assert words_of_name(name, chain) == effect_words(parse_effect(name, chain)) == words


def test_many_rivals_are_counted_beyond_the_first() -> None:
    many = step("backlash(X)", *(f"geometric(E{c}{a},3)" for c in "XYZ" for a in "XY"))
    assert rival_words(many).endswith("geometric(EYX,3), geometric(EYY,3) and 2 more")
    words = class_words(many)
    assert "straightness of X in Y, positioning error of Y or 2 more) [backlash(X) or" in words
    assert words.endswith("or one of 6 more]")


def test_plans_say_what_they_distinguish() -> None:
    touches = made_up("hsm600u")
    plan = SimpleNamespace(
        touches=touches, distinguishes=("backlash(X)", "backlash(Y)"), periods_of=""
    )
    assert plan_words(plan) == "reversal of X [backlash(X)] from reversal of Y [backlash(Y)]"
    periods = ("periodic(EXX)@10", "periodic(EXX)@5,3.333")
    plan = SimpleNamespace(touches=touches, distinguishes=periods, periods_of="periodic(EXX)")
    assert plan_words(plan).startswith("the periods 10, 5, 3.333 mm of positioning error of X")


def test_an_identification_has_the_units_of_its_names():
    """2 ± 1 µrad and 4 ± 0.5 µm, of three touches of which the one of line 5 is a gross error."""
    fit = SimpleNamespace(
        parameters=(),
        used=np.array([True, False, True]),
        run=SimpleNamespace(line=np.array([4, 5, 6])),
        gross=SimpleNamespace(rows=np.array([1])),
        rms=0.002,
        test_rms=0.003,
        noise=SimpleNamespace(factor=1.5),
    )
    known = SimpleNamespace(
        found=SimpleNamespace(parameters=2, rank=2, condition_prior=3.0),
        effective=1.5,
        determined=[
            SimpleNamespace(name="tilt", value=2e-6, u=1e-6, unit="rad"),
            SimpleNamespace(name="place", value=0.004, u=0.0005, unit="mm"),
        ],
        combinations=[],
        freedoms=[],
    )
    table = identification_table(fit, known)
    assert [(d["name"], d["unit"]) for d in table["determined"]] == [
        ("tilt", "µrad"),
        ("place", "µm"),
    ]
    assert [d["value"] for d in table["determined"]] == pytest.approx([2.0, 4.0])
    assert [d["u"] for d in table["determined"]] == pytest.approx([1.0, 0.5])
    assert (table["touches"], table["gross_errors"]) == (2, [5])
    assert (table["rms_um"], table["test_rms_um"]) == pytest.approx((2.0, 3.0))


def test_a_step_of_the_console_has_two_numbers_of_its_effect_and_three_of_its_fit() -> None:
    fit = SimpleNamespace(
        rms=1.23456e-3, test_rms=2.34567e-3, noise=SimpleNamespace(chi2_ratio=3.4567)
    )
    numbers = ("1.235", "2.346", "3.46")
    begin = SimpleNamespace(effect=None, fit=fit, reported=(), name="", p_value=1.0)
    assert _row(begin, is_withdrawn=False) == ("starting model", "", "", *numbers)
    sizes = {"amplitude": 5.0, "play": 7.0, "slip": 9.0}
    reported = [Reported(name, "um", v, 0.1, UM, Role.SIZE) for name, v in sizes.items()]
    one = step("backlash(X)")
    found = SimpleNamespace(
        **vars(one), fit=fit, reported=reported, name="backlash(X)", p_value=3.21e-7
    )
    name, both, *rest = _row(found, is_withdrawn=True)
    assert name == "withdrawn:\nreversal of X\n\\[backlash(X)]"  # a bracket is no style
    assert both == "5.00 ± 0.10 µm, play 7.00 ± 0.10 µm"
    assert rest == ["3e-07", *numbers]
