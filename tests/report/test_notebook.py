"""Results by themselves: short texts, tables with a picture, CSV and data frames of the same."""

import base64
import csv
import io
import re
from pathlib import Path

import numpy as np
import pytest

from matstd import compensate, machine_file
from matstd.diagnosis.answer import compare, diagnose
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.stations import Station
from matstd.report.pages import drawing
from matstd.report.words import comparison_sentence, verdict_sentence
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.study import run_study, write_study
from matstd.twin import display
from matstd.twin.errors import MissingLibrary
from matstd.twin.files import read_run
from matstd.twin.library import ordinary_model
from matstd.twin.thermal.thermal_lag import KIND as LAG
from matstd.twin.units import UM

RUN = Path(__file__).parents[2] / "examples" / "hidden_effect" / "warm_up.csv"


@pytest.fixture(scope="module")
def run():
    """Every fourth table pose of the example."""
    whole = read_run(RUN)
    return whole[whole.touches.pose % 4 == 0]


@pytest.fixture(scope="module")
def comparison(run):
    return compare(run)


@pytest.fixture(scope="module")
def diagnosis(run):
    return diagnose(run, candidates=list(LAG.propose(run.touches))[:3])


@pytest.fixture(scope="module")
def study(chain_of_example):
    workspace = Workspace(chain_of_example, {}, 160.0)
    return run_study(Population(chain_of_example), workspace, 40, 200, np.random.default_rng(1))


@pytest.fixture(scope="module")
def chain_of_example(run):
    return run.touches.chain


def test_compare_without_a_model_is_with_the_ordinary_one(run, comparison):
    ordinary = ordinary_model(run.touches.chain)
    assert [e.name for e in comparison.fit.model.effects] == [e.name for e in ordinary.effects]


def test_texts_are_those_of_the_commands(run, comparison, diagnosis, study):
    assert repr(comparison) == comparison_sentence(comparison)
    assert repr(diagnosis) == verdict_sentence(diagnosis)
    assert repr(study).startswith("200 random machines, seed 1/")
    rms = np.sqrt(np.mean(run.deviation**2)) / UM
    assert repr(run).startswith(f"{len(run)} touches at ")
    assert f"{rms:.2f}" in repr(run)
    assert repr(comparison.fit).endswith("rms of touches held out")
    assert all(len(repr(thing)) < 700 for thing in (run, comparison, diagnosis, study))


@pytest.mark.parametrize("name", ["comparison", "diagnosis", "study"])
def test_a_notebook_shows_text_table_and_picture(name, request):
    result = request.getfixturevalue(name)
    shown = result._repr_html_()
    first = repr(result).splitlines()[0]
    assert first.replace("<", "&lt;").replace(">", "&gt;").replace("'", "&#x27;") in shown
    assert [name for name in result.columns() if f"<th>{name}</th>" not in shown] == []
    (image,) = re.findall(r'src="data:image/png;base64,([^"]+)"', shown)
    assert base64.b64decode(image).startswith(b"\x89PNG")
    rows = len(next(iter(result.columns().values())))
    assert shown.count("<tr>") == 1 + min(rows, 10)


def test_a_run_shows_its_text_alone(run):
    assert drawing(run) is None
    assert run._repr_html_() == f"<p>{run!r}</p>"


def test_the_table_of_a_comparison_is_the_file_of_residuals(comparison, tmp_path):
    path = tmp_path / "residuals.csv"
    text = comparison.to_csv(path)
    assert path.read_bytes().decode("utf-8") == text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == len(comparison.run)
    measured = [float(row["measured_um"]) for row in rows]
    np.testing.assert_allclose(measured, comparison.run.deviation / UM, atol=5.1e-5)
    total = np.array([float(r["predicted_um"]) + float(r["residual_um"]) for r in rows])
    np.testing.assert_allclose(total, measured, atol=1.6e-4)


def test_the_table_of_a_study_is_its_file_of_poses(study, tmp_path):
    write_study(study, tmp_path, "sampled")
    assert study.to_csv() == (tmp_path / "poses.csv").read_text(encoding="utf-8")


def test_steps_of_a_diagnosis_as_a_data_frame(diagnosis):
    frame = diagnosis.to_dataframe()
    assert frame["effect"].tolist() == ["", *(e.name for e in diagnosis.found)]
    assert frame["rms_um"].iloc[-1] == pytest.approx(diagnosis.fit.rms / UM)
    assert frame["rms_um"].is_monotonic_decreasing


def test_without_pandas_the_table_is_still_to_be_had(comparison, monkeypatch):
    def missing(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(display, "import_module", missing)
    with pytest.raises(MissingLibrary, match=r"to_csv\(\)"):
        comparison.to_dataframe()
    assert comparison.to_csv().startswith("line,feature,")


def test_plans_programs_and_stations_print_in_a_few_lines(golden):
    plan, programs = golden.plan(), golden.programs()
    assert repr(plan) == "set-up a: 58 touches in 10 visits of 5 poses"
    assert repr(programs.programs[0]).startswith("MS_A_1.H: 24 touches, about ")
    assert repr(programs).count("\n") == len(programs.programs) - 1
    station = Station(plan, Dialect(), programs)
    assert repr(station).startswith(f"{plan!r}, with tool 30\nMS_A_1.H: 24 touches")


def test_a_compensation_and_its_tables_print_in_a_line_each(tmp_path):
    files = machine_file("hmc1995"), machine_file("hmc1995", errors=True)
    found = compensate(*files, tool_length=100.0)
    of = "compensation of hmc1995 with hmc1995.toml"
    assert repr(found) == f"{of}, tool of 100 mm, judged at 256 poses"
    made = found.tables(tmp_path / "tables", ["iso230"])
    assert repr(made.done[0]) == repr(made)
    assert repr(made).startswith("ISO 230 names")
    assert "\n" not in repr(made)
