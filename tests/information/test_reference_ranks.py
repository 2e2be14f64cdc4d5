"""Ranks that others found, by models that were written without this code.

The first is a small numpy model of the table/table machine. Its linear axes and B have Legendre
polynomials up to degree n, constants included, C has K harmonics; six numbers of the set-up and
three of the stylus are free. The others are the ranks that a simulator of measurements states of
its own ordinary model: several set-ups, linear, parabolic and sinusoidal errors.
"""

import numpy as np
import pytest

from matstd.information.identifiability import rank_analysis
from matstd.sensitivity.first_order import Workspace, latin_hypercube
from matstd.sensitivity.population import Population
from matstd.twin.effects import ComponentError, HigherOrder, LocationError
from matstd.twin.machine import Axis, Family, make_chain
from matstd.twin.model import Model
from matstd.twin.record import at_poses
from matstd.twin.units import DEG

RANKS = {
    (1, 1): (66, 39),
    (2, 1): (90, 59),
    (3, 2): (126, 91),
    (4, 3): (162, 123),
    (5, 3): (186, 143),
}
"""Degree n and harmonics K: coefficients of the machine, rank with the nine others."""

SEVERAL_LENGTHS = 99
"""Rank at degree 3 with three stylus lengths, each with the same three offsets."""

STATED = {"[w C' B' X' f Y Z (C1) t]": (3, 95), "[w C' X' f Y Z B (C1) t]": (3, 109)}
"""Number of set-ups and rank, as the simulator of measurements states them of its machines."""

LENGTHS = (100.0, 160.0, 240.0)


@pytest.fixture(scope="module")
def chain():
    axes = {
        "X": Axis((-210.0, 210.0)),
        "Y": Axis((-145.0, 145.0)),
        "Z": Axis((-420.0, 0.0)),
        "B": Axis((-100.0 * DEG, 20.0 * DEG), (0.0, 0.0, -420.0)),
        "C": Axis((-180.0 * DEG, 180.0 * DEG)),
    }
    return make_chain("table/table", "[w C' B' X' f Y Z t]", axes, (0.0, 0.0, -500.0))


def reference_model(chain, degree, harmonics):
    """Polynomials and harmonics with their constants; set-up and stylus offset."""
    effects, machine = [], 0
    for symbol in chain.symbols:
        if symbol.family is Family.COMPONENT:
            is_c = symbol.link == "C"
            higher = HigherOrder(symbol, harmonics if is_c else degree, 1.0, rotary=is_c)
            effects += [ComponentError(symbol, "constant"), higher]
            machine += 1 + len(higher.parameters)
        elif symbol.link == "w" or (symbol.link == "t" and not symbol.is_angular):
            effects.append(LocationError(symbol))
    return Model(chain, tuple(effects)), machine


def rows(model, lengths):
    q = latin_hypercube(Workspace(model.chain, {}, 160.0), 300, np.random.default_rng(4))
    touches = at_poses(model.chain, q, np.resize(lengths, len(q)))
    return model.tip_columns(touches).reshape(3 * len(q), -1)


@pytest.mark.parametrize(("order", "expected"), RANKS.items())
def test_rank_is_that_of_the_reference(chain, order, expected):
    model, machine = reference_model(chain, *order)
    assert machine == expected[0]
    assert len(model.parameters) == machine + 9
    assert rank_analysis(rows(model, [160.0])).rank == expected[1]


def test_several_stylus_lengths_show_what_the_reference_says(chain):
    model, _ = reference_model(chain, 3, 2)
    assert rank_analysis(rows(model, LENGTHS)).rank == SEVERAL_LENGTHS


@pytest.mark.parametrize(("notation", "expected"), STATED.items())
def test_every_set_up_more_adds_six(notation, expected):
    """One set-up shows 83 combinations of the table/table machine; that is 95 - 2 x 6."""
    axes = {a: Axis((-300.0, 300.0)) for a in "XYZ"}
    axes |= {"B": Axis((-1.6, 0.4), (0.0, 0.0, -420.0)), "C": Axis((-6.3, 6.3))}
    model = Population(make_chain("other", notation, axes, (0.0, 0.0, -500.0))).model
    q = latin_hypercube(Workspace(model.chain, {}, 160.0), 300, np.random.default_rng(4))
    A = model.tip_columns(at_poses(model.chain, q, 160.0))
    setups, rank = expected
    of_w = [p for p, (e, _) in enumerate(model.parameters) if e.symbol.link == "w"]
    parts = [A]
    for setup in range(1, setups):  # its own place, beside that of the first
        own = A[:, :, of_w] * (np.arange(len(q)) % setups == setup)[:, None, None]
        parts.append(own)
    W = np.concatenate(parts, axis=2).reshape(3 * len(q), -1)
    assert rank_analysis(A.reshape(3 * len(q), -1)).rank == rank - 6 * (setups - 1)
    assert rank_analysis(W).rank == rank
