"""The first placement: buildable, touchable, the same for a seed, and better than chance."""

from dataclasses import replace

import numpy as np
import pytest
from briefs import brief_of

from matstd.artefact.body import (
    Base,
    Limits,
    Meeting,
    check,
    contact,
    read_standard,
    write_standard,
)
from matstd.artefact.brief import PlacementOptions
from matstd.artefact.compare import proof_power, task_normals
from matstd.artefact.layout import Blank
from matstd.artefact.place import design_standard
from matstd.artefact.reach import ProbeReach, ProbeShape, clearance
from matstd.artefact.worth import CriterionOptions, TouchOptions, poses_within
from matstd.artefact.worth.potential import library_effects
from matstd.information.criteria import Posterior
from matstd.sensitivity.population import Group, Population, drawn_scales, grouped
from matstd.twin.errors import DesignError, NotBuildable, NotReachable
from matstd.twin.machine import table_to_tool, tip
from matstd.twin.model import Model, columns
from matstd.twin.record import Setup
from matstd.twin.units import DEG, NM, UM

pytestmark = pytest.mark.slow  # whole designs; `test_placement_parts` and the command's test stay

LENGTH = 160.0
PROBE = ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0)))
CHOICE = TouchOptions(touches=160, poses=12, proof=60)
OPTIONS = PlacementOptions(name="trial", patches=5, sites=90, choice=CHOICE)


@pytest.fixture(scope="module")
def reach(chain):
    return ProbeReach(chain, Setup("a"), PROBE, LENGTH)


@pytest.fixture(scope="module")
def placement(reach, workspace):
    return design_standard(brief_of(reach, workspace, OPTIONS), np.random.default_rng(3))


def test_the_standard_meets_every_limit(placement):
    check(placement.standard, Limits())
    assert len(placement.standard.patches) == 5
    assert 4 <= len(placement.standard.spheres) <= 13
    assert len(placement.standard.holes) == 3
    centres = np.stack([s.centre for s in placement.standard.spheres])
    assert np.ptp(centres[:, 2]) > 50.0
    # balls stand on all sides: no half space around the axis is without one
    azimuth = np.sort(np.arctan2(centres[:, 1], centres[:, 0]))
    gaps = np.diff(np.append(azimuth, azimuth[0] + 2.0 * np.pi))
    assert gaps.max() < np.pi


def test_touches_lie_on_their_features(placement):
    requests, standard = placement.touches, placement.standard
    assert (len(placement.requests), len(placement.proof)) == (160, 60)
    for name in np.unique(requests.feature):
        mine = requests[requests.feature == name]
        surface = standard.features[name]
        uv = surface.project(mine.point)
        np.testing.assert_allclose(surface.point(uv), mine.point, rtol=0, atol=NM)
        np.testing.assert_allclose(surface.normal(uv), mine.normal, rtol=0, atol=1e-9)
        assert surface.contains(uv).all()
    assert set(placement.proof.feature) <= {p.name for p in standard.patches}
    assert set(placement.requests.feature) <= {s.name for s in standard.spheres}


def test_touches_are_spread_over_poses_and_features(placement):
    requests = placement.requests
    count = np.bincount(requests.pose)
    assert len(count) == 12
    assert count.max() <= np.ceil(1.6 * 160 / 12)
    on_face = dict(zip(*np.unique(placement.proof.feature, return_counts=True), strict=True))
    area = {p.name: np.prod(p.half_size) for p in placement.standard.patches}
    for name, count in on_face.items():  # a place on a face that no pose reaches takes its share
        assert 0.6 < count / (60.0 * area[name] / sum(area.values())) < 1.5
    keys = np.column_stack([requests.point, requests.rotary])
    assert len(np.unique(np.round(keys, 6), axis=0)) == 160  # no touch twice


def test_every_touch_can_be_made(placement, reach, chain):
    requests, standard = placement.touches, placement.standard
    q = reach.readings(requests)
    ball = requests.point + 3.0 * requests.normal
    np.testing.assert_allclose(tip(chain, q, LENGTH), ball, rtol=0, atol=NM)
    for i, name in enumerate(chain.axes):
        low, high = chain.link(name).range
        assert np.all((q[:, i] >= low) & (q[:, i] <= high))
    axis = table_to_tool(chain, q)[:, :3, 2]
    cosine = np.einsum("ni,ni->n", axis, requests.normal)
    assert cosine.min() >= np.cos(75.0 * DEG) - 1e-9
    assert clearance(standard, ball, axis, PROBE).distance.min() >= 2.0
    met = contact(standard, ball + 5.0 * requests.normal, -requests.normal, 3.0, 8.0)
    assert np.all(met.meeting == Meeting.SURFACE)
    assert np.all(met.feature == requests.feature)
    np.testing.assert_allclose(met.travel, 5.0, rtol=0, atol=NM)


def test_prediction_is_far_beyond_tenfold_and_better_than_chance(placement):
    own = placement.own
    assert own.rms < 0.02 * placement.prior_rms[0]
    assert own.rms_user < 0.05 * placement.prior_rms[1]
    assert own.rms < 0.9 * own.rms_random
    assert own.rms < own.p95
    by_name = {r.name: r for r in placement.rivals}
    assert {f"{n} spheres" for n in (4, 5, 7, 13)} < set(by_name)
    assert len(by_name) == 10
    assert own.rms < 0.6 * by_name["one freeform face"].rms
    assert own.rms < 0.6 * by_name["five-sided block"].rms
    ideal = by_name["ideal scatter, chosen by I"]
    assert ideal.rms < own.rms  # an honest yardstick
    assert ideal.rms < by_name["ideal scatter, at random"].rms
    assert by_name["ideal scatter, chosen by D"].estimable > ideal.estimable - 0.5
    for rival in placement.rivals:
        assert rival.rms < rival.p95
        assert rival.rms_user < rival.p95_user
        assert 0 < rival.visible <= rival.could_be_visible
    assert own.visible > by_name["one freeform face"].visible
    spheres = [by_name[f"{n} spheres"].rms_user for n in (4, 5, 7, 13)]
    assert own.rms_user < 1.02 * min(spheres)


@pytest.mark.parametrize("of_task", [False, True])
def test_the_power_of_the_faces_is_that_of_a_drawn_test(placement, reach, of_task):
    """Whole experiments drawn at random with one effect, decided by their own scatter."""
    from scipy.stats import chi2

    criterion, rng = placement.criterion.on(placement.standard), np.random.default_rng(1)
    before, after = placement.requests, placement.proof
    W, C = criterion.whitened(before), criterion.calibrated(before)
    Wp, Cp = criterion.whitened(after), criterion.calibrated(after)
    V = np.eye(160) + C @ C.T
    whole = np.linalg.inv(np.eye(W.shape[1]) + W.T @ np.linalg.solve(V, W))
    estimate = whole @ np.linalg.solve(V, W).T

    def left(shift_before, shift_after, count):
        theta = rng.normal(size=(count, W.shape[1]))
        place = rng.normal(size=(count, C.shape[1]))
        seen = theta @ W.T + place @ C.T + rng.normal(size=(count, 160)) + shift_before
        noise = rng.normal(size=(count, 60))
        return (theta - seen @ estimate.T) @ Wp.T + place @ Cp.T + noise + shift_after

    scatter = np.cov(left(0.0, 0.0, 20000).T)
    (effect,) = [e for e in library_effects(reach.touches(before)) if e.name == "periodic(EXX)"]
    mix = rng.normal(size=len(effect.parameters))
    rows = [columns([effect], reach.touches(t)) @ mix / criterion.noise for t in (before, after)]
    tip = criterion.tip_volume * criterion.prior_sd
    own = Model(reach.chain, (effect,)).tip_columns(criterion.at_volume) @ mix
    wrong = own - tip @ (estimate @ rows[0])
    normals = task_normals(criterion, after, rng) if of_task else None
    if of_task:  # no steeper than the faces, and unit vectors
        assert normals[:, 2].min() > after.normal[:, 2].min() - 1e-9
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
        wrong = np.sum(wrong * normals, axis=1, keepdims=True)
    size = 2.0 * UM / np.sqrt(np.mean(np.sum(wrong**2, axis=1)))
    drawn = left(size * rows[0], size * rows[1], 2000)
    statistic = np.sum(drawn * np.linalg.solve(scatter, drawn.T).T, axis=1)
    found = np.mean(statistic > chi2.isf(0.05, 60))

    class Fixed:
        def normal(self, size):
            return np.tile(mix[:, None], (1, size[1]))

    power = proof_power(criterion, before, after, [effect], Fixed(), normals)
    assert power.effects == ("periodic(EXX)",)
    assert power.power[0] == pytest.approx(found, abs=0.05)


def test_certificate_is_of_the_choice(placement):
    found, criterion = placement.certificate, placement.criterion
    rows = criterion.on(placement.standard).rows(placement.requests)
    assert found.count == 160
    assert found.value == pytest.approx(
        criterion.on(placement.standard).objective.value(rows.T @ rows), rel=1e-6
    )
    assert 0.5 < found.efficiency <= 1.0


def test_figures_are_those_of_the_information(placement):
    criterion = placement.criterion
    here = criterion.on(placement.standard)
    posterior = Posterior(
        here.known_rows(placement.requests), criterion.prior_sd, criterion.model.names
    )
    rms = np.sqrt(np.mean(posterior.predicted_sd(criterion.tip_volume) ** 2))
    assert placement.own.rms == pytest.approx(rms, rel=1e-12)
    both = np.concatenate([criterion.tip_volume, criterion.tip_user])
    plain = criterion.plain.on(placement.standard)
    rows = plain.rows(placement.requests)
    mean_square = np.mean(posterior.predicted_sd(both) ** 2)
    assert plain.objective.value(rows.T @ rows) == pytest.approx(mean_square, rel=1e-6)


def test_every_patch_says_what_it_is_for(placement, chain):
    known = {s.name for s in chain.symbols}
    for patch in placement.standard.patches:
        assert len(patch.errors) == 4
        shares = [e.share for e in patch.errors]
        assert shares == sorted(shares, reverse=True)
        assert 0.02 < sum(shares) < 1.0
        assert {e.name for e in patch.errors} <= known
        assert not any(e.name.endswith(("0w", "0t")) for e in patch.errors)
    named = {e.name for p in placement.standard.patches for e in p.errors}
    assert len(named) >= 8  # patches are for different errors


def test_the_same_seed_gives_the_same_standard(reach, workspace):
    """A small design says it as well as a large one."""
    options = PlacementOptions(patches=3, sites=30, choice=TouchOptions(60, 5, 30))
    first, again = (
        design_standard(brief_of(reach, workspace, options), np.random.default_rng(3))
        for _ in range(2)
    )
    np.testing.assert_array_equal(again.requests.point, first.requests.point)
    for one, other in zip(again.standard.patches, first.standard.patches, strict=True):
        np.testing.assert_array_equal(one.heights, other.heights)


def test_too_many_patches_for_a_blank_are_refused(reach, workspace):
    options = PlacementOptions(patches=16, sites=60, choice=CHOICE)
    small = Blank(base=Base(half_size=(70.0, 70.0), corner_radius=10.0))
    with pytest.raises(NotBuildable, match="patches"):
        design_standard(brief_of(reach, workspace, options, small), np.random.default_rng(1))


def test_a_blank_larger_than_the_table_is_refused(reach, workspace):
    large = Blank(base=Base(half_size=(250.0, 140.0)))
    with pytest.raises(NotBuildable, match="500 x 280 mm is larger than the table, diameter"):
        design_standard(brief_of(reach, workspace, OPTIONS, large), np.random.default_rng(1))


def test_limits_that_nothing_meets_are_named(reach, workspace):
    light = Blank(limits=Limits(max_mass=5.0))
    with pytest.raises(NotBuildable, match=r"the lightest standard found weighs .* kg, limit 5 kg"):
        design_standard(brief_of(reach, workspace, OPTIONS, light), np.random.default_rng(1))


def test_a_standard_beyond_the_travel_is_refused(chain, workspace):
    away = np.eye(4)
    away[:3, 3] = [2000.0, 0.0, 0.0]
    far = ProbeReach(chain, Setup("a", away), PROBE, LENGTH)
    with pytest.raises(NotReachable, match="every axis within its limits"):
        design_standard(brief_of(far, workspace, OPTIONS), np.random.default_rng(1))


def test_an_unknown_criterion_is_refused():
    with pytest.raises(DesignError, match="criterion 'T', expected one of I, G, D, A, E"):
        PlacementOptions(criterion=CriterionOptions("T"))


def test_poses_keep_room_to_be_approached(chain):
    rotary = np.array([(-360.0 * DEG, 360.0 * DEG), (-110.0 * DEG, 30.0 * DEG)])
    poses = poses_within(chain, rotary, 18)
    assert 80 <= len(poses) <= 140
    assert poses[:, 1].min() >= -104.0 * DEG - 1e-9
    assert poses[:, 1].max() <= 24.0 * DEG + 1e-9
    np.testing.assert_allclose(poses / DEG, np.round(poses / DEG), atol=1e-9)
    assert len(np.unique(poses[:, 1])) > 20  # many different readings of B
    narrow = np.array([(0.0, 0.0), (-109.0 * DEG, -108.0 * DEG)])
    with pytest.raises(NotReachable, match="leave no room: they are approached from both sides"):
        poses_within(chain, narrow, 18)


class ScalesAreDrawn(Exception):
    """Placement has come as far as the sizes of the errors."""


def test_groups_of_errors_reach_the_placement(reach, workspace, chain, monkeypatch):
    """A machine that is drawn for the criterion has the errors of a group equally large."""
    names, drawn = ("EXX", "EYY", "EZZ"), []

    def recorded(population, count, rng, model):
        drawn.append((model.names, drawn_scales(population, count, rng, model)))
        raise ScalesAreDrawn

    monkeypatch.setattr("matstd.artefact.worth.touch_criterion.drawn_scales", recorded)
    options = replace(OPTIONS, criterion=CriterionOptions(robust_machines=6))
    for groups in ([Group(names, correlation=1.0)], [Group(names, correlation=0.0)]):
        population = Population(chain, dependence=grouped(groups))
        brief = brief_of(reach, workspace, options, errors=population)
        with pytest.raises(ScalesAreDrawn):
            design_standard(brief, np.random.default_rng(3))
    spread = []
    for parameters, scale in drawn:
        columns = [[n in p for p in parameters].index(True) for n in names]
        spread.append(np.ptp(scale[:, columns], axis=1).max())
    assert spread[0] < 1e-12 < 0.1 < spread[1]


@pytest.mark.parametrize("family", ["wavy", "flat", "auto"])
def test_other_families_meet_every_limit_and_identify_as_balls_do(reach, workspace, family):
    options = replace(OPTIONS, family=family, choice=TouchOptions(touches=120, poses=8, proof=40))
    if family == "wavy":  # where it is to prove, a larger face may cost a third
        options = replace(options, goal="identify")
    made = design_standard(brief_of(reach, workspace, options), np.random.default_rng(3))
    check(made.standard, Limits())
    assert len(made.standard.holes) == 3
    assert len(made.proof) == 40
    balls = min(r.rms_user for r in made.rivals if r.body is not None and not r.body.patches)
    if family == "wavy":
        assert made.family == "wavy"
        assert len(made.standard.patches) == 1
        assert min(made.standard.patches[0].half_size) > 50.0
        assert made.own.rms_user <= 1.05 * balls  # chosen by the criterion, within 2 % of its root
    if family == "auto":
        built = {one.family for one in made.families if not one.refused}
        assert {"balls", "faces", "flat"} <= built
        own = next(one for one in made.families if one.family == made.family)
        fit = [f for f in made.families if f.rms_user <= 1.02 * balls]
        assert own.signal == max(f.signal for f in fit)
    own = next(one for one in made.families if one.family == made.family)
    assert own.rms_user == pytest.approx(made.own.rms_user, rel=1e-9)
    assert own.touches == 160


def test_balls_alone_are_a_standard_of_their_own(reach, workspace, tmp_path):
    options = replace(OPTIONS, family="balls")
    placed = design_standard(brief_of(reach, workspace, options), np.random.default_rng(3))
    made = placed.standard
    check(made, Limits())
    assert not made.patches
    assert 1 <= len(made.proving) <= options.patches
    assert set(placed.proof.feature) <= set(made.proving)
    assert not set(placed.requests.feature) & set(made.proving)
    spheres = [r.rms_user for r in placed.rivals[1:] if r.body is not None and not r.body.patches]
    assert placed.own.rms_user <= 1.02 * min(spheres)
    write_standard(tmp_path / "s.toml", made)
    again = read_standard(tmp_path / "s.toml")
    assert again.proving == made.proving
    assert again.fingerprint == made.fingerprint
