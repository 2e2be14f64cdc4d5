"""What touches can know, and what another stylus or set-up would bring: against sums by hand."""

import json

import numpy as np
import pytest

from matstd.artefact.compare import alternatives as module
from matstd.artefact.compare import identifiability_report
from matstd.artefact.compare.alternatives import (
    alternatives,
    joined_rows,
    machine_rank,
    other_setups,
    touches_reached_in,
)
from matstd.artefact.layout import Blank
from matstd.artefact.reach import ProbeReach
from matstd.artefact.tool import Probe
from matstd.artefact.worth import (
    CriterionOptions,
    criterion_for,
    random_touches,
    setup_parameters,
)
from matstd.information.identifiability import Resolution, combinations
from matstd.report.identifiability import identifiability_table
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.twin.files.whole import write_json
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

TOUCHES = 240
SHAPES = 4
"""Linear, parabolic, sine, cosine."""

SECOND_STYLUS, SECOND_SETUP = "a second stylus length", "a second set-up"


@pytest.fixture(scope="module")
def criterion(chain):
    probe = Probe()
    reach = ProbeReach(chain, Setup("a"), probe.shape, probe.length)
    limits = {"B": (-90.0 * DEG, 20.0 * DEG), "C": (-180.0 * DEG, 180.0 * DEG)}
    workspace = Workspace(chain, limits, probe.length)
    rng = np.random.default_rng(3)
    population = Population(chain)
    wanted = CriterionOptions(), 480, population
    return criterion_for(reach, population.model, Blank(), workspace, 1.0 * UM, rng, *wanted)


@pytest.fixture(scope="module")
def requests(criterion):
    return random_touches(
        criterion.reach, criterion.volume, criterion.rotary, TOUCHES, np.random.default_rng(4)
    )


@pytest.fixture(scope="module")
def known(criterion, requests):
    return identifiability_report(criterion, requests, np.random.default_rng(5))


def test_a_second_stylus_shows_the_tilts_of_the_ram_and_a_second_set_up_shows_nothing(known):
    """The ball hangs from Z, the last axis: its tilts about X and Y are straightnesses until then.

    A set-up stands on the table, of which C turns the whole: no place on it shows more of a machine
    whose axes are all free, only the set-up's own six numbers are added.
    """
    gained = {a.name: a.rank_gained for a in known.alternatives}
    assert gained.pop(SECOND_STYLUS) == 2 * SHAPES
    assert len(gained) >= 3
    assert set(gained.values()) == {0}
    by = [f.resolved_by for f in known.gauge.freedoms]
    assert by.count(SECOND_STYLUS) == 2 * SHAPES
    how = [f.resolution for f in known.gauge.freedoms]
    assert how.count(Resolution.SIDEWAYS) == 2 * SHAPES  # ECY and ECZ turn about the spindle's line
    assert how.count(Resolution.NEVER) + 4 * SHAPES == len(known.gauge.freedoms)
    assert known.gauge.rank + len(known.gauge.freedoms) == known.gauge.parameters


def test_rank_of_the_machine_is_that_of_its_rows_freed_of_set_ups_and_tools(criterion, requests):
    rng = np.random.default_rng(6)
    for name, other in list(other_setups(criterion).items())[:2]:
        second = touches_reached_in(other, requests, rng)[:TOUCHES]
        W = joined_rows(criterion, requests, second, other).W
        P = len(criterion.prior_sd)
        nuisance = np.concatenate([setup_parameters(criterion.model), np.arange(P, W.shape[1])])
        length = np.linalg.norm(W, axis=0)
        scaled = np.where(length > 1e-9 * length.max(), W / np.maximum(length, 1e-300), 0.0)
        free, rest = scaled[:, nuisance], np.delete(scaled, nuisance, axis=1)
        left = rest - free @ np.linalg.lstsq(free, rest, rcond=1e-10)[0]
        s = np.linalg.svd(left, compute_uv=False)
        assert machine_rank(criterion, W) == int(np.sum(s > 1e-8 * s[0])), name


def test_touches_in_a_second_set_up_have_their_own_six_numbers(criterion, requests):
    name, other = next(
        (n, w) for n, w in other_setups(criterion).items() if n.startswith(SECOND_SETUP)
    )
    first, second = (
        requests[:50],
        touches_reached_in(other, requests, np.random.default_rng(7))[:50],
    )
    found = joined_rows(criterion, first, second, other)
    P, of_w = len(criterion.prior_sd), setup_parameters(criterion.model, "w")
    assert len(of_w) == 6
    assert found.W.shape == (100, P + 6), name
    assert not found.W[50:, of_w].any()
    assert not found.W[:50, P:].any()
    assert np.abs(found.W[50:, P:]).max() > 0.0
    np.testing.assert_array_equal(found.prior_sd[P:], criterion.prior_sd[of_w])


def test_a_stylus_that_reaches_nothing_is_said(criterion, requests, monkeypatch):
    monkeypatch.setattr(module, "STYLUS_EXTENSION", 5000.0)
    monkeypatch.setattr(module, "SETUPS", {})
    (only,) = alternatives(criterion, requests, np.random.default_rng(8))
    assert not only.is_possible
    assert only.refusal == f"the machine reaches 0 touches, {TOUCHES // 2} are required"


def test_combinations_know_nothing_of_the_set_up(criterion, requests):
    """Against the textbook: no prior at all on the set-up, ones on the rest."""
    W = criterion.whitened(requests)
    free = setup_parameters(criterion.model)
    unit = ["mm"] * W.shape[1]
    found = combinations(W, criterion.prior_sd, unit, free.tolist())
    kept = np.setdiff1d(np.arange(W.shape[1]), free)
    U, s, _ = np.linalg.svd(W[:, free], full_matrices=False)
    U = U[:, s > 1e-9 * s[0]]
    A = W[:, kept] - U @ (U.T @ W[:, kept])
    covariance = np.linalg.inv(np.eye(len(kept)) + A.T @ A)
    for c in found[:10]:
        weights = (c.weights * criterion.prior_sd)[kept]
        assert not c.weights[free].any()
        assert c.u == pytest.approx(np.sqrt(weights @ covariance @ weights), rel=1e-6)
    assert [c.gain for c in found] == sorted((c.gain for c in found), reverse=True)


def test_errors_known_for_themselves(criterion, requests, known):
    W = criterion.whitened(requests)
    left = np.sqrt(np.diag(np.linalg.inv(np.eye(W.shape[1]) + W.T @ W)))
    setup = set(setup_parameters(criterion.model).tolist())
    expected = {
        n for p, n in enumerate(criterion.model.names) if left[p] ** 2 < 0.1 and p not in setup
    }
    assert {a.name for a in known.alone} == expected
    for a in known.alone:
        share = left[criterion.model.names.index(a.name)]
        assert a.u == pytest.approx(share * a.expected, rel=1e-6)


def test_the_file_says_what_the_record_says(known, tmp_path):
    path = tmp_path / "identifiability.json"
    write_json(path, identifiability_table(known))
    data = json.loads(path.read_text(encoding="utf-8"))
    assert data == json.loads(json.dumps(identifiability_table(known)))
    assert data["format"] == "identifiability/1"
    assert data["rank"] == known.gauge.rank
    assert len(data["freedoms"]) == len(known.gauge.freedoms)
    assert sum(family.count for family in known.freedoms) == len(known.gauge.freedoms)
    words = [f["words"] for f in data["freedoms"]]
    assert "rotation of the workpiece about Z (EC0w) = - zero position of C (EC0C)" in words
    assert data["readings"]["B_deg"][0] == pytest.approx(-90.0, abs=3.0)
    for d, record in zip(data["degrees"], known.degrees, strict=True):
        assert d["largest"] == max(d["supported"], default=0)
        assert d["u"] == pytest.approx(record.u / UM / (1.0 if d["unit"] == "µm" else UM), rel=1e-4)
