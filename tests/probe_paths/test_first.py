"""The commissioning program: few blocks, all of them needed, and a touch that must meet nothing."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import as_read, parts_of, ran
from unchanged import facts, folded

from matstd.artefact.body import write_standard
from matstd.cli import main
from matstd.probe_paths.campaign import VirtualMachine, check_moves, read_heights
from matstd.probe_paths.control import ProbeStep
from matstd.probe_paths.emit import make_first
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.locate.beside import plan_ball
from matstd.twin.errors import BadFile, DesignError, NotReachable
from matstd.twin.frames import pose
from matstd.twin.units import NM


@pytest.fixture(scope="module")
def made(plan):
    return make_first(plan_ball(plan))


@pytest.fixture(scope="module")
def reads(made, small, chain):
    """Reads a text as the program, and looks at its moves."""

    def read(text):
        program = as_read(made, chain, text=text)
        check_moves(program, small, chain)
        return program

    return read


@pytest.fixture(scope="module")
def program(made, reads):
    return reads(made.programs[0].text)


def test_the_program_is_what_it_was(made, program, unchanged):
    unchanged("\n".join([folded(made.programs[0].text), folded(facts(program.steps))]))


def test_it_has_less_than_a_hundred_blocks_a_touch_in_the_air_and_one_on_a_ball(made, program):
    (one,) = made.programs
    assert one.blocks == len([s for s in one.text.split("\r\n") if s and s[0] != " "]) < 100
    assert list(made.masks) == [f"{one.name}.A"]
    air, ball = (step for step in program.steps if isinstance(step, ProbeStep))
    assert air.is_air
    assert not ball.is_air
    assert np.array_equal(air.direction, ball.direction)
    assert program.features[ball.feature] == "SPH1"


def test_the_place_above_the_ball_is_tested_in_machine_coordinates(made):
    """By hand: (60, 60) turned by 0.35 rad about (12, -8), before Z goes down for the first time.

    A preset, a datum shift, a rotation, a mirror image or a scaling would move X or Y there.
    """
    x = 60.0 * np.cos(0.35) - 60.0 * np.sin(0.35) + 12.0
    y = 60.0 * np.sin(0.35) + 60.0 * np.cos(0.35) - 8.0
    text = "\n".join(line.partition(" ")[2] for line in made.programs[0].text.split("\r\n"))
    above = f"L X{x:+.4f} Y{y:+.4f} R0 FMAX\nFN 20: WAIT FOR SYNC\n"
    _, _, tests = text.partition(above)
    tests, down, _ = tests.partition("\nL Z")
    assert down
    for index, planned in ((1, x), (2, y)):
        assert (
            f"FN 18: SYSREAD Q1614 = ID240 NR1 IDX{index}\n"
            f"FN 2: Q1614 = +Q1614 - {planned:+.4f}\n"
            "FN 12: IF +Q1614 LT -1 GOTO LBL 93\nFN 11: IF +Q1614 GT +1 GOTO LBL 93\n"
        ) in f"{tests}\n"


def test_every_block_is_needed(made, reads):
    """Each one taken out, the others numbered anew: refused."""
    lines = made.programs[0].text.split("\r\n")
    passed = set()
    for i, line in enumerate(lines):
        if not line or line.startswith(" "):
            continue
        many = 2 if lines[i + 1].startswith(" ") else 1
        left = lines[:i] + lines[i + many :]
        numbers = iter(range(len(left)))
        text = [f"{next(numbers)} {s.partition(' ')[2]}" if s[:1].isdigit() else s for s in left]
        try:
            reads("\r\n".join(text))
        except BadFile:
            continue
        passed.add(line.partition(" ")[2])
    assert passed == set()


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("Q1613 = +0", "Q1613 = -1", r"expected FN 0: Q1613 = \+0 before it"),
        ("LT +0 GOTO LBL 94", "LT +0 GOTO LBL 91", "expected"),
        ("LT +0 GOTO LBL 94", "LT +1 GOTO LBL 94", "the status"),
        ("Z+90.0000", "Z+72.0000", "a touch in the air"),
        (";COMMISSIONING", ";COMMISSIONED", "expected"),
        ("LT -1 GOTO LBL 93", "LT -3 GOTO LBL 93", "off by"),
        ("GT +0.0500 GOTO LBL 93", "GT +0.5000 GOTO LBL 93", "basic rotation is off"),
        ("M140 MB MAX", "L Z-1.0000 R0 FMAX M91", "a move back to the start"),
        ("FN 14: ERROR= 1014", "FN 0: Q1620 = +2", "expected"),
        ("SET UP +8.0000", "SET UP +80.0000", "at most 10 mm beyond"),
        ("Z+70.0000", "Z+75.0000", "touch 1 on SPH1"),
    ],
)
def test_what_is_wrong_is_refused(made, reads, old, new, expected):
    text = made.programs[0].text
    assert old in text
    with pytest.raises(BadFile, match=expected):
        reads(text.replace(old, new))


@pytest.mark.parametrize("meaning", ["gauge", "tip"])
def test_its_log_shows_what_z_the_control_returns(program, small, chain, meaning):
    machine = VirtualMachine(chain, dialect=replace(read_dialect("itnc530"), result_height=meaning))
    run = ran(program, small, machine)
    run.check_done()
    (part,) = parts_of([run], chain)
    assert part.is_complete
    assert not part.is_measuring
    assert (part.radius, part.tool_length) == (3.0, 163.0)
    beside = read_heights(part, small, chain)
    assert abs(beside.pop(meaning)) < 10.0 * NM
    assert abs(beside.popitem()[1]) > 100.0  # the length of the probe, from whichever side


def test_a_touch_in_the_air_that_meets_something_stops_it(program, small, chain):
    higher = VirtualMachine(chain, setup_error=pose(np.eye(3), np.array([0.0, 0.0, 22.0])))
    run = ran(program, small, higher)
    assert run.log == {}
    with pytest.raises(NotReachable, match="the touch in the air meets SPH1"):
        run.check_done()


def test_another_language_and_a_pose_beside_home_are_refused(plan):
    ball = plan_ball(plan)
    with pytest.raises(DesignError, match="expected klartext"):
        make_first(ball, read_dialect("linuxcnc"))
    visit = replace(ball.visits[0], rotary=ball.visits[0].rotary + 0.1)
    with pytest.raises(NotReachable, match="with the rotary axes at home"):
        make_first(replace(ball, visits=(visit,)))


def test_simulate_and_evaluate_take_it(made, small, tmp_path, answer, refusal):
    write_standard(tmp_path / "standard.toml", small)
    (path,) = made.write(tmp_path)
    machine = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"
    words = ["--standard", str(tmp_path / "standard.toml"), "--machine", str(machine)]
    out = ["-o", str(tmp_path / "run.csv")]
    assert "a commissioning program leave a log" in refusal(["simulate", str(path), *words, *out])
    assert main(["simulate", str(path), *words, *out, "--logs", str(tmp_path)]) == 0
    log = str(tmp_path / "MS_A_COM.TXT")
    text = Path(log).read_text(encoding="ascii")
    calibrated = re.sub(r"(?m)^R +3\.000000", "R     3.250000", text)  # another stylus
    assert calibrated != text
    Path(log).write_text(calibrated, encoding="ascii")
    output = answer(["evaluate", log, *words, *out])
    assert "no run file" in output
    assert "Z of the control refers to gauge (--z gauge)" in output
    assert "radius of the ball 3.2500 mm as calibrated, 3.0000 mm as planned" in output
    assert not (tmp_path / "run.csv").exists()
