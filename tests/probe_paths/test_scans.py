"""Scans made rows of a run: means with the right values, uncertainties and refusals."""

from pathlib import Path

import numpy as np
import pytest
from unchanged import facts

from matstd.api.evaluating import evaluate_scan_log
from matstd.artefact.body import Standard
from matstd.artefact.layout import Blank, Wave, wavy_face
from matstd.importers import read_scan_log
from matstd.probe_paths.scans import ScanPoints, evaluate_scan
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.frames import apply, fixed_xyz, inverse, pose
from matstd.twin.machine import Axis, inverse_linear, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM

RADIUS, LENGTH, S, MEMORY, PITCH = 3.0, 160.0, 2.0 * UM, 1.0, 0.25
CHAIN = make_chain(
    "vertical", "[w X' Y' f Z t]", {n: Axis(range=(-400.0, 400.0)) for n in "XYZ"}, (0.0, 0.0, 0.0)
)
BELIEVED = Setup("a", pose(t=np.array([10.0, -20.0, 5.0])))
TRUE = pose(fixed_xyz(np.array([0.002, -0.001, 0.003])), np.array([10.2, -19.7, 5.4]))


@pytest.fixture(scope="module")
def body():
    face = wavy_face("FF1", Blank(), Wave((0.0, 0.0), (50.0, 45.0), 60.0, 45.0 * DEG))
    blank = Blank()
    return Standard(
        name="W", serial="", material=blank.material, base=blank.base, core=None, patches=(face,),
        spheres=(), holes=(), blank_height=blank.height,
    )  # fmt: skip


@pytest.fixture(scope="module")
def scan(body):
    """Lines over the face with a bump of 20 µm and noise with memory; balls in the table frame."""
    rng, face = np.random.default_rng(8), body.patches[0]
    u, v = np.arange(-40.0, 41.0, 10.0), np.arange(-40.0, 40.0, PITCH)
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
    uv[1::2] = uv[1::2, ::-1]
    uv = uv.reshape(-1, 2)
    line = np.repeat(np.arange(1, len(u) + 1), len(v))
    p, n = face.point(uv), face.normal(uv)
    r, noise = np.exp(-PITCH / MEMORY), rng.normal(size=len(uv))
    for i in range(1, len(uv)):
        noise[i] = r * noise[i - 1] + np.sqrt(1.0 - r**2) * noise[i]
    field = 20.0 * UM * np.exp(-np.sum(p[:, :2] ** 2, axis=1) / 12.0**2)
    ball = p + (RADIUS + field + S * noise)[:, None] * n
    return line, apply(TRUE, ball), n, field, p


def written(path: Path, line, values, header="line;X;Y;Z") -> Path:
    table = np.column_stack([line, *values.T])
    rows = [";".join([f"{int(row[0])}", *(f"{x:.6f}" for x in row[1:])]) for row in table]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


def readings(ball):
    return inverse_linear(CHAIN, ball, np.zeros((len(ball), 3)), LENGTH)


def evaluated(path, body, **more):
    return evaluate_scan_log(
        path, body, CHAIN, "FF1", RADIUS, LENGTH, setup=BELIEVED, u=0.0, **more
    )


def test_rows_have_the_deviations_and_their_uncertainty(body, scan, tmp_path):
    line, ball, _, field, p = scan
    q = readings(ball)[:, [CHAIN.axis_index(n) for n in "XYZ"]]
    found = evaluated(written(tmp_path / "s.csv", line, q), body)
    run = found.run
    assert 80 <= len(run) <= 150  # 9 lines of 90 to 120 mm along the waves
    assert "9 lines" in found.remarks[0]
    # what the six freedoms of the set-up take from the field is not in the deviations
    t, n = run.touches, run.touches.normal
    near = np.argmin(np.linalg.norm(t.point[:, None] - p, axis=-1), axis=1)
    rigid = np.concatenate([n, np.cross(t.point, n) / 50.0], axis=1)
    left = run.deviation - field[near]
    left = left - rigid @ np.linalg.lstsq(rigid, left, rcond=None)[0]
    z = left / run.u
    assert (
        0.8 < np.std(z) < 1.35
    )  # curvature of the field over 8 mm, and a parabola's share of noise
    assert np.ptp(run.deviation) > 12.0 * UM
    assert abs(t.T_table_artefact[0][:3, 3] - TRUE[:3, 3]).max() < 0.02
    naive = S / np.sqrt(8.0 / PITCH)
    assert run.u.mean() > 1.8 * naive  # neighbours share their noise


def test_an_evaluated_scan_is_what_it_was(body, scan, tmp_path, unchanged):
    line, ball, _, _, _ = scan
    q = readings(ball)[:, [CHAIN.axis_index(n) for n in "XYZ"]]
    unchanged(facts(evaluated(written(tmp_path / "s.csv", line, q), body)))


def test_a_run_of_a_scan_can_be_written_and_read(body, scan, tmp_path):
    line, ball, *_ = scan
    q = readings(ball)[:, [CHAIN.axis_index(n) for n in "XYZ"]]
    found = evaluated(written(tmp_path / "s.csv", line, q), body)
    (tmp_path / "machine.toml").write_text(
        'format = "machine/1"\nname = "v"\nchain = "[w X\' Y\' f Z t]"\n'
        + "".join(f"[axis.{n}]\nrange = [-400.0, 400.0]\n" for n in "XYZ"),
        encoding="utf-8",
    )
    found.save(tmp_path / "run.csv", tmp_path / "machine.toml")
    again = read_run(tmp_path / "run.csv")
    assert '# machine = "machine.toml"' in (tmp_path / "run.csv").read_text(encoding="utf-8")
    assert len(again) == len(found.run)
    np.testing.assert_allclose(again.deviation, found.run.deviation, atol=2e-6)


def test_a_run_of_a_machine_file_that_is_missing_is_not_written(body, scan, tmp_path):
    """The path is that from the current folder, not from the run file's."""
    line, ball, *_ = scan
    q = readings(ball)[:, [CHAIN.axis_index(n) for n in "XYZ"]]
    found = evaluated(written(tmp_path / "s.csv", line, q), body)
    with pytest.raises(BadFile, match=r"machine: found no such file.*from the current folder"):
        found.save(tmp_path / "run.csv", tmp_path / "there" / "machine.toml")
    assert not (tmp_path / "run.csv").exists()


def test_the_three_kinds_of_logs_say_the_same(body, scan, tmp_path):
    """Deflected positions; machine and deflection by axes; machine and deflection along n."""
    line, ball, n, *_ = scan
    local = apply(inverse(BELIEVED.T_table_artefact), ball)
    normal = n  # set-up differs by 3 mrad: 0.3 mm of deflection turn by a micrometre across it
    d = 0.3 + 0.02 * np.sin(np.arange(len(line)))
    plain = evaluated(written(tmp_path / "a.csv", line, local), body, frame="standard").run
    both = np.column_stack([local - d[:, None] * normal, d[:, None] * normal])
    by_axes = written(tmp_path / "b.csv", line, both, "Line;x;y;z;dx;dy;dz")
    along = np.column_stack([local - d[:, None] * normal, d])
    by_normal = written(tmp_path / "c.csv", line, along, "line;x_mm;y_mm;z_mm;d_mm")
    for path in (by_axes, by_normal):
        run = evaluated(path, body, frame="standard").run
        assert len(run) == pytest.approx(len(plain), abs=6)
        assert np.std(run.deviation) == pytest.approx(np.std(plain.deviation), rel=0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("gap", r"line \d+.*a gap of [\d.]+ mm in line 3 of the scan"),
        ("inches", r"line 2.*mm from FF1 or beyond its edge, as \d+ % of all.*unit"),
        ("corrected", r"points on FF1 itself.*centres of the ball"),
        ("radius", r"deviations of 0\.\d+ mm rms.*radius of the ball"),
        ("neighbour", r"line \d+.*beyond its edge, as [1-9] % of all.*another face"),
        ("face", r"FF7.*a freeform face of the standard: FF1"),
    ],
)
def test_refusals_are_one_line(body, scan, tmp_path, change, message):
    line, ball, n, *_ = scan
    local, face = apply(inverse(BELIEVED.T_table_artefact), ball), "FF1"
    kept = np.ones(len(line), dtype=bool)
    if change == "gap":
        kept[np.flatnonzero(line == 3)[60:110]] = False
    elif change == "inches":
        local = local / 25.4
    elif change == "corrected":
        local = local - RADIUS * n
    elif change == "radius":
        local = local + 2.0 * n
    elif change == "neighbour":
        local[-40:] += [30.0, 60.0, 0.0]
        line = line.copy()
        line[-40:] = 99
    else:
        face = "FF7"
    path = written(tmp_path / "s.csv", line[kept], local[kept])
    with pytest.raises(BadFile, match=message) as caught:
        evaluate_scan_log(path, body, CHAIN, face, RADIUS, LENGTH, setup=BELIEVED, frame="standard")
    assert "\n" not in str(caught.value)


def test_units_and_times_of_a_log(tmp_path):
    rows = [f"{0.01 * i:.3f},{i},{2 * i},1.5" for i in range(12)]
    path = tmp_path / "t.csv"
    path.write_text("\n".join(["time_s,X [in],Y [mm],Z", *rows]) + "\n", encoding="utf-8")
    log = read_scan_log(path)
    np.testing.assert_allclose(log.position[3], [3 * 25.4, 6.0, 1.5])
    assert log.time[-1] == pytest.approx(0.11)
    assert not log.is_numbered
    path.write_text("\n".join(["t,x,y,z", *reversed(rows)]) + "\n", encoding="utf-8")
    with pytest.raises(BadFile, match="rising times"):
        read_scan_log(path)
    path.write_text("x,z\n" + "1,2\n" * 20, encoding="utf-8")
    with pytest.raises(BadFile, match="a column y"):
        read_scan_log(path)


def test_sag_is_taken_off_a_scan_as_it_is_off_touches(body):
    """Lying on its side, a face that weight along z pushes up by s stands s higher than upright."""
    s, chain = 4.0 * UM, make_chain(
        "tilting",
        "[w A' f X Y Z t]",
        {n: Axis(range=(-400.0, 400.0)) for n in "XYZ"} | {"A": Axis((-2.0, 2.0))},
        (0.0, 0.0, 0.0),
    )  # fmt: skip
    heavy = body.sagging("by hand", "-Z", 0.25, {"FF1": np.diag([0.0, 0.0, s])})
    face = body.patches[0]
    u, v = np.arange(-40.0, 41.0, 10.0), np.arange(-40.0, 40.0, PITCH)
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    p, n, lines = face.point(uv), face.normal(uv), np.repeat(np.arange(len(u)), len(v))
    upright = p + RADIUS * n
    ball = np.concatenate([upright, upright + np.array([0.0, 0.0, s])])
    q = np.zeros((len(ball), 4))
    q[len(p) :, chain.axis_index("A")] = 90.0 * DEG
    q = inverse_linear(chain, ball, q, LENGTH)
    rows = np.arange(len(ball))
    points = ScanPoints(
        Path("s.csv"), rows, np.concatenate([lines, lines + 100]), True, q,
        np.zeros(len(ball)), 0.01 * rows,
    )  # fmt: skip
    there = Setup("a", np.eye(4))
    seen, _ = evaluate_scan(points, heavy, "FF1", chain, RADIUS, LENGTH, there, 0.0)
    bare, _ = evaluate_scan(points, body, "FF1", chain, RADIUS, LENGTH, there, 0.0)
    assert np.abs(seen.deviation).max() < 0.01 * UM
    assert np.abs(bare.deviation).max() > 0.4 * s
    lying = seen.touches.q[:, chain.axis_index("A")] > 1.0
    assert seen.u[~lying].max() < 0.02 * UM
    flat = seen.touches.normal[:, 2]
    np.testing.assert_allclose(seen.u[lying], 0.25 * s * flat[lying], rtol=0.01)
