"""Coordinates of tilted planes: other numbers, the same positions, the same measurements."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import as_read, parts_of, ran
from scipy.spatial.transform import Rotation
from unchanged import facts, folded

from matstd.artefact.brief import read_project
from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import VirtualMachine, evaluate
from matstd.probe_paths.control import Move, ProbeStep
from matstd.probe_paths.emit import make_dry_run, make_programs
from matstd.probe_paths.language import Dialect, read_dialect
from matstd.probe_paths.plan import ProgramFrame, plan_touches
from matstd.probe_paths.stations import dialects_of
from matstd.twin.effects import component
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_machine
from matstd.twin.machine import table_to_tool
from matstd.twin.model import contribution
from matstd.twin.units import DEG

ROOT = Path(__file__).parents[2]

TILTED = replace(Dialect(), is_tilted=True)
PIVOT, ORIGIN = np.array([0.0, 0.0, -420.0]), np.array([0.0, 0.0, -500.0])


@pytest.fixture(scope="module")
def made(plan):
    return make_programs(plan, TILTED)


@pytest.fixture(scope="module")
def both(made, plan, chain):
    flat = make_programs(plan, Dialect())
    return as_read(made, chain), as_read(flat, chain)


def test_programs_in_planes_are_what_they_were(made, both, unchanged):
    unchanged("\n".join([folded(made.programs[0].text), folded(facts(both[0].steps))]))


def test_axes_end_where_programs_without_planes_end(both):
    tilted, flat = both
    assert tilted.heading.is_tilted
    assert not flat.heading.is_tilted
    assert [type(step) for step in tilted.steps] == [type(step) for step in flat.steps]
    for one, other in zip(tilted.steps, flat.steps, strict=True):
        if isinstance(one, (Move, ProbeStep)):
            assert np.allclose(one.q, other.q, rtol=0.0, atol=1.01e-4, equal_nan=True)
        if isinstance(one, ProbeStep):
            assert np.allclose(one.direction, other.direction, atol=1e-4)


def test_words_are_the_pole_of_the_ball_in_the_plane_by_a_rotation_of_our_own(made, both, plan):
    """The text alone: spatial angles about fixed X, Y, Z; kinematics of this machine by hand."""
    _, flat = both
    (program,) = made.programs
    pole = plan.probe.length + plan.probe.radius
    poles, turn, xyz, starts = [], None, {}, []
    for line in program.text.splitlines():
        block = line.partition(" ")[2]
        if match := re.match(r"PLANE SPATIAL SPA(\S+) SPB(\S+) SPC(\S+) STAY", block):
            turn = Rotation.from_euler("xyz", [float(v) for v in match.groups()], degrees=True)
        elif block.startswith("L ") and "M91" not in block and turn is not None:
            xyz |= {a: float(v) for a, v in re.findall(r" ([XYZ])([+-][\d.]+)", block)}
        elif block.startswith("TCH PROBE 4.0"):
            starts.append(turn.apply([xyz[a] for a in "XYZ"]))
    for touch in flat.touches:
        c, b = touch.q[:2]
        gauge = touch.q[2:5] - [0.0, 0.0, pole]
        on_table = Rotation.from_euler("z", c).apply(
            Rotation.from_euler("y", b).apply(gauge - PIVOT) + PIVOT
        )
        poles.append(on_table - ORIGIN)
    assert len(starts) == len(poles) > 40
    assert np.abs(np.array(starts) - np.array(poles)).max() < 2.0e-4


def test_logs_of_both_strategies_are_the_same_measurements(both, plan):
    errors = [(component(plan.chain, "EXX", "linear"), np.array([0.02]))]
    machine = VirtualMachine(plan.chain, lambda t: contribution(errors, t))
    runs = []
    for program in both:
        parts = parts_of([ran(program, plan.standard, machine, seed=1)], plan.chain)
        assert parts[0].heading.is_tilted is program.heading.is_tilted
        runs.append(evaluate(parts, plan.standard, plan.chain, 1e-3))
    tilted, flat = runs
    assert np.abs(tilted.touches.q - flat.touches.q).max() < 2e-4
    assert np.abs(tilted.deviation - flat.deviation).max() < 2e-6
    assert np.abs(flat.deviation).max() > 1e-3


def test_a_dry_run_has_planes_too(plan):
    made = make_dry_run(plan, 80.0, TILTED)
    assert "PLANE SPATIAL" in made.programs[0].text
    moves = [step for step in as_read(made, plan.chain).steps if isinstance(step, Move)]
    assert len(moves) > 100


def test_the_retract_is_the_highest_place_in_every_plane(plan, small, chain, golden):
    """At B +15 and -35 its word ends in ..0661 and ..1635: the nearest one leads above it."""
    wanted, z = golden.requests(small), chain.axis_index("Z")
    b = wanted.rotary[:, 1]
    stands = np.select([np.isclose(b, 20.0 * DEG), np.isclose(b, -30.0 * DEG)], [15.0, -35.0], 0.0)
    wanted = replace(wanted, rotary=np.column_stack([wanted.rotary[:, 0], stands * DEG]))
    options = replace(plan.options, tolerated=10)
    inclined = plan_touches(small, chain, plan.probe, plan.setup, wanted, options)
    highest = tuple(replace(visit, height=plan.top) for visit in inclined.visits)
    at_top = replace(inclined, visits=highest)
    for made in (make_dry_run(inclined, 500.0, TILTED), make_programs(at_top, TILTED)):
        moves = [step for step in as_read(made, chain).steps if isinstance(step, Move)]
        reached = np.array([step.q[z] for step in moves])
        high = reached[reached > plan.top - 1.0]
        assert len(high) > 40
        assert high.max() < plan.top + 1e-6
        assert high.min() > plan.top - 1.01e-4


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (r"SPB-30\.0000", "SPB+30.0000", "SPB-30.0000 SPC.*square to the tool as it stands"),
        (r"SPC\+120\.0000", "SPC+120.0010", "square to the tool"),
        (r"SEQ-", "SEQ+", "the solution that the axes stand at"),
        (r"\d+ PLANE SPATIAL [^\r]*\r\n", "", "PLANE SPATIAL before it, as the head says"),
        (r"(?s)(PLANE SPATIAL.*?)\d+ PLANE RESET STAY\r\n", r"\1", "PLANE RESET STAY before it"),
        (r"FRAME SPATIAL", "FRAME AXIAL", "FRAME AXIAL.*expected FRAME SPATIAL"),
        (r"\d+ ;FRAME SPATIAL\r\n", "", "lines for the log that begin with"),
        (r" STAY SEQ", " TURN SEQ", "PLANE RESET STAY, or PLANE SPATIAL SPA<signed>"),
    ],
)
def test_a_plane_that_is_not_the_table_s_is_refused(old, new, reason, made, plan):
    (program,) = made.programs
    lines = re.sub(old, new, program.text, count=1).split("\r\n")
    assert lines != program.text.split("\r\n")
    bare = [re.sub(r"^\d+ ", "", line) for line in lines if line]
    with pytest.raises(BadFile, match=reason):
        as_read(made, plan.chain, text="\r\n".join(bare) + "\r\n")


@pytest.mark.parametrize("name", ["four-axis", "horizontal", "trunnion"])
def test_spatial_angles_mean_the_table_of_any_machine(name):
    chain = read_machine(ROOT / "examples" / "machines" / f"{name}-machine.toml")
    frame, rng = ProgramFrame(chain, Probe()), np.random.default_rng(3)
    for rotary in [*rng.uniform(-2.5, 2.5, (20, len(chain.rotary_axes))),
                   np.full(len(chain.rotary_axes), np.pi / 2)]:  # fmt: skip
        angles = frame.plane(rotary)
        q = np.zeros((1, len(chain.axes)))
        q[0, frame.rotary] = rotary
        found = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
        assert np.allclose(found, table_to_tool(chain, q)[0, :3, :3], atol=1e-9)
        assert frame.is_plane(np.round(angles, 4), rotary)
        assert not frame.is_plane(angles + 0.01, rotary)


def test_a_machine_that_turns_its_tool_has_no_such_planes():
    chain = read_machine(ROOT / "examples" / "machines" / "head-table-machine.toml")
    with pytest.raises(DesignError, match="turns its tool"):
        ProgramFrame(chain, Probe()).tilted(np.full(len(chain.rotary_axes), 0.3))


def test_a_control_without_planes_is_refused(plan, tmp_path):
    linuxcnc = replace(read_dialect("linuxcnc"), is_tilted=True)
    with pytest.raises(DesignError, match="has no PLANE SPATIAL"):
        make_programs(plan, linuxcnc)
    for machine, control, reason in (
        ("hsm600u-machine.toml", "linuxcnc", "has_planes"),
        ("machines/head-table-machine.toml", "tnc640", "whose tool . turns"),
    ):
        path = tmp_path / "project.toml"
        path.write_text(
            f'format = "project/1"\nmachine = "{ROOT / "examples" / machine}"\nseed = 1\n'
            f'control = "{control}"\n[probe]\nradius_mm = 3.0\nlength_mm = 160.0\n'
            '[workshop]\nstrategy = "plane-spatial"\n',
            encoding="utf-8",
        )
        with pytest.raises(BadFile, match=f"workshop.strategy.*{reason}"):
            dialects_of(read_project(path))
