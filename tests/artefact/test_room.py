"""What a standard cannot be is known before it is chosen; what it can be is found."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from matstd.artefact.body import graph_patch
from matstd.artefact.feasibility import (
    check_room,
    lightest_room,
    mutually_probeable,
    room_among,
    touches_on,
    untouchable_faces,
)
from matstd.artefact.layout import (
    Blank,
    balls_on_posts,
    faces_beside,
    freeform_faces,
    most_side_by_side,
    with_spheres,
)
from matstd.artefact.place.body_choice import BodyChoice
from matstd.artefact.reach import ProbeReach, ProbeShape, joined
from matstd.artefact.worth import each_at, sphere_grid
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import pose, rotation
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG

PROBE = ProbeShape(3.0, ((80.0, 2.0), (160.0, 25.0)))
STEEP = Blank(limits=replace(Blank().limits, max_slope=55.0 * DEG))
UPRIGHT = make_chain(
    "upright",
    "[w B' f X Y Z t]",
    {n: Axis((-400.0, 600.0)) for n in "XYZ"} | {"B": Axis((-7.0, 7.0))},
    (0.0, 0.0, 0.0),
)
FROM_SIDE = ProbeReach(UPRIGHT, Setup("a", pose(rotation([-90.0 * DEG, 0.0, 0.0]))), PROBE, 160.0)
AROUND = np.linspace(-3.0, 3.0, 12)[:, None]


@pytest.fixture
def reach(chain):
    return ProbeReach(chain, Setup("a"), PROBE, 160.0)


def heavy(limit: float) -> Blank:
    return Blank(limits=replace(Blank().limits, max_mass=limit))


def mass_of(blank: Blank, faces: tuple = (), balls: tuple = ()) -> float:
    return replace(with_spheres(blank, [b.centre for b in balls]), patches=tuple(faces)).mass(4.0)


def test_pillars_weigh_what_they_may():
    plate = mass_of(Blank())
    for heaviest in (0.5, 0.4):
        faces = freeform_faces(Blank(), 6, 12, np.random.default_rng(2), heaviest=heaviest)
        for face in faces[:2]:
            assert mass_of(Blank(), (face,)) - plate < 1.05 * heaviest
    with pytest.raises(NotBuildable):
        freeform_faces(Blank(), 6, 5, np.random.default_rng(2), heaviest=-1.0)


def test_the_lightest_standard_is_reported_and_can_be_built(reach):
    rng = np.random.default_rng(3)
    faces, balls = freeform_faces(Blank(), 4, 25, rng), balls_on_posts(Blank(), 25, rng)
    refused = lightest_room(room_among(faces, balls, 4, heavy(19.0)), faces, balls)
    assert not refused.is_light
    with pytest.raises(NotBuildable, match=r"lightest standard found weighs .* limit 19 kg") as why:
        check_room(refused)
    assert why.value.facts["binding"] == ["mass"]
    assert mass_of(Blank()) < refused.least
    blank = heavy(np.ceil(10.0 * refused.least) / 10.0)
    check_room(lightest_room(room_among(faces, balls, 4, blank), faces, balls))
    made = built(BodyChoice(SimpleNamespace(reach=reach), blank, 80, rng, refused, False))
    assert mass_of(blank, made.patches, made.spheres) < blank.limits.max_mass


def test_faces_out_of_reach_do_not_lack_room():
    room = replace(room_among([], [], 4, Blank()), tried=30)
    with pytest.raises(NotBuildable, match=r"30 places tried, 0 of which .* travels$"):
        check_room(room)
    with pytest.raises(NotBuildable, match=r"of 0 places tried; between two bodies .* 12 mm"):
        check_room(replace(room, tried=0))


def built(choice: BodyChoice):
    """Faces that stand beside each other, worth alike."""
    balls = list(choice.room.balls)
    poses = AROUND if choice.from_side else np.array([[0.0, a] for a in (-1.5, 0.0, 1.5)])
    touches = joined([each_at(ball, sphere_grid(4), poses) for ball in balls])
    return choice.standard("trial", "", balls, touches, choice.room.wanted, 0)


@pytest.fixture(autouse=True)
def alike(monkeypatch):
    monkeypatch.setattr(
        BodyChoice,
        "_choose_faces",
        lambda _, there, asked: most_side_by_side(there.fits, asked.count),
    )


def test_faces_that_a_probe_from_the_side_touches_are_chosen():
    rng = np.random.default_rng(1)
    faces = freeform_faces(STEEP, 6, 50, rng, from_side=True)
    balls = [b for b in balls_on_posts(STEEP, 30, rng) if b.centre[2] < 75.0]
    room = room_among(faces, balls, 6, STEEP)
    assert untouchable_faces(FROM_SIDE, room.standard, AROUND)  # side by side is not enough
    made = built(BodyChoice(SimpleNamespace(reach=FROM_SIDE), STEEP, 50, rng, room, True))
    assert not untouchable_faces(FROM_SIDE, made, AROUND)


def test_a_face_behind_a_tall_pillar_is_seen_beside_a_low_one_only():
    flat = graph_patch("flat", np.eye(4), (14.0, 14.0), np.zeros((8, 8)))
    heights = -0.8 * flat.poles[..., 0]  # falls along x, towards the probe
    low, behind = (
        graph_patch(name, pose(t=np.array([x, 0.0, z])), (14.0, 14.0), heights, depth=40.0)
        for name, x, z in (("0", 100.0, 50.0), ("1", 0.0, 110.0))
    )
    tall = replace(low, name="2", T_artefact_patch=pose(t=np.array([100.0, 0.0, 130.0])))
    from_x = np.array([[-90.0 * DEG], [90.0 * DEG]])  # of which one is from the other side
    seen = mutually_probeable(FROM_SIDE, STEEP, [low, behind, tall], (), from_x)
    assert seen.reached.all()
    assert seen.alone.all()
    assert seen.beside[1, 0]
    assert not seen.beside[1, 2]


def test_what_is_seen_alone_is_what_the_touches_say_whatever_number_a_ball_has():
    """Places of faces and of balls are both named by their numbers."""
    rng = np.random.default_rng(4)
    balls = balls_on_posts(STEEP, 5, rng)[:2]
    faces = freeform_faces(STEEP, 6, 12, rng, balls, from_side=True)
    faces = [f for f, ok in zip(faces, faces_beside(faces, balls, STEEP), strict=True) if ok]
    assert {b.name for b in balls} <= {f.name for f in faces}
    seen = mutually_probeable(FROM_SIDE, STEEP, faces, balls, AROUND)
    bare = with_spheres(STEEP, [b.centre for b in balls])
    alone = [not untouchable_faces(FROM_SIDE, replace(bare, patches=(f,)), AROUND) for f in faces]
    assert 0 < sum(alone) < len(faces)
    np.testing.assert_array_equal(seen.alone, alone)
    within = FROM_SIDE.is_reachable(touches_on(faces, AROUND)).reshape(len(faces), -1)
    np.testing.assert_array_equal(seen.reached, within.any(axis=1))
