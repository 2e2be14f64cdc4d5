"""The names of `matstd`: loaded when used, each with an example, all that commands can do."""

import doctest
import importlib
import inspect
import re
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from figures import render_alone

import matstd
from matstd.cli import main
from matstd.compensation.field import MachineErrors
from matstd.diagnosis.fit import fit_run
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.units import UM

ROOT = Path(__file__).parents[1]
API = sorted((ROOT / "matstd" / "api").glob("[a-z]*.py"))


@pytest.fixture
def there(workshop, tmp_path, monkeypatch):
    """The folder of the examples, for one test."""
    shutil.copytree(workshop, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_door_has_all_its_names() -> None:
    assert set(matstd.__all__) <= set(dir(matstd))
    assert 35 <= len(matstd.__all__) <= 58


@pytest.mark.parametrize("name", matstd.__all__)
def test_every_name_is_there_and_says_what_it_is(name) -> None:
    value = getattr(matstd, name)
    if not isinstance(value, float):
        assert inspect.getdoc(value), name


def test_another_name_is_refused_as_by_any_module() -> None:
    with pytest.raises(AttributeError, match="module 'matstd' has no attribute 'diagnoze'"):
        matstd.diagnoze  # noqa: B018


def test_importing_the_door_loads_nothing() -> None:
    code = "import sys, matstd; dir(matstd); assert not {'numpy', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


MADE_ONCE = ("diagnose", "compare", "learn", "replan", "trend")


def once(function):
    """The function, which makes the result of one call once for all examples of a module."""
    made = {}

    def result(*arguments, **options):
        key = repr((arguments, options))
        if key not in made:
            made[key] = function(*arguments, **options)
        return made[key]

    return result


@pytest.mark.parametrize("path", API, ids=lambda p: p.stem)
def test_examples_of_the_docstrings_run(path, there, unrendered) -> None:
    module = importlib.import_module(f"matstd.api.{path.stem}")
    found = doctest.DocTestFinder(recurse=True).find(module)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    names = {name: getattr(matstd, name) for name in matstd.__all__} | {"np": np}
    names["diagnose"] = partial(matstd.diagnose, learn=False)
    names |= {name: once(names[name]) for name in MADE_ONCE}
    for test in found:
        test.globs |= names
        runner.run(test)
    assert runner.summarize(verbose=False).failed == 0


OWN = [n for n, module in matstd._MODULES.items() if module.startswith("matstd.api.")]


@pytest.mark.parametrize("name", OWN)
def test_every_name_of_the_door_has_an_example(name) -> None:
    assert ">>>" in (inspect.getdoc(getattr(matstd, name)) or ""), name


def test_large_records_have_a_short_text(there) -> None:
    run = matstd.read_run("run.csv")
    model = ordinary_model(run.touches.chain)
    files = matstd.machine_file("hmc1995"), matstd.machine_file("hmc1995", errors=True)
    machine = matstd.compensate(*files, tool_length=100.0)
    tables = machine.tables("tables", "iso230")
    assert re.match(r"ISO 230 names .*: [\d.]+ -> .* µm rms over the workspace", repr(tables))
    records = [
        machine,
        machine.errors,
        tables,
        run,
        run.touches.chain,
        model,
        fit_run(run, model),
        matstd.read_standard("standard.toml"),
        matstd.simulate(["programs/MS_A_1.H"], "standard.toml", "machine.toml"),
        matstd.volumetric(*files, poses()),
    ]
    for record in records:
        assert len(repr(record)) < 400, type(record)
        assert repr(record).count("\n") < 4
        assert len(record._repr_html_()) < 5000


def test_results_print_what_their_commands_say(there) -> None:
    """A sentence with figures, no dump of fields."""
    program = ["programs/MS_A_1.H"], "standard.toml", "machine.toml"
    made = [
        (matstd.trend("trend"), r"\d+ runs of .*: \d+ of \d+ charted quantities changed"),
        (matstd.learn("run.csv", add=["thermal-lag(EZZ)"]), r"No law: .* \([\d.]+ µm rms\)"),
        (matstd.calibrate("standard.toml", "cmm.csv"), r"\d+ features of .*, by [\d.]+ µm\Z"),
        (matstd.simulate(*program), r"\d+ touches at .* deviations [\d.]+ µm rms, .* min"),
        (matstd.uncertainty(["monday.csv", "friday.csv"], "standard.toml"), r".*\n.*U = [\d.]+ µm"),
    ]
    for found, words in made:
        assert re.match(words, str(found)), str(found)
        assert str(found) == repr(found)
        assert len(str(found)) < 2000


def poses():
    return np.zeros((2, 4)), np.full(2, 100.0)


def test_a_run_can_be_given_as_a_path_a_run_or_several(there) -> None:
    run = matstd.read_run("monday.csv")
    by_path, by_run = matstd.compare("monday.csv"), matstd.compare(run)
    np.testing.assert_array_equal(by_path.residual, by_run.residual)
    later = matstd.compare(["monday.csv", "probed.csv"])
    assert len(later.run) == len(run) + 33


ALIKE = ["thermal-lag(EZZ)", "thermal-lag(EZX)"]


@pytest.fixture(scope="module")
def few(workshop, tmp_path_factory):
    """A folder with a third of the run and its diagnosis, saved as `door`, and the diagnosis."""
    place = tmp_path_factory.mktemp("few")
    shutil.copy(workshop / "machine.toml", place)
    matstd.write_run(place / "few.csv", matstd.read_run(workshop / "run.csv")[::3], "machine.toml")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        render_alone(patch)
        found = matstd.diagnose("few.csv", only=ALIKE, auto=True, learn=False)
        found.save("door")
    return place, found


def test_machine_errors_of_a_fit_are_those_of_its_file(few, monkeypatch) -> None:
    place, found = few
    monkeypatch.chdir(place)
    saved = MachineErrors.of_model(matstd.read_model("door/model.toml"))
    for errors in (MachineErrors.of_model(found.fit), MachineErrors.of_model(found.model)):
        assert [e.name for e in errors.effects] == [e.name for e in saved.effects]
        np.testing.assert_allclose(np.concatenate(errors.theta), np.concatenate(saved.theta))
    q = np.zeros((1, len(found.run.touches.chain.axes)))
    state = matstd.State(temperature={"spindle": 25.0})
    by_file = matstd.compensate("door/model.toml", tool_length=160.0, state=state)
    assert found.compensate(tool_length=160.0, state=state).header() == by_file.header()
    assert len(by_file.errors.touches(q, 160.0)) == 1


def test_commands_write_what_the_door_writes(few, monkeypatch, unrendered) -> None:
    place, found = few
    monkeypatch.chdir(place)
    words = ["diagnose", "few.csv", "--auto", "--no-learn", "--only", *ALIKE, "-o", "command"]
    assert main(words) == 0
    names = {p.relative_to("command") for p in Path("command").rglob("*") if p.is_file()}
    assert names == {p.relative_to("door") for p in Path("door").rglob("*") if p.is_file()}
    for name in ("diagnosis.json", "model.toml"):
        assert Path("command", name).read_bytes() == Path("door", name).read_bytes()
    with pytest.raises(matstd.DesignError, match="already exists"):
        found.page("door")


def test_calls_that_nothing_fits_are_refused_by_their_argument(there) -> None:
    with pytest.raises(matstd.BadArgument, match=r"^runs none: expected one run or more"):
        matstd.diagnose([])
    with pytest.raises(matstd.BadArgument, match=r"^model geometri: expected geometry, setup or"):
        matstd.compare("run.csv", "geometri")
    with pytest.raises(matstd.BadArgument, match=r"^temperature 24.0: expected values by name"):
        matstd.State(temperature=24.0)


def test_a_model_asks_at_once_for_all_that_it_follows(there) -> None:
    chain = matstd.read_run("run.csv").touches.chain
    effects = [(parse_effect("thermal-static(EZZ,spindle)", chain), np.ones(1) * UM)]
    effects += [(parse_effect("thermal-static(EXX,oil)", chain), np.ones(1) * UM)]
    with pytest.raises(matstd.DesignError, match=r"sensor 'spindle'.*sensor 'oil'"):
        MachineErrors.of_errors(chain, effects)


def test_an_argument_is_named_as_it_was_given(there, capsys) -> None:
    with pytest.raises(matstd.BadArgument, match=r"^hold_out winter: expected one of run"):
        matstd.diagnose("run.csv", hold_out=["winter"])
    assert main(["diagnose", "run.csv", "--hold-out", "winter", "-o", "out"]) == 2
    assert "matstd diagnose: --hold-out winter: expected one of run" in capsys.readouterr().err
