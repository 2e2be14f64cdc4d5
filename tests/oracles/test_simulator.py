"""The simulator against the twin: two models that share no code must agree on what both describe.

Component, location and set-up errors (the proof of `matstd volumetric`), then every effect of the
library: what an exact run with the effect's own formula reads, against the twin's columns.
"""

import numpy as np
import pytest
import simulator_effects as effects
from simulator import probe, run_text
from simulator_case import Ordinary, named, read_back, simulate_case
from simulator_experiment import MACHINES, random_experiment
from simulator_machine import read_machine, tip
from simulator_surface import foot, random_pads, surface_point

from matstd.twin.files import read_machine as read_chain
from matstd.twin.library import parse_effect
from matstd.twin.machine import Contribution, Family, exact_tip
from matstd.twin.machine import tip as twin_tip
from matstd.twin.model import columns
from matstd.twin.units import NM, UM, URAD

VOLUMETRIC = 0.02 * UM
"""Agreement asked of `matstd volumetric` at errors of 50 um and 100 urad."""
SINGLE = 0.001 * NM
"""One error at a time leaves only rounding between two exact products."""
CURVED = 0.03 * UM
"""Second order of an effect of 10 um beside machine errors of 20 um on curved pads."""


@pytest.fixture(params=MACHINES)
def both(request, tmp_path):
    """A machine in the simulator and in the twin, with poses all over its travels."""
    file = tmp_path / "machine.toml"
    file.write_text(MACHINES[request.param], encoding="utf-8")
    machine, chain = read_machine(MACHINES[request.param]), read_chain(file)
    rng = np.random.default_rng(11)
    q = {a.name: rng.uniform(a.low, a.high, 300) for a in machine.axes}
    return machine, chain, q, np.stack([q[a] for a in chain.axes], axis=1)


def drawn(chain, symbols, n, rng):
    """Errors up to 50 um and 100 urad, as a dictionary and as a contribution."""
    errors, c = {}, Contribution.zeros(n, len(chain.links))
    for s in symbols:
        size = 100 * URAD if s.is_angular else 50 * UM
        errors[s.name] = size * rng.uniform(-1.0, 1.0, n)
        part = c.twist if s.family is Family.COMPONENT else c.place
        part[:, chain.link_index(s.link), s.component] = errors[s.name]
    return errors, c


def test_nominal_poses_agree(both) -> None:
    machine, chain, q, readings = both
    assert np.max(np.abs(tip(machine, q, 160.0) - twin_tip(chain, readings, 160.0))) < SINGLE


def test_every_error_alone_agrees(both) -> None:
    machine, chain, q, readings = both
    rng, nominal = np.random.default_rng(5), tip(machine, q, 160.0)
    for symbol in chain.symbols:
        errors, c = drawn(chain, [symbol], len(readings), rng)
        own = tip(machine, q, 160.0, errors) - nominal
        twin = exact_tip(chain, readings, 160.0, c) - nominal
        assert np.max(np.abs(own - twin)) < SINGLE, symbol.name


def test_all_errors_at_once_agree(both) -> None:
    """Order and kind of small rotations differ between the two: second order, and far below."""
    machine, chain, q, readings = both
    errors, c = drawn(chain, chain.symbols, len(readings), np.random.default_rng(6))
    own = tip(machine, q, 160.0, errors)
    twin = exact_tip(chain, readings, 160.0, c)
    assert np.max(np.abs(own - tip(machine, q, 160.0))) > 100 * UM
    assert np.max(np.abs(own - twin)) < VOLUMETRIC


def test_foot_points_on_curved_pads() -> None:
    """A ball lifted along the normal finds its way back to where it came from."""
    rng = np.random.default_rng(8)
    pads, index = random_pads(rng), rng.integers(0, 11, 400)
    x, y = rng.uniform(-18.0, 18.0, (2, 400))
    point, normal = surface_point(pads, index, x, y)
    fx, fy, distance = foot(pads, index, point + 3.0 * normal, (x + 0.5, y - 0.5))
    np.testing.assert_allclose(distance, 3.0, atol=SINGLE)
    np.testing.assert_allclose(np.hypot(fx - x, fy - y), 0.0, atol=NM)


def test_without_errors_the_run_reads_its_noise() -> None:
    """A perfect machine and set-up see the surface where it is, plus the noise of the trigger."""
    e = random_experiment(np.random.default_rng(2), "fork")
    e.errors = {}
    e.actual = [np.array(_pose(s)) for s in e.stated]
    noise = np.random.default_rng(3).normal(0.0, 5 * UM, len(e.time))
    run = probe(e, [], noise, digits=False)
    np.testing.assert_allclose(run.deviation, noise, atol=SINGLE)


def _pose(stated):
    from simulator_experiment import pose_about_z

    return pose_about_z(*stated)


NAMES = {
    "hsm600u": [
        "coupling(EBX,Z)",
        "coupling(EBX,C)",
        "coupling(EBB,C)",
        "backlash(X)",
        "backlash(B)",
        "backlash(C)",
        "periodic(EYY)",
        "periodic(EZC)",
        "thermal-expansion(Z,scaleZ)",
        "thermal-lag(EXC)",
        "thermal-lag(EZZ,spindle_rpm)",
        "thermal-lag(EZZ,spindle)",
        "gravity(EBB)",
        "gravity(EYZ)",
        "gravity(EBB,C)",
        "geometric(EYX,4)",
        "artefact-expansion(artefact)",
        "artefact-slip",
        "drift",
        "probe-lobing",
        "probe-radius",
        "stylus-bending",
        "artefact-form(pad3)",
    ],
    "fork": ["coupling(EBZ,B)", "backlash(B)", "gravity(EBB)", "probe-lobing", "thermal-lag(EBB)"],
    "hmc1995": ["coupling(EAZ,Y)", "backlash(Y)", "probe-lobing", "stylus-bending"],
}
TUNED = {"tau_min": 60.0, "period_mm": 1.0, "harmonic": 1.0, "lobes": 1.0}


@pytest.fixture(scope="module")
def experiments():
    """A run on every machine with its errors, and its touches as the twin reads them."""
    out = {}
    for label in MACHINES:
        e = random_experiment(np.random.default_rng(21), label)
        plain = probe(e, [], np.zeros(len(e.time)), digits=False)
        touches = read_back(run_text(e, plain, True), MACHINES[label]).touches
        out[label] = e, plain, touches
    return out


@pytest.mark.parametrize(
    ("label", "name"), [(m, n) for m, names in NAMES.items() for n in names], ids=str
)
def test_effect_of_the_library_explains_what_the_simulator_hides(experiments, label, name) -> None:
    """10 um or urad of an effect by its own formula; the twin's columns find amplitude and sign."""
    e, plain, touches = experiments[label]
    hidden = named(np.random.default_rng(4), e.machine, name)
    if name == "artefact-form(pad3)":
        hidden = effects.form_of_pad(3, np.array([1.0, 0.14, 0.9, 0.13, 3.7]))
    hidden.amplitude = size = 1.0 if name.endswith(",spindle)") else 10.0  # per K, of 9 K
    shown = probe(e, [hidden], np.zeros(len(e.time)), digits=False).deviation - plain.deviation
    effect = parse_effect(hidden.name, touches.chain)
    inner = [TUNED[k] * v for k, v in hidden.inner.items() if k in TUNED]
    if "at_s" in hidden.inner:
        inner = [touches.time[int(np.ceil(hidden.inner["at_s"] * len(touches)))] - 1e-3]
    if inner:
        effect = effect.tuned(*inner)
    C = columns([effect], touches)
    theta = np.linalg.lstsq(C, shown, rcond=1e-12)[0]
    if effect.kind == "artefact-form":  # a sine wave, by polynomials of limited degree
        assert np.linalg.norm(shown - C @ theta) < 0.1 * np.linalg.norm(shown)
        assert np.linalg.norm(theta) / UM == pytest.approx(size, rel=0.25)
        return
    assert np.max(np.abs(shown - C @ theta)) < CURVED
    assert np.max(np.abs(shown)) > 10 * CURVED
    unit = {"mm": UM, "rad": URAD, "1/K": 1e-6, "mm/h": UM, "mm/K": UM}[effect.parameters[0].unit]
    if len(theta) == 1:
        assert theta[0] / unit == pytest.approx(size, rel=5e-3)
    else:
        same = [t for t, p in zip(theta, effect.parameters, strict=True) if p.unit != "rad"]
        same = same or list(theta)
        assert np.linalg.norm(same) / unit == pytest.approx(size, rel=5e-3)


@pytest.mark.slow
def test_unknown_effects_are_outside_the_library(experiments) -> None:
    """Nothing in the library reproduces more than half of a cable, a pump or a chiller."""
    e, plain, touches = experiments["hsm600u"]
    ordinary = Ordinary(touches)
    for make in (
        lambda: effects.cable(10.0, 30.0, -20.0),
        lambda: effects.pump(847.0, 1.0),
        lambda: effects.chiller(900.0, 0.3),
    ):
        hidden = make()
        hidden.amplitude = 5.0
        shown = probe(e, [hidden], np.zeros(len(e.time)), digits=False).deviation - plain.deviation
        assert ordinary.alike(shown, hidden.name)[0][0] < 0.6, hidden.name


def test_a_case_is_what_its_truth_says() -> None:
    """Wanted visibility, folder texts, chips far outside, and the same case from the same seed."""
    make = lambda: simulate_case(  # noqa: E731
        np.random.default_rng(17),
        "hmc1995",
        ["backlash(Y)"],
        hard=True,
        signal_to_noise=(20.0, 20.0),
        with_alike=False,
    )
    text, machine_text, truth = make()
    assert (text, machine_text, truth) == make()
    (hidden,) = truth["hidden"]
    assert hidden["effect"] == "backlash(Y)"
    assert hidden["detectable"]
    run = read_back(text, machine_text)
    assert len(run.touches) == truth["touches"] == 780
    ordinary = Ordinary(run.touches)
    signature = columns([parse_effect("backlash(Y)", run.touches.chain)], run.touches)[:, 0]
    seen = hidden["amplitude"] * UM * np.linalg.norm(ordinary.left(signature))
    assert seen / (truth["noise_um"] * UM) == pytest.approx(20.0, rel=0.02)
    left = ordinary.left(run.deviation)
    assert np.min(left[truth["chips"]]) > 10 * UM
    assert truth["chi2_ratio_baseline"] > 10.0


@pytest.mark.parametrize("label", MACHINES)
def test_nothing_hidden_leaves_the_noise(label: str) -> None:
    """Chi-square per degree of freedom of the ordinary model over 2 runs: 1 within 4 deviations."""
    ratios, freedom = [], 0.0
    for seed in range(2):
        truth = simulate_case(np.random.default_rng([40, seed]), label)[2]
        ratios.append(truth["chi2_ratio_baseline"])
        freedom += truth["touches"] - truth["rank"]
    assert abs(np.mean(ratios) - 1.0) < 4.0 * np.sqrt(2.0 / freedom)
