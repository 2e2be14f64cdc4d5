"""What belongs to a run stays with it: a slip of one day is no error of the machine on another.

Both runs come from the exact simulator, whose slip is a formula of its own.
"""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import simulator_effects as effects
from simulator import probe, run_text
from simulator_case import read_back
from simulator_experiment import DURATION, MACHINES, STATED_NOISE, placed, random_experiment
from unchanged import table_text

from matstd.cli import main
from matstd.compensation.field import MachineErrors
from matstd.diagnosis.answer import compare
from matstd.diagnosis.files import model_text, read_model
from matstd.diagnosis.fit import fit_run
from matstd.report.words import remark_sentence
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.library import load_user_effects, ordinary_model, parse_effect
from matstd.twin.model import Model
from matstd.twin.record import without_copies
from matstd.twin.units import UM

SLIP, BACKLASH = 40.0, 30.0
"""Planted in the first run, µm."""

AT = 0.55
"""Where in the run the set-up slipped, as a share of its time."""


@pytest.fixture(scope="module")
def visits(tmp_path_factory):
    """Folder of two runs of one machine; the first as it was, and without its slip."""
    folder = tmp_path_factory.mktemp("visits")
    rng = np.random.default_rng(17)
    first = random_experiment(rng, "hsm600u", 5)
    second = replace(first, actual=placed(rng, first.stated))
    slip = replace(effects.slip(AT, np.array([0.6, -0.64, 0.48])), amplitude=SLIP)
    machine = replace(effects.backlash("X"), amplitude=BACKLASH)
    noise = [rng.normal(0.0, STATED_NOISE, len(first.time)) for _ in range(2)]
    texts = {
        "slipped": run_text(first, probe(first, [slip, machine], noise[0]), with_speed=False),
        "calm": run_text(first, probe(first, [machine], noise[0]), with_speed=False),
        "second": run_text(second, probe(second, [machine], noise[1]), with_speed=False),
    }
    for name, text in texts.items():
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    (folder / "machine.toml").write_text(MACHINES["hsm600u"], encoding="utf-8")
    words = ["diagnose", str(folder / "slipped.csv"), "--add", "backlash(X)", "artefact-slip"]
    words += ["--only", "backlash", "--no-report", "--no-learn", "-o", str(folder / "of_slipped")]
    assert main(words) == 0
    return folder


def compared(visits, run, out):
    """What `matstd compare --model` leaves."""
    model = str(visits / "of_slipped/model.toml")
    words = ["compare", str(visits / f"{run}.csv"), "--model", model, "--no-report", "-o", str(out)]
    assert main(words) == 0
    return json.loads((out / "comparison.json").read_text(encoding="utf-8"))


def test_a_slip_of_one_run_is_not_predicted_for_another(visits, tmp_path, capsys, unchanged):
    """Applied to a run in which nothing slipped, the slip would leave eight times the noise."""
    found = compared(visits, "second", tmp_path / "a")
    said = " ".join(capsys.readouterr().out.split())
    slipped, second = (read_run(visits / f"{name}.csv") for name in ("slipped", "second"))
    whole = read_model(visits / "of_slipped/model.toml", runs=[slipped])
    before = compare(second, whole.model, whole.estimates).rms / UM
    assert before > 5.0
    assert found["rms_um"] == pytest.approx(STATED_NOISE / UM, rel=0.1)
    stated = r"slip of the set-up \(artefact-slip, instant (\d+) s\) belongs to slipped.csv"
    instant = re.search(stated, said)
    assert float(instant[1]) == pytest.approx(AT * DURATION, abs=30.0)  # between two touches
    assert "it is not applied here" in said
    assert any(re.search(stated, remark) for remark in found["remarks"])
    # what the model says of a run with such a slip is what the slip did to this one
    same = r"had a slip of the set-up of the same size as that run, an error of ([\d.]+) µm"
    again = re.search(same, said)
    assert again
    assert float(again[1]) == pytest.approx(before, rel=0.03)
    unchanged(table_text(found))


def test_the_run_with_the_slip_has_the_figures_of_its_diagnosis(visits, tmp_path, capsys):
    found = compared(visits, "slipped", tmp_path / "a")
    said = capsys.readouterr().out
    diagnosis = json.loads((visits / "of_slipped" / "diagnosis.json").read_text())
    last = diagnosis["steps"][-1]
    assert found["learnt"] == {key: last[key] for key in ("rms_um", "test_rms_um", "chi2_ratio")}
    assert "is not applied" not in said
    assert "slip of the set-up" in said


def test_a_file_of_before_is_read_by_the_kind_of_its_effects(visits, tmp_path):
    text = (visits / "of_slipped" / "model.toml").read_text(encoding="utf-8")
    old = re.sub(r"(?m)^(run = \"[0-9a-f]{16}\"|share_um = .*)\n", "", text)
    old = re.sub(r"(?ms)^probes = \[\n.*?^\]\n", "", old)
    assert not {"share_um", "probes"} & set(re.findall(r"\w+", old))
    (tmp_path / "model.toml").write_text(old, encoding="utf-8")
    slipped, second = (read_run(visits / f"{name}.csv") for name in ("slipped", "second"))
    for runs, is_there in (([slipped], True), ([second], False), ([slipped, second], False)):
        saved = read_model(tmp_path / "model.toml", runs=runs)
        assert ("artefact-slip" in {e.name for e in saved.model.effects}) == is_there
        assert [one.effect.name for one in saved.left_out] == [] if is_there else ["artefact-slip"]


@pytest.mark.slow
def test_a_second_run_learns_without_the_slip_of_the_first(visits, tmp_path, capsys):
    words = [
        "diagnose",
        str(visits / "second.csv"),
        "--model",
        str(visits / "of_slipped/model.toml"),
    ]
    words += ["--only", "backlash", "--no-report", "--no-learn", "-o", str(tmp_path / "out")]
    assert main(words) == 0
    assert "belongs to slipped.csv" in " ".join(capsys.readouterr().out.split())
    second = read_model(tmp_path / "out" / "model.toml", runs=[read_run(visits / "second.csv")])
    assert "artefact-slip" not in {e.name for e in second.model.effects}
    assert "backlash(X)" in {e.name for e in second.model.effects}


def saved_with(visits, tmp_path, *names):
    """A model of the calm run with further effects, as a file; its path."""
    run = without_copies(read_run(visits / "calm.csv"))
    start = ordinary_model(run.touches.chain)
    added = tuple(parse_effect(name, run.touches.chain) for name in names)
    fit = fit_run(run, Model(start.chain, (*start.effects, *added)))
    (tmp_path / "model.toml").write_text(model_text(fit, "calm.csv"), encoding="utf-8")
    return tmp_path / "model.toml"


def test_a_jump_is_not_compensated(visits, tmp_path):
    """Counts that were lost one afternoon are not taken off the axis on the next day."""
    path = saved_with(visits, tmp_path, "jump(EXX)", "backlash(X)")
    errors = MachineErrors.of_model(read_model(path))
    assert "backlash(X)" in {e.name for e in errors.effects}
    assert "jump(EXX)" not in {e.name for e in errors.effects}
    assert "jump(EXX)" in errors.left_out


def test_what_the_probe_does_is_applied_where_the_same_probe_touched(visits, tmp_path):
    path = saved_with(visits, tmp_path, "probe-radius")
    second = read_run(visits / "second.csv")
    longer = replace(second, touches=replace(second.touches, length=second.touches.length + 50.0))
    for run, is_there in ((second, True), (longer, False)):
        effects_there = {e.name for e in read_model(path, runs=[run]).model.effects}
        assert ("probe-radius" in effects_there) == is_there
    (one,) = read_model(path, runs=[longer]).left_out
    assert "belongs to the probe of calm.csv" in remark_sentence(one)


@pytest.mark.slow
def test_lobes_of_a_head_predict_another_run_with_it(tmp_path):
    """Three lobes of 6 um, another day, a standard placed anew: with them noise is left."""
    rng = np.random.default_rng(23)
    first = random_experiment(rng, "fork", 4)
    head = replace(effects.lobes(3, 0.7), amplitude=6.0)
    runs = []
    for one in (first, replace(first, actual=placed(rng, first.stated))):
        noise = rng.normal(0.0, STATED_NOISE, len(one.time))
        runs.append(read_back(run_text(one, probe(one, [head], noise), False), MACHINES["fork"]))
    start = ordinary_model(runs[0].touches.chain)
    lobing = parse_effect("probe-lobing", start.chain)
    fit = fit_run(runs[0], Model(start.chain, (*start.effects, lobing)))
    path = tmp_path / "model.toml"
    path.write_text(model_text(fit, "first.csv"), encoding="utf-8")
    same, machine = read_model(path, runs=[runs[1]]), read_model(path)
    with_head, without = (
        compare(runs[1], saved.model, saved.estimates).rms / UM for saved in (same, machine)
    )
    assert with_head < 1.15 * STATED_NOISE / UM
    assert without > 2.0 * with_head


def test_what_is_left_is_known_as_well_as_before(visits):
    """Without the slip the covariance of the others is that of the whole file: marginal."""
    path, slipped = str(visits / "of_slipped/model.toml"), read_run(visits / "slipped.csv")
    whole, rest = read_model(path, runs=[slipped]), read_model(path)
    kept = [e.name != "artefact-slip" for e, _ in whole.model.parameters]
    covariance = whole.estimates.root @ whole.estimates.root.T
    found = rest.estimates.root @ rest.estimates.root.T
    sd = np.sqrt(np.diag(found))
    np.testing.assert_allclose(
        found / np.outer(sd, sd), covariance[np.ix_(kept, kept)] / np.outer(sd, sd), atol=1e-9
    )
    np.testing.assert_array_equal(rest.estimates.mean, whole.estimates.mean[kept])


def test_an_effect_that_belongs_to_nothing_known_is_refused(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from matstd.twin.effects.artefact import ArtefactSlip\n"
        "from matstd.twin.model import Kind\n"
        "from dataclasses import dataclass\n"
        "@dataclass(frozen=True)\nclass Mine(ArtefactSlip):\n    kind = 'mine'\n"
        "    name = 'mine'\n"
        "MINE = Kind.of(Mine, formula='a', belongs_to='weather')\n"
    )
    with pytest.raises(BadFile, match="belongs_to = 'weather', expected 'machine', 'probe' or"):
        load_user_effects(tmp_path / "mine.py")
