"""The same ball before and after: what has moved, what the probe has lost, and how surely."""

from dataclasses import replace
from datetime import timedelta
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from programs import as_read, left_log, ran
from unchanged import facts, folded

from matstd.artefact.body import write_standard
from matstd.artefact.tool import home_readings
from matstd.probe_paths.campaign import VirtualMachine, ball_changes, check_changes, check_moves
from matstd.probe_paths.control import read_log
from matstd.probe_paths.emit import make_ball
from matstd.probe_paths.locate.beside import plan_ball
from matstd.report.words import ball_lines
from matstd.twin.errors import BadFile, DesignError, NotReachable
from matstd.twin.frames import pose
from matstd.twin.units import NM, UM


@pytest.fixture(scope="module")
def ball(plan):
    return plan_ball(plan)


@pytest.fixture(scope="module")
def program(ball, chain):
    return as_read(make_ball(ball), chain)


@pytest.fixture(scope="module")
def logged(program, small, chain):
    """The log that the program leaves on a machine, so many hours later."""
    return partial(left_log, program, small, chain)


@pytest.fixture(scope="module")
def part(logged, chain):
    (one,) = read_log("MS_A_CAL.TXT", chain.rotary_axes, logged())
    return one


def test_it_goes_all_round_one_ball_in_one_visit_and_hits_nothing(
    ball, program, small, plan, chain
):
    assert len(ball.visits) == 1
    assert set(ball.feature) == {"SPH1"}
    assert len(ball) == 8
    assert np.array_equal(ball.visits[0].rotary, home_readings(chain))
    assert np.linalg.matrix_rank(np.column_stack([ball.normal, np.ones(8)]), tol=0.3) == 4
    check_moves(program, small, chain)


def test_a_ball_that_moved_and_a_radius_that_grew_are_separated(logged, part, small, golden, chain):
    moved = np.array([5.0, -3.0, 8.0]) * UM
    text = logged(2.0, setup_error=pose(np.eye(3), moved), radius_error=2.0 * UM)
    (after,) = read_log("MS_A_CAL.TXT", chain.rotary_axes, text)
    (change,) = ball_changes([after, part], small, chain, 1.0 * UM)
    expected = golden.setup().T_table_artefact[:3, :3] @ moved
    # the log keeps six decimals; a ball of 10 mm bends by 2 nm over 8 µm
    assert np.abs(change.centre - expected).max() < 10.0 * NM
    assert abs(change.radius - 2.0 * UM) < 10.0 * NM
    assert change.hours == pytest.approx(2.0)
    assert change.touches == 8
    assert change.scatter < 10.0 * NM


def test_the_program_and_a_change_are_what_they_were(
    ball, program, logged, part, small, chain, unchanged
):
    later = logged(2.0, setup_error=pose(np.eye(3), np.full(3, 4.0 * UM)), radius_error=2.0 * UM)
    (after,) = read_log("MS_A_CAL.TXT", chain.rotary_axes, later)
    parts = facts(ball_changes([after, part], small, chain, 1.0 * UM))
    unchanged(
        "\n".join([make_ball(ball).programs[0].text, folded(facts(program.steps)), later, parts])
    )


def test_uncertainties_cover_what_noise_does(part, small, chain):
    rng, u, off = np.random.default_rng(1), 0.8 * UM, []
    for _ in range(300):
        noisy = [
            replace(
                part,
                xyz=part.xyz + rng.normal(0.0, 1.0, (8, 1)) * u * _normals(part, small, chain),
                begin=part.begin + timedelta(hours=h),
            )
            for h in (0, 1)
        ]
        (change,) = ball_changes(noisy, small, chain, u)
        off.append([*change.centre, change.radius] / change.u)
    # a scatter above the stated noise makes u larger, by chance too: a little below one
    assert np.all(np.abs(np.sqrt(np.mean(np.square(off), axis=0)) - 0.9) < 0.12)


def _normals(part, small, chain):
    """From the ball's centre to where the probe stood, by the log's own numbers alone."""
    middle = np.linalg.lstsq(
        np.column_stack([2.0 * part.xyz, np.ones(8)]), (part.xyz**2).sum(axis=1), rcond=None
    )[0][:3]
    way = part.xyz - middle
    return way / np.linalg.norm(way, axis=1, keepdims=True)


def test_a_change_beyond_the_limit_is_refused_and_dirt_is_reported(part, small, chain):
    later = part.begin + timedelta(hours=1)
    shifted = replace(part, xyz=part.xyz + np.array([0.02, 0.0, 0.0]), begin=later)
    changes = ball_changes([part, shifted], small, chain, 1.0 * UM)
    with pytest.raises(DesignError, match=r"by 20\.0 µm, expected 10 µm at most: measure again"):
        check_changes(changes, 10.0 * UM)
    check_changes(changes, 30.0 * UM)
    one = part.xyz.copy()
    one[3] += 0.06 * _normals(part, small, chain)[3]
    (dirty,) = ball_changes([part, replace(part, xyz=one, begin=later)], small, chain, 1.0 * UM)
    check_changes([dirty], 100.0 * UM)
    assert dirty.is_odd
    assert "dirt on the ball or a loose stylus" in ball_lines([dirty])[-1]


def test_too_few_touches_in_common_and_touches_on_one_side_are_refused(part, small, chain):
    later = part.begin + timedelta(hours=1)
    few = replace(part, number=part.number + 5, begin=later)
    with pytest.raises(BadFile, match="3 touches in common"):
        ball_changes([part, few], small, chain, UM)
    beside = replace(part, xyz=part.xyz[[0] * 8], begin=later)
    with pytest.raises(BadFile, match="8 touches on one side of SPH1"):
        ball_changes([replace(beside, begin=part.begin), beside], small, chain, UM)


def test_no_ball_no_program(plan):
    bare = replace(plan, standard=replace(plan.standard, spheres=()))
    with pytest.raises(NotReachable, match="no ball of SMALL-1"):
        plan_ball(bare)


def test_evaluate_reports_the_change_and_refuses_beyond_the_limit(
    logged, programs, read, small, chain, golden, tmp_path, answer, refusal
):
    run = ran(read[0], small, VirtualMachine(chain))
    folder = tmp_path
    for name, text in run.log.items():
        (folder / name).write_text(text, encoding="ascii")
    later = logged(3.0, setup_error=pose(np.eye(3), np.array([0.0, 0.0, 0.015])))
    (folder / "MS_A_CAL.TXT").write_text(logged() + later, encoding="ascii")
    write_standard(folder / "standard.toml", small)
    machine = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"
    words = ["--standard", str(folder / "standard.toml"), "--machine", str(machine)]
    logs = [str(path) for path in sorted(folder.glob("*.TXT"))]
    out = folder / "run.csv"
    assert "by 15.0 µm, expected 10 µm at most" in refusal(
        ["evaluate", *logs, *words, "-o", str(out)]
    )
    assert not out.exists()
    for wrong in ("0", "-3", "nan"):
        assert "--probe-limit-um" in refusal(
            ["evaluate", *logs, *words, "--probe-limit-um", wrong, "-o", str(out)]
        )
    output = answer(["evaluate", *logs, *words, "--probe-limit-um", "40", "-o", str(out)])
    assert "ball SPH1, 08:00 to 11:00 (3.00 h, 8 touches)" in output
    assert f"{len(read[0].touches)} touches" in output
