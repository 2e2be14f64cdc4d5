"""Rank and gauge freedoms: hand-worked machines, central differences, reference ranks."""

import numpy as np
import pytest

from matstd.information.identifiability import (
    Resolution,
    combinations,
    identifiability,
    in_families,
    rank_analysis,
)
from matstd.information.identifiability.freedoms import Reason
from matstd.information.identifiability.nullspace import sparse
from matstd.information.identifiability.separation import Group, _groups
from matstd.report.identifiability import family_words, freedom_words
from matstd.sensitivity.first_order import Workspace, latin_hypercube
from matstd.sensitivity.population import Population
from matstd.twin.machine import Axis, exact_tip, make_chain, tip
from matstd.twin.model import Model
from matstd.twin.record import at_poses

SHAPES = ("linear", "parabolic", "sine", "cosine")
EACH_SHAPE = f"(in each shape: {', '.join(SHAPES)})"
LENGTHS = (100.0, 160.0, 240.0)
SMALL = 1e-4
"""Size of parameters in central differences, in expected sizes: far above rounding."""

LINEAR = {axis: Axis(range=(-200.0, 200.0)) for axis in "XYZ"}
HEADS = {
    "three axes": ("[w X' f Y Z t]", LINEAR),
    "table/table": (
        "[w C' B' X' f Y Z (C1) t]",
        {**LINEAR, "B": Axis((-1.9, 0.5), (0.0, 0.0, -420.0)), "C": Axis((-6.3, 6.3))},
    ),
    "table/head": (
        "[w C' f X Y Z B (C1) t]",
        {**LINEAR, "B": Axis((-1.7, 1.7)), "C": Axis((-6.3, 6.3))},
    ),
    "head/head": (
        "[w f X Y Z C B (C1) t]",
        {**LINEAR, "B": Axis((-1.7, 1.7)), "C": Axis((-6.3, 6.3))},
    ),
}


def machine(name):
    notation, axes = HEADS[name]
    return make_chain(name, notation, axes, (0.0, 0.0, -500.0))


def poses(chain, count=250):
    return latin_hypercube(Workspace(chain, {}, 160.0), count, np.random.default_rng(0))


def rows(model, q, length):
    return model.tip_columns(at_poses(model.chain, q, length)).reshape(3 * len(q), -1)


def found_on(name):
    chain = machine(name)
    model, q = Population(chain).model, poses(chain)
    W = rows(model, q, 160.0) * model.prior_sd
    other = rows(model, q, np.resize(LENGTHS, len(q))) * model.prior_sd
    richer = {"a second stylus length": other}
    found = identifiability(W, model.prior_sd, model.names, model.parameters, chain, richer)
    return model, q, found


@pytest.fixture(scope="module", params=list(HEADS))
def case(request):
    return (request.param, *found_on(request.param))


def test_rank_is_that_of_central_differences_of_the_exact_machine(case):
    _, model, q, found = case
    touches = at_poses(model.chain, q, 160.0)
    nominal = tip(model.chain, q, 160.0)
    columns = []
    for p, sd in enumerate(model.prior_sd):
        theta = np.zeros(len(model.prior_sd))
        theta[p] = SMALL * sd
        ends = [
            exact_tip(model.chain, q, 160.0, model.contribution(touches, sign * theta)) - nominal
            for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]).ravel() / (2.0 * SMALL))
    D = np.array(columns).T
    length = np.linalg.norm(D, axis=0)
    loud = length > 1e-6 * length.max()
    s = np.linalg.svd(D[:, loud] / length[loud], compute_uv=False)
    assert found.rank == int(np.sum(s > 1e-6 * s[0]))
    assert found.rank + len(found.freedoms) == found.parameters


def test_every_freedom_is_one_and_they_are_independent(case):
    _, model, q, found = case
    A = rows(model, q, 160.0)
    place = {name: p for p, name in enumerate(model.names)}
    vectors = []
    for freedom in found.freedoms:
        z = np.zeros(len(place))
        z[place[freedom.parameter]] = 1.0
        for name, value in freedom.values.items():
            z[place[name]] = -value
        moved = np.linalg.norm(A * z, axis=0).max()
        assert np.linalg.norm(A @ z) <= 1e-7 * max(moved, 1e-6 * np.linalg.norm(A, axis=0).max())
        vectors.append(z / model.prior_sd / np.linalg.norm(z / model.prior_sd))
    if vectors:
        assert np.linalg.matrix_rank(np.array(vectors), tol=1e-9) == len(vectors)


def test_words_are_those_worked_by_hand(case):
    name, model, _, found = case
    words = {freedom_words(f, model.chain): f for f in found.freedoms}
    # -EC0Y y in X: over a range of 200 mm each way a linear straightness of -0.2 um a urad
    straightness = "- 0.2 µm of linear straightness of Y in X (EXY)"
    squareness = f"1 µrad of squareness of Y about Z (EC0Y) = {straightness}"
    assert words[squareness].resolution is Resolution.NEVER
    assert words[squareness].reason is Reason.SQUARENESS
    if name in ("three axes", "table/table"):  # the ball hangs 160 mm below Z, which ends the chain
        tilt = words[
            "1 µrad of linear tilt of Z about Y (EBZ) = "
            "- 0.16 µm of linear straightness of Z in X (EXZ)"
        ]
        assert tilt.resolved_by == "a second stylus length"
        preset = words["displacement of the tool along Z (EZ0t) = zero position of Z (EZ0Z)"]
        assert preset.resolution is Resolution.NEVER
        roll = words["linear roll of Z (ECZ) moves no touch"]
        assert roll.resolution is Resolution.SIDEWAYS
        families = in_families(found.freedoms)
        lines = {family_words(family, model.chain): family.count for family in families}
        assert lines[f"roll of Z (ECZ) moves no touch {EACH_SHAPE}"] == len(SHAPES)
        family = "1 µrad of tilt of Z about Y (EBZ) = - 0.16 µm of straightness of Z in X (EXZ)"
        assert lines[f"{family} {EACH_SHAPE}"] == len(SHAPES)
        assert sum(lines.values()) == len(found.freedoms)
    if name in ("table/table", "table/head"):  # C ends the chain on the side of the standard
        assert "rotation of the workpiece about Z (EC0w) = - zero position of C (EC0C)" in words


def test_three_axes_by_counting_monomials():
    """Linear errors of `[w X' f Y Z t]` against the textbook's 21 errors, written out.

    Every axis has three displacements and three rotations about a point that travels with it,
    proportional to its reading; the arm is from that point to the ball. Squarenesses, zeros, set-up
    and tool add constants, slopes and a rotation of the whole.
    """
    chain = machine("three axes")
    every = Population(chain).model
    kept = tuple(
        e for e in every.effects if e.name.startswith("location") or e.name.endswith(",linear)")
    )
    model, q = Model(chain, kept), poses(chain)
    found = rank_analysis(rows(model, q, 160.0) * model.prior_sd)
    x, y, z = (q[:, chain.axis_index(a)] for a in "XYZ")
    one, zero = np.ones(len(q)), np.zeros(len(q))
    tool, up = np.stack([x, y, z - 160.0]), np.eye(3)
    ball = z - 160.0
    hangs = np.stack([zero, zero, -160.0 * one])
    arms = (np.stack([zero, y, ball]), np.stack([zero, zero, ball]), hangs)
    fields = []
    for reading, arm in zip((x, y, z), arms, strict=True):
        fields += [reading * e[:, None] for e in up]
        fields += [reading * np.cross(e, arm.T).T for e in up]
    fields += [one * e[:, None] for e in up]  # zeros, set-up, tool
    fields += [np.cross(e, tool.T - np.array([0.0, 0.0, -500.0])).T for e in up]  # set-up turned
    fields += [z * up[0][:, None], z * up[1][:, None], y * up[0][:, None], x * up[1][:, None]]
    M = np.array([f.ravel() for f in fields]).T
    M = M[:, np.linalg.norm(M, axis=0) > 0.0]
    assert found.rank == np.linalg.matrix_rank(M / np.linalg.norm(M, axis=0), tol=1e-9)


def test_a_second_stylus_adds_what_hangs_on_the_ram():
    """On the table/table machine the tilts of Z: about X and Y, in four distributions each."""
    model, q, found = found_on("table/table")
    resolved = [f for f in found.freedoms if f.resolved_by == "a second stylus length"]
    tilts = [f for f in resolved if "tilt of Z" in freedom_words(f, model.chain)]
    assert len(tilts) == 8
    more = rows(model, q, np.resize(LENGTHS, len(q))) * model.prior_sd
    assert rank_analysis(more).rank == found.rank + len(resolved)


def test_sparse_directions_are_found_again():
    """Planted: three null directions of two, three and one members among twelve parameters."""
    rng = np.random.default_rng(3)
    planted = np.zeros((3, 12))
    planted[0, [1, 4]] = 1.0, -2.0
    planted[1, [4, 6, 9]] = 1.0, 0.5, -3.0
    planted[2, 11] = 1.0
    W = rng.normal(size=(40, 12)) @ (np.eye(12) - np.linalg.pinv(planted) @ planted)
    got = sparse(rank_analysis(W).null)
    found = sorted(np.flatnonzero(z).tolist() for _, z in got)
    # 1 in place of 4 makes a triple as small
    assert found in ([[1, 4], [4, 6, 9], [11]], [[1, 4], [1, 6, 9], [11]])
    pair = next(z for _, z in got if np.count_nonzero(z) == 2)
    assert pair[4] / pair[1] == pytest.approx(-2.0, rel=1e-6)


def test_combinations_have_the_textbooks_uncertainty():
    rng = np.random.default_rng(5)
    W, sd = rng.normal(size=(30, 4)), np.array([1.0, 2.0, 0.5, 1.0])
    covariance = np.diag(sd) @ np.linalg.inv(np.eye(4) + W.T @ W) @ np.diag(sd)
    for c in combinations(W, sd, ["mm"] * 4):
        assert c.u == pytest.approx(np.sqrt(c.weights @ covariance @ c.weights), rel=1e-9)
        prior = np.sqrt(np.sum((c.weights * sd) ** 2))
        assert c.gain == pytest.approx(prior / c.u, rel=1e-9)


def test_confounded_groups_are_named_the_largest_first() -> None:
    """a - b is invisible, c + d - 2 e is, and f by itself: by hand."""
    null = np.array([[1, -1, 0, 0, 0, 0], [0, 0, 1, 1, -2, 0], [0, 0, 0, 0, 0, 1]], dtype=float)
    assert _groups(null, "abcdef") == (Group(("c", "d", "e"), 2), Group(("a", "b"), 1))
