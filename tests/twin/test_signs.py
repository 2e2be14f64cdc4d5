"""One error on, one deviation worked out by hand: every parameter, both sides of the machine.

HSM 600U, tool length 160 mm, X 100, Y 50, Z -200. In the machine frame the tip stands at
(0, 50, -360), so the lever arms from the reference points carried along by their bodies are

    X' (-100, 0, 0)    -> (100, 50, -360)      Y  (0, 50, 0)     -> (0, 0, -360)
    B' (-100, 0, -420) -> (100, 50, 60)        Z  (0, 50, -200)  -> (0, 0, -160)
    C1 and t           -> (0, 0, -160)

At B = -90 the B' body stands turned by +90 about y, so machine directions read (-z, y, x) on it;
the tip stands at (-60, 50, -320) on it, which is also the arm of C'. At C = 90 the C' body stands
turned by -90 about z and B' directions read (-y, x, z) on it: machine directions read (-y, -z, x)
in the table frame, and the tool point is (-50, -60, 180).

A twist (e, r) moves the tip by e + r x arm. Rotary location errors are (1 - R) of the displacement
or tilt, R the body's rotation, with the minus of the workpiece side on C' and B'.
"""

import numpy as np
import pytest
from machines import HSM600U

from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.machine import Axis, Chain, Family, make_chain, tip
from matstd.twin.model import Model
from matstd.twin.record import at_poses
from matstd.twin.units import DEG, NM, UM, URAD

LENGTH = 160.0
SIZE_UM, SIZE_URAD = 1.0, 10.0


def readings(chain: Chain, **given: float) -> np.ndarray:
    """Readings of one pose, mm and degrees by axis name."""
    q = np.zeros((1, len(chain.axes)))
    for name, value in given.items():
        factor = 1.0 if chain.link(name).kind == "linear" else DEG
        q[0, chain.axis_index(name)] = value * factor
    return q


def deviation_um(chain: Chain, q: np.ndarray, name: str, size: float) -> tuple[np.ndarray, ...]:
    """Deviation by one constant error, exact and first order, µm."""
    symbol = chain.symbol(name)
    if symbol.family is Family.COMPONENT:
        model = Model(chain, (ComponentError(symbol, "constant"),))
    else:
        model = Model(chain, (LocationError(symbol),))
    theta = np.array([size * (URAD if symbol.is_angular else UM)])
    touches = at_poses(chain, q, LENGTH)
    exact = model.tip_deviation(touches, theta)[0]
    return exact / UM, model.tip_columns(touches)[0] @ theta / UM


def assert_deviation(chain: Chain, q: np.ndarray, name: str, expected: object) -> None:
    angular = chain.symbol(name).is_angular
    exact, first = deviation_um(chain, q, name, SIZE_URAD if angular else SIZE_UM)
    np.testing.assert_allclose(exact, expected, rtol=0, atol=NM / UM, err_msg=f"{name}, exact")
    np.testing.assert_allclose(first, expected, rtol=0, atol=NM / UM, err_msg=f"{name}, columns")


EXAMPLES = [  # FORMATS, worked examples: B, C, error, nominal point, deviation
    (0, 0, "EXX", (100, 50, 140), (1, 0, 0)),
    (0, 0, "EBX", (100, 50, 140), (-3.6, 0, -1.0)),
    (0, 0, "EC0Y", (100, 50, 140), (-0.5, 0, 0)),
    (0, 0, "EC0X", (100, 50, 140), (0, 1, 0)),
    (0, 90, "EXC", (-50, 100, 140), (0, 1, 0)),
    (0, 90, "EAC", (-50, 100, 140), (-3.6, 0, 0.5)),
    (0, 90, "EX0C", (-50, 100, 140), (1, -1, 0)),
    (-90, 0, "EBB", (-60, 50, 180), (1.0, 0, 0.6)),
    (-90, 0, "EX0B", (-60, 50, 180), (1, 0, -1)),
    (-90, 0, "EAC", (-60, 50, 180), (0, 3.2, 0.5)),
]


@pytest.mark.parametrize(("B", "C", "name", "point", "expected"), EXAMPLES)
def test_worked_examples_of_the_formats(B, C, name, point, expected):
    q = readings(HSM600U, X=100, Y=50, Z=-200, B=B, C=C)
    np.testing.assert_allclose(tip(HSM600U, q, LENGTH)[0], point, rtol=0, atol=NM)
    assert_deviation(HSM600U, q, name, expected)


# Table-frame deviation in µm at B = -90, C = 90 for 1 µm or 10 µrad of every parameter.
BY_HAND = {
    # component errors on the workpiece side: C', B', X'
    "EXC": (0, 1, 0),
    "EYC": (-1, 0, 0),
    "EZC": (0, 0, 1),
    "EAC": (-3.2, 0, 0.5),
    "EBC": (0, -3.2, 0.6),
    "ECC": (0.6, -0.5, 0),
    "EXB": (0, 0, 1),
    "EYB": (-1, 0, 0),
    "EZB": (0, -1, 0),
    "EAB": (0.6, -0.5, 0),
    "EBB": (0, 1.0, 0.6),
    "ECB": (-1.0, 0, -0.5),
    "EXX": (0, 0, 1),
    "EYX": (-1, 0, 0),
    "EZX": (0, -1, 0),
    "EAX": (-3.6, -0.5, 0),
    "EBX": (0, 1.0, -3.6),
    "ECX": (-1.0, 0, -0.5),
    # component errors on the tool side: Y, Z, C1
    "EXY": (0, 0, 1),
    "EYY": (-1, 0, 0),
    "EZY": (0, -1, 0),
    "EAY": (-3.6, 0, 0),
    "EBY": (0, 0, -3.6),
    "ECY": (0, 0, 0),
    "EXZ": (0, 0, 1),
    "EYZ": (-1, 0, 0),
    "EZZ": (0, -1, 0),
    "EAZ": (-1.6, 0, 0),
    "EBZ": (0, 0, -1.6),
    "ECZ": (0, 0, 0),
    "EXC1": (0, 0, 1),
    "EYC1": (-1, 0, 0),
    "EZC1": (0, -1, 0),
    "EAC1": (-1.6, 0, 0),
    "EBC1": (0, 0, -1.6),
    "ECC1": (0, 0, 0),
    # location errors of rotary axes; those of the spindle do nothing at its reading zero
    "EX0C": (1, -1, 0),
    "EY0C": (1, 1, 0),
    "EA0C": (3.2, 3.2, -1.1),
    "EB0C": (-3.2, 3.2, -0.1),
    "EC0C": (0.6, -0.5, 0),
    "EX0B": (0, 1, -1),
    "EZ0B": (0, 1, 1),
    "EA0B": (0.4, 0.5, 0.5),
    "EB0B": (0, 1.0, 0.6),
    "EC0B": (1.6, -0.5, 0.5),
    "EX0C1": (0, 0, 0),
    "EY0C1": (0, 0, 0),
    "EA0C1": (0, 0, 0),
    "EB0C1": (0, 0, 0),
    "EC0C1": (0, 0, 0),
    # zero positions and squarenesses of linear axes
    "EX0X": (0, 0, 1),
    "EB0X": (0, 1.0, 0),
    "EC0X": (-1.0, 0, 0),
    "EY0Y": (-1, 0, 0),
    "EA0Y": (0, -0.5, 0),
    "EC0Y": (0, 0, -0.5),
    "EZ0Z": (0, -1, 0),
    "EA0Z": (-2.0, 0, 0),
    "EB0Z": (0, 0, -2.0),
    # set-up of the workpiece, about the table's origin, and of the tool, about the gauge point
    "EX0w": (-1, 0, 0),
    "EY0w": (0, -1, 0),
    "EZ0w": (0, 0, -1),
    "EA0w": (0, 1.8, 0.6),
    "EB0w": (-1.8, 0, -0.5),
    "EC0w": (-0.6, 0.5, 0),
    "EX0t": (0, 0, 1),
    "EY0t": (-1, 0, 0),
    "EZ0t": (0, -1, 0),
    "EA0t": (-1.6, 0, 0),
    "EB0t": (0, 0, -1.6),
}


def test_the_paper_has_71_parameters_and_each_has_its_sign_case():
    assert [s.name for s in HSM600U.symbols] == list(dict.fromkeys(s.name for s in HSM600U.symbols))
    assert {s.name for s in HSM600U.symbols} == set(BY_HAND)
    assert len(BY_HAND) == 71


@pytest.mark.parametrize("name", BY_HAND)
def test_sign_of_every_parameter(name):
    q = readings(HSM600U, X=100, Y=50, Z=-200, B=-90, C=90)
    assert_deviation(HSM600U, q, name, BY_HAND[name])


# The spindle turned by 90: an unprimed rotary axis, (1 - R) with R about +z, arm (0, 0, -160).
SPINDLE = {
    "EX0C1": (1, -1, 0),
    "EY0C1": (1, 1, 0),
    "EA0C1": (1.6, 1.6, 0),
    "EB0C1": (-1.6, 1.6, 0),
    "EC0C1": (0, 0, 0),  # turns the tool about itself
    "EXC1": (1, 0, 0),  # component errors keep the directions of the body they sit on
    "EBC1": (-1.6, 0, 0),
}


@pytest.mark.parametrize("name", SPINDLE)
def test_location_errors_of_an_unprimed_rotary_axis(name):
    q = readings(HSM600U, X=100, Y=50, Z=-200, C1=90)
    assert_deviation(HSM600U, q, name, SPINDLE[name])


# A tilting head: X' carries the table, A sits under Z with its line 50 mm below the gauge point.
# At A = 90 the head turns by +90 about x (y to z, z to -y), so A's arm (0, 0, -110) becomes
# (0, 110, 0) and the tip stands at (0, 110, -50), with Y 50 and Z -200 at (0, 160, -250).
HEAD = make_chain(
    "head",
    "[w X' f Y Z A t]",
    {
        "X": Axis(range=(-400.0, 400.0)),
        "Y": Axis(range=(-300.0, 300.0)),
        "Z": Axis(range=(-500.0, 0.0)),
        "A": Axis(range=(-110.0 * DEG, 110.0 * DEG), point=(0.0, 0.0, -50.0)),
    },
)
HEAD_CASES = {
    "EXX": (1, 0, 0),
    "ECX": (-1.6, 1.0, 0),  # arm of X' is (100, 160, -250)
    "EXA": (1, 0, 0),
    "EZA": (0, 0, 1),
    "EAA": (0, 0, 1.1),  # arm (0, 110, 0)
    "ECA": (-1.1, 0, 0),
    "EA0A": (0, 0, 1.1),
    "EY0A": (0, 1, -1),  # (1 - R) y = y - z
    "EC0A": (-1.1, 0, 0),  # (1 - R) z = z + y, of which y x arm is zero
    "EA0Y": (0, 0, 0.5),
    "EB0Z": (-2.0, 0, 0),
    "EY0t": (0, 0, 1),  # tool y points up
    "EZ0t": (0, -1, 0),
    "EA0t": (0, 0, 1.6),
}


def test_nominal_point_of_a_tilting_head():
    q = readings(HEAD, X=100, Y=50, Z=-200, A=90)
    np.testing.assert_allclose(tip(HEAD, q, LENGTH)[0], (100, 160, -250), rtol=0, atol=NM)


@pytest.mark.parametrize("name", HEAD_CASES)
def test_signs_of_a_tilting_head(name):
    q = readings(HEAD, X=100, Y=50, Z=-200, A=90)
    assert_deviation(HEAD, q, name, HEAD_CASES[name])


# a table that swivels about (0, -1, 1) through (0, 0, -500), tip at (100, 0, -400), all at zero;
# µm for 1 µm and 10 µrad: b = (0, -1, 1), and across it a = (1, 0, 0), c = (0, 1, 1), over root 2
SWIVEL_BY_HAND = {
    "EXB": (1, 0, 0),
    "EYB": (0, -(0.5**0.5), 0.5**0.5),
    "EZB": (0, 0.5**0.5, 0.5**0.5),
    "EAB": (0, -1, 0),  # a x (100, 0, 100) = (0, -100, 0)
    "EBB": (-(0.5**0.5), 0.5**0.5, 0.5**0.5),  # b x (100, 0, 100) = (-100, 100, 100) / root 2
    "ECB": (0.5**0.5, 0.5**0.5, -(0.5**0.5)),  # c x (100, 0, 100) = (100, 100, -100) / root 2
}


@pytest.mark.parametrize("name", SWIVEL_BY_HAND)
def test_signs_of_an_inclined_swivel(name):
    swivel = Axis((-3.0, 3.0), (0.0, 0.0, -500.0), (0.0, -1.0, 1.0))
    travels = dict.fromkeys("XYZ", Axis((-500.0, 500.0)))
    chain = make_chain("swivel", "[w B' f X Y Z t]", travels | {"B": swivel})
    q = readings(chain, X=100, Z=-400 + LENGTH)
    assert_deviation(chain, q, name, SWIVEL_BY_HAND[name])
