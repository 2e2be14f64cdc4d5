"""Reach comes first: what binds is named and true, the nearest wish does, a picture stays."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from unchanged import Unchanged, facts, folded

from matstd.artefact.brief import Brief, read_project
from matstd.artefact.feasibility import check_room, check_seat, feasibility, feasible
from matstd.artefact.feasibility.room import room_for
from matstd.artefact.feasibility.within_travels import _to_rise, travels
from matstd.artefact.reach import ANGLE, Requests, places_on, reach_of, standing_remarks, table_face
from matstd.cli import main
from matstd.stages.refusals import REFUSED_REACH, REFUSED_ROOM, refusals
from matstd.twin.errors import BadFile, NotBuildable, NotReachable
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.units import DEG

MACHINES = Path(__file__).parents[2] / "examples" / "machines"


def changed(folder: Path, name: str, project: dict[str, str], machine: dict[str, str]) -> Path:
    """An example with lines of project and machine changed."""
    for kind, changes in (("", project), ("-machine", machine)):
        text = (MACHINES / f"{name}{kind}.toml").read_text()
        for pattern, new in changes.items():
            text, count = re.subn(f"(?m){pattern}", new, text)
            assert count == 1, pattern
        (folder / f"{name}{kind}.toml").write_text(text)
    return folder / f"{name}.toml"


def with_setup(line: str) -> dict[str, str]:
    return {r"\Z": f"\n[setup.a]\n{line}\n"}


def on_large_table(place: str) -> dict[str, str]:
    """The standard at a place of a table that is larger than that of the example."""
    table = "\n[workshop.table]\nsides_mm = [4200.0, 4200.0]\n"
    return {r"^table_radius_mm = .*\n": "", **with_setup(f"origin_mm = {place}{table}")}


def refusal(project: Brief) -> str:
    with pytest.raises(NotReachable) as caught:
        feasibility(project).check()
    return str(caught.value)


def is_reached(project: Brief) -> bool:
    return not travels(project).against


@pytest.mark.parametrize("name", ["gantry", "upright", "vertical"])
def test_reach_is_what_every_single_touch_says(name: str) -> None:
    project = read_project(MACHINES / f"{name}.toml")
    wanted, rng = project.reach, np.random.default_rng(1)
    limits = project.rotary
    poses = np.array([[rng.uniform(*pair) for pair in limits] for _ in range(7)]).reshape(7, -1)
    point, normal = (v[::9] for v in places_on(project.blank))
    found = reach_of(wanted, point, normal, poses)
    each = Requests(
        np.full(7 * len(point), "place"),
        np.repeat(point, 7, axis=0),
        np.repeat(normal, 7, axis=0),
        np.tile(poses, (len(point), 1)),
    )
    assert np.array_equal(found.reached.ravel(), wanted.is_reachable(each))


def test_the_travel_that_binds_is_named_and_enough(tmp_path: Path) -> None:
    """Z ends 150 mm too high; with the travel that the refusal asks for, the design may begin."""
    short = {r"^\[axis.Z\]\nrange = .*": "[axis.Z]\nrange = [-150.0, 0.0]"}
    wishes = {r"^Z = .*\n": ""}
    message = refusal(read_project(changed(tmp_path, "vertical", wishes, short)))
    asked = re.search(r"Z would have to go to (-\d+) mm, its travel ends at -150", message)
    assert asked, message
    enough = {next(iter(short)): f"[axis.Z]\nrange = [{asked[1]}.0, 0.0]"}
    project = read_project(changed(tmp_path, "vertical", wishes, enough))
    assert is_reached(project)
    assert travels(project).poses.shape == (1, 0)


def test_the_nearest_wish_does(tmp_path: Path) -> None:
    far = on_large_table("[700.0, 0.0, 0.0]")
    message = refusal(read_project(changed(tmp_path, "vertical", far, {})))
    assert "X would have to go to" in message
    place = re.search(r"setup.a.origin_mm = (\[.*?\]) would do", message)
    assert place, message
    near = on_large_table(place[1])
    assert is_reached(read_project(changed(tmp_path, "vertical", near, {})))


def test_a_standard_that_looks_away_is_asked_to_turn(tmp_path: Path) -> None:
    message = refusal(
        read_project(
            changed(tmp_path, "vertical", with_setup("rotation_deg = [180.0, 0.0, 0.0]"), {})
        )
    )
    assert "degrees away from the tool axis, 75 at most" in message


def test_z_that_cannot_rise_is_reported_before_anything_is_designed(tmp_path: Path) -> None:
    low = {r"^\[axis.Z\]\nrange = .*": "[axis.Z]\nrange = [-500.0, -250.0]"}
    project = changed(tmp_path, "vertical", {r"^Z = .*\n": ""}, low)
    message = refusal(read_project(project))
    # table at -500, sphere 130 + 12.5 high, ball pole 163 below the gauge point, 20 mm to spare
    assert "Z would have to rise to -174 mm" in message
    assert "retracts to -251 mm" in message


@pytest.mark.usefixtures("unrendered")
def test_a_refused_command_leaves_its_picture_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # whatever would design has not begun: it would fail with a traceback
    monkeypatch.setattr("matstd.stages.design.design_standard", None)
    far = on_large_table("[1900.0, 0.0, 0.0]")
    path, out = changed(tmp_path, "gantry", far, {}), tmp_path / "out"
    for _ in range(2):  # its own picture does not stand in the way of the next run
        assert main(["design", str(path), "-o", str(out)]) == 2
        # beside lines of progress, which a slow machine prints
        (message,) = re.findall(r"(?m)^matstd .*", capsys.readouterr().err)
        assert f"{out / REFUSED_REACH} shows what is reached" in message
        assert [p.name for p in out.iterdir()] == [REFUSED_REACH]
        assert (out / REFUSED_REACH).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("name", "setup", "expected"),
    [
        ("vertical", "origin_mm = [0.0, 0.0, -50.0]", "lowest corner lies 50.0 mm below"),
        # a base of 280 mm, tilted by 20 degrees about its middle
        ("vertical", "rotation_deg = [20.0, 0.0, 0.0]", "lies 47.9 mm below"),
        ("trunnion", "rotation_deg = [180.0, 0.0, 0.0]", "its seat does"),
        ("head-table", "rotation_deg = [0.0, 170.0, 0.0]", "lies 24.3 mm below"),
    ],
)
def test_a_standard_in_the_table_or_under_it_is_refused(
    tmp_path: Path, name: str, setup: str, expected: str
) -> None:
    project = read_project(changed(tmp_path, name, with_setup(setup), {}))
    with pytest.raises(BadFile, match=re.escape(expected)):
        check_seat(project)


def test_a_face_that_is_no_table_is_said() -> None:
    """The table of B looks up; a standard that looks at the spindle stands on something else."""
    said = {}
    for name in ("horizontal", "upright", "trunnion", "vertical", "four-axis"):
        project = read_project(MACHINES / f"{name}.toml")
        place = project.setup.T_table_artefact
        said[name] = standing_remarks(project.chain, place, project.down)
        if name == "upright":  # its table lies level under a level spindle: weight along -Y
            (remark,) = standing_remarks(project.chain, place, "-Z")
            assert 'Where it lies level, standard.down = "-Y"' in remark
    (remark,) = said.pop("horizontal")
    assert "looks along +Z of the table frame, and B turns about Y" in remark
    assert "Where B tilts a table, that table is [workshop.table], and this is right" in remark
    assert "rotation_deg = [-90, 0, 0] of the set-up" in remark
    # A about X, as on a four-axis mill, tilts the table that stands under [workshop.table]
    assert set(said.values()) == {()}


def carried_by_y(tmp_path: Path, travel: str, place: float) -> Path:
    """A trunnion on a table at `place` along Y, which carries it."""
    machine = {
        r"(?<=^\[axis.Y\]\nrange = ).*": travel,
        r"(?<=^origin = )\[.*": f"[0.0, {place}, -500.0]",
        r"(?<=^\[axis.A\]\nrange = \[-120.0, 30.0\]\npoint = ).*": f"[0.0, {place}, -450.0]",
        r"(?<=^\[axis.C\]\nrange = \[-360.0, 360.0\]\npoint = ).*": f"[0.0, {place}, 0.0]",
    }
    return changed(tmp_path, "trunnion", {r"^Y = .*\n": ""}, machine)


def test_travels_of_a_table_with_the_opposite_sign_are_reported(tmp_path: Path) -> None:
    """Y carries the table: its readings are those of the tool relative to it."""
    message = refusal(read_project(carried_by_y(tmp_path, "[50.0, 650.0]", -345.0)))
    assert "axis.Y.range = [-650, -50] of the machine (readings move the tool" in message
    assert is_reached(read_project(carried_by_y(tmp_path, "[-650.0, -50.0]", -345.0)))


def test_travels_of_the_opposite_sign_far_from_the_table_are_asked_about(tmp_path: Path) -> None:
    asked = (
        r"axis.Y.range: found \[100, 700\], 500 mm from the table, expected readings that "
        r"move the tool relative to the workpiece; is it \[-700, -100\]\?"
    )
    with pytest.raises(BadFile, match=asked):
        read_project(carried_by_y(tmp_path, "[100.0, 700.0]", -400.0))
    assert is_reached(read_project(carried_by_y(tmp_path, "[-700.0, -100.0]", -400.0)))


def test_a_direction_opposite_to_the_readings_is_asked_about(tmp_path: Path) -> None:
    """The travel is right as it stands, so no other range is offered."""
    reversed_y = "[-700.0, -100.0]\ndirection = [0.0, -1.0, 0.0]"
    asked = (
        r"axis.Y.direction: found \[0, -1, 0\], with the range \[-700, -100\], 500 mm from the "
        r"table, expected the motion of the tool relative to the workpiece; is it \[0, 1, 0\]\?"
    )
    with pytest.raises(BadFile, match=asked):
        read_project(carried_by_y(tmp_path, reversed_y, -400.0))


def with_few_sites(patches, reach, blank, poses, _sites, seed):
    return room_for(patches, reach, blank, poses, 40, seed)


def test_travels_and_refusals_are_what_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, unchanged: Unchanged
) -> None:
    """Of machines of three kinds, and of what stands in the wrong place or needs more travel."""
    monkeypatch.setattr(feasible, "room_for", with_few_sites)
    lines = [
        facts(travels(read_project(MACHINES / f"{name}.toml")), name)
        for name in ("gantry", "upright", "vertical")
    ]
    axis = r"^\[axis.{}\]\nrange = .*"
    for name, project, machine in (
        ("vertical", on_large_table("[-900.0, 300.0, 0.0]"), {}),
        ("vertical", {r"^Z = .*\n": ""}, {axis.format("Z"): "[axis.Z]\nrange = [-500.0, -250.0]"}),
        ("vertical", {r"^X = .*\n": ""}, {axis.format("X"): "[axis.X]\nrange = [-40.0, 90.0]"}),
        ("trunnion", {r"^A = .*\n": ""}, {axis.format("A"): "[axis.A]\nrange = [-8.0, 30.0]"}),
    ):
        try:
            found = feasibility(read_project(changed(tmp_path, name, project, machine)))
            lines.append(facts((found.poses, found.room and found.room.faces)))
            found.check()
        except (NotBuildable, NotReachable) as error:
            lines.append(f"{name}: {error}")
    unchanged(folded("\n".join(lines).replace(f"{tmp_path}", "")))


def test_patches_that_do_not_fit_are_reported_with_a_picture(
    tmp_path: Path, refusal, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("matstd.stages.design.design_standard", None)  # not begun
    monkeypatch.setattr(feasible, "room_for", with_few_sites)
    wide = {r"\Z": "gap_mm = 120.0\n"}  # behind the table [limits]
    path, out = changed(tmp_path, "vertical", wide, {}), tmp_path / "out"
    (message,) = re.findall(r"(?m)^matstd .*", refusal(["design", str(path), "-o", str(out)]))
    assert [p.name for p in out.iterdir()] == [REFUSED_ROOM]
    assert re.search(r"only 1 of 6 patches fit on the blank side by side", message)
    assert re.search(r"; limits\.gap_mm = \d+ would do; ", message)


@pytest.mark.parametrize(
    ("name", "limits", "expected", "wish"),
    [
        ("vertical", "max_mass_kg = 19.0", "limit 19 kg: its plate 18.2 kg", "max_mass_kg"),
        pytest.param(
            *("upright", "max_slope_deg = 32.0", "can be touched where they stand"),
            "max_slope_deg",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_what_would_do_does(tmp_path, monkeypatch, name, limits, expected, wish) -> None:
    """A tenth of the usual places are tried: what is refused is, and the wish that is met."""
    monkeypatch.setattr(feasible, "_fewer_patches", lambda *_: ())
    path = changed(tmp_path, name, {r"\Z": f"{limits}\n"}, {})
    project = read_project(path)
    project = replace(project, options=replace(project.options, sites=40))
    poses = np.linspace(-3.0, 3.0, 12)[:, None] * np.ones(len(project.chain.rotary_axes))
    room = feasible.room_of(project, poses)
    with pytest.raises(NotBuildable, match=expected):
        check_room(room)
    (words,) = [w for w in feasible.nearest_that_fits(project, room, poses) if wish in w]
    key, unit = {"max_mass_kg": ("max_mass", 1.0), "max_slope_deg": ("max_slope", DEG)}[wish]
    met = replace(project.blank.limits, **{key: float(words.split(" = ")[1]) * unit})
    other = replace(project, blank=replace(project.blank, limits=met))
    check_room(feasible.room_of(other, poses))


@pytest.mark.parametrize(
    ("wish", "facts", "values"),
    [
        (feasible._fewer_patches, {"faces": [1, 2, 3, 4]}, [4, 3]),
        (feasible._fewer_patches, {"faces": [1, 2, 3]}, [3]),
        (feasible._fewer_patches, {"faces": [1, 2, 3], "is_enough": True}, []),
        (feasible._smaller_gaps, {}, [8.0, 3.0]),
        (feasible._smaller_gaps, {"is_enough": True}, []),
        (feasible._steeper_faces, {"is_hidden": True}, [35.5, 45.5]),
        (feasible._steeper_faces, {}, []),
        (feasible._resized_blanks, {"is_light": True}, [[242, 209], [275, 238]]),
        (feasible._resized_blanks, {}, [[209, 180], [198, 171], [187, 162]]),
        (feasible._resized_blanks, {"is_hidden": True}, []),
    ],
)
def test_what_is_tried_is_each_share_of_what_is_stated(wish, facts, values) -> None:
    """Of a gap of 17 mm, 30.5 degrees, sides of 220 and 190 mm on a disc of 320 mm: by hand."""
    brief = read_project(MACHINES / "vertical.toml")
    limits = replace(brief.blank.limits, gap=17.0, max_slope=30.5 * DEG)
    base = replace(brief.blank.base, half_size=(110.0, 95.0))
    brief = replace(brief, blank=replace(brief.blank, limits=limits, base=base))
    flags = dict.fromkeys(("is_enough", "is_hidden", "is_light"), False)
    room = SimpleNamespace(**({"faces": [], "blank": brief.blank} | flags | facts))
    for (words, other), value in zip(wish(brief, room), values, strict=True):
        assert words.endswith(f" = {value:g}" if isinstance(value, float) else f" = {value}")
        limits, half = other.blank.limits, other.blank.base.half_size
        made = {
            "standard.patches": other.options.patches,
            "limits.gap_mm": limits.gap,
            "limits.max_slope_deg": limits.max_slope / DEG,
            "blank.base_mm": [2.0 * side for side in half],
        }
        assert made[words.partition(" = ")[0]] == pytest.approx(value)


def test_a_pose_is_charged_with_the_way_beyond_it(tmp_path: Path) -> None:
    """The table swings 5 degrees beyond A = -60, unless its travel ends there."""
    rises = []
    for end in (-120.0, -60.0):
        short = {r"(?<=^\[axis.A\]\nrange = )\[.*?,": f"[{end},"}
        path = changed(tmp_path, "trunnion", {r"^A = .*\n": ""}, short)
        project = read_project(path)
        rise, _ = _to_rise(project, project.reach, np.array([[0.0, -60.0 * DEG]]))
        rises.append(rise[0])
    # the rim is 160 mm from the line of A, 50 mm above it
    assert 5.0 < rises[0] - rises[1] < 160.0 * 5.0 * DEG


@pytest.mark.parametrize(
    ("facts", "change"),
    [
        ({"fitting": 9}, "standard.patches (to 9) or limits.gap_mm or probe.radius_mm (smaller)"),
        ({"fitting": 2}, "limits.gap_mm or probe.radius_mm (smaller) or blank.base_mm and"),
        ({"binding": ["mass"]}, "limits.max_mass_kg (larger) or blank.base_mm (smaller)"),
        ({"exit_code": 1}, "seed: the fault is the tool's own, not the project's"),
        ({"binding": ["slots"]}, "limits.slot_pitch_mm (smaller, or 0) or blank.base_mm and"),
    ],
)
def test_what_cannot_be_built_says_which_keys_to_change(tmp_path, facts, change) -> None:
    project = read_project(MACHINES / "vertical.toml")
    with pytest.raises(NotBuildable) as caught, refusals(project, tmp_path, str(tmp_path / "out")):
        raise NotBuildable("what binds", **facts)
    assert str(caught.value).startswith(f"{project.path}: what binds; change {change}")
    assert not (tmp_path / "out").exists()


def test_a_rotary_range_at_the_end_of_its_travel_is_refused_with_its_numbers(
    tmp_path: Path, refusal
) -> None:
    path = changed(tmp_path, "trunnion", {r"^A = .*": "A = [29.0, 29.5]"}, {})
    message = refusal(["design", str(path), "-o", str(tmp_path / "out")])
    assert "readings of A from 29 to" in message
    assert "6 degrees away, within the travel" in message
    assert message.startswith(f"matstd design: {path}: ")


def test_limits_bar_what_they_say() -> None:
    project = read_project(MACHINES / "upright.toml")
    poses = np.array([[0.0], [180.0 * DEG]])
    found = reach_of(project.reach, *places_on(project.blank), poses)
    shares = {(m.name, m.upper): share for m, share in found.barred()}
    # faces that look up or away from a horizontal spindle
    assert shares[ANGLE, True] > 0.5


@pytest.mark.parametrize(
    ("angles", "up"),
    [
        ((0.0, 0.0, 0.0), (0, 0, 1)),
        ((15.0, 0.0, 70.0), (0, 0, 1)),
        ((45.0, 0.0, 0.0), (0, 0, 1)),
        ((-90.0, 0.0, 0.0), (0, 1, 0)),
        ((90.0, 0.0, 0.0), (0, -1, 0)),
        ((0.0, 90.0, 0.0), (1, 0, 0)),
        ((-80.0, 0.0, 30.0), (0, 1, 0)),
    ],
)
def test_the_face_of_the_table(angles: tuple[float, ...], up: tuple[int, ...]) -> None:
    found = table_face(pose(fixed_xyz(np.array(angles) * DEG), np.array([5.0, 6.0, 7.0])))
    np.testing.assert_array_equal(found[:3, 2], up)
    np.testing.assert_array_equal(found[:3, 3], 0.0)
    assert np.linalg.det(found[:3, :3]) == pytest.approx(1.0)
