"""The factor on the prior that suits a machine, against another library and plain least squares."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import multivariate_t

from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.fit.suited_prior import _evidence, _released
from matstd.diagnosis.geometry import geometry_rows
from matstd.diagnosis.regression import PRIOR_DOF
from matstd.twin.files import read_machine
from matstd.twin.library import ordinary_model, parse_effect, proposals
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import Model
from matstd.twin.record import Run, Setup, Touches
from matstd.twin.units import DEG, UM, URAD

EXAMPLES = Path(__file__).parents[2] / "examples"

NOISE = 3.0 * UM
SCALE, SQUARE = -18e-6, 41.0 * URAD


def holes(seed: int, size: float = 1.0) -> Run:
    """35 holes drilled by X and Y, x and y of each measured elsewhere: scale, squareness, noise."""
    rng = np.random.default_rng(seed)
    chain = make_chain("mill", "[w f X Y t]", {"X": Axis((0.0, 500.0)), "Y": Axis((0.0, 320.0))})
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(20.0, 480.0, 7), np.linspace(15, 310, 5)))
    place = np.repeat(np.column_stack([x, y, np.zeros(len(x))]), 2, axis=0)
    normal = np.tile([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], (len(x), 1))
    # the machine believes to drill at x, y and drills at x (1 + e) - s y, y
    error = np.zeros_like(place)
    error[:, 0] = size * (SCALE * place[:, 0] - SQUARE * place[:, 1])
    n = len(place)
    touches = Touches(
        chain=chain,
        q=place[:, :2],
        length=np.zeros(n),
        radius=np.zeros(n),
        point=place,
        normal=normal,
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=np.zeros(n),
        approach=np.zeros((n, 2)),
        pose=np.repeat(np.arange(len(x)), 2),
    )
    deviation = -(error * normal).sum(axis=1) + rng.normal(0.0, NOISE, n)
    return Run(touches=touches, deviation=deviation, u=np.full(n, NOISE))


def test_evidence_is_that_of_a_multivariate_t_distribution():
    rng = np.random.default_rng(1)
    X, y = rng.normal(size=(30, 8)), rng.normal(size=30)
    factors = [np.ones(8), np.full(8, 0.25), rng.uniform(0.1, 1.0, 8)]
    ours = [_evidence(X.T @ X, X.T @ y, float(y @ y), 30, f) for f in factors]
    theirs = [
        multivariate_t(np.zeros(30), np.eye(30) + (X * f**2) @ X.T, df=PRIOR_DOF).logpdf(y)
        for f in factors
    ]
    np.testing.assert_allclose(np.diff(ours), np.diff(theirs), rtol=1e-9)


def test_what_is_left_to_the_class_gains_evidence_and_nothing_else_would():
    rng = np.random.default_rng(2)
    X = rng.normal(size=(60, 12))
    true = np.where(np.isin(np.arange(12), (4, 5)), 1.0, 0.02) * rng.normal(size=12)
    y = X @ true + rng.normal(0.0, 0.3, 60)
    errors = [np.arange(i, i + 2) for i in range(0, 12, 2)]

    def likely(factor):
        V = np.eye(60) + (X * factor**2) @ X.T
        return multivariate_t(np.zeros(60), V, df=PRIOR_DOF).logpdf(y)

    small = np.full(12, 1.0 / 16.0)
    found = _released(X.T @ X, X.T @ y, float(y @ y), 60, small, errors)
    assert (found[4:6] == 1.0).all()
    assert found[[0, 1, 2, 3]].max() < 1.0
    assert likely(found) > likely(small) + 10.0
    for of in errors:
        other = found.copy()
        other[of] = 1.0
        assert likely(other) <= likely(found)


@pytest.mark.parametrize("seed", range(4))
def test_a_good_machine_is_reported_as_well_as_by_least_squares_of_what_is_there(seed):
    run = holes(seed)
    model = ordinary_model(run.touches.chain)
    fit = fit_run(run, model)
    wide = fit_run(run, model, Prior.of_effects(model.effects))
    assert fit.prior.factor[: len(model.parameters)].min() < 0.1
    assert fit.test_rms < wide.test_rms
    rows = {r.symbol: r for r in geometry_rows(fit)}
    x, y = run.touches.point[:, 0], run.touches.point[:, 1]
    nx, ny = run.touches.normal[:, 0], run.touches.normal[:, 1]
    A = np.column_stack([nx, ny, ny * x - nx * y, -nx * x, -ny * y, nx * y])  # place, then errors
    theta = np.linalg.lstsq(A, run.deviation, rcond=None)[0]
    u = NOISE * np.sqrt(np.diag(np.linalg.inv(A.T @ A)))
    for symbol, k in (("EXX", 3), ("EC0Y", 5)):
        row = rows[symbol]
        assert row.is_determined
        assert abs(row.estimate.value - theta[k]) < u[k]
        assert row.estimate.u < 1.5 * u[k]
    # what is expected of the class stays what it is: only the belief for this machine is narrower
    wide_rows = {r.symbol: r for r in geometry_rows(wide)}
    assert rows["EXX"].expected == pytest.approx(wide_rows["EXX"].expected)


def test_lines_keep_what_is_expected_of_them_and_so_does_a_machine_of_its_class():
    run = holes(1, size=25.0)
    model = ordinary_model(run.touches.chain)
    factor = fit_run(run, model).prior.factor[: len(model.parameters)]
    bends = np.array(
        [getattr(e, "shape", "") in ("parabolic", "sinusoidal") for e in model.effects]
    )
    assert (factor[~bends] == 1.0).all()
    # X is bowed by 120 µm, as an ordinary machine may be: one curve of many, so not quite the class
    x = run.touches.point[:, 0]
    bow = 120.0 * UM * ((x - 250.0) / 250.0) ** 2 * run.touches.normal[:, 1]
    bowed = fit_run(replace(run, deviation=run.deviation - bow), model)
    assert bowed.prior.factor.min() > factor.min()


def test_one_error_that_is_not_as_small_as_the_rest_keeps_what_is_expected_of_it():
    run = holes(2)
    model = ordinary_model(run.touches.chain)
    x = run.touches.point[:, 0]
    bow = 160.0 * UM * ((x - 250.0) / 250.0) ** 2 * run.touches.normal[:, 1]
    fit = fit_run(replace(run, deviation=run.deviation - bow), model)
    factor = {e.name: fit.prior.factor[i] for i, e in enumerate(model.effects)}
    assert factor["geometric(EYX,parabolic)"] == factor["geometric(EYX,sinusoidal)"] == 1.0
    assert factor["geometric(EXX,parabolic)"] == factor["geometric(EXY,parabolic)"] < 0.3


def beside_a_turning_head(names: dict[str, float], seed: int = 0) -> Run:
    """A good gantry with a head of two axes: its lines and scales, and errors by their names."""
    rng, n = np.random.default_rng(seed), 400
    chain = read_machine(EXAMPLES / "machines" / "gantry-machine.toml")
    q, poses = np.zeros((n, len(chain.axes))), np.repeat(np.arange(40), n // 40)
    for axis, (low, high) in {"X": (-300, 300), "Y": (-300, 300), "Z": (-300, -100)}.items():
        q[:, chain.axis_index(axis)] = rng.uniform(low, high, n)
    for axis, largest in {"A": 48 * DEG, "C": 180 * DEG}.items():
        q[:, chain.axis_index(axis)] = rng.uniform(-largest, largest, 40)[poses]
    normal = rng.normal((0.0, 0.0, 1.5), 1.0, (n, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    t = Touches(
        chain=chain,
        q=q,
        length=np.full(n, 240.0),
        radius=np.full(n, 3.0),
        point=np.zeros((n, 3)),
        normal=normal,
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=9.0 * np.arange(n),
        approach=np.zeros(q.shape),
        pose=poses,
    )
    t = replace(t, point=t.ball_artefact - 3.0 * t.normal)
    ordinary = ordinary_model(chain)
    is_large = [e.name.endswith("linear)") or e.kind == "location" for e in ordinary.effects]
    size = np.repeat(np.where(is_large, 0.3, 1 / 64), [len(e.parameters) for e in ordinary.effects])
    theta = list(size * rng.normal(0.0, ordinary.prior_sd))
    known = [e.name for e in ordinary.effects for _ in e.parameters]
    added = [name for name in names if name not in known]
    for name, amplitude in names.items():
        if name in known:
            theta[known.index(name)] = amplitude
    effects = [parse_effect(name, chain) for name in added]
    for name, effect in zip(added, effects, strict=True):
        theta += [names[name], *(0.0 for _ in effect.parameters[1:])]
    moved = Model(chain, (*ordinary.effects, *effects)).deviation(t, np.array(theta))
    return Run(t, moved + rng.normal(0.0, 0.6 * UM, n), np.full(n, 0.6 * UM))


def test_an_error_is_not_drawn_to_zero_beside_an_effect_that_was_found() -> None:
    """While the wave of C is missing, an error of A a sixteenth of its class is likeliest."""
    own = "geometric(EAA,sinusoidal)"
    run = beside_a_turning_head({own: 12.0 * URAD, "periodic(ECC)": 60.0 * URAD}, seed=1)
    names = ("periodic(ECC)", "geometric(EAA,2-4)", "gravity(EAA)", "backlash(X)")
    candidates = [parse_effect(name, run.touches.chain) for name in names]
    found = diagnose(run, candidates=candidates)
    assert [e.name for e in found.found] == ["periodic(ECC)"]
    fit = found.fit
    (value,) = fit.theta[fit.of_effect(own)]
    (u,) = np.sqrt(np.diag(fit.covariance)[fit.of_effect(own)])
    assert abs(value - 12.0 * URAD) < 2.0 * u < 6.0 * URAD


def test_growth_of_the_spindle_follows_a_head_that_turns() -> None:
    """It grows along the tool, which no axis of the machine does (ISO 230-3)."""
    run = beside_a_turning_head({"thermal-lag(EZC1)": -15.0 * UM})
    found = diagnose(run)
    assert [e.name for e in found.found] == ["thermal-lag(EZC1)"]
    (size,) = (s.size for s in found.steps if s.effect is not None)
    assert abs(size.value + 15.0) < 2.0 * size.u < 3.0
    q = run.touches.q.copy()
    q[:, run.touches.chain.axis_index("A")] = q[:, run.touches.chain.axis_index("C")] = 0.0
    assert "thermal-lag(EZC1)" not in {e.name for e in proposals(replace(run.touches, q=q))}
