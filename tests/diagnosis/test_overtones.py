"""A periodic error of any shape is one period with its sines; unrelated waves stay apart.

Shapes are made by their own formulas (amplitudes from Fourier's series by hand).
"""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up import run_of

from matstd.diagnosis.answer import Diagnosis, Verdict, diagnose
from matstd.diagnosis.search.further_parts import _is_fraction
from matstd.report.words import sizes
from matstd.twin.errors import UnknownEffect
from matstd.twin.library import parse_effect
from matstd.twin.units import UM

NOISE = 0.15 * UM


def found_in(error: np.ndarray, x: np.ndarray) -> Diagnosis:
    """Diagnosis of a fine log of such an error (mm)."""
    noise = np.random.default_rng(6).normal(0.0, NOISE, len(x))
    return diagnose(run_of(x, -error + noise, u=NOISE))


def test_a_triangle_is_one_period_with_its_odd_sines() -> None:
    """``8 A / pi^2 (sin - sin 3 / 9 + sin 5 / 25 ...)``, A = 6 µm, every 0.4 mm."""
    x = np.arange(2.0, 4.2, 0.02)
    triangle = 6.0 * UM * (2.0 / np.pi) * np.arcsin(np.sin(2.0 * np.pi * x / 0.4))
    result = found_in(triangle, x)
    assert result.verdict is Verdict.MISSING
    (effect,) = result.found
    assert effect.name.startswith("periodic(EXX,")
    reported = {r.quantity: r for r in result.steps[1].reported}
    assert reported["period"].u < 1e-3 * 0.4
    assert reported["period"].value == pytest.approx(0.4, abs=4.0 * reported["period"].u)
    for k in (1, 2, 3):
        true = 6.0 * 8.0 / np.pi**2 / k**2 * (k % 2)
        assert reported[f"sine_{k}"].value == pytest.approx(true, abs=4.0 * reported[f"sine_{k}"].u)
    assert "amplitudes of its harmonics 1 to " in sizes(result.steps[1], 3)


def test_a_strongest_second_sine_does_not_halve_the_period() -> None:
    x = np.arange(0.0, 2.4, 0.02)
    turn = 2.0 * np.pi * x / 0.5
    result = found_in((1.5 * np.sin(turn) + 7.0 * np.cos(2.0 * turn) + np.sin(3.0 * turn)) * UM, x)
    assert len(result.found) == 1
    reported = {r.quantity: r for r in result.steps[1].reported}
    assert reported["period"].value == pytest.approx(0.5, abs=4.0 * reported["period"].u)
    for k, true in ((1, 1.5), (2, 7.0), (3, 1.0)):
        assert reported[f"sine_{k}"].value == pytest.approx(true, abs=4.0 * reported[f"sine_{k}"].u)


def test_waves_of_two_parts_stay_two() -> None:
    x = np.arange(5.0, 11.0, 0.06)
    result = found_in(
        (3.0 * np.sin(2 * np.pi * x / 1.7) + 2.0 * np.cos(2 * np.pi * x / 0.63)) * UM, x
    )
    assert sorted(e.name for e in result.found) == ["periodic(EXX)", "periodic(EXX)#2"]


@pytest.mark.parametrize("name", ["periodic(EXX,1)", "periodic(EXX,x)", "periodic(EXX,13)"])
def test_a_number_of_sines_that_makes_no_sense_is_refused(name: str) -> None:
    x = np.arange(5.0, 15.0, 0.5)
    with pytest.raises(UnknownEffect, match="2 to 12"):
        parse_effect(name, run_of(x, 0.0 * x).touches.chain)


def test_sines_are_whole_fractions_of_the_period() -> None:
    x = np.linspace(0.0, 3.0, 40)
    touches = run_of(x, 0.0 * x).touches
    effect = parse_effect("periodic(EXX,3)", touches.chain).tuned(0.7)
    terms = [t.amount for t in effect.terms(touches)]
    want = [f(2 * np.pi * k * x / 0.7) for k in (1, 2, 3) for f in (np.sin, np.cos)]
    assert np.allclose(terms, want)


@pytest.mark.parametrize(
    ("order", "off", "is_one"),
    [
        *((1, 0.45, True), (1, -0.55, False), (3, -0.45, True), (3, 0.55, False)),
        *((4, 0.0, False), (0, 0.45, False)),
    ],
)
def test_a_wave_is_a_sine_of_a_period_within_half_a_turn_of_the_travel(order, off, is_one) -> None:
    """Of 0.7 mm with three sines, over 3 mm."""
    x = np.linspace(2.0, 5.0, 61)
    space = SimpleNamespace(touches=run_of(x, 0.0 * x).touches, used=np.ones(61, dtype=bool))
    chain = space.touches.chain
    wave = parse_effect("periodic(EXX)", chain).tuned(1.0 / (order / 0.7 + off / 3.0))
    assert _is_fraction(space, wave, parse_effect("periodic(EXX,3)", chain).tuned(0.7)) == is_one
    assert not _is_fraction(space, parse_effect("backlash(X)", chain), wave)
