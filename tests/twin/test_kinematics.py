"""Poses and columns of many machines, by differences of the exact product and by properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matstd.twin.errors import NotReachable, ShapeMismatch
from matstd.twin.frames import (
    apply,
    fixed_xyz,
    fixed_xyz_angles,
    inverse,
    pose,
    rotation,
    skew,
    turned_about,
)
from matstd.twin.machine import (
    Axis,
    Chain,
    Contribution,
    Family,
    error_class,
    exact_tip,
    inverse_linear,
    make_chain,
    reach,
    tip,
)
from matstd.twin.units import DEG, NM

RELATIVE = 1e-6
"""Central differences of step 1e-4 rad leave h^2/6 = 2e-9 of the third derivative, and 1e-9 of
rounding; the bound is what the house promises."""

STEP = {False: 0.1, True: 1e-4}  # mm, rad: translations are linear, so any step will do

TRAVEL = {name: Axis(range=(-400.0, 400.0)) for name in "XYZ"}
TURN = Axis(range=(-180.0 * DEG, 180.0 * DEG))


def turning(*point: float, direction: tuple[float, float, float] | None = None) -> Axis:
    return Axis(range=TURN.range, point=point, direction=direction)


MACHINES = {
    "table-table": make_chain(
        "table-table",
        "[w C' B' X' f Y Z (C1) t]",
        TRAVEL | {"B": turning(0.0, 0.0, -420.0), "C": turning(0.0, 0.0, 0.0)},
        (0.0, 0.0, -500.0),
    ),
    "A/C head": make_chain(
        "A/C head",
        "[w f X Y Z C A t]",
        TRAVEL | {"C": turning(12.0, -3.0, 0.0), "A": turning(12.0, -3.0, -80.0)},
        (100.0, 20.0, -700.0),
    ),
    "table-head fork": make_chain(
        "table-head fork",
        "[w C' X' f Y Z B (C1) t]",
        TRAVEL | {"C": turning(30.0, 40.0, -600.0), "B": turning(0.0, 5.0, 150.0)},
        (30.0, 40.0, -600.0),
    ),
    "three axes": make_chain("three axes", "[w Y' X' f Z t]", TRAVEL, (0.0, 0.0, -300.0)),
    "nutating table": make_chain(
        "nutating table",
        "[w C' B' f X Y Z t]",
        TRAVEL
        | {
            "B": turning(5.0, -7.0, -430.0, direction=(0.0, 1.0, 1.0)),
            "C": turning(-4.0, 9.0, -300.0),
        },
        (0.0, 0.0, -450.0),
    ),
    "tilted the other way": make_chain(
        "tilted the other way",
        "[w C' B' f X Y Z t]",
        TRAVEL
        | {
            "B": turning(5.0, -7.0, -430.0, direction=(0.1, -1.0, 0.8)),
            "C": turning(-4.0, 9.0, -300.0),
        },
        (0.0, 0.0, -450.0),
    ),
    "against its letter": make_chain(
        "against its letter",
        "[w X' f Y Z B t]",
        TRAVEL
        | {
            "X": Axis(range=(-300.0, 300.0), direction=(-1.0, 0.0, 0.0)),
            "B": turning(5.0, -7.0, 130.0, direction=(0.0, -1.0, 0.0)),
        },
        (0.0, 0.0, -450.0),
    ),
    "slanted linear axis": make_chain(
        "slanted linear axis",
        "[w A' Y' f X Z t]",
        {
            "X": TRAVEL["X"],
            "Y": Axis(range=(-300.0, 300.0), direction=(0.0, 0.8, -0.6), point=(3.0, 4.0, 5.0)),
            "Z": TRAVEL["Z"],
            "A": turning(0.0, 30.0, -350.0),
        },
    ),
    "seven axes": make_chain(
        "seven axes",
        "[w C' A' Y' f X Z W B t]",
        TRAVEL
        | {
            "W": Axis(range=(-100.0, 100.0)),
            "A": turning(0.0, 0.0, -400.0),
            "B": turning(0.0, 0.0, 120.0),
            "C": turning(1.0, 2.0, -350.0),
        },
        (0.0, 0.0, -420.0),
    ),
}
CASES = pytest.mark.parametrize("chain", MACHINES.values(), ids=list(MACHINES))


def random_readings(chain: Chain, n: int, seed: int = 5) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.stack([rng.uniform(*chain.link(name).range, size=n) for name in chain.axes], axis=-1)


def contribution_of(chain: Chain, n: int, name: str, size: float) -> Contribution:
    """One constant error, put by hand into the tuple that the exact product takes."""
    symbol = chain.symbol(name)
    added = Contribution.zeros(n, len(chain.links))
    part = added.twist if symbol.family is Family.COMPONENT else added.place
    part[:, chain.link_index(symbol.link), symbol.component] = size
    return added


@CASES
@pytest.mark.parametrize("where", ["on the tool axis", "beside it"])
def test_columns_of_every_parameter_against_central_differences(chain, where):
    q = random_readings(chain, 20)
    length = np.linspace(90.0, 210.0, 20)
    if where == "beside it":
        length = np.column_stack([length - 150.0, 20.0 - 0.3 * length, -length])
    reached = reach(chain, q, length)
    for symbol in chain.symbols:
        h = STEP[symbol.is_angular]
        plus, minus = (
            exact_tip(chain, q, length, contribution_of(chain, 20, symbol.name, sign * h))
            for sign in (1.0, -1.0)
        )
        part = reached.twist if symbol.family is Family.COMPONENT else reached.place
        column = part[:, chain.link_index(symbol.link), symbol.component]
        scale = max(float(np.abs(column).max()), 1.0)
        worst = float(np.abs((plus - minus) / (2.0 * h) - column).max()) / scale
        assert worst < RELATIVE, f"{symbol.name}: {worst:.2e}"


@CASES
def test_remainder_of_first_order_is_second_order(chain):
    rng = np.random.default_rng(8)
    n = 50
    q = random_readings(chain, n)
    length = 160.0
    reached = reach(chain, q, length)
    size = np.array([0.5, 0.5, 0.5, 1e-3, 1e-3, 1e-3])  # large, so that there is a remainder
    full = Contribution.zeros(n, len(chain.links))
    for symbol in chain.symbols:  # only what the machine has: rotations about a tool say nothing
        part = full.twist if symbol.family is Family.COMPONENT else full.place
        i = chain.link_index(symbol.link)
        part[:, i, symbol.component] = rng.uniform(-1.0, 1.0) * size[symbol.component]

    def remainder(scale: float) -> np.ndarray:
        added = full._replace(twist=scale * full.twist, place=scale * full.place)
        first = np.einsum("nlc,nlci->ni", added.twist, reached.twist)
        first += np.einsum("nlc,nlci->ni", added.place, reached.place)
        return exact_tip(chain, q, length, added) - tip(chain, q, length) - first

    once, half = remainder(1.0), remainder(0.5)
    norm = np.linalg.norm(once)
    assert norm > 1000 * NM  # there is something to look at
    # halved errors leave a quarter; what is left over is third order, 1e-3 of it
    assert np.linalg.norm(4.0 * half - once) < 1e-2 * norm


@CASES
def test_inverse_brings_the_tip_to_the_point(chain):
    q = random_readings(chain, 40, seed=9)
    if len(chain.linear_axes) != 3:
        with pytest.raises(NotReachable, match="linear axes"):
            inverse_linear(chain, np.zeros((40, 3)), q, 160.0)
        return
    target = tip(chain, q, 160.0)
    start = q.copy()
    start[:, [chain.axis_index(name) for name in chain.linear_axes]] = 777.0
    back = inverse_linear(chain, target, start, 160.0)
    np.testing.assert_allclose(back, q, rtol=0, atol=NM)


def test_three_linear_axes_in_one_plane_reach_nothing():
    flat = make_chain(
        "flat", "[w f X Y U t]", {n: Axis(range=(-1.0, 1.0)) for n in ("X", "Y", "U")}
    )
    with pytest.raises(NotReachable, match="one plane"):
        inverse_linear(flat, np.zeros((1, 3)), np.zeros((1, 3)), 0.0)


def test_readings_of_a_wrong_shape_are_refused():
    with pytest.raises(ShapeMismatch, match="C, B, X, Y, Z, C1"):
        tip(MACHINES["table-table"], np.zeros((3, 5)), 160.0)


@pytest.mark.parametrize(
    ("machine", "axis", "symbols"),
    [
        ("slanted linear axis", "Y", ("EY0Y", "EYY")),
        ("nutating table", "B", ("EB0B", "EBB")),
        ("tilted the other way", "B", ("EB0B", "EBB")),
        ("against its letter", "X", ("EX0X", "EXX")),
        ("against its letter", "B", ("EB0B", "EBB")),
    ],
)
@pytest.mark.parametrize("which", ["zero position", "positioning"])
def test_an_error_of_its_own_letter_adds_to_the_reading(machine, axis, symbols, which):
    chain, symbol = MACHINES[machine], symbols[which == "positioning"]
    q = random_readings(chain, 10)
    size = 1e-4
    read_wrong = q.copy()
    read_wrong[:, chain.axis_index(axis)] += size
    added = contribution_of(chain, 10, symbol, size)
    np.testing.assert_allclose(
        exact_tip(chain, q, 160.0, added), tip(chain, read_wrong, 160.0), rtol=0, atol=NM
    )


def test_the_letter_names_the_location_errors_of_a_steeply_inclined_axis():
    steep = Axis(range=TURN.range, point=(0.0, 0.0, -400.0), direction=(0.0, 0.6, 0.8))
    chain = make_chain("steep", "[w B' f X Y Z t]", TRAVEL | {"B": steep})
    named = [s.name for s in chain.symbols if s.link == "B" and s.family is Family.LOCATION]
    assert named == ["EX0B", "EZ0B", "EA0B", "EB0B", "EC0B"]


ANGLE = st.floats(-3.0, 3.0)
VECTOR = st.tuples(ANGLE, ANGLE, ANGLE).map(np.array)
POINT = st.tuples(*[st.floats(-500.0, 500.0)] * 3).map(np.array)
EXACT = 1e-12


@given(VECTOR)
def test_rotations_are_orthogonal_and_keep_their_axis(vector):
    R = rotation(vector)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=EXACT)
    assert np.linalg.det(R) == pytest.approx(1.0, abs=EXACT)
    np.testing.assert_allclose(R @ vector, vector, atol=EXACT * 10)
    assert np.trace(R) == pytest.approx(1.0 + 2.0 * np.cos(np.linalg.norm(vector)), abs=EXACT)


@given(st.floats(-1e-7, 1e-7), VECTOR)
def test_rotations_are_accurate_through_angle_zero(angle, v):
    vector = angle * np.array([0.6, 0.0, 0.8])
    np.testing.assert_allclose(rotation(vector) @ v - v, np.cross(vector, v), atol=1e-13)


@given(VECTOR, POINT, POINT)
def test_poses_compose_and_invert(vector, shift, point):
    T_a_b = pose(rotation(vector), shift)
    np.testing.assert_allclose(apply(inverse(T_a_b), apply(T_a_b, point)), point, atol=NM)
    np.testing.assert_allclose(T_a_b @ inverse(T_a_b), np.eye(4), atol=1e-9)
    np.testing.assert_allclose(
        apply(T_a_b @ T_a_b, point), apply(T_a_b, apply(T_a_b, point)), atol=NM
    )


@given(VECTOR, POINT)
def test_a_turn_about_a_point_leaves_it_where_it_is(vector, point):
    np.testing.assert_allclose(apply(turned_about(point, rotation(vector)), point), point, atol=NM)


@given(VECTOR, VECTOR)
def test_skew_is_the_cross_product(a, b):
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), atol=EXACT)


@given(st.tuples(ANGLE, st.floats(-1.5, 1.5), ANGLE).map(np.array))
def test_angles_about_fixed_axes_come_back(angles):
    R = fixed_xyz(angles)
    np.testing.assert_allclose(fixed_xyz(fixed_xyz_angles(R)), R, atol=1e-9)
    # about x first: a turn about x alone leaves x, and the later turns see the fixed axes
    np.testing.assert_allclose(
        R,
        rotation(np.array([0, 0, angles[2]])) @ fixed_xyz(np.array([angles[0], angles[1], 0.0])),
        atol=EXACT,
    )


def test_a_quill_in_brackets_stays_where_it_is():
    """Z and W are parallel: of both as programmed axes no tip says which has moved."""
    axes = {name: Axis((-500.0, 500.0)) for name in "XYZW"}
    both = make_chain("both", "[w X' f Y Z W t]", axes)
    with pytest.raises(NotReachable, match=r'4 linear axes, X, Y, Z, W; .* such as "\(W\)"'):
        inverse_linear(both, np.zeros((1, 3)), np.zeros((1, 4)), 100.0)
    chain = make_chain("quill", "[w X' f Y Z (W) t]", axes)
    assert chain.linear_axes == ("X", "Y", "Z")
    q = inverse_linear(chain, np.array([[10.0, 20.0, -30.0]]), np.zeros((1, 4)), 100.0)
    np.testing.assert_allclose(q, [[10.0, 20.0, 70.0, 0.0]], rtol=0, atol=NM)


@pytest.mark.parametrize(
    ("notation", "joints", "turns"),
    [
        ("[w f C A B A1 t]", ("C", "A", "B", "A1"), False),
        ("[w f X A B C t]", (), False),  # a head, however many axes it has
        ("[w C1' f C A B A1 t]", ("C", "A", "B", "A1"), True),
        ("[w C' B' f X t]", (), True),
    ],
)
def test_joints_are_the_rotary_axes_of_an_open_chain(notation, joints, turns):
    names = [name.strip("'") for name in notation.strip("[]").split() if name not in "wft"]
    chain = make_chain("a", notation, {name: Axis((-1.0, 1.0)) for name in names})
    assert chain.joints == joints
    assert [link.name for link in chain.links if link.is_joint] == [*joints]
    assert chain.turns_workpiece is turns
    for symbol in chain.symbols:
        if symbol.link not in "wt":
            assert error_class(chain, symbol).startswith("arm_") == (symbol.link in joints)


@pytest.mark.parametrize(
    ("notation", "arrangement"),
    [
        ("[w C' B' X' f Y Z (C1) t]", "C-B-X-F-Y-Z"),
        ("[w B' C' X' f Y Z t]", "B-C-X-F-Y-Z"),  # the tilting axis on the table
        ("[w C' B' X' f Z Y t]", "C-B-X-F-Y-Z"),  # slides of one side commute
        ("[w C' X' B' f Y Z t]", "C-X-B-F-Y-Z"),
        ("[w C' f X B Z Y A t]", "C-F-X-B-Y-Z-A"),
        ("[w Y' X' f (C1) Z t]", "X-Y-F-Z"),
        ("[w f (C1) t]", "F"),
    ],
)
def test_the_arrangement_is_the_order_that_moves_the_tool(notation, arrangement):
    names = [name.strip("'") for name in notation.strip("[]").split() if name not in "wft"]
    axes = {name: Axis((-1.0, 1.0)) for name in names if "(" not in name}
    assert make_chain("a", notation, axes).arrangement == arrangement
