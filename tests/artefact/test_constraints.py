"""Every constraint refuses the standard that breaks it, alone and by name; the demo breaks none."""

import re
from dataclasses import replace

import numpy as np
import pytest
from briefs import brief_of
from demo import leaning

from matstd.artefact.body import (
    OVERHANG,
    Base,
    Limits,
    check,
    constraints,
    graph_patch,
    max_slope,
    min_concave_radius,
)
from matstd.artefact.body.limits import overhang
from matstd.artefact.body.spline import clamped_knots
from matstd.artefact.brief import PlacementOptions
from matstd.artefact.layout import Blank, Fittings
from matstd.artefact.place import design_standard
from matstd.artefact.reach import ProbeReach, ProbeShape, Requests
from matstd.artefact.worth import TouchOptions
from matstd.sensitivity.first_order import Workspace
from matstd.twin.errors import NotBuildable, NotReachable, OutsideTravel, ShapeMismatch
from matstd.twin.record import Setup
from matstd.twin.units import DEG

FLAT = np.zeros((8, 8))
LIMITS = Limits()


def bowl(radius, half=18.0, count=8):
    """Control heights of ``z = (x^2 + y^2) / 2 R`` exactly: the blossom of x^2 at the knots."""
    knots = clamped_knots(-half - OVERHANG, half + OVERHANG, count, 5)
    square = np.array(
        [
            np.mean(
                [
                    knots[i + 1 : i + 6][p] * knots[i + 1 : i + 6][q]
                    for p in range(5)
                    for q in range(p)
                ]
            )
            for i in range(count)
        ]
    )
    return (square[:, None] + square[None, :]) / (2.0 * radius)


def test_demo_meets_every_constraint(standard):
    check(standard, LIMITS)
    assert {c.subject for c in constraints(standard, LIMITS)} >= set(standard.features) - {
        "DATUM_A"
    }


def test_concave_radius_of_a_bowl_is_its_own():
    patch = graph_patch("FF1", np.eye(4), (18.0, 18.0), bowl(15.0))
    assert np.abs(patch.height(patch.grid()) - (patch.grid() ** 2).sum(axis=1) / 30.0).max() < 1e-12
    # a paraboloid is most curved at its vertex: 1/R
    assert min_concave_radius(patch) == pytest.approx(15.0, abs=1e-6)
    assert max_slope(patch) == pytest.approx(np.arctan(18.0 * np.sqrt(2.0) / 15.0), abs=1e-9)
    assert min_concave_radius(graph_patch("FF1", np.eye(4), (18.0, 18.0), -bowl(15.0))) == np.inf


def changed(standard, number, **what):
    patches = list(standard.patches)
    patches[number] = replace(patches[number], **what)
    return replace(standard, patches=tuple(patches))


def test_column_that_leans_out_through_the_side_of_the_base():
    # looks inwards at 45 degrees, so its column runs outwards: its outer corners pass the top of
    # the base at radius + 18 cos 45 + (height + 18 sin 45 - 30), here 5 mm within the outline,
    # and leave through its side 5 mm lower, 10 mm above mid-base, where the column is cut off
    base = Base()
    radius = base.half_size[0] - 5.0 - 18.0 * np.sqrt(2.0) - (90.0 - base.thickness)
    for inwards, expected in ((0.0, 0.5 * base.thickness - 5.0), (10.0, 0.0)):
        at = leaning(0, radius - inwards, 90, -45)
        patch = graph_patch("FF1", at, (18.0, 20.0), FLAT, depth=140.0)
        assert overhang(patch, base) == pytest.approx(expected, abs=1e-9)


def test_hole_under_a_patch(standard):
    holes = (replace(standard.holes[0], x=100.0, y=0.0), *standard.holes[1:])
    with pytest.raises(NotBuildable, match="HOLE1: access from above past FF6"):
        check(replace(standard, holes=holes), LIMITS)


def test_names_are_used_once(standard):
    with pytest.raises(ShapeMismatch, match="two features are named FF3"):
        changed(standard, 0, name="FF3")


def test_volume_estimate_against_closed_form(standard):
    # base with rounded corners, one upright column with a flat lid, four holes, no core
    column = graph_patch("FF1", leaning(0, 0, 60, 0), (20.0, 25.0), FLAT, depth=45.0)
    places = ((50.0, 50.0), (-50.0, 50.0), (50.0, -50.0), (-50.0, -50.0))
    whole = replace(
        standard,
        base=Base((70.0, 70.0), 25.0, 30.0),
        core=None,
        patches=(column,),
        spheres=tuple(
            replace(s, centre=np.array([x, y, 60.0]))
            for s, (x, y) in zip(standard.spheres, ((0, 50), (50, 0), (-50, 0)), strict=True)
        ),
        holes=tuple(replace(h, x=x, y=y) for h, (x, y) in zip(standard.holes, places, strict=True)),
        blank_height=80.0,
    )
    fit = Fittings()
    plate = (140.0**2 - (4 - np.pi) * 25.0**2) * 30.0
    holes = 4 * np.pi * (fit.hole_radius**2 * 19.0 + fit.bore_radius**2 * 11.0)
    stems = sum(
        np.pi / 3 * (s.centre[2] - 30.0) * (81.0 + 54.0 + 36.0)
        + 4 / 3 * np.pi * 12.5**3
        - _stem_in_ball(s)
        for s in whole.spheres
    )
    exact = plate + 40.0 * 50.0 * 30.0 - holes + stems
    assert whole.volume(2.0) == pytest.approx(exact, rel=2e-3)
    assert whole.volume() == pytest.approx(exact, rel=1e-2)
    assert whole.mass(4.0) == pytest.approx(whole.volume() * 7.8e-6, rel=1e-12)


def _stem_in_ball(sphere):
    """Volume of the cone inside the ball, by a fine sum over heights."""
    z = np.linspace(sphere.foot, sphere.centre[2], 200_001)
    share = (z - sphere.foot) / (sphere.centre[2] - sphere.foot)
    cone = sphere.foot_radius + share * (sphere.stem_radius - sphere.foot_radius)
    ball2 = np.maximum(sphere.radius**2 - (z - sphere.centre[2]) ** 2, 0.0)
    return float(np.trapezoid(np.pi * np.minimum(cone**2, ball2), z))


EVERYTHING = {"room": -100.0, "steepest": 2.5}  # neither angle nor room for the probe matter
PROBE = ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0)))


def between(values):
    """A limit that the worst of some values breaks and the second worst does not."""
    first, second = sorted(values)[:2]
    return 0.5 * (first + second)


def moved(standard, number, by):
    T = standard.patches[number].T_artefact_patch.copy()
    T[:3, 3] += by
    return changed(standard, number, T_artefact_patch=T)


def steep(standard):
    return standard, replace(LIMITS, max_slope=-between([-max_slope(p) for p in standard.patches]))


def curved(standard):
    radii = [min_concave_radius(p) for p in standard.patches]
    return standard, replace(LIMITS, min_concave_radius=-between([-r for r in radii if r < 1e6]))


def heavy(standard):
    return standard, replace(LIMITS, max_mass=standard.mass(step=6.0) - 0.1)


def tall(standard):
    top = max(p.point(p.grid(4.0))[:, 2].max() for p in standard.patches)
    return replace(standard, blank_height=float(top) - 0.1), LIMITS


def wide(standard):
    base = standard.base
    reach = [overhang(p, base) for p in standard.patches]
    worst = int(np.argmax(reach))
    outwards = standard.patches[worst].T_artefact_patch[:3, 3] * [1.0, 1.0, 0.0]
    outwards *= 1.0 / np.abs(outwards).max()
    return moved(standard, worst, (0.5 - reach[worst]) * outwards), LIMITS


def hanging(standard):
    return changed(standard, 7, depth=30.0), LIMITS


def bored(standard):
    holes = (replace(standard.holes[0], bore_depth=26.0), *standard.holes[1:])
    return replace(standard, holes=holes), LIMITS


def two_holes(standard):
    first = standard.holes[0]
    turned = replace(standard.holes[1], x=first.x * 0.86, y=first.y)
    return replace(standard, holes=(first, turned, *standard.holes[2:])), LIMITS


def cut_rim(standard):
    # where along the side of the base there is most room for it
    first, base = standard.holes[0], standard.base
    x, y = base.half_size[0] - first.bore_radius - 1.0, np.linspace(-100.0, 100.0, 41)
    at, up = np.meshgrid(y, np.arange(base.thickness, standard.blank_height, 5.0))
    points = np.column_stack([np.full(at.size, x), at.ravel(), up.ravel()])
    others = [body for name, body in standard.bodies.items() if name != "BASE"]
    room = np.min([body.distance(points) for body in others], axis=0).reshape(at.shape).min(axis=0)
    for hole in standard.holes[1:]:
        room = np.minimum(room, np.hypot(hole.x - x, hole.y - y) - hole.bore_radius)
    moved_out = replace(first, x=x, y=float(y[np.argmax(room)]))
    return replace(standard, holes=(moved_out, *standard.holes[1:])), LIMITS


def crowded(standard):
    room = sorted(
        c.value for c in constraints(standard, LIMITS) if c.name.startswith("room for the ball")
    )
    return standard, replace(LIMITS, gap=0.5 * (room[0] + room[1]))


@pytest.mark.parametrize(
    ("broken", "line"),
    [
        (curved, r"FF\d+: smallest concave radius is [\d.]+ mm, limit"),
        (steep, r"FF\d+: slope is [\d.]+ deg, limit"),
        (heavy, r"demo: mass is [\d.]+ kg, limit"),
        (tall, r"FF1: height is [\d.]+ mm, limit"),
        (wide, r"FF\d+: reach beyond the outline of the blank is 0\.5\d* mm, limit 0\.000 mm"),
        (hanging, r"FF8: depth of the column's end in the body is -[\d.]+ mm, limit 2\.000 mm"),
        (bored, r"HOLE1: depth of the counterbore is 26\.000 mm, limit 25\.000 mm"),
        (two_holes, r"HOLE2: wall to HOLE1 is [-\d.]+ mm, limit 3\.000 mm"),
        (cut_rim, r"HOLE1: wall to the outline is 1\.000 mm, limit 3\.000 mm"),
        (crowded, r"\w+: room for the ball before \w+ is [\d.]+ mm, limit"),
    ],
)
def test_one_constraint_broken_is_the_only_one_named(standard, broken, line):
    made, limits = broken(standard)
    violated = [c for c in constraints(made, limits) if c.slack < 0.0]
    assert len({c.name for c in violated}) == 1
    with pytest.raises(NotBuildable, match=f"standard 'demo': {line}") as caught:
        check(made, limits)
    assert "\n" not in str(caught.value)


def test_a_ball_larger_than_the_cutter_decides_the_concave_radius(standard):
    limits = Limits(min_concave_radius=1.0, ball_radius=4.0)
    found = {c.name: c.limit for c in constraints(standard, limits) if c.subject == "FF1"}
    assert found["smallest concave radius"] == 4.0


def test_a_groove_too_narrow_for_ball_and_cutter(standard):
    # poles on a paraboloid of radius 2 mm; the face is so small that nothing else is in the way
    x = np.linspace(-1.0, 1.0, 8)
    net = 36.0 * (x[:, None] ** 2 + x[None, :] ** 2) / 4.0
    T = standard.patches[0].T_artefact_patch
    tiny = graph_patch("FF1", T, (1.0, 1.0), net, depth=standard.patches[0].depth)
    made = replace(standard, patches=(tiny, *standard.patches[1:]))
    names = {c.name for c in constraints(made, LIMITS) if c.slack < 0.0}
    assert "smallest concave radius" in names


def touch(standard, feature, uv, c_b):
    surface = standard.features[feature]
    uv = np.atleast_2d(np.array(uv, dtype=float))
    rotary = np.array([c_b]) * DEG
    return Requests(np.array([feature]), surface.point(uv), surface.normal(uv), rotary)


@pytest.mark.parametrize(
    ("feature", "uv", "c_b", "what", "reason"),
    [
        ("FF1", (0.0, 0.0), (0.0, 0.0), {}, ""),
        (
            "FF1",
            (0.0, 0.0),
            (0.0, -100.0),
            {},
            r"the surface leans \d+\.\d degrees from the tool axis",
        ),
        ("FF1", (0.0, 0.0), (400.0, 0.0), {}, r"C would have to go to 400\.0, -360 to 360 degrees"),
        (
            "FF1",
            (0.0, 0.0),
            (0.0, 0.0),
            {"length": 660.0},
            r"Z would have to go to [\d.]+, -500 to 0 mm",
        ),
        ("FF1", (0.0, 0.0), (0.0, 0.0), {"room": 80.0}, r"[\d.]+ mm between probe and \w+"),
        (
            "SPH1",
            (0.0, -40 * DEG),
            (0.0, 0.0),
            EVERYTHING,
            r"on its way down the ball meets .* of SPH1",
        ),
        ("FF1", (-25.0, 0.0), (0.0, 0.0), EVERYTHING, "the ball meets nothing within the travel"),
    ],
)
def test_what_is_against_a_touch(standard, chain, feature, uv, c_b, what, reason):
    reach = replace(ProbeReach(chain, Setup("a"), PROBE, 160.0), **what)
    wanted = touch(standard, feature, uv, c_b)
    (found,) = reach.reasons(standard, wanted)
    assert re.match(f"{reason}$", found)
    can_be_made = reach.is_reachable(wanted) & reach.is_clear(standard, wanted)
    assert can_be_made.tolist() == [not reason]


OPTIONS = PlacementOptions(name="trial", sites=60, choice=TouchOptions(touches=160, poses=12))


@pytest.mark.parametrize(
    ("limits", "what", "kind", "line"),
    [
        pytest.param(
            Limits(gap=60.0),
            {},
            NotBuildable,
            r"only 5 of 6 patches fit .* probe need 66 mm",
            marks=pytest.mark.slow,
        ),
        (
            Limits(),
            {"steepest": 1e-3},
            NotReachable,
            "none of 18000 random touches looks within 0.1 deg",
        ),
        (Limits(), {"length": 900.0}, NotReachable, "every axis within its limits"),
    ],
)
def test_contradictory_limits_are_refused_with_the_one_that_binds(
    chain, workspace, limits, what, kind, line
):
    reach = replace(ProbeReach(chain, Setup("a"), PROBE, 160.0), **what)
    brief = brief_of(reach, workspace, OPTIONS, Blank(limits=limits))
    with pytest.raises(kind, match=line) as caught:
        design_standard(brief, np.random.default_rng(1))
    assert "\n" not in str(caught.value)


def test_a_workspace_out_of_reach_is_refused(chain, workspace):
    with pytest.raises(OutsideTravel, match="workspace of X: 500 to 600, beyond the travel -400"):
        Workspace(chain, workspace.limits | {"X": (500.0, 600.0)}, 160.0)
    narrow = Workspace(chain, workspace.limits | {"B": (-109.0 * DEG, -108.0 * DEG)}, 160.0)
    reach = ProbeReach(chain, Setup("a"), PROBE, 160.0)
    with pytest.raises(NotReachable, match="leave no room: they are approached"):
        design_standard(brief_of(reach, narrow, OPTIONS), np.random.default_rng(1))
