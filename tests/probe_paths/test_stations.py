"""Several probes and clampings in one campaign: what touches what, and what their logs report."""

import re
from dataclasses import replace

import make_programs as golden
import numpy as np
import pytest
from briefs import project_with
from scipy.spatial.transform import Rotation
from unchanged import facts, folded

from matstd.api.replanning import by_probe, of_one_setup
from matstd.artefact.brief import read_project
from matstd.artefact.reach import Clamping, Solid, Workshop, round_table
from matstd.artefact.tool import Probe
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign import VirtualMachine, evaluate
from matstd.probe_paths.campaign.virtual_run import run_programs
from matstd.probe_paths.control import read_log, read_program
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import PlanOptions, plan_touches
from matstd.probe_paths.stations import all_programs, make_stations, plan_campaign
from matstd.probe_paths.stations.from_brief import with_tool
from matstd.probe_paths.stations.planned import _in_other_clamping
from matstd.twin.effects import setup_errors
from matstd.twin.errors import BadFile, DesignError, NotReachable
from matstd.twin.files import read_run, write_run
from matstd.twin.frames import pose, rotation
from matstd.twin.model import Model
from matstd.twin.record import Setup

TOOL_12 = "[workshop]\ntool = 12\n[setup.a]\norigin_mm = [0.0, 0.0, 0.0]\n"
WIDE = Probe(stack=((40.0, 1.5), (160.0, 31.0)), nose_radius=50.0)
SLIM = Probe(radius=2.0, length=200.0, stack=((80.0, 1.4), (200.0, 20.0)))
TURNED = Setup("b", pose(rotation(np.array([0.0, 0.0, np.pi / 2])), np.array([-10.0, 5.0, 0.0])))
CLAMP = Solid("CLAMP", (10.0, 10.0), low=0.0, high=60.0, x=100.0)
CLAMPINGS = (
    Clamping(golden.setup(), Workshop()),
    Clamping(TURNED, Workshop(round_table(), (CLAMP,))),
)


@pytest.fixture(scope="module")
def small():
    return golden.standard()


@pytest.fixture(scope="module")
def wanted(small):
    """Touches at two poses; at the last the wide probe has no room for some."""
    every = golden.requests(small)
    return every[np.isin(every.pose, (2, 4))]


@pytest.fixture(scope="module")
def plans(small, wanted):
    options = PlanOptions(tolerated=2)
    return plan_campaign(small, golden.machine(), [WIDE, SLIM], CLAMPINGS, wanted, options)


@pytest.fixture(scope="module")
def stations(plans):
    return make_stations(plans, [Dialect(), with_tool(Dialect(), 31)])


@pytest.fixture(scope="module")
def texts(stations, tmp_path_factory):
    """Programs as read from nothing but their files."""
    folder = tmp_path_factory.mktemp("stations")
    return [read_program(path, golden.machine()) for path in all_programs(stations).write(folder)]


def logs(texts, small, machines):
    """Parts of the logs that programs leave, each on a machine of its own."""
    parts = []
    for hour, (text, machine) in enumerate(zip(texts, machines, strict=True)):
        later = replace(machine, begin=machine.begin.replace(hour=8 + hour))
        (run,) = run_programs([text], small, later, np.random.default_rng(hour))
        ((name, log),) = run.log.items()
        parts += read_log(name, machine.chain.rotary_axes, log)
    return parts


@pytest.fixture(scope="module")
def parts(texts, small):
    """Of a machine without errors."""
    return logs(texts, small, [VirtualMachine(golden.machine())] * 3)


@pytest.fixture(scope="module")
def seen(parts, small):
    """Their run."""
    return evaluate(parts, small, golden.machine(), 1e-3)


def test_the_stations_are_what_they_were(plans, stations, texts, parts, seen, unchanged):
    lines = [facts((n, p.visits, p.request, p.start, p.contact, p.refused)) for n, p in plans]
    lines += [folded(p.text) for p in all_programs(stations).programs]
    unchanged("\n".join([*lines, facts(parts), facts(seen.deviation), facts(seen.touches.setups)]))


def test_every_touch_is_made_by_the_first_probe_that_can(plans, small, wanted):
    (first, wide), (second, slim) = plans[:2]
    assert (first, second) == (0, 1)
    chain, setup = golden.machine(), golden.setup()
    alone = plan_touches(small, chain, WIDE, setup, wanted, PlanOptions(tolerated=len(wanted)))
    by_wide, by_slim = (set(p.request[p.request >= 0].tolist()) for p in (wide, slim))
    assert by_wide == set(alone.request[alone.request >= 0].tolist())
    refused = {r.request for r in wide.refused}
    assert by_slim
    assert by_wide | by_slim | refused == set(range(len(wanted)))
    assert not by_slim & refused
    again = by_slim & by_wide  # ties its ball to that of the first
    assert 6 <= len(again) <= 8
    assert all(wanted.feature[row].startswith("SPH") for row in again)
    rows = slim.request >= 0
    assert np.allclose(slim.point[rows], wanted.point[slim.request[rows]], atol=1e-9)


def test_another_clamping_touches_the_same_places_at_poses_of_the_first(plans, wanted):
    _, there = plans[-1]
    assert there.setup.name == "b"
    assert [solid.name for solid in there.options.workshop.bodies] == ["CLAMP"]
    rows = there.request >= 0
    assert rows.sum() > 0.8 * len(wanted)
    known = {tuple(np.round(r, 6)) for r in wanted.rotary}
    assert {tuple(np.round(v.rotary, 6)) for v in there.visits} <= known
    # the tool axis by hand: C and B of this machine carry the workpiece
    for row in np.flatnonzero(rows):
        c, b = there.visits[there.visit[row]].rotary
        axis = (Rotation.from_euler("z", c) * Rotation.from_euler("y", b)).apply([0.0, 0.0, 1.0])
        normal = Rotation.from_euler("z", 90, degrees=True).apply(there.normal[row])
        assert axis @ normal > np.cos(np.radians(91.0))


def test_programs_name_their_tool_and_stand_in_order(stations, texts):
    assert [text.name for text in texts] == ["MS_A_1", "MS31_A_1", "MS_B_1"]
    assert [station.dialect.tool for station in stations] == [30, 31, 30]
    assert [text.heading.probe.length for text in texts] == [160.0, 200.0, 160.0]
    by_tool = {words.tool: p for words, p in by_probe(texts, None).items()}
    assert {tool: [p.name for p in mine] for tool, mine in by_tool.items()} == {
        30: ["MS_A_1", "MS_B_1"],
        31: ["MS31_A_1"],
    }


def test_logs_of_all_stations_are_one_run(seen, tmp_path):
    touches = seen.touches
    assert [setup.name for setup in touches.setups] == ["a", "b"]
    assert sorted(set(touches.length.tolist())) == pytest.approx([160.0, 200.0])
    assert sorted(set(touches.radius.tolist())) == pytest.approx([2.0, 3.0])
    assert np.abs(seen.deviation).max() < 1e-5
    # a pose of one probe is none of the other
    with_slim = touches.length > 180.0
    assert not set(touches.pose[with_slim]) & set(touches.pose[~with_slim])
    write_run(tmp_path / "run.csv", seen, "machine.toml")
    again = read_run(tmp_path / "run.csv", golden.machine())
    assert again.touches.radius == pytest.approx(touches.radius, abs=1e-6)
    assert again.touches.length == pytest.approx(touches.length, abs=1e-6)


def test_a_stylus_calibrated_wrongly_is_identified(texts, small):
    """The second probe is 20 um longer and 3 um larger than its calibration says, on the twin."""
    good = VirtualMachine(golden.machine(), noise=2e-4)
    wrong = replace(good, length_error=0.020, radius_error=0.003)
    parts = logs(texts, small, [good, wrong, good])
    run = evaluate(parts, small, good.chain, 5e-4)
    fit = fit_run(run, Model(good.chain, ()))
    (stylus,) = [e for e in fit.effects if e.kind == "stylus"]
    where = fit.of_effect(stylus.name)
    found, u = fit.theta[where], np.sqrt(np.diag(fit.covariance)[where])
    # a longer stylus has its ball farther from the spindle: -z of the tool
    truth = np.array([0.0, 0.0, -0.020, 0.003])
    assert np.all(np.abs(found - truth) < 4.0 * u + 1e-4)
    assert u[2] < 0.004
    (output,) = [
        remark for remark in run.remarks if remark.startswith("stylus of length 200.000 mm")
    ]
    z = re.search(r"z ([+-][\d.]+) ± ([\d.]+) µm beside its calibration", output)
    assert abs(float(z[1]) + 20.0) < 4.0 * float(z[2])


def test_a_stylus_error_is_what_a_displaced_ball_does(seen):
    """Signs by kinematics written here: tool turned against the table by B, then C."""
    touches = seen.touches
    (stylus,) = [free for free in setup_errors(touches) if free.kind == "stylus"]
    e, r = np.array([0.004, -0.003, 0.005]), 0.002
    columns = Model(golden.machine(), (stylus,)).columns(touches)
    rows = np.flatnonzero(touches.length > 180.0)
    assert np.all(columns[touches.length < 180.0] == 0.0)
    for row in rows:
        c, b = touches.reading("C")[row], touches.reading("B")[row]
        table_tool = Rotation.from_euler("z", c) * Rotation.from_euler("y", b)
        normal = touches.setups[touches.setup[row]].T_table_artefact[:3, :3] @ touches.normal[row]
        expected = -normal @ table_tool.apply(e) + r
        assert columns[row] @ [*e, r] == pytest.approx(expected, abs=1e-9)


def test_one_probe_with_two_calibrations_is_refused(parts, small):
    other = replace(parts[-1], tool_length=parts[-1].tool_length + 0.01)
    with pytest.raises(BadFile, match="one calibration a probe"):
        evaluate([*parts[:-1], other], small, golden.machine(), 1e-3)


def test_what_no_probe_reaches_is_refused_by_the_first_one(small, wanted):
    chain, clampings, wanted = golden.machine(), CLAMPINGS[:1], wanted[wanted.pose == 1]
    with pytest.raises(NotReachable, match="by any of 2 probes, 1 tolerated; the first"):
        plan_campaign(small, chain, [WIDE, SLIM], clampings, wanted, PlanOptions(tolerated=1))


def test_a_clamping_without_a_touch_is_refused(small, wanted):
    far = Clamping(Setup("c", pose(np.eye(3), np.array([2000.0, 0.0, 0.0]))), Workshop())
    with pytest.raises(NotReachable, match=r"set-up c: none of \d+ touches"):
        _in_other_clamping(small, golden.machine(), [WIDE], far, wanted)


def test_a_standard_is_planned_again_in_the_set_up_of_the_log(texts, parts):
    here, others = of_one_setup(texts, parts[:2])
    assert ([p.name for p in here], others) == (["MS_A_1", "MS31_A_1"], ["b"])
    with pytest.raises(DesignError, match="logs of set-up a, b, expected those of one"):
        of_one_setup(texts, parts)


@pytest.mark.parametrize(
    ("addition", "reason"),
    [
        ('[[workshop.probes]]\ntool = 12\nmodel = "om-40x50"', "workshop.probes.0.tool"),
        ('[[workshop.probes]]\ntool = 31\nmodel = "om-1"', "workshop.probes.0.model"),
        ("[[workshop.probes]]\ntool = 31\nlength_mm = 200.0", "workshop.probes.0.radius_mm"),
        ('[[workshop.bodies]]\nname = "C"\nsides_mm = [9.0, 9.0]\nheight_mm = 9.0\nsetup = "q"',
         "workshop.bodies.0.setup"),
        ("[setup.b-1]\norigin_mm = [0.0, 0.0, 0.0]", "'b-1'"),
        ("[setup.A]\norigin_mm = [0.0, 0.0, 0.0]", "'A'"),
    ],
)  # fmt: skip
def test_probes_and_set_ups_that_contradict_are_one_line(addition, reason, tmp_path):
    path = project_with(tmp_path, TOOL_12 + addition)
    with pytest.raises(BadFile, match=reason):
        read_project(path)


def test_a_project_states_further_probes_and_set_ups(tmp_path):
    addition = (
        '[[workshop.probes]]\ntool = 31\nmodel = "om-63x76"\n'
        "[setup.b]\nrotation_deg = [0.0, 0.0, 90.0]"
    )
    project = read_project(project_with(tmp_path, TOOL_12 + addition))
    assert [setup.name for setup in project.setups] == ["a", "b"]
    assert project.programs.further_tools == (31,)
    assert len(project.probes) == 2
