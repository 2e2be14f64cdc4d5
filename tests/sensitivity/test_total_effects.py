"""Total effects by rank-one updates against conditional variances and a known case."""

import numpy as np
import pytest
from machines import none_but

from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.montecarlo.random_machines import first_order
from matstd.sensitivity.population import (
    Distributions,
    Group,
    Population,
    coefficients,
    draw,
    grouped,
)
from matstd.sensitivity.shares import norm_shares, total_effects
from matstd.twin.errors import DesignError, ShapeMismatch

SINGLE = 1e-5
"""Indices are off by so little where the compiled code calculates in single precision."""


def random_case(draws):
    rng = np.random.default_rng(1)
    J = rng.normal(size=(5, 3, 40))
    a, b = rng.normal(size=(2, 5, draws)) * np.array([1.0, 0.2, 0.5, 2.0, 0.0])[:, None]
    return J, a, b


@pytest.mark.parametrize("compiled", [False, True])
def test_against_variances_at_given_other_errors(compiled):
    # T_p = E[Var(f | all but p)] / Var f, by two nested loops that know nothing of updates
    J, a, b = random_case(8192)
    found = total_effects(J, a, b, compiled).total
    rng = np.random.default_rng(2)
    for p in range(5):
        outer = np.repeat(a[:, :1500, None], 60, axis=2)
        outer[p] = rng.normal(size=(1500, 60)) * a[p].std()
        d = np.einsum("pi,pmk->imk", J[:, :, 7], outer)
        f = np.linalg.norm(d, axis=0)
        inside = f.var(axis=1, ddof=1).mean()
        whole = np.linalg.norm(J[:, :, 7].T @ a, axis=0).var()
        # 1500 conditional variances, scattered by about their mean: 3 %; the estimator the same
        assert found[p, 7] == pytest.approx(inside / whole, abs=0.05)
    assert found[4].max() < SINGLE  # an error that never varies


def test_compiled_and_plain_agree():
    case = random_case(300)
    for one, two in zip(total_effects(*case)[:2], total_effects(*case, False)[:2], strict=True):
        np.testing.assert_allclose(one, two, rtol=0, atol=SINGLE)


def test_one_error_alone_is_everything():
    J, a, b = random_case(20_000)
    found = total_effects(J[:1], a[:1], b[:1]).total
    np.testing.assert_allclose(found, 1.0, atol=0.05)


def test_nothing_varies_and_nothing_fits():
    J, a, b = random_case(10)
    assert total_effects(J, 0.0 * a, 0.0 * b).total.max() == 0.0
    with pytest.raises(ShapeMismatch, match="5 columns"):
        total_effects(J, a[:4], b[:4])


def test_against_salib():
    from SALib.analyze import sobol
    from SALib.sample import sobol as sampling

    J, *_ = random_case(2)
    half = np.array([1.0, 0.3, 0.5, 2.0, 0.1])
    problem = {
        "num_vars": 5,
        "names": list("abcde"),
        "bounds": np.stack([-half, half], axis=1).tolist(),
    }
    machines = sampling.sample(problem, 4096, calc_second_order=False, seed=1)
    theirs = sobol.analyze(
        problem,
        np.linalg.norm(machines @ J[:, :, 3], axis=1),
        calc_second_order=False,
        num_resamples=20,
        seed=1,
    )["ST"]
    a, b = half[:, None] * np.random.default_rng(2).uniform(-1.0, 1.0, size=(2, 5, 40_000))
    ours = total_effects(J[:, :, 3:4], a, b)
    # theirs is a quasi-random sample of 4096: an order below ours in its error
    assert (np.abs(ours.total[:, 0] - theirs) < 4.0 * ours.u[:, 0] + 2e-3).all()
    assert ours.u.max() < 0.02


def test_stated_errors_are_those_of_repeated_runs():
    J = random_case(2)[0]
    runs = []
    for seed in range(60):
        a, b = np.random.default_rng(seed).normal(size=(2, 5, 400))
        runs.append(total_effects(J[:, :, :6], a, b))
    seen = np.std([r.total for r in runs], axis=0, ddof=1)
    said = np.mean([r.u for r in runs], axis=0)
    # 60 runs know a standard deviation to 9 %; numerator and variance are not quite independent
    np.testing.assert_allclose(np.mean(said / seen), 1.0, atol=0.15)


def test_errors_of_random_machines_change_as_a_whole(chain, workspace):
    names = ("EXX", "EYC", "EC0Y", "EAB")
    ranges = none_but(EXX=(0.05, 0.1), EYC=(0.02, 0.06), EC0Y=(1e-4, 3e-4), EAB=(5e-5, 3e-4))
    population = Population(chain, ranges, Distributions(periods=(1, 3)))
    q = latin_hypercube(workspace, 5, np.random.default_rng(4))
    found = norm_shares(population, q, 160.0, np.random.default_rng(5), machines=8192)
    assert (found.machines, found.seed) == (8192, "5")
    # the plain way: replace all coefficients of one error, multiply everything anew
    rng = np.random.default_rng(6)
    a, b = (coefficients(population, draw(population, 8192, rng)) for _ in range(2))
    G = first_order(population.model, q, 160.0)
    owner = np.array([e.symbol.name for e, _ in population.model.parameters])

    def size(theta):
        return np.linalg.norm(np.einsum("nik,sk->nsi", G, theta), axis=2)

    whole = size(a)
    for p, symbol in enumerate(chain.symbols):
        if symbol.name not in names:
            assert found.total[p].max() < SINGLE
            continue
        changed = size(np.where(owner == symbol.name, b, a)) - whole
        plain = 0.5 * np.mean(changed**2, axis=1) / whole.var(axis=1)
        assert np.abs(found.total[p] - plain).max() < 6.0 * found.u[p].max()


def test_correlated_errors_have_no_such_index(chain):
    tied = Population(chain, dependence=grouped([Group(("EXX", "EYX"), 0.5)]))
    with pytest.raises(DesignError, match="independent errors"):
        norm_shares(tied, np.zeros((1, len(chain.axes))), 160.0, np.random.default_rng(1))
