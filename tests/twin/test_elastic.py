"""Elastic bodies: against virtual work, books, and the signs of weights on a machine."""

import numpy as np
import pytest
from beam_by_work import flexibility

from matstd.twin.elastic import material
from matstd.twin.elastic.beam import SUPPORTS, bending, section
from matstd.twin.elastic.body import GRAVITY
from matstd.twin.errors import UnknownEffect
from matstd.twin.library import parse_effect, parse_sized_effect
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import Model
from matstd.twin.record import at_poses
from matstd.twin.units import UM

EI, GA = 2.1e5 * 8.0e6, 8.0e4 * 5.0e3


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("share", [0.1, 0.25, 0.5, 0.8])
def test_beams_are_those_of_virtual_work(support, share):
    """Length over depth about 4, where shear is a third of the bending."""
    span = 400.0
    x = np.array([share * span])
    found = bending(support, x, np.array([span]), EI, GA)
    want = flexibility(support, x[0], span, EI, GA)
    got = [
        [found.by_force[0], found.coupled[0], found.own[0]],
        [found.coupled[0], found.by_moment[0], found.own_rotation[0]],
    ]
    scale = np.abs(want).max(axis=1, keepdims=True)
    # the trapezoids' error at a jump of the moment is a step of 1/4000
    np.testing.assert_allclose(got, want, atol=2e-3 * scale.max(), rtol=2e-3)


def test_a_cantilever_is_that_of_calculix():
    """Steel 100 x 100 mm, 1 kN at the end: L/h 10, 3, 2; CalculiX 2.20, ten B32R elements, um."""
    steel = material("steel")
    shape = section("100x100", steel.poisson)
    for length, calculix in ((1000.0, 189.47), (300.0, 5.540), (200.0, 1.863)):
        at = np.array([length])
        plane = bending(
            "cantilever", at, at, steel.young * shape.bending[0], steel.shear * shape.shear_area[0]
        )
        assert plane.by_force[0] * 1000.0 / UM == pytest.approx(calculix, rel=0.03)


def test_sections_are_those_of_books():
    """Roark: 0.1406 a^4 of a square; a thin square tube t a^3; a tube pi/32 (D^4 - d^4)."""
    assert section("50x50", 0.3).torsion == pytest.approx(0.1406 * 50.0**4, rel=2e-3)
    assert section("102x102x2", 0.3).torsion == pytest.approx(2.0 * 100.0**3, rel=1e-9)
    assert section("d50x5", 0.3).torsion == pytest.approx(np.pi / 32 * (50.0**4 - 40.0**4))
    assert section("200x300", 0.3).bending == pytest.approx((300 * 200**3 / 12, 200 * 300**3 / 12))


@pytest.fixture(scope="module")
def chain():
    """Table in Y, column in X, a ram along Z that comes down."""
    axes = {a: Axis(range=(-300.0, 300.0)) for a in "XY"} | {"Z": Axis(range=(-400.0, 0.0))}
    return make_chain("gantry", "[w Y' f X Z t]", axes)


def moved(chain, text, theta, q, force=None, length=0.0):
    effect = parse_effect(text, chain)
    touches = at_poses(chain, np.array([q]), length)
    if force is not None:
        object.__setattr__(touches, "force", np.array([force], dtype=float))
    return Model(chain, (effect,)).tip_deviation(touches, np.array(theta))[0]


def test_a_crossbeam_sags_and_the_tool_with_it(chain):
    """Steel 300 x 300 x 20 box of 1200 mm, clamped, 400 kg at its middle: -W S^3/(192 EI) ..."""
    text = "beam(X,clamped,300x300x20,at:600,span:1200,mass:400)"
    shape, steel = section("300x300x20", 0.3), material("steel")
    bend, shear = steel.young * shape.bending[1], steel.shear * shape.shear_area[1]
    weight = 400.0 * GRAVITY
    own = steel.density * shape.area * GRAVITY
    want = weight * (1200.0**3 / (192 * bend) + 1200.0 / (4 * shear))
    want += own * (1200.0**4 / (384 * bend) + 1200.0**2 / (8 * shear))
    found = moved(chain, text, (1.0, 0.0), (0.0, 0.0, 0.0))
    np.testing.assert_allclose(found, (0.0, 0.0, -want), atol=1e-9)


def test_a_table_that_sags_lets_the_workpiece_fall_away_from_the_tool(chain):
    text = "beam(Y,supported,200x120,at:500,span:1000,mass:300)"
    assert moved(chain, text, (1.0, 0.0), (0.0, 0.0, 0.0))[2] > 1.0 * UM


def test_a_ram_out_of_its_guide_turns_with_its_offset_load(chain):
    """Overhang 500 mm down, 60 kg 200 mm in front (+Y): a moment about -X tilts the tip to -Y...

    The weight at +Y turns the ram about -X; below the guide its end then swings back, to -Y.
    """
    text = "beam(Z,cantilever,180x180,at:100,sense:-1,mass:60,offset:0:200:0)"
    shape, steel = section("180x180", 0.3), material("steel")
    moment, EI_ = 60.0 * GRAVITY * 200.0, steel.young * shape.bending[0]
    found = moved(chain, text, (1.0, 0.0), (0.0, 0.0, -400.0))
    assert found[1] == pytest.approx(-moment * 500.0**2 / (2.0 * EI_), rel=1e-4)
    lower = moved(chain, text, (1.0, 0.0), (0.0, 0.0, -400.0), length=100.0)
    tilt = moment * 500.0 / EI_
    assert lower[1] - found[1] == pytest.approx(-tilt * 100.0, rel=1e-3)


def test_the_tool_moves_with_its_load_on_either_side_of_the_machine(chain):
    ram = "beam(Z,cantilever,180x180,at:100,sense:-1)"
    table = "beam(Y,supported,200x120,at:500,span:1000)"
    for text, push in ((ram, (100.0, 0.0, 0.0)), (table, (0.0, 0.0, -100.0))):
        found = moved(chain, text, (0.0, 1.0), (0.0, 0.0, -300.0), push)
        assert np.dot(found, push) > 0.0
        assert np.linalg.norm(found) > 0.01 * UM


def test_torsion_of_a_crossbeam_by_a_load_in_front_of_it(chain):
    """GJ of a square box 200 x 200 x 10 clamped over 1000 mm, at its middle: T S/(4 G J)."""
    text = "beam(X,clamped,210x210x10,at:500,span:1000,mass:100,offset:0:-300:0)"
    shape, steel = section("210x210x10", 0.3), material("steel")
    turned = 100.0 * GRAVITY * 300.0 * 1000.0 / (4.0 * steel.shear * shape.torsion)
    found = moved(chain, text, (1.0, 0.0), (0.0, 0.0, 0.0), length=200.0)
    above = moved(chain, text, (1.0, 0.0), (0.0, 0.0, 0.0))
    # the load at -Y turns the beam about +X, so that a tool 200 mm below swings to +Y
    assert found[1] - above[1] == pytest.approx(turned * 200.0, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("beam(X,clamped,300x300,at:600)", "span:MM"),
        ("beam(X,clamped,300x,at:600,span:1200)", "a section"),
        ("beam(X,glued,300x300,at:600)", "a support"),
        ("beam(X,cantilever,300x300)", "where the frame stands"),
        ("beam(X,cantilever,300x300,at:100)", "stays on the beam"),
        ("beam(X,cantilever,300x300,at:600,material:wood)", "a material"),
        ("beam(X,cantilever,300x300,at:600,weight:3)", "each of at"),
        ("beam(X,cantilever,300x300,at:600,mass:heavy)", "a number in mass"),
        ("beam(X,cantilever,300x300x160,at:600)", "a section"),
        ("tool-point-stiffness(X,X)", "each once"),
    ],
)
def test_what_is_no_beam_is_refused(chain, text, words):
    with pytest.raises(UnknownEffect, match=words):
        parse_effect(text, chain)


def test_a_beam_with_its_size_as_a_user_writes_it(chain):
    sized = parse_sized_effect("beam(X,cantilever,300x300,at:600,mass:20)=weight=1,load=1.5", chain)
    np.testing.assert_array_equal(sized.theta, (1.0, 1.5))
    assert sized.effect.slenderness(-300.0, 300.0) == 3.0


def test_a_loaded_ball_bar_finds_the_stiffness_over_the_workspace(chain):
    """Three planes at two places: what the tool yields along the bar, by hand, gives C(p)."""
    rng = np.random.default_rng(7)
    effect = parse_effect("tool-point-stiffness(X,Z)", chain)
    theta = np.array([p.sd for p in effect.parameters]) * rng.uniform(0.5, 1.5, 18)
    C = {
        k: np.array([[v[0], v[3], v[5]], [v[3], v[1], v[4]], [v[5], v[4], v[2]]])
        for k, v in zip(("0", "X", "Z"), theta.reshape(3, 6), strict=True)
    }
    rows, want = [], []
    for place in ((-200.0, -300.0), (200.0, -100.0), (100.0, -350.0)):
        for angle in np.arange(0.0, 2 * np.pi, 0.3):
            for i, j in ((0, 1), (1, 2), (2, 0)):
                force = np.zeros(3)
                force[[i, j]] = 200.0 * np.cos(angle), 200.0 * np.sin(angle)
                here = C["0"] + C["X"] * place[0] / 300.0 + C["Z"] * (place[1] + 200.0) / 200.0
                rows.append((place[0], place[1], force))
                want.append(force @ here @ force / 200.0)
    q = np.array([(x, 0.0, z) for x, z, _ in rows])[:, [1, 0, 2]]
    touches = at_poses(chain, q, 0.0)
    F = np.array([f for _, _, f in rows])
    object.__setattr__(touches, "force", F)
    along = np.einsum("nip,ni->np", Model(chain, (effect,)).tip_columns(touches), F / 200.0)
    np.testing.assert_allclose(along @ theta, want, rtol=1e-9)
    found = np.linalg.lstsq(along, np.array(want))[0]
    np.testing.assert_allclose(found, theta, rtol=1e-6)


def test_a_coupling_of_higher_degree_is_any_smooth_function_of_both_axes(chain):
    """EAX = 40 urad (3 u^2 - 1)/2 v + 10 urad u (5 v^3 - 3 v)/2, written out."""
    effect = parse_effect("coupling(EAX,Z,3)", chain)
    words = [p.name for p in effect.parameters]
    theta = np.zeros(9)
    theta[words.index("P2X P1Z")], theta[words.index("P1X P3Z")] = 40e-6, 10e-6
    x, z = 120.0, -50.0
    u, v = x / 300.0, (z + 200.0) / 200.0
    want = 40e-6 * (3 * u**2 - 1) / 2 * v + 10e-6 * u * (5 * v**3 - 3 * v) / 2
    touches = at_poses(chain, np.array([[0.0, x, z]]), 0.0)
    added = Model(chain, (effect,)).contribution(touches, theta)
    assert added.twist[0, chain.link_index("X"), 3] == pytest.approx(want, rel=1e-12)
    with pytest.raises(UnknownEffect, match="a degree of 1"):
        parse_effect("coupling(EAX,Z,9)", chain)
