"""One entry of a contribution: what it does to the deviation and to the tip, wherever it stands."""

import numpy as np
import pytest
from made_up import made_up

from matstd.twin.machine import Contribution, Where
from matstd.twin.model import Model, Parameter, Term, columns

TINY = 1e-7
"""Size of an entry (mm, rad) whose square is below the tolerance."""


class Unit:
    """Stands for an effect: one unit of one entry at every touch."""

    kind = name = "unit"
    parameters = (Parameter("amplitude", "mm", 1.0),)

    def __init__(self, where):
        self.where = where

    def terms(self, touches):
        return (Term(0, self.where, np.ones(len(touches))),)


ENTRIES = [Where("twist", 2, 4), Where("place", 1, 3), Where("shift", 0, 1), Where("bias")]


@pytest.mark.parametrize("where", ENTRIES, ids=lambda w: w.part)
def test_signature_is_what_the_exact_chain_does(where) -> None:
    touches = made_up("hsm600u")
    effect = Unit(where)
    exact = Model(touches.chain, (effect,)).deviation(touches, np.array([TINY])) / TINY
    assert np.abs(touches.signature.of(where) - exact).max() < 2e-4  # mm per mm, mm per rad
    assert np.array_equal(columns([effect], touches)[:, 0], touches.signature.of(where))


@pytest.mark.parametrize("where", ENTRIES, ids=lambda w: w.part)
def test_reach_is_the_tip_against_the_standard(where) -> None:
    touches = made_up("fork")
    model = Model(touches.chain, (Unit(where),))
    against = touches.reach.of(where)
    assert np.array_equal(model.relative_columns(touches)[:, :, 0], against)
    moves_tip = where.part in ("twist", "place")
    tip = model.tip_columns(touches)[:, :, 0]
    assert np.array_equal(tip, against) if moves_tip else not tip.any()
    # the standard that moves by +y leaves the tip behind by -y; a probe's bias moves nothing
    if where.part == "shift":
        assert np.array_equal(against, np.tile([0.0, -1.0, 0.0], (len(touches), 1)))
    if where.part == "bias":
        assert not against.any()


@pytest.mark.parametrize("where", ENTRIES, ids=lambda w: w.part)
def test_adding_touches_one_entry_alone(where) -> None:
    total = Contribution.zeros(5, 4)
    total.add(where, np.arange(5.0))
    total.add(where, np.ones(5))
    assert sum(np.count_nonzero(part) for part in total) == 5
    found = {
        "twist": total.twist[:, 2, 4],
        "place": total.place[:, 1, 3],
        "shift": total.shift[:, 1],
        "bias": total.bias,
    }
    assert np.array_equal(found[where.part], np.arange(5.0) + 1.0)
