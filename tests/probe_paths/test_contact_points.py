"""Deviations refer to where the ball met the surface, however far the machine carried it along."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from matstd.probe_paths.campaign import VirtualMachine, foot_points, simulate
from matstd.probe_paths.campaign.contact_points import at_true_contacts
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.machine import exact_tip
from matstd.twin.model import contribution
from matstd.twin.record import Run, computed_deviation
from matstd.twin.units import UM

NOISE = 1.0 * UM


@pytest.fixture(scope="module")
def probed(programs, small, chain, tmp_path_factory) -> Callable[[float], tuple[Run, Array]]:
    """Run of a machine with a quarter of a millimetre of errors, and its true balls, by noise."""
    folder = tmp_path_factory.mktemp("programs")
    paths = [p for p in programs.write(folder) if p.suffix == ".H"]
    errors = drawn_errors(Population(chain), np.random.default_rng(7))

    @cache
    def probe(noise: float) -> tuple[Run, Array]:
        machine = VirtualMachine(chain, lambda touches: contribution(errors, touches), noise=noise)
        campaign = simulate(paths, small, machine, np.random.default_rng(0))
        t = campaign.run.touches
        actual = exact_tip(chain, t.q, t.length, contribution(errors, t))
        stood = campaign.runs[0].program.heading.setup.T_table_artefact
        return campaign.run, apply(inverse(stood), actual)

    return probe


def believed(run: Run, standard) -> Run:
    """The same touches with the foot points of the believed balls."""
    t = run.touches
    point, normal = foot_points(standard, t.feature, t.ball_artefact)
    t = replace(t, point=point, normal=normal)
    return replace(run, touches=t, deviation=computed_deviation(t))


def curvature(run: Run, true_ball: Array) -> Array:
    """What deviations hold beside the displacement of the ball along their own normals, mm."""
    t = run.touches
    return run.deviation - np.einsum("ni,ni->n", t.normal, t.ball_artefact - true_ball)


def test_curvature_does_not_pass_for_a_deviation(probed, small) -> None:
    """Five touches a pose: micrometres of curvature without anchors, a hundredth of them with."""
    run, true_ball = probed(0.0)
    assert np.abs(curvature(believed(run, small), true_ball)).max() > 1.0 * UM
    assert np.abs(curvature(run, true_ball)).max() < 0.01 * UM


def test_noise_does_not_slide_a_ball_along_its_surface(probed) -> None:
    """Noise of a micrometre moves no foot point by thirty, with five touches a pose."""
    feet, noisy = (probed(noise)[0].touches.point for noise in (0.0, NOISE))
    assert 0.1 * UM < np.abs(noisy - feet).max() < 30.0 * UM


def test_a_handful_of_touches_moves_by_no_more_than_it_measured(probed, small) -> None:
    """Seven touches place not even the standard: they find their balls near where they believed."""
    run = believed(probed(0.0)[0], small)
    few = run[np.arange(len(run)) < 7]
    moved = np.linalg.norm(at_true_contacts(few, small).touches.point - few.touches.point, axis=1)
    assert moved.max() < 4.0 * np.abs(few.deviation).max()


def test_a_chip_pulls_no_other_touch_along(probed, small, chain) -> None:
    """One ball 0.3 mm off its face moves others by 0.1 mm at most, 0.25 um of curvature."""
    run = believed(probed(0.0)[0], small)
    q = run.touches.q.copy()
    q[11, chain.axis_index("Z")] += 0.3
    chipped = believed(replace(run, touches=replace(run.touches, q=q)), small)
    moved = (
        at_true_contacts(chipped, small).touches.point - at_true_contacts(run, small).touches.point
    )
    others = np.arange(len(run)) != 11
    assert abs(chipped.deviation[11] - run.deviation[11]) > 100.0 * UM
    assert np.linalg.norm(moved[others], axis=1).max() < 100.0 * UM


@pytest.mark.parametrize("wrong", [-0.1, 0.05])
def test_a_wrong_radius_moves_no_foot_point(programs, small, chain, tmp_path, wrong) -> None:
    """The set-up that imitates it would: the radius found was then off by 1 µm of 100.

    Radius and set-up by a least squares of their own, over touches of a machine without errors.
    """
    paths = [p for p in programs.write(tmp_path) if p.suffix == ".H"]
    machine = VirtualMachine(chain, radius_error=wrong)
    run = simulate(paths, small, machine, np.random.default_rng(0)).run
    t = run.touches
    turned = np.cross(t.ball_artefact, t.normal) / 100.0
    A = np.column_stack([np.ones(len(t)), t.normal, turned])
    assert np.linalg.lstsq(A, run.deviation)[0][0] == pytest.approx(wrong, abs=0.05 * UM)
