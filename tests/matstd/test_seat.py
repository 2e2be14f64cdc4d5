"""Standards off their table and clamps inside them, against solids joined by manifold3d."""

import re
from ast import literal_eval
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from unchanged import Unchanged, folded

from matstd.artefact.brief import Brief, base_of, read_project
from matstd.artefact.brief.workshop_tables import BodyTable, TableTable
from matstd.artefact.feasibility import check_beside, check_seat, feasibility
from matstd.artefact.reach import DatumBall
from matstd.cad_out.meshes import read_stl
from matstd.cli import main
from matstd.twin.errors import BadFile, NotReachable
from matstd.twin.frames import pose, rotation
from matstd.twin.record import Setup

EXAMPLES = Path(__file__).parents[2] / "examples"
ALL = sorted([EXAMPLES / "hsm600u.toml", *(EXAMPLES / "machines").glob("*[!e].toml")])
SIDES, CORNER, THICK = (280.0, 240.0), 25.0, 30.0
ZERO = np.zeros((1, 6))
NEAR = 0.6
"""Of the limit, mm: nearer, two methods may differ about what touches."""


@pytest.mark.parametrize("path", [p for p in ALL if not p.stem.endswith("machine")], ids=str)
def test_every_project_of_the_examples_stands(path: Path) -> None:
    check_seat(read_project(path))


def test_faults_of_seats_are_what_they_were(unchanged: Unchanged) -> None:
    """Beside and over the edge of tables, above and in them, tilted, with clamps anywhere."""
    project, rng = example(), np.random.default_rng(2)
    said = []
    for place in ((0, 0, 0), (170, 0, 0), (0, -90, 12), (30, 20, -4), (400, 0, 0), (9, 0, 40)):
        turned = rotation(np.array([0.002 * place[2], 0.0, 0.01 * place[0]]))
        there = replace(project, setups=(Setup("a", pose(turned, np.array(place, float))),))
        for table in ({"diameter_mm": 320.0}, {"sides_mm": [420.0, 300.0], "height_mm": 6.0}):
            said.append(refusal(with_table(there, **table)))
    for _ in range(25):
        said.append(refusal(with_bodies(project, placed(rng, np.eye(4)))))
    for x in (100.0, 138.0, 144.0, 147.0, 400.0):
        said.append(refusal(replace(project, ball=DatumBall(x, 9.0, 80.0, 12.5, 6.0, 0.0, 0.0))))
    sunk = {"name": "CLAMP", "height_mm": 20.0, "sides_mm": [30.0, 20.0]}
    for place in ([10.0, 150.0, -5.0], [10.0, 150.0, 0.05], [0.0, 135.0, 31.0]):
        said.append(refusal(with_bodies(project, sunk | {"at_mm": place})))
    for sides in ((320.0, 200.0), (300.0, 300.0)):
        large = replace(project, blank=replace(project.blank, base=base_of(sides)), overhang=0.0)
        said.append(refusal(with_table(large, diameter_mm=280.0)))
    said += [refusal(cradle_post(height)) for height in (160.0, 170.0, 180.0, 186.0)]
    unchanged(folded("\n".join(said).replace(str(EXAMPLES), "")))


def example(**limits: float) -> Brief:
    made = read_project(EXAMPLES / "hsm600u.toml")
    made = replace(made, options=replace(made.options, sites=60))  # a tenth of the usual places
    return replace(made, blank=replace(made.blank, base=base_of(SIDES)), **limits)


def with_table(project: Brief, **keys: object) -> Brief:
    return replace(project, table=TableTable.model_validate(keys).solid())


def with_bodies(project: Brief, *bodies: dict[str, object]) -> Brief:
    made = [BodyTable.model_validate(body).body(project.path.parent) for body in bodies]
    return replace(project, bodies=tuple(made))


def refusal(project: Brief) -> str:
    """Of the early stage; empty for none."""
    try:
        check_seat(project)
    except BadFile as error:
        return str(error)
    return ""


@cache
def whole_base() -> trimesh.Trimesh:
    return rounded_plate(*SIDES)


def rounded_plate(a: float, b: float) -> trimesh.Trimesh:
    """A base as two boxes and four round corners, by a library that knows nothing of ours."""
    boxes = [(a - 2 * CORNER, b, THICK), (a, b - 2 * CORNER, THICK)]
    parts = [trimesh.creation.box(extents=sides) for sides in boxes]
    for x in (-1, 1):
        for y in (-1, 1):
            round_ = trimesh.creation.cylinder(radius=CORNER, height=THICK, sections=256)
            parts.append(round_.apply_translation([x * (a / 2 - CORNER), y * (b / 2 - CORNER), 0]))
    whole = trimesh.boolean.union(parts, engine="manifold")
    return whole.apply_translation([0, 0, THICK / 2])


def base_mesh() -> trimesh.Trimesh:
    return whole_base().copy()


def disc(radius: float) -> trimesh.Trimesh:
    """A table through which a plate may stand."""
    return trimesh.creation.cylinder(radius=radius, height=200.0, sections=1024)


def placed(rng: np.random.Generator, T: np.ndarray) -> dict[str, object]:
    """A clamp whose corner or side is somewhere near the outline of the base."""
    along = rng.uniform(-1.0, 1.0, 2) * (np.array(SIDES) / 2 + 45.0)
    x, y = (T[:3, :3] @ [*along, 0.0] + T[:3, 3])[:2]
    body: dict[str, object] = {"name": "CLAMP", "height_mm": rng.uniform(5.0, 60.0)}
    body["at_mm"] = [x, y, float(rng.choice([0.0, 0.0, THICK - 4.0, THICK + 3.0]))]
    body["turned_deg"] = rng.uniform(-90.0, 90.0)
    if rng.random() < 0.5:
        return body | {"sides_mm": rng.uniform(15.0, 90.0, 2).tolist()}
    return body | {"diameter_mm": rng.uniform(10.0, 60.0)}


def clamp_mesh(body: dict, grown: float = 0.0) -> trimesh.Trimesh:
    height = body["height_mm"] + 2 * grown
    if "sides_mm" in body:
        a, b = body["sides_mm"]
        mesh = trimesh.creation.box(extents=(a + 2 * grown, b + 2 * grown, height))
    else:
        radius = body["diameter_mm"] / 2 + grown
        mesh = trimesh.creation.cylinder(radius=radius, height=height, sections=256)
    turn = trimesh.transformations.rotation_matrix(np.deg2rad(body["turned_deg"]), [0, 0, 1])
    mesh.apply_transform(turn)
    return mesh.apply_translation(np.add(body["at_mm"], [0, 0, body["height_mm"] / 2]))


def shared(first: trimesh.Trimesh, second: trimesh.Trimesh) -> float:
    common = trimesh.boolean.intersection([first, second], engine="manifold")
    return 0.0 if common.is_empty else float(common.volume)


@pytest.mark.parametrize("upright", [False, True])
def test_clamps_in_the_base_are_those_that_share_volume_with_it(upright: bool) -> None:
    rng, seen = np.random.default_rng(11), {True: 0, False: 0}
    project = with_table(example(), sides_mm=[900.0, 900.0])
    for _ in range(11):
        place = np.array([*rng.uniform(-60.0, 60.0, 2), 0.0])
        T_face = pose(rotation(np.array([0.0, 0.0, rng.uniform(-0.6, 0.6)])), place)
        T = T_face.copy()
        if upright:  # a face along Y of the table: its x, y, z are Z, X, Y of the frame
            cycle = np.eye(3)[:, [2, 0, 1]]
            T[:3, :3], T[:3, 3] = cycle @ T_face[:3, :3], cycle @ place
        body = placed(rng, T_face)
        base = base_mesh().apply_transform(T_face)
        apart = shared(base, clamp_mesh(body, NEAR)) == 0.0
        inside = shared(base, clamp_mesh(body, -NEAR)) > 0.0
        if not (apart or inside):
            continue
        seen[inside] += 1
        message = refusal(with_bodies(replace(project, setups=(Setup("a", T),)), body))
        assert ("CLAMP beside the standard" in message) == inside, (body, T, message)
        if inside:
            assert "would do" in message
            at = literal_eval(message.rsplit("at_mm = ", 1)[1].removesuffix(" would do"))
            assert shared(base, clamp_mesh(body | {"at_mm": at})) < 1.0
    assert min(seen.values()) > 1


@pytest.mark.parametrize("is_disc", [True, False])
def test_standards_over_the_edge_are_those_with_volume_outside(is_disc: bool) -> None:
    """Of the base, what an outline that is larger by the overhang does not hold."""
    rng, allowed, seen = np.random.default_rng(12), 25.0, {True: 0, False: 0}
    size = {"diameter_mm": 400.0} if is_disc else {"sides_mm": [420.0, 350.0]}
    project = with_table(example(overhang=allowed), **size)

    def table(more: float) -> trimesh.Trimesh:
        if is_disc:
            return trimesh.creation.cylinder(radius=200.0 + more, height=200.0, sections=512)
        a, b = 420.0, 350.0
        sides = [(a + 2 * more, b, 200.0), (a, b + 2 * more, 200.0)]
        parts = [trimesh.creation.box(extents=s) for s in sides]
        for x in (-a / 2, a / 2):
            for y in (-b / 2, b / 2):
                round_ = trimesh.creation.cylinder(radius=more, height=200.0, sections=512)
                parts.append(round_.apply_translation([x, y, 0]))
        return trimesh.boolean.union(parts, engine="manifold")

    tables = {more: table(more) for more in (allowed - NEAR, allowed + NEAR)}
    for _ in range(16):
        place = np.array([*rng.uniform(-80.0, 80.0, 2), 0.0])
        T = pose(rotation(np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)])), place)
        base = base_mesh().apply_transform(T)
        outside = {more: base.volume - shared(base, one) > 1.0 for more, one in tables.items()}
        if len(set(outside.values())) > 1:
            continue
        is_over = outside[allowed + NEAR]
        seen[is_over] += 1
        message = refusal(replace(project, setups=(Setup("a", T),)))
        assert ("beyond the edge" in message) == is_over, (T, message)
        if is_over:
            origin = literal_eval(message.rsplit("origin_mm = ", 1)[1].removesuffix(" would do"))
            moved = base_mesh().apply_transform(pose(T[:3, :3], np.array(origin)))
            assert moved.volume - shared(moved, tables[allowed + NEAR]) < 1.0
    assert min(seen.values()) > 2


def test_corners_over_a_round_table_are_the_fault_of_the_base() -> None:
    """A square of 320 mm on a disc of 320 mm: corners at hypot(135, 135) + 25 - 160 = 55.92 mm.

    What the refusal proposes is joined with the table by manifold3d.
    """
    square = replace(example().blank, base=base_of((320.0, 320.0)))
    project = with_table(replace(example(), blank=square, overhang=0.0), diameter_mm=320.0)
    said = refusal(project)
    assert "blank.base_mm: found [320.0, 320.0]" in said
    assert "a corner of it reaches 55.9 mm beyond the edge, limits.overhang_mm is 0.0" in said
    sides = literal_eval(said.rsplit("base_mm = ", 1)[1].removesuffix(" would do"))
    assert refusal(replace(project, blank=replace(square, base=base_of(sides)))) == ""
    assert rounded_plate(*sides).volume - shared(rounded_plate(*sides), disc(160.0)) < 1.0
    larger = [side + 10.0 for side in sides]
    assert rounded_plate(*larger).volume - shared(rounded_plate(*larger), disc(160.0)) > 1.0
    assert refusal(replace(project, overhang=55.95)) == ""
    assert "55.9 mm beyond the edge" in refusal(replace(project, overhang=55.9))


def test_where_no_smaller_base_would_do_the_overhang_is_tried() -> None:
    """160 mm is the smallest side there is; its corners need a disc of 205.6 mm."""
    small = replace(example().blank, base=base_of((160.0, 160.0)))
    project = with_table(replace(example(), blank=small, overhang=0.0), diameter_mm=205.0)
    assert "0.3 mm beyond the edge" in refusal(project)
    assert refusal(project).endswith("limits.overhang_mm = 1 would do")
    assert refusal(with_table(project, diameter_mm=205.6)) == ""


def setup_at(x: float, y: float, z: float) -> Setup:
    return Setup("a", pose(np.eye(3), np.array([x, y, z])))


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        # a disc of 160, the near side of a base of 280 at 300 mm from it
        ((600.0, 0.0, 0.0), "it stands 300.0 mm beside it"),
        ((0.0, 0.0, 30.0), "it floats 30.0 mm above it"),
        ((0.0, 0.0, -30.0), "its lowest corner lies 30.0 mm below"),
        # corner: hypot(60 + 115, 95) + 25 - 160 = 64.12
        ((60.0, 0.0, 0.0), "a corner of it reaches 64.1 mm beyond the edge"),
    ],
)
def test_distances_by_hand(place: tuple[float, float, float], expected: str) -> None:
    said = refusal(replace(example(), setups=(setup_at(*place),)))
    assert expected in said
    origin = literal_eval(said.rsplit("origin_mm = ", 1)[1].removesuffix(" would do"))
    check_seat(replace(example(), setups=(setup_at(*origin),)))


def test_what_carries_a_standard_above_the_table() -> None:
    high = replace(example(), setups=(setup_at(0.0, 0.0, 30.0),))
    riser = {"name": "RISER", "diameter_mm": 200.0, "height_mm": 30.0}
    assert not refusal(with_bodies(high, riser))
    for x, is_carried in ((149.3, True), (150.3, False)):  # the base ends at 140 mm
        block = {"name": "BLOCK", "sides_mm": [20.0, 20.0], "height_mm": 30.0}
        beside = refusal(with_bodies(high, block | {"at_mm": [x, 0.0, 0.0]}))
        assert ("floats 30.0 mm" not in beside) == is_carried
    assert "floats 30.0 mm" in refusal(with_bodies(high, riser | {"at_mm": [400.0, 0.0, 0.0]}))
    assert not refusal(replace(high, riser=30.0))


def test_every_set_up_is_looked_at() -> None:
    project = example()
    beside = Setup("b", pose(np.eye(3), np.array([500.0, 0.0, 0.0])))
    assert "setup.b.origin_mm" in refusal(replace(project, setups=(project.setup, beside)))
    clamp = {"name": "C", "at_mm": [130.0, 0.0, 0.0], "sides_mm": [40.0, 20.0], "height_mm": 30.0}
    assert "C beside the standard: it reaches 30.0 mm" in refusal(with_bodies(project, clamp))
    assert not refusal(with_bodies(project, clamp | {"setup": "b"}))


def test_a_mesh_that_surrounds_the_base_is_no_clamp_in_it(tmp_path: Path) -> None:
    """Boxes that cover a frame reach into what it surrounds; the frame does not."""
    outer, inner = (trimesh.creation.cylinder(r, 20.0, sections=64) for r in (230.0, 195.0))
    frame = trimesh.boolean.difference([outer, inner], engine="manifold")
    frame.apply_translation([0, 0, 10]).export(tmp_path / "frame.stl")
    path = tmp_path / "project.toml"
    project = replace(with_table(example(), diameter_mm=500.0), path=path)
    body = {"name": "FRAME", "stl": "frame.stl"}
    assert not refusal(with_bodies(project, body))
    message = refusal(with_bodies(project, body | {"at_mm": [60.0, 0.0, 0.0]}))
    assert "FRAME beside the standard" in message
    assert "workshop.bodies.0.at_mm = [" in message


def with_post(folder: Path, x: float, y: float) -> tuple[type, object]:
    """What stands for a standard with one post of 24 mm on its base, and its mesh."""

    class Standing:
        class _Post:
            @staticmethod
            def distance(points: np.ndarray) -> np.ndarray:
                return np.hypot(points[:, 0] - x, points[:, 1] - y) - 12.0

        bodies = {"POST1": _Post}  # noqa: RUF012

    post = trimesh.creation.cylinder(radius=12.0, height=100.0).apply_translation([x, y, 75])
    trimesh.boolean.union([base_mesh(), post], engine="manifold").export(folder / "standard.stl")
    return Standing, read_stl(folder / "standard.stl")


def test_a_clamp_in_the_finished_standard_is_seen_by_its_mesh(tmp_path: Path) -> None:
    """Above the base, in the middle of a post: the early look cannot know of it."""
    standing, mesh = with_post(tmp_path, 60.0, 40.0)
    clamp = {"name": "ARM", "at_mm": [80.0, 40.0, 60.0], "sides_mm": [30.0, 20.0], "height_mm": 9.0}
    project = with_bodies(example(), clamp)
    check_seat(project)
    with pytest.raises(BadFile, match=r"ARM beside the standard: it reaches 7\.0 mm into POST1"):
        check_beside(project, standing, mesh, ZERO)  # type: ignore[arg-type]
    clear = with_bodies(example(), clamp | {"at_mm": [88.0, 40.0, 60.0]})
    check_beside(clear, standing, mesh, ZERO)  # type: ignore[arg-type]


def cradle_post(radius: float, **more: object) -> Brief:
    """A post of 20 x 20 mm on the cradle, on the way of the turning corners, along y."""
    post = {"name": "POST", "on": "B", "sides_mm": [20.0, 20.0], "height_mm": 60.0}
    return with_bodies(example(), post | {"at_mm": [0.0, radius, 0.0]} | more)


def test_a_post_on_the_cradle_is_met_by_the_corners_that_turn_past_it() -> None:
    """Corners of 280 x 240 mm, rounded by 25, reach hypot(115, 95) + 25 = 174.2 mm: the post is
    clear of the side at 120 mm and stands on their way, as far as it is nearer than that."""
    assert pytest.approx(149.16**2, rel=1e-4) == 115.0**2 + 95.0**2
    assert refusal(cradle_post(186.0)) == ""
    said = refusal(cradle_post(170.0))
    assert "POST clear of what turns past it: at C = " in said
    assert "into the base of the standard" in said
    assert "would do" in said
    carried = with_bodies(example(), {"name": "POST", "at_mm": [0.0, 170.0, 0.0],
                                      "sides_mm": [20.0, 20.0], "height_mm": 60.0})  # fmt: skip
    assert refusal(carried) == ""


@pytest.mark.slow
def test_a_post_on_the_cradle_clear_of_what_turns_within_the_workspace() -> None:
    """With C between -5 and 5 degrees no corner comes to the post in front of the side."""
    made = cradle_post(150.0, sides_mm=[20.0, 20.0])
    assert refusal(made) != ""
    held = replace(made, ranges=made.ranges | {"C": (-0.08, 0.08)})
    assert refusal(held) == ""


def test_the_finished_standard_is_looked_at_where_it_is_probed(tmp_path: Path) -> None:
    """An arm of the cradle above the base meets a ball's post at C = 90 degrees alone."""
    standing, mesh = with_post(tmp_path, 0.0, 100.0)
    arm = {"name": "ARM", "on": "B", "at_mm": [-100.0, 0.0, 60.0], "sides_mm": [30.0, 20.0],
           "height_mm": 9.0}  # fmt: skip
    project = with_bodies(example(), arm)
    check_beside(project, standing, mesh, ZERO)  # type: ignore[arg-type]
    turned = ZERO.copy()
    turned[0, project.chain.axis_index("C")] = np.pi / 2
    with pytest.raises(BadFile, match=r"into POST1 at C = -?90 degrees"):
        check_beside(project, standing, mesh, np.vstack([turned, -turned]))  # type: ignore[arg-type]


def test_the_command_refuses_before_it_designs(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.setattr("matstd.stages.design.feasibility", None)  # would fail with a traceback
    text = (EXAMPLES / "hsm600u.toml").read_text(encoding="utf-8")
    machine, task = (EXAMPLES / f for f in ("hsm600u-machine.toml", "task.toml"))
    text = text.replace('"hsm600u-machine.toml"', f'"{machine}"').replace(
        '"task.toml"', f'"{task}"'
    )
    path = tmp_path / "p.toml"
    path.write_text(text.replace("origin_mm = [0.0,", "origin_mm = [600.0,"), encoding="utf-8")
    assert main(["design", str(path), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "it stands 300.0 mm beside it" in said
    assert "would do" in said
    assert [p.name for p in tmp_path.iterdir()] == ["p.toml"]


def test_weight_does_not_pull_a_standard_off_its_seat():
    assert "standard.down: found +Z, expected a direction of weight" in refusal(example(down="+Z"))
    assert refusal(example(down="-Z")) == refusal(example(down="-Y")) == ""


def test_two_set_ups_are_two_places():
    first = Setup("a", np.eye(4))
    turned = pose(rotation(np.array([0.0, 0.0, np.pi / 2])), np.zeros(3))
    assert "setup.b.origin_mm" in refusal(example(setups=(first, Setup("b", np.eye(4)))))
    assert refusal(example(setups=(first, Setup("b", turned)))) == ""


def test_the_ball_of_the_workshop_stands_on_the_table():
    near, far = (DatumBall(x, 0.0, 80.0, 12.5, 6.0, 0.0, 0.0) for x in (200.0, 1000.0))
    assert refusal(example(ball=near)) == ""
    assert "its stem stands 840 mm beside the face" in refusal(example(ball=far))


def test_a_body_above_which_z_cannot_rise_is_named_with_a_height_that_was_tried():
    tall = {"name": "POST", "at_mm": [200.0, 0.0, 0.0], "diameter_mm": 20.0}
    with pytest.raises(NotReachable) as caught:
        feasibility(with_bodies(example(), tall | {"height_mm": 1000.0})).check()
    words = r"POST, 1000 mm high,.* a height of (\d+) mm of POST would do"
    said = re.search(words, str(caught.value))
    assert said
    feasibility(with_bodies(example(), tall | {"height_mm": float(said[1])})).check()
