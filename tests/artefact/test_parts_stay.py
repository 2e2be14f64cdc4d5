"""What bodies, probes, effects and prices are by number, as it was when it was looked at."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from unchanged import Unchanged, facts, folded

from matstd.artefact.body import Core, constraints, contact, max_slope, min_concave_radius
from matstd.artefact.brief import read_project
from matstd.artefact.compare import identifiability_report, proof_power, task_normals
from matstd.artefact.feasibility import in_the_way, mutually_probeable, room_among, touches_on
from matstd.artefact.hidden import (
    Scan,
    hidden_power,
    measured_together,
    possible_places,
    scanned,
    showing_touches,
    touched,
)
from matstd.artefact.layout import (
    Blank,
    balls_fit,
    balls_on_posts,
    faces_fit,
    freeform_faces,
    holes_on,
    most_side_by_side,
    rivals,
)
from matstd.artefact.price import prices_of
from matstd.artefact.reach import clearance, joined
from matstd.artefact.tool import Probe, solid_hull, swing_height, top_height
from matstd.artefact.worth import (
    CriterionOptions,
    criterion_for,
    random_touches,
    touch_curve,
    visibility,
)
from matstd.artefact.worth.touch_criterion import CRITERIA
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population

EXAMPLES = Path(__file__).parents[2] / "examples"
BALL = 3.0


@pytest.fixture(scope="module")
def touches(criterion):
    return random_touches(
        criterion.reach, criterion.volume, criterion.rotary, 60, np.random.default_rng(7)
    )


@pytest.mark.parametrize("name", ["standard", "upright", "on a core"])
def test_a_body_is_what_it_was(request, name: str, unchanged: Unchanged) -> None:
    """Its limits, shapes, distances, and what a ball meets that comes from anywhere."""
    made = request.getfixturevalue("upright" if name == "on a core" else name)
    if name == "on a core":
        made = replace(made, core=Core(30.0, 22.0, 60.0))
    rng = np.random.default_rng(3)
    around = rng.uniform((-90.0, -90.0, -5.0), (90.0, 90.0, 130.0), (150, 3))
    way = rng.normal(size=(150, 3)) - [0.0, 0.0, 1.0]
    lines = [facts(constraints(made, Blank().limits))]
    for patch in made.patches[:3]:
        uv = patch.grid(4.0, beyond=1.0)
        jet = patch.jet(uv)
        shape = max_slope(patch), min_concave_radius(patch), patch.curvature(uv), patch.slope(uv)
        lines.append(facts((shape, jet, patch.normal(uv), patch.mean_plane(), patch.errors)))
        lines.append(facts(patch.project(patch.point(uv) + 0.3 * patch.normal(uv))))
    lines += [facts({n: b.distance(around) for n, b in made.bodies.items()})]
    lines += [facts((made.volume(4.0), made.mass(4.0), made.distance(around)))]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    lines.append(facts(contact(made, around, way, BALL)))
    lines.append(facts(contact(made, around + np.array([0.0, 0.0, 130.0]), way, BALL, 150.0)))
    lines.append(facts(prices_of(made)))
    unchanged(folded("\n".join(lines)))


def test_what_stands_on_a_blank_is_what_it_was(criterion, unchanged: Unchanged) -> None:
    """Faces, balls and screws that are drawn for it; what fits beside what; other artefacts."""
    blank, rng, reach = Blank(), np.random.default_rng(5), criterion.reach
    balls = balls_on_posts(blank, 14, rng)
    faces = freeform_faces(blank, 4, 16, rng, from_side=True)
    between = freeform_faces(blank, 3, 12, rng, balls[:3], holes_on(blank, balls[:3]), False, 6.0)
    holes, poses = holes_on(blank, balls[:4], faces[:1]), np.array([[0.0], [1.0]])
    beside = mutually_probeable(reach, blank, between, balls[:3], poses)
    fits, hides = (
        faces_fit(faces, holes, blank.limits),
        in_the_way(reach, blank, between, touches_on(faces, poses)),
    )
    lots = (balls, faces, between, holes, balls_fit(balls, blank), fits, beside, hides)
    some = most_side_by_side(fits, 4, starts=80), room_among(faces, balls, 4, blank)
    others = {name: made.features for name, made in rivals(criterion.volume, blank, rng).items()}
    unchanged(folded(facts((lots, some, others))))


def test_what_a_probe_reaches_is_what_it_was(criterion, upright, touches, unchanged) -> None:
    """Reasons against touches, room of the probe, and heights at which a table may turn."""
    reach, probe, poses = criterion.reach, Probe(), np.linspace(-3.0, 3.0, 7)[:, None]
    tried = touches_on(upright.patches, poses)
    axis = np.array([[0.0, 0.0, 1.0], [0.3, 0.1, 0.95], [0.0, -0.6, 0.8]])
    lines = [facts(reach.reasons(upright, tried)), facts(reach.readings(tried))]
    for tool in axis / np.linalg.norm(axis, axis=1, keepdims=True):
        lines.append(facts(clearance(upright, touches.point, tool, probe.shape)))
        lines.append(facts(clearance(upright, touches.point, tool, probe.shape, 20.0, True)))
    solid = solid_hull(upright, reach.setup, reach.workshop)
    lines.append(facts((solid, top_height(reach.chain, poses, solid, probe))))
    lines.append(facts(swing_height(reach.chain, poses, solid, probe, -60.0)))
    unchanged("\n".join(lines))


def test_what_touches_show_is_what_it_was(criterion, upright, touches, unchanged) -> None:
    """Hidden effects, those of the library, worth of single touches, regions."""
    here, reach, rng = criterion.plain.on(upright), criterion.reach, np.random.default_rng(8)
    poses = np.array([[0.0], [1.5]])
    at = possible_places(reach, criterion.volume, poses, rng)
    scan = scanned(upright.patches[0], Scan(), poses, reach, upright)
    tried = touches_on(upright.patches, poses)
    on_faces, on_balls = touched(tried, criterion.noise), touched(touches, criterion.noise)
    power = hidden_power(here, measured_together([on_balls, scan, on_faces]), at)
    place = np.arange(len(tried)), np.unique(tried.feature, return_inverse=True)[1]
    some = showing_touches(here, on_balls, on_faces, at, 9, *place)
    many = random_touches(reach, criterion.volume, criterion.rotary, 240, rng)
    library = visibility(criterion, many)
    rows = criterion.rows(touches), criterion.known_rows(touches), criterion.whitened(tried)
    curve = touch_curve(criterion, "", touches, counts=(20, 60))
    few, normals = library.effects[::5], task_normals(criterion, tried, rng)
    proofs = [
        proof_power(here, joined([many, tried[::2]]), tried[1::2], few, rng, n)
        for n in (None, normals)
    ]
    seen = library.shown(criterion, joined([touches, tried]))
    shown = [effect.name for effect in library.effects], seen
    unchanged(facts((scan.u, power, some, shown, proofs, rows, curve, at)))


def test_criteria_are_what_they_were(criterion, touches, unchanged) -> None:
    """What touches are worth by every criterion, with potential effects, on drawn machines."""
    reach, noise, population = criterion.reach, criterion.noise, Population(criterion.reach.chain)
    limits = {"X": (-100.0, 100.0), "Y": (-100.0, 100.0), "Z": (-250.0, -50.0)}
    area, lines = Workspace(reach.chain, limits, 160.0), []
    for name in CRITERIA:
        options = CriterionOptions(name, 0.3, 4, 0.5)
        made = criterion_for(
            reach, criterion.model, Blank(), area, noise, np.random.default_rng(4), options, 60,
            population,
        )  # fmt: skip
        rows, terms = made.rows(touches), made.potential
        value = made.objective.value(rows.T @ rows)
        # a term has either sign
        signless = np.abs(rows), np.abs(terms.mix), np.abs(terms.imitation)
        lines.append(facts((name, value, len(terms), signless, made.tip_user)))
    lines.append(" ".join(terms.names))
    unchanged("\n".join(lines))


def test_what_is_identifiable_is_what_it_was(criterion, touches, unchanged) -> None:
    report = identifiability_report(criterion, touches, np.random.default_rng(5))
    alike = [(f.parameter, f.reason, f.resolution, len(f.alike)) for f in report.gauge.freedoms]
    shown = replace(report, model=None, freedoms=(), gauge=replace(report.gauge, freedoms=alike))
    unchanged(folded(facts(shown)))


@pytest.mark.parametrize("name", ["hsm600u", "wavy_face"])
def test_a_brief_is_what_it_was(name: str, unchanged: Unchanged) -> None:
    """What an example asks for, in base units, with every default."""
    unchanged(facts(read_project(EXAMPLES / f"{name}.toml")))
