"""One wavy face: as steep as cutter and limits allow, within the blank, smooth."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from matstd.artefact.body import Base, Limits, max_slope, min_concave_radius
from matstd.artefact.hidden import Scan, scanned, write_scan_path
from matstd.artefact.hidden.scan_path import scan_path
from matstd.artefact.layout import Blank, Wave, holes_on, wavy_face, with_spheres
from matstd.artefact.place import Family, FamilyFigures, families
from matstd.artefact.place.family import chosen_family, flat_pads, score_of
from matstd.artefact.price import Estimate
from matstd.artefact.worth import ball_places
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.units import DEG, UM

BLANK = Blank()
WAVE = Wave((0.0, 0.0), (80.0, 70.0), 60.0, 45.0 * DEG)
AT_ZERO = np.array([[0.0]])  # table pose


def with_face(face, *centres):
    """A standard of the face and balls on posts."""
    return replace(with_spheres(BLANK, [np.array(c) for c in centres]), patches=(face,))


@pytest.mark.parametrize("flatness", [0.0, 0.9])
@pytest.mark.parametrize("wavelength", [45.0, 60.0, 80.0])
def test_waves_reach_one_limit_and_exceed_none(wavelength, flatness):
    face = wavy_face("FF1", BLANK, replace(WAVE, wavelength=wavelength, flatness=flatness))
    slope, radius, limits = max_slope(face), min_concave_radius(face), BLANK.limits
    assert slope <= limits.max_slope
    assert radius >= limits.min_concave_radius
    assert slope > 0.95 * limits.max_slope or radius < 1.05 * limits.min_concave_radius


def test_a_sine_is_the_sine_of_the_formula():
    """Slope sqrt(2) A k and radius 1 / (A k^2) at the height that the net was given."""
    face = wavy_face("FF1", BLANK, replace(WAVE, wavelength=80.0, slope=30.0 * DEG))
    k = 2.0 * np.pi / 80.0
    amplitude = np.tan(30.0 * DEG / 1.03) / (np.sqrt(2.0) * k)
    assert min_concave_radius(face) == pytest.approx(1.0 / (amplitude * k**2), rel=0.05)
    height = face.height(face.grid(1.0))
    assert np.ptp(height) == pytest.approx(4.0 * amplitude, rel=0.03)


def test_normals_point_everywhere():
    face = wavy_face("FF1", BLANK, WAVE)
    n = face.normal(face.grid(2.0))
    assert np.abs(n.mean(axis=0)[:2]).max() < 0.05
    azimuth = np.histogram(np.arctan2(n[:, 1], n[:, 0]), bins=8, range=(-np.pi, np.pi))[0]
    assert azimuth.min() > 0.5 * azimuth.mean()


def test_the_face_stands_on_the_base_and_under_the_top():
    face = wavy_face("FF1", BLANK, WAVE)
    z = face.point(face.grid(2.0))[:, 2]
    assert z.min() > BLANK.base.thickness + 8.0
    low = replace(BLANK, height=60.0)
    with pytest.raises(NotBuildable, match=r"waves of 60 mm and 45 degrees rise to .* 60 mm high"):
        wavy_face("FF1", low, WAVE)


def test_a_cutter_that_is_too_large_makes_flatter_waves():
    radii = (6.0, 12.0, 25.0)
    blanks = [replace(BLANK, limits=Limits(min_concave_radius=radius)) for radius in radii]
    slopes = [max_slope(wavy_face("FF1", blank, WAVE)) for blank in blanks]
    assert all(a >= b for a, b in pairwise(slopes))
    assert slopes[-1] < 0.7 * slopes[0]


def test_the_mean_plane_of_a_wave_is_level(upright):
    face = wavy_face("FF1", BLANK, WAVE).mean_plane()
    assert np.degrees(max_slope(face)) < 5.0
    pads = flat_pads(upright)
    for pad, own in zip(pads.patches, upright.patches, strict=True):
        grid = own.grid()
        assert np.abs(pad.curvature(grid)).max() < 1e-9
        assert pad.height(grid).mean() == pytest.approx(own.height(grid).mean(), abs=0.05)


@pytest.mark.parametrize(
    ("goal", "signals", "lefts", "wins"),
    [
        ("prove", (10.0, 8.0, 8.0, 16.0), (1.0, 1.01, 1.01, 1.01), Family.WAVY),
        ("prove", (10.0, 9.7, 9.0, 9.0), (1.0, 1.01, 1.01, 1.01), Family.FACES),
        ("prove", (10.0, 9.0, 9.6, 16.0), (1.0, 1.01, 1.01, 1.03), Family.FLAT),
        ("prove", (10.0, 9.0, 9.5, 16.0), (1.0, 1.01, 1.01, 1.03), Family.BALLS),
        ("prove", (10.0, 9.0, 9.5, 16.0), (1.0, 1.03, 1.03, 1.03), Family.BALLS),
        ("identify", (10.0, 8.0, 8.0, 16.0), (1.0, 1.01, 1.02, 0.99), Family.WAVY),
        ("identify", (10.0, 8.0, 8.0, 16.0), (1.0, 1.01, 1.02, 1.02), Family.FACES),
        ("worst", (10.0, 8.0, 8.0, 16.0), (1.0, 1.01, 1.02, 1.02), Family.FACES),
    ],
)
def test_the_family_that_wins(goal, signals, lefts, wins):
    figures = tuple(
        FamilyFigures(family, rms_user=left * UM, worst_user=2.0 * left * UM, signal=signal)
        for family, signal, left in zip(Family, signals, lefts, strict=True)
    )
    assert chosen_family(figures, goal, 1.0 * UM) is wins


def test_a_family_that_cannot_be_built_does_not_win():
    figures = (
        FamilyFigures(Family.FACES, 1.0 * UM, signal=5.0),
        FamilyFigures(Family.WAVY, refused="no room"),
    )
    assert chosen_family(figures, "prove", 1.0 * UM) is Family.FACES
    assert chosen_family(figures, "identify", 1.0 * UM) is Family.FACES


@pytest.mark.parametrize(
    ("goal", "score"),
    [
        ("identify", 500.0),  # 1 / 0.002 mm
        ("worst", 250.0),
        ("prove", 6.0),
        ("minutes", 2.0),  # 100 touches of 3.6 s are 6 min, and 3 min of scan: 6 / sqrt(9)
        ("price", 0.01),
    ],
)
def test_the_figure_of_a_goal_by_hand(goal, score):
    one = FamilyFigures(
        Family.WAVY, rms_user=2.0 * UM, worst_user=4.0 * UM, signal=6.0, touches=100,
        scan_minutes=3.0, price=Estimate(100.0, 10.0),
    )  # fmt: skip
    assert score_of(one, goal) == pytest.approx(score)
    assert score_of(replace(one, price=None), "price") == 1.0


def test_where_no_family_can_be_built_the_first_reason_is_reported(monkeypatch):
    def refused(_, family, like=None):
        raise NotBuildable(f"no room for {family}")

    monkeypatch.setattr(families, "_built", refused)
    site = SimpleNamespace(options=SimpleNamespace(family="auto"))
    with pytest.raises(NotBuildable, match="no room for balls"):
        families.built_family(site)


def test_means_of_a_scan_have_the_noise_of_their_points(criterion):
    """A thousand points that share their noise are worth as many as are independent."""
    rng = np.random.default_rng(4)
    scan = Scan(pitch=0.8, u=2.0 * UM, memory=1.5)
    r = np.exp(-0.8 / 1.5)
    noise = np.zeros((40_000, 10))
    noise[:, 0] = rng.normal(size=40_000)
    for i in range(1, 10):
        noise[:, i] = r * noise[:, i - 1] + np.sqrt(1.0 - r**2) * rng.normal(size=40_000)
    assert scan.u_of_mean == pytest.approx(2.0 * UM * noise.mean(axis=1).std(), rel=0.02)
    assert Scan(pitch=0.8, memory=0.0).u_of_mean == pytest.approx(2.0 * UM / np.sqrt(10.0))
    face = wavy_face("FF1", replace(BLANK, base=Base((100.0, 100.0))), WAVE)
    lines = scanned(face, Scan(), AT_ZERO, criterion.reach, with_face(face))
    density = 4.0 * 77.0 * 67.0 / len(lines)  # area of one mean
    assert density == pytest.approx(10.0 * 8.0, rel=0.12)
    assert scan.points(face) > 5000
    assert 3.0 < Scan().minutes(face) < 10.0


def test_the_path_of_a_scan_runs_forth_and_back(criterion, tmp_path):
    face, scan = wavy_face("FF1", BLANK, WAVE), Scan(between=10.0)
    how = face, scan, AT_ZERO, criterion.reach, with_face(face)
    points, line = scan_path(*how)
    assert len(points) == pytest.approx(scan.points(face), rel=0.05)
    assert line[0] == 1
    assert set(np.diff(line).tolist()) == {0, 1}
    steps = np.linalg.norm(np.diff(points.point, axis=0), axis=1)
    assert steps.max() < 1.5 * scan.between / np.cos(45.0 * DEG)  # never back over the face
    assert steps[np.diff(line) == 0].max() < 1.5 * scan.pitch / np.cos(45.0 * DEG)
    count = write_scan_path(tmp_path / "scan.csv", *how)
    comment, head, *rows = (tmp_path / "scan.csv").read_text(encoding="utf-8").splitlines()
    assert count == len(rows) == len(points)
    assert "contact points and normals in the artefact frame" in comment
    names, first = head.split(","), [float(cell) for cell in rows[0].split(",")]
    assert names[:4] == ["line", "x_mm", "y_mm", "z_mm"]
    assert first[1:4] == pytest.approx(points.point[0].tolist(), abs=1e-6)
    q = criterion.reach.readings(points[:1])[0]
    assert first[names.index("X_mm")] == pytest.approx(q[criterion.reach.chain.axis_index("X")])


def test_a_gap_in_a_line_begins_a_new_one(criterion):
    """Slopes that the probe cannot touch are left out, and no number spans them."""
    steep = replace(criterion.reach, steepest=30.0 * DEG)
    face = wavy_face("FF1", BLANK, WAVE)
    how = face, Scan(between=10.0), AT_ZERO
    points, line = scan_path(*how, steep, with_face(face))
    whole = scan_path(*how, criterion.reach, with_face(face))
    assert len(points) < 0.8 * len(whole[0])
    assert line.max() > 2 * whole[1].max()
    steps = np.linalg.norm(np.diff(points.point, axis=0), axis=1)
    assert steps[np.diff(line) == 0].max() < 1.5 * 2.5 / np.cos(45.0 * DEG)


def test_the_body_of_the_probe_clears_what_stands_beside_a_scan(criterion):
    """A ball higher than the stylus is long keeps the body of the probe away, not the tip alone."""
    face, tall = wavy_face("FF1", BLANK, WAVE), (110.0, 0.0, 180.0)
    how, reach = (face, Scan(between=4.0), AT_ZERO), criterion.reach
    points, _ = scan_path(*how, reach, with_face(face, tall))
    free, _ = scan_path(*how, reach, with_face(face))
    assert 0.5 * len(free) < len(points) < len(free)
    ball = points.point + reach.radius * points.normal
    beside = np.hypot(ball[:, 0] - tall[0], ball[:, 1] - tall[1])
    high = tall[2] - ball[:, 2]
    radius = np.array([next(r for end, r in reach.shape.cylinders if end > h) for h in high])
    assert radius.max() > 20.0  # the body, not the stylus, is beside the ball
    assert np.all(beside > radius + 12.5 + reach.room - 1e-9)


def test_screws_stand_round_the_middle():
    """On three corners of a square the middle lies on a side, and the fourth corner swings."""
    wide = replace(BLANK, base=Base((160.0, 160.0)))
    a, b, c = (np.array([hole.x, hole.y]) for hole in holes_on(wide))
    for p, q in ((a, b), (b, c), (c, a)):
        (x, y), (u, v) = p, q - p
        assert abs(x * v - y * u) / np.hypot(u, v) > 55.0


def test_waves_that_a_cutter_leaves_flat_are_refused():
    """A concave radius of 400 mm leaves waves of 60 mm a slope of a degree."""
    limits = replace(BLANK.limits, min_concave_radius=400.0)
    with pytest.raises(NotBuildable, match=r"radius of 412 mm rise by \d degrees, expected 15"):
        wavy_face("FF1", replace(BLANK, limits=limits), WAVE)


def test_a_face_that_leaves_room_for_no_ball_is_refused(criterion):
    blank = replace(BLANK, base=Base((100.0, 100.0)))
    face = wavy_face("FF1", blank, replace(WAVE, half_size=(98.0, 98.0)))
    with pytest.raises(NotReachable, match="no ball has room beside the faces"):
        ball_places(criterion, blank, AT_ZERO, np.random.default_rng(0), [face])
