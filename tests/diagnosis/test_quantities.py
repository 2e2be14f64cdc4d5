"""Sizes that are physical quantities within the run, against numbers from no part of the fit."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_up import gauge_touches, made_up

from matstd.diagnosis.fit import Prior, Role, fit_run, reported
from matstd.diagnosis.geometry import Quantity, geometry_rows, learnt_geometry
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.machine import make_chain
from matstd.twin.model import Declared, Model, Parameter
from matstd.twin.record import Instrument, Run, Touches, at_poses
from matstd.twin.units import MINUTE, UM, URAD

U = 0.3 * UM


def in_a_corner(seed: int) -> Touches:
    """Touches of a three-axis machine in a part of its travel, denser on one side."""
    rng = np.random.default_rng(seed)
    t = made_up("hmc1995", 300)
    q = t.q.copy()
    for axis, ends in {"X": (-100, 200, 250), "Y": (-50, -40, 150), "Z": (-60, 0, 60)}.items():
        q[:, t.chain.axis_index(axis)] = rng.triangular(*ends, len(t))
    t = replace(t, q=q)
    return replace(t, point=t.ball_artefact - 3.0 * t.normal)


def squareness_of_lines(model: Model, theta: np.ndarray, t: Touches) -> float:
    """EC0Y of the true straight lines of X and Y over the probed readings, rad (ISO 230-1)."""
    slopes = []
    for axis, across in (("X", 1), ("Y", 0)):
        own, q = t.chain.axis_index(axis), np.tile(t.q.mean(axis=0), (len(t), 1))
        q[:, own] = t.q[:, own]
        moved = model.tip_deviation(at_poses(t.chain, q, float(t.length.mean())), theta)
        slopes.append(np.polyfit(t.q[:, own], moved[:, across], 1)[0])
    return float(-sum(slopes))


@pytest.mark.parametrize("seed", range(4))
def test_squareness_is_that_of_the_straight_lines_where_it_was_probed(seed: int) -> None:
    """Straightness of third to fifth degree is in no part of the model: lines are 50 µrad off."""
    rng = np.random.default_rng(seed)
    t = in_a_corner(seed)
    model = ordinary_model(t.chain)
    curves = [parse_effect(f"geometric({name},3-5)", t.chain) for name in ("EYX", "EXY")]
    true = Model(t.chain, (*model.effects, *curves))
    theta = np.concatenate([rng.normal(0.0, 0.3 * model.prior_sd), rng.normal(0.0, 6.0 * UM, 6)])
    run = Run(t, true.deviation(t, theta) + rng.normal(0.0, 2 * U, len(t)), np.full(len(t), 2 * U))
    rows = {r.symbol: r for r in learnt_geometry(fit_run(run, model)).rows}
    found = rows["EC0Y"].estimate
    assert abs(found.value - squareness_of_lines(true, theta, t)) < 3.0 * found.u
    assert found.u < 10.0 * URAD


@dataclass(frozen=True)
class Bow(Declared):
    """A guideway of Y that bends along X."""

    kind, acts_on = "bow", "EXY"
    parameters = (Parameter("amplitude", "mm", 10 * UM),)

    def amounts(self, touches: Touches) -> tuple[np.ndarray]:
        return (over_travel(touches, "Y") ** 2,)


def over_travel(t: Touches, axis: str) -> np.ndarray:
    """Readings from -1 to 1 over the travel of an axis."""
    low, high = t.chain.link(axis).range
    return (2.0 * t.reading(axis) - low - high) / (high - low)


def test_straightness_is_no_squareness_of_an_axis_that_goes_with_it() -> None:
    """Below a head that tilts, Z goes with the square of Y; a parabola of Y does not incline Z."""
    rng = np.random.default_rng(3)
    t = made_up("hmc1995", 300)
    q, z = t.q.copy(), t.chain.axis_index("Z")
    low, high = t.chain.link("Z").range
    q[:, z] = high + (low - high) * (0.9 * over_travel(t, "Y") ** 2 + rng.uniform(0.0, 0.1, len(t)))
    t = replace(t, q=q, point=replace(t, q=q).ball_artefact - 3.0 * t.normal)
    moved = Model(t.chain, (Bow(),)).deviation(t, np.array([10.0 * UM]))
    run = Run(t, moved + rng.normal(0.0, U, len(t)), np.full(len(t), U))
    rows = {r.symbol: r.estimate for r in geometry_rows(fit_run(run, ordinary_model(t.chain)))}
    assert rows["EXY"].value > 5.0 * UM
    assert abs(rows["EB0Z"].value) < 3.0 * rows["EB0Z"].u
    assert rows["EB0Z"].u < 3.0 * URAD


@dataclass(frozen=True)
class Ramp(Declared):
    """What pushes the slide beyond a reading of X."""

    kind, acts_on = "ramp", "EYX"
    parameters = (Parameter("amplitude", "mm", 10 * UM),)
    is_of_reading: bool

    def amounts(self, touches: Touches) -> tuple[np.ndarray]:
        return (np.clip((touches.reading("X") - 60.0) / 50.0, 0.0, 1.0),)


@pytest.mark.parametrize("is_part", [True, False])
def test_a_function_of_the_reading_is_a_part_of_the_squareness(is_part: bool) -> None:
    """It turns the straight line of X, so the whole is reported, and what the ramp adds to it."""
    rng = np.random.default_rng(7)
    t, ramp = in_a_corner(7), Ramp(is_part)
    ordinary = ordinary_model(t.chain)
    model = Model(t.chain, (*ordinary.effects, ramp))
    theta = np.concatenate([rng.normal(0.0, 0.3 * ordinary.prior_sd), [9.0 * UM]])
    run = Run(t, model.deviation(t, theta) + rng.normal(0.0, U, len(t)), np.full(len(t), U))
    (row,) = (r for r in geometry_rows(fit_run(run, model)) if r.symbol == "EC0Y")
    part = squareness_of_lines(Model(t.chain, (ramp,)), theta[-1:], t)
    whole = squareness_of_lines(model, theta, t)
    assert abs(part) > 20.0 * URAD
    expected = whole if is_part else whole - part
    assert abs(row.estimate.value - expected) < 3.0 * row.estimate.u < 0.5 * abs(part)
    assert row.by_laws is not None
    assert abs(row.by_laws.value - is_part * part) <= 3.0 * row.by_laws.u < 0.5 * abs(part)


def test_what_the_choice_of_the_model_adds_is_part_of_the_uncertainty() -> None:
    """Without curves in the machine every model says the same; with one they differ.

    By little: lines over the probed readings hardly depend on what a model has in between.
    """
    t = in_a_corner(1)
    model = ordinary_model(t.chain)
    curve = parse_effect("geometric(EYX,8-8)", t.chain)
    noise = np.random.default_rng(3).normal(0.0, 2 * U, len(t))
    added = []
    for size in (0.0, 50.0 * UM):
        moved = Model(t.chain, (curve,)).deviation(t, np.array([size]))
        fit = fit_run(Run(t, moved + noise, np.full(len(t), 2 * U)), model)
        (plain,) = (r for r in geometry_rows(fit) if r.symbol == "EC0Y")
        (row,) = (r for r in learnt_geometry(fit).rows if r.symbol == "EC0Y")
        assert row.estimate.value == plain.estimate.value
        assert row.estimate.u == pytest.approx(np.hypot(plain.estimate.u, row.u_model))
        added.append(row.u_model / plain.estimate.u)
    assert added[0] < 0.05
    assert added[1] > 0.2


def test_a_residual_makes_no_size_of_what_the_run_leaves_open() -> None:
    """The prior is widened by a residual of 2 mm; a scale over 4 mm of travel stays open."""
    rng = np.random.default_rng(1)
    t = in_a_corner(2)
    q = t.q.copy()
    x = t.chain.axis_index("X")
    q[:, x] = np.clip(q[:, x], 98.0, 102.0)
    t = replace(t, q=q)
    t = replace(t, point=t.ball_artefact - 3.0 * t.normal)
    wild = 0.5 * np.sign(rng.normal(size=len(t))) * np.sin(0.3 * t.q[:, t.chain.axis_index("Y")])
    rows = geometry_rows(fit_run(Run(t, wild, np.full(len(t), U)), ordinary_model(t.chain)))
    for row in rows:
        if row.quantity is Quantity.SCALE and row.is_determined:
            assert abs(row.estimate.value) > 2.0 * row.estimate.u or 3 * row.estimate.u < 200e-6


def test_a_screw_is_reported_by_its_change_within_the_run() -> None:
    """Twenty minutes of a screw that needs an hour: final values are a guess, changes are not.

    By hand: low end 5 µm, high end 60 µm at last, of a travel of 800 mm probed from 200 to 600.
    """
    n, tau, spent = 240, 60.0 * MINUTE, 20.0 * MINUTE
    time = np.linspace(0.0, spent, n)
    x = np.tile(np.linspace(200.0, 600.0, 12), n // 12)
    chain = make_chain("axis", "[w f X t]", {"X": ordinary_axis()})
    t = replace(
        gauge_touches(time),
        chain=chain,
        q=x[:, None],
        normal=np.tile([1.0, 0.0, 0.0], (n, 1)),
        point=np.column_stack([x, np.zeros((n, 2))]),
        instrument=Instrument.LASER,
    )
    y = 1.0 - np.exp(-time / tau)
    grown = y * (5.0 * UM * (1.0 - x / 800.0) + 60.0 * UM * x / 800.0)
    noise = np.random.default_rng(4).normal(0.0, U, n)
    effect = parse_effect("axis-warming(X)", chain)
    effect = effect.tuned(tau)
    model = Model(chain, (effect,))
    run = Run(t, -grown + noise, np.full(n, U))
    first = fit_run(run, model)
    fit = fit_run(run, model, free_inner=first.theta[:2])
    numbers = {r.quantity: r for r in reported(fit, effect)}
    whole = 1.0 - np.exp(-spent / tau)
    for word, end in (("lowest", 200.0), ("highest", 600.0)):
        change = numbers[f"change_at_{word}_reading"]
        true = whole * (5.0 + 55.0 * end / 800.0)
        assert change.role is Role.SIZE
        assert abs(change.value - true) < 3.5 * change.u
        assert change.u < 0.5
    assert numbers["high_end"].u > 3.0 * numbers["change_at_highest_reading"].u
    assert "amplitude" not in numbers


def ordinary_axis():
    from matstd.twin.machine.chain import Axis

    return Axis((0.0, 800.0))


def test_compliances_of_the_tool_are_two_quantities() -> None:
    """Sideways and along have no common size: 0.8 and 0.2 µm/N are reported as such."""
    t = made_up("hmc1995", 200)
    effect = parse_effect("stiffness(t)", t.chain)
    model = Model(t.chain, (effect,))
    exact = model.deviation(t, np.array([0.8e-3, 0.2e-3]))
    noise = np.random.default_rng(2).normal(0.0, U, len(t))
    numbers = {
        r.quantity: r
        for r in reported(fit_run(Run(t, exact + noise, np.full(len(t), U)), model), effect)
    }
    assert set(numbers) == {"sideways", "along"}
    for name, true in (("sideways", 0.8), ("along", 0.2)):
        assert numbers[name].role is Role.SIZE
        assert abs(numbers[name].value - true) < 3.5 * numbers[name].u


def test_play_and_a_compliance_of_two_sides_are_distinguished_from_the_mean_compliance() -> None:
    """A hinge by hand: 0.06 µm/N pulled, 0.10 µm/N pushed, 4 µm of play between."""
    t = made_up("hmc1995", 300)
    load = np.linspace(-200.0, 200.0, 300)
    t = replace(t, force=load[:, None] * [0.0, 0.0, 1.0])
    moved = np.where(load > 0.0, 0.10 * UM, 0.06 * UM) * load + 2.0 * UM * np.sign(load)
    noise = np.random.default_rng(6).normal(0.0, U, len(t))
    # along z, as the normals see it: a tool that yields upwards finds the surface lower
    run = Run(t, -moved * t.normal_table[:, 2] + noise, np.full(len(t), U))
    effects = [parse_effect(f"{kind}(Z)", t.chain) for kind in ("stiffness", "load-play")]
    fit = fit_run(run, Model(t.chain, tuple(effects)))
    numbers = {r.quantity: r for e in effects for r in reported(fit, e)}
    truth = {"compliance": 0.08, "play": 4.0, "difference_of_compliance": 0.04}
    for name, true in truth.items():
        assert numbers[name].role is Role.SIZE
        assert abs(numbers[name].value - true) < 3.5 * numbers[name].u, name


def test_a_peak_to_valley_has_no_sign_and_a_curve_that_turned_over_has_changed() -> None:
    """A bow of 16 µm against one of -16 µm: its height before and now, and up to twice between."""
    t = in_a_corner(3)
    model = ordinary_model(t.chain)
    bow = parse_effect("geometric(EYX,parabolic)", t.chain)
    rng = np.random.default_rng(6)
    fits = []
    for sign in (-1.0, 1.0):
        moved = Model(t.chain, (bow,)).deviation(t, np.array([sign * 40.0 * UM]))
        run = Run(t, moved + rng.normal(0.0, U, len(t)), np.full(len(t), U))
        fits.append(fit_run(run, model))
    first, second = fits
    count = len(model.parameters)
    before = Prior.of_estimates(first.theta[:count], first.covariance[:count, :count])
    rows = geometry_rows(second, before)
    spans = [r for r in rows if r.quantity in (Quantity.STRAIGHTNESS, Quantity.ANGULAR)]
    assert len(spans) > 6
    assert all(r.estimate.value >= 0.0 and r.before.value >= 0.0 for r in spans)
    (row,) = (r for r in spans if r.symbol == "EYX")
    q = np.linspace(*(f(t.reading("X")) for f in (np.min, np.max)), 21)
    low, high = t.chain.link("X").range
    curve = 40.0 * UM * np.polynomial.Chebyshev.basis(2)((2.0 * q - low - high) / (high - low))
    height = np.ptp(curve - np.polyval(np.polyfit(q, curve, 1), q))
    for one in (row.before, row.estimate):
        assert one.value == pytest.approx(height, abs=4.0 * one.u)
    assert height < abs(row.change.value) < 2.0 * height + 4.0 * row.change.u
    assert row.has_changed
    assert row.has_changed_since_model
