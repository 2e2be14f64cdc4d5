"""A whole study: the same for a seed, its files hold its numbers; poor machines have one too."""

import csv
from types import SimpleNamespace

import numpy as np
import pytest
from machines import LATHE, TURNING, none_but

from matstd.report.maps import draw_maps, study_maps
from matstd.report.style import nothing as nothing_to_draw
from matstd.report.words import sampling_words
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.study import Study, run_study, write_study
from matstd.sensitivity.study.machine_study import section_pairs
from matstd.twin.units import DEG, UM


@pytest.fixture(scope="module")
def study(chain, workspace):
    return run_study(Population(chain), workspace, 150, 200, np.random.default_rng(5))


@pytest.fixture(scope="module")
def written(study, tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    write_study(study, folder, sampling_words(study.volumetric))
    return folder


def test_the_same_seed_gives_the_same_study(chain, workspace):
    first, again, other = (
        run_study(Population(chain), workspace, 30, 50, np.random.default_rng(seed))
        for seed in (5, 5, 6)
    )
    np.testing.assert_array_equal(again.q, first.q)
    np.testing.assert_array_equal(again.volumetric.p95, first.volumetric.p95)
    assert not np.array_equal(other.volumetric.p95, first.volumetric.p95)


def test_recurrence_is_counted_over_the_workspace(study):
    # 8 of 150 poses are the worst 5 %
    assert study.volumetric.recurrence.mean() == pytest.approx(8 / 150, abs=1e-12)
    assert max(s.volumetric.recurrence.max() for s in study.sections) > 0.1


def test_sections_pass_through_the_worst_pose(study, chain):
    assert [s.axes for s in study.sections] == [("X", "Y"), ("X", "Z"), ("Y", "Z"), ("B", "C")]
    worst = study.worst_pose
    held = study.sections[0].q[:, chain.axis_index("B")]
    assert np.all(held == worst[chain.axis_index("B")])
    assert study.rms.max() == pytest.approx(study.rms[np.all(study.q == worst, axis=1)][0])


def test_data_files_hold_the_numbers(study, written, chain):
    with (written / "poses.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 150
    p95 = np.array([float(r["p95_um"]) for r in rows])
    np.testing.assert_allclose(p95, study.volumetric.p95 / UM, rtol=1e-6)
    b = np.array([float(r["B_deg"]) for r in rows])
    np.testing.assert_allclose(b, study.q[:, chain.axis_index("B")] / DEG, rtol=1e-6)
    with (written / "sensitivity.csv").open(encoding="utf-8") as stream:
        first = next(csv.DictReader(stream))
    assert float(first["EXX"]) == pytest.approx(1.0)
    assert float(first["EBZ"]) == pytest.approx(0.16)  # um/urad at 160 mm
    with (written / "shares.csv").open(encoding="utf-8") as stream:
        shares = next(csv.DictReader(stream))
    assert sum(float(shares[s.name]) for s in chain.symbols) == pytest.approx(1.0, abs=1e-5)
    with np.load(written / "sections.npz") as arrays:
        section = study.sections[0].volumetric.p95.reshape(25, 25)
        np.testing.assert_array_equal(arrays["XY_p95"], section)


def test_ranking_is_by_share(study):
    ranking = study.ranking()
    assert [r[0] for r in ranking[:2]] in (["EX0C", "EY0C"], ["EY0C", "EX0C"])
    assert sum(share for _, share in ranking) == pytest.approx(1.0)


@pytest.mark.parametrize("machine", [LATHE, TURNING], ids=lambda c: c.name)
def test_maps_of_a_machine_of_few_axes(machine, tmp_path, rendered_alone, unchanged):
    figures, area = rendered_alone(), Workspace(machine, {}, 50.0)
    assert section_pairs(area)[0] == ("X", "Z")
    sizes = {s.name: (10.0 + k, 20.0 + 2.0 * k) for k, s in enumerate(machine.symbols)}
    population = Population(machine, none_but(**sizes))
    study = run_study(population, area, 40, 50, np.random.default_rng(1))
    captions = draw_maps(study, tmp_path)
    unchanged("\n".join(f"{name}: {words}\n{figures[name[:-4]]}" for name, words in captions))


@pytest.mark.filterwarnings("error")
def test_a_machine_without_errors_gives_a_whole_study(
    chain, workspace, tmp_path, monkeypatch, rendered_alone
):
    """The two pictures of S, which know nothing of the sizes of errors, are left out."""
    rendered_alone()
    for name in ("overview", "maps_of_S"):
        monkeypatch.setattr(study_maps, name, lambda _: nothing_to_draw("S"))
    nothing = Population(chain, none_but())
    study = run_study(nothing, workspace, 20, 50, np.random.default_rng(1))
    assert study.volumetric.mean.max() == study.shares.max() == study.rms.max() == 0.0
    assert study.volumetric.p95.max() < UM
    assert study.tail == (0.0, 0.0)
    write_study(study, tmp_path, "sampled")
    written = draw_maps(study, tmp_path)
    assert written
    assert all((tmp_path / name).stat().st_size > 0 for name, _ in written)


@pytest.mark.parametrize(
    ("closed", "sampled", "expected"),
    [
        ([1.0, 2.0, 0.0], [1.1, 1.6, 0.0], (-0.05, -0.2)),  # +10 % and -20 %; the third stands
        ([0.0, 0.0], [0.0, 0.0], (0.0, 0.0)),
    ],
)
def test_the_tail_by_hand(closed, sampled, expected):
    study = SimpleNamespace(
        closed=SimpleNamespace(p95=np.array(closed)),
        volumetric=SimpleNamespace(p95=np.array(sampled)),
    )
    assert Study.tail.fget(study) == pytest.approx(expected)
