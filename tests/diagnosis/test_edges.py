"""A slip close to an edge of a set-up is offered as one, and accidents stay accidents."""

from dataclasses import replace

import numpy as np
import pytest
from marks import slow
from unchanged import answer_text

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.search.edges import unexplained_near_slip
from matstd.twin.effects.artefact import ArtefactSlip
from matstd.twin.library import parse_effect
from matstd.twin.units import UM

NOTHING = (2, "hsm600u", ())
SHIFT = np.array([6.0, -5.0, 4.0]) * UM
"""Displacement of the standard, table frame, mm."""
BESIDE = 3
"""Touches of the set-up on the short side of the slip."""


@pytest.fixture(scope="module")
def run(case):
    return case(*NOTHING).run


def in_time(touches, setup):
    """Rows of a set-up in the order of probing."""
    rows = np.flatnonzero(touches.setup == setup)
    return rows[np.argsort(touches.time[rows], kind="stable")]


def gross(touches, rows):
    bad = np.zeros(len(touches), dtype=bool)
    bad[rows] = True
    return GrossErrors(bad, np.zeros(len(touches)), np.zeros(len(touches)), 5.0)


def slipped(run, rows):
    """The run with some touches of a set-up on a standard that stands elsewhere.

    A displacement d of the standard moves its surface by ``n . d`` along the normal n.
    """
    deviation = run.deviation.copy()
    deviation[rows] += run.touches.normal_table[rows] @ SHIFT
    return replace(run, deviation=deviation)


@pytest.mark.parametrize("side", ["start", *slow("end")])
def test_a_slip_three_touches_from_an_edge_is_named(run, side, unchanged) -> None:
    rows = in_time(run.touches, 1)
    rows = rows[:BESIDE] if side == "start" else rows[-BESIDE:]
    some = ["artefact-slip", "backlash(X)", "drift", "probe-radius"]
    library = [parse_effect(name, run.touches.chain) for name in some]
    d = diagnose(slipped(run, rows), candidates=library)
    assert d.verdict is Verdict.MISSING
    (found,) = d.found
    assert found.name == "artefact-slip"
    times = run.touches.time
    before, after = (rows[-1], rows[-1] + 1) if side == "start" else (rows[0] - 1, rows[0])
    assert times[before] <= found.instant <= times[after]
    assert not d.fit.gross.rows[rows].any()
    # an error that turns the ball on its spot is wrong nowhere, by no 1e17 µrad either
    assert all(abs(region.wrong.size) < 1.0 for region in d.where if region.wrong)
    unchanged(answer_text(d))


@pytest.mark.slow
def test_the_same_touches_scattered_are_gross_errors(run) -> None:
    deviation = run.deviation.copy()
    rows = in_time(run.touches, 1)[[40, 90, 170]]
    deviation[rows] += 9.0 * UM
    library = [parse_effect(name, run.touches.chain) for name in ("artefact-slip", "drift")]
    d = diagnose(replace(run, deviation=deviation), candidates=library)
    assert d.verdict is Verdict.NONE
    assert np.flatnonzero(d.fit.gross.rows).tolist() == sorted(rows)


def test_offered_is_what_accidents_hardly_form(run) -> None:
    t = run.touches
    rows = in_time(t, 2)
    last_two = np.sort(rows[-2:])
    assert (
        np.flatnonzero(unexplained_near_slip(t, gross(t, last_two), ())).tolist()
        == last_two.tolist()
    )
    assert not unexplained_near_slip(t, gross(t, rows[100:102]), ()).any()  # not at an edge
    assert not unexplained_near_slip(t, gross(t, rows[-1:]), ()).any()  # one alone
    chips = [3, 50, 101, 155, 230, 300, 410, *last_two]
    assert not unexplained_near_slip(t, gross(t, chips), ()).any()  # with so many, chance does it


def test_what_adjoins_the_instant_of_a_slip_is_offered(run) -> None:
    t = run.touches
    rows = in_time(t, 0)
    instant = 0.5 * (t.time[rows[50]] + t.time[rows[51]])
    slip = [ScaledEffect(ArtefactSlip(float(instant)))]
    found = unexplained_near_slip(t, gross(t, rows[[48, 49, 50, 52]]), slip)
    assert np.flatnonzero(found).tolist() == sorted(rows[[48, 49, 50]])
