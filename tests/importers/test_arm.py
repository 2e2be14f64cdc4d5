"""Arms under a tracker: kinematics from a table of parameters, against loops that share no code."""

import re

import numpy as np
import pytest

from matstd.cli import main
from matstd.diagnosis.fit import fit_run
from matstd.importers import read_sheet
from matstd.importers.arms import arm_from_dh, read_arm, tracker_run
from matstd.twin.errors import BadFile, DesignError, NotEnoughData
from matstd.twin.files import read_machine, read_run, write_run
from matstd.twin.frames import apply
from matstd.twin.library import ordinary_model
from matstd.twin.machine import table_to_tool
from matstd.twin.units import DEG, NM, UM

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
    found = [(by_hand(row, modified) @ [*REFLECTOR, 1.0])[:3] for row in q]
    return tracked(length * np.array(found))


def tracked(places):
    """Places of the base as the tracker sees them."""
    axis = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    R = np.eye(3) + np.sin(2.0) * K + (1.0 - np.cos(2.0)) * K @ K
    return places @ R.T + np.array([2100.0, -900.0, 350.0])


def written(tmp_path, places, q, decimal=","):
    lines = ["J1 [deg];J2 [deg];J3 [deg];J4 [deg];J5 [deg];J6 [deg];X [mm];Y [mm];Z [mm];Zeit [s]"]
    for k, (row, place) in enumerate(zip(q / DEG, places, strict=True)):
        lines.append(";".join(f"{v:.9f}" for v in (*row, *place, 20.0 * k)).replace(".", decimal))
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="cp1252")
    (tmp_path / "ur5.csv").write_text(UR5)
    return tmp_path / "log.csv"


def arm_of(tmp_path, q, *more):
    """Chain and turned flange of the table of parameters."""
    (tmp_path / "ur5.csv").write_text(UR5)
    return arm_from_dh(read_sheet(tmp_path / "ur5.csv"), q, *more)


def words(tmp_path):
    """The command that makes a run of the log."""
    log, dh, out = (str(tmp_path / name) for name in ("log.csv", "ur5.csv", "run.csv"))
    return ["import", log, "--arm", "--dh", dh, "--u-um", "5", "-o", out]


@pytest.mark.parametrize("modified", [False, True])
def test_the_chain_of_a_table_of_parameters_is_the_arm(tmp_path, modified):
    q = poses()
    chain, turned = arm_of(tmp_path, q, modified)
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
    table = read_arm(sheet)
    assert table.joints[0] == "J1 [deg]"
    chain, turned = arm_of(tmp_path, table.q)
    run = tracker_run(table, chain, 5.0 * UM)
    np.testing.assert_allclose(run.touches.target[0], turned @ REFLECTOR, atol=1e-5)
    assert np.abs(run.deviation).max() < 1e-5
    assert run.touches.time[3] == 20.0
    stated = tracker_run(table, chain, 5.0 * UM, turned @ REFLECTOR)
    assert np.abs(stated.deviation).max() < 1e-5


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_reflector_on_either_side_of_the_flange_is_written_and_read(tmp_path, monkeypatch, side):
    """On the far side the distance along the tool is negative, which no probe's length is."""
    monkeypatch.setitem(globals(), "REFLECTOR", side * REFLECTOR)
    q = poses()
    sheet = read_sheet(written(tmp_path, seen(q), q))
    chain, turned = arm_of(tmp_path, q)
    run = tracker_run(read_arm(sheet), chain, 5.0 * UM)
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
    chain, turned = arm_of(tmp_path, q)
    run = tracker_run(read_arm(sheet), chain, 5.0 * UM, turned @ REFLECTOR)
    middle = run.touches.point.reshape(-1, 3, 3)[:, 0]
    outwards = middle - middle.mean(axis=0)
    dev = run.deviation.reshape(-1, 3)
    slope = np.sum(dev * outwards) / np.sum(outwards**2)
    assert slope == pytest.approx(-20e-6, rel=0.02)


def test_the_command_makes_run_and_machine(tmp_path, answer):
    q = poses()
    table, out = written(tmp_path, seen(q), q), tmp_path / "run.csv"
    said = " ".join(answer(words(tmp_path)).split())
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
        read_arm(read_sheet(table))
    table.write_text(text.replace("X [mm]", "X [mm];X cmd [mm]"))
    chain, _ = arm_of(tmp_path, q)
    table.write_text("\n".join(text.splitlines()[:5]) + "\n")
    sheet = read_sheet(table)
    with pytest.raises(DesignError, match="4 poses, expected 6"):
        tracker_run(read_arm(sheet), chain, 5.0 * UM)


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
    table = read_arm(several(tmp_path, poses()))
    chain, turned = arm_of(tmp_path, table.q)
    run = tracker_run(table, chain, 5.0 * UM)
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
    assert table.sheet.unused == ("state",)
    write_run(tmp_path / "run.csv", run, "none.toml")
    again = read_run(tmp_path / "run.csv", chain)
    np.testing.assert_allclose(again.touches.target, t.target, atol=1e-6)
    assert again.touches.value.keys() == {"tau2_Nm"}


@pytest.mark.parametrize(
    ("coupling", "expected", "code"), [(1.0, "--coupled J3+J2", 0), (-1.0, "--coupled J3-J2", BAD)]
)
def test_a_joint_that_counts_from_another_link_is_named(tmp_path, capsys, coupling, expected, code):
    """As the controls of Fanuc count joint 3; nothing is applied until the user says so.

    The other way round 172 mm are left of places that spread by 323: no run is made of that.
    """
    several(tmp_path, poses(), coupling)
    arguments = words(tmp_path)
    assert main(arguments) == code
    said = capsys.readouterr()
    assert expected in (said.err if code else said.out)
    assert (tmp_path / "run.csv").exists() == (code == 0)
    assert main([*arguments, "--force", "--coupled", expected.split()[1]]) == 0
    said = capsys.readouterr().out
    assert "do not agree" not in said
    assert "deviations 0.000 µm" in said


def test_a_coupling_of_joints_that_are_not_there_is_refused(tmp_path, capsys):
    several(tmp_path, poses())
    assert main([*words(tmp_path), "--coupled", "J7+J2"]) == BAD
    assert "--coupled J7+J2: expected two of 6 joints such as J3+J2" in capsys.readouterr().err


def test_the_order_of_the_rows_gives_times_where_the_user_says_so(tmp_path, capsys):
    several(tmp_path, poses())
    arguments = [*words(tmp_path), "--in-order"]
    assert main([*arguments, "30"]) == 0
    run = read_run(tmp_path / "run.csv", read_machine(tmp_path / "run.machine.toml"))
    np.testing.assert_array_equal(np.unique(run.touches.time), 30.0 * np.arange(POSES))
    t = run.touches
    np.testing.assert_array_equal(np.diff(t.time) > 0.0, np.diff(t.pose) != 0)
    assert main([*arguments, "0", "--force"]) == BAD
    assert "--in-order 0: expected seconds" in capsys.readouterr().err
    log, out = (str(tmp_path / name) for name in ("log.csv", "run.csv"))
    kind = ["import", log, "--positioning", "X", "--u-um", "5", "-o", out, "--in-order", "30"]
    assert main([*kind, "--target", "x1", "--actual", "x2", "--force"]) == BAD
    assert "--in-order: expected with --arm" in capsys.readouterr().err


def refused(tmp_path, q, places):
    """What a table of poses is refused with."""
    sheet = read_sheet(written(tmp_path, places, q))
    table = read_arm(sheet)
    chain, _ = arm_of(tmp_path, table.q)
    with pytest.raises(NotEnoughData) as refusal:
        tracker_run(table, chain, 5.0 * UM)
    return str(refusal.value)


def on_a_line():
    """Poses along X of the base with one orientation, by the law of cosines.

    Joints 2, 3 and 4 turn about one direction, so with q2 + q3 + q4 constant nothing turns.
    """
    x, z = np.linspace(-650.0, -350.0, 40), -250.0  # of the wrist as seen from joint 2
    cos3 = (x**2 + z**2 - A[1] ** 2 - A[2] ** 2) / (2.0 * A[1] * A[2])
    q3 = np.arccos(cos3)
    q2 = np.arctan2(z, x) - np.arctan2(A[2] * np.sin(q3), A[1] + A[2] * np.cos(q3))
    rest = np.tile([0.3, 0.4], (len(x), 1))
    return np.column_stack([np.zeros(len(x)), q2, q3, 0.7 - q2 - q3, rest])


@pytest.mark.parametrize("noise", [0.0, 20.0 * UM])
def test_a_path_with_one_orientation_does_not_say_where_the_reflector_sits(tmp_path, capsys, noise):
    """R never changes: another reflector is another tracker; about the line everything may turn."""
    q = on_a_line()
    flange = np.array([by_hand(row)[:3, 3] for row in q])
    assert np.ptp(flange[:, 0]) == pytest.approx(300.0)
    np.testing.assert_allclose(np.ptp(flange[:, 1:], axis=0), 0.0, atol=1e-9)
    places = seen(q) + noise * np.random.default_rng(5).normal(size=(len(q), 3))
    message = refused(tmp_path, q, places)
    assert "the reflector along every direction of the tool frame" in message
    assert "a turn of the tracker about X of the table frame" in message
    assert "--reflector X Y Z" in message
    assert main(words(tmp_path)) == BAD
    assert "the reflector along every direction" in capsys.readouterr().err
    assert not (tmp_path / "run.csv").exists()


def test_one_pose_says_nothing_but_where_the_reflector_was(tmp_path):
    q = np.tile(poses()[0], (10, 1))
    message = refused(tmp_path, q, seen(q))
    assert "the reflector along every direction of the tool frame" in message
    assert "a turn of the tracker about every direction of the table frame" in message


def test_a_turn_of_one_joint_says_how_far_from_its_line_the_reflector_is(tmp_path):
    """Joint 6 turns about z of the flange: along it and around it the reflector may be anywhere.

    What is determined is its distance from the line: square to z of the flange, wherever around the
    line the search has ended. The tracker turns about the line as the reflector does.
    """
    q = np.tile(poses()[1], (20, 1))
    q[:, 5] = np.linspace(-2.0, 2.0, 20)
    _, turned = arm_of(tmp_path, q)
    message = refused(tmp_path, q, seen(q))
    number = r"(-?\d\.\d\d)"
    triple = rf"\({number}, {number}, {number}\)"
    match = re.search(rf"reflector along every direction square to {triple} of the tool", message)
    assert match
    determined = np.array(match.groups(), dtype=float)
    assert np.linalg.norm(determined) == pytest.approx(1.0, abs=0.01)
    assert determined @ turned[:, 2] == pytest.approx(0.0, abs=0.01)
    line = by_hand(q[0])[:3, 2] * np.sign(by_hand(q[0])[1, 2])
    assert f"a turn of the tracker about ({', '.join(f'{c:.2f}' for c in line)}) of" in message


def test_a_stated_reflector_on_a_line_leaves_a_turn_about_it(tmp_path):
    q = on_a_line()
    sheet = read_sheet(written(tmp_path, seen(q), q))
    table = read_arm(sheet)
    chain, turned = arm_of(tmp_path, table.q)
    with pytest.raises(NotEnoughData) as refusal:
        tracker_run(table, chain, 5.0 * UM, turned @ REFLECTOR)
    said = str(refusal.value)
    assert "leave open a turn of the tracker about X of the table frame; expected poses off" in said


def test_places_of_another_arm_are_refused_with_what_is_left(tmp_path, capsys):
    """Places that have nothing to do with the readings: a tracker sees 1 m of scatter."""
    q = poses()
    places = 1000.0 * np.random.default_rng(8).normal(size=(len(q), 3))
    written(tmp_path, places, q)
    assert main(words(tmp_path)) == BAD
    assert "mm rms are left of measured places that spread by" in capsys.readouterr().err


MACHINE = """format = "machine/1"
name = "gantry"
chain = "[w f X Y Z t]"
[axis.X]
range = [0, 500]
[axis.Y]
range = [0, 500]
[axis.Z]
range = [0, 500]
"""


def test_a_column_z_is_not_a_column_Z(tmp_path, capsys):
    """Readings X, Y, Z beside places x, y, z: Z is 100 ppm longer than its readings say."""
    q = np.stack(np.meshgrid(*3 * [[0.0, 200.0, 400.0]]), axis=-1).reshape(-1, 3)
    rows = ["X [mm],Y [mm],Z [mm],x [mm],y [mm],z [mm]"]
    rows += [",".join(f"{v:.9f}" for v in (*r, r[0], r[1], r[2] * 1.0001)) for r in q]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "gantry.toml").write_text(MACHINE)
    command = ["import", str(tmp_path / "log.csv"), "--arm", "--machine"]
    command += [str(tmp_path / "gantry.toml"), "--u-um", "5", "--reflector", "0", "0", "0"]
    assert main([*command, "-o", str(tmp_path / "run.csv")]) == 0
    run = read_run(tmp_path / "run.csv", read_machine(tmp_path / "gantry.toml"))
    along = run.touches.normal[:, 2] > 0.5
    slope = np.polyfit(run.touches.reading("Z")[along], run.deviation[along], 1)[0]
    assert slope == pytest.approx(-100e-6, rel=0.03)
    capsys.readouterr()


def test_two_columns_of_places_without_names_are_refused(tmp_path):
    q = poses()
    table = written(tmp_path, seen(q), q)
    text = table.read_text(encoding="cp1252").splitlines()
    doubled = [text[0] + ";x [mm];y [mm];z [mm]", *(line + ";1,0;2,0;3,0" for line in text[1:])]
    table.write_text("\n".join(doubled) + "\n", encoding="cp1252")
    chain, _ = arm_of(tmp_path, q)
    sheet = read_sheet(table)
    with pytest.raises(BadFile, match=r"'Z \[mm\]'.*'z \[mm\]'.*one column of measured x, y, z"):
        tracker_run(read_arm(sheet), chain, 5.0 * UM)
