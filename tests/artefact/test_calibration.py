"""Features known as well as their calibration: columns, averages over them, and what stays."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from matstd.artefact.layout import Blank
from matstd.artefact.worth import (
    Calibration,
    ball_choice,
    each_at,
    face_grid,
    poses_within,
    sphere_grid,
)
from matstd.information.criteria import Posterior
from matstd.twin.errors import DesignError
from matstd.twin.frames import apply, fixed_xyz, pose
from matstd.twin.units import DEG, NM, UM

ALGEBRA = 1e-8  # relative: a marginal by a Cholesky factor against a block of an inverse


@pytest.fixture(scope="module")
def touches(standard):
    patch, sphere = standard.patches[0], standard.spheres[0]
    poses = np.array([[-60.0], [0.0], [80.0]]) * DEG
    on_patch = each_at(patch, face_grid(patch.half_size, 4), poses)
    on_sphere = each_at(sphere, sphere_grid(12), poses)
    return type(on_patch)(
        *(
            np.concatenate([getattr(t, f) for t in (on_patch, on_sphere)])
            for f in ("feature", "point", "normal", "rotary")
        )
    )


def test_columns_of_a_patch_are_its_displacements_along_the_normals(standard, touches):
    """The patch is moved and turned as a whole; a touch along the normal meets it so much later."""
    patch, sd = standard.patches[0], Calibration()
    mine = touches[touches.feature == patch.name]
    found = sd.columns(standard, mine)
    assert found.shape == (len(mine), 6 * len(standard.patches) + 3 * len(standard.spheres))
    rng = np.random.default_rng(1)
    amount = rng.normal(size=6) * 10.0
    centre = patch.T_artefact_patch[:3, 3]
    turn = pose(fixed_xyz(amount[3:] * sd.patch_tilt))
    moved = apply(turn, mine.point - centre) + centre + amount[:3] * sd.patch
    expected = np.einsum("ni,ni->n", moved - mine.point, mine.normal)
    # the remainder is of second order: (1e-4 rad)^2 / 2 of 30 mm
    np.testing.assert_allclose(found[:, :6] @ amount, expected, atol=0.5 * NM)
    assert not found[:, 6:].any()


def test_columns_of_a_sphere_are_the_shifts_of_its_centre(standard, touches):
    mine = touches[touches.feature == standard.spheres[0].name]
    found = Calibration(ball=2.0 * UM).columns(standard, mine)
    first = 6 * len(standard.patches)
    np.testing.assert_allclose(found[:, first : first + 3], 2.0 * UM * mine.normal, rtol=1e-12)
    assert not np.delete(found, np.s_[first : first + 3], axis=1).any()


def test_rows_that_average_over_the_places_know_what_the_joint_estimate_knows(
    criterion, standard, touches
):
    here = criterion.on(standard)
    W, C = here.whitened(touches), here.calibrated(touches)
    both, P = np.concatenate([W, C], axis=1), W.shape[1]
    joint = np.linalg.inv(np.eye(both.shape[1]) + both.T @ both)[:P, :P]
    known = here.known_rows(touches)
    alone = np.linalg.inv(np.eye(P) + known.T @ known)
    np.testing.assert_allclose(alone, joint, rtol=ALGEBRA, atol=ALGEBRA * np.diag(joint).max())


def test_the_criterion_counts_what_the_places_hide(criterion, standard, touches):
    here = criterion.on(standard)
    rows = here.rows(touches)
    after = Posterior(here.known_rows(touches), here.prior_sd, here.model.names)
    tips = np.concatenate([here.tip_volume, here.tip_user])
    expected = np.mean(after.predicted_sd(tips) ** 2)
    assert here.objective.value(rows.T @ rows) == pytest.approx(expected, rel=1e-6)
    plain = criterion.rows(touches)
    assert here.objective.value(rows.T @ rows) > criterion.objective.value(plain.T @ plain)


def test_an_exact_calibration_changes_nothing(criterion, standard, touches):
    exact = replace(criterion, calibration=Calibration(0.0, 0.0, 0.0)).on(standard)
    np.testing.assert_array_equal(exact.rows(touches), criterion.rows(touches))
    np.testing.assert_allclose(exact.known_rows(touches), exact.whitened(touches), rtol=1e-12)
    with pytest.raises(DesignError, match="from zero up"):
        Calibration(patch=-1.0 * UM)


def test_placed_balls_stand_apart_and_beat_balls_anywhere(criterion, monkeypatch):
    monkeypatch.setattr(ball_choice, "_PLACES", 150)
    blank, rng = Blank(), np.random.default_rng(3)
    poses = poses_within(criterion.reach.chain, criterion.rotary, 12)
    places = ball_choice.ball_places(criterion, blank, poses, rng)

    def left(spheres):
        """Criterion after the same directions on every sphere at the same few poses."""
        touches = [each_at(s, sphere_grid(12), poses[::9]) for s in spheres]
        W = np.concatenate([criterion.rows(t) for t in touches]) / np.sqrt(len(spheres))
        return criterion.objective.value(W.T @ W)

    found = {count: places.best(count, 160) for count in (4, 7)}
    for count, balls in found.items():
        assert len(balls) == count
        for one, other in combinations(balls, 2):
            across = np.linalg.norm(one.centre[:2] - other.centre[:2])
            assert across >= one.foot_radius + other.foot_radius + 12.0
            assert across >= 2.0 * (12.5 + 3.0) + 1.0
        assert max(np.abs(b.centre[:2]).max() + b.radius for b in balls) < 140.0
    anywhere = [
        left([places.balls[k] for k in rng.choice(len(places.balls), 4, replace=False)])
        for _ in range(20)
    ]
    assert left(found[4]) < np.median(anywhere)
    barred = np.array([b.centre[0] > 0.0 for b in places.balls])
    free = places.best(4, 160, ~barred[places.group])  # touches on the others are in the way
    assert all(b.centre[0] <= 0.0 for b in free)
