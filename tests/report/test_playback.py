"""The playback: bodies where they stand, and at every touch a ball that touches."""

import re
from pathlib import Path

import numpy as np
import pytest
from browser import page_data
from unchanged import page_text
from written import live_lines

from matstd.compensation.field import MachineErrors
from matstd.probe_paths.control import interpret
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import ToolClearance
from matstd.report.machine import PLAYBACK, played_probing, set_up_bodies, write_playback
from matstd.report.machine.played import last_moves
from matstd.twin.frames import apply, inverse
from matstd.twin.library import parse_sized_effect
from matstd.twin.machine import tip
from matstd.twin.units import DEG

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def plan(golden):
    return golden.plan()


@pytest.fixture(scope="module")
def read(golden, plan):
    made = golden.programs()
    return [
        interpret(p.text.encode("ascii"), Path(p.file), made.masks.get, plan.chain)
        for p in made.programs
    ]


@pytest.fixture(scope="module")
def page(golden, plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("play") / PLAYBACK
    lost = parse_sized_effect("backlash(X)=6um", plan.chain)
    errors = MachineErrors.of_errors(plan.chain, [(lost.effect, lost.theta)])
    write_playback(path, plan, golden.programs(), Dialect(), errors)
    assert path.name == PLAYBACK
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def data(page):
    return page_data(page)


def test_at_every_touch_the_ball_touches_its_feature(golden, read, plan):
    texts = [p.text for p in golden.programs().programs]
    played = played_probing(plan.chain, read, texts, plan.options.standoff)
    rows = np.flatnonzero(played.touch)
    assert len(rows) == len(plan)
    assert np.all(np.diff(played.time) >= 0.0)
    ball = tip(plan.chain, played.q[rows], played.length[rows])
    stands = plan.setup.T_table_artefact
    point = apply(stands, plan.point + plan.probe.radius * plan.normal)
    order = played.touch[rows] - 1
    # readings of a program have four decimals
    assert np.abs(ball - point[order]).max() < 1e-3
    # the motion is against the normal as far as the programs let a probe go along it
    along = np.einsum("ni,ni->n", played.normal[rows], plan.normal[order] @ stands[:3, :3].T)
    assert along.min() > 0.99
    assert not np.any(played.normal[played.touch == 0])
    rotary = [plan.chain.axis_index(a) for a in plan.chain.rotary_axes]
    assert np.abs(np.diff(played.q[:, rotary], axis=0)).max() <= 6.0 * DEG + 1e-9
    # without the plan the start of a touch is where the probe retracts to
    alone = played_probing(plan.chain, read, texts)
    assert np.abs(alone.q - played.q).max() < 10.0


def test_the_line_that_runs_is_the_one_of_the_program(golden, read, plan):
    texts = [p.text for p in golden.programs().programs]
    played = played_probing(plan.chain, read, texts)
    for row in np.flatnonzero(played.touch)[::7]:
        line = texts[played.which[row]].splitlines()[played.line[row] - 1]
        assert "TCH PROBE 4.3" in line


def test_an_axis_stands_at_its_first_reading_until_a_program_moves_it(golden, read, plan):
    """The program begins with a retract in machine coordinates: `L Z... R0 FMAX M91`."""
    text = golden.programs().programs[0].text
    line = next(line for line in text.splitlines() if line.endswith("M91"))
    retract = float(line.split(" L Z")[1].split()[0])
    played = played_probing(plan.chain, read[:1], [text])
    assert played.q[0, plan.chain.axis_index("Z")] == pytest.approx(retract)
    for axis in plan.chain.programmed_axes:
        low, high = plan.chain.link(axis).range
        reading = played.q[:, plan.chain.axis_index(axis)]
        assert low - 1e-9 <= reading.min()
        assert reading.max() <= high + 1e-9


def test_sides_hold_until_an_axis_turns_back():
    q = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, -2.0], [0.5, -2.0], [0.5, -1.0]])
    assert last_moves(q).T.tolist() == [[0, 1, 1, -1, -1], [0, 0, -1, -1, 1]]


def test_bodies_are_those_of_the_plan(plan):
    room = (plan.standard, plan.setup, plan.probe, plan.options.workshop)
    drawn = set_up_bodies(ToolClearance(plan.chain, *room))
    tool = next(body for body in drawn if body.on == "t").corners.reshape(-1, 3)
    assert tool[:, 2].min() == pytest.approx(-plan.probe.length - plan.probe.radius)
    assert np.hypot(*tool[:, :2].T).max() == pytest.approx(plan.probe.nose_radius)
    at_home = np.concatenate([b.corners.reshape(-1, 3) for b in drawn if b.on == "w"])
    at_home = at_home - plan.chain.table_origin
    back = inverse(plan.setup.T_table_artefact)
    for sphere in plan.standard.spheres:
        away = np.linalg.norm(apply(back, at_home) - sphere.centre, axis=1)
        assert np.sum(np.abs(away - sphere.radius) < 1e-9) > 100
    for patch in plan.standard.patches:
        corner = apply(plan.setup.T_table_artefact, patch.point(np.array([patch.half_size])))
        assert np.linalg.norm(at_home - corner, axis=1).min() < 1e-9


def test_the_whole_page(page, unchanged):
    unchanged("\n".join([page_text(page), *live_lines(page), ""]))


def test_the_page_holds_it_all_and_loads_nothing(page, data, plan, read):
    assert not re.search(r"\b(src|href)\s*=", page)
    assert len(page) < 700_000
    program = data["program"]
    touch = program["touch"]
    assert np.sum(touch > 0) == len(plan)
    assert program["names"] == [one.name for one in read]
    assert program["features"][0]["1"] == plan.feature[0]
    assert [e["name"] for e in data["errors"]] == ["backlash(X)"]
    q = program["q"].reshape(len(touch), -1)
    rows = np.flatnonzero(touch)[::9]
    gaps = ToolClearance(plan.chain, plan.standard, plan.setup, plan.probe, plan.options.workshop)
    expected, nearest = gaps.gap(q[rows].astype(float))
    assert program["clearance"][rows] == pytest.approx(expected, abs=2e-3)
    which = program["nearest_body"][rows]
    assert [program["nearest"][k] for k in which] == list(nearest)
