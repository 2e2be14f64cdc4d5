"""Trajectories and the paper's figures 2 and 3: by hand, and by the second model of the machine."""

from pathlib import Path

import numpy as np
import pytest
from simulator_machine import read_machine as second_model
from simulator_machine import tip as second_tip

from matstd.report.maps.trajectory_pictures import axis_effect_picture, statistics_picture
from matstd.report.words import sampling_words
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.montecarlo import volumetric
from matstd.sensitivity.population import Distributions, Population
from matstd.sensitivity.study import along_path, paper_trajectory
from matstd.sensitivity.study.trajectory import axis_effect, axis_errors
from matstd.twin.effects import LocationError, component
from matstd.twin.errors import DesignError, OutsideTravel, UnknownAxis
from matstd.twin.files import read_machine
from matstd.twin.machine import Axis, make_chain
from matstd.twin.units import NM, UM, URAD

LENGTH = 160.0
SECOND_ORDER = 5e-6
"""Two rotations of 100 µrad in another order turn an arm of 400 mm by 4 nm, mm."""
MACHINE = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"


@pytest.fixture(scope="module")
def own():
    return read_machine(MACHINE)


@pytest.fixture(scope="module")
def path(own):
    return paper_trajectory(Workspace(own, {}, LENGTH), count=121)


def reading(path, axis):
    return path.q[:, path.chain.axis_index(axis)]


def test_x_and_c_run_linearly_and_b_swings(path, own):
    s = np.linspace(0.0, 1.0, 121)
    assert path.name == "X and C linear, B sinusoidal"
    assert set(path.moving) == {"X", "B", "C"}
    for axis in "XC":
        low, high = own.link(axis).range
        np.testing.assert_allclose(reading(path, axis), low + s * (high - low), atol=NM)
    low, high = own.link("B").range
    np.testing.assert_allclose(
        reading(path, "B"), (low + high) / 2 + (high - low) / 2 * np.sin(4 * np.pi * s), atol=NM
    )
    np.testing.assert_array_equal(reading(path, "Y"), np.mean(own.link("Y").range))


def test_held_axes_stay_where_they_are_wished(own):
    path = paper_trajectory(Workspace(own, {}, LENGTH), held={"Y": 20.0})
    np.testing.assert_array_equal(reading(path, "Y"), 20.0)
    assert "Y" not in path.moving


def test_machines_without_rotary_axes_have_a_path_too():
    chain = make_chain(
        "m", "[w f X Y Z t]", {n: Axis((-100.0, 100.0)) for n in "XYZ"}, (0.0, 0.0, -300.0)
    )
    path = paper_trajectory(Workspace(chain, {}, 50.0))
    assert path.name == "X linear, Y sinusoidal"


def test_translations_of_x_by_hand(own, path):
    # figure 2 without angles: every translation counts once wherever the tool is
    errors = [
        (component(own, name, "linear"), np.array([size * UM]))
        for name, size in (("EXX", 50.0), ("EYX", 75.0), ("EZX", 100.0))
    ]
    found = along_path(path, errors)
    u = reading(path, "X") / own.link("X").range[1]
    np.testing.assert_allclose(found.size, np.abs(u) * np.hypot(np.hypot(50, 75), 100) * UM,
                               rtol=0, atol=NM)  # fmt: skip
    np.testing.assert_allclose(found.each["EYX"], 75 * UM * np.abs(u), rtol=0, atol=NM)
    assert found.dominant == ["EZX", "EYX", "EXX"]


def test_radial_motions_of_c_by_hand(own, path):
    # figure 3 without the others: EXC = a sin C and EYC = a cos C, so |d| = a everywhere
    radial = [e for e in axis_errors(own, "C") if e[0].symbol.name in ("EXC", "EYC")]
    found = along_path(path, radial)
    np.testing.assert_allclose(found.size, 10 * UM, rtol=0, atol=NM)
    np.testing.assert_allclose(
        found.each["EXC"], 10 * UM * np.abs(np.sin(reading(path, "C"))), rtol=0, atol=NM
    )


@pytest.mark.parametrize(
    ("axis", "dominant"), [("X", {"EZX", "EYX", "EXX"}), ("C", {"EXC", "EYC"})]
)
def test_figures_2_and_3_by_the_second_model(own, path, axis, dominant):
    found = axis_effect(path, axis)
    second = second_model(MACHINE.read_text(encoding="utf-8"))
    q = {name: reading(path, name) for name in own.axes}
    u = 2.0 * (q["X"] - own.link("X").range[0]) / np.ptp(own.link("X").range) - 1.0
    if axis == "X":
        errors = {"EXX": 50 * UM * u, "EYX": 75 * UM * u, "EZX": 100 * UM * u}
        errors |= {"EAX": 50 * URAD * u, "EBX": 75 * URAD * u, "ECX": 100 * URAD * u}
    else:
        errors = {"EXC": 10 * UM * np.sin(q["C"]), "EYC": 10 * UM * np.cos(q["C"])}
        errors |= {"EZC": 5 * UM * np.sin(q["C"])}
        errors |= {n: 10 * URAD * np.sin(q["C"]) for n in ("EAC", "EBC", "ECC")}
    exact = second_tip(second, q, LENGTH, errors) - second_tip(second, q, LENGTH, {})
    np.testing.assert_allclose(found.deviation, exact, rtol=0, atol=SECOND_ORDER)
    assert set(found.dominant[: len(dominant)]) == dominant
    drawn, caption = axis_effect_picture(found)
    assert len(drawn.axes) == 4
    assert f"{np.linalg.norm(exact, axis=1).max() / UM:.1f} µm" in caption


def test_constants_have_their_place_on_a_path(own, path):
    found = along_path(path, [(LocationError(own.symbol("EC0Y")), np.array([10 * URAD]))])
    y = np.mean(own.link("Y").range)
    np.testing.assert_allclose(found.size, np.abs(10 * URAD * y), rtol=0, atol=NM)


def test_random_machines_along_a_path(own, path):
    population = Population(own, distributions=Distributions(("linear",)))
    found = volumetric(population, path.q, LENGTH, 2000, np.random.default_rng(3), tolerance=0.3)
    drawn, caption = statistics_picture(path, found, found.p95)
    assert sampling_words(found) in caption
    assert "2000 random machines, seed 3" in caption
    assert any("beyond 300 µm" in t.get_text() for t in drawn.axes[1].get_legend().get_texts())


@pytest.mark.parametrize(
    ("wish", "kind", "words"),
    [
        ({"held": {"Q": 0.0}}, UnknownAxis, "Q"),
        ({"held": {"X": 0.0}}, DesignError, "X held: expected an axis that does not move"),
        ({"held": {"Y": 900.0}}, OutsideTravel, "Y held at 900"),
        ({"count": 1}, DesignError, "two at least"),
    ],
)
def test_contradictory_wishes_are_refused(own, wish, kind, words):
    with pytest.raises(kind, match=words):
        paper_trajectory(Workspace(own, {}, LENGTH), **wish)


def test_a_path_on_which_nothing_moves_is_refused(own):
    limits = {a: (own.link(a).range[0],) * 2 for a in own.programmed_axes}
    with pytest.raises(DesignError, match="no axis has room to move"):
        paper_trajectory(Workspace(own, limits, LENGTH))


def test_axes_without_motions_are_refused(path):
    with pytest.raises(UnknownAxis, match="C1"):
        axis_effect(path, "C1")
