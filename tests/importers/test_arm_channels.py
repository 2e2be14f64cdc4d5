"""Orientations of targets, fixed targets, tilts, replicates and more joints beside an arm."""

import numpy as np
import pytest
from foreign_cases import DH
from scipy.spatial.transform import Rotation

from matstd.cli import main
from matstd.importers import import_arm, read_sheet
from matstd.importers.arms import arm_from_dh, read_arm, tracker_run
from matstd.importers.arms.orientation import disagreement, from_quaternions, target_rotation
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_machine, read_run
from matstd.twin.frames import apply, rotation
from matstd.twin.machine import table_to_tool
from matstd.twin.units import DEG, UM, URAD

BAD = 2
POSES = 40
TARGET = np.array([15.0, -40.0, 70.0])
TURNED = Rotation.from_rotvec([0.3, -0.8, 0.5])
"""Place and orientation of the target in the flange frame."""
TRACKER = Rotation.from_rotvec([0.4, 1.1, -0.7])
STANDS = np.array([2100.0, -900.0, 350.0])
U, U_ANGLE = 10.0 * UM, 40.0 * URAD


def flanges(q):
    """Flange in the base by the textbook, with scipy's rotations."""
    rows = [line.split(",") for line in DH.splitlines()[1:]]
    at, R = np.zeros((len(q), 3)), Rotation.from_matrix(np.tile(np.eye(3), (len(q), 1, 1)))
    for i, (a, alpha, d, theta) in enumerate(np.array(rows, dtype=float)):
        R = R * Rotation.from_rotvec(np.outer(q[:, i] + theta * DEG, [0.0, 0.0, 1.0]))
        at = at + R.apply([float(a), 0.0, float(d)])
        R = R * Rotation.from_rotvec([alpha * DEG, 0.0, 0.0])
    return at, R


def joints():
    return np.random.default_rng(3).uniform(-1.5, 1.5, (POSES, 6))


def seen(q, noise=0.0, seed=5):
    """Place and orientation of the target as a tracker sees them, with noise times U, U_ANGLE."""
    rng = np.random.default_rng(seed)
    at, R = flanges(q)
    place = TRACKER.apply(at + R.apply(TARGET)) + STANDS
    turn = TRACKER * R * TURNED
    wrong = Rotation.from_rotvec(noise * U_ANGLE * rng.normal(size=(len(q), 3)))
    return place + noise * U * rng.normal(size=place.shape), wrong * turn


def written(tmp_path, q, place, columns):
    """A log with further columns, each (N,), by name."""
    head = [*(f"j{k + 1}" for k in range(q.shape[1])), "x [mm]", "y [mm]", "z [mm]", *columns]
    cells = np.column_stack([q / DEG, place, *columns.values()])
    lines = [",".join(f"{v:.12g}" for v in row) for row in cells]
    (tmp_path / "log.csv").write_text("\n".join([",".join(head), *lines]) + "\n")
    (tmp_path / "dh.csv").write_text(DH)
    return read_sheet(tmp_path / "log.csv")


def words(tmp_path):
    """The command that makes a run of the log."""
    log, dh, out = (str(tmp_path / n) for n in ("log.csv", "dh.csv", "run.csv"))
    return ["import", log, "--arm", "--dh", dh, "--u-um", "10", "-o", out]


def quaternion(turn):
    x, y, z, w = turn.as_quat().T
    return {"qw": w, "qx": x, "qy": y, "qz": z}


def vector(turn):
    return {f"r{c} [deg]": v for c, v in zip("xyz", turn.as_rotvec(degrees=True).T, strict=True)}


def test_rotations_are_those_of_an_independent_library():
    turn = Rotation.random(20, random_state=np.random.default_rng(1))
    np.testing.assert_allclose(
        from_quaternions(np.roll(turn.as_quat(), 1, axis=1)), turn.as_matrix(), atol=1e-12
    )
    vectors = np.vstack([turn.as_rotvec(), np.zeros(3), [1e-9, 0.0, 0.0]])
    np.testing.assert_allclose(
        rotation(vectors), Rotation.from_rotvec(vectors).as_matrix(), atol=1e-12
    )


def test_the_orientation_of_a_target_in_closed_form():
    _, R = flanges(joints())
    measured = (TRACKER * R * TURNED).as_matrix()
    assert disagreement(R.as_matrix(), measured) < 1e-6
    found = target_rotation(R.as_matrix(), measured, TRACKER.as_matrix())
    np.testing.assert_allclose(found, TURNED.as_matrix(), atol=1e-9)
    assert disagreement(R.as_matrix(), measured.swapaxes(1, 2)) > 0.5


@pytest.mark.parametrize("kind", [quaternion, vector])
def test_a_pose_gives_six_rows_that_vanish_on_the_nominal_arm(tmp_path, kind):
    q = joints()
    place, turn = seen(q)
    sheet = written(tmp_path, q, place, kind(turn))
    found = import_arm(sheet, U, dh=read_sheet(tmp_path / "dh.csv"), u_angle=U_ANGLE)
    assert len(found.run) == 6 * POSES
    assert np.abs(found.run.deviation).max() < 1e-5
    assert len(np.unique(found.run.touches.pose)) == POSES
    np.testing.assert_allclose(found.run.u, np.sqrt(2.0) * U)
    assert not sheet.unused
    plain = import_arm(sheet, U, dh=read_sheet(tmp_path / "dh.csv"))
    assert len(plain.run) == 3 * POSES
    for name, at in plain.reflectors.items():
        np.testing.assert_allclose(found.reflectors[name], at, atol=1e-5)


def test_the_rows_of_a_pose_are_independent_and_as_uncertain_as_stated(tmp_path):
    """Signs and statistics: chi-square per row is 1, and no two rows of a pose go together."""
    q = joints()
    (tmp_path / "dh.csv").write_text(DH)
    chain, turned = arm_from_dh(read_sheet(tmp_path / "dh.csv"), q)
    drawn = []
    for seed in range(30):
        place, turn = seen(q, 1.0, seed)
        table = read_arm(written(tmp_path, q, place, quaternion(turn)), is_oriented=True)
        run = tracker_run(table, chain, U, turned @ TARGET, U_ANGLE)
        drawn.append((run.deviation / run.u).reshape(-1, 6))
    z = np.vstack(drawn)
    # tracker and target take 9 of 240 degrees of freedom
    np.testing.assert_allclose(np.cov(z.T), (231.0 / 240.0) * np.eye(6), atol=0.09)


def test_an_error_of_the_orientation_shows_as_angle_times_arm(tmp_path):
    """A tool that turns by +30 µrad about e3 in one pose moves the points at ± L e1 along ± e2."""
    q = joints()
    place, turn = seen(q)
    matrix = turn.as_matrix()
    bent = matrix.copy()
    bent[7] = bent[7] @ Rotation.from_rotvec([0.0, 0.0, 30.0 * URAD]).as_matrix()
    table = read_arm(
        written(tmp_path, q, place, quaternion(Rotation.from_matrix(bent))), is_oriented=True
    )
    chain, turned = arm_from_dh(read_sheet(tmp_path / "dh.csv"), q)
    run = tracker_run(table, chain, U, turned @ TARGET, U_ANGLE)
    rows = run.deviation.reshape(-1, 6)[7]
    lever = U / U_ANGLE
    # believed minus measured; the other 39 poses hold the tracker and the target to 1/40
    np.testing.assert_allclose(
        rows[:2], [-30.0 * URAD * lever, 30.0 * URAD * lever], rtol=0.06, atol=0.0
    )
    assert np.abs(rows[2:]).max() < 0.1 * 30.0 * URAD * lever


def test_orientations_that_are_not_those_of_the_arm_are_refused(tmp_path, capsys):
    q = joints()
    place, turn = seen(q)
    written(tmp_path, q, place, quaternion(turn.inv()))
    assert main([*words(tmp_path), "--u-urad", "40"]) == BAD
    assert "if they are inverted" in capsys.readouterr().err
    assert main(words(tmp_path)) == 0
    assert "--u-urad states their standard uncertainty" in capsys.readouterr().out
    for length in (2.0, 1.012):
        sheet = written(tmp_path, q, place, {n: length * v for n, v in quaternion(turn).items()})
        with pytest.raises(BadFile, match=f"a quaternion of length {length:g}, expected 1"):
            read_arm(sheet, is_oriented=True)
    read_arm(written(tmp_path, q, place, {n: 1.008 * v for n, v in quaternion(turn).items()}))
    sheet = written(tmp_path, q, place, {})
    with pytest.raises(BadFile, match="qw qx qy qz"):
        import_arm(sheet, U, dh=read_sheet(tmp_path / "dh.csv"), u_angle=U_ANGLE)


def test_fixed_targets_tilts_and_forces_stand_beside(tmp_path):
    q = joints()
    place, _ = seen(q)
    drift = 0.02 * np.linspace(0.0, 1.0, POSES)
    columns = {
        **{f"ref {c} [mm]": 100.0 + i + drift for i, c in enumerate("xyz")},
        "tilt base [mrad]": 3.0 * drift,
        "tool force [N]": np.full(POSES, 12.0),
        "housing [°C]": 20.0 + drift,
    }
    sheet = written(tmp_path, q, place, columns)
    found = import_arm(sheet, U, dh=read_sheet(tmp_path / "dh.csv"))
    assert found.fixed == pytest.approx({"ref": 0.02})
    value = found.run.touches.value
    np.testing.assert_allclose(value["ref_x_um"][::3], 1000.0 * drift, atol=1e-6)
    assert {"tilt_base_mrad", "tool_force_N"} <= set(value)
    assert "housing" in found.run.touches.temperature
    assert np.abs(found.run.deviation).max() < 1e-5


def test_a_numbered_reflector_that_stands_still_is_a_fixed_target(tmp_path):
    q = joints()
    place, _ = seen(q)
    still = np.tile([500.0, 10.0, -20.0], (POSES, 1)) + 0.01 * place[:, :1] / 2000.0
    head = [*(f"j{k}" for k in range(1, 7)), *(f"{c}{k}" for k in (1, 2) for c in "xyz")]
    cells = np.column_stack([q / DEG, still, place])
    lines = [",".join(head), *(",".join(f"{v:.9f}" for v in row) for row in cells)]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    table = read_arm(read_sheet(tmp_path / "log.csv"))
    assert table.names == ("reflector 2",)
    assert set(table.fixed) == {"reflector 1"}


def test_replicates_are_cycles_of_one_pose(tmp_path):
    q = np.tile(joints()[:15], (2, 1))
    place, _ = seen(q, 1.0)
    sheet = written(tmp_path, q, place, {"replicate": np.repeat([1.0, 2.0], 15)})
    run = import_arm(sheet, U, dh=read_sheet(tmp_path / "dh.csv")).run
    assert sorted(set(run.repeat.tolist())) == [1, 2]
    assert len(np.unique(run.touches.pose)) == 15


def test_an_arm_of_twelve_joints(tmp_path):
    """Ten joints and more have two digits; the chain is the arm whatever their number."""
    table = "a,alpha,d,theta,min,max\n" + "".join(
        f"{60 if k % 2 else 0},{90 if k % 2 else -90},{120},0,-160,160\n" for k in range(12)
    )
    (tmp_path / "dh.csv").write_text(table)
    q = np.random.default_rng(2).uniform(-1.0, 1.0, (30, 12))
    chain, _ = arm_from_dh(read_sheet(tmp_path / "dh.csv"), q)
    place = apply(table_to_tool(chain, q), np.array([10.0, 20.0, 30.0]))
    place = place + np.array([500.0, 0.0, 0.0])
    text = [",".join([*(f"J{k + 1} [deg]" for k in range(12)), "x", "y", "z"])]
    text += [
        ",".join(f"{v:.10f}" for v in row) for row in np.column_stack([q / DEG, place]).tolist()
    ]
    (tmp_path / "log.csv").write_text("\n".join(text) + "\n")
    assert main(words(tmp_path)) == 0
    machine = read_machine(tmp_path / "run.machine.toml")
    assert len(machine.programmed_axes) == 12
    for axis in machine.programmed_axes:
        np.testing.assert_allclose(machine.link(axis).range, [-160.0 * DEG, 160.0 * DEG])
    assert np.abs(read_run(tmp_path / "run.csv").deviation).max() < 1e-4


def test_travels_are_those_of_the_joints_not_of_the_log(tmp_path):
    q = joints()
    place, _ = seen(q)
    written(tmp_path, q, place, {})
    chain, _ = arm_from_dh(read_sheet(tmp_path / "dh.csv"), q)
    for axis in chain.programmed_axes:
        assert chain.link(axis).range == (-np.pi, np.pi)
    chain, _ = arm_from_dh(read_sheet(tmp_path / "dh.csv"), q + 3.0 * (np.arange(6) == 5))
    assert chain.link(chain.programmed_axes[5]).range == (-2.0 * np.pi, 2.0 * np.pi)
    assert chain.link(chain.programmed_axes[4]).range == (-np.pi, np.pi)
    limited = "\n".join(
        line + (",min,max" if k == 0 else ",-45,45") for k, line in enumerate(DH.splitlines())
    )
    (tmp_path / "limits.csv").write_text(limited + "\n")
    with pytest.raises(BadFile, match=r"readings from -8.*expected the travel, -45 to 45"):
        arm_from_dh(read_sheet(tmp_path / "limits.csv"), q)


def test_a_stated_travel_stands_in_the_machine_file(tmp_path, capsys):
    text = "Target [mm],1 up [µm],1 down [µm]\n" + "".join(
        f"{100 * k},{k},{k - 1}\n" for k in range(5)
    )
    (tmp_path / "x.csv").write_text(text, encoding="utf-8")
    command = ["import", str(tmp_path / "x.csv"), "--positioning", "X", "--u-um", "0.3", "--force"]
    command += ["-o", str(tmp_path / "run.csv")]
    assert main([*command, "--travel", "X", "-20", "620"]) == 0
    assert read_machine(tmp_path / "run.machine.toml").link("X").range == (-20.0, 620.0)
    assert main([*command, "--travel", "X", "0", "350"]) == BAD
    assert "limits about the readings, 0 to 400" in capsys.readouterr().err
    assert main([*command, "--travel", "Y", "0", "350"]) == BAD


def test_a_machine_that_is_wrong_by_centimetres_is_read(tmp_path):
    """15 mm of error of an arm that was never calibrated: import, and the reader of the run."""
    q = joints()
    at, R = flanges(q)
    at = at + 0.02 * at[:, [1, 0, 2]]
    place = TRACKER.apply(at + R.apply(TARGET)) + STANDS
    written(tmp_path, q, place, {})
    assert main(words(tmp_path)) == 0
    run = read_run(tmp_path / "run.csv")
    assert len(run) == 3 * POSES
    assert np.abs(run.deviation).max() > 10.0


def test_columns_that_differ_by_case_alone_are_named(tmp_path):
    (tmp_path / "points.csv").write_text("Z [mm],z [mm],z meas [mm]\n1,1,1\n2,2,2\n")
    from matstd.importers.points import read_points

    with pytest.raises(DesignError, match=r"'Z \[mm\]' and 'z \[mm\]', expected one column"):
        read_points(read_sheet(tmp_path / "points.csv"))
