"""A calibrated ball on the table beside the standard: kept clear of, touched by one program."""

from dataclasses import replace

import numpy as np
import pytest
from briefs import project_with
from programs import as_read, left_log
from unchanged import facts, folded

from matstd.artefact.brief import read_project
from matstd.artefact.reach import DatumBall, Solid, Workshop
from matstd.probe_paths.campaign import ball_changes, check_moves, effective_radii
from matstd.probe_paths.control import Move, read_log
from matstd.probe_paths.emit import make_ball, make_programs
from matstd.probe_paths.linuxcnc import shortened
from matstd.probe_paths.locate import planned_again
from matstd.probe_paths.locate.beside import plan_ball
from matstd.probe_paths.plan.heading import rounded_workshop
from matstd.report.words import ball_lines
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import pose, rotation
from matstd.twin.units import DEG, NM, UM

BALL = DatumBall(x=118.0, y=20.0, z=70.0, radius=12.5, stem=5.0, low=0.0, u=0.25 * UM)


@pytest.fixture(scope="module")
def beside(plan):
    """The plan's touches where the ball stands there too."""
    return replace(plan, options=replace(plan.options, workshop=Workshop(ball=BALL)))


@pytest.fixture(scope="module")
def made(beside):
    return make_ball(plan_ball(beside, is_beside=True))


@pytest.fixture(scope="module")
def program(made, chain):
    return as_read(made, chain)


@pytest.fixture(scope="module")
def logged(program, small, chain):
    """The log on a machine, so many hours later."""

    def log(*hours, **machine):
        text = left_log(program, small, chain, *hours, **machine)
        (part,) = read_log("A.TXT", chain.rotary_axes, text)
        return part

    return log


def test_the_program_touches_the_ball_and_nothing_else(program, small, chain):
    assert {program.features[t.feature] for t in program.touches} == {"DATUM"}
    check_moves(program, small, chain)
    # by hand: with the rotary axes at zero the table frame is that of the machine, 500 mm up
    for touch in program.touches:
        assert np.all(touch.q[:2] == 0.0)
        contact = touch.q[2:5] + touch.back * touch.direction[2:5]
        ball = contact - [0.0, 0.0, 160.0] + [0.0, 0.0, 500.0]
        away = np.linalg.norm(ball - [BALL.x, BALL.y, BALL.z])
        assert away == pytest.approx(BALL.radius + 3.0, abs=2e-4)


def test_the_radius_is_compared_with_that_of_the_ball(logged, chain):
    (exact,) = effective_radii([logged()], chain, 0.2 * UM)
    assert abs(exact.excess) < 3.0 * NM
    assert 0.25 * UM < exact.u < 0.6 * UM
    part = logged(2.0, radius_error=2.0 * UM)
    # a ball that is too large meets the surface early: it seems larger by as much
    (grown,) = effective_radii([part], chain, 0.2 * UM)
    assert grown.excess == pytest.approx(2.0 * UM, abs=3.0 * NM)
    assert "datum ball at 10:00: effective radius of the probe +2.0 ± " in ball_lines(
        [], radii=[grown]
    )[0]  # fmt: skip


def test_it_does_not_mind_where_the_standard_stands(logged, small, chain):
    moved = pose(rotation(np.array([0.0, 0.0, 2e-4])), np.array([0.05, -0.04, 0.03]))
    parts = [logged(), logged(1.0, setup_error=moved)]
    (change,) = ball_changes(parts, small, chain, 0.2 * UM)
    assert change.ball == "DATUM"
    assert np.abs(change.centre).max() < 3.0 * NM
    assert abs(change.radius) < 3.0 * NM


@pytest.fixture(scope="module")
def measuring(beside, chain):
    made = make_programs(beside)
    return as_read(made, chain), made.programs[0].text


def test_program_and_log_of_the_ball_are_what_they_were(made, program, logged, unchanged):
    unchanged("\n".join([folded(made.programs[0].text), folded(facts((program.steps, logged())))]))


def test_a_workshop_is_rounded_to_what_a_program_states():
    """Lengths to 1 µm, turns to 0.001 degrees (17.18873 is 0.3 rad), the ball to 1 nm."""
    clamp = Solid("CLAMP", (20.00049, 15.00051), False, 0.1234, 30.9876, 1.00061, -2.00039, 0.3)
    ball = replace(BALL, x=118.12345678, radius=12.5000004)
    made = rounded_workshop(Workshop(bodies=(clamp,), ball=ball))
    (body,) = made.bodies
    assert body.half_size == (20.0, 15.001)
    assert (body.low, body.high, body.x, body.y) == (0.123, 30.988, 1.001, -2.0)
    assert body.turn == pytest.approx(17.189 * DEG, rel=1e-12)
    assert (made.ball.x, made.ball.radius, made.ball.u) == (118.123457, 12.5, BALL.u)


def test_programs_that_measure_keep_clear_of_it(measuring, small, chain):
    program, text = measuring
    assert "BODY DATUM DISC A+12.500 B+12.500 Z+57.500 TO+82.500" in text
    assert "BODY DATUM.STEM DISC" in text
    # a move through the ball is refused where it is stated, and only there
    begin = np.array([0.0, 0.0, BALL.x, BALL.y - 60.0, BALL.z - 340.0, 0.0])
    end = np.array([0.0, 0.0, BALL.x, BALL.y + 60.0, BALL.z - 340.0, 0.0])
    through = replace(program, steps=(Move(1, begin, None), Move(2, end, None)))
    with pytest.raises(BadFile, match="DATUM"):
        check_moves(through, small, chain)
    check_moves(
        replace(through, heading=replace(program.heading, workshop=Workshop())), small, chain
    )


def test_a_new_plan_keeps_the_ball(measuring, beside, small, chain):
    program, _ = measuring
    old = shortened([program], small, chain)
    assert [b.name for b in old.options.workshop.bodies] == ["DATUM", "DATUM.STEM"]
    again = planned_again([program], small, chain, beside.setup, BALL).options.workshop
    assert (again.ball, again.bodies) == (BALL, ())


def test_a_tilted_standard_has_no_such_ball():
    with pytest.raises(DesignError, match="expected it upright"):
        BALL.sphere(pose(rotation(np.array([0.2, 0.0, 0.0])), np.zeros(3)))


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ("at_mm = [9.0, 0.0, 70.0]\ndiameter_mm = 25.0\nstem_diameter_mm = 30.0", "less than the"),
        ("at_mm = [9.0, 0.0, 10.0]\ndiameter_mm = 25.0\nstem_diameter_mm = 9.0", "than 12.5 in z"),
        ("at_mm = [9.0, 0.0]\ndiameter_mm = 25.0\nstem_diameter_mm = 9.0", "workshop.ball.at_mm"),
    ],
)
def test_a_ball_that_cannot_be_is_one_line(keys, reason, tmp_path):
    with pytest.raises(BadFile, match=reason):
        read_project(project_with(tmp_path, f"[workshop.ball]\n{keys}\n"))


def test_the_ball_of_a_project_stands_in_the_workshop(tmp_path):
    keys = "at_mm = [118.0, 20.0, 70.0]\ndiameter_mm = 25.0\nstem_diameter_mm = 10.0"
    project = read_project(project_with(tmp_path, f"[workshop.ball]\n{keys}\n"))
    assert project.reach.workshop.ball == BALL
