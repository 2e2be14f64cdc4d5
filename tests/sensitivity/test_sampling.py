"""Drawn machines: within their ranges, reproducible, and the same as effect and as vector."""

import numpy as np
import pytest

from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.population import (
    DRAWS_A_CHILD,
    Distributions,
    Mix,
    Population,
    coefficients,
    draw,
    drawn_errors,
    drawn_in_chunks,
)
from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.errors import DesignError
from matstd.twin.files import errors_toml, read_errors
from matstd.twin.library import ordinary_model
from matstd.twin.machine import Ranges
from matstd.twin.model import contribution
from matstd.twin.record import at_poses

MANY = Distributions(periods=(1, 2, 3))


def test_amplitudes_signs_and_shapes_are_drawn_evenly(chain):
    population = Population(chain, distributions=MANY)
    draws = draw(population, 4000, np.random.default_rng(3))
    for p, symbol in enumerate(chain.symbols):
        low, high = population.ranges.of(chain, symbol)
        size = np.abs(draws.amplitude[:, p])
        assert low <= size.min()
        assert size.max() <= high
    # standard errors of a mean over 4000 x 71 draws: 0.002 and less
    assert np.mean(draws.amplitude > 0.0) == pytest.approx(0.5, abs=0.01)
    on_x = next(p for p, s in enumerate(chain.symbols) if s.name == "EXX")
    assert np.bincount(draws.shape[:, on_x]) / 4000 == pytest.approx([1 / 3] * 3, abs=0.04)
    assert np.bincount(draws.periods[:, on_x])[1:] / 4000 == pytest.approx([1 / 3] * 3, abs=0.04)
    assert np.mean(np.exp(1j * draws.phase)) == pytest.approx(0.0, abs=0.01)


def test_constants_stay_constants(chain):
    population = Population(chain)
    assert population.mix_of(chain.symbol("EC0Y")).shapes == ("constant",)
    assert population.mix_of(chain.symbol("EXC1")).shapes == ("constant",)
    assert population.mix_of(chain.symbol("EXX")).shapes == ("linear", "parabolic", "sinusoidal")


def test_a_rotary_axis_repeats_every_turn(chain):
    assert Population(chain).mix_of(chain.symbol("EXC")).shapes == ("sinusoidal",)
    asked = Distributions(rotary_shapes=("linear", "sinusoidal"))
    population = Population(chain, distributions=asked)
    assert population.mix_of(chain.symbol("EXC")).shapes == ("linear", "sinusoidal")


def test_a_drawn_machine_is_the_same_as_effects_and_as_vector(chain, workspace):
    population = Population(chain, distributions=MANY)
    touches = at_poses(chain, latin_hypercube(workspace, 30, np.random.default_rng(1)), 160.0)
    for seed in range(5):
        theta = coefficients(population, draw(population, 1, np.random.default_rng(seed)))[0]
        errors = drawn_errors(population, np.random.default_rng(seed))
        assert len(errors) == 71
        by_effects = contribution(errors, touches)
        by_vector = population.model.contribution(touches, theta)
        np.testing.assert_allclose(by_vector.twist, by_effects.twist, rtol=0, atol=1e-15)
        np.testing.assert_allclose(by_vector.place, by_effects.place, rtol=0, atol=1e-15)
        assert np.abs(by_effects.twist).max() > 0.01  # mm: something was drawn


def test_the_population_is_what_the_ordinary_model_can_be(chain):
    """So a random machine of ours holds nothing that a diagnosis would call a missing effect."""
    assert set(ordinary_model(chain).names) == set(Population(chain).model.names)


def test_a_drawn_machine_comes_back_from_an_error_file(chain, tmp_path):
    errors = drawn_errors(Population(chain, distributions=MANY), np.random.default_rng(6))
    path = tmp_path / "errors.toml"
    path.write_text(errors_toml(errors), encoding="utf-8")
    for (effect, theta), (again, theta_again) in zip(errors, read_errors(path, chain), strict=True):
        assert type(effect) is type(again)
        assert isinstance(effect, ComponentError | LocationError)
        assert effect.symbol == again.symbol
        np.testing.assert_allclose(theta_again, theta, rtol=1e-12)


def test_the_first_machines_do_not_depend_on_how_many_are_drawn(chain):
    population = Population(chain)
    few = next(iter(drawn_in_chunks(population, DRAWS_A_CHILD, np.random.default_rng(5))))
    many = list(drawn_in_chunks(population, 3 * DRAWS_A_CHILD + 7, np.random.default_rng(5)))
    assert [len(lot) for lot in many] == [DRAWS_A_CHILD] * 3 + [7]
    np.testing.assert_array_equal(few.amplitude, many[0].amplitude)
    assert not np.array_equal(many[0].amplitude, many[1].amplitude)


def test_ranges_by_name_go_first(chain):
    ranges = Ranges(by_name={"EXX": (0.2, 0.2), "EYX": (0.0, 0.0)})
    draws = draw(Population(chain, ranges), 10, np.random.default_rng(1))
    names = [s.name for s in chain.symbols]
    np.testing.assert_array_equal(np.abs(draws.amplitude[:, names.index("EXX")]), 0.2)
    np.testing.assert_array_equal(draws.amplitude[:, names.index("EYX")], 0.0)


def test_distributions_that_cannot_be_drawn_are_refused():
    with pytest.raises(DesignError, match="expected at least one of"):
        Distributions(shapes=())
    with pytest.raises(DesignError, match="cubic"):
        Distributions(shapes=("cubic",))
    with pytest.raises(DesignError, match="periods"):
        Distributions(periods=(0,))


def test_mixes_by_name_and_class_have_their_chances(chain):
    mixes = Distributions(
        by_class={"rotary_rotation": Mix(("linear", "sinusoidal"), (2, 5), (1.0, 3.0))},
        by_name={"EXX": Mix(("parabolic",)), "EBB": Mix(("constant",))},
    )
    population = Population(chain, distributions=mixes)
    assert population.mix_of(chain.symbol("EXX")).shapes == ("parabolic",)
    assert population.mix_of(chain.symbol("EYX")).shapes == ("linear", "parabolic", "sinusoidal")
    assert population.mix_of(chain.symbol("EBB")).shapes == ("constant",)
    draws = draw(population, 8000, np.random.default_rng(3))
    p = next(p for p, s in enumerate(chain.symbols) if s.name == "EAC")
    # standard errors of a share over 8000 draws: 0.006 and less
    assert np.mean(draws.shape[:, p] == 1) == pytest.approx(0.75, abs=0.02)
    assert set(draws.periods[:, p]) == {2, 5}
    assert np.mean(draws.periods[:, p] == 2) == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda: Mix(("linear",), weights=(1.0, 2.0)), "weights"),
        (lambda: Mix(("linear", "parabolic"), weights=(0.0, 0.0)), "not all zero"),
        (lambda: Mix(("linear", "linear")), "each once"),
        (lambda: Mix(("sinusoidal",), periods=(1, 1)), "each once"),
        (lambda: Distributions(by_class={"squareness": Mix(("linear",))}), "squareness"),
    ],
)
def test_mixes_that_mean_nothing_are_refused(wrong, words):
    with pytest.raises(DesignError, match=words):
        wrong()


def test_shapes_of_a_constant_are_refused(chain):
    for name, words in (("EC0Y", "it is a constant"), ("EQX", "unknown error parameter")):
        with pytest.raises(DesignError, match=words):
            Population(chain, distributions=Distributions(by_name={name: Mix(("linear",))}))
