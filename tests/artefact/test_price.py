"""Estimates of price: sums worked by hand, uncertainties, and what makes a body dearer."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.body import Material
from matstd.artefact.price import Construction, Estimate, construction_to_make, prices_of
from matstd.artefact.price.rates import MILLING, PER_PART, SET_UP


def test_a_range_has_the_uncertainty_of_a_rectangle():
    one = Estimate.between(70.0, 130.0)
    assert one.value == 100.0
    assert one.u == pytest.approx(60.0 / np.sqrt(12.0))


def test_products_and_quotients_follow_a_monte_carlo():
    rng = np.random.default_rng(1)
    a, b = Estimate(10.0, 0.5), Estimate(4.0, 0.3)
    x, y = rng.normal(10.0, 0.5, 200_000), rng.normal(4.0, 0.3, 200_000)
    for made, drawn in ((a.times(b), x * y), (a.over(b), x / y), (a + b, x + y)):
        assert made.value == pytest.approx(drawn.mean(), rel=0.01)
        assert made.u == pytest.approx(drawn.std(), rel=0.03)


def test_both_constructions_of_a_standard(upright):
    billet, parts = prices_of(upright)
    assert [billet.construction, parts.construction] == [*Construction]
    a, b = (2.0 * half + 10.0 for half in upright.base.half_size)
    top = max(
        *(ball.centre[2] for ball in upright.spheres),
        *(p.point(p.grid(2.0))[:, 2].max() for p in upright.patches),
    )
    assert billet.stock == pytest.approx(upright.material.density * a * b * (top + 10.0))
    assert parts.stock < 0.6 * billet.stock
    # of parts: a plate, a block under every face, a bar of every post with 30 mm to hold it by
    volume = a * b * (upright.base.thickness + 10.0)
    for patch in upright.patches:
        high = patch.point(patch.grid(2.0))[:, 2].max() - upright.base.thickness + 10.0
        volume += np.prod([2.0 * half + 10.0 for half in patch.half_size]) * high
    for ball in upright.spheres:
        bar = ball.centre[2] - ball.foot + 30.0
        volume += np.pi * (ball.foot_radius + 1.0) ** 2 * bar
    assert parts.stock == pytest.approx(upright.material.density * volume)
    assert billet.hours["milling"].value > 3.0 * SET_UP.value
    programs = len(upright.patches) + 1  # one turns all posts
    more = parts.hours["programming"].value - billet.hours["programming"].value
    assert more == pytest.approx(programs * PER_PART.value)
    for one in (billet, parts):
        assert one.total.value == pytest.approx(
            one.labour.value + sum(item.value for item in one.bought.values())
        )
        assert one.labour.value < one.work.value * MILLING.value * 1.3
        assert 0.05 < one.total.u / one.total.value < 0.3
        assert 3.0 < one.weeks.value < 15.0


def test_more_balls_cost_more_and_stone_is_not_milled(upright):
    fewer = replace(upright, spheres=upright.spheres[:-2])
    for less, more in zip(prices_of(fewer), prices_of(upright), strict=True):
        assert less.total.value < more.total.value
        assert less.hours["calibration"].value < more.hours["calibration"].value
    assert prices_of(replace(upright, material=Material("granite", 2.9e-6, 6.5e-6))) == ()
    assert prices_of(replace(upright, material=Material("something", 2.9e-6, 6.5e-6))) == ()
    soft, hard = (
        prices_of(replace(upright, material=Material(name)))[0] for name in ("steel", "X40Cr14")
    )
    assert "hardening" in hard.bought
    assert "hardening" not in soft.bought


def test_parts_are_made_unless_the_billet_is_clearly_cheaper(upright):
    billet, parts = prices_of(upright)
    dearer = replace(parts, labour=parts.labour + billet.total)
    assert construction_to_make((billet, dearer), True) is Construction.BILLET
    like_it = replace(billet, construction=Construction.PARTS)
    assert construction_to_make((billet, like_it), True) is Construction.PARTS
    assert construction_to_make((billet, like_it), False) is Construction.BILLET
    assert construction_to_make((), True) is Construction.BILLET
