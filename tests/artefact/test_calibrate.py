"""A standard with planted errors, a CMM that measures it somewhere, and what comes back."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from unchanged import facts

from matstd.artefact.body import read_standard, write_standard
from matstd.artefact.body.spline import greville
from matstd.artefact.certify import fit_calibration, read_cmm_points
from matstd.artefact.certify.calibration_fit import fitted_ball, measured_balls
from matstd.artefact.certify.cmm_points_file import CmmPoints
from matstd.artefact.certify.cmm_stylus import TIP, TO_PIVOT, Angle, choose_stylus, reaches
from matstd.artefact.certify.dmis import APPROACH
from matstd.artefact.tool import Probe
from matstd.artefact.worth import Calibration
from matstd.cad_out.details import engraved_on
from matstd.cli import main
from matstd.diagnosis.answer import diagnose
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign import VirtualMachine, simulate
from matstd.probe_paths.emit import Feeds, make_programs
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.plan import PlanOptions, plan_touches
from matstd.stages.cmm import cmm_program
from matstd.twin.errors import BadFile, NotEnoughData
from matstd.twin.frames import apply, pose, rotation
from matstd.twin.library import ordinary_model
from matstd.twin.units import UM

ROOT = Path(__file__).parents[2]
NOISE = 0.3 * UM
"""Of a point of the CMM."""

ELSEWHERE = pose(rotation(np.array([0.01, -0.02, 1.2])), np.array([300.0, 200.0, -50.0]))
"""The standard in the frame of the CMM."""

SHIFT = np.array([[0.02, -0.01, 0.015], [-0.01, 0.01, -0.02], [0.0, 0.025, 0.01]])
"""How far the balls stand beside their places, mm."""


def form(uv: np.ndarray) -> np.ndarray:
    """What was planted on FF1, along the normal, mm: place, tilt and a wave."""
    u, v = uv.T / 15.0
    return 6 * UM + 4 * UM * u + 7 * UM * np.sin(2.2 * u + 1.0) * np.cos(1.5 * v)


@pytest.fixture(scope="module")
def nominal(golden):
    return golden.standard()


def cmm_rows(nominal, rng, per_face: int = 120, per_ball: int = 25) -> list[tuple]:
    """Points on the real standard in the frame of the CMM, by formulas of this file."""
    rows = []
    for ball, shift in zip(nominal.spheres, SHIFT, strict=True):
        n = rng.normal(size=(per_ball, 3))
        n[:, 2] = np.abs(n[:, 2])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        r = ball.radius + 0.7 * UM + NOISE * rng.normal(size=(per_ball, 1))
        rows += [(ball.name, *p) for p in apply(ELSEWHERE, ball.centre + shift + r * n)]
    for patch in nominal.patches:
        a, b = patch.half_size
        uv = rng.uniform(-1.0, 1.0, (per_face, 2)) * [a, b]
        high = form(uv) if patch.name == "FF1" else np.zeros(per_face)
        high = high + NOISE * rng.normal(size=per_face)
        p = patch.point(uv) + high[:, None] * patch.normal(uv)
        rows += [(f"{patch.name}_{k}", *x) for k, x in enumerate(apply(ELSEWHERE, p))]
    return rows


def written(path: Path, rows, stamp: str = "", unit: str = "mm", scale: float = 1.0) -> Path:
    head = [f"# MATSTD {stamp}"] if stamp else []
    head.append(f"feature,x [{unit}],y [{unit}],z [{unit}]")
    body = [f"{name},{x * scale:.9f},{y * scale:.9f},{z * scale:.9f}" for name, x, y, z in rows]
    path.write_text("\n".join([*head, *body]) + "\n")
    return path


@pytest.fixture(scope="module")
def found(nominal, tmp_path_factory):
    path = tmp_path_factory.mktemp("cmm") / "cmm.csv"
    written(path, cmm_rows(nominal, np.random.default_rng(1)), nominal.fingerprint)
    return fit_calibration(nominal, read_cmm_points(path, nominal), NOISE, 0.2 * UM, 0.0)


def test_features_without_points_stay_as_designed(nominal, golden, tmp_path, unchanged):
    """Three balls of four and one face of two are measured."""
    four = (*nominal.spheres, golden.sphere("SPH4", 60.0, -60.0))
    nominal = replace(nominal, spheres=four)
    rows = cmm_rows(replace(nominal, spheres=four[:3]), np.random.default_rng(1))
    path = written(tmp_path / "cmm.csv", [r for r in rows if not r[0].startswith("FF2")])
    found = fit_calibration(nominal, read_cmm_points(path, nominal), NOISE, 0.2 * UM, 0.0)
    assert found.standard.spheres[3] is nominal.spheres[3]
    assert found.standard.patches[1] is nominal.patches[1]
    assert set(found.standard.known.features) == {"SPH1", "SPH2", "SPH3", "FF1"}
    assert "no points on SPH4, FF2: taken as designed" in " ".join(found.remarks)
    unchanged(facts(replace(found, remarks=())))


def aligned_truth(nominal) -> np.ndarray:
    """Pose that brings the displaced balls back best: the frame of a calibration, (4, 4).

    By Horn's quaternions, the calibration uses singular values.
    """
    a = np.array([s.centre for s in nominal.spheres]) + SHIFT
    b = np.array([s.centre for s in nominal.spheres])
    S = (a - a.mean(0)).T @ (b - b.mean(0))
    d = [S[1, 2] - S[2, 1], S[2, 0] - S[0, 2], S[0, 1] - S[1, 0]]
    N = np.block(
        [[np.trace(S), np.array(d)], [np.array(d)[:, None], S + S.T - np.trace(S) * np.eye(3)]]
    )
    w, x, y, z = np.linalg.eigh(N)[1][:, -1]
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return pose(R, b.mean(0) - R @ a.mean(0))


def test_balls_and_faces_are_where_they_were_planted(nominal, found) -> None:
    back = aligned_truth(nominal)
    for ball, made, shift in zip(nominal.spheres, found.standard.spheres, SHIFT, strict=True):
        truth = apply(back, (ball.centre + shift)[None])[0]
        u = found.standard.known.features[ball.name].u
        assert np.abs(made.centre - truth).max() < 4.0 * u
        assert made.radius == pytest.approx(ball.radius + 0.7 * UM, abs=0.5 * UM)
    for patch, made in zip(nominal.patches, found.standard.patches, strict=True):
        grid = patch.grid(3.0)
        grid = grid[np.all(np.abs(grid) < 0.93 * np.array(patch.half_size), axis=1)]
        high = form(grid) if patch.name == "FF1" else np.zeros(len(grid))
        real = apply(back, patch.point(grid) + high[:, None] * patch.normal(grid))
        uv = made.project(real)
        off = np.einsum("ni,ni->n", made.normal(uv), real - made.point(uv))
        u_form = found.standard.known.features[patch.name].u_form
        assert np.sqrt(np.mean(off**2)) < 2.0 * u_form + 0.3 * UM  # balls misplace it as a whole
        assert u_form < NOISE


def test_file_keeps_it(found, tmp_path) -> None:
    write_standard(tmp_path / "s.toml", found.standard)
    again = read_standard(tmp_path / "s.toml")
    assert again.fingerprint == found.standard.fingerprint
    assert again.known.nominal == found.standard.known.nominal
    for name, feature in found.standard.known.features.items():
        assert again.known.features[name].u == pytest.approx(feature.u, abs=1e-7)


def test_uncertainties_take_the_place_of_those_assumed(nominal, found) -> None:
    from matstd.artefact.reach.touchable import Requests

    ball = nominal.spheres[0]
    n = np.array([[0.0, 0.0, 1.0]])
    touch = Requests(np.array([ball.name]), ball.centre + ball.radius * n, n, np.zeros((1, 2)))
    felt = [
        np.linalg.norm(Calibration(ball=5 * UM).columns(s, touch))
        for s in (nominal, found.standard)
    ]
    # along z, where the upper half of a ball determines least
    across, _, along_z = found.standard.known.features[ball.name].along
    assert felt == pytest.approx([5 * UM, along_z])
    assert along_z > 1.2 * across


def planted(nominal):
    """The real standard: balls beside their places, heights of FF1 that follow its form."""
    balls = [replace(b, centre=b.centre + d) for b, d in zip(nominal.spheres, SHIFT, strict=True)]
    faces = list(nominal.patches)
    patch = faces[0]
    gu, gv = (greville(k, 5) for k in (patch.knots_u, patch.knots_v))
    uv = np.clip(np.stack(np.meshgrid(gu, gv, indexing="ij"), axis=-1).reshape(-1, 2), -18, 18)
    j = patch.jet(uv)
    along_z = form(uv) * np.sqrt(1.0 + j.hu**2 + j.hv**2)
    faces[0] = replace(patch, heights=patch.heights + along_z.reshape(patch.heights.shape))
    return replace(nominal, spheres=tuple(balls), patches=tuple(faces))


def measured(true, nominal, rng):
    """The standard that a CMM makes of the real one."""
    rows = []
    for body in (*true.spheres, *true.patches):
        if body in true.patches:
            uv = rng.uniform(-1.0, 1.0, (120, 2)) * body.half_size
        else:
            uv = np.column_stack([rng.uniform(-3, 3, 40), rng.uniform(0.0, 1.5, 40)])
        p = body.point(uv) + NOISE * rng.normal(size=(len(uv), 1)) * body.normal(uv)
        rows += [(body.name, *x) for x in apply(ELSEWHERE, p)]
    cmm = CmmPoints(
        path=Path("cmm.csv"),
        feature=np.array([r[0] for r in rows]),
        point=np.array([r[1:] for r in rows]),
        diameter=np.full(len(rows), np.nan),
        line=np.arange(len(rows)),
        remarks=(),
    )
    return fit_calibration(nominal, cmm, NOISE, 0.2 * UM, 0.0).standard


def test_the_planted_errors_are_no_longer_seen(golden, nominal) -> None:
    """Programs on the real standard: with the design the fit is bad, with the calibration good."""
    true = planted(nominal)
    made = measured(true, nominal, np.random.default_rng(8))
    machine = VirtualMachine(golden.machine(), noise=0.5 * UM)
    programs = sorted(golden.FOLDER.glob("*_[0-9].H"))
    ratio = {}
    for name, believed in (("design", nominal), ("calibrated", made)):
        run = simulate(programs, true, machine, np.random.default_rng(2), calibrated=believed).run
        ratio[name] = fit_run(run, ordinary_model(run.touches.chain)).noise.chi2_ratio
    assert ratio["design"] > 8.0
    assert ratio["calibrated"] < 1.8


@pytest.mark.slow
def test_diagnosis_sees_the_form_until_the_standard_is_calibrated(
    golden, nominal, tmp_path
) -> None:
    """Places right, form planted alone: named with the design, not there with the calibration."""
    form_alone = replace(nominal, patches=planted(nominal).patches)
    made = measured(form_alone, nominal, np.random.default_rng(8))
    wanted = golden.requests(nominal, each=10)
    plan = plan_touches(
        nominal, golden.machine(), Probe(), golden.setup(), wanted, PlanOptions(tolerated=20)
    )
    programs = make_programs(plan, read_dialect("itnc530"), Feeds()).write(tmp_path)
    machine = VirtualMachine(golden.machine(), noise=0.5 * UM)
    found = {}
    for name, believed in (("design", nominal), ("calibrated", made)):
        rng = np.random.default_rng(2)
        run = simulate(programs, form_alone, machine, rng, calibrated=believed).run
        found[name] = [step.effect.name for step in diagnose(run).steps if step.effect]
    assert found == {"design": ["artefact-form(FF1)"], "calibrated": []}


def test_a_ball_by_hand() -> None:
    """Six points of a ball of 10 mm at (1, 2, 3), exactly."""
    points = np.array([1.0, 2.0, 3.0]) + 10.0 * np.concatenate([np.eye(3), -np.eye(3)])
    centre, radius, covariance, u_radius, left, count, form = fitted_ball(points, 1 * UM)
    assert centre == pytest.approx([1.0, 2.0, 3.0])
    assert (radius, left, count) == pytest.approx((10.0, 0.0, 6))
    # two points see every coordinate
    assert covariance == pytest.approx(0.5 * UM**2 * np.eye(3), abs=1e-15)
    assert form == 0.0
    assert u_radius == pytest.approx(1 * UM / np.sqrt(6.0))  # and all six the radius


@pytest.mark.parametrize(
    ("spoil", "expected"),
    [
        (lambda rows: [r for r in rows if not r[0].startswith("FF1_1")], "FF1 has"),
        (lambda rows: [r for r in rows if r[0] not in ("SPH1",)], "points on 2 balls"),
        (lambda rows: [*rows, ("FF9_1", 0.0, 0.0, 0.0)], "feature 'FF9'"),
        (lambda rows: [*rows[:-1], (rows[-1][0], *np.add(rows[-1][1:], 5.0))], "FF2"),
    ],
)
def test_points_that_do_not_do(nominal, tmp_path, spoil, expected) -> None:
    rows = spoil(cmm_rows(nominal, np.random.default_rng(3), per_face=22))
    path = written(tmp_path / "cmm.csv", rows, nominal.fingerprint)
    with pytest.raises((BadFile, NotEnoughData), match=expected):
        fit_calibration(nominal, read_cmm_points(path, nominal), NOISE, NOISE, 0.0)


def test_balls_that_the_cmm_has_evaluated_state_their_diameter(nominal, tmp_path) -> None:
    """Four rows a ball: its centre in mm, its diameter in inches. A mean of four has u/2."""
    off = np.array([-3.0, -1.0, 1.0, 3.0]) * UM
    rows = [
        (s.name, *(s.centre + d), 2.0 * (s.radius + d) / 25.4) for s in nominal.spheres for d in off
    ]
    lines = ["feature,x [mm],y [mm],z [mm],diameter [in]", *(",".join(map(str, r)) for r in rows)]
    (tmp_path / "cmm.csv").write_text("\n".join(lines) + "\n")
    cmm = read_cmm_points(tmp_path / "cmm.csv", nominal)
    for name, ball in measured_balls(nominal, cmm, NOISE, []).items():
        known = nominal.features[name]
        assert ball.radius == pytest.approx(known.radius)
        assert ball.centre == pytest.approx(known.centre)
        assert (ball.points, ball.left) == (4, 0.0)
        assert np.sqrt(np.diag(ball.covariance)) == pytest.approx(np.full(3, 0.5 * NOISE))
        assert ball.u_radius == pytest.approx(0.25 * NOISE)


def test_units_and_stamps(nominal, tmp_path, capsys) -> None:
    rows = cmm_rows(nominal, np.random.default_rng(3), per_face=30)
    write_standard(tmp_path / "standard.toml", nominal)
    out = tmp_path / "made.toml"

    def call(path: Path, *options: str) -> int:
        standard = str(tmp_path / "standard.toml")
        return main(["calibrate", standard, "--points", str(path), "-o", str(out), *options])

    assert call(written(tmp_path / "inch.csv", rows, scale=1 / 25.4)) == 2
    assert "in inches, expected mm" in capsys.readouterr().err
    assert call(written(tmp_path / "other.csv", rows, stamp="0123456789abcdef")) == 2
    assert "fingerprint" in capsys.readouterr().err
    assert not out.exists()
    inches = written(tmp_path / "in.csv", rows, nominal.fingerprint, "in", 1 / 25.4)
    assert call(inches) == 0
    assert "FF1: 30 points" in capsys.readouterr().out
    by_hand = [
        ("DATUM_A", 1.0, 2.0, 20.0),
        ("DATUM_B", 0.0, -75.0, 10.0),
        ("DATUM_C", -75.0, 0.0, 10.0),
    ]
    listed = written(tmp_path / "all.csv", [*by_hand, *rows], nominal.fingerprint)
    assert call(listed, "--force") == 0
    assert "3 points on DATUM_A, DATUM_B, DATUM_C are not used" in capsys.readouterr().out
    nominal_file = str(tmp_path / "standard.toml")
    both = ["calibrate", nominal_file, "--program", "--cad", str(tmp_path / "c"), "-o", str(out)]
    assert main([*both, "--force"]) == 2
    assert "expected it beside --points" in capsys.readouterr().err
    again = main(["calibrate", str(out), "--points", str(inches), "-o", str(tmp_path / "x.toml")])
    assert again == 2
    assert "already" in capsys.readouterr().err


def test_dmis_program_probes_the_features_and_nothing_else(nominal) -> None:
    """Read back by patterns of its own: points on surfaces, normals, ways that meet nothing."""
    engraved = engraved_on(nominal)
    text = cmm_program(nominal)
    assert nominal.fingerprint in text.splitlines()[0]
    number = r"(-?\d+\.\d+)"
    feature, stylus, moved = "", 1.5, 0
    where = None
    automatic = False
    for line in text.splitlines():
        automatic |= line.startswith("D(PART_2)")  # the datums of the frame come before it
        if found := re.match(r"F\((\w+)\)=FEAT", line):
            feature = re.sub(r"_\d+$", "", found[1])
        if not automatic:
            continue
        if found := re.match(rf"\s+PTMEAS/CART,{','.join([number] * 6)}$", line):
            p, n = np.array(found.groups(), dtype=float).reshape(2, 3)
            surface = nominal.features[feature]
            uv = surface.project(p[None])
            assert np.linalg.norm(surface.point(uv)[0] - p) < 1e-3
            assert surface.normal(uv)[0] @ n > 1.0 - 1e-6
            goals = [p + (APPROACH + stylus) * n]
        elif found := re.match(rf"\s+GOTO/CART,{','.join([number] * 3)}$", line):
            goals = [np.add(np.array(found.groups(), dtype=float), [0.0, 0.0, stylus])]
        else:
            continue
        for goal in goals:
            if where is not None:
                way = where + np.linspace(0.0, 1.0, 60)[:, None] * (goal - where)
                assert nominal.distance(way).min() > stylus, (feature, line)
                moved += 1
            where = goal
    assert moved > 200
    # by hand the frame of the drawing: the plate's own outline gives the places of B and C
    (a, b), thick = nominal.base.half_size, nominal.base.thickness
    by_hand, _, controlled = text.partition("MODE/PROG")
    touched = np.array(re.findall(rf"PTMEAS/CART,{','.join([number] * 6)}", by_hand), dtype=float)
    assert touched[:-3, 2] == pytest.approx(thick, abs=1e-3)
    # a stylus of 2 mm rests on no dot, each of which is 1 mm wide
    assert np.linalg.norm(touched[:, None, :3] - engraved, axis=-1).min() > 2.0
    first, second, third = touched[-3:]
    assert first[1] == second[1] == pytest.approx(-b, abs=1e-3)
    assert second[0] - first[0] > a
    assert third[0] == pytest.approx(-a, abs=1e-3)
    assert first[3:].tolist() == [0.0, -1.0, 0.0]
    assert third[3:].tolist() == [-1.0, 0.0, 0.0]
    assert f"D(PART)=TRANS/XORIG,{a:.4f},YORIG,{b:.4f},ZORIG,{-thick:.4f}" in by_hand
    assert text.count("MEAS/") - text.count("PTMEAS/") == text.count("ENDMES")
    # under control the same datums, and the frame again
    refined = controlled.partition("D(PART_2)")[0]
    again = np.array(re.findall(rf"PTMEAS/CART,{','.join([number] * 6)}", refined), dtype=float)
    assert again == pytest.approx(touched)
    assert "DATSET/DAT(A),ZDIR,ZORIG,DAT(B),XDIR,YORIG,DAT(C),XORIG" in refined


def test_dmis_program_states_sensors_tolerances_and_the_form_of_balls(nominal) -> None:
    text = cmm_program(nominal)
    defined = dict(re.findall(r"S\((\w+)\)=SNSDEF/PROBE,INDEX,POL,([-0-9.,]+)", text))
    selected = re.findall(r"SNSLCT/S\((\w+)\)", text)
    assert selected[0] == "A0_B0"
    assert set(selected) == set(defined)
    assert "UNITS/MM,ANGDEC,TEMPC" in text
    assert "10.5E-6/K" in text
    assert "T(BALL_SIZE)=TOL/DIAM,-0.0025,0.0025" in text
    assert "T(BALL_PLACE)=TOL/POS,3D,0.2000,DAT(A),DAT(B),DAT(C)" in text
    assert "T(FACE)=TOL/PROFP,-0.0250,0.0250,DAT(A),DAT(B),DAT(C)" in text
    joined = text.replace(",$\n", ",")
    for ball in nominal.spheres:
        points = len(re.findall(rf"OUTPUT/FA\({ball.name}_\d+\)", text))
        assert points >= 7
        (made_of,) = re.findall(rf"CONST/SPHERE,F\({ball.name}\),BF,(.*)", joined)
        assert made_of.count("FA(") == points
        assert f"OUTPUT/FA({ball.name}),TA(BALL_SIZE),TA(BALL_PLACE)" in text
    assert max(map(len, text.splitlines())) <= 132
    turned = cmm_program(nominal, 90.0)
    assert turned.splitlines()[0].endswith("ORIENTATION 90',05.2")
    assert "turned by 90 degrees" in turned


def test_a_head_stands_on_the_side_that_its_angles_say(nominal) -> None:
    """A = 90 lays the stylus down: its head at +y for B = 0, at -x for B = 90."""
    assert Angle(0.0, 45.0).axis == pytest.approx([0.0, 0.0, 1.0])
    assert Angle(90.0, 0.0).axis == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert Angle(90.0, 90.0).axis == pytest.approx([-1.0, 0.0, 0.0], abs=1e-12)
    ball = nominal.spheres[0]
    pole = ball.centre + np.array([[0.0, 0.0, ball.radius + TIP]])
    foot = ball.centre * [1.0, 1.0, 0.0] + [ball.foot_radius + TIP + 0.2, 0.0, ball.foot + 2.0]
    high = 300.0 + TO_PIVOT
    assert reaches(nominal, pole, high, 50.0, Angle(0.0, 0.0)).all()
    assert not reaches(nominal, foot[None], high, 50.0, Angle(0.0, 0.0)).any()  # under the ball


def wall(x: float, low: float, high: float) -> SimpleNamespace:
    """A body with one side, at x between two heights."""

    def distance(places):
        z = places[..., 2]
        return np.where((low < z) & (z < high), x - places[..., 0], 1e3)

    return SimpleNamespace(distance=distance)


@pytest.mark.parametrize(
    ("low", "high", "least"),
    [
        (16.0, 58.0, 2.0),  # shaft of 1 mm and a gap of 1 mm
        (61.0, 109.0, 8.0),  # module of 7 mm
        (112.0, 228.0, 37.0),  # head of 32 mm and a gap of 5 mm
    ],
)
def test_the_room_of_shaft_module_and_head_by_hand(low: float, high: float, least: float) -> None:
    """A stylus of 50 mm upright on a ball at z = 10: its module ends at 110, its head at 230."""
    at, upright = np.array([[0.0, 0.0, 10.0]]), Angle(0.0, 0.0)
    assert reaches(wall(least + 0.05, low, high), at, 300.0, 50.0, upright).all()
    assert not reaches(wall(least - 0.05, low, high), at, 300.0, 50.0, upright).any()


def test_a_head_that_lies_stays_above_the_table() -> None:
    """Its radius is 32 mm; on the way down from 60 mm there is room."""
    for z, is_free in ((32.1, True), (31.9, False)):
        at = np.array([[0.0, 0.0, z]])
        assert reaches(wall(1e3, 0.0, 1.0), at, 60.0, 50.0, Angle(90.0, 0.0)).all() == is_free


def test_the_least_tilt_that_keeps_clear_of_a_wall_by_hand() -> None:
    """Of a wall 5 mm beside the ball: upright and at 15 degrees the head is too near (5 + 100
    sin 15 = 31 of 37 mm). At 30 degrees the first turn is B = 45: 5 + 100 sin 30 sin 45 = 40."""
    centres = np.array([[0.0, 0.0, 40.0], [0.0, 9.0, 40.0], [-60.0, 0.0, 40.0]])
    one, each = (
        choose_stylus(wall(5.0, 0.0, 400.0), {"A": (centres, is_one)}, 41.0)
        for is_one in (True, False)
    )
    assert one == (50.0, {"A": [Angle(30.0, 45.0)] * 3})
    assert each == (50.0, {"A": [Angle(30.0, 45.0)] * 2 + [Angle(0.0, 0.0)]})


def test_the_piece_is_probed_and_the_design_believed(golden, nominal, found, tmp_path) -> None:
    """`simulate --real-standard`: the balls that stand off are reported by their deviations."""
    from matstd.twin.files.run_file import read_run

    write_standard(tmp_path / "standard.toml", nominal)
    write_standard(tmp_path / "real.toml", found.standard)
    (tmp_path / "machine.toml").write_text(golden.machine_text())
    programs = sorted(map(str, golden.FOLDER.glob("*_[0-9].H")))
    rms = {}
    for believed in ("standard", "real"):
        out = tmp_path / f"{believed}.csv"
        common = ["--machine", str(tmp_path / "machine.toml"), "--noise-um", "0.5", "-o", str(out)]
        real = ["--real-standard", str(tmp_path / "real.toml")]
        standard = ["--standard", str(tmp_path / f"{believed}.toml")]
        assert main(["simulate", *programs, *standard, *real, *common]) == 0
        rms[believed] = np.sqrt(np.mean(read_run(out).deviation ** 2)) / UM
    assert rms["standard"] > 5.0
    assert rms["real"] == pytest.approx(0.5, abs=0.15)


def test_dust_is_left_out_and_reported(nominal, tmp_path) -> None:
    """A chip of 40 µm under a point of a face and of a ball: the same standard, and two lines."""
    made = []
    for chip in (0.0, 40 * UM):
        rows = cmm_rows(nominal, np.random.default_rng(6))
        at = [k for k, r in enumerate(rows) if r[0] in ("SPH2", "FF1_60")]
        for k in (at[3], at[-1]):
            rows[k] = (rows[k][0], *(np.add(rows[k][1:], [0.0, 0.0, chip])))
        path = written(tmp_path / "cmm.csv", rows, nominal.fingerprint)
        made.append(fit_calibration(nominal, read_cmm_points(path, nominal), NOISE, NOISE, 0.0))
    clean, dusty = made
    assert clean.remarks == ()
    assert [r.split(":")[0] for r in dusty.remarks] == ["SPH2", "FF1"]
    assert f"lines {at[-1] + 3} " in dusty.remarks[1]
    face, other = (m.standard.patches[0] for m in made)
    grid = face.grid(3.0)
    assert np.abs(face.height(grid) - other.height(grid)).max() < 1.5 * UM
