"""The pages on formats are true: readers read their examples, and no key is left out."""

import importlib
import json
import re
import runpy
import tomllib
from dataclasses import asdict
from enum import Enum
from pathlib import Path

import numpy as np
import pytest
from formats import examples, paths, tables, undescribed, write_examples
from pydantic_core import PydanticUndefined

from matstd.artefact.body import read_standard
from matstd.artefact.brief import read_project, read_task
from matstd.diagnosis.files import comparison_table, diagnosis_table, read_model
from matstd.diagnosis.laws import POLICY as LAW_POLICY
from matstd.diagnosis.policy import POLICY
from matstd.importers.files.mapping_file import MappingTable
from matstd.probe_paths.control import read_log
from matstd.twin.errors import BadFile
from matstd.twin.files import (
    Table,
    read_errors,
    read_machine,
    read_poses,
    read_run,
    read_sensors,
    run_columns,
    run_file,
)
from matstd.twin.machine import DEFAULT_RANGES
from matstd.twin.units import UM, URAD

ROOT = Path(__file__).parents[1]
UNSTATED = {PydanticUndefined: "needed", None: "none", float("inf"): "none"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("formats")
    write_examples(made)
    return made


# --- the examples ---------------------------------------------------------------------------


def test_machine_errors_and_poses_are_read(folder):
    chain = read_machine(folder / "machine.toml")
    assert chain.programmed_axes == ("C", "B", "X", "Y", "Z")
    errors = read_errors(folder / "errors.toml", chain)
    assert [effect.symbol.name for effect, _ in errors] == ["EC0Y", "EXX", "EXX"]
    q, length = read_poses(folder / "poses.csv", chain)
    assert q.shape == (2, len(chain.axes))
    assert set(length) == {160.0}


def test_runs_sensors_logs_and_mappings_are_read(folder):
    run = read_run(folder / "run.csv")
    np.testing.assert_allclose(run.deviation, np.array([0.4, -0.2, 0.9]) * UM)
    assert run.touches.setups[0].T_table_artefact[:3, 3].tolist() == [20.0, 0.0, 5.0]
    assert run.remarks == ()
    sensors = read_sensors(folder / "sensors.csv")
    assert set(sensors.temperature) == {"ambient", "spindle"}
    (part,) = read_log(folder / "log.txt", ("C", "B"))
    assert part.is_complete
    assert part.time.tolist() == [12.0]
    mapping = MappingTable.model_validate(tomllib.loads(examples()["mapping.toml"]))
    assert mapping.columns["X_mm"].source == "x pos"


def test_the_deviation_of_the_run_is_what_its_readings_say(folder, tmp_path):
    """Without `dev_um` the readings give it: they stand where the example says, to its digits."""
    write_examples(tmp_path)
    lines = examples()["run.csv"].splitlines()
    head = [line for line in lines if line.startswith("#")]
    rows = [line.split(",") for line in lines if not line.startswith("#")]
    place = rows[0].index("dev_um")
    rows = [row[:place] + row[place + 1 :] for row in rows]
    text = "\n".join(head + [",".join(row) for row in rows]) + "\n"
    (tmp_path / "run.csv").write_text(text, encoding="utf-8")
    run = read_run(tmp_path / "run.csv")
    np.testing.assert_allclose(run.deviation, 0.0, atol=1e-9)


def test_projects_standards_and_models_are_read(folder):
    project = read_project(folder / "project.toml")
    assert project.options.choice.touches == 300
    assert project.population.dependence is not None
    task = read_task(folder / "task.toml")
    assert task.tolerance == pytest.approx(20.0 * UM)
    assert task.u_w == pytest.approx(np.hypot(0.5, 0.2) * UM)
    standard = read_standard(folder / "standard.toml")
    assert [patch.name for patch in standard.patches] == ["FF1"]
    saved = read_model(folder / "model.toml")
    assert saved.model.effects[2].tuning == {"tau": pytest.approx(18.2 * 60.0)}
    np.testing.assert_allclose(saved.estimates.mean, [12.5 * URAD, 1.8 * UM, 24.9 * UM])


# --- the keys of files that are read --------------------------------------------------------


def every_table():
    """All models of tables that any reader of the tool has."""
    for room in ("twin", "importers", "artefact", "diagnosis", "probe_paths", "cad_out", "matstd"):
        for file in (ROOT / room).rglob("*.py"):
            if "(Table)" in file.read_text(encoding="utf-8"):
                name = file.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
                importlib.import_module(name if room == "matstd" else f"matstd.{name}")
    todo, out = [Table], {}
    while todo:
        for model in todo.pop().__subclasses__():
            if not model.__module__.startswith("test"):
                out[f"{model.__module__}.{model.__qualname__}"] = model
                todo.append(model)
    return out


TABLES = every_table()


def test_every_model_of_a_table_is_described():
    assert len(TABLES) > 20
    assert sorted(set(TABLES) - set(tables())) == []


@pytest.mark.parametrize("name", sorted(TABLES))
def test_every_key_is_described_with_its_default(name):
    described = tables()[name]
    fields = {f.alias or key: f for key, f in TABLES[name].model_fields.items()}
    assert sorted(described) == sorted(fields)
    for key, field in fields.items():
        default = field.get_default(call_default_factory=True, validated_data={})
        stated = described[key]
        default = default.value if isinstance(default, Enum) else default
        if isinstance(default, Table):
            assert stated == "its defaults", key
        elif isinstance(default, dict) and default:
            assert stated == "one, `[setup.a]`", key
        elif default in ({}, []) or default == ():
            assert stated == "none", key
        elif isinstance(default, list | tuple) or default not in UNSTATED:
            value = tomllib.loads("x = " + stated.strip("`"))["x"]
            assert value == (list(default) if isinstance(default, tuple) else default), key
        else:
            assert stated == UNSTATED[default], key


MADE = runpy.run_path(str(ROOT / "docs" / "make_formats.py"))


def test_keys_that_users_write_have_a_description_and_an_example():
    """Refusals, pages and new files are made from them."""
    written = [m for name, m in TABLES.items() if name.rpartition(".")[0] in MADE["MODULES"]]
    assert len(written) > 20
    for model in written:
        for name, key in model.keys().items():
            assert key.about, f"{model.__name__}.{name}: write a docstring below the field"
            is_value = not key.holds.startswith(("a table", "tables", "text", "true"))
            is_named = '"' in key.holds or key.range or "in brackets" in key.holds
            assert not is_value or is_named or key.example, f"{model.__name__}.{name}: {key}"


@pytest.mark.parametrize("page", sorted(p.name for p in MADE["FOLDER"].glob("*.md")))
def test_tables_of_keys_are_those_of_the_models(page):
    text = (MADE["FOLDER"] / page).read_text(encoding="utf-8")
    assert MADE["written"](text) == text, "run python docs/make_formats.py"


def test_every_column_of_a_run_is_described(folder):
    columns = {*run_columns.POINT, *run_columns.NORMAL, *run_columns.FORCE, *run_file._OPTIONAL}
    placeholders = {"X_mm", "B_deg", "dirX", "dirB", "T_<sensor>_degC", "V_<name>_<unit>"}
    assert set(tables()["columns of runs"]) == columns | placeholders


def test_other_columns_are_those_of_their_readers(folder):
    """What the pages on poses and sensors name is read, and the readers name nothing else."""
    chain = read_machine(folder / "machine.toml")
    assert set(tables()["columns of poses"]) == {"X_mm", "B_deg", "tool_length_mm"}
    (folder / "odd.csv").write_text("what\n1\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"X_mm.*, tool_length_mm$"):
        read_poses(folder / "odd.csv", chain)
    assert set(tables()["columns of sensors"]) == {"clock", "T_<sensor>_degC", "spindle_rpm"}
    text = examples()["sensors.csv"].replace("T_ambient_degC", "spindle_rpm")
    (folder / "speed.csv").write_text(text, encoding="utf-8")
    assert read_sensors(folder / "speed.csv").spindle_rpm is not None


def test_classes_of_errors_are_described_with_their_amplitudes():
    described = tables()["classes of errors"]
    assert set(described) == set(DEFAULT_RANGES)
    for name, stated in described.items():
        is_angle = name.endswith(("_rotation", "_tilt", "ry_zero", "arm_zero", "squareness"))
        shown = np.array(DEFAULT_RANGES[name]) / (URAD if is_angle else UM)
        assert json.loads(stated.strip("`")) == pytest.approx(shown.tolist())


# --- the keys of results --------------------------------------------------------------------


RESULTS = {
    "diagnosis.json": [
        "diagnosis/files/diagnosis_file.py",
        "diagnosis/files/geometry_table.py",
        "diagnosis/files/parts_table.py",
        "diagnosis/files/law_file.py",
    ],
    "comparison.json": [
        "diagnosis/files/diagnosis_file.py",
        "diagnosis/files/geometry_table.py",
        "diagnosis/files/parts_table.py",
    ],
    "law.json": [
        "diagnosis/files/law_file.py",
        "diagnosis/files/plan_file.py",
        "diagnosis/laws/policy.py",
    ],
    "trend.json": ["diagnosis/charts/history_file.py"],
    "uncertainty.json": ["diagnosis/files/uncertainty_file.py"],
    "identification.json": ["report/identifiability/identification_file.py"],
    "identifiability.json": [
        "report/identifiability/identifiability_file.py",
        "artefact/compare/alternatives.py",
        "information/identifiability/separation.py",
    ],
    "montecarlo.json": ["sensitivity/study/study_file.py"],
}


@pytest.mark.parametrize("name", list(RESULTS))
def test_examples_of_results_have_described_keys_alone_and_all_of_them(name):
    example = json.loads(examples()[name])
    assert undescribed(example, name) == []
    shown = set(paths(example))
    assert [key for key in tables()[name] if "<" not in key and key not in shown] == []


def test_thresholds_of_the_examples_are_those_in_force():
    shown = examples()
    law, found = (json.loads(shown[f"{name}.json"])["policy"] for name in ("law", "diagnosis"))
    assert law == asdict(LAW_POLICY)
    assert found.items() <= POLICY.table().items()


@pytest.mark.parametrize("name", list(RESULTS))
def test_described_keys_are_those_that_are_written(name):
    """Every key on the page stands in the module that writes the file."""
    source = "".join((ROOT / file).read_text(encoding="utf-8") for file in RESULTS[name])
    for key in tables()[name]:
        word = key.rpartition(".")[2]
        if "<" not in word and not re.fullmatch(r"p\d+_um", word):
            assert re.search(rf'"{word}"|\b{word}:', source), key


def test_a_comparison_has_described_keys_alone(warm):
    from matstd.diagnosis.answer.comparison import compare

    found = compare(warm.run[::2])
    words = ["words"] * len(found.structure)
    assert undescribed(comparison_table(found, words, ["remark"]), "comparison.json") == []


def test_a_diagnosis_has_described_keys_alone(warm):
    """One whose starting model lacked a thermal lag, with rivals and regions.

    Keys of several runs are those of `diagnosis/test_several_runs`.
    """
    assert warm.found
    assert undescribed(diagnosis_table(warm), "diagnosis.json") == []
