"""Holes, corners, polar coordinates: against LinuxCNC's expansion, and geometry by hand."""

import re
from itertools import pairwise

import numpy as np
import pytest
from bench import DRILL, part_program
from rs274 import interpreted, is_there

from matstd.compensation.programs import compensated
from matstd.twin.errors import BadFile
from matstd.twin.units import DEG, UM

HOLES = """%
O1234 (A PLATE)
N5 G21 G17 G90 G94 G98
N10 T30 M6
N15 T2
G54 G0 X0 Y0 Z30
G43 H30 Z20
G81 X10 Y10 Z-8 R2 F200
X20
G99 Y30 Z-12
X-5 Y-5 R3
G91 G82 X5 Y5 Z-6 R-1 P0.2 L3
G90 G98 G83 X40 Y0 Z-20 R1 Q5
G80
G0 X1 Y1 Z30
G28 G91 Z0
G90 M30
%
"""
START = "BEGIN PGM A MM\nTOOL CALL 3 Z S100\nL X+0 Y+0 Z+9 FMAX\nL Z+0 F500\n"


def drilled(text, folder):
    """X, Y, R, bottom and the height after it of every hole, by LinuxCNC's own interpreter."""
    said = interpreted(re.sub("O1234.*|N15 T2|^T2$", "", text, flags=re.M), folder)
    moves = re.findall(r"(STRAIGHT_TRAVERSE|STRAIGHT_FEED)\((.*)\)", said)
    at = [(name, *(float(v) for v in values.split(",")[:3])) for name, values in moves]
    holes = []
    for before, now in pairwise(at):
        if now[0] == "STRAIGHT_FEED" and before[1:3] == now[1:3]:
            if not holes or holes[-1][:2] != list(now[1:3]):
                holes.append([*now[1:3], before[3], now[3], 0.0])
            holes[-1][3] = min(holes[-1][3], now[3])
        elif holes and before[1:3] == now[1:3] == tuple(holes[-1][:2]):
            holes[-1][4] = now[3]
    return np.array(holes), said


def ours(found):
    """The same of our motions."""
    columns = [found.frame.chain.axis_index(a) for a in "XYZ"]
    motions = found.motions
    called = [k for k, m in enumerate(motions) if m.cycle and m.cycle.block]
    return np.array(
        [
            [*motions[k].end[columns[:2]], *(motions[j].end[columns[2]] for j in (k - 1, k, k + 1))]
            for k in called
        ]
    )


# --- canned cycles of G-code ----------------------------------------------------------------------


@is_there
def test_linuxcnc_drills_the_same_holes(frame, known, head, tmp_path):
    """Places, R, bottoms and heights to which it returns; then those that are written."""
    found = part_program(HOLES, frame, tmp_path, "a.ngc")
    theirs, _ = drilled(HOLES, tmp_path)
    assert len(theirs) == 8
    np.testing.assert_allclose(ours(found), theirs, atol=1e-4)
    done = compensated(found, known, head)
    written, said = drilled(done.text, tmp_path)
    assert "rror" not in said
    chain = frame.chain
    columns = [chain.axis_index(a) for a in "XYZ"]
    k = [i for i, m in enumerate(found.motions) if m.cycle and m.cycle.block]
    rows = [np.flatnonzero(done.motion == i)[0] for i in k]
    at = done.q[rows] + done.added[rows] - frame.datum.q
    np.testing.assert_allclose(written[:, [0, 1, 3]], at[:, columns], atol=6e-5)
    np.testing.assert_allclose(
        written[:, 2] - written[:, 3], theirs[:, 2] - theirs[:, 3], atol=1e-4
    )
    assert "G91 G28 Z0\nG90" in done.text
    assert "G98 G83 X39.98" in done.text
    assert done.text.startswith("%\nO1234 (A PLATE)\n(matstd model: 0123456789ab)\n")
    assert "Q5" in done.text


def test_a_hole_is_where_it_should_be_at_its_bottom(frame, known, head, tmp_path):
    done = compensated(part_program(HOLES, frame, tmp_path, "a.ngc"), known, head)
    motions = done.program.motions
    bottoms = [k for k, m in enumerate(motions) if m.cycle and m.cycle.block]
    off = {
        k: np.linalg.norm(done.after[done.motion == k], axis=1).max() for k in range(len(motions))
    }
    assert np.linalg.norm(done.before, axis=1).max() > 10 * UM
    assert max(off[k] for k in bottoms) < 0.03 * UM
    # above it the same shift holds: what it leaves there is reported
    assert 0.03 * UM < max(off[k - 1] for k in bottoms) < 3 * UM
    assert len(done.leans) == len(bottoms)
    assert max(done.leans) <= max(off[k - 1] + off[k] for k in bottoms)
    assert np.linalg.norm(done.after[done.is_stated], axis=1).max() < 0.03 * UM


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("G81 X1 Y1 Z-3", "line 3: found a canned cycle without R"),
        ("G18 G81 X1 Y1 Z-3 R2", "line 3: found G81 outside G17"),
        ("G81 X1 Y1 Z3 R2", "a bottom at Z3 above R2"),
        ("G81 X1 Y1 Z-3 R2 I5", "found I in a canned cycle"),
        ("G43.4 H3\nG81 X1 Y1 Z-3 R2", "a cycle with tool-point control"),
        ("G28 Z0\nG81 X1 Y1 Z-3 R2", "a cycle from where no axis is known"),
        ("G81 X1 Y1 Z-3 R2 L0", "found 0 holes"),
        ("G93 G1 X5", "a motion without F in inverse time"),
        ("G69 X5", "G69, expected"),
    ],
)
def test_cycles_that_are_refused(frame, tmp_path, lines, said):
    with pytest.raises(BadFile) as refused:
        part_program(f"G0 X0 Y0 Z9\nG1 X1 F9\n{lines}\n", frame, tmp_path, "a.ngc")
    assert said in str(refused.value)


def test_inverse_time_stays_the_time(frame, known, head, tmp_path):
    """A line that becomes several takes as long as it did."""
    text = "G21 G90 G0 X0 Y0 Z0\nG93 G1 X100 B20 C40 F2.5\nG94 G1 X0 F100\n"
    found = part_program(text, frame, tmp_path, "a.ngc")
    done = compensated(found, known, head)
    block = done.text.partition("G93")[2].partition("G94")[0]
    minutes = [1.0 / float(f) for f in re.findall(r"F(\S+)", block)]
    assert len(minutes) > 3
    np.testing.assert_allclose(sum(minutes), 0.4, rtol=1e-6)
    np.testing.assert_allclose(done.elapsed[done.motion == 1][-1], 24.0, rtol=1e-9)


def test_a_tool_changes_where_the_program_says(frame, tmp_path):
    """T before M6 is the next one; H names the length; without any M6 the T word itself counts."""
    text = "T1 M6\nT2\nG0 X0 Y0 Z0\nG43 H7 X1\nM6\nX2\n"
    lengths = {1: 100.0, 2: 120.0, 7: 70.0}
    found = part_program(text, frame, tmp_path, "a.ngc", lengths=lengths)
    assert [m.length for m in found.motions] == [100.0, 70.0, 120.0]
    found = part_program("T2\nG0 X0 Y0 Z0\n", frame, tmp_path, "b.ngc", lengths=lengths)
    assert [m.length for m in found.motions] == [120.0]


def test_tool_point_control_has_three_names(frame, tmp_path):
    """Fanuc's G43.4, and Heidenhain's two."""
    ends = []
    for name, on, off in (
        ("a.ngc", "G43.4 H3", "G49"), ("a.H", "M128", "M129"),
        ("b.H", "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "FUNCTION RESET TCPM"),
    ):  # fmt: skip
        line = "G0 " if name.endswith("ngc") else "L FMAX "
        blocks = ["X+1 Y+2 Z+3", on, "X+10 Y+20 Z-5 B-40 C+30", off, "Z+50"]
        text = "\n".join(b if b in (on, off) else line + b for b in blocks) + "\n"
        ends.append([(m.tcpm, *m.end) for m in part_program(text, frame, tmp_path, name).motions])
    text = "G0 X1 Y2 Z3\nM428\nG0 X10 Y20 Z-5 B-40 C30\nM429\nG0 Z50\n"
    found = part_program(text, frame, tmp_path, "c.ngc", tcp_functions=(428, 429))
    ends.append([(m.tcpm, *m.end) for m in found.motions])
    assert [row[0] for row in ends[0]] == [False, True, False]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
    np.testing.assert_allclose(ends[0], ends[2], atol=1e-9)
    np.testing.assert_allclose(ends[0], ends[3], atol=1e-9)


# --- Klartext -------------------------------------------------------------------------------------


def test_a_tool_below_the_surface_of_a_hole_rises_before_it_moves_over(frame, tmp_path):
    """To Q200 above Q203, both from the Z of the call: -5 - 1.5 + 2 mm."""
    calls = "L Z-6 F500\nCYCL CALL POS X+50 Y+50 Z-5 FMAX\n"
    found = part_program(START + DRILL + calls, frame, tmp_path)
    columns = [frame.chain.axis_index(a) for a in "XYZ"]
    ends = np.array([m.end[columns] for m in found.motions])
    low = np.flatnonzero(ends[:, 2] == -6.0)[0]
    np.testing.assert_allclose(ends[low + 1 : low + 3], [[0.0, 0.0, -4.5], [50.0, 50.0, -4.5]])


def test_holes_of_klartext(frame, known, head, tmp_path):
    """M99, M89, CYCL CALL, CYCL CALL POS: the surface is shifted, the rest of the cycle stays."""
    calls = "L X+20 Y+10 FMAX M99\nL X+30 R0 FMAX M89\nL Y+40 C+30 FMAX\nL X-10 FMAX M99\n"
    calls += "L X-20 Y-20 FMAX\nCYCL CALL M8\nCYCL CALL POS X+50 Y+50 Z-5 FMAX\nL Z+50 FMAX\n"
    found = part_program(START + DRILL + calls, frame, tmp_path)
    z = frame.chain.axis_index("Z")
    at = ours(found)
    expected = [[20, 10], [30, 10], [30, 40], [-10, 40], [-20, -20], [50, 50]]
    np.testing.assert_allclose(at[:, :2], expected)
    np.testing.assert_allclose(at[:5, 2:], np.tile([0.5, -16.5, 18.5], (5, 1)))
    np.testing.assert_allclose(at[5, 2:], [-4.5, -21.5, 13.5])
    assert found.motions[-1].start[z] == 13.5
    done = compensated(found, known, head)
    surfaces = [float(v) for v in re.findall(r"Q203=(\S+)", done.text)]
    k = [i for i, m in enumerate(found.motions) if m.cycle and m.cycle.block]
    rows = [np.flatnonzero(done.motion == i)[0] for i in k]
    bottoms = (done.q[rows] + done.added[rows])[:, z] - frame.datum.q[z]
    np.testing.assert_allclose(np.array(surfaces) - 15.0, bottoms, atol=1e-4)
    assert np.linalg.norm(done.after[rows], axis=1).max() < 0.15 * UM
    assert done.text.count("DEPTH {of the hole}") == done.text.count("M99") == 6
    twice = part_program(f"{START}{DRILL}L X+20 Y+10 FMAX M99\nL X+20 FMAX M99\n", frame, tmp_path)
    text = compensated(twice, known, head).text
    assert text.count("CYCL DEF 200") == 1
    assert text.count("M99") == 2
    assert "M89" not in done.text
    assert re.search(r"L X-19\.\S+ Y-20\.\S+ FMAX M99 M8|L X-20\.\S+ Y-\S+ FMAX M99 M8", done.text)


@pytest.mark.parametrize(
    ("blocks", "said"),
    [
        ("L X+5 FMAX M99", "line 5: found a call of no cycle"),
        ("CYCL DEF 200 D ~\nQ200=2 ~\nQ201=-5", "a cycle without Q203, expected its surface"),
        ("CYCL DEF 200 D ~\nQ200=2 ~\nQ201=5 ~\nQ203=0", "Q201=5, expected a depth below zero"),
        (f"{DRILL}M128\nL X+5 FMAX M99", "a cycle with tool-point control"),
        (f"{DRILL}CYCL CALL PAT FMAX", "expected CYCL CALL, CYCL CALL POS X Y Z, or M99"),
        ("M128\nL M140 MB MAX", "M129 before M91 and M140"),
        ("L X+5 M88", "--pass-m 88 where it moves nothing"),
        ("TOOL CALL 4 Y S100", "a tool along Z"),
        ("RND R2", "RND between no motion right behind it"),
        ("L X+10\nRND R2\nL X+20", "motions that go straight on"),
        ("L X+10\nRND R20\nL Y+20", "motions that are too short for it"),
        ("L X+10\nRND R2\nL X+10\nL Y+20", "motions that are too short for it"),
        ("L X+10\nRND R0\nL Y+20", "RND between motions by nothing"),
        ("L X+10\nCHF 2\nL Y+20 Z-3", "motions that do not stay in X and Y"),
        ("CC X+5 Y+0\nCP IPA+90 DR-", "IPA and DR of one sign"),
        ("LP PR+5 PA+0", "CC with two of X, Y and Z before it"),
    ],
)
def test_klartext_that_is_refused(frame, tmp_path, blocks, said):
    with pytest.raises(BadFile) as refused:
        part_program(f"{START}{blocks}\n", frame, tmp_path)
    assert said in str(refused.value)


def test_after_a_cycle_the_motion_before_it_holds(frame, tmp_path):
    """As on Fanuc; LinuxCNC asks for a word, which is written anyway."""
    text = "G0 X0 Y0 Z5\nG81 X1 Z-3 R2 F100\nG80\nZ15\nG80\n"
    found = part_program(text, frame, tmp_path, "a.ngc")
    assert [m.line for m in found.motions] == [1, 2, 2, 2, 4]
    assert found.motions[-1].is_rapid
    with pytest.raises(BadFile, match="line 6: found axes without G0"):
        part_program(f"{text}X5\n", frame, tmp_path, "a.ngc")


def test_words_of_posts_that_move_nothing(frame, tmp_path):
    """Retraction along the tool, functions of the machine, other ways to write a word."""
    text = (
        'BEGIN PGM A MM\nTOOL CALL "MILL_D10" Z S 3000 F 800\nM88\nL M140 MB MAX\nM3\n'
        "L X+5 Y+6 R0 F MAX\nL Z+5 FMAX\nM120 LA10\nL X+20 F AUTO\nTOOL CALL S4000\n"
        "L M140 MB MAX\nL X+0 FMAX\nEND PGM A MM\n"
    )
    found = part_program(text, frame, tmp_path, lengths={"MILL_D10": 77.0}, passed=[88])
    assert [(m.line, m.feed, m.length) for m in found.motions] == [(7, 0.0, 77.0), (9, 800.0, 77.0)]
    assert [i.line for i in found.items if getattr(i, "moves", False)] == [4, 6, 11, 12]


def test_inches(frame, tmp_path):
    text = "BEGIN PGM A {}\nTOOL CALL 3 Z\nL X{:+g} Y{:+g} Z{:+g} F{:g}\n"
    text += "CC X+0 Y+0\nC X{:+g} Y{:+g} DR+\n"
    numbers = (1.0, 2.0, 0.5, 200.0, -2.0, 1.0)
    scaled = [v * (2.54 if k == 3 else 25.4) for k, v in enumerate(numbers)]
    a = part_program(text.format("INCH", *numbers), frame, tmp_path).motions
    b = part_program(text.format("MM", *scaled), frame, tmp_path, "b.H").motions
    for one, other in zip(a, b, strict=True):
        np.testing.assert_allclose(one.end, other.end, atol=1e-9)
        assert one.feed == pytest.approx(other.feed)


def test_polar_coordinates(frame, tmp_path):
    """Against X and Y worked out by hand: a hexagon's corner, a helix of one turn and a half."""
    text = (
        f"{START}CC X+10 Y+20\nLP PR+30 PA+60\nLP IPA+60 Z-2\nCP IPA-540 IZ-6 DR-\nCP PA+90 DR-\n"
    )
    found = part_program(text, frame, tmp_path).motions[2:]
    columns = [frame.chain.axis_index(a) for a in "XYZ"]
    s = 30.0 * np.sqrt(0.75)
    expected = [[25, 20 + s, 0], [-5, 20 + s, -2], [25, 20 - s, -8], [10, 50, -8]]
    np.testing.assert_allclose([m.end[columns] for m in found], expected, atol=1e-9)
    np.testing.assert_allclose([m.arc.angle for m in found[2:]], [-540 * DEG, -210 * DEG])


@pytest.mark.parametrize("size", [2.0, 4.0])
def test_corners(frame, tmp_path, size):
    """A rounded corner touches both of its sides, a chamfer cuts the same off both."""
    columns = [frame.chain.axis_index(a) for a in "XY"]
    text = f"{START}L X+40\nRND R{size:g}\nL Y+40\nCHF {size:g}\nL X+10\n"
    found = part_program(text, frame, tmp_path).motions[2:]
    ends = np.array([m.end[columns] for m in found])
    np.testing.assert_allclose(ends[0], [40 - size, 0], atol=1e-9)
    np.testing.assert_allclose(found[1].arc.centre, [40 - size, size], atol=1e-9)
    np.testing.assert_allclose(found[1].arc.angle, np.pi / 2)
    np.testing.assert_allclose(ends[2:4], [[40, 40 - size], [40 - size, 40]], atol=1e-9)
    assert [m.arc is None for m in found] == [True, False, True, True, True]


@pytest.mark.parametrize("sense", ["+", "-"])
def test_a_corner_between_a_line_and_an_arc(frame, tmp_path, sense):
    """The arc between lies inside: a radius off the line, and from the circle off its centre."""
    columns = [frame.chain.axis_index(a) for a in "XY"]
    y, own = 10.0 if sense == "+" else -10.0, np.sqrt(200.0)
    far = y + np.copysign(own, y)
    text = f"{START}L X+40\nRND R2\nCC X+30 Y{y:+g}\nC X+30 Y{far:+.9f} DR{sense}\n"
    line, between, arc = part_program(text, frame, tmp_path).motions[2:]
    centre = between.arc.centre
    assert centre[1] == pytest.approx(np.copysign(2.0, y))
    assert np.hypot(*(centre - [30.0, y])) == pytest.approx(own - 2.0)
    assert line.end[columns[0]] == pytest.approx(centre[0])
    assert np.hypot(*(arc.start[columns] - [30.0, y])) == pytest.approx(own)
    assert np.hypot(*(arc.start[columns] - centre)) == pytest.approx(2.0)
    assert np.sign(arc.arc.angle) == np.sign(between.arc.angle) == (1 if sense == "+" else -1)
    assert abs(arc.arc.angle) < 0.75 * np.pi


def test_a_corner_beside_the_tool(frame, tmp_path):
    """Rounded first, then the path of the tool's centre: an inner corner keeps R less the tool."""
    text = f"{START}L X+10 Y+10 RL\nL X+60\nRND R8\nL Y+60\nL X+80 R0\n"
    arcs = [m for m in part_program(text, frame, tmp_path, radii={3: 5.0}).motions if m.arc]
    k = [frame.chain.axis_index(a) for a in "XY"]
    assert len(arcs) == 1
    np.testing.assert_allclose(arcs[0].arc.centre, [52.0, 18.0])
    assert np.hypot(*(arcs[0].start[k] - [52.0, 18.0])) == pytest.approx(3.0)


def test_another_kind_of_cycle_keeps_levels_and_forgets_the_dwell(frame, tmp_path):
    lines = "G21 G17 G90 G94 G98\nG0 X0 Y0 Z20\nG82 X10 Y10 Z-8 R2 P0.5 F200\nG83 X20 Q3\nG80\nM2\n"
    found = part_program(lines, frame, tmp_path, "a.ngc")
    np.testing.assert_allclose(ours(found), [[10.0, 10.0, 2.0, -8.0, 20.0], [20, 10, 2, -8, 20]])
    blocks = [m.cycle.block for m in found.motions if m.cycle and m.cycle.block]
    assert ["P0.5" in block for block in blocks] == [True, False]
    assert ["Q3" in block for block in blocks] == [False, True]


def test_a_call_with_a_height_goes_there_first(frame, tmp_path):
    found = part_program(f"{START}{DRILL}L X+20 Y+10 Z+6 FMAX M99\n", frame, tmp_path)
    columns = [frame.chain.axis_index(a) for a in "XYZ"]
    assert [20.0, 10.0, 6.0] in [m.end[columns].tolist() for m in found.motions]
    assert len(ours(found)) == 1
