"""Labels, parameters and cutter radius: against LinuxCNC, distances, and values worked by hand."""

import re
from itertools import pairwise

import numpy as np
import pytest
from bench import part_program
from rs274 import is_there, moves

from matstd.compensation.part_programs import Motion, Paths
from matstd.compensation.programs import compensated
from matstd.twin.errors import BadFile

R = 5.0
START = "BEGIN PGM A MM\nTOOL CALL 3 Z S100\nL X+0 Y+0 Z+9 FMAX\nL Z+0 F500\n"


def program(*given):
    """With a tool of 10 mm."""
    return part_program(*given, radii={3: R})


def ends(found):
    """X and Y at the end of every motion behind the first two."""
    k = [found.frame.chain.axis_index(a) for a in "XY"]
    return [tuple(np.round(m.end[k], 9) + 0.0) for m in found.motions[2:]]


# --- labels and parameters -----------------------------------------------------------------------


def test_subprograms_and_repetitions_run_in_their_order(frame, tmp_path):
    text = START + (
        'CALL LBL 1\nLBL 2\nL IX+1\nCALL LBL 2 REP 2/2\nCALL LBL "hole"\nL Z+50 M30\n'
        'LBL 1\nL X+10 Y+10\nCALL LBL "hole"\nLBL 0\nLBL "hole"\nL IY+5\nLBL 0\nEND PGM A MM\n'
    )
    found = program(text, frame, tmp_path)
    assert ends(found) == [
        (10, 10), (10, 15), (11, 15), (12, 15), (13, 15), (13, 20), (13, 20),
    ]  # fmt: skip
    assert found.motions[3].line == found.motions[7].line == 16
    texts = [i.text for i in found.items if not isinstance(i, Motion)]
    assert texts[-1] == "END PGM A MM"
    assert not any("LBL" in t for t in texts)


def test_a_loop_with_a_jump(frame, tmp_path):
    """Points on a circle by Q parameters; the control's own manual writes them so."""
    text = START + (
        "FN 0: Q1 = +0\nQ2 = 360 / 8\nLBL 5\nL X+Q10 Y+Q11 FQ4\n".replace("Q10", "Q3")
        .replace("LBL 5\n", "LBL 5\nQ3 = 20 * COS Q1\nFN 6: Q5 = SIN +Q1\nFN 3: Q11 = +Q5 * +20\n")
        .replace("FQ4", "F300")
        + "FN 1: Q1 = +Q1 + +Q2\nFN 12: IF +Q1 LT +360 GOTO LBL 5\nEND PGM A MM\n"
    )
    angle = np.radians(45.0 * np.arange(8))
    found = np.array(ends(program(text, frame, tmp_path)))
    np.testing.assert_allclose(
        found, 20.0 * np.column_stack([np.cos(angle), np.sin(angle)]), atol=1e-8
    )


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("Q9 = 5 * 3 + 2 * 10", 35.0),  # the manual's own two
        ("Q9 = SQ 10 - 3^3", 73.0),
        ("Q9 = -(2 + 3) * SIN 30", -2.5),
        ("Q9 = ATAN (1 / 1) + NEG 5", 40.0),
        ("Q9 = INT -2.7 + FRAC 2.5 + ABS -1 + SQRT 16", 3.5),
        ("FN 4: Q9 = +7 DIV +2", 3.5),
        ("FN 5: Q9 = SQRT +16", 4.0),
        ("FN 8: Q9 = +3 LEN +4", 5.0),
        ("FN 13: Q9 = +1 ANG -1", 135.0),
        ("FN 2: Q9 = -5 - -7", 2.0),
    ],
)
def test_formulas(frame, tmp_path, formula, value):
    found = program(f"{START}{formula}\nL X+Q9 Y-Q9\nEND PGM A MM\n", frame, tmp_path)
    assert ends(found) == [(value, -value)]


@pytest.mark.parametrize(
    ("blocks", "said"),
    [
        ("LBL 1\nLBL 1", "line 6: found LBL 1 again, expected every label once; it is in line 5"),
        ("LBL 1\nCALL LBL 1", "LBL 1 without an end, expected LBL 0 behind it"),
        ("LBL 1\nCALL LBL 1\nLBL 0", "line 6: found subprograms 9 deep, expected 8 at most"),
        ("LBL 1\nFN 9: IF +1 EQU +1 GOTO LBL 1", "blocks, expected a program that ends"),
        ("FN 9: IF +1 LT +1 GOTO LBL 1", "expected EQU with FN 9"),
        ("L X+Q7", "line 5: found Q7 without a value"),
        ("Q1 = 4 / 0", "expected a value that exists"),
        ("Q1 = 4 +", "found 'the end', expected numbers, parameters"),
        ("Q1 = ROOT 4", "found 'ROOT', expected numbers, parameters"),
        ("Q1 = 4 % 3", "found '% 3', expected"),
        ("QS1 = 4", "parameters Q that the program sets itself"),
        ("FN 5: Q1 = SQRT -4", "expected a value that exists"),
    ],
)
def test_what_does_not_run_is_named_with_its_line(frame, tmp_path, blocks, said, monkeypatch):
    monkeypatch.setattr("matstd.nc.grammar.order.MAX_BLOCKS", 1000)
    with pytest.raises(BadFile) as refused:
        program(f"{START}{blocks}\nEND PGM A MM\n", frame, tmp_path)
    assert said in str(refused.value)


def test_numbers_of_cycles_are_no_parameters(frame, tmp_path):
    text = START + "CYCL DEF 247 PRESET ~\nQ339=+1\nL X+5\nM30\nL X+6\nEND PGM A MM\n"
    assert ends(program(text, frame, tmp_path)) == [(5, 0), (6, 0)]


# --- cutter radius -------------------------------------------------------------------------------

CONTOUR = [
    "L X+40 Y+10",
    "L X+60 Y+10",  # outer corner for a tool on the right
    "L X+60 Y+40",
    "L X+80 Y+40",  # an inner one
    "CC X+80 Y+60",
    "C X+100 Y+60 DR+",
    "L X+100 Y+80",
    "CR X+70 Y+80 R+16 DR+",  # tangent nowhere
    "L X+20 Y+75",
    "L X+20 Y+10",
    "L X+40 Y+10",
]
G_CONTOUR = [
    "X40 Y10", "G1 X60 Y10", "X60 Y40", "X80 Y40", "G3 X100 Y60 I0 J20", "G1 X100 Y80",
    "G3 X70 Y80 R16", "G1 X20 Y75", "X20 Y10", "X40 Y10",
]  # fmt: skip


def along(motions, chain, count=400):
    """Points on motions, X and Y."""
    k = [chain.axis_index(a) for a in "XY"]
    which = np.repeat(np.arange(len(motions)), count)
    share = np.tile(np.linspace(0.0, 1.0, count), len(motions))
    return Paths(motions, [chain.axis_index(a) for a in "XYZ"]).at(which, share)[:, k]


def klartext(side, contour=CONTOUR):
    first, *rest = contour
    return START + "\n".join([f"{first} {side} F500", *rest, "L X+0 Y+0 R0", "END PGM A MM", ""])


@pytest.mark.parametrize("side", ["RL", "RR"])
def test_the_centre_is_a_radius_away_from_the_contour(frame, tmp_path, side):
    chain = frame.chain
    plain = program(klartext("R0"), frame, tmp_path).motions[3:-1]
    found = program(klartext(side), frame, tmp_path).motions
    contour, centre = along(plain, chain, 1500), along(found[3:-1], chain, 150)
    away = np.array([np.linalg.norm(contour - p, axis=1).min() for p in centre])
    np.testing.assert_allclose(away, R, atol=2e-3)  # the contour's points are 0.07 mm apart
    for a, b in pairwise(found):
        np.testing.assert_allclose(a.end, b.start, atol=1e-9)
    # square to the first point, and to the last one
    k = [chain.axis_index(a) for a in "XY"]
    left = 1.0 if side == "RL" else -1.0
    np.testing.assert_allclose(found[2].end[k], [40.0, 10.0 + left * R], atol=1e-9)
    np.testing.assert_allclose(found[-1].start[k], [40.0, 10.0 + left * R], atol=1e-9)


@pytest.mark.parametrize(
    ("word", "outer", "inner"), [("M109", 1, 1), ("M110", 0, 1), ("M111", 0, 0)]
)
def test_the_edge_keeps_its_feed_on_arcs_with_m109(
    known, frame, head, tmp_path, word, outer, inner
):
    """A quarter of R 20 outside and of R 30 inside: the edge goes (R +- r) / R times as fast."""
    text = START + (
        f"L X+0 Y+0 RL F600 {word}\nL X+0 Y+40\nCC X+20 Y+40\nC X+20 Y+60 DR-\nL X+40\n"
        "CC X+40 Y+90\nC X+70 Y+90 DR+\nL Y+110\nM111\nCC X+90 Y+110\nC X+90 Y+130 DR-\n"
        "L X+110\nL X+150 Y+150 R0\nEND PGM A MM\n"
    )
    found = program(text, frame, tmp_path)
    outside, inside, later = (m for m in found.motions if m.arc is not None)
    paths = Paths([outside, inside], frame.linear)
    at_edge = np.array([20.0, 30.0]) * 0.5 * np.pi / paths.far * [outside.feed, inside.feed]
    around = np.array([20.0 / (20.0 + R), 30.0 / (30.0 - R)])
    np.testing.assert_allclose(at_edge, 600.0 * np.where([outer, inner], 1.0, around), rtol=1e-9)
    straight = [m.word for m in found.motions[2:] if m.arc is None]
    assert [*straight, later.word] == [600.0] * (len(straight) + 1)
    text = compensated(found, known, head).text
    feeds = {float(feed) for feed in re.findall(r"^\d+ L .* F(\d[\d.]*)", text, re.M)}
    assert feeds == {500.0, 600.0, float(f"{outside.word:.6g}"), float(f"{inside.word:.6g}")}


def test_height_and_words_stay_with_their_motion(frame, tmp_path):
    text = START + "L X+10 Y+10 RR F500 M8\nL X+50 Z-3\nL Y+40 Z-6\nL X+60 Y+50 Z+9 R0 M9\n"
    found = program(text, frame, tmp_path)
    z = frame.chain.axis_index("Z")
    assert [m.end[z] for m in found.motions[2:]] == [0.0, -3.0, -3.0, -6.0, 9.0]
    assert found.motions[4].arc is not None
    assert [m.words for m in found.motions[2:]] == ["R0 M8", "", "", "", "R0 M9"]


def canonical(text, folder):
    """Ends of the motions of LinuxCNC's own interpreter, the tool 10 mm thick."""
    tool = f"T3 P3 Z6.0 D{2 * R / 25.4:.9f}"  # inches to it
    return [[name[0], *numbers[:2]] for name, numbers in moves(text, folder, tool)]


@is_there
@pytest.mark.parametrize("word", ["G41", "G42"])
@pytest.mark.parametrize("approach", ["X-10 Y10", "X20 Y-15", "X10 Y30"])
def test_linuxcnc_goes_beside_the_same_contour(frame, tmp_path, word, approach):
    """All lines and arcs, from approaches that make an inner and an outer corner, or none."""
    first, *rest = G_CONTOUR
    text = "\n".join(
        ["G21 G17 G90", "T3 M6", "G0 X0 Y0 Z9", f"G1 {approach} Z0 F500", f"{word} {first}", *rest,
         "G40 X0 Y0", "M2", ""]
    )  # fmt: skip
    theirs = canonical(text.replace(f"{word} ", f"{word} D3 "), tmp_path)[1:]
    found = program(text, frame, tmp_path, "a.ngc").motions[1:]
    k = [frame.chain.axis_index(a) for a in "XY"]
    ours = [["S" if m.arc is None else "A", *m.end[k]] for m in found]
    assert [o[0] for o in ours] == [t[0] for t in theirs]
    np.testing.assert_allclose([o[1:] for o in ours], [t[1:] for t in theirs], atol=1e-3)


@pytest.mark.parametrize(
    ("blocks", "said"),
    [
        ("L X+9 Y+9 RL\nL Z-5", "line 6: found no way in X and Y beside a contour"),
        ("L X+9 Y+9 RR\nL X+9 Y+19\nL X+12\nL Y+9", "narrower than the tool, R 5"),
        ("L X+9 Y+9 RL\nCR X+15 Y+9 R+3.1 DR+", "narrower than the tool, R 5"),
        ("L X+9 Y+9 RL\nL X+50\nL X+20", "narrower than the tool, R 5"),
        ("L X+9 Y+9 RL\nL X+50\nL X+50 Y+50 RR", "expected R0 or G40 between"),
        ("L X+9 Y+9 RL\nTOOL CALL 4 Z", "R0 before a TOOL CALL"),
        ("L X+9 Y+9 RL\nL X+50 B-5", "rotary axes beside a contour"),
        ("CC X+5 Y+0\nC X+10 Y+0 DR+ RL", "an arc as the first motion to a contour"),
        ("L X+9 Y+9 RL\nL X+50\nCC X+50 Y+20\nC X+50 Y+31 DR+ R0", "expected a straight line"),
        ("L X+9 Y+9 RL\nL Z+50 R0 M91", "expected it before the contour"),
        ("L X+9 Y+9 RL", "a contour of one point"),
        ("TOOL CALL 3 Z DR-6\nL X+9 Y+9 RL", "a tool of radius -1 mm"),
    ],
)
def test_contours_that_cannot_be_cut(frame, tmp_path, blocks, said):
    with pytest.raises(BadFile) as refused:
        program(f"{START}{blocks}\n", frame, tmp_path)
    assert said in str(refused.value)
