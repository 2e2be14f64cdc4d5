"""Regions in words: their poses lie where the words say, their shares are those of closed sums."""

import numpy as np
import pytest
from machines import LATHE, LENGTH, none_but

from matstd.report.maps import draw_regions
from matstd.report.words import dominant_words, place_words
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.shares import region_totals, regions
from matstd.twin.machine import tip
from matstd.twin.units import DEG, UM


@pytest.fixture(scope="module")
def found(chain, workspace):
    return regions(Population(chain), workspace)


def named(found, words):
    (one,) = [r for r in found if place_words(r.place).startswith(words)]
    return one


def test_poses_lie_where_the_words_say(found, chain):
    assert [place_words(r.place) for r in found] == [
        "whole workspace",
        "middle: X, Y and Z in their middle third",
        "corners: X, Y and Z in their outer sixths",
        "B from -90° to -72°",
        "B from 2° to 20°",
        "C within 15° of 0°",
        "C within 15° of 90°",
        "C within 15° of 180°",
    ]
    column = {a: chain.axis_index(a) for a in chain.axes}
    middle = named(found, "middle").q
    assert np.all(np.abs(middle[:, column["X"]]) <= 50.0)
    assert np.all(np.abs(middle[:, column["Z"]] + 275.0) <= 125.0 / 3.0)
    corners = named(found, "corners").q
    assert np.all(np.abs(corners[:, column["Y"]]) >= 100.0)
    assert np.any(corners[:, column["Y"]] < 0.0)
    assert np.any(corners[:, column["Y"]] > 0.0)
    low = named(found, "B from -90°").q[:, column["B"]] / DEG
    assert -90.0 <= low.min() < -89.0
    assert -73.0 < low.max() <= 1e-9 - 71.66
    around = named(found, "C within 15° of 180°").q[:, column["C"]] / DEG
    assert np.all((around >= 165.0) & (around <= 180.0))
    # evenly over the whole: every tenth of a travel has its share of the poses
    counts = np.histogram(found[0].q[:, column["X"]], 10, (-150.0, 150.0))[0]
    assert counts.min() > 15


def test_shares_sum_to_one_and_follow_the_displaced_c_line(found, chain):
    names = [s.name for s in chain.symbols]
    i = names.index("EX0C")
    for region in found:
        assert region.mean_shares.sum() == pytest.approx(1.0)
        np.testing.assert_allclose(region.shares.sum(axis=1), 1.0)
    # S of EX0C is 2 sin(C/2): nothing at C = 0, most at 180 degrees
    assert named(found, "C within 15° of 0°").mean_shares[i] < 0.005
    assert set(named(found, "C within 15° of 180°").largest(2)) == {i, names.index("EY0C")}


def test_shares_of_two_constants_by_hand():
    # Displaced zeros of 3 and 4 um, nothing else: 9 and 16 of 25 everywhere, 5 um rms.
    ranges = none_but(EX0X=(3 * UM, 3 * UM), EZ0Z=(4 * UM, 4 * UM))
    names = [s.name for s in LATHE.symbols]
    all_of_them = regions(Population(LATHE, ranges), Workspace(LATHE, {}, 50.0))
    assert len(all_of_them) == 3  # no rotary axis
    for region in all_of_them:
        assert region.rms == pytest.approx(5 * UM)
        assert region.mean_shares[names.index("EX0X")] == pytest.approx(9 / 25)
        assert dominant_words(region, names) == "EZ0Z causes 64 % of the variance"
    words = dominant_words(all_of_them[0], names, enough=0.9)
    assert words == "EZ0Z 64 %, EX0X 36 %: together 100 % of the variance"


def test_the_only_error_makes_all_of_the_length():
    # Jansen's index of the one error there is: mean (f(a) - f(b))^2 / (2 Var f) = 1 on average.
    area = Workspace(LATHE, {}, 50.0)
    population = Population(LATHE, none_but(EX0X=(1 * UM, 9 * UM)))
    found = regions(population, area)
    totals = region_totals(population, area, found, np.random.default_rng(3), machines=4000)
    i = [s.name for s in LATHE.symbols].index("EX0X")
    assert totals.total.shape == totals.u.shape == (3, len(LATHE.symbols))
    np.testing.assert_allclose(totals.total[:, i], 1.0, atol=4.0 * totals.u[0, i])
    assert 0.0 < totals.u[0, i] < 0.03
    assert np.all(np.delete(totals.total, i, axis=1) == 0.0)


def test_diamonds_stand_at_the_total_effects(found, chain, workspace):
    totals = region_totals(
        Population(chain), workspace, found[:2], np.random.default_rng(3), machines=100
    )
    panel = draw_regions(chain, found[:2], totals).axes[1]
    (markers,) = [line for line in panel.lines if line.get_marker() == "D"]
    expected = 100.0 * totals.total[1, found[1].largest(8)]
    np.testing.assert_allclose(markers.get_xdata(), expected)
    low, high = panel.get_xlim()
    assert low <= 0.0
    assert high > expected.max()


def test_a_machine_without_errors_is_named(chain, workspace):
    nothing = regions(Population(chain, none_but()), workspace)
    assert "no error displaces the tool point" in dominant_words(nothing[0], [])
    assert "No error" in draw_regions(chain, nothing).texts[0].get_text()


def test_poses_stay_in_the_volume_of_a_workspace(chain, workspace):
    box = ((-60.0, -60.0, 20.0), (60.0, 60.0, 120.0))
    area = Workspace(chain, workspace.limits, LENGTH, box)
    for region in regions(Population(chain), area):
        p = tip(chain, region.q, LENGTH)
        assert np.all((p >= np.array(box[0])) & (p <= np.array(box[1])))


def test_the_tornado_holds_the_shares_in_percent(found, chain):
    drawn = draw_regions(chain, found)
    panels = [a for a in drawn.axes if a.patches]
    assert len(panels) == len(found)
    for axes, region in zip(panels, found, strict=True):
        order = region.largest(8)
        widths = [bar.get_width() for bar in axes.patches]
        np.testing.assert_allclose(widths, 100.0 * region.mean_shares[order])
        labels = [t.get_text() for t in axes.get_yticklabels()]
        assert labels == [chain.symbols[i].name for i in order]
        title = axes.get_title(loc="left")
        assert title == f"{place_words(region.place)}\n{region.rms / UM:.0f} µm rms"
    assert panels[-1].get_xlabel() == "share of the variance in %"
    ends = [100.0 * np.quantile(r.shares[:, r.largest(1)], 0.95) for r in found]
    assert max(ends) < panels[0].get_xlim()[1] < 1.2 * max(ends)
