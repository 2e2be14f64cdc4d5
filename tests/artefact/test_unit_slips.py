"""Numbers that were typed in another unit are asked about, whatever their key."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from matstd.api.compensating import compensate
from matstd.api.machines import machine_file
from matstd.artefact.brief import read_project
from matstd.compensation.field import State
from matstd.diagnosis.files import model_of
from matstd.diagnosis.fit import fit_run
from matstd.twin.errors import BadArgument, BadFile
from matstd.twin.files import read_machine, read_poses, read_run
from matstd.twin.library import ordinary_model

ROOT = Path(__file__).parents[2]
EXAMPLE, MACHINE = ROOT / "examples/hsm600u.toml", ROOT / "examples/hsm600u-machine.toml"

RADIAN = 57.29577951308232  # degrees

MORE: dict[str, Any] = {
    "probe": {"stylus_length_mm": 80.0, "stylus_diameter_mm": 4.0, "nose_diameter_mm": 90.0},
    "workshop": {
        "clearance_mm": 20.0,
        "dry_run_mm": 100.0,
        "bodies": [
            {"name": "C1", "at_mm": [155.0, 0.0, 0.0], "diameter_mm": 10.0, "height_mm": 35.0}
        ],
    },
    "limits": {"slot_pitch_mm": 63.0, "overhang_mm": 40.0, "table_radius_mm": 190.0},
    "scan": {"lines_mm": 5.0, "noise_um": 2.0, "feed_mm_min": 1000.0},
    "montecarlo": {"tolerance_um": 100.0},
    "calibration": {"form_um": 0.3},
}
"""Keys that the example leaves out."""

UNLIKE = ("workspace", "errors", "setup", "seed", "standard")
"""Tables without a usual size, or without a unit."""


def project() -> dict[str, Any]:
    data = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    for name, keys in MORE.items():
        data.setdefault(name, {}).update(keys)
    return data


def written(folder: Path, data: dict[str, Any], machine: dict[str, Any] | None = None) -> Path:
    known = machine or tomllib.loads(MACHINE.read_text(encoding="utf-8"))
    (folder / "machine.toml").write_text(tomli_w.dumps(known), encoding="utf-8")
    path = folder / "project.toml"
    path.write_text(tomli_w.dumps(data | {"machine": "machine.toml"}), encoding="utf-8")
    return path


def sizes() -> list[tuple[str, str]]:
    """Keys of the project that have a unit with a thousandfold or a radian in it."""
    ends = ("_mm", "_um", "_urad", "_kg", "_deg", "_MPa", "_mm_min")
    return [
        (table, key)
        for table, keys in project().items()
        if isinstance(keys, dict) and table not in UNLIKE
        for key, value in keys.items()
        if key.endswith(ends) and not isinstance(value, str)
    ]


def scaled(value: Any, factor: float) -> Any:
    return [v * factor for v in value] if isinstance(value, list) else value * factor


@pytest.mark.parametrize(("table", "key"), sizes())
def test_a_size_in_another_unit_is_refused(table, key, tmp_path) -> None:
    assert read_project(written(tmp_path, project()))
    factors = {"_deg": (1.0 / RADIAN,), "_min": (1e-3,)}.get(key[-4:], (1e-3, 1e3))
    for factor in factors:
        data = project()
        data[table][key] = scaled(data[table][key], factor)
        with pytest.raises(BadFile) as refusal:
            read_project(written(tmp_path, data))
        assert f"{table}.{key}: found" in str(refusal.value)
        assert "\n" not in str(refusal.value)


INCH = 25.4  # mm


@pytest.mark.parametrize(
    ("length", "unit", "factor"),
    [
        (16.0, "cm", 10.0),
        (12.5, "cm", 10.0),
        (6.3, "inches", INCH),
        (8.66, "inches", INCH),
        (1600.0, "tenths of a mm", 0.1),
        (30.0, "cm", 10.0),
        (0.16, "metres", 1e3),
    ],
)
def test_a_probe_in_another_unit_is_asked_about(length, unit, factor, tmp_path) -> None:
    """What is proposed is in that unit what was typed, and a project with it is read."""
    data = project()
    del data["probe"]["stylus_length_mm"]
    data["probe"]["length_mm"] = length
    with pytest.raises(BadFile, match=r"probe\.length_mm: found") as refusal:
        read_project(written(tmp_path, data))
    name, meant = re.findall(r"is it in (.*), (.*) mm\?", str(refusal.value))[0]
    assert name == unit
    assert float(meant) == pytest.approx(factor * length, rel=1e-3)
    right = project()
    right["probe"]["length_mm"] = float(meant)
    assert read_project(written(tmp_path, right)).probe.length == float(meant)
    if length > 25.0:  # a probe that a project may confirm
        confirmed = {"confirmed": ["probe.length_mm"]}
        assert read_project(written(tmp_path, confirmed | data)).probe.length == length


@pytest.mark.parametrize(
    ("key", "value", "meant"),
    [
        ("origin_mm", [0.05, 0.02, 0.0], "metres, [50, 20, 0] mm"),
        ("rotation_deg", [0.0, 0.0, 1.5708], "radians, [0, 0, 90] degrees"),
        ("rotation_deg", [0.0, 0.0, -0.785], "radians, [0, 0, -44.98] degrees"),
    ],
)
def test_a_place_in_metres_and_a_rotation_in_radians_are_refused(key, value, meant, tmp_path):
    with pytest.raises(BadFile, match="is it in") as refusal:
        read_project(written(tmp_path, project() | {"setup": {"a": {key: value}}}))
    assert meant in str(refusal.value)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("origin_mm", [0.013, -0.041, 0.0]),
        ("origin_mm", [0.005, 0.0, 0.0]),
        ("rotation_deg", [0.0, 0.0, 0.51]),
        ("rotation_deg", [0.012, 0.0, 1.234]),
        ("rotation_deg", [0.0, 0.0, 1.57]),
    ],
)
def test_a_place_that_was_measured_is_read(key, value, tmp_path) -> None:
    assert read_project(written(tmp_path, project() | {"setup": {"a": {key: value}}}))


def test_a_very_good_machine_is_read_with_a_question(tmp_path) -> None:
    data = project() | {"errors": {"parameters": {"EXX": [0.05, 0.1]}}}
    (remark,) = read_project(written(tmp_path, data)).remarks
    assert "errors.parameters.EXX" in remark
    assert "is it in mm, [50.0, 100.0] µm?" in remark
    data["errors"]["parameters"]["EXX"] = [1e6, 2e6]
    with pytest.raises(BadFile, match="100000 at most"):
        read_project(written(tmp_path, data))


@pytest.mark.parametrize(
    "name", ["hsm600u", *(p.stem for p in sorted(ROOT.glob("examples/machines/*-machine.toml")))]
)
def test_a_table_in_metres_is_refused(name, tmp_path) -> None:
    path = MACHINE if name == "hsm600u" else ROOT / f"examples/machines/{name}.toml"
    machine = tomllib.loads(path.read_text(encoding="utf-8"))
    table = machine["workpiece"]["origin"]
    machine["workpiece"]["origin"] = [1e-3 * v for v in table]
    copy = tmp_path / "machine.toml"
    copy.write_text(tomli_w.dumps(machine), encoding="utf-8")
    with pytest.raises(BadFile, match=r"workpiece\.origin.*is it in metres"):
        read_machine(copy)
    machine["workpiece"]["origin"] = [v + 0.3 for v in table]  # a measured offset
    copy.write_text(tomli_w.dumps(machine), encoding="utf-8")
    assert read_machine(copy)


def test_a_table_near_the_origin_of_its_machine_may_be_off_by_tenths(tmp_path) -> None:
    machine = tomllib.loads(MACHINE.read_text(encoding="utf-8"))
    machine["axis"]["Z"]["range"] = [0.0, 500.0]
    machine["axis"]["B"]["point"] = [0.0, 0.0, 80.0]
    machine["workpiece"]["origin"] = [0.3, -0.2, 0.15]
    copy = tmp_path / "machine.toml"
    copy.write_text(tomli_w.dumps(machine), encoding="utf-8")
    assert read_machine(copy)


@pytest.mark.parametrize(("key", "value"), [("pitch", 0.01), ("pitch", 1e4), ("expected", 10.0)])
def test_lengths_of_an_axis_in_another_unit_are_refused(key, value, tmp_path) -> None:
    machine = tomllib.loads(MACHINE.read_text(encoding="utf-8"))
    machine["axis"]["X"][key] = value
    copy = tmp_path / "machine.toml"
    copy.write_text(tomli_w.dumps(machine), encoding="utf-8")
    with pytest.raises(BadFile, match=rf"axis\.X\.{key}.*is it in"):
        read_machine(copy)


def test_a_tool_in_metres_is_refused(tmp_path) -> None:
    poses = tmp_path / "poses.csv"
    head = "X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_length_mm\n"
    poses.write_text(head + "0,0,-100,0,0,0\n0,0,-100,0,0,0.16\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"line 3, column tool_length_mm.*is it in metres"):
        read_poses(poses, read_machine(MACHINE))
    poses.write_text(head + "0,0,-100,0,0,12\n", encoding="utf-8")
    assert len(read_poses(poses, read_machine(MACHINE))[1]) == 1


@pytest.mark.parametrize(
    ("length", "meant"),
    [
        (0.16, r"is it in metres, 160 mm\?"),
        (16.0, r"is it in cm, 160 mm\?"),
        (6.3, r"is it in inches, 160 mm\?"),
        (1600.0, r"is it in tenths of a mm, 160 mm\?"),
        (-160.0, "40 to 1000 mm from the gauge point"),
    ],
)
def test_a_tool_in_another_unit_is_refused(length, meant) -> None:
    machine, errors = (machine_file("hsm600u", errors=wanted) for wanted in (False, True))
    with pytest.raises(BadArgument, match=meant):
        compensate(machine, errors, tool_length=length)
    assert compensate(machine, errors, tool_length=100.0).datum.length == 100.0


def test_a_tool_is_compared_with_the_probe_of_the_model() -> None:
    """Of a machine that was probed with 32 mm, a tool of 16 mm may be; of one with 160 mm not."""
    run = read_run(ROOT / "examples/hidden_effect/warm_up.csv")
    run = run[run.touches.pose % 4 == 0]
    model = model_of(fit_run(run, ordinary_model(run.touches.chain)))
    assert [length for length, _ in model.source.probes] == [160.0]
    with pytest.raises(BadArgument, match=r"in cm, 160 mm\? \(the machine was probed with 160 mm"):
        compensate(model, tool_length=16.0, state=State(temperature={"spindle": 25.0}))
    short = replace(model, source=model.source.model_copy(update={"probes": [[32.0, 2.0]]}))
    assert compensate(short, tool_length=16.0, state=State()).datum.length == 16.0
