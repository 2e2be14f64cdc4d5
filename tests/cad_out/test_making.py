"""Cutters and stiffness against closed forms: cantilevers, slots, a cube under uniform strain."""

import json
from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.body import Base, Material, graph_patch
from matstd.artefact.layout import cantilever_stiffness
from matstd.cad_out.details import details_of
from matstd.cad_out.making import Making, making_of, stiffness_of, with_sag, write_making
from matstd.cad_out.making.cutting import OVERHANG, RADIUS, cutting_of, is_free, untrimmed_radius
from matstd.cad_out.making.hexahedron import CORNERS, cube
from matstd.cad_out.making.hints import hints_of, step_over
from matstd.cad_out.making.stiffness import GRAVITY
from matstd.twin.frames import pose
from matstd.twin.units import DEG, UM

E, NU = 200e3, 0.3


def test_a_cube_under_uniform_strain_stores_the_energy_of_hookes_law():
    K, side = cube(7.0, E, NU), 7.0
    eigenvalues = np.linalg.eigvalsh(K)
    assert (np.abs(eigenvalues) < 1e-9 * eigenvalues.max()).sum() == 6
    places = 0.5 * side * CORNERS
    for strain in (np.diag([1e-3, 0.0, 0.0]), np.array([[0, 1e-3, 0], [1e-3, 0, 0], [0, 0, 0]])):
        u = (places @ strain.T).reshape(-1)
        lame, shear = E * NU / ((1 + NU) * (1 - 2 * NU)), 0.5 * E / (1 + NU)
        by_hand = 0.5 * lame * np.trace(strain) ** 2 + shear * np.sum(strain**2)
        assert 0.5 * u @ K @ u == pytest.approx(by_hand * side**3, rel=1e-9)


@pytest.fixture(scope="module")
def mast(upright):
    """A pillar of 10 by 10 mm, 90 mm above a plate of 20 mm with three screws."""
    flat = np.zeros((4, 4))
    pillar = graph_patch(
        "FF1", pose(t=np.array([5.0, 5.0, 110.0])), (5.0, 5.0), flat, (3, 3), 100.0
    )
    holes = tuple(
        replace(hole, x=x, y=y) for hole, (x, y) in zip(
            upright.holes, ((-10.0, 0.0), (20.0, -10.0), (20.0, 20.0)), strict=True
        )
    )  # fmt: skip
    return replace(
        upright, base=Base((50.0, 50.0), 5.0, 20.0), patches=(pillar,), spheres=(), holes=holes
    )


ALUMINIUM = Material("EN AW-5083", 2.66e-6, 23.8e-6, modulus=71e3, poisson=0.33)
INVAR = Material("Invar", 8.05e-6, 1.5e-6).with_usual_modulus()


@pytest.mark.parametrize("stuff", [None, ALUMINIUM, INVAR])
def test_a_mast_swings_and_sags_as_a_cantilever(mast, stuff):
    """Euler and Bernoulli: f = 1.8751^2 / (2 pi L^2) sqrt(E I / rho A), tip rho A g L^4 / 8 E I."""
    mast = replace(mast, material=stuff or mast.material)
    modulus = {"EN AW-5083": 71e3, "Invar": 141e3}.get(mast.material.name, E)
    found = stiffness_of(mast, details_of(mast), 10.0)
    density, L, b = mast.material.density, 90.0, 10.0
    second, area = b**4 / 12.0, b**2
    f = 1.8751**2 / (2 * np.pi * L**2) * np.sqrt(modulus * second / (density * area) * 1e3)
    tip = density * area * GRAVITY * L**4 / (8.0 * modulus * second) * 1e-3
    # the plate gives way a little, and the blend of the foot is in the cubes beside it
    assert found.first_mode == pytest.approx(f, rel=0.08)
    assert found.sag["FF1"] == pytest.approx(tip, rel=0.15)


def test_sag_goes_by_density_over_modulus_and_the_first_mode_by_its_root(mast):
    """Of two materials with one Poisson's ratio, to all digits; the plate takes part in both."""
    steel = replace(mast.material, modulus=200e3, poisson=0.33)
    one, other = (
        stiffness_of(replace(mast, material=m), details_of(mast), 10.0) for m in (steel, ALUMINIUM)
    )
    softer, lighter = 200e3 / 71e3, 2.66 / 7.8
    assert other.sag["FF1"] == pytest.approx(one.sag["FF1"] * softer * lighter, rel=1e-4)
    assert other.first_mode == pytest.approx(one.first_mode / np.sqrt(softer * lighter), rel=1e-4)


def test_without_a_modulus_stiffness_and_sag_stay_unknown(upright, tmp_path):
    own = replace(upright, material=Material("1.2379", 7.7e-6, 11e-6).with_usual_modulus())
    assert stiffness_of(own, details_of(own), 25.0) is None
    write_making(tmp_path / "making.json", making_of(own, None))
    written = json.loads((tmp_path / "making.json").read_text())
    unknown = ("modulus_MPa", "first_mode_Hz", "ball_N_um", "sag_um", "sag_worst")
    assert {key: written[key] for key in unknown} == dict.fromkeys(unknown)
    assert written["material"] == "1.2379"


def test_the_uncertainty_of_a_usual_modulus_is_in_that_of_the_sag(mast):
    """A fifth by the elements; granite is from 30 to 90 GPa by its kind."""
    for name, share in (("X40Cr14 (1.2083)", 0.2), ("Granite", 0.36)):
        stuff = Material(name, 2.9e-6, 8e-6).with_usual_modulus()
        solid = replace(mast, material=stuff)
        sagging = with_sag(solid, stiffness_of(solid, details_of(solid), 10.0), "-Z")
        assert sagging.sag.share == share
        assert sagging.sag.modulus == stuff.modulus


def test_a_ball_on_a_rigid_plate_sags_by_its_weight_over_the_stiffness_of_its_post(upright):
    bare = replace(upright, patches=upright.patches[:1])
    found = stiffness_of(bare, details_of(bare), 12.5)
    ball = upright.spheres[1]
    length = ball.centre[2] - ball.foot
    post = 7.8e-6 * np.pi * ball.foot_radius**2 * (length - ball.radius)  # nearly a cylinder
    mass = 7.83e-6 * 4.0 / 3.0 * np.pi * ball.radius**3 + 0.25 * post
    k = cantilever_stiffness(length, ball.stem_radius, ball.foot_radius, E, NU)
    alone = mass * GRAVITY * 1e-3 / k
    assert alone < found.sag["SPH2"] < 3.0 * alone
    assert k / 3.0 < found.at_balls["SPH2"] < k
    up = np.array([0.0, 0.0, 100.0])  # on a block of 130 mm nothing but post and foot gives way
    higher = replace(ball, foot=ball.foot + up[2], centre=ball.centre + up)
    base = replace(bare.base, thickness=bare.base.thickness + up[2])
    thick = replace(bare, base=base, spheres=(higher,))
    assert found.at_balls["SPH2"] < stiffness_of(thick, details_of(bare), 25.0).at_balls["SPH2"] < k
    assert found.worst[0] in found.sag


def test_a_cutter_reaches_open_pillars_and_not_the_floor_of_a_deep_slot(upright):
    details = details_of(upright)
    found = cutting_of(upright, details)
    assert found.tilted == 1.0
    assert found.out_of_reach == ()
    assert found.overhang == OVERHANG
    flat = np.zeros((4, 4))
    walls = tuple(
        graph_patch(f"FF{i}", pose(t=np.array([x, 0.0, 160.0])), (20.0, 40.0), flat, (3, 3), 150.0)
        for i, x in ((1, -26.0), (2, 26.0))
    )
    slot = replace(upright, patches=walls, spheres=(), blank_height=200.0)
    found = cutting_of(slot, details_of(slot))
    assert found.upright < found.tilted < 1.0
    assert {"FF1 wall", "FF2 wall"} <= set(found.out_of_reach)
    # tilted by 45 degrees along the slot of 80 mm, a holder of 27 mm is out of it at its middle
    # where (overhang - 13.5) / sqrt 2 > 40, from 70 mm on
    assert found.overhang == 80.0


def test_a_cutter_comes_from_above_to_a_post_under_its_ball(upright):
    """The post is milled before its ball, which is wider, is glued in."""
    ball, up = upright.spheres[0], np.array([0.0, 0.0, 1.0])
    x, y, z = ball.centre
    beside = np.array([[x + ball.foot_radius + RADIUS + 0.01, y, ball.foot + 20.0]])
    side_of_shank = np.array([[x + ball.foot_radius + 0.01, y, z]])
    assert upright.holds(side_of_shank, 0.5)  # where the ball will be
    assert is_free(upright, beside, up).all()
    assert not is_free(upright, beside - [2.0, 0.0, 0.0], up).any()


def test_the_largest_cutter_fits_the_least_radius_beyond_the_trim(upright):
    """A bowl z = (x^2 + y^2) / 2 R has the radius R in its middle and wider ones outside."""
    R = 11.0
    control = np.array([1.0, -1.0, 1.0]) * 18.0**2 / (2.0 * R)  # of a parabola of degree 2
    bowl = graph_patch(
        "FF1", pose(t=np.array([-38.0, -22.0, 52.0])), (12.0, 12.0),
        control[:, None] + control, (2, 2), 44.0,
    )  # fmt: skip
    assert untrimmed_radius(bowl) == pytest.approx(R, rel=1e-6)
    hollow = replace(upright, patches=(bowl, upright.patches[1]))
    assert cutting_of(hollow, details_of(hollow)).cutter["FF1"] == 16.0  # 0.8 * 22 = 17.6


def test_the_file_has_every_figure_with_its_limit(upright, tmp_path):
    details = details_of(upright)
    stiffness, hints = stiffness_of(upright, details, 25.0), hints_of(upright)
    made = Making(cutting_of(upright, details), stiffness, hints, upright.material)
    write_making(tmp_path / "making.json", made)
    written = json.loads((tmp_path / "making.json").read_text())
    assert written["first_mode_Hz"] == pytest.approx(made.stiffness.first_mode)
    assert written["sag_limit_um"] == 0.1
    assert (written["modulus_MPa"], written["poisson"]) == (200e3, 0.3)
    assert written["modulus_source"].startswith("usual value of x40cr14: ")
    assert written["ball_N_um"]["SPH3"] == pytest.approx(stiffness.at_balls["SPH3"] / 1e3)
    assert set(written["sag_um"]) == {"FF1", "FF2", "SPH1", "SPH2", "SPH3"}
    face = written["faces"]["FF1"]
    assert face["step_over_mm"]["Ra 0.8 um"] == pytest.approx(
        2.0 * face["step_over_mm"]["Ra 0.2 um"]
    )
    assert face["contact_angle_deg"][0] == pytest.approx(max(hints["FF1"].contact[0] / DEG, 0.0))


@pytest.mark.parametrize("curvature", [0.0, 1.0 / 25.0, -1.0 / 15.0])
def test_a_step_over_leaves_the_roughness_that_it_is_for(curvature):
    """Against the profile of two passes itself: the ball's circles, from circle to circle."""
    r, ra = 3.0, 0.4 * UM
    s = step_over(ra, r, curvature)
    x = np.linspace(-0.5 * s, 0.5 * s, 20001)
    profile = r - np.sqrt(r**2 - x**2)
    if curvature:  # the surface, taken off
        R = 1.0 / curvature
        profile += R - np.sign(R) * np.sqrt(R**2 - x**2)
    profile -= profile.mean()
    assert np.abs(profile).mean() == pytest.approx(ra, rel=2e-3)


def test_a_slope_is_milled_beside_the_tip(upright):
    """A plane at 20 degrees: upright it touches at 20, tilted away at up to 65."""
    lean = np.tan(20.0 * DEG)
    plane = graph_patch(
        "FF1", pose(t=np.array([0.0, 0.0, 60.0])), (12.0, 12.0),
        lean * np.linspace(-18.0, 18.0, 4)[:, None] + np.zeros((4, 4)), (3, 3), 52.0,
    )  # fmt: skip
    alone = replace(upright, patches=(plane,), spheres=())
    hint = hints_of(alone)["FF1"]
    assert hint.convex == np.inf
    np.testing.assert_allclose(hint.slope, 20.0 * DEG, atol=1e-9)
    np.testing.assert_allclose(hint.tilts, np.array([0.0, 15.0, 30.0, 45.0]) * DEG)
    # the normal leans to -x, so the axis leans to +x
    np.testing.assert_allclose(hint.axis, (45.0 * DEG, 0.0), atol=1e-12)
    np.testing.assert_allclose(hint.contact, 65.0 * DEG, atol=1e-9)
