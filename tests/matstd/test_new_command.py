"""`matstd new`: what it writes is read, designs, compares, and never replaces a user's file."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.brief import read_project
from matstd.artefact.feasibility import check_seat, feasibility
from matstd.artefact.reach import ProbeReach
from matstd.artefact.worth import random_touches
from matstd.cli import main
from matstd.commands.machine.new import MACHINES, TEMPLATES, template
from matstd.stages.proposal import Proposal, workspace
from matstd.twin.files import read_machine, read_run
from matstd.twin.library import load_user_effects, parse_effect, try_effect
from matstd.twin.machine import Axis, make_chain, table_to_tool
from matstd.twin.units import UM


def written(kind, folder):
    path = folder / {"effect": "effect.py"}.get(kind, TEMPLATES[kind])
    assert main(["new", kind, "-o", str(path)]) == 0
    return path


def test_a_machine_is_read(tmp_path):
    chain = read_machine(written("machine", tmp_path))
    assert chain.programmed_axes == ("C", "B", "X", "Y", "Z")


def test_a_project_is_read_with_the_machine_that_is_written_beside_it(tmp_path):
    project = read_project(written("project", tmp_path))
    assert project.chain.name == "My machine"
    assert project.study.poses == 2000


def test_the_machine_of_a_new_project_reaches_touches_on_its_standard(tmp_path):
    """What a design begins with: touches that the machine reaches in the volume of the blank."""
    project = read_project(written("project", tmp_path))
    reach = project.reach
    assert isinstance(reach, ProbeReach)
    volume = ((-100.0, -100.0, 30.0), (100.0, 100.0, 150.0))
    assert len(random_touches(reach, volume, project.rotary, 200, np.random.default_rng(1))) == 200


def test_a_run_is_read_without_a_remark(tmp_path):
    run = read_run(written("run", tmp_path))
    np.testing.assert_allclose(run.deviation, np.array([0.4, -0.2, 0.9]) * UM)
    assert run.remarks == ()


def test_the_readings_of_a_new_run_stand_where_its_points_are(tmp_path):
    """Without the column of deviations the readings give them: zero, to the digits given."""
    path = written("run", tmp_path)
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line if line.startswith("#") else line.split(",") for line in lines]
    names = next(row for row in rows if isinstance(row, list))
    place = names.index("dev_um")
    kept = [r if isinstance(r, str) else ",".join(r[:place] + r[place + 1 :]) for r in rows]
    path.write_text("\n".join(kept) + "\n", encoding="utf-8")
    np.testing.assert_allclose(read_run(path).deviation, 0.0, atol=1e-9)


def test_an_effect_passes_the_trial_of_user_effects(tmp_path):
    path = written("effect", tmp_path)
    load_user_effects(path)
    run = read_run(written("run", tmp_path))
    effect = parse_effect("my-effect", run.touches.chain)
    try_effect(effect, run.touches, path)
    assert effect.tuned(12.0).tuning == {"x": 12.0}


@pytest.mark.parametrize("kind", list(TEMPLATES))
def test_without_an_output_the_file_is_printed(kind, capsys):
    assert main(["new", kind]) == 0
    assert capsys.readouterr().out == template(kind)


@pytest.mark.parametrize("kind", list(TEMPLATES))
def test_a_file_of_the_user_stays(kind, tmp_path, capsys):
    path = tmp_path / TEMPLATES[kind]
    path.write_text("mine\n", encoding="utf-8")
    assert main(["new", kind, "-o", str(path)]) == 2
    assert "--force" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine\n"
    assert main(["new", kind, "-o", str(path), "--force"]) == 0
    assert path.read_text(encoding="utf-8") == template(kind)


def test_a_machine_that_is_there_stays_beside_a_new_project(tmp_path):
    machine = tmp_path / "machine.toml"
    machine.write_text("mine\n", encoding="utf-8")
    written("project", tmp_path)
    assert machine.read_text(encoding="utf-8") == "mine\n"


TABLES = {
    "trunnion": ["500"],
    "swivel-45": ["630"],
    "two-tables": ["320"],
    "fork-portal": ["3000", "2000"],
    "turn-mill": ["315"],
    "three-axis": ["900", "500"],
    "horizontal": ["500", "500"],
    "micro": ["80"],
    "cmm": ["900", "1200"],
}
"""Sizes of the tables that the templates state."""

BUILT = sorted(TABLES.keys() - {"micro"})  # kinds whose table is large enough for a standard


QUICK = ("three-axis",)  # `test_whole_commands` has two tables, a round one that binds


def like(kind, folder):
    path = folder / "machine.toml"
    assert main(["new", "machine", "--like", kind, "-o", str(path)]) == 0
    return path


@pytest.mark.parametrize("kind", MACHINES)
def test_every_kind_of_machine_is_read_without_a_remark(kind, tmp_path, capsys):
    """The next command proposes a project for the table that the file states."""
    assert read_machine(like(kind, tmp_path)).remarks == ()
    assert f" --table-mm {' '.join(TABLES[kind])} -o " in capsys.readouterr().out


def test_the_inclined_table_stands_upright_at_half_a_turn(tmp_path):
    """Half a turn about (0, 1, 1) takes z to y: the face of the table looks along Y."""
    chain = read_machine(like("swivel-45", tmp_path))
    q = np.zeros((1, len(chain.axes)))
    q[0, chain.axis_index("B")] = np.pi
    T_table_tool = table_to_tool(chain, q)[0]
    # the tool's axis, Z of the machine, is Y of the turned table
    np.testing.assert_allclose(T_table_tool[:3, 2], [0.0, 1.0, 0.0], atol=1e-7)


def proposed(kind, folder, *more):
    machine, path = like(kind, folder), folder / "made" / "project.toml"
    words = ["--machine", str(machine), "-o", str(path), "--table-mm", *TABLES[kind], *more]
    code = main(["new", "project", *words])
    return code, path


@pytest.mark.parametrize(
    "kind",
    [pytest.param(k, marks=() if k in QUICK else pytest.mark.slow) for k in BUILT],
)
def test_a_proposed_project_passes_the_first_checks_of_a_design(kind, tmp_path, capsys):
    code, path = proposed(kind, tmp_path)
    assert code == 0
    brief = read_project(path)
    assert brief.probe.nose_is_stated
    brief = replace(brief, options=replace(brief.options, sites=60))  # a tenth of the usual places
    check_seat(brief)
    feasibility(brief).check()
    # corners are rounded with 25 mm; on a disc they are the farthest places of a square
    half, table = brief.blank.base.half_size[0], [float(size) for size in TABLES[kind]]
    farthest = np.hypot(half - 25.0, half - 25.0) + 25.0 if len(table) == 1 else half
    assert farthest <= 0.5 * min(table)
    if kind == "two-tables":  # 260 mm: hypot(105, 105) + 25 = 173.5 mm over a radius of 160 mm
        assert half == 120.0
    said = capsys.readouterr().out
    assert f"next: matstd design {path} -o {path.parent / 'out'}" in said
    assert "the base covers" in said
    for name, (low, high) in brief.ranges.items():
        assert brief.chain.link(name).range[0] <= low < high <= brief.chain.link(name).range[1]


def test_the_workspace_is_what_brings_the_tool_over_the_standard():
    """Three axes, the tool 160 mm long, a base of 320 mm: 200 mm either way of its middle, and the
    gauge point from 160 mm above the table to 160 + 220 mm."""
    chain = make_chain(
        "plain",
        "[w f X Y Z t]",
        {a: Axis(range=(-600.0, 600.0)) for a in "XYZ"},
        (10.0, 0.0, -500.0),
    )
    found = dict(workspace(chain, 320.0, 220.0, 160.0, (0.0, 0.0, 0.0)))
    assert found == {"X": [-190.0, 210.0], "Y": [-200.0, 200.0], "Z": [-340.0, -120.0]}


@pytest.mark.parametrize(
    ("travel", "covered"),
    [
        ((-30.0, 300.0), [-30.0, 300.0]),
        ((-200.0, 170.0), [-190.0, 170.0]),
        ((0.0, 360.0), [0.0, 360.0]),
        ((-360.0, 360.0), [-180.0, 180.0]),
        ((-9999.0, 9999.0), [-180.0, 180.0]),
        ((200.0, 400.0), [200.0, 400.0]),
        ((-95.0, 15.0), [-95.0, 15.0]),
    ],
)
def test_every_direction_of_a_table_is_in_the_workspace(travel, covered):
    """The whole travel, and of more than a turn one turn."""
    axes = {a: Axis(range=(-600.0, 600.0)) for a in "XYZ"}
    axes["C"] = Axis(range=tuple(np.radians(travel)))
    chain = make_chain("table", "[w C' f X Y Z t]", axes, (0.0, 0.0, -500.0))
    found = dict(workspace(chain, 320.0, 220.0, 160.0, (0.0, 0.0, 0.0)))
    assert found["C"] == covered


def test_a_machine_without_z_is_named_with_what_a_design_needs(tmp_path, capsys):
    text = template("machine", "three-axis").replace("Z", "W")
    machine = tmp_path / "w.toml"
    machine.write_text(text, encoding="utf-8")
    read_machine(machine)
    assert main(["new", "project", "--machine", str(machine)]) == 2
    said = capsys.readouterr().err
    assert f"{machine}: chain: found linear axes" in said
    assert "expected X, Y and Z" in said


@pytest.mark.parametrize(
    ("table", "base", "share"),
    [
        ((1000.0, 500.0), 200.0, 0.08),
        ((500.0,), 500.0 / np.sqrt(2.0), 2.0 / np.pi),
        ((300.0,), 300.0, 1.0),
        ((300.0, 200.0), 250.0, 250.0 / 300.0),
    ],
)
def test_what_overhangs_covers_no_table(table, base, share):
    made = Proposal(
        text="", brief=None, table=table, is_assumed=False, larger=None, other_place=0.0
    )
    assert made.share_of_table(base) == pytest.approx(share, abs=0.01)


def test_a_machine_that_is_too_small_is_reported_in_one_message(tmp_path, capsys):
    code, path = proposed("micro", tmp_path, "--table-mm", "40")
    assert code == 2
    said = capsys.readouterr().err
    assert "a table of 40 mm: the smallest standard is 160 x 160 x 120 mm" in said
    assert not path.exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["run", "--like", "cmm"], "--like cmm: expected it with `matstd new machine` alone"),
        (["machine", "--machine", "m.toml"], "--machine m.toml: expected it with"),
        (["project", "--table-mm", "40"], "--table-mm 40: expected it with --machine alone"),
        (["project", "--machine", "m", "--table-mm", "0"], "--table-mm 0: expected a diameter"),
        (
            ["project", "--machine", "m", "--table-mm", "0.5"],
            "--table-mm 0.5 (in metres?): expected",
        ),
    ],
)
def test_options_that_do_not_belong_together_are_refused(words, expected, capsys):
    assert main(["new", *words]) == 2
    assert expected in capsys.readouterr().err
