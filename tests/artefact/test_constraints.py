"""Every constraint refuses the standard that breaks it, by name; the demo breaks none."""

from dataclasses import replace

import numpy as np
import pytest
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
from matstd.artefact.layout import Fittings
from matstd.twin.errors import NotBuildable, ShapeMismatch

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
    assert whole.mass() == pytest.approx(whole.volume() * 7.8e-6, rel=1e-12)


def _stem_in_ball(sphere):
    """Volume of the cone inside the ball, by a fine sum over heights."""
    z = np.linspace(sphere.foot, sphere.centre[2], 200_001)
    share = (z - sphere.foot) / (sphere.centre[2] - sphere.foot)
    cone = sphere.foot_radius + share * (sphere.stem_radius - sphere.foot_radius)
    ball2 = np.maximum(sphere.radius**2 - (z - sphere.centre[2]) ** 2, 0.0)
    return float(np.trapezoid(np.pi * np.minimum(cone**2, ball2), z))
