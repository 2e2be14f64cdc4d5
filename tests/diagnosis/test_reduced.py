"""Errors of sets of effects without the touches, against fits to the touches."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.answer import compare
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.reduced import compared_board, diagnosed_board
from matstd.diagnosis.reduced.base import Base
from matstd.diagnosis.reduced.board import mix
from matstd.diagnosis.reduced.matrices import reduced
from matstd.diagnosis.reduced.switches import lagrange, switch
from matstd.diagnosis.regression import Memory
from matstd.twin.effects.backlash import KIND as BACKLASH
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model, columns
from matstd.twin.thermal.thermal_lag import KIND as LAG

SAME = 1e-7
"""Relative: figures of files have six digits, of which the last shall be the same."""


@pytest.fixture(scope="module")
def run(case):
    """With chips, a lag along Z, and touches of unequal uncertainty."""
    known = case(31, "hsm600u", ("thermal-lag(EZZ)",), True, (30.0, 35.0), 6).run
    return replace(known, u=known.u * np.where(np.arange(len(known)) % 3 == 0, 1.5, 0.9))


def offered(run):
    return [e for kind in (LAG, BACKLASH) for e in kind.propose(run.touches)]


def refitted(fit, found, switches, on):
    """The model with a set of effects, fitted to the touches."""
    base = [e for e in fit.model.effects if e.name not in found]
    count = sum(len(e.parameters) for e in base)
    root = fit.prior.root[:count, :count]
    prior = Prior(fit.prior.mean[:count], root, np.ones(count))
    chosen = [s for s in switches if s.effect.name in on]
    for one in chosen:
        prior = prior.joined(Prior(np.zeros(len(one.sd)), np.diag(one.sd)))
    model = Model(fit.model.chain, (*base, *(s.effect for s in chosen)))
    return fit_run(fit.run, model, prior, gross=fit.gross, memory=fit.memory)


def switchboard(fit, effects):
    """Switches of some effects beside a fit, with their matrices."""
    base = Base.of(fit, frozenset())
    made = [
        switch(base, e, np.array([3.0 * p.sd for p in e.parameters]), is_found=False)
        for e in effects
    ]
    nothing = np.zeros(sum(s.columns.shape[1] for s in made))
    names = [s.effect.name for s in made]
    sets = [mix(made, nothing, on) for on in ((), names)]
    return made, nothing, reduced(base, np.column_stack([*(s.columns for s in made), base.y]), sets)


def assert_as_refitted(fit, effects, draws=6):
    made, nothing, matrices = switchboard(fit, effects)
    rng = np.random.default_rng(0)
    names = [s.effect.name for s in made]
    for count in range(draws):
        on = set(rng.choice(names, min(count, len(names)), replace=False))
        known = refitted(fit, (), made, on)
        errors = matrices.errors(mix(made, nothing, on))
        assert errors.fitted == pytest.approx(known.rms, rel=SAME)
        assert errors.held_out == pytest.approx(known.test_rms, rel=SAME)
        assert errors.s == pytest.approx(known.noise.factor, rel=SAME)
        own = [
            known.theta[known.of_effect(s.effect.name)] / s.sd for s in made if s.effect.name in on
        ]
        assert errors.estimate == pytest.approx(np.concatenate([[0.0], *own])[1:], abs=1e-5)


@pytest.mark.parametrize(
    "memory",
    [
        None,
        Memory(0.7),
        pytest.param(Memory(0.8, 0.0, False, is_filtered=False), marks=pytest.mark.slow),
    ],
    ids=["white", "remembers", "counts for less"],
)
def test_any_set_is_as_a_fit_to_the_touches(run, memory):
    fit = fit_run(run, ordinary_model(run.touches.chain), memory=memory)
    assert_as_refitted(fit, offered(run)[:9])


def test_rows_that_the_file_holds_out(run):
    split = np.where(run.touches.pose % 4 == 1, "test", "train")
    fit = fit_run(replace(run, split=split), ordinary_model(run.touches.chain))
    assert fit.test_rows.sum() > 50
    assert_as_refitted(fit, offered(run)[:6])


def test_a_set_up_of_which_nothing_was_used(run):
    split = np.where(run.touches.setup == 1, "test", "train")
    fit = fit_run(replace(run, split=split), ordinary_model(run.touches.chain))
    assert fit.unseen_setups
    assert_as_refitted(fit, offered(run)[:4], 4)


def test_without_geometry_and_without_poses(run):
    still = replace(run, touches=replace(run.touches, pose=np.zeros(len(run), dtype=np.int64)))
    assert_as_refitted(fit_run(still, Model(run.touches.chain, ())), offered(run)[:5], 4)


def test_residuals_are_those_of_the_fit(run):
    fit = fit_run(run, ordinary_model(run.touches.chain), memory=Memory(0.7))
    base = Base.of(fit, frozenset())
    residual = base.residuals(base.y[:, None], fit.noise.factor)[:, 0]
    assert residual == pytest.approx(fit.residual, abs=1e-9)


def test_the_board_has_the_figures_of_every_step(warm):
    board = diagnosed_board(warm)
    assert {e.name for e in warm.found} == board.found
    on = set()
    for step in warm.steps:
        on |= {step.effect.name} if step.effect else set()
        assert board.errors(on).fitted == pytest.approx(step.fit.rms, rel=1e-6)
        assert board.errors(on).held_out == pytest.approx(step.fit.test_rms, rel=1e-6)
        assert board.known[frozenset(on)] == (step.fit.rms, step.fit.test_rms)
    # look-alikes and others stand behind what was found, each once
    names = [s.effect.name for s in board.switches]
    assert len(names) == len(set(names)) > len(warm.found)
    rivals = {r.effect.name for r in warm.steps[1].confusion.rivals}
    assert set(board.switches[0].alike) <= rivals
    last = board.residuals(warm.fit.noise.factor)[:, -1]
    assert last == pytest.approx(warm.fit.residual, abs=1e-6)


def test_columns_follow_the_inner_parameter(warm):
    """At values of the slider and between them, against columns of the effect itself."""
    board = diagnosed_board(warm)
    one = next(s for s in board.switches if s.inner is not None)
    x, run = np.log(one.values), warm.run
    change = columns([one.effect], run.touches) * one.sd / run.u[:, None]
    size = np.linalg.norm(change)
    assert one.values[one.present] == pytest.approx(next(iter(one.effect.tuning.values())))
    assert one.columns[:, : len(one.sd)] == pytest.approx(change)
    for at in (x[one.present], x[2], 0.5 * (x[4] + x[5])):
        nearest = np.sort(np.argsort(np.abs(x - at))[:4])
        weights = lagrange(x[nearest], at)
        mixed = np.einsum("v,vkm->km", weights, one.mixes[nearest])
        moved = columns([one.effect.tuned(float(np.exp(at)))], run.touches) * one.sd
        seen = board.base.freed(
            (one.columns @ mixed.T - moved / run.u[:, None])[warm.fit.used], 1.0
        )
        assert np.linalg.norm(seen) < 0.01 * size


def test_a_comparison_offers_what_suits_its_residual(run):
    found = compare(run[::2])
    board = compared_board(found)
    assert board.errors(()).held_out == pytest.approx(found.fit.test_rms, rel=1e-4)
    best = min(board.switches, key=lambda s: board.errors({s.effect.name}).held_out)
    assert "EZ" in best.effect.name
    assert board.errors({best.effect.name}).held_out < 0.8 * board.errors(()).held_out
