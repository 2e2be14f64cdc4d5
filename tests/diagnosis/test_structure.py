"""Structure in a residual: what was planted is found by its kind, noise has none."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import made_up

from matstd.diagnosis.evidence import EffectSet, ResidualSpace
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import PatternTests, Shape, find_structure
from matstd.diagnosis.residual.partial_residuals import _split
from matstd.twin.library import kinds, ordinary_model, proposals
from matstd.twin.model import Model, columns, is_tunable
from matstd.twin.units import UM

KEY = (1, "hmc1995")
NOISE = 0.6 * UM


@pytest.fixture
def structure_of(case):
    """A function: deviation (mm) of the touches of a run -> structure that a bare model leaves."""

    def found(deviation):
        run = replace(case(*KEY).run, deviation=deviation)
        space = ResidualSpace.of(fit_run(run, Model(run.touches.chain, ())))
        nothing = EffectSet(space, np.zeros((len(space.residual), 0)))
        return space, find_structure(nothing)

    return found


@pytest.fixture
def noise(case):
    """A function of a seed -> white noise of a run, (N,), mm."""
    return lambda seed: np.random.default_rng(seed).normal(0.0, NOISE, len(case(*KEY).run))


@pytest.mark.parametrize("seed", range(8))
def test_noise_has_no_structure(structure_of, noise, seed) -> None:
    assert structure_of(noise(seed))[1] == []


def test_chances_of_patterns_are_even_beside_a_model_that_imitates_them(case, noise) -> None:
    """What a machine with all its errors takes of a pattern is no part of its test."""
    run = case(*KEY).run
    found = []
    for seed in range(4):
        fit = fit_run(replace(run, deviation=noise(seed)), ordinary_model(run.touches.chain))
        space = ResidualSpace.of(fit)
        nothing = EffectSet(space, np.zeros((len(space.residual), 0)))
        found += [tested.p for tested in PatternTests(space).of(nothing)]
    p = np.concatenate(found)
    assert 0.4 < p.mean() < 0.6
    assert 0.02 < np.mean(p < 0.1) < 0.25


def test_a_smooth_function_is_found_in_its_variable_and_direction(
    case, structure_of, noise
) -> None:
    """A wavy Z over X: nothing but X, along Z, explains it."""
    t = case(*KEY).run.touches
    x = t.reading("X")
    wavy = np.sin(3.0 * np.pi * (x - x.min()) / np.ptp(x)) * t.normal_table[:, 2]
    space, found = structure_of(noise(1) + 4.0 * UM * wavy)
    named = [s for s in found if s.shape is Shape.SMOOTH and s.columns is not None]
    best = max(named, key=lambda s: s.evidence)
    assert "X_mm" in best.variables
    assert best.direction == "Z"
    assert best.p_value < 1e-9
    # its columns leave nothing but noise once they are in the set
    after = EffectSet(space, best.columns)
    left = np.sqrt(after.objective / after.dof) * np.median(space.u)
    assert left == pytest.approx(NOISE, rel=4.0 / np.sqrt(2.0 * after.dof))
    assert all(s.p_value > 1e-9 for s in find_structure(after))


def test_noise_that_remembers_is_seen_by_its_neighbours(structure_of, noise) -> None:
    """Every touch keeps six tenths of the one before."""
    white = noise(2)
    coloured = np.zeros_like(white)
    for i in range(len(white)):
        coloured[i] = 0.6 * coloured[i - 1] * (i > 0) + 0.8 * white[i]
    found = structure_of(coloured)[1]
    (in_time,) = [s for s in found if s.shape is Shape.NEIGHBOURS and s.variables == ("time_s",)]
    assert in_time.p_value < POLICY.false_alarm
    assert in_time.columns is None


def test_a_quantity_times_what_a_unit_of_it_moves_is_the_deviation() -> None:
    """Whatever a picture of an effect shows: of every kind one."""
    t, rng = made_up("hsm600u", 60), np.random.default_rng(1)
    for effect in [e for kind in kinds() for e in proposals(t, [kind.word])[:1]]:
        if is_tunable(effect):
            effect = effect.tuned(*(one.grid[len(one.grid) // 2] for one in effect.inner(t)))
        theta = rng.normal(size=len(effect.parameters)) * [p.sd for p in effect.parameters]
        _, quantity, per_unit = _split(effect, t, theta)
        moved = columns([effect], t) @ theta
        np.testing.assert_allclose(
            quantity * per_unit, moved, rtol=1e-9, atol=1e-9 * UM, err_msg=effect.name
        )
