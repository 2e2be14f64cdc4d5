import numpy as np
import pytest

from matstd.artefact.tool import Probe
from matstd.probe_paths.language import Datum, Dialect, Kind, Touch, head_mask, read_blocks
from matstd.probe_paths.language.dialect import CYCLE_NAMES, DISTANCE_WORDS
from matstd.probe_paths.language.klartext import DATUM_SHIFT_OFF, KLARTEXT, PLANE_OFF, plane
from matstd.probe_paths.language.text import signed
from matstd.probe_paths.plan import Heading, parse_heading
from matstd.probe_paths.plan.heading import rounded_setup
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import pose, rotation
from matstd.twin.record import Setup

k = KLARTEXT
ROUNDING = 1e-6
"""Six decimals of millimetres and degrees in a heading."""


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "+1.0000"), (-0.00001, "+0.0000"), (-12.34567, "-12.3457"), (0.0, "+0.0000")],
)
def test_numbers_carry_sign_and_four_decimals(value, text):
    assert signed(value) == text


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e5, -123456.0])
def test_numbers_beyond_the_control_are_refused(value):
    with pytest.raises(DesignError, match="beyond the control's range"):
        signed(value)


@pytest.mark.parametrize("name", ["ms_1", "1MS", "M-1", "A" * 17, ""])
def test_program_names_that_old_software_cannot_show_are_refused(name):
    with pytest.raises(DesignError, match="at most 16 characters"):
        k.begin(name)


@pytest.mark.parametrize("block", ["M3", "M03", "L Z+1.0000 R0 FMAX M13", "TOOL CALL 5 Z S1000"])
def test_a_spindle_start_is_never_listed(block):
    with pytest.raises(DesignError, match="would start the spindle"):
        k.listed([block])


@pytest.mark.parametrize(
    "block", ["M30", "M126", "L Z-1.0000 R0 FMAX M91", "TOOL CALL 3 Z", "M140 MB MAX"]
)
def test_other_m_functions_are_no_spindle_start(block):
    assert k.listed([block]) == f"0 {block}\r\n"


def test_long_and_foreign_lines_are_refused():
    with pytest.raises(DesignError, match="at most 72"):
        k.listed([k.comment("X" * 80)])
    with pytest.raises(DesignError, match="outside ASCII"):
        k.listed([k.comment("20 \N{DEGREE SIGN}")])
    with pytest.raises(DesignError, match="ends in ~"):
        k.comment("to be continued ~")


def test_every_block_of_the_vocabulary_is_one_that_the_parser_knows():
    text = k.listed([
        k.begin("ALL"), k.comment("TEXT"), k.structure("HEAD"), *k.stock([0, 0, 0], [1, 2, 3]),
        "M129", PLANE_OFF, *DATUM_SHIFT_OFF, k.tool_call(7), k.preset(3), k.wait,
        plane([0.0, -30.0, 5.0], -30.0),
        k.retract(-1.0), k.turn({"B": -30.0, "C": 5.0}), k.line({"B": -30.0}, 1000),
        *KLARTEXT.orientation, "M115", "M145", "M126", "M127", k.assign(1601, 2),
        k.assign(1601, -2.5),
        k.read(1601, Datum.OFFSET_X), k.read(1601, Datum.RADIUS), k.call(90),
        *k.probe_vector(Dialect(), 1610, Touch([0.0, 0.6, -0.8], 8.0, 250.0, 5.0)),
        k.printed("TNC:\\A\\M.A", [], "TNC:\\A\\L.TXT"), k.program_stop, k.label(90, "WHY"),
        k.jump_if_less(1613, 0, 91), k.jump_if_greater(1607, 2, 91),
        k.difference(1607, 114, 163.5), k.minus(1607, 1608), "M5",
            k.label_end, k.label(91), k.retract_max(0.0), k.operator_stop,
        k.stop_with_error(1014), k.end("ALL"),
    ])  # fmt: skip
    blocks = read_blocks(text.encode("ascii"), "ALL.H")
    assert {b.kind for b in blocks} == set(Kind) - {Kind.TCPM_ON}


@pytest.mark.parametrize("word", DISTANCE_WORDS)
@pytest.mark.parametrize("name", CYCLE_NAMES)
def test_every_dialect_of_cycle_4_is_read_back(word, name):
    dialect = Dialect(cycle_name=name, distance_word=word)
    blocks = k.probe_vector(dialect, 1610, Touch([0.0, 0.0, -1.0], 8.0, 250.0, 5.0))
    path = read_blocks(k.listed(blocks).encode("ascii"), "A.H")[3]
    assert (path.number("distance"), path.number("feed"), path.number("back")) == (8.0, 250.0, 5.0)


def test_words_of_a_dialect_are_known_to_its_reader_alone():
    own = Dialect(cycle_name="MESSEN IN 3D", distance_word="WEG")
    blocks = k.probe_vector(own, 1610, Touch([0.0, 0.0, -1.0], 8.0, 250.0, 5.0))
    text = k.listed(blocks).encode("ascii")
    assert read_blocks(text, "A.H", own)[3].number("distance") == 8.0
    with pytest.raises(BadFile, match=r"line 1.*MEASURING IN 3D"):
        read_blocks(text, "A.H")
    assert Dialect(folder="TNC:\\P").on_control("A.H") == "TNC:\\P\\A.H"


def test_a_heading_survives_its_lines():
    T_table_artefact = pose(rotation(np.array([0.1, -0.2, 3.0])), np.array([1.23456789, -2.0, 3.0]))
    setup = rounded_setup(Setup("b", T_table_artefact))
    head = Heading("FFS-600U", setup, Probe(2.998765, 160.25))
    back, _ = parse_heading(list(enumerate(head.lines, start=5)), "A.H")
    assert (back.standard, back.setup.name) == ("FFS-600U", "b")
    np.testing.assert_allclose(back.setup.T_table_artefact, setup.T_table_artefact, atol=1e-12)
    assert abs(back.probe.radius - head.probe.radius) < ROUNDING
    assert np.abs(setup.T_table_artefact - T_table_artefact).max() < ROUNDING


def test_a_name_with_blanks_cannot_stand_in_a_heading():
    with pytest.raises(DesignError, match="1 to 24 letters"):
        _ = Heading("my standard", Setup("a"), Probe(3.0, 160.0)).lines


@pytest.mark.parametrize("name", ["1_STARTS_WITH_A_DIGIT", "WITH BLANK", "A" * 40, ""])
def test_a_name_that_no_software_takes_is_refused_in_program_and_mask(name) -> None:
    for made in (KLARTEXT.begin, KLARTEXT.end, lambda name: head_mask(KLARTEXT.log, name, ())):
        with pytest.raises(DesignError, match=r"program name .* expected a letter"):
            made(name)
