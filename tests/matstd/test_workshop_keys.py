"""What stands in the workshop: its keys reach placement, plan and programs, or are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from formats import write_examples
from unchanged import facts

from matstd.artefact.body import Base, DatumSphere, Standard
from matstd.artefact.body.material import STEEL
from matstd.artefact.brief import probe_models, read_project
from matstd.artefact.feasibility import check_seat
from matstd.artefact.reach import (
    ProbeReach,
    Requests,
    Solid,
    Workshop,
    mesh_cover,
    read_drawn_body,
    still_frames,
)
from matstd.artefact.reach.mesh_cover import MOST_BOXES
from matstd.probe_paths.stations import dialects_of, feeds_of, plan_options_of
from matstd.twin.errors import BadFile
from matstd.twin.frames import apply, inverse, pose, rotation
from matstd.twin.machine import table_to_tool
from matstd.twin.record import Setup
from matstd.twin.units import DEG

EXAMPLES = Path(__file__).parents[2] / "examples"


def project(folder, old="", new=""):
    """The example of the page on formats, with one place changed."""
    write_examples(folder)
    path = folder / "project.toml"
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1 or not old
    path.write_text(text.replace(old, new) if old else text, encoding="utf-8")
    return read_project(path)


def test_the_example_of_the_page_reaches_planner_programs_and_placement(tmp_path, unchanged):
    made = project(tmp_path)
    tool, room = made.probe, made.reach.workshop
    assert tool.stack == ((32.0, 2.0), (50.0, 4.0), (100.0, 20.0), (160.0, 20.0))
    assert (tool.radius, tool.length, tool.nose_radius) == (3.0, 160.0, 45.0)
    assert room.table_radius == 180.0
    assert [(b.name, b.on, b.low, b.high) for b in room.bodies] == [
        ("CLAMP1", "", 0.0, 35.0), ("POST", "B", -20.0, 40.0)
    ]  # fmt: skip
    assert plan_options_of(made).workshop == room
    words = dialects_of(made)[0]
    assert (words.tool, words.preset) == (12, 3)
    assert words.on_control("A.H") == "TNC:\\STANDARD\\A.H"
    assert feeds_of(made).probing == 250.0
    unchanged(facts((made.programs, made.clampings, plan_options_of(made), words, feeds_of(made))))


def test_every_model_of_the_library_is_a_probe(tmp_path):
    for name, model in probe_models().items():
        made = project(tmp_path, '"om-40x50"', f'"{name}"').probe
        assert made.stack[0] == (model.stack_mm[0][0], 0.5 * model.stack_mm[0][1])
        assert len(model.source) > 20


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('"om-40x50"', '"om-40"', "probe.model: found 'om-40', expected one of plain, wide"),
        ('model = "om-40x50"', "", "probe.radius_mm: found nothing"),
        ("length_mm = 160.0", "length_mm = 90.0", "probe.stack_mm: found .* to length_mm = 90"),
        ("length_mm = 160.0", "body_diameter_mm = 50.0", "by model, by stack_mm or by stylus"),
        ("tool = 12", "tool = 0", "workshop.tool"),
        ("tool = 12", "probing_feed_mm_min = 5000", "workshop.probing_feed_mm_min"),
        ("diameter_mm = 360.0", "height_mm = 1.0", "workshop.table: .* diameter_mm or sides_mm"),
        ("[limits]", "[limits]\ntable_radius_mm = 160.0",
         "limits.table_radius_mm: .* no such key beside"),
        ('name = "POST"', 'name = "CLAMP1"', "workshop.bodies.1.name: .* a name of its own"),
        ("sides_mm = [40.0, 25.0]", "", "workshop.bodies.0: .* sides_mm, diameter_mm or stl"),
        ("height_mm = 35.0", "", "workshop.bodies.0.height_mm"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(tmp_path, old, new, reason):
    with pytest.raises(BadFile, match=reason):
        project(tmp_path, old, new)


def test_a_body_on_an_axis_of_the_tool_is_refused(tmp_path):
    expected = r"workshop.bodies.1.on: .*axis Z, expected one that carries the workpiece: C, B"
    with pytest.raises(BadFile, match=expected):
        project(tmp_path, 'on = "B"', 'on = "Z"')


def test_a_mesh_is_read_once(tmp_path, monkeypatch):
    """However often the workshop is asked for, and wherever its bodies are tried."""
    trimesh.creation.box((40.0, 25.0, 35.0)).export(tmp_path / "clamp.stl")
    read, usual = [], mesh_cover.mesh_triangles
    monkeypatch.setattr(mesh_cover, "mesh_triangles", lambda path: read.append(path) or usual(path))
    stl = 'stl = "clamp.stl"'
    brief = project(tmp_path, "sides_mm = [40.0, 25.0]\nheight_mm = 35.0", stl)
    with pytest.raises(BadFile, match=r"CLAMP1 on the table: it reaches 17\.5 mm into it"):
        check_seat(brief)  # half of the box lies below its origin; other places are tried
    moved = replace(brief, bodies=tuple(replace(b, at=(150.0, 0.0, 90.0)) for b in brief.bodies))
    assert [s.low for s in moved.reach.workshop.bodies] != [
        s.low for s in brief.reach.workshop.bodies
    ]
    assert brief.clampings[0].workshop is brief.reach.workshop
    assert len(read) == 1


def test_a_mesh_that_is_none_is_refused(tmp_path):
    stl = 'stl = "clamp.stl"'
    for _ in range(2):
        with pytest.raises(BadFile, match=r"clamp\.stl: file: "):
            project(tmp_path, "sides_mm = [40.0, 25.0]\nheight_mm = 35.0", stl)
        (tmp_path / "clamp.stl").write_text("solid nothing\nendsolid nothing\n")


def test_a_body_of_the_cradle_stands_still_while_the_table_turns(tmp_path):
    """Where a point of the cradle is, by the pose of the tool that has not moved."""
    chain = project(tmp_path).chain
    q = np.zeros((2, len(chain.axes)))
    q[:, chain.axis_index("B")] = -40.0 * DEG
    q[1, chain.axis_index("C")] = 75.0 * DEG
    frames = still_frames(("", "B", "X"), chain, q)
    np.testing.assert_allclose(frames[""], np.tile(np.eye(4), (2, 1, 1)))
    point = np.array([30.0, 40.0, -10.0])
    # seen from the tool, which does not move, the point of the cradle is in one place
    seen = apply(inverse(table_to_tool(chain, q)) @ inverse(frames["B"]), point)
    np.testing.assert_allclose(seen[0], seen[1], atol=1e-9)
    # with X, C and B all still it is the foundation that the body stands on
    q[1] = 0.0
    q[1, chain.axis_index("B")] = 20.0 * DEG
    frames = still_frames(("X",), chain, q)
    seen = apply(inverse(table_to_tool(chain, q)) @ inverse(frames["X"]), point)
    np.testing.assert_allclose(seen[0], seen[1], atol=1e-9)


def test_what_a_clamp_is_in_the_way_of_is_not_chosen(tmp_path):
    """A touch straight down on a ball with a wall 4 mm beside the stylus, and without."""
    made = project(tmp_path)
    ball = DatumSphere("SPH1", np.array([0.0, 0.0, 100.0]), 12.5, 6.0, 9.0, 30.0)
    standard = Standard("bare", "", STEEL, Base(), None, (), (ball,), (), 160.0)
    touch = Requests(
        np.array(["SPH1"]), np.array([[0.0, 0.0, 112.5]]), np.array([[0.0, 0.0, 1.0]]),
        np.zeros((1, 2)),
    )  # fmt: skip
    for at, is_free in ((4.0, False), (60.0, True)):
        wall = Solid("WALL", (2.0, 20.0), False, 0.0, 140.0, x=at + 2.0)
        reach = ProbeReach(
            made.chain, Setup("a"), made.probe.shape, 160.0, workshop=Workshop(bodies=(wall,))
        )
        (reason,) = reach.reasons(standard, touch)
        assert (reason == "") is is_free
        assert is_free or "WALL" in reason


def test_boxes_cover_a_mesh_and_not_much_else(tmp_path, unchanged):
    """An L of two bars, turned: 20 000 points of its surface are in the boxes, its notch is not."""
    bars = [
        trimesh.creation.box((80.0, 20.0, 15.0), pose(t=np.array([40.0, 10.0, 7.5]))),
        trimesh.creation.box((20.0, 60.0, 15.0), pose(t=np.array([10.0, 30.0, 7.5]))),
        trimesh.creation.cylinder(8.0, 40.0, transform=pose(t=np.array([10.0, 10.0, 30.0]))),
    ]
    mesh = trimesh.util.concatenate(bars)
    mesh.export(tmp_path / "clamp.stl")
    place = pose(rotation(np.array([0.0, 0.0, 0.6])), np.array([100.0, -50.0, 2.0]))
    solids = read_drawn_body(tmp_path / "clamp.stl").solids("CLAMP", place, "B")
    assert 3 <= len(solids) <= MOST_BOXES
    assert {solid.on for solid in solids} == {"B"}
    points = apply(place, mesh.sample(20_000, seed=1))
    inside = [s.plate.distance(apply(inverse(s.T_face_solid), points)) for s in solids]
    assert np.min(inside, axis=0).max() <= 1e-9
    notch = apply(place, np.array([[60.0, 50.0, 7.5], [30.0, 30.0, 10.0], [50.0, 10.0, 30.0]]))
    outside = [s.plate.distance(apply(inverse(s.T_face_solid), notch)) for s in solids]
    assert np.min(outside, axis=0).min() > 4.0
    unchanged(facts(solids))


@pytest.mark.parametrize(
    ("task", "expected"),
    [
        ("slope_deg = [50.0, 60.0]", r"slope_deg: found 50 and more, expected some within limits"),
        ("curvature_1_m = [900.0, 1000.0]", r"900 and more, expected some up to 166\.7, twice"),
        ("[poses]\nA_deg = [-5.0, 5.0]", r"poses\.A_deg: found an axis .*, expected B_deg, C_deg"),
        ("[poses]\nB_deg = [25.0, 29.0]", r"poses\.B_deg: found 25 to 29, expected some of work"),
    ],
)
def test_a_task_out_of_reach_is_refused_with_the_project(tmp_path, task, expected):
    text = (EXAMPLES / "hsm600u.toml").read_text().replace("# task =", "task =")
    (tmp_path / "task.toml").write_text(f'format = "task/1"\nname = "blade"\n{task}\n')
    (tmp_path / "hsm600u-machine.toml").write_text((EXAMPLES / "hsm600u-machine.toml").read_text())
    (tmp_path / "project.toml").write_text(text)
    with pytest.raises(BadFile, match=expected):
        read_project(tmp_path / "project.toml")
