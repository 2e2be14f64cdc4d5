"""Degrees that touches support: against a model written out, and on a machine worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import machine

from matstd.information.identifiability import supported_degrees
from matstd.information.identifiability.degrees import MAX_DEGREE, MAX_POSTERIOR_SHARE, Degree
from matstd.report.identifiability.identifiability_words import degree_words
from matstd.sensitivity.population import Population
from matstd.twin.machine import Axis, Family, make_chain
from matstd.twin.model import Model
from matstd.twin.record import at_poses
from matstd.twin.units import UM

HALF = 200.0  # mm, half a travel
NOISE = 1.0 * UM


@pytest.fixture(scope="module")
def model():
    chain = make_chain(
        "three axes", "[w X' f Y Z t]", {a: Axis((-HALF, HALF)) for a in "XYZ"}, (0.0, 0.0, -500.0)
    )
    return Population(chain).model


def along_x(model, q_x):
    """Every reading of X touched along X, Y and Z."""
    q = np.zeros((3 * len(q_x), 3))
    q[:, model.chain.axis_index("X")] = np.tile(q_x, 3)
    normal = np.repeat(np.eye(3), len(q_x), axis=0)
    return replace(at_poses(model.chain, q, 160.0), normal=normal)


def found(model, touches):
    W = model.columns(touches) * model.prior_sd / NOISE
    return {d.symbol: d for d in supported_degrees(model, touches, W, NOISE)}


def only(model, *symbols):
    """A model of some component errors alone."""
    kept = tuple(
        e
        for e in model.effects
        if (s := getattr(e, "symbol", None)) is not None
        and s.family is Family.COMPONENT
        and s.name in symbols
    )
    return Model(model.chain, kept)


def by_hand(q_x, degree, sd):
    """Uncertainty over expected size of `a_1 T_1 + ... + a_n T_n`, everything else being zero."""
    T = np.polynomial.chebyshev.chebvander(q_x / HALF, degree)[:, 1:]
    A = T * sd / np.arange(1, degree + 1) ** 1.5 / NOISE
    return np.sqrt(np.diag(np.linalg.inv(np.eye(degree) + A.T @ A)))


@pytest.mark.parametrize("reach", [1.0, 0.45, 0.1])
def test_one_error_alone_is_a_polynomial_fit(model, reach):
    """Nothing else can move: what is left is that of a ridge regression in Chebyshev terms."""
    alone, q_x = only(model, "EXX"), reach * np.linspace(-HALF, HALF, 40)
    sd = float(alone.prior_sd.max())
    degree = found(alone, along_x(alone, q_x))["EXX"]
    left = [by_hand(q_x, n, sd) for n in range(1, MAX_DEGREE + 1)]
    largest = 0
    while largest < MAX_DEGREE and (left[largest] < MAX_POSTERIOR_SHARE).all():
        largest += 1
    assert degree.largest == largest
    assert degree.supported == tuple(range(1, largest + 1))
    assert degree.u == pytest.approx(left[largest - 1][-1] * sd / largest**1.5, rel=1e-9)


def test_a_part_of_the_travel_supports_less(model):
    alone = only(model, "EXX")
    whole, part = (
        found(alone, along_x(alone, reach * np.linspace(-HALF, HALF, 40)))["EXX"].largest
        for reach in (1.0, 0.1)
    )
    assert whole == MAX_DEGREE
    assert 1 <= part < MAX_DEGREE


def test_what_no_touch_moves_has_no_degree(model):
    """Y and Z stand still; the ball hangs on the line about which Z rolls."""
    degrees = found(model, along_x(model, np.linspace(-HALF, HALF, 9)))
    for symbol in ("EXY", "EZZ", "ECZ"):
        assert degrees[symbol].supported == ()
        assert degrees[symbol].largest == 0
    assert degree_words(degrees["ECZ"], model.chain) == "roll of Z (ECZ): no degree"
    assert degrees["EXX"].largest > 0


@pytest.mark.parametrize(
    ("symbol", "supported", "u", "words"),
    [
        ("EYX", (2, 3, 4, 5), 0.4 * UM, ": degrees 2 to 5, the last to 0.4 µm"),
        ("EYX", (3,), 0.12 * UM, ": degree 3 to 0.12 µm"),
        ("EXC", (1, 2), 7.0 * UM, ": harmonics 1 to 2, the last to 7 µm"),
        ("EXC", (4,), 7.0 * UM, ": harmonic 4 to 7 µm"),
    ],
)
def test_degrees_of_a_linear_axis_are_harmonics_of_a_rotary_one(symbol, supported, u, words):
    chain = machine("hsm600u")
    said = degree_words(Degree(symbol, supported, supported[-1], u, "mm"), chain)
    assert said.endswith(f"({symbol}){words}")
