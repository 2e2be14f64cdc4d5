"""Calibrations of pieces with known truth: errors over stated uncertainties; waves and scrap."""

import tomllib
from pathlib import Path

import cmm_sets
import numpy as np
import pytest

from matstd.api.standards import calibrate
from matstd.artefact.body import read_standard
from matstd.artefact.certify.waviness import dense_lines
from matstd.twin.errors import BadFile
from matstd.twin.units import UM


def calibrated(drawn: Path, rows, **stated):
    points = cmm_sets.write_rows(drawn.with_name("cmm.csv"), rows)
    stated = {"u_scale": cmm_sets.U_SCALE, "body_u": 0.0} | stated
    return calibrate(
        drawn, points, u=cmm_sets.U_POINT, u_feature=cmm_sets.U_FEATURE, accept=True, **stated
    )


def scores(drawn: Path, count: int) -> list[np.ndarray]:
    file, out = tomllib.loads(drawn.read_text()), []
    for seed in range(count):
        piece = cmm_sets.Piece(file, seed, 0.7 * UM)
        calibrated(drawn, piece.rows()).save(drawn.with_name("made.toml"))
        made = tomllib.loads(drawn.with_name("made.toml").read_text())
        out.append(cmm_sets.scores(file, made, piece, np.random.default_rng(seed)))
    return [np.concatenate(part) for part in zip(*out, strict=True)]


def test_errors_of_three_pieces_are_as_stated(drawn) -> None:
    """The bounds are those of a root mean square of so few independent pieces."""
    distances, _, faces = scores(drawn, 3)
    assert 0.7 < np.sqrt(np.mean(distances**2)) < 1.3
    assert 0.7 < np.sqrt(np.mean(faces**2)) < 1.4


@pytest.mark.slow
def test_errors_of_twenty_pieces_are_as_stated(drawn) -> None:
    for z in scores(drawn, 20):
        assert 0.8 < np.sqrt(np.mean(z**2)) < 1.2


def test_waves_that_a_grid_does_not_see_are_in_the_uncertainty(drawn) -> None:
    """Waves of 8 to 15 mm, 2 um: lines show them, without lines they are an assumption."""
    file = tomllib.loads(drawn.read_text())
    piece = cmm_sets.Piece(file, 1, 2.0 * UM)
    seen = calibrated(drawn, piece.rows())
    assert seen.unseen == ()
    rows = piece.rows(lines=False)
    assumed, none = (calibrated(drawn, rows, waviness=w) for w in (2.0 * UM, 0.0))
    assert assumed.unseen == none.unseen == ("FF1", "FF2")
    u = [{n: f.u_form for n, f in c.standard.known.features.items()} for c in (seen, assumed, none)]
    for name in ("FF1", "FF2"):
        assert u[0][name] > 0.5 * UM
        assert u[1][name] == pytest.approx(np.hypot(u[2][name], 2.0 * UM))


def test_a_line_is_long_dense_and_narrow() -> None:
    u = np.linspace(-9.0, 9.0, 19)
    line = np.column_stack([u, np.full(19, 1.3)])
    grid = np.stack(np.meshgrid(u[::3], u[::3], indexing="ij"), -1).reshape(-1, 2)
    both = np.concatenate([grid, line, line[:, ::-1]])
    found = dense_lines(both, (10.0, 10.0))
    assert found.seen == (True, True)
    assert found.judging.tolist() == [False] * 49 + [True] * 38
    assert dense_lines(np.concatenate([grid, line]), (10.0, 10.0)).seen == (True, False)
    assert dense_lines(np.concatenate([grid, line[::3]]), (10.0, 10.0)).seen == (False, False)
    assert dense_lines(np.concatenate([grid, line[:8]]), (10.0, 10.0)).seen == (False, False)
    area = np.stack(np.meshgrid(u, u, indexing="ij"), -1).reshape(-1, 2)
    assert dense_lines(area, (10.0, 10.0)).seen == (True, True)
    assert not dense_lines(area, (10.0, 10.0)).judging.any()


@pytest.mark.parametrize(
    ("half", "pitch", "scatter", "is_seen"),
    [
        (6.0, 1.0, 0.0, True),  # 0.6 of the face
        (5.5, 1.0, 0.0, False),
        (8.0, 2.0, 0.0, True),
        (8.4, 2.1, 0.0, False),
        (9.0, 1.5, 0.09, True),  # 0.18 mm from a point to the next, half the width of a line
        (9.0, 1.5, 0.15, False),  # two lines, of points 3 mm apart
    ],
)
def test_where_a_line_ends(half: float, pitch: float, scatter: float, is_seen: bool) -> None:
    u = np.arange(-half, half + 0.01, pitch)
    line = np.column_stack([u, 1.3 + scatter * (-1.0) ** np.arange(len(u))])
    aside = np.column_stack([np.zeros(20), np.linspace(-9.0, -5.0, 20)])
    found = dense_lines(np.concatenate([aside, line]), (10.0, 10.0))
    assert found.seen == (is_seen, False)
    assert found.judging[20:].all() == found.judging.any() == is_seen


def test_a_dented_ball_does_not_conform_to_its_grade(drawn) -> None:
    """A flattened side, 8 um deep, of a ball of grade 5."""
    rows = cmm_sets.Piece(tomllib.loads(drawn.read_text()), 1, 0.0).rows()
    mine = [i for i, row in enumerate(rows) if row[0].startswith("SPH2_")]
    middle = np.mean([rows[i][1:] for i in mine], axis=0)
    for i in mine[::2]:
        away = np.array(rows[i][1:]) - middle
        rows[i] = (rows[i][0], *(rows[i][1:] - 8 * UM * away / np.linalg.norm(away)))
    found = calibrated(drawn, rows)
    assert "SPH2 form" in found.refusal
    assert [v.feature for v in found.verdicts if v.is_refused and v.characteristic == "form"] == [
        "SPH2"
    ]


def test_a_ball_measured_from_above_is_known_worse_along_z(drawn) -> None:
    piece = cmm_sets.Piece(tomllib.loads(drawn.read_text()), 2, 0.0)
    found = calibrated(drawn, piece.rows())
    known = found.standard.known
    for name in piece.balls:
        x, y, z = (np.sqrt(u**2 - cmm_sets.U_FEATURE**2) for u in known.features[name].along)
        assert z > 1.5 * max(x, y)
    assert known.u_scale == pytest.approx(cmm_sets.U_SCALE)
    found.save(drawn.with_name("made.toml"))
    again = read_standard(drawn.with_name("made.toml")).known
    assert again.features["SPH1"].along == pytest.approx(known.features["SPH1"].along, abs=1e-7)
    assert again.u_scale == pytest.approx(known.u_scale)


def test_four_orientations_cancel_the_squareness_of_the_machine(drawn) -> None:
    """20 urad between x and y of the machine: 2 um over 100 mm in one orientation, none in four."""
    piece = cmm_sets.Piece(tomllib.loads(drawn.read_text()), 4, 0.0)
    rows = piece.rows()
    paths = []
    for angle in (0.0, 90.0, 180.0, 270.0):
        turn = cmm_sets.Rotation.from_euler("z", angle, degrees=True)
        there = turn.apply(np.array([row[1:] for row in rows]))
        there[:, 0] += 20e-6 * there[:, 1]
        turned = [(row[0], *p) for row, p in zip(rows, there, strict=True)]
        paths.append(cmm_sets.write_rows(drawn.with_name(f"cmm_{angle:.0f}.csv"), turned))
    straight = calibrated(drawn, rows).standard

    def apart(points):
        stated = {"u": cmm_sets.U_POINT, "u_feature": cmm_sets.U_FEATURE, "body_u": 0.0}
        found = calibrate(drawn, points, accept=True, **stated).standard
        pairs = zip(found.spheres, straight.spheres, strict=True)
        return max(np.linalg.norm(a.centre - b.centre) for a, b in pairs), found

    one, four = apart(paths[0])[0], apart(paths)
    assert one > 0.5 * UM
    assert four[0] < 0.05 * one
    known = four[1].known.features["SPH1"]
    assert known.points == 160
    assert known.u < 0.6 * one


def test_a_point_of_a_neighbouring_face_is_named(drawn) -> None:
    rows = cmm_sets.Piece(tomllib.loads(drawn.read_text()), 3, 0.0).rows()
    first, other = (next(i for i, r in enumerate(rows) if r[0] == f"FF{k}_9") for k in (1, 2))
    rows[first] = (rows[first][0], *rows[other][1:])
    with pytest.raises(BadFile, match=rf"line {first + 2}: found a point of FF2, expected a point"):
        calibrated(drawn, rows)
