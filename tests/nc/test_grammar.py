"""Blocks, values, order and modes of control programs: cases worked by hand."""

import math
from pathlib import Path

import pytest

from matstd.nc.grammar import (
    MAX_DEPTH,
    MODAL,
    NUMBER,
    Flow,
    Modal,
    gcode_lines,
    klartext_blocks,
    label_places,
    run_order,
    split_words,
)
from matstd.nc.grammar.formulas import Formula, function_value
from matstd.probe_paths.language.gcode import MODES
from matstd.twin.errors import BadFile

PATH = Path("A.H")


def order(text):
    return [
        " ".join(b.text.split()) for b in run_order(list(klartext_blocks(text.splitlines())), PATH)
    ]


def test_klartext_blocks_have_numbers_comments_and_further_lines():
    text = '0 BEGIN PGM A MM\n7  CYCL DEF 247 ~\n    Q339=+1 ;ROW\nLBL "hole" ;x\n12\nl x+1 ~'
    first, cycle, label, bare_number, last = klartext_blocks(text.splitlines())
    assert first == (1, "0", "BEGIN PGM A MM")
    assert (cycle.line, cycle.number, " ".join(cycle.text.split())) == (
        2,
        "7",
        "CYCL DEF 247 ~ Q339=+1 ;ROW",
    )
    assert (label.line, label.number, label.bare) == (4, "", 'LBL "hole"')
    assert (bare_number.number, bare_number.text) == ("", "12")  # a number needs a block
    assert (last.text, last.bare) == ("l x+1 ~", "L X+1 ~")


def test_gcode_lines_have_code_and_remarks():
    lines = list(gcode_lines(["g1 x1 (to (here) f5 ; end", "", "; all", "G0"]))
    assert lines[0] == (1, "g1 x1 (to (here) f5 ; end", "G1 X1  F5", "(to (here); end")
    assert [line.code for line in lines[1:]] == ["", "", "G0"]
    assert split_words(lines[0].code) == [("G", 1.0), ("X", 1.0), ("F", 5.0)]
    with pytest.raises(ValueError, match=r"\?"):
        split_words("G1 X1 ?")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 + 3 * 4 ^ 2", 50.0),
        ("- 2 ^ 2", 4.0),  # a sign goes before a power
        ("(1 + 2) / -.5", -6.0),
        ("SIN 30 + COS (2 * 30)", 1.0),
        ("SQ SQRT 7 - LN EXP 3", 4.0),
        ("INT -2.7 - FRAC 1.25 + ABS NEG 3", 0.75),
        ("ASIN 1 + ATAN 1 + PI", 135.0 + math.pi),
    ],
)
def test_formulas(text, value):
    assert Formula(text, float).value() == pytest.approx(value)


@pytest.mark.parametrize(
    ("number", "text", "value"),
    [
        ("0", "+5", 5.0), ("1", "+1 + -3", -2.0), ("2", "1 - +3", -2.0), ("3", "+2 * +3", 6.0),
        ("4", "+1 DIV +4", 0.25), ("5", "SQRT +9", 3.0), ("6", "SIN +90", 1.0),
        ("7", "COS +180", -1.0), ("8", "+3 LEN +4", 5.0), ("13", "-1 ANG +0", 270.0),
        ("9", "+1", None), ("1", "+1 - +3", None),
    ],
)  # fmt: skip
def test_functions(number, text, value):
    found = function_value(number, text, NUMBER, float)
    assert found is None if value is None else found == pytest.approx(value)


def test_a_formula_names_the_parameter_that_has_no_value():
    with pytest.raises(BadFile, match="line 1: found Q7 without a value"):
        order("Q1 = 2 * Q7\nL X+Q1\n")


def test_blocks_run_in_their_order():
    text = (
        "Q1 = 2\nLBL 1\nL X+Q1\nFN 1: Q1 = +Q1 + +1\nCALL LBL 1 REP 2\nL Y-Q1 FQ1 ;Q1\nM30\nL Z+1\n"
    )
    assert order(text) == ["L X+2", "L X+3", "L X+4", "L Y-5 F5 ;Q1", "M30"]
    assert order("l x+1\n;Q\n") == ["l x+1", ";Q"]  # as it is


def test_subprograms_and_labels():
    places = label_places([(3, 4, "1"), (5, 6, "0"), (7, 8, "0")], PATH)
    assert places == {"1": 3}
    flow = Flow(PATH, places, most=3)
    assert [flow.call(0, 1, "1"), flow.end(), flow.end()] == [4, 1, None]
    assert [flow.repeat(9, 1, "1", 2) for _ in range(4)] == [4, 4, 10, 4]
    for _ in range(MAX_DEPTH):
        flow.call(0, 1, "1")
    with pytest.raises(BadFile, match="line 7: found subprograms 9 deep, expected 8 at most"):
        flow.call(0, 7, "1")
    with pytest.raises(BadFile, match="found LBL 2, expected a label that is defined"):
        flow.behind(7, "2")
    with pytest.raises(BadFile, match="found LBL 1 again, expected every label once"):
        label_places([(3, 4, "1"), (5, 6, "1")], PATH)
    for _ in range(3):
        flow.count(1)
    with pytest.raises(BadFile, match="line 2: found a loop without end"):
        flow.count(2)


def test_the_reset_of_our_programs_leaves_no_mode_in_force():
    """The line that every program begins with, taken by the reader of other programs."""
    modal = Modal()
    for g in (1.0, 18.0, 20.0, 41.0, 81.0, 91.0, 93.0):
        modal.take(g)
    modal.before_cycle = None
    for letter, g in split_words(MODES):
        assert letter == "G"
        if g in MODAL:
            modal.take(g)
    assert modal == Modal()


def test_after_a_canned_cycle_the_motion_before_it_holds():
    modal = Modal()
    for g, motion in ((1.0, 1.0), (81.0, 81.0), (83.0, 83.0), (80.0, 1.0), (80.0, None)):
        modal.take(g)
        assert modal.motion == motion
    modal.take(2.0)
    assert modal.is_arc
    modal.take(81.0)
    assert modal.is_cycle
    modal.take(80.0)
    assert modal.motion is None
