"""Arms under a tracker: kinematics from a table of parameters, against loops that share no code."""

import numpy as np
import pytest

from diagnosis.fit.identification import fit_run
from matstd.cli import main
from twin.errors import BadFile, DesignError
from twin.files.machine_file import read_machine
from twin.files.run_file import read_run
from twin.files.run_writer import write_run
from twin.foreign.serial_arm import arm_from_dh, joint_readings, tracker_run
from twin.frames import apply
from twin.library.ordinary import ordinary_model
from twin.machine.kinematics import table_to_tool
from twin.sheets.sheet import read_sheet
from twin.units import DEG, NM, UM

BAD = 2
UR5 = """a,alpha,d,theta offset
0;90;89.159;0
-425;0;0;0
-392.25;0;0;0
0;90;109.15;0
0;-90;94.65;0
0;0;82.3;0
""".replace(",", ";")
A = np.array([0.0, -425.0, -392.25, 0.0, 0.0, 0.0])
ALPHA = np.array([90.0, 0.0, 0.0, 90.0, -90.0, 0.0]) * DEG
D = np.array([89.159, 0.0, 0.0, 109.15, 94.65, 82.3])
REFLECTOR = np.array([12.0, -35.0, 60.0])
POSES = 30


def by_hand(q, modified=False):
    """Flange pose of one configuration, element by element as in the textbooks."""
    T = np.eye(4)
    for th, a, al, d in zip(q, A, ALPHA, D, strict=True):
        c, s, ca, sa = np.cos(th), np.sin(th), np.cos(al), np.sin(al)
        if modified:
            step = [[c, -s, 0, a], [s * ca, c * ca, -sa, -sa * d], [s * sa, c * sa, ca, ca * d]]
        else:
            step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
        T = T @ np.array([*step, [0, 0, 0, 1]], dtype=float)
    return T


def poses():
    return np.random.default_rng(3).uniform(-1.5, 1.5, (POSES, 6))


def seen(q, length=1.0, modified=False):
    """Where a tracker that stands anywhere sees the reflector; an arm that is too long by a factor.

    The tracker's frame is turned by 2 rad about a skew line and stands metres away.
    """
    axis = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    R = np.eye(3) + np.sin(2.0) * K + (1.0 - np.cos(2.0)) * K @ K
    found = [(by_hand(row, modified) @ [*REFLECTOR, 1.0])[:3] for row in q]
    return length * np.array(found) @ R.T + np.array([2100.0, -900.0, 350.0])


def written(tmp_path, places, q, decimal=","):
    lines = ["J1 [deg];J2 [deg];J3 [deg];J4 [deg];J5 [deg];J6 [deg];X [mm];Y [mm];Z [mm];Zeit [s]"]
    for k, (row, place) in enumerate(zip(q / DEG, places, strict=True)):
        lines.append(";".join(f"{v:.9f}" for v in (*row, *place, 20.0 * k)).replace(".", decimal))
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="cp1252")
    (tmp_path / "ur5.csv").write_text(UR5)
    return tmp_path / "log.csv"


@pytest.mark.parametrize("modified", [False, True])
def test_the_chain_of_a_table_of_parameters_is_the_arm(tmp_path, modified):
    (tmp_path / "ur5.csv").write_text(UR5)
    q = poses()
    chain, turned = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q, modified)
    T = table_to_tool(chain, q)
    for k, row in enumerate(q):
        expected = by_hand(row, modified)
        np.testing.assert_allclose(T[k, :3, 3], expected[:3, 3], atol=NM)
        np.testing.assert_allclose(T[k, :3, :3] @ turned, expected[:3, :3], atol=1e-9)
        at = (expected @ [*REFLECTOR, 1.0])[:3]
        np.testing.assert_allclose(apply(T[k], turned @ REFLECTOR), at, atol=NM)


def test_tracker_and_reflector_are_found_wherever_they_are(tmp_path):
    q = poses()
    sheet = read_sheet(written(tmp_path, seen(q), q))
    readings, columns = joint_readings(sheet)
    assert columns[0] == "J1 [deg]"
    chain, turned = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), readings)
    run = tracker_run(sheet, chain, readings, 5.0 * UM)
    np.testing.assert_allclose(run.touches.target[0], turned @ REFLECTOR, atol=1e-5)
    assert np.abs(run.deviation).max() < 1e-5
    assert run.touches.time[3] == 20.0
    stated = tracker_run(sheet, chain, readings, 5.0 * UM, turned @ REFLECTOR)
    assert np.abs(stated.deviation).max() < 1e-5


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_reflector_on_either_side_of_the_flange_is_written_and_read(tmp_path, monkeypatch, side):
    """On the far side the distance along the tool is negative, which no probe's length is."""
    monkeypatch.setitem(globals(), "REFLECTOR", side * REFLECTOR)
    q = poses()
    sheet = read_sheet(written(tmp_path, seen(q), q))
    chain, turned = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q)
    run = tracker_run(sheet, chain, joint_readings(sheet)[0], 5.0 * UM)
    write_run(tmp_path / "run.csv", run, "none.toml")
    again = read_run(tmp_path / "run.csv", chain)
    np.testing.assert_allclose(again.touches.target, run.touches.target, atol=1e-6)
    np.testing.assert_allclose(again.touches.target[0], turned @ REFLECTOR, atol=1e-5)


def test_sign_of_an_arm_that_is_too_long(tmp_path):
    """All that is measured is 20 ppm larger, tracker and all: the controller believes too little.

    dev = believed - measured, so along the position as seen from the tracker it is negative; the
    place of the tracker takes up what all poses share.
    """
    q = poses()
    sheet = read_sheet(written(tmp_path, seen(q, 1.00002), q))
    chain, turned = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q)
    run = tracker_run(sheet, chain, joint_readings(sheet)[0], 5.0 * UM, turned @ REFLECTOR)
    middle = run.touches.point.reshape(-1, 3, 3)[:, 0]
    outwards = middle - middle.mean(axis=0)
    dev = run.deviation.reshape(-1, 3)
    slope = np.sum(dev * outwards) / np.sum(outwards**2)
    assert slope == pytest.approx(-20e-6, rel=0.02)


def test_the_command_makes_run_and_machine(tmp_path, capsys):
    q = poses()
    table = written(tmp_path, seen(q), q)
    out = tmp_path / "run.csv"
    words = ["import", str(table), "--arm", "--dh", str(tmp_path / "ur5.csv"), "--u-um", "5"]
    assert main([*words, "-o", str(out)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "J1 [deg] is C, J2 [deg] is B" in said
    assert "believed - measured" in said
    run = read_run(out)
    assert len(run) == 3 * POSES
    assert run.touches.instrument.value == "tracker"
    assert np.abs(run.deviation).max() < 1e-4
    fit = fit_run(run, ordinary_model(run.touches.chain))
    assert fit.rms < 1.0 * UM
    # what was written names the arm for the next table
    again = ["import", str(table), "--arm", "--machine", str(tmp_path / "run.machine.toml")]
    assert main([*again, "--u-um", "5", "-o", str(tmp_path / "again.csv")]) == 0
    assert read_run(tmp_path / "again.csv").fingerprint == run.fingerprint


def test_what_is_no_arm_is_refused(tmp_path):
    q = poses()
    table = written(tmp_path, seen(q), q)
    out = ["--u-um", "5", "-o", str(tmp_path / "run.csv")]
    assert main(["import", str(table), "--arm", *out]) == BAD
    (tmp_path / "short.csv").write_text("\n".join(UR5.splitlines()[:-1]) + "\n")
    assert main(["import", str(table), "--arm", "--dh", str(tmp_path / "short.csv"), *out]) == BAD
    text = table.read_text(encoding="cp1252")
    table.write_text(text.replace("J4", "J5"))
    with pytest.raises(BadFile, match="every joint once"):
        joint_readings(read_sheet(table))
    table.write_text(text.replace("X [mm]", "X [mm];X cmd [mm]"))
    chain, _ = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q)
    table.write_text("\n".join(text.splitlines()[:5]) + "\n")
    sheet = read_sheet(table)
    with pytest.raises(DesignError, match="4 poses, expected 6"):
        tracker_run(sheet, chain, joint_readings(sheet)[0], 5.0 * UM)


def several(tmp_path, q, coupling=0.0):
    """A log with two reflectors, one of them hidden once, torques and a load on the tool."""
    link = q.copy()
    link[:, 2] += coupling * q[:, 1]
    lines = ["j1,j2,j3,j4,j5,j6,x1,y1,z1,x2,y2,z2,tau2 [Nm],Fz [N],motor [°C],state"]
    for k, (row, of_link) in enumerate(zip(q / DEG, link, strict=True)):
        T = by_hand(of_link)
        first, second = ((T @ [*v, 1.0])[:3] for v in (REFLECTOR, -REFLECTOR))
        places = [*(f"{v:.9f}" for v in first), *("" if k == 4 else f"{v:.9f}" for v in second)]
        lines.append(
            ",".join([*(f"{v:.9f}" for v in row), *places, str(10.5 + k), "-30", "35", "ok"])
        )
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "ur5.csv").write_text(UR5)
    return read_sheet(tmp_path / "log.csv")


def test_several_reflectors_with_torques_and_loads_are_one_run(tmp_path):
    sheet = several(tmp_path, poses())
    q, _ = joint_readings(sheet)
    chain, turned = arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q)
    run = tracker_run(sheet, chain, q, 5.0 * UM)
    t = run.touches
    assert len(run) == 6 * POSES - 3
    assert np.abs(run.deviation).max() < 1e-6
    targets = dict(zip(t.feature, t.target, strict=True))
    np.testing.assert_allclose(targets["reflector 1"], turned @ REFLECTOR, atol=1e-6)
    np.testing.assert_allclose(targets["reflector 2"], -(turned @ REFLECTOR), atol=1e-6)
    assert len(np.unique(t.pose)) == POSES
    np.testing.assert_allclose(t.value["tau2_Nm"][:6], 10.5)
    np.testing.assert_allclose(t.force[0], [0.0, 0.0, -30.0])
    assert t.temperature["motor"][0] == 35.0
    assert sheet.unused == ("state",)
    write_run(tmp_path / "run.csv", run, "none.toml")
    again = read_run(tmp_path / "run.csv", chain)
    np.testing.assert_allclose(again.touches.target, t.target, atol=1e-6)
    assert again.touches.value.keys() == {"tau2_Nm"}


@pytest.mark.parametrize(
    ("coupling", "told"), [(1.0, "--coupled J3+J2"), (-1.0, "--coupled J3-J2")]
)
def test_a_joint_that_counts_from_another_link_is_named(tmp_path, capsys, coupling, told):
    """As the controls of Fanuc count joint 3; nothing is applied until the user says so."""
    several(tmp_path, poses(), coupling)
    log, dh, out = (str(tmp_path / name) for name in ("log.csv", "ur5.csv", "run.csv"))
    arguments = ["import", log, "--arm", "--dh", dh, "--u-um", "5", "-o", out]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert told in said
    assert main([*arguments, "--force", "--coupled", told.split()[1]]) == 0
    said = capsys.readouterr().out
    assert "do not agree" not in said
    assert "deviations 0.000 µm" in said


def test_a_coupling_of_joints_that_are_not_there_is_refused(tmp_path, capsys):
    several(tmp_path, poses())
    log, dh, out = (str(tmp_path / name) for name in ("log.csv", "ur5.csv", "run.csv"))
    arguments = ["import", log, "--arm", "--dh", dh, "--u-um", "5", "-o", out]
    assert main([*arguments, "--coupled", "J7+J2"]) == BAD
    assert "--coupled J7+J2: expected two of 6 joints such as J3+J2" in capsys.readouterr().err


def test_the_order_of_the_rows_gives_times_where_the_user_says_so(tmp_path, capsys):
    several(tmp_path, poses())
    log, dh, out = (str(tmp_path / name) for name in ("log.csv", "ur5.csv", "run.csv"))
    arguments = ["import", log, "--arm", "--dh", dh, "--u-um", "5", "-o", out, "--in-order"]
    assert main([*arguments, "30"]) == 0
    run = read_run(tmp_path / "run.csv", read_machine(tmp_path / "run.machine.toml"))
    np.testing.assert_array_equal(np.unique(run.touches.time), 30.0 * np.arange(POSES))
    t = run.touches
    np.testing.assert_array_equal(np.diff(t.time) > 0.0, np.diff(t.pose) != 0)
    assert main([*arguments, "0", "--force"]) == BAD
    assert "--in-order 0: expected seconds" in capsys.readouterr().err
    kind = ["import", log, "--positioning", "X", "--u-um", "5", "-o", out, "--in-order", "30"]
    assert main([*kind, "--target", "x1", "--actual", "x2", "--force"]) == BAD
    assert "--in-order: expected with --arm" in capsys.readouterr().err
