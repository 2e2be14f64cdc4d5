"""A search that never has enough ends at its limit, and says so."""

import pytest

import matstd.diagnosis.search.search_loop as rounds
from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.remarks import What, noticed
from matstd.diagnosis.search import MOST_SETS, Budget
from matstd.twin.library import parse_effect

KEY = (8, "hmc1995", ("thermal-expansion(Y,scaleY)",))
LIBRARY = ("thermal-expansion(Y,scaleY)", "backlash(X)", "drift", "probe-radius", "probe-lobing")


def found_in(run):
    library = [parse_effect(name, run.touches.chain) for name in LIBRARY]
    d = diagnose(run, candidates=library)
    return [e.name for e in d.found], noticed(What.SEARCH_ENDED, sets=MOST_SETS) in d.remarks


@pytest.mark.slow
def test_a_usual_search_is_far_from_its_limit(case, monkeypatch) -> None:
    made = []

    def budget():
        made.append(Budget())
        return made[-1]

    monkeypatch.setattr(rounds, "Budget", budget)
    assert found_in(case(*KEY).run) == (["thermal-expansion(Y,scaleY)"], False)
    assert made
    assert all(0.8 * MOST_SETS < one.left < MOST_SETS for one in made)


def test_a_search_at_its_limit_ends_and_says_so(case, monkeypatch) -> None:
    monkeypatch.setattr(rounds, "Budget", lambda: Budget(0.5))
    assert found_in(case(*KEY).run[::3])[1]


def test_sets_of_a_small_run_count_for_less() -> None:
    budget = Budget()
    budget.spend(100, 4, 200)
    assert 0.1 < MOST_SETS - budget.left < 0.2


def test_large_sets_count_for_more() -> None:
    small, large = Budget(), Budget()
    small.spend(800, 6, 1600)
    large.spend(20_000, 170, 1000)
    assert MOST_SETS - small.left < 1.01
    assert MOST_SETS - large.left > 10.0
