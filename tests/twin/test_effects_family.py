"""What holds for every effect of the library, whatever its physics."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from made_up import MACHINES, arm_poses, made_up

from matstd.twin.library import ordinary_model, parse_effect, proposals
from matstd.twin.machine import Contribution
from matstd.twin.model import Effect, Model, columns, contribution, is_tunable
from matstd.twin.record import Instrument
from matstd.twin.thermal import field
from matstd.twin.thermal.drive_columns import first_order_lag
from matstd.twin.units import NM

SECOND_ORDER = 60 * NM
"""What products of two errors of 50 um and 100 urad on arms below 1 m may come to."""
RELATIVE_ROUNDING = 1e-9


def on_a_path(touches):
    """The same as a logger would see them that states the speeds of two axes."""
    speeds = {f"v{axis}_mm_s": touches.reading(axis) / 10.0 for axis in "YZ"}
    return replace(touches, instrument=Instrument.BALL_BAR, value=speeds)


def elastic(touches):
    """What is never proposed: beams, whose sections are the user's to say, higher couplings."""
    chain = touches.chain
    axis = next(a for a in chain.linear_axes if not carried_by_rotary(chain, a))
    low, high = chain.link(axis).range
    at, span = 50.0 - low, high - low + 100.0
    texts = (
        f"beam({axis},cantilever,220x180x20,at:{at:g},mass:80,offset:0:60:-100)",
        f"beam({axis},clamped,d160,at:{at:g},span:{span:g},mass:120,material:cast-iron)",
        f"beam({axis},supported,200x300,at:{high + 50.0:g},sense:-1,span:{span:g},down:+Y)",
    )
    rotary = chain.rotary_axes[:1] or chain.linear_axes[:1]
    others = [a for a in (*rotary, *chain.linear_axes) if a != axis][:2]
    couplings = [f"coupling(EB{axis},{other},{n})" for n, other in zip((2, 3), others, strict=True)]
    return [parse_effect(text, chain) for text in (*texts, *couplings)]


def learnt(touches):
    """What is learnt and never proposed: laws without a cause."""
    chain = touches.chain
    axis, other = chain.linear_axes[0], chain.linear_axes[1]
    texts = (
        f"law(EZ{axis},bump {other})",
        f"law(bias,kink {axis})",
        f"law(shift,lin time,quad {axis})",
        f"law(tilt,sine {other})",
        f"law(growth,curve {axis})",
    )
    return [parse_effect(text, chain) for text in texts]


def carried_by_rotary(chain, axis):
    i = chain.link_index(axis)
    ground = chain.links[i + 1 :] if chain.link(axis).carries_workpiece else chain.links[:i]
    same = [k for k in ground if k.carries_workpiece == chain.link(axis).carries_workpiece]
    return any(k.kind == "rotary" for k in same)


RUNS = {label: made_up(label) for label in MACHINES} | {"arm": arm_poses()}
WITHOUT_A_BALL = ["position-table", "axis-warming"]
ALL = [
    (label, e)
    for label, touches in RUNS.items()
    if label in MACHINES
    for e in (
        *proposals(touches),
        *proposals(replace(touches, instrument=Instrument.LASER), WITHOUT_A_BALL),
        *proposals(on_a_path(touches), ["servo-lag"]),
        field(touches),  # weighed against what is proposed
        parse_effect(
            f"jump(E{touches.chain.linear_axes[0]}{touches.chain.linear_axes[0]})", touches.chain
        ),
        *elastic(touches),  # sections are the user's
        *learnt(touches),
    )
]
ALL += [("arm", e) for e in proposals(RUNS["arm"], ["joint-sag"])]
# thirty of a kind on a machine are the same code: every one that differs in kind and in axis
SOME = list(
    {
        (label, e.kind, getattr(getattr(e, "symbol", None), "link", ""), type(e)): (label, e)
        for label, e in ALL
    }.values()
)
NAMES = [f"{label}-{e.name}" for label, e in SOME]


def every(label: str) -> list[Effect]:
    return [e for other, e in ALL if other == label]


def test_the_made_up_runs_have_every_kind_of_effect() -> None:
    from matstd.twin.library.catalogue import kinds

    assert {e.kind for _, e in ALL} == {k.word for k in kinds()}
    assert len({e.name for e in every("hsm600u")}) == len(every("hsm600u"))


@pytest.mark.parametrize("label", MACHINES)
def test_names_lead_back_to_the_effect(label: str) -> None:
    """Sines of the ordinary model with their phase too: a saved model is the model."""
    chain = RUNS[label].chain
    for effect in (*every(label), *ordinary_model(chain).effects):
        assert parse_effect(effect.name, chain) == effect
        assert effect.name.split("(")[0] == effect.kind


@pytest.mark.parametrize(("label", "effect"), SOME, ids=NAMES)
def test_zero_at_zero_and_additive(label: str, effect: Effect) -> None:
    """Contributions of theta, of -theta and of nothing; one parameter at a time adds up."""
    touches, count = RUNS[label], len(effect.parameters)
    nothing = contribution([(effect, np.zeros(count))], touches)
    assert all(not np.any(part) for part in nothing)
    theta = np.array([p.sd for p in effect.parameters])
    whole = contribution([(effect, theta)], touches)
    for part in Contribution._fields:
        each = [contribution([(effect, row)], touches) for row in np.diag(theta)]
        total = sum(getattr(c, part) for c in each)
        scale = np.max(np.abs(getattr(whole, part)))
        np.testing.assert_allclose(
            getattr(whole, part), total, atol=RELATIVE_ROUNDING * max(scale, NM)
        )


@pytest.mark.parametrize("label", MACHINES)
def test_first_order_columns_match_the_exact_machine(label: str) -> None:
    """Each effect at two of its expected sizes: the exact product differs in second order only."""
    touches = RUNS[label][np.arange(0, 300, 6)]
    rng = np.random.default_rng(3)
    for _, effect in (pair for pair in SOME if pair[0] == label):
        model = Model(touches.chain, (effect,))
        theta = model.prior_sd * rng.uniform(-1.0, 1.0, len(model.prior_sd))
        linear = model.columns(touches) @ theta
        size = np.max(np.abs(linear))
        if size > 0.3:  # mm: keep products of errors within the tolerance
            theta, linear = theta * 0.1 / size, linear * 0.1 / size
        exact = model.deviation(touches, theta)
        assert np.max(np.abs(exact - linear)) < SECOND_ORDER, effect.name


@pytest.mark.parametrize("label", MACHINES)
def test_effects_show_and_parameters_have_sizes(label: str) -> None:
    touches = RUNS[label]
    for effect in every(label):
        C = columns([effect], touches)
        assert C.shape == (len(touches), len(effect.parameters))
        assert np.all(np.isfinite(C))
        assert all(p.sd > 0.0 for p in effect.parameters)
        assert len({p.name for p in effect.parameters}) == len(effect.parameters)
        assert np.any(np.abs(C) > 1e-9), effect.name


def test_what_moves_nothing_is_not_proposed() -> None:
    """The ball hangs on the axis about which Z of an upright machine rolls; not so when tilted."""
    assert not [e.name for e in every("hsm600u") if "(ECZ" in e.name]
    assert [e.name for e in every("fork") if "(ECZ" in e.name]


@pytest.mark.parametrize("label", MACHINES)
def test_inner_parameters_have_ascending_grids_and_can_be_set(label: str) -> None:
    touches = RUNS[label]
    for effect in every(label):
        if not is_tunable(effect):
            continue
        inner = effect.inner(touches)
        assert list(effect.tuning) == [i.name for i in inner]
        for i in inner:
            assert len(i.grid) >= (2 if i.continuous else 1)
            assert np.all(np.diff(i.grid) > 0.0)
        values = [float(i.grid[len(i.grid) // 2]) for i in inner]
        tuned = effect.tuned(*values)
        assert list(tuned.tuning.values()) == values
        assert tuned.name == effect.name
        if all(len(i.grid) == 1 for i in inner):
            continue
        # another tuning is another signature
        other = effect.tuned(*(float(i.grid[0]) for i in inner))
        assert not np.allclose(columns([tuned], touches), columns([other], touches))


def test_the_scan_of_a_period_keeps_nine_tenths_of_any_sine() -> None:
    """The worst period between two scanned ones, over evenly touched travel."""
    touches = RUNS["hmc1995"]
    (period,) = parse_effect("periodic(EXX)", touches.chain).inner(touches)
    frequency = 1.0 / period.grid
    middle = 0.5 * (frequency[200] + frequency[201])
    x = np.linspace(*np.array([-1.0, 1.0]) * 0.5 * np.ptp(touches.reading("X")), 4000)
    true = np.sin(2.0 * np.pi * middle * x + 0.3)
    basis = np.exp(2j * np.pi * frequency[200] * x)
    A = np.stack([basis.real, basis.imag], axis=1)
    fitted = A @ np.linalg.lstsq(A, true, rcond=None)[0]
    assert np.linalg.norm(fitted) > 0.9 * np.linalg.norm(true)


def test_lag_after_steps_of_the_spindle() -> None:
    """Cold at time zero; 1 unit from the record at 100 s to the one at 400 s, then nothing."""
    t = np.array([100.0, 250.0, 400.0, 700.0])
    speed = np.array([1.0, 1.0, 0.0, 0.0])
    tau = 150.0
    # what is set at the first record has been set since time zero
    warm = [1 - np.exp(-100 / tau), 1 - np.exp(-250 / tau), 1 - np.exp(-400 / tau)]
    warm.append(warm[-1] * np.exp(-300 / tau))
    np.testing.assert_allclose(first_order_lag(t, speed, tau, steps=True), warm, atol=1e-12)


def test_lag_does_not_mind_the_order_of_the_touches() -> None:
    rng = np.random.default_rng(2)
    t, d = np.sort(rng.uniform(0.0, 5000.0, 50)), rng.normal(size=50)
    mixed = rng.permutation(50)
    for steps in (False, True):
        sorted_lag = first_order_lag(t, d, 800.0, steps)
        np.testing.assert_allclose(
            first_order_lag(t[mixed], d[mixed], 800.0, steps), sorted_lag[mixed]
        )


def test_touching_both_sides_is_needed_for_backlash() -> None:
    touches = RUNS["hsm600u"]
    names = {e.name for e in proposals(touches, only=["backlash"])}
    assert names == {f"backlash({a})" for a in "XYZBC"}
    one_sided = touches[touches.last_move("B") > 0.0]
    assert "backlash(B)" not in {e.name for e in proposals(one_sided, only=["backlash"])}


def test_sensors_that_say_nothing_are_not_proposed() -> None:
    text = " ".join(e.name for _, e in ALL)
    assert "constant" not in text
    assert "dead" not in text
    assert "room" in text


def test_axes_that_stood_still_are_not_proposed() -> None:
    touches = RUNS["hsm600u"]
    still = touches[np.flatnonzero(touches.reading("B") == touches.reading("B")[0])]
    words = ["coupling", "periodic", "geometric", "gravity", "backlash"]
    for effect in proposals(still, only=words):
        assert "B)" not in effect.name.replace("EBB", "").replace(",B)", "B)"), effect.name
        assert not effect.name.endswith("B,4)")


def test_pairs_of_effects_keep_their_own_parameters() -> None:
    """Two effects side by side have the columns that each has alone."""
    touches = RUNS["fork"]
    for (_, a), (_, b) in itertools.pairwise(pair for pair in SOME if pair[0] == "fork"):
        both = columns([a, b], touches)
        alone = np.hstack([columns([a], touches), columns([b], touches)])
        np.testing.assert_array_equal(both, alone)
