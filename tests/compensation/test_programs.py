"""Part programs: read as LinuxCNC reads them, compensated, played on a second machine model."""

import re

import numpy as np
import pytest
from bench import LENGTH, oracle_tip, part_program, readings
from rs274 import is_there, moves

from matstd import compensate
from matstd.compensation.field import MachineErrors, State
from matstd.compensation.part_programs import Keep
from matstd.compensation.programs import compensated
from matstd.compensation.programs.path import ProgramPath
from matstd.compensation.tables import header_of
from matstd.twin.errors import BadArgument, BadFile, OutsideTravel
from matstd.twin.library import parse_effect
from matstd.twin.units import DEG, NM, UM

PROBE = "T3 P3 Z160.0 D6.0"
TOLERANCE = 1.0 * UM

GCODE = """%
(a contour)
G21 G17 G90 G54
T3 M6
S8000 M3
G0 Z50
N70 G0 X0 Y0
G1 Z-5 F500 M8
G1 X100 F1500
G3 X100 Y50 I0 J25
G3 X50 Y100 R50
G91 G1 X-10 Y-10
G90
G18 G2 X20 Z-15 I-10 K-5
G17 G1 B-20 C45 X20
G2 X20 Y90 I30 J0 Z-6 P2 (helix of two turns)
G20 G1 X1.0 Y2.0 F50
G21 G0 Z50 M9
M30
"""
KLARTEXT = """0 BEGIN PGM PART MM
1 TOOL CALL 3 Z S8000
2 L Z+50 R0 FMAX M3
3 L X+0 Y+0 R0 FMAX
4 L Z-5 F500 M8
5 L X+100 F1500
6 CC X+100 Y+25
7 C X+100 Y+50 DR+
8 CR X+50 Y+100 R+50 DR+
9 L IX-10 IY-10
10 L B-20 C+45 FMAX
11 M128
12 L X+10 Y+20 Z-5 F1500
13 L X+60 Y-10 Z+5 B-60 C+120
14 M129
15 L Z+50 FMAX M9
16 M30
17 END PGM PART MM
"""


@pytest.fixture(scope="module")
def done(known, frame, head, tmp_path_factory):
    """Both programs compensated, by their endings."""
    folder = tmp_path_factory.mktemp("programs")
    texts = {"part.ngc": GCODE, "part.H": KLARTEXT}
    return {
        name: compensated(part_program(text, frame, folder, name), known, head, TOLERANCE)
        for name, text in texts.items()
    }


def coordinates(text):
    """X, Y, Z, B and C of every line that has all of X, Y and Z; read by nothing of ours."""
    rows, last = [], {"B": 0.0, "C": 0.0}
    for block in text.splitlines():
        found = dict(re.findall(r"\b([XYZBC])([+-]?\d+\.\d+)", block.partition(";")[0]))
        last |= {k: float(v) for k, v in found.items()}
        if set("XYZ") <= set(found):
            rows.append([last[k] for k in "XYZBC"])
    return np.array(rows)


def actual(xyzbc, frame):
    """Where the second model's tool point is, seen from the datum as the machine finds it."""
    zero = oracle_tip(frame.datum.q[None], frame.chain)
    return oracle_tip(readings(xyzbc, frame), frame.chain) - zero


# --- reading ----------------------------------------------------------------------------------


@is_there
def test_linuxcnc_reads_the_same_motions(frame, tmp_path):
    """Ends, planes, centres, senses and turns of every motion, inches and steps included."""
    motions = part_program(GCODE, frame, tmp_path, "a.ngc").motions
    theirs = moves(GCODE, tmp_path, PROBE)[1:]
    # the first stands still in X and Y, and is no motion of ours
    assert len(motions) == len(theirs)
    columns = [frame.chain.axis_index(a) for a in "XYZBC"]
    plane, first = "XY", {"XY": (0, 1, 2), "ZX": (2, 0, 1)}
    for motion, (name, numbers) in zip(motions, theirs, strict=True):
        end = motion.end[columns] / np.array([1.0, 1.0, 1.0, DEG, DEG])
        unit = motion.unit
        if name != "ARC_FEED":
            assert (name == "STRAIGHT_TRAVERSE") == motion.is_rapid
            expected = [*(v * unit for v in numbers[:3]), *numbers[4:6]]
            np.testing.assert_allclose(end, expected, atol=6e-5 * unit)
            continue
        plane = (
            "ZX"
            if motion.arc.plane == (frame.chain.axis_index("Z"), frame.chain.axis_index("X"))
            else "XY"
        )
        a, b, across = first[plane]
        np.testing.assert_allclose(end[[a, b, across]], [*numbers[:2], numbers[5]], atol=6e-5)
        np.testing.assert_allclose(motion.arc.centre, numbers[2:4], atol=6e-5)
        assert np.sign(motion.arc.angle) == np.sign(numbers[4])
        turns = np.ceil(abs(motion.arc.angle) / (2 * np.pi) - 1e-9)
        assert turns == abs(numbers[4])


def test_klartext_is_the_same_geometry(frame, tmp_path):
    g = part_program(GCODE, frame, tmp_path, "a.ngc").motions
    h = part_program(KLARTEXT, frame, tmp_path, "part.H").motions
    for a, b in zip(g[:6], h[:6], strict=True):
        np.testing.assert_allclose(a.end, b.end, atol=1e-12)
        assert (a.arc is None) == (b.arc is None)
        if a.arc is not None:
            np.testing.assert_allclose(a.arc.centre, b.arc.centre, atol=1e-12)
            np.testing.assert_allclose(a.arc.angle, b.arc.angle)
    assert [m.tcpm for m in h[-4:]] == [False, True, True, False]


@pytest.mark.parametrize(
    ("name", "block", "said"),
    [
        ("a.ngc", "G41 D1 X5", "tool 1, whose radius is not stated, expected --tool-radius"),
        ("a.ngc", "G87 X1 Y1 Z-3 R2", "G87, expected G0 to G4"),
        ("a.ngc", "#1 = 5", "no parameters, expressions"),
        ("a.ngc", "G1 X[1+2]", "no parameters, expressions"),
        ("a.ngc", "O100 CALL", "no parameters, expressions"),
        ("a.ngc", "G55", "G54 alone: a compensated program holds for one datum"),
        ("a.ngc", "G10 L2 P1 X0", "one datum for the whole program"),
        ("a.ngc", "M98 P3", "M98, expected M0 to M9"),
        ("a.ngc", "M88", "--pass-m 88 where it moves nothing"),
        ("a.ngc", "G68.2 X0 Y0 Z0 I0 J30 K0", "plain coordinates of the datum"),
        ("a.ngc", "G1 U5", "axis of the machine: C, B, X, Y, Z"),
        ("a.ngc", "G2 X9 Y0 I2 J0", "mm off the circle"),
        ("a.ngc", "G2 X90 Y0 R5", "R5 for ends 89.0000 mm apart"),
        ("a.ngc", "G1 X1 ?", "words of G-code"),
        ("a.H", "L X+1 RL F9", "the tool, whose radius is not stated, expected --tool-radius"),
        ("a.H", "L X+Q1", "Q1 without a value, expected a parameter that the program has set"),
        ("a.H", "FN 18: SYSREAD Q1 = ID1", "expected FN 0 to FN 8 and FN 13 with"),
        ("a.H", "CALL LBL 3", "LBL 3, expected a label that is defined; available: none"),
        ("a.H", "CYCL DEF 252 CIRCULAR POCKET ~\nQ215=0", "and holes (200, 201, 202"),
        ("a.H", "APPR LCT X+1 Y+1 R5 RL F9", "L, LP, CC, C, CP, CR, RND, CHF: others are"),
        ("a.H", "C X+1 Y+1 DR+ F9", "CC with two of X, Y and Z before it"),
        ("a.H", "PLANE SPATIAL SPA+10 SPB+0 SPC+0 STAY", "PLANE RESET STAY"),
        ("a.H", "L X+1 M97", "M97, expected M0 to M9"),
    ],
)
def test_what_is_not_understood_is_named_with_its_line(frame, tmp_path, name, block, said):
    start = {"a.ngc": "G54 G0 X0 Y0 Z9\nG1 X1 F9\n", "a.H": "BEGIN PGM A MM\nL X+0 Y+0 Z+9 FMAX\n"}
    with pytest.raises(BadFile, match="line 3: ") as refused:
        part_program(start[name] + block + "\n", frame, tmp_path, name)
    assert said in str(refused.value)


def test_feeds_travels_and_endings(frame, tmp_path):
    with pytest.raises(BadFile, match="line 2: found a motion without feed"):
        part_program("G0 X0 Y0 Z0\nG1 X5\n", frame, tmp_path, "a.ngc")
    with pytest.raises(BadFile, match=r"line 1: found Y at a reading of 400.000, expected -300"):
        part_program("G0 X0 Y400 Z0\n", frame, tmp_path, "a.ngc")
    with pytest.raises(BadFile, match=r"found .txt, expected one of .h, .ngc"):
        part_program("G0 X0\n", frame, tmp_path, "part.txt")


# --- compensating -----------------------------------------------------------------------------


def test_the_circle_is_round_again(done, frame, known):
    """By the second model of the machine: points, and the middles of the lines between them."""
    at = coordinates(done["part.ngc"].text)
    motion = done["part.ngc"].motion
    on_circle = np.flatnonzero(motion == 3)
    ends = at[[on_circle[0] - 1, *on_circle]]
    points = np.vstack([ends, 0.5 * (ends[1:] + ends[:-1])])
    real = actual(points, frame)
    radius = np.hypot(real[:, 0] - 100.0, real[:, 1] - 25.0)
    assert np.abs(radius - 25.0).max() < TOLERANCE + 5 * NM
    assert np.abs(real[:, 2] + 5.0).max() < 0.2 * UM
    t = np.linspace(-np.pi / 2, np.pi / 2, 20)  # the same circle without compensation
    plain = np.column_stack(
        [100 + 25 * np.cos(t), 25 + 25 * np.sin(t), np.full(20, -5.0), 0 * t, 0 * t]
    )
    was = actual(plain, frame)
    assert np.abs(np.hypot(was[:, 0] - 100, was[:, 1] - 25) - 25).max() > 5 * UM


def test_every_point_is_where_it_should_be(done):
    """The exact twin agrees with itself to what rounding leaves."""
    for found, step in ((done["part.ngc"], 0.01 * UM), (done["part.H"], 0.1 * UM)):
        assert np.linalg.norm(found.before, axis=1).max() > 10 * UM
        assert np.linalg.norm(found.after, axis=1).max() < 1.5 * step


def test_tool_point_control_is_met_on_the_turning_table(done, frame):
    """A straight line in the table frame while B and C turn, by the second model of the machine."""
    found = done["part.H"]
    k = next(i for i, m in enumerate(found.program.motions) if m.line == 14)
    rows = np.flatnonzero(found.motion == k)
    chain, zero = frame.chain, frame.datum.q
    real = oracle_tip(found.q[rows] + found.added[rows], chain) - oracle_tip(zero[None], chain)
    start, end = np.array([10.0, 20.0, -5.0]), np.array([60.0, -10.0, 5.0])
    along = (end - start) / np.linalg.norm(end - start)
    off = np.cross(real - start, along)
    assert len(rows) > 5
    assert np.linalg.norm(off, axis=1).max() < 0.2 * UM
    np.testing.assert_allclose(real[-1], end, atol=0.2 * UM)


@is_there
def test_linuxcnc_takes_what_is_written(done, tmp_path):
    """Every line as it stands, none more and none less; no arc is left."""
    found = moves(done["part.ngc"].text, tmp_path, PROBE)
    assert "ARC_FEED" not in {name for name, _ in found}
    theirs = np.array([[*v[:3], *v[4:6]] for _, v in found])[1:]
    ours = coordinates(done["part.ngc"].text)
    assert len(theirs) == len(ours)
    inches = np.abs(theirs - ours).max(axis=1) > 1.0  # written in inches, another canonical unit
    assert inches.sum() < 10
    np.testing.assert_allclose(theirs[~inches], ours[~inches], atol=6e-5)


def test_words_stay_with_their_motion(done):
    text = done["part.ngc"].text
    assert text.startswith("%\n(a contour)\n(matstd model: 0123456789ab)\n")
    order = ["M3 S8000", "M8 F500 G1", "F1500 G1", "(helix of two turns)", "M9 G0", "M30"]
    places = [text.index(word) for word in order]
    assert places == sorted(places)
    assert done["part.ngc"].unmoved == (6,)  # Z alone, before X and Y are known
    klartext = done["part.H"].text.splitlines()
    assert [int(b.split()[0]) for b in klartext] == list(range(len(klartext)))
    assert sum(" M8" in b for b in klartext) == sum(" M9" in b for b in klartext) == 1
    kept = [i.text for i in done["part.H"].program.items if isinstance(i, Keep)]
    assert all(any(k in b for b in klartext) for k in kept if "PGM" not in k)


def test_coarser_is_shorter(known, frame, head, tmp_path):
    """Chords go with the root of the tolerance."""
    text = "G0 X0 Y0 Z0\nG1 X1 F100\nG2 X1 Y0 I30 J0\n"
    part = part_program(text, frame, tmp_path, "a.ngc")
    fine, coarse = (len(compensated(part, known, head, t * UM).motion) for t in (0.5, 8.0))
    assert 3.0 < fine / coarse < 5.0


def test_a_periodic_error_is_followed(bench_chain, frame, head, tmp_path):
    """A pitch error of 40 mm: the line of 200 mm is divided far below the period."""
    effect = parse_effect("geometric(EXX,sinusoidal,20)", bench_chain)
    errors = MachineErrors.of_errors(bench_chain, [(effect, np.array([20 * UM]))])
    found = compensated(
        part_program("G0 X0 Y0 Z0\nG1 X200 F100\n", frame, tmp_path, "a.ngc"), errors, head
    )
    x = found.q[:, bench_chain.axis_index("X")] + found.added[:, bench_chain.axis_index("X")]
    fine = np.linspace(1.0, 199.0, 4001)
    true_x = fine + 20 * UM * np.sin(2 * np.pi * 20 * (fine + 400) / 800)
    at_zero = 20 * UM * np.sin(2 * np.pi * 10)
    # readings that the machine passes on straight lines, at equal shares of the nominal path
    passed = np.interp(fine, found.q[:, bench_chain.axis_index("X")], x)
    real = passed + 20 * UM * np.sin(2 * np.pi * 20 * (passed + 400) / 800) - at_zero
    assert np.abs(true_x - fine).max() > 19 * UM
    assert np.abs(real - fine).max() < 1.0 * UM


def test_reversal_is_taken_up_on_both_sides(bench_chain, frame, head, tmp_path):
    backlash = parse_effect("backlash(X)", bench_chain)
    errors = MachineErrors.of_errors(bench_chain, [(backlash, np.array([8 * UM]))])
    part = part_program("G0 X0 Y0 Z0\nG1 X10 F100\nG1 Y5\nG1 X0\n", frame, tmp_path, "a.ngc")
    found = compensated(part, errors, head)
    last = [np.flatnonzero(found.motion == k)[-1] for k in (1, 2, 3)]
    added = found.added[last, bench_chain.axis_index("X")]
    # the datum was probed between both sides
    np.testing.assert_allclose(added, [-4 * UM, -4 * UM, 4 * UM], atol=10 * NM)


def test_a_quarter_of_a_circle_ends_with_the_sign_that_it_has_before_its_end(
    bench_chain, frame, tmp_path
):
    """From (0, 0) to (10, 10) about (10, 0): Y stands at the end, and came from below."""
    backlash = parse_effect("backlash(X)", bench_chain)
    errors = MachineErrors.of_errors(bench_chain, [(backlash, np.array([8 * UM]))])
    text = "G0 X0 Y5 Z0\nG1 Y0 F100\nG2 X10 Y10 I10 J0\nG1 X20\n"
    path = ProgramPath(part_program(text, frame, tmp_path, "a.ngc"), errors)
    x, y = (bench_chain.axis_index(axis) for axis in "XY")
    np.testing.assert_array_equal(path.last[2:, [x, y]], [[0.0, -1.0], [1.0, 1.0]])


def test_growth_goes_on_while_the_program_runs(bench_chain, frame, tmp_path, datum):
    effect = parse_effect("thermal-lag(EZZ)", bench_chain)
    state = State(time=600.0)
    errors = MachineErrors.of_errors(bench_chain, [(effect, np.array([50 * UM]))], state)
    text = "G0 X0 Y0 Z0\nG1 X100 F5\nG1 X0\n"  # twenty minutes each
    head = header_of(bench_chain, "0123456789ab", datum, state)
    found = compensated(part_program(text, frame, tmp_path, "a.ngc"), errors, head)
    np.testing.assert_allclose(found.elapsed[-1], 2400.0, rtol=1e-3)
    grown = 50 * UM * (np.exp(-600.0 / effect.tau) - np.exp(-3000.0 / effect.tau))
    z = bench_chain.axis_index("Z")
    np.testing.assert_allclose(found.added[-1, z], -grown, atol=20 * NM)


def test_what_leaves_its_travel_is_refused(known, bench_chain, frame, head, tmp_path):
    far = MachineErrors.of_errors(
        bench_chain, [(parse_effect("geometric(EXX,linear)", bench_chain), np.array([-1.0]))]
    )
    part = part_program("G0 X0 Y0 Z0\nG1 X400 F100\n", frame, tmp_path, "a.ngc")
    with pytest.raises(OutsideTravel, match="line 2: compensated, X leaves its travel"):
        compensated(part, far, head)


def test_a_zero_beyond_a_travel_shifts_the_coordinates_alone(bench, errors_file, tmp_path):
    """X travels from -400: a zero 30 mm beyond has the errors of the end, and 30 mm more in X."""
    found, machine = {}, {}
    for name, zero in {"far": -430.0, "near": -400.0}.items():
        source = tmp_path / f"{name}.part.H"
        datum = {"X": zero, "Z": -200.0}
        machine[name] = compensate(bench, errors_file, tool_length=LENGTH, datum=datum)
        text = "BEGIN PGM PART MM\nTOOL CALL 3 Z\nL X{:+g} Y+0 Z+9 FMAX\nL X{:+g} B-20 F900\nM30\n"
        source.write_text(text.format(100.0 - zero, 180.0 - zero))
        found[name] = machine[name].program(source, tmp_path / f"{name}.H").text
    rows = [coordinates(found[name]) for name in ("far", "near")]
    np.testing.assert_allclose(rows[0] - rows[1], np.tile([30.0, 0, 0, 0, 0], (len(rows[0]), 1)))
    assert found["far"].startswith("0 BEGIN PGM FAR MM")  # the control finds a program by its file
    with pytest.raises(BadArgument, match="X=-430: expected -400 to 400, the travel of X"):
        machine["far"].tables(tmp_path / "tables")


def test_command(bench, errors_file, tmp_path, answer, refusal):
    source, output = tmp_path / "part.ngc", tmp_path / "out" / "better.ngc"
    source.write_text("G0 X0 Y0 Z0\nG1 X50 F1000\nG2 X50 Y0 I20 J0\nM30\n")
    command = ["compensate", str(bench), "--errors", str(errors_file), "--program", str(source)]
    command += ["--tool-length", str(LENGTH), "--datum", "Z=-200", "-o", str(output)]
    said = answer(command)
    assert "better.ngc: 3 motions as" in said
    names = {p.name for p in output.parent.iterdir()}
    assert names == {"better.ngc", "better.csv", "better.png", "better.json"}
    table = np.genfromtxt(output.with_suffix(".csv"), delimiter=",", names=True)
    assert set(table["line"]) == {1, 2, 3}
    before = np.hypot(table["before_dx_um"], table["before_dy_um"])
    assert before.max() > 5.0
    assert max(np.abs(table[f"after_d{c}_um"]).max() for c in "xyz") < 0.02
    assert "already exists" in refusal(command)
    again = [w if w != str(source) else str(output) for w in command[:-1]]
    assert "that was not compensated before" in refusal([*again, str(tmp_path / "twice.ngc")])
