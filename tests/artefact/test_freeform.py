"""The spline against scipy, closed forms and finite differences; contact against other searches."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline
from scipy.optimize import brentq, minimize

from matstd.artefact.body import OVERHANG, graph_patch
from matstd.artefact.body.spline import clamped_knots, greville, pieces, powers
from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.units import NM, UM

ROUNDING = 1e-11  # mm: float64 on coordinates of a few hundred mm
BALL = 3.0


def tilted(rng):
    return pose(fixed_xyz(rng.uniform(-1.0, 1.0, 3)), rng.uniform(-80.0, 80.0, 3))


def wavy(seed=0, half=(20.0, 16.0), count=(9, 8), amplitude=1.2):
    """Random but smooth control heights; concave radii stay above the ball's."""
    rng = np.random.default_rng(seed)
    u = np.linspace(-1.0, 1.0, count[0])[:, None]
    v = np.linspace(-1.0, 1.0, count[1])[None, :]
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    net = np.sin(2.5 * u + phase[0]) * np.cos(1.5 * v + phase[1]) + np.sin(2.2 * v + phase[2])
    return graph_patch("FF1", tilted(rng), half, amplitude * net)


def interpolated(function, half=(20.0, 20.0), T=None, count=60, degree=5):
    """A patch whose spline interpolates z = function(x, y); the error is far below a nanometre."""
    a, b = half[0] + OVERHANG, half[1] + OVERHANG
    knots = clamped_knots(-a, a, count, degree), clamped_knots(-b, b, count, degree)
    x, y = greville(knots[0], degree), greville(knots[1], degree)
    z = function(*np.meshgrid(x, y, indexing="ij"))
    along = make_interp_spline(x, z, k=degree, t=knots[0]).c
    net = make_interp_spline(y, along.T, k=degree, t=knots[1]).c.T
    return graph_patch("FF1", np.eye(4) if T is None else T, half, net, (degree, degree))


def inside(patch, rng, count, margin=0.0):
    return rng.uniform(-1.0, 1.0, (count, 2)) * (np.array(patch.half_size) - margin)


@pytest.mark.parametrize("degree", [3, 5])
def test_pieces_are_scipys_with_its_derivatives(degree):
    rng = np.random.default_rng(degree)
    ends = np.full(degree + 1, -7.0), np.full(degree + 1, 9.0)
    knots = np.concatenate([ends[0], np.sort(rng.uniform(-6.0, 6.0, 5)), ends[1]])
    x = np.concatenate([rng.uniform(-7.0, 9.0, 200), [-7.0, 9.0], knots[degree + 1 : -degree - 1]])
    coefficients = rng.normal(size=len(knots) - degree - 1)
    spline = BSpline(knots, coefficients, degree)
    first, power = powers(knots, degree, x, 3)
    values = np.einsum("okn,nkj->noj", power, pieces(knots, degree)[first])
    picked = coefficients[first[:, None] + np.arange(degree + 1)]
    for order in range(3):
        theirs = spline(x, nu=order)
        ours = np.einsum("nk,nk->n", values[:, order], picked)
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(theirs).max()


def test_points_are_those_of_the_poles_by_scipy():
    patch = wavy(3)
    uv = inside(patch, np.random.default_rng(1), 500)
    spline = NdBSpline((patch.knots_u, patch.knots_v), np.array(patch.poles), k=patch.degree)
    assert np.abs(spline(uv) - patch.point(uv)).max() < ROUNDING


def test_parameters_are_millimetres_of_the_patch_plane():
    patch = wavy(4)
    uv = inside(patch, np.random.default_rng(2), 100)
    local = (patch.point(uv) - patch.T_artefact_patch[:3, 3]) @ patch.T_artefact_patch[:3, :3]
    assert np.abs(local[:, :2] - uv).max() < ROUNDING
    assert np.abs(local[:, 2] - patch.height(uv)).max() < ROUNDING
    assert np.abs(patch.height(uv) - patch.jet(uv).h).max() < ROUNDING


def test_derivatives_and_normal_against_differences():
    patch = wavy(5)
    uv = inside(patch, np.random.default_rng(3), 300)
    step = 1e-3  # mm: the remainder step^2 |S'''| / 6 is about 1e-9 here
    eu, ev = np.array([step, 0.0]), np.array([0.0, step])
    du = (patch.point(uv + eu) - patch.point(uv - eu)) / (2 * step)
    dv = (patch.point(uv + ev) - patch.point(uv - ev)) / (2 * step)
    duu = (patch.point(uv + eu) - 2 * patch.point(uv) + patch.point(uv - eu)) / step**2
    dvv = (patch.point(uv + ev) - 2 * patch.point(uv) + patch.point(uv - ev)) / step**2
    one, nil, j = np.ones(len(uv)), np.zeros(len(uv)), patch.jet(uv)
    turned = patch.T_artefact_patch[:3, :3]
    assert np.abs(du @ turned - np.column_stack([one, nil, j.hu])).max() < 1e-8
    assert np.abs(dv @ turned - np.column_stack([nil, one, j.hv])).max() < 1e-8
    assert np.abs(duu @ turned - np.column_stack([nil, nil, j.huu])).max() < 1e-6
    assert np.abs(dvv @ turned - np.column_stack([nil, nil, j.hvv])).max() < 1e-6
    huv = (patch.jet(uv + ev).hu - patch.jet(uv - ev).hu) / (2 * step)
    assert np.abs(j.huv - huv).max() < 1e-8
    across = np.cross(du, dv)
    normal = across / np.linalg.norm(across, axis=1, keepdims=True)
    assert np.abs(patch.normal(uv) - normal).max() < 1e-8
    assert np.all(patch.normal(uv) @ patch.direction > 0.0)


def test_the_jet_of_a_sum_is_that_of_the_summed_control_net():
    rng = np.random.default_rng(8)
    nets = rng.uniform(-1.0, 1.0, (2, 9, 8))
    one, other, both = (
        graph_patch("FF1", np.eye(4), (20.0, 16.0), net) for net in (*nets, nets[0] - 0.7 * nets[1])
    )
    uv = inside(one, rng, 50)
    summed = one.jet(uv).plus(other.jet(uv), -0.7)
    for name, expected in vars(both.jet(uv)).items():
        np.testing.assert_allclose(getattr(summed, name), expected, atol=ROUNDING)


def test_sphere_like_patch_has_the_curvature_of_its_sphere():
    R = 60.0
    rng = np.random.default_rng(6)
    T = tilted(rng)
    cup = interpolated(lambda x, y: R - np.sqrt(R**2 - x**2 - y**2), T=T)
    uv = inside(cup, rng, 200)
    centre = T[:3, 3] + R * T[:3, 2]
    assert np.abs(np.linalg.norm(cup.point(uv) - centre, axis=1) - R).max() < 1.0 * NM
    # a cup is concave seen from outside: positive
    assert np.abs(cup.curvature(uv) * R - 1.0).max() < 1e-5
    inward = (centre - cup.point(uv)) / R
    assert np.abs(cup.normal(uv) - inward).max() < 1e-7
    dome = interpolated(lambda x, y: np.sqrt(R**2 - x**2 - y**2) - R)
    assert np.abs(dome.curvature(uv) * R + 1.0).max() < 1e-5


def test_paraboloid_has_its_closed_principal_curvatures():
    # z = x^2/2p + y^2/2q is a spline exactly. On x = 0: 1/(p w) across and 1/(q w^3) along,
    # w^2 = 1 + (y/q)^2; both lines are lines of curvature by symmetry.
    p, q = 25.0, -40.0
    patch = interpolated(lambda x, y: x**2 / (2 * p) + y**2 / (2 * q), count=12)
    y = np.linspace(-18.0, 18.0, 31)
    w = np.sqrt(1.0 + (y / q) ** 2)
    expected = np.sort(np.column_stack([1 / (p * w), 1 / (q * w**3)]), axis=1)[:, ::-1]
    found = patch.curvature(np.column_stack([np.zeros_like(y), y]))
    assert np.abs(found - expected).max() < 1e-12
    slope = patch.slope(np.column_stack([np.zeros_like(y), y]))
    assert np.abs(np.tan(slope) - np.abs(y / q)).max() < 1e-12


def test_curvature_against_the_shape_operator_by_differences():
    patch = wavy(7)
    uv = inside(patch, np.random.default_rng(8), 100)
    step = 1e-3
    E = np.eye(2) * step
    dn = [(patch.normal(uv + e) - patch.normal(uv - e)) / (2 * step) for e in E]
    dS = [(patch.point(uv + e) - patch.point(uv - e)) / (2 * step) for e in E]
    first = np.array([[np.einsum("ni,ni->n", a, b) for b in dS] for a in dS]).transpose(2, 0, 1)
    # dn turns away from a concave face's tangent: II = -dn.dS is positive where it is a cup
    second = -np.array([[np.einsum("ni,ni->n", a, b) for b in dS] for a in dn]).transpose(2, 0, 1)
    principal = np.linalg.eigvals(np.linalg.solve(first, second)).real
    assert np.abs(np.sort(principal, axis=1)[:, ::-1] - patch.curvature(uv)).max() < 1e-7


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.floats(-2.0, 8.0))
def test_foot_point_of_an_offset_point_is_where_it_came_from(seed, lift):
    # below the smallest radius of curvature a point on the normal has its foot there
    patch = wavy(seed)
    uv = inside(patch, np.random.default_rng(seed), 50, margin=1.0)
    found = patch.project(patch.point(uv) + lift * patch.normal(uv))
    assert np.abs(found - uv).max() < 1e-7


def test_foot_points_far_outside_are_reported_as_none():
    patch = wavy(1)
    beyond = patch.point(np.array([[20.0, 0.0]])) + 40.0 * patch.T_artefact_patch[:3, 0]
    assert np.isnan(patch.project(beyond)).all()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000))
def test_contact_along_the_normal_returns_the_touch(seed):
    patch = wavy(seed)
    rng = np.random.default_rng(seed)
    uv = inside(patch, rng, 60, margin=0.5)
    standoff = rng.uniform(0.1, 30.0, 60)
    n = patch.normal(uv)
    hit = patch.contact(patch.point(uv) + (BALL + standoff)[:, None] * n, -n, BALL)
    met = np.abs(hit.uv - uv).max(axis=1) < 1e-7
    # from afar a ball may meet another wave before the touch aimed at, never after it
    assert np.all(met | (hit.travel < standoff - 1e-6))
    assert np.abs(hit.travel - standoff)[met].max() < 0.01 * NM
    assert met.mean() > 0.8


def gap_of_ball(patch, centre, start_uv):
    """Distance of the ball's surface from the face by a general minimiser."""
    a, b = patch.half_size
    best = minimize(
        lambda uv: ((patch.point(uv[None])[0] - centre) ** 2).sum(),
        start_uv,
        bounds=[(-a, a), (-b, b)],
        method="L-BFGS-B",
        options={"ftol": 1e-16, "gtol": 1e-12},
    )
    return np.sqrt(best.fun) - BALL


def test_contact_agrees_with_bisection_on_the_distance():
    # second source: the travel at which the distance of the ball's centre falls to its radius,
    # the distance by scipy's bounded minimiser from the best of a fine grid
    patch = wavy(11)
    rng = np.random.default_rng(12)
    uv = inside(patch, rng, 3, margin=4.0)
    n = patch.normal(uv)
    d = -(n + 0.5 * rng.normal(size=n.shape))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    start = patch.point(uv) - 12.0 * d
    hit = patch.contact(start, d, BALL)
    assert patch.contains(hit.uv).all()
    grid = patch.grid(0.5)
    points = patch.point(grid)
    for k in range(len(uv)):

        def gap(t, k=k):
            centre = start[k] + t * d[k]
            nearest = grid[np.argmin(((points - centre) ** 2).sum(axis=1))]
            return gap_of_ball(patch, centre, nearest)

        travel = brentq(gap, 0.0, hit.travel[k] + 0.5, xtol=1e-9)
        assert abs(travel - hit.travel[k]) < 0.05 * UM


def test_ball_that_passes_by_is_reported_as_no_contact():
    patch = wavy(2)
    side = patch.T_artefact_patch[:3, 0]
    start = patch.point(np.zeros((1, 2))) + 40.0 * patch.direction
    hit = patch.contact(start, side, BALL)
    assert np.isnan(hit.travel).all()
    assert np.isnan(hit.uv).all()
    away = patch.contact(start, patch.direction, BALL)
    assert np.isnan(away.travel).all()


def test_ball_that_starts_in_the_face_has_negative_travel():
    patch = wavy(2)
    uv = np.zeros((1, 2))
    start = patch.point(uv) + (BALL - 0.4) * patch.normal(uv)
    hit = patch.contact(start, -patch.normal(uv), BALL)
    assert hit.travel[0] == pytest.approx(-0.4, abs=NM)


def test_patch_refuses_what_is_no_control_net():
    T = np.eye(4)
    with pytest.raises(ShapeMismatch, match="4 poles cannot carry degree 5; at least 6"):
        graph_patch("FF1", T, (10.0, 10.0), np.zeros((4, 8)))
    with pytest.raises(ShapeMismatch, match="FF1: control heights have 1 dimensions, expected 2"):
        graph_patch("FF1", T, (10.0, 10.0), np.zeros(8))
    with pytest.raises(ShapeMismatch, match="FF7: control heights: every number must be finite"):
        graph_patch("FF7", T, (10.0, 10.0), np.full((8, 8), np.nan))


def test_patch_refuses_knots_of_another_spline():
    patch = wavy(0)
    knots = np.array(patch.knots_u)
    unclamped, creased, short = knots.copy(), knots.copy(), knots * 0.7
    unclamped[0] -= 1.0
    creased[6:10] = knots[7]
    for wrong, words in (
        (unclamped, "must stand 6 times"),
        (creased[::-1], "must ascend"),
        (np.concatenate([knots[:6], np.zeros(len(knots) - 12), knots[-6:]]), None),
        (short, "expected 21 mm to both sides"),
        (knots[:-1], r"shape \(14,\), expected \(15,\)"),
    ):
        if words is None:
            replace(patch, knots_u=wrong)  # three knots in one place: still smooth at degree 5
            continue
        with pytest.raises(ShapeMismatch, match=words):
            replace(patch, knots_u=wrong)
    cubic = graph_patch("FF1", np.eye(4), (10.0, 10.0), np.zeros((7, 7)), (3, 3))
    triple = np.concatenate([cubic.knots_u[:4], np.zeros(3), cubic.knots_u[-4:]])
    with pytest.raises(ShapeMismatch, match="a knot stands too often for a face without a crease"):
        replace(cubic, knots_u=triple)
    with pytest.raises(ShapeMismatch, match="degree 1, expected at least 2"):
        graph_patch("FF1", np.eye(4), (10.0, 10.0), np.zeros((6, 6)), (1, 3))


def test_patch_is_read_only():
    patch = wavy(0)
    with pytest.raises(ValueError, match="read-only"):
        patch.heights[0, 0] = 1.0
