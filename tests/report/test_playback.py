"""The playback: bodies where they stand, and at every touch a ball that touches."""

import base64
import importlib.util
import json
import re
from pathlib import Path

import numpy as np
import pytest

from matstd.probe_paths.control.interpreter import interpret
from matstd.probe_paths.language.dialect import Dialect
from matstd.report.scenes.bodies import TOOL, drawn_bodies
from matstd.report.scenes.playback import PLAYBACK, key_frames, poses, write_playback
from matstd.twin.files import read_machine
from matstd.twin.frames import apply, inverse
from matstd.twin.machine.kinematics import carriers, table_to_tool
from matstd.twin.units import DEG

ROOT = Path(__file__).parents[2]
GRAIN = 0.05
"""Half of it, and single precision, is what the page is off, mm."""


@pytest.fixture(scope="module")
def golden():
    path = ROOT / "tests" / "golden" / "make_programs.py"
    spec = importlib.util.spec_from_file_location("make_programs", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
    write_playback(path, plan, golden.programs(), Dialect())
    assert path.name == PLAYBACK
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "path", sorted((ROOT / "examples" / "machines").glob("*-machine.toml")), ids=lambda p: p.stem
)
def test_table_and_probe_stand_to_each_other_as_on_the_machine(path):
    """Against the kinematics: the table as seen at home is the foundation's frame, moved."""
    chain = read_machine(path)
    rng = np.random.default_rng(0)
    low, high = np.array([chain.link(a).range for a in chain.axes]).T
    q = rng.uniform(np.maximum(low, -300.0), np.minimum(high, 300.0), (20, len(chain.axes)))
    q[:, [chain.axis_index(a) for a in chain.rotary_axes]] *= 1.0 * DEG
    T_home_table, T_home_tool = poses(chain, q, ""), poses(chain, q, TOOL)
    assert np.allclose(inverse(T_home_table) @ T_home_tool, table_to_tool(chain, q))
    home = q.copy()
    home[
        :,
        [
            chain.axis_index(k.name)
            for k in chain.links
            if k.carries_workpiece and k.kind != "fixed"
        ],
    ] = 0.0
    _, T_machine_home, _ = carriers(chain, home)
    _, T_machine_table, _ = carriers(chain, q)
    assert np.allclose(T_machine_home @ T_home_table, T_machine_table)


def test_at_every_touch_the_ball_touches_its_feature(read, plan):
    frames = key_frames(read, plan)
    rows = np.flatnonzero(frames.touch)
    assert len(rows) == len(plan)
    assert np.all(np.diff(frames.time) >= 0.0)
    T = inverse(poses(plan.chain, frames.q[rows], "")) @ poses(plan.chain, frames.q[rows], TOOL)
    ball = T[:, :3, 3] - plan.probe.length * T[:, :3, 2]
    stands = plan.setup.T_table_artefact
    point = apply(stands, plan.point + plan.probe.radius * plan.normal)
    order = frames.touch[rows] - 1
    # readings of a program have four decimals
    assert np.abs(ball - point[order]).max() < 1e-3
    rotary = [plan.chain.axis_index(a) for a in plan.chain.rotary_axes]
    assert np.abs(np.diff(frames.q[:, rotary], axis=0)).max() <= 6.0 * DEG + 1e-9


def test_bodies_are_those_of_the_plan(plan):
    drawn = drawn_bodies(plan)
    tool = next(body for body in drawn if body.on == TOOL).corners.reshape(-1, 3)
    assert tool[:, 2].min() == pytest.approx(-plan.probe.length - plan.probe.radius)
    assert np.hypot(*tool[:, :2].T).max() == pytest.approx(plan.probe.nose_radius)
    at_home = np.concatenate([b.corners.reshape(-1, 3) for b in drawn if not b.on])
    stands = inverse(plan.setup.T_table_artefact)
    for sphere in plan.standard.spheres:
        away = np.linalg.norm(apply(stands, at_home) - sphere.centre, axis=1)
        assert np.sum(np.abs(away - sphere.radius) < 1e-9) > 100
    for patch in plan.standard.patches:
        corner = apply(plan.setup.T_table_artefact, patch.point(np.array([patch.half_size])))
        assert np.linalg.norm(at_home - corner, axis=1).min() < 1e-9


def test_the_page_holds_it_all_and_loads_nothing(page, plan, read):
    assert not re.search(r"(src|href)\s*=", page)
    assert len(page) < 400_000
    scene = json.loads(
        re.search(r'<script type="application/json" id="scene">(.*?)</script>', page)[1]
    )
    touch = np.frombuffer(base64.b64decode(scene["touch"]), "<u4")
    assert np.sum(touch > 0) == len(plan)
    assert scene["names"] == [one.name for one in read]
    assert scene["features"][0]["1"] == plan.feature[0]
    frames = key_frames(read, plan)
    tool = scene["carriers"][scene["probe"]]
    T = poses(plan.chain, frames.q, TOOL)
    places = np.frombuffer(base64.b64decode(tool["places"]), "<f4").reshape(-1, 3)
    assert np.abs(places - T[:, :3, 3]).max() < GRAIN
    which = np.frombuffer(base64.b64decode(tool["which"]), "<u2")
    turned = np.frombuffer(base64.b64decode(tool["rotations"]), "<f4").reshape(-1, 3, 3)[which]
    assert np.abs(turned - T[:, :3, :3]).max() < 1e-5
    corners = np.frombuffer(base64.b64decode(scene["bodies"][0]["corners"]), "<i2") * scene["grain"]
    assert np.abs(corners - drawn_bodies(plan)[0].corners.reshape(-1)).max() <= 0.5 * GRAIN + 1e-9
