"""S of every parameter against lever arms worked out by hand and against the exact product."""

import numpy as np
import pytest

from matstd.sensitivity.first_order import (
    jacobian,
    jacobian_by_parameter,
    latin_hypercube,
    sensitivity,
)
from matstd.twin.machine import Axis, Family, make_chain, reach
from matstd.twin.units import DEG, NM

LENGTH = 160.0
MACHINES = {
    "[w C' B' X' f Y Z (C1) t]": {"B": (0.0, 0.0, -420.0), "C": (3.0, -2.0, 1.0)},
    "[w Y' f X Z C A t]": {"C": (12.0, -3.0, 0.0), "A": (12.0, -3.0, -80.0)},
    "[w C' X' f Y Z B t]": {"C": (30.0, 40.0, -600.0), "B": (0.0, 5.0, 150.0)},
    "[w f X Y Z t]": {},
}


def readings(chain, **given):
    q = np.zeros((1, len(chain.axes)))
    for name, value in given.items():
        q[0, chain.axis_index(name)] = value * (1.0 if chain.link(name).kind == "linear" else DEG)
    return q


def test_a_translation_counts_once_everywhere(chain, workspace):
    q = latin_hypercube(workspace, 200, np.random.default_rng(1))
    S = sensitivity(chain, q, LENGTH)
    for p, symbol in enumerate(chain.symbols):
        if not symbol.is_angular and symbol.family is Family.COMPONENT:
            np.testing.assert_allclose(S[:, p], 1.0, rtol=0, atol=1e-12, err_msg=symbol.name)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # the arm of X' is (100, 50, -360): an angle counts with the distance from its own axis
        ("EAX", np.hypot(50.0, 360.0)),
        ("EBX", np.hypot(100.0, 360.0)),
        ("ECX", np.hypot(100.0, 50.0)),
        ("EBB", np.hypot(100.0, 60.0)),  # B's line is 420 mm below the spindle's gauge line
        ("EAY", 360.0),
        ("ECY", 0.0),
        ("EC0Y", 50.0),  # squareness: the travel alone
        ("EC0X", 100.0),
        ("EA0Z", 200.0),
        ("EX0C", 0.0),  # at C = 0 nothing has turned
        ("EB0t", 160.0),
        ("EC0w", np.hypot(100.0, 50.0)),
    ],
)
def test_angles_count_with_their_lever_arm(chain, name, expected):
    q = readings(chain, X=100, Y=50, Z=-200)
    S = sensitivity(chain, q, LENGTH, [chain.symbol(name)])
    assert S[0, 0] == pytest.approx(expected, abs=NM)


def test_displaced_line_of_a_rotary_axis_counts_twice_at_half_a_turn(chain):
    S = sensitivity(chain, readings(chain, C=180), LENGTH, [chain.symbol("EX0C")])
    assert S[0, 0] == pytest.approx(2.0, abs=1e-12)


def test_blocks_and_selections_change_nothing(chain, workspace, monkeypatch):
    q = latin_hypercube(workspace, 50, np.random.default_rng(2))
    length = np.linspace(100.0, 200.0, 50)
    whole = jacobian(chain, q, length)
    monkeypatch.setattr("matstd.sensitivity.first_order.jacobians._POSES_A_BLOCK", 7)
    np.testing.assert_array_equal(jacobian(chain, q, length), whole)
    some = [chain.symbols[i] for i in (70, 3, 40)]
    np.testing.assert_array_equal(jacobian(chain, q, length, some), whole[:, [70, 3, 40]])


@pytest.mark.parametrize("notation", MACHINES)
@pytest.mark.parametrize("slanting", [False, True])
def test_the_fast_walk_says_what_the_matrices_say(notation, slanting):
    # `reach` multiplies 4x4 matrices from the foundation outwards and shares nothing with the walk
    points = MACHINES[notation]
    axes = {n: Axis((-400.0, 400.0), (1.0, 2.0, 3.0)) for n in "XYZ"}
    slant = (0.2, 1.0, -1.0) if slanting else None
    axes |= {n: Axis((-3.0, 3.0), point, slant) for n, point in points.items()}
    if slanting:
        axes["Y"] = Axis((-400.0, 400.0), direction=(0.1, -1.0, 0.2))
    chain = make_chain("m", notation, axes, (10.0, 20.0, -500.0))
    rng = np.random.default_rng(8)
    low, high = np.array([chain.link(a).range for a in chain.axes]).T
    q, length = rng.uniform(low, high, (40, len(low))), rng.uniform(50.0, 300.0, 40)
    reached = reach(chain, q, length)
    found = jacobian_by_parameter(chain, q, length)
    assert found.shape == (len(chain.symbols), 3, 40)
    np.testing.assert_array_equal(jacobian(chain, q, length), found.transpose(2, 0, 1))
    for p, symbol in enumerate(chain.symbols):
        part = reached.twist if symbol.family is Family.COMPONENT else reached.place
        expected = part[:, chain.link_index(symbol.link), symbol.component]
        np.testing.assert_allclose(found[p].T, expected, rtol=0, atol=NM, err_msg=symbol.name)
