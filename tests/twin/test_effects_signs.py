"""Every effect by hand: one machine, one pose, one amplitude, the sign and size of dev.

HSM 600U, `[w C' B' X' f Y Z (C1) t]`, tool length 160 mm. At X 100, Y 50, Z -200, B = C = 0 the
ball centre stands at (100, 50, 140) of the table frame, the line of B at height 80. A touch with
outward normal n reads dev = -n . (motion of the tip) + n . (shift of the standard) + bias.
"""

from dataclasses import replace

import numpy as np
import pytest
from machines import HSM600U

from matstd.twin.effects.joint_sag import KIND as JOINT_SAG
from matstd.twin.errors import UnknownEffect
from matstd.twin.library import parse_effect
from matstd.twin.machine import Axis, make_chain
from matstd.twin.model import columns, is_tunable
from matstd.twin.record import Setup, Touches
from matstd.twin.units import DEG, NM, UM, URAD

PER_HAND = 0.5 * NM
"""Hand values are given to half a nanometre."""

X, Y, Z = np.eye(3)

HELD = Setup("a", fixing=(0.0, 0.0, 40.0))


def touch(normal, X=100.0, Y=50.0, Z=-200.0, B=0.0, C=0.0, n=1, **more):
    """n touches in one pose (angles in deg), with normals in the table frame."""
    by_name = {"X": X, "Y": Y, "Z": Z, "B": B * DEG, "C": C * DEG, "C1": 0.0}
    q = np.tile([by_name[a] for a in HSM600U.axes], (n, 1))
    given = {
        "time": np.zeros(n),
        "approach": np.zeros(q.shape),
        "setups": (Setup("a"),),
        "setup": np.zeros(n, dtype=np.int64),
        "point": np.tile((100.0, 50.0, 140.0), (n, 1)),
    }
    return Touches(
        chain=HSM600U,
        q=q,
        length=np.full(n, 160.0),
        radius=np.full(n, 3.0),
        normal=np.tile(np.asarray(normal, dtype=float), (n, 1)),
        **{**given, **more},
    )


def deviation(name, theta, touches, *tuning):
    """dev in um of an effect with parameters theta (base units)."""
    effect = parse_effect(name, HSM600U)
    if tuning:
        assert is_tunable(effect)
        effect = effect.tuned(*tuning)
    return columns([effect], touches) @ np.atleast_1d(theta) / UM


def first(name, size, touches, *tuning, parameter=0):
    """dev in um of the first touch, with one parameter of the effect set."""
    theta = np.zeros(len(parse_effect(name, HSM600U).parameters))
    theta[parameter] = size
    return deviation(name, theta, touches, *tuning)[0]


def warm(normal, **sensors):
    """A touch with temperatures of some sensors, degC."""
    return touch(normal, temperature={name: np.array([t]) for name, t in sensors.items()})


def pushed(normal, *force):
    """A touch with a force on the tool, N."""
    return touch(normal, force=np.array([force]))


def moving(**signs):
    """Signs of the last motion of some axes, (1, A)."""
    return np.array([[signs.get(a, 0.0) for a in HSM600U.axes]])


# name, size, touch, parameter, hand value in um
BY_HAND = {
    # EXX = 5 um, the tip stands 5 um further in +X, a wall facing +X is seen 5 um inside
    "linear component": ("geometric(EXX,1)", 20 * UM, touch(X), 0, -5.0),
    # u = 0.25, T_2 = 2 u^2 - 1 = -0.875
    "parabolic component": ("geometric(EXX,2)", 8 * UM, touch(X), 1, 7.0),
    # T_3 = 4 u^3 - 3 u = -0.6875
    "cubic component": ("geometric(EZX,4)", 16 * UM, touch(Z), 2, 11.0),
    # sin(2 C) at 45 deg
    "harmonic of C": ("geometric(EZC,2)", 3 * UM, touch(Z, C=45.0), 2, -3.0),
    # FORMATS.md: EC0Y = 10 urad moves the tip by -0.5 um in x at Y = 50
    "squareness": ("location(EC0Y)", 10 * URAD, touch(X), 0, 0.5),
    # EBX = 100 urad * u_X 0.25 * u_Z 0.2 = 5 urad on 360 mm below: -1.8 um in x
    "coupling of two lengths": ("coupling(EBX,Z)", 100 * URAD, touch(X), 0, 1.8),
    "coupling with a turn": ("coupling(EZX,C)", 8 * UM, touch(Z, C=60.0), 0, -1.0),
    "coupling with a turn, sine": ("coupling(EZX,C)", 8 * UM, touch(Z, C=-90.0), 1, 2.0),
    # cos B cos C = 0.5 at B = 0, C = 60
    "coupling of two turns": ("coupling(EZB,C)", 8 * UM, touch(Z, C=60.0), 0, -4.0),
    # forward: +B/2
    "backlash forward": ("backlash(X)", 10 * UM, touch(-X, approach=moving(X=1.0)), 0, 5.0),
    "backlash backward": ("backlash(X)", 10 * UM, touch(X, approach=moving(X=-1.0)), 0, 5.0),
    "backlash unknown": ("backlash(X)", 10 * UM, touch(X), 0, 0.0),
    # +10 urad about y at arm (100, 50, 60): (0.6, 0, -1.0) um
    "backlash of B": ("backlash(B)", 20 * URAD, touch(Z, approach=moving(B=1.0)), 0, 1.0),
    "backlash of B in x": ("backlash(B)", 20 * URAD, touch(X, approach=moving(B=-1.0)), 0, 0.6),
    # 10e-6 * 5 K * 100 mm
    "expansion of a scale": ("thermal-expansion(X,glass)", 10e-6, warm(X, glass=25.0), 0, -5.0),
    "expansion at 20 degC": ("thermal-expansion(X,glass)", 10e-6, warm(X, glass=20.0), 0, 0.0),
    # overhang (0 - -250)/500 = 1/2, cubed
    "sag of a ram": ("gravity(EYZ)", 8 * UM, touch(Y, Z=-250.0), 0, -1.0),
    "ram drawn in": ("gravity(EYZ)", 8 * UM, touch(Y, Z=0.0), 0, 0.0),
    # EZB at B = -45 deg: sin(-90 deg) = -1, along machine z which is (-1, 0, 1)/sqrt 2 there
    "tilting weight": ("gravity(EZB)", np.sqrt(2.0) * UM, touch(Z, B=-45.0), 0, 1.0),
    # sin(-90) cos(180) = 1 in machine z, which is table x at B = -90, C = 0 and -x at C = 180
    "load off centre": ("gravity(EZB,C)", 2 * UM, touch(X, B=-90.0, C=180.0), 0, -2.0),
    # 50 N down on the tool: 5 um down
    "stiffness of Z": ("stiffness(Z)", 0.1 * UM, pushed(Z, 0.0, 0.0, -50.0), 0, 5.0),
    # 10 N in +x at 60 mm above the line of B: 600 N mm; 1e-9 rad/(N mm) gives 0.6 urad * 60 mm
    "stiffness of B": ("stiffness(B)", 1e-9, pushed(X, 10.0, 0.0, 0.0), 0, -0.036),
    "stiffness of the tool": ("stiffness(t)", 0.5 * UM, pushed(Y, 0.0, 4.0, 0.0), 0, -2.0),
    # pushed down by 50 N: half of 8 um of play downwards
    "play of Z": ("load-play(Z)", 8 * UM, pushed(Z, 0.0, 0.0, -50.0), 0, 4.0),
    "play of Z pulled": ("load-play(Z)", 8 * UM, pushed(Z, 0.0, 0.0, 5.0), 0, -4.0),
    # half of 0.1 um/N more under push than under pull, at 50 N: 2.5 um upwards, whichever way
    "softer upwards": ("load-play(Z)", 0.1 * UM, pushed(Z, 0.0, 0.0, -50.0), 1, -2.5),
    "ball too large": ("probe-radius", 4 * UM, touch(Y), 0, 4.0),
    "stylus square to the wall": ("stylus-bending", 4 * UM, touch(Y), 0, 4.0),
    "stylus at 30 deg": ("stylus-bending", 4 * UM, touch((0.5, 0.0, np.sqrt(0.75))), 0, 1.0),
    # B = -90: the tool axis lies along -x of the table
    "stylus along the normal": ("stylus-bending", 4 * UM, touch(-X, B=-90.0), 0, 0.0),
    "stylus square at B -90": ("stylus-bending", 4 * UM, touch(Z, B=-90.0), 0, 4.0),
    # (T - 20) alpha p_z = 10 K * 10e-6 * 140 mm
    "growing standard": ("artefact-expansion(block)", 10e-6, warm(Z, block=30.0), 0, 14.0),
    # held 40 mm above the origin of the table: 10 K * 10e-6 * (140 - 40) mm
    "growing standard, held": (
        "artefact-expansion(block)",
        10e-6,
        replace(warm(Z, block=30.0), setups=(HELD,)),
        0,
        10.0,
    ),
    # 2 h at 3 um/h in +x carries the wall that faces +x outwards
    "drift": ("drift", 3 * UM, touch(X, time=np.array([7200.0])), 0, 6.0),
}


@pytest.mark.parametrize("case", BY_HAND.values(), ids=BY_HAND.keys())
def test_size_and_sign_by_hand(case) -> None:
    name, size, touches, parameter, expected = case
    assert first(name, size, touches, parameter=parameter) == pytest.approx(
        expected, abs=PER_HAND / UM
    )


def test_pitch_of_a_screw() -> None:
    """X = 102 mm over a pitch of 8 mm is 12.75 turns: the sine stands at -1, the cosine at 0."""
    here = touch(X, X=102.0)
    assert first("periodic(EXX)", 2 * UM, here, 8.0) == pytest.approx(2.0, abs=PER_HAND / UM)
    assert first("periodic(EXX)", 2 * UM, here, 8.0, parameter=1) == pytest.approx(
        0.0, abs=PER_HAND / UM
    )


def test_third_harmonic_of_c() -> None:
    """sin(3 * 30 deg) = 1, upwards."""
    here = touch(Z, C=30.0)
    assert first("periodic(EZC)", UM, here, 3.0) == pytest.approx(-1.0, abs=PER_HAND / UM)


@pytest.mark.parametrize(
    ("azimuth_deg", "lobes", "expected"), [(60.0, 3, -2.0), (0.0, 3, 2.0), (90.0, 4, 2.0)]
)
def test_lobes_of_the_probe(azimuth_deg: float, lobes: int, expected: float) -> None:
    """2 um cos(k phi) on an upright wall; half of it on a slope of 30 deg."""
    phi = azimuth_deg * DEG
    wall = np.array([np.cos(phi), np.sin(phi), 0.0])
    slope = 0.5 * wall + np.sqrt(0.75) * Z
    for normal, share in ((wall, 1.0), (slope, 0.5), (Z, 0.0)):
        found = first("probe-lobing", 2 * UM, touch(normal), float(lobes))
        assert found == pytest.approx(share * expected, abs=PER_HAND / UM)


def test_lobes_turn_with_the_tool() -> None:
    """At B = -90 deg the table's z is the tool's x, its -y the tool's -y."""
    across = touch(Z, B=-90.0)
    assert first("probe-lobing", 2 * UM, across, 3.0) == pytest.approx(2.0, abs=PER_HAND / UM)
    down = touch(-Y, B=-90.0)  # azimuth -90 deg: sin(-270 deg) = 1
    assert first("probe-lobing", 2 * UM, down, 3.0, parameter=1) == pytest.approx(
        2.0, abs=PER_HAND / UM
    )


def test_bent_column() -> None:
    """Half way up Z (500 mm), 4 K, 5 urad/K at the top: 10 urad about x, and an offset in y.

    The column leans to -Y: its offset there is -20 urad * 500 mm * 0.5^2 / 2 = -1.25 um. The
    reference point of Z travels with it to -250, the ball hangs 160 mm below: +1.6 um in y.
    """
    warm = {"columnFront": np.array([23.0]), "columnBack": np.array([19.0])}
    here = touch(Y, Z=-250.0, temperature=warm)
    found = first("column-bending(Z,columnFront,columnBack)", 5 * URAD, here)
    assert found == pytest.approx(-(-1.25 + 1.6), abs=PER_HAND / UM)


def test_slip_moves_the_later_touches_of_its_setup() -> None:
    """5 um up after t = 15 s, until the standard is set up again."""
    touches = touch(
        Z,
        n=4,
        time=np.array([0.0, 10.0, 20.0, 30.0]),
        setups=(Setup("a"), Setup("b")),
        setup=np.array([0, 0, 0, 1]),
    )
    theta = np.zeros(6)
    theta[2] = 5 * UM
    found = deviation("artefact-slip", theta, touches, 15.0)
    np.testing.assert_allclose(found, [0.0, 0.0, 5.0, 0.0], atol=PER_HAND / UM)
    # a slip in the second set-up leaves the first alone
    found = deviation("artefact-slip", theta, touches, 25.0)
    np.testing.assert_allclose(found, [0.0, 0.0, 0.0, 5.0], atol=PER_HAND / UM)


def test_slip_turns_about_the_middle_of_the_touches() -> None:
    """10 urad about z carry a point 20 mm out in x by 0.2 um in +y."""
    touches = touch(
        Y,
        n=2,
        time=np.array([10.0, 20.0]),
        point=np.array([(80.0, 50.0, 140.0), (120.0, 50.0, 140.0)]),
    )
    theta = np.zeros(6)
    theta[5] = 10 * URAD
    found = deviation("artefact-slip", theta, touches, 0.0)
    np.testing.assert_allclose(found, [-0.2, 0.2], atol=PER_HAND / UM)


def test_form_of_one_patch() -> None:
    """sqrt(3) v/2 over 40 mm of touched points: -2, 0, 2 um; nothing on the other patch."""
    place = np.array([(-20.0, 0.0, 0.0), (0.0, 5.0, 0.0), (20.0, -5.0, 0.0), (3.0, 3.0, 0.0)])
    touches = touch(Z, n=4, point=place, feature=np.array(["pad1", "pad1", "pad1", "pad2"]))
    theta = np.zeros(21)
    theta[1] = 4 * UM / np.sqrt(3.0)
    found = deviation("artefact-form(pad1)", theta, touches)
    assert abs(found[0]) == pytest.approx(2.0, abs=1e-3)
    assert found[2] == pytest.approx(-found[0], abs=1e-3)
    assert found[3] == 0.0
    theta[:2] = (6 * UM, 0.0)
    np.testing.assert_allclose(
        deviation("artefact-form(pad1)", theta, touches), [3.0, 3.0, 3.0, 0.0], atol=PER_HAND / UM
    )


def test_a_position_table_is_a_curve_for_each_direction() -> None:
    """X at 100 of -400 to 400, s = 5/8: E = 4 um w_1 cos(5 pi/8), and half of 2 um of reversal.

    With l = 0.3 the first of 20 waves has the weight 1/(1 + (0.3 pi)^2) over the root of the sum of
    all squares; the axis went too far, so a surface that looks along +X seems to stand lower.
    """
    share = [1.0 / (1.0 + (0.3 * np.pi * k) ** 2) for k in range(1, 21)]
    curve = 4.0 * share[0] / np.sqrt(sum(w * w for w in share)) * np.cos(5.0 * np.pi / 8.0)
    approach = np.zeros((3, len(HSM600U.axes)))
    approach[:, HSM600U.axis_index("X")] = (1.0, -1.0, 0.0)
    touches = touch(X, n=3, approach=approach)
    theta = np.zeros(41)
    theta[0], theta[20] = 4 * UM, 2 * UM
    found = deviation("position-table(EXX,directions)", theta, touches, 0.3)
    np.testing.assert_allclose(found, [-curve - 1.0, -curve + 1.0, -curve], atol=PER_HAND / UM)
    found = deviation("position-table(EXX)", theta[:20], touches, 0.3)
    np.testing.assert_allclose(found, -curve, atol=PER_HAND / UM)


def test_a_position_table_of_a_whole_turn_closes_in_itself() -> None:
    """C from -360 to 360 deg: the errors at both ends, and their slopes, are the same."""
    theta = np.random.default_rng(1).normal(size=20) * URAD
    near = 1e-4
    found = [
        deviation("position-table(ECC)", theta, touch(Y, C=c), 0.1)[0]
        for c in (-360.0, -360.0 + near, 360.0, 360.0 - near)
    ]
    assert found[0] == pytest.approx(found[2], abs=1e-9)
    assert found[1] - found[0] == pytest.approx(found[2] - found[3], rel=1e-3)


def test_an_arm_that_is_stretched_out_sags() -> None:
    """Two joints about +Y at x = -500 and -200, the flange at 0; all upright lines of weight.

    At rest the shoulder has the levers 300 (elbow) and 500 mm (flange): with 1 and 0.5 urad/mm it
    turns by 300 + 250 urad, the arm dips, and the flange at 500 mm goes down by 0.275 mm. With the
    shoulder at -90 deg (the arm straight up, +Y turns +X to -Z) nothing has a lever.
    """
    arm = make_chain(
        "planar arm",
        "[w f B B1 t]",
        {
            "B": Axis((-np.pi, np.pi), (-500.0, 0.0, 0.0)),
            "B1": Axis((-np.pi, np.pi), (-200.0, 0.0, 0.0)),
        },
    )
    effect = parse_effect("joint-sag(B)", arm)
    assert effect.places == ("B1", "flange")
    touches = Touches(
        chain=arm,
        q=np.array([[0.0, 0.0], [-0.5 * np.pi, 0.0], [-0.5 * np.pi, 0.5 * np.pi]]),
        length=np.zeros(3),
        radius=np.zeros(3),
        point=np.zeros((3, 3)),
        normal=np.tile(Z, (3, 1)),
        setups=(Setup("a"),),
        setup=np.zeros(3, dtype=np.int64),
        time=np.zeros(3),
        approach=np.zeros((3, 2)),
    )
    found = columns([effect], touches) @ [1e-6, 0.5e-6] / UM
    # bent at the elbow the forearm of 200 mm lies level: 0.5 urad/mm * 200 mm, on a lever of 200 mm
    np.testing.assert_allclose(found, [275.0, 0.0, 20.0], atol=1e-6)
    elbow = columns([parse_effect("joint-sag(B1)", arm)], touches) @ [1e-6] / UM
    np.testing.assert_allclose(elbow, [40.0, 0.0, 40.0], atol=1e-6)


def test_machines_that_are_no_arm_have_no_joints_that_sag() -> None:
    assert not list(JOINT_SAG.propose(touch(Z)))
    with pytest.raises(UnknownEffect, match="carries the tool: none on this machine"):
        parse_effect("joint-sag(B)", HSM600U)
