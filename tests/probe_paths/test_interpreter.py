"""The interpreter accepts what we emit, and finds every error that is seeded into it."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from programs import as_read

from matstd.artefact.tool import Probe
from matstd.probe_paths.control import (
    Halt,
    Move,
    Print,
    ProbeStep,
    interpret,
    read_program,
    stated_probe,
)
from matstd.twin.errors import BadFile
from matstd.twin.frames import apply, turn
from matstd.twin.machine import linear_directions, tip
from matstd.twin.units import DEG

ROUNDING = 1e-4
"""Four decimals of three coordinates, mm, with room for the fourth of the vector."""

Change = Callable[[list[str]], list[str]]


def renumbered(lines: list[str]) -> bytes:
    """Blocks with consecutive numbers, CRLF; continuation lines have none."""
    out, count = [], 0
    for line in lines:
        if line.startswith("    "):
            out.append(line)
            continue
        out.append(f"{count} {line}")
        count += 1
    return ("\r\n".join(out) + "\r\n").encode("latin-1")


def bare(text: str) -> list[str]:
    """Blocks without their numbers."""
    return [re.sub(r"^\d+ ", "", line) for line in text.splitlines()]


def instead(has: Callable[[str], object], nth: int, made: Callable[[str], list[str]]) -> Change:
    """Other lines in place of the nth that has something."""

    def change(lines: list[str]) -> list[str]:
        at = [i for i, line in enumerate(lines) if has(line)][nth]
        return [*lines[:at], *made(lines[at]), *lines[at + 1 :]]

    return change


def swap(old: str, new: str, nth: int = 0) -> Change:
    """Replace text in the nth line that has it."""
    return instead(lambda line: old in line, nth, lambda line: [line.replace(old, new, 1)])


def drop(old: str, nth: int = 0) -> Change:
    """Delete the nth line that has some text."""
    return instead(lambda line: old in line, nth, lambda _: [])


def insert(new: str, before: str, nth: int = 0) -> Change:
    """A further block before the nth line that has some text."""
    return instead(lambda line: before in line, nth, lambda line: [new, line])


def edit(pattern: str, new: str, nth: int = 0) -> Change:
    """Replace a pattern in the nth line that matches it."""
    wanted = re.compile(pattern)
    return instead(wanted.search, nth, lambda line: [wanted.sub(new, line, count=1)])


def both(first: Change, then: Change) -> Change:
    """Two changes, one after the other."""
    return lambda lines: then(first(lines))


RETRACT = "L Z-1.0000 R0 FMAX M91"
FIRST_DOWN = r"^(L Z[+]\d+\.\d+ R0) F2000"
SEEDED: dict[str, tuple[Change, str]] = {
    # words and numbers
    "misspelt rapid": (swap("FMAX", "FMAXX", 3), "L <axis><signed number>"),
    "decimal comma": (edit(r"(L X[+-]\d+)\.", r"\1,"), "L <axis><signed number>"),
    "letter O in a number": (edit(r"Z\+(\d+)\.(\d)", r"Z+\1.O", 4), "L <axis><signed number>"),
    "double sign": (swap("L X+", "L X++"), "L <axis><signed number>"),
    "no sign": (edit(r"^L X[+-]", "L X"), "L <axis><signed number>"),
    "lost continuation": (swap(" ~", ""), "CYCL DEF 7 with zeros or 247"),
    "comparison of another language": (swap("LT +0", "< 0"), "FN 0, 2, 11, 12, 14, 16, 18 or 20"),
    "words run together": (swap("TOOL CALL", "TOOLCALL"), "block of the closed list"),
    "another cycle": (swap("4.0 MEASURING IN 3D", "3.0 MEASURING"), "the only cycle"),
    "spindle start": (insert("M3", "TCH PROBE 4.0"), "no spindle start"),
    "spindle speed": (swap("TOOL CALL 30 Z", "TOOL CALL 30 Z S500"), "no speed"),
    "tilted plane": (
        insert("PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY", "TCH PROBE 4.0"),
        "PLANE RESET STAY",
    ),
    "unknown axis": (swap("L X+", "L U+"), "an axis of the machine: X, Y, Z"),
    "axis twice": (edit(r"^(L X[+-]\d+\.\d+) Y", r"\1 X"), "every axis once"),
    "byte of another code page": (swap("RESET", "R\xdcCKSETZEN"), "ASCII"),
    # start at a later visit
    "start at none": (swap("Q1640 = +1", "Q1640 = +9"), "a later visit of the program"),
    "no start": (drop("FN 0: Q1640"), "a parameter set by this program"),
    "skip of another parameter": (swap("+Q1640 GT", "+Q1621 GT"), "a label behind the visit"),
    "skip to another visit": (swap("+1 GOTO LBL 111", "+1 GOTO LBL 112"), "nothing goes to"),
    "skip lost": (drop("GOTO LBL 112"), "LBL 112 that nothing goes to"),
    "skip behind the touches": (
        both(drop("LBL 111", 1), insert("LBL 111", "L X+")),
        "a retract .* before it and there",
    ),
    "skip while down": (
        both(drop("GOTO LBL 111"), insert("FN 11: IF +Q1640 GT +1 GOTO LBL 111", "TCH PROBE 4.0")),
        "a retract .* before it and there",
    ),
    "skip past the tests": (
        both(
            drop("GOTO LBL 111"),
            insert("FN 11: IF +Q1640 GT +1 GOTO LBL 111", "* - TEST PROBE"),
        ),
        "a test that stops the program before it",
    ),
    # frame and labels
    "no END PGM": (drop("END PGM"), "END PGM: cut off"),
    "other name at the end": (swap("END PGM MS_A_1", "END PGM MS_A_2"), "MS_A_1 as in BEGIN PGM"),
    "inches": (swap("BEGIN PGM MS_A_1 MM", "BEGIN PGM MS_A_1 INCH"), "found INCH, expected MM"),
    "two programs in a file": (insert("BEGIN PGM X MM", "* - END"), "one frame per file"),
    "undefined label": (swap("CALL LBL 90", "CALL LBL 93", 2), "available: 90, 91, 92"),
    "jump to nowhere": (swap("GOTO LBL 91", "GOTO LBL 19"), "available: 90, 91, 92"),
    "label twice": (swap("LBL 91 ;", "LBL 90 ;"), "every label once"),
    "no M30": (drop("M30"), "M30 at the end"),
    "no LBL 0": (drop("LBL 0"), "a subprogram that is called"),
    "no head": (drop(";STANDARD"), "the program's head"),
    "head mended by hand": (swap(";ORIGIN X+", ";ORIGIN X"), "ORIGIN X.. Y.. Z.."),
    "feature unknown": (drop(";FEATURE 3 IS"), "a number of the head's list"),
    "feature twice": (swap(";FEATURE 2 IS", ";FEATURE 1 IS"), "every feature number once"),
    # modes
    "tool point control left on": (insert("M128 F1000", "TCH PROBE 4.0"), "M129 before it"),
    "tool point control on a retract": (insert("M128", RETRACT, 2), "M129 before M91"),
    "tool point control not reset": (drop("M129"), "M129 before M91"),
    "offset of a head switched on": (insert("M144", "TCH PROBE 4.0"), "block of the closed list"),
    "plane not reset": (drop("PLANE RESET"), "PLANE RESET STAY before it"),
    "a shift left over": (swap("7.2 Y+0", "7.2 Y+5"), "only the preset may shift"),
    "shift of one axis not reset": (drop("CYCL DEF 7.3"), "zeros in X, Y and Z before it"),
    "no tool": (drop("TOOL CALL"), "TOOL CALL before it"),
    "no radius compensation word": (swap(" R0 FMAX M91", " FMAX M91"), "R0 on the first move"),
    "foreign M function": (swap("M91", "M92"), "M91 or M126 and no other"),
    "machine coordinates of a rotary system": (
        swap("REFERENCE SYSTEM:0", "REFERENCE SYSTEM:1"),
        "REFERENCE SYSTEM:0",
    ),
    # motion
    "rotary move near the standard": (drop(RETRACT, 3), "a retract .* before it"),
    "half a retract": (swap("L Z-1.0000", "L Z-101.0000", 3), "at least Z-20"),
    "rotary with linear axes": (edit(r"^L B", "L X+0.0000 B"), "a block of their own"),
    "more than half a turn": (edit(r"C\S+ R0 FMAX M126", "C-359.0 R0 FMAX M126", 1), "at most 180"),
    "rapid down to the standard": (edit(FIRST_DOWN, r"\1 FMAX"), "no rapid move below"),
    "not up before going sideways": (edit(r"^L Z\+\S+ R0 FMAX$", ";", 1), "no rapid move below"),
    "not back before going up": (edit(r"^L X\S+ Y\S+ Z\S+ R0 F2000", ";"), "back to the start"),
    "back to somewhere else": (edit(r"^L X\S+( Y\S+ Z)", r"L X+1.0000\1"), "back to the start"),
    "no move down": (edit(FIRST_DOWN, ";"), "back to the start"),
    "feed forgotten": (edit(r"^(L B\S+ C\S+ R0) F1000", r"\1"), "a feed above zero"),
    "beyond the travel": (edit(r"^L X[+-]\d+", "L X+901"), "the travel of X"),
    "rotary beyond the travel": (edit(r"^L B[+-]\d+", "L B-130"), "the travel of B"),
    "no retract at the end": (drop(RETRACT, -1), "a retract .* before it"),
    # touches
    "vector not of length one": (edit(r"(4\.2 IX)\S+", r"\1+0.9999"), "a vector of length"),
    "vector lost": (drop("TCH PROBE 4.2"), "TCH PROBE 4.2 in its place"),
    "cycle interrupted": (insert("CALL LBL 90", "TCH PROBE 4.1"), "TCH PROBE 4.1 in its place"),
    "probing too fast": (swap("F250", "F2500"), "F1 to F1000"),
    "retract beyond the start": (swap("MB+5.0000", "MB+9.0000"), "MB between 1 mm and the path"),
    "status not looked at": (drop("CALL LBL 90"), "FN 12 on the status"),
    "a move before the status": (insert(RETRACT, "CALL LBL 90"), "FN 12 on the status"),
    "status of another parameter": (swap("Q1613 LT", "Q1612 LT"), "the status"),
    "result elsewhere": (swap("4.1 Q1610", "4.1 Q1620"), "FN 12 on the status"),
    "result in the builder's range": (swap("4.1 Q1610", "4.1 Q1410"), "a free parameter"),
    "status left over": (drop("FN 0: Q1613", 1), "FN 0: Q1613 = -1 before it"),
    "status never set": (drop("FN 0: Q1613"), "FN 0: Q1613 = -1 before it"),
    "length check the wrong way": (swap("LT -1", "LT +1"), "after a touch without contact"),
    "length of another probe": (swap("- +163.0", "- +150.0"), "after a touch without contact"),
    "parameter left over": (drop("FN 0: Q1606"), "a parameter set by this program"),
    "touch number forgotten": (drop("FN 0: Q1620", 1), "touch set anew"),
    "stated side wrong": (edit(r"Q1623 = \+1", "Q1623 = -1"), "as it last moved"),
    "no pre-move": (edit(r"^L B\S+ C\S+ R0 FMAX M126", ";", 0), "as it last moved"),
    "printed ahead": (drop("FN 20", 1), "FN 20: WAIT FOR SYNC before it"),
    "mask missing": (swap("MSPOINT.A", "MSPOINTS.A"), "a mask file beside the program"),
    "no log line": (drop("FN 16: F-PRINT TNC:\\MATSTD\\MSPOINT.A"), "FN 16 with its results"),
    "miss without retract": (drop("M140"), "M140 MB MAX, and no other move"),
    "miss goes on": (drop("FN 14"), "a subprogram that is called"),
    "system datum unknown": (swap("ID350 NR12", "ID350 NR52"), "one of ID350 NR11, ID350 NR12"),
    # what a cautious operator would notice
    "another tool": (swap("TOOL CALL 30 Z", "TOOL CALL 31 Z"), "31, as the program calls it"),
    "another preset": (swap("Q339=+1", "Q339=+2"), "2, as the program calls it"),
    "no word of the tool": (drop(";TOOL 30"), "no comment ';TOOL <number>"),
    "another length in the head": (swap("L+163.0000 R", "L+165.0000 R"), "as PROBE says"),
    "another radius in the head": (swap("R+3.0000,", "R+2.0000,"), "as PROBE says"),
    "feed with a digit too many": (swap("F2000", "F99999"), "F5000 at most"),
    "path of 80 for 8": (swap("SET UP +8.0000", "SET UP +80.0000"), "at most 10 mm beyond"),
    "no retract after the contact": (swap("MB+5.0000", "MB+0.0000"), "MB between 1 mm"),
    "end after eleven touches": (insert("M30", ";TOUCH 12 ON"), "a retract|subprograms after M30"),
    "end after eleven touches at the top": (
        both(insert("M30", ";TOUCH 12 ON"), insert(RETRACT, "M30")),
        "found 11 touches before M30, expected touches 1 to 24",
    ),
    "a touch left out of the head's count": (swap("TO 24,", "TO 25,"), "touches 1 to 25 in order"),
    "log into another folder": (
        edit(r"MSPOINT\.A / TNC:\\MATSTD", r"MSPOINT.A / TNC:\\OTHER"),
        r"expected TNC:\\MATSTD\\MS_A_1.TXT",
    ),
    "log of another name": (swap("MS_A_1.TXT", "MS_A_2.TXT", 1), "MS_A_1.TXT"),
    "masks of another folder": (swap("MATSTD\\MSPOINT", "NEW\\MSPOINT"), "where the log is"),
    "interlock without its difference": (drop("FN 2:"), "length of the tool is off"),
    "interlock that goes on": (drop("FN 14: ERROR= 1011"), "a subprogram that is called"),
    "interlock on another parameter": (
        swap("FN 11: IF +Q1614", "FN 11: IF +Q1602", 1),
        "after a touch without contact",
    ),
    "upper end tested after a motion": (insert(RETRACT, "ID230 NR3"), "upper end of Z is off"),
    "mirror image not tested": (drop("GT +0.5000 GOTO LBL 95"), "cycle 8, 10, 11 or 26 is off"),
    "scaling in Y not tested": (swap("NR4 IDX2", "NR4 IDX1"), "cycle 8, 10, 11 or 26 is off"),
    "spindle not stopped": (drop("M5"), "M5 before it"),
    "loop without end": (insert("CALL LBL 90", "FN 12: IF +Q1613"), "8 at most"),
}  # fmt: skip


ALARMS = {
    92: ("length of the tool", 1.05),
    95: ("cycle 8, 10, 11 or 26", 0.0525),
    101: ("radius of the ball", 0.21),
    102: ("basic rotation", 0.0525),
    103: ("upper end of Z", 5.25),
    104: ("preset in X", 1.05),
    105: ("preset in Y", 1.05),
    106: ("preset in Z", 1.05),
    107: ("zero of C", 0.0525),
    108: ("zero of B", 0.0525),
}
"""What is tested before the probe goes down, and what is off where that is tried."""


@pytest.fixture(scope="session")
def first(programs):
    return programs.programs[0]


@pytest.mark.parametrize("name", SEEDED)
def test_every_seeded_error_is_found(name, first, programs, chain):
    change, expected = SEEDED[name]
    lines = bare(first.text)
    assert renumbered(lines) == first.text.encode("ascii")
    broken = change(lines)
    assert broken != lines, "the seeded error changed nothing"
    with pytest.raises(BadFile, match=expected) as caught:
        as_read(programs, chain, text=renumbered(broken))
    assert re.match(r"MS_A_1\.H: (line \d+|head|file): found .*, expected ", str(caught.value))


@pytest.mark.parametrize("label", ALARMS)
@pytest.mark.parametrize("how", ["less", "greater", "wider", "elsewhere", "turned"])
def test_a_test_of_the_control_that_is_weakened_is_found(label, how, first, programs, chain):
    """One half removed, the limit tenfold, another alarm, another number held against it."""
    what, off = ALARMS[label]
    lines = bare(first.text)
    less, greater = (
        next(
            i
            for i, line in enumerate(lines)
            if line.startswith(f"FN {n}: ") and f"L {label}" in line
        )
        for n in (12, 11)
    )
    expected = f"although {what} is off by [-+]{off}, expected a test .*LBL {label}"
    if how in ("less", "greater"):
        del lines[less if how == "less" else greater]
    elif how == "wider":
        lines[greater] = re.sub(r"GT \S+", "GT +50", lines[greater])
    elif how == "elsewhere":
        other = 92 if label != 92 else 101
        lines[less] = lines[less].replace(f"LBL {label}", f"LBL {other}")
        expected = f"a stop behind LBL {other} where {what} is off, expected LBL {label}"
    else:
        # a number that is right to half its limit today is wrong at the limit
        lines.insert(less, f"FN 2: Q1614 = +Q1614 - {0.5 * off:+.4f}")
    with pytest.raises(BadFile, match=expected):
        as_read(programs, chain, text=renumbered(lines))


def test_a_program_for_the_same_letters_in_another_order_is_refused(first, programs, golden):
    """Its blocks can all run there: the ball would only meet something else."""
    as_read(programs, golden.machine("[w C' B' X' f Z Y (C1) t]"), text=first.text)
    with pytest.raises(BadFile, match=r"MACHINE: .* C-B-X-F-Y-Z .* expected C-X-B-F-Y-Z, those of"):
        as_read(programs, golden.machine("[w C' X' B' f Y Z (C1) t]"), text=first.text)


def test_raw_faults_of_the_file_are_found(first, programs, chain):
    text = first.text.encode("ascii")
    faults = {
        b"": "a program that begins with BEGIN PGM",
        text[: len(text) // 3]: "cut off",
        text.replace(b"\r\n", b"\n", 3): "CRLF",
        text.replace(b"\r\n7 ", b"\r\n8 ", 1): "block number 8, expected 7",
        text.replace(b"\r\n7 ", b"\r\n", 1): "everywhere or nowhere",
        text[: text.index(b"~\r\n") + 3]: "a further line after the tilde",
    }
    for data, expected in faults.items():
        with pytest.raises(BadFile, match=expected):
            interpret(data, Path("MS_A_1.H"), programs.masks.get, chain)


def test_a_file_of_another_name_is_refused(first, programs, chain):
    with pytest.raises(BadFile, match="program name MS_A_1"):
        interpret(first.text.encode("ascii"), Path("COPY.H"), programs.masks.get, chain)


@pytest.mark.parametrize(
    ("mask", "expected"),
    [
        ('"P%8.1LF S%8.1LF",Q1620;', "one format such as"),
        ('"P%8.1LF",Q1620', "quotes and semicolon"),
        ('"P%8.1LF",WEEK;', "a Q parameter or one of DAY"),
        ("", "at least one line"),
        ('"P%8.1lf",Q1620;', "one format such as"),
    ],
)
def test_broken_masks_are_found(mask, expected, first, programs, chain):
    masks = {**programs.masks, "MSPOINT.A": mask}
    with pytest.raises(BadFile, match=expected):
        interpret(first.text.encode("ascii"), Path("MS_A_1.H"), masks.get, chain)


def test_the_probe_in_the_spindle_must_be_the_planned_one(first, programs, chain):
    with pytest.raises(BadFile, match="a probe of radius 3 mm, expected 2 mm"):
        interpret(
            first.text.encode("ascii"), Path("MS_A_1.H"), programs.masks.get, chain, Probe(2.0)
        )


def test_what_a_user_states_of_the_probe_completes_the_head(golden_folder):
    path = golden_folder / "MS_A_1.H"
    assert stated_probe(path, None, None) is None
    assert stated_probe(path, 2.0, None) == Probe(2.0, 160.0)
    assert stated_probe(path, None, 150.0) == Probe(3.0, 150.0)


def test_text_and_plan_mean_the_same_touches(plan, read, chain):
    touches = [touch for program in read for touch in program.touches]
    assert len(touches) == len(plan)
    start = np.array([t.q for t in touches])
    planned = plan.start.copy()
    linear = [chain.axis_index(a) for a in "XYZ"]
    assert np.abs(start - planned)[:, linear].max() < ROUNDING
    rotary = [chain.axis_index(a) for a in "BC"]
    assert np.abs(start - planned)[:, rotary].max() < 1e-12
    direction = np.array([t.direction for t in touches])[:, linear]
    assert np.abs(direction - plan.direction).max() < ROUNDING
    names = [program.features[t.feature] for program in read for t in program.touches]
    assert names == plan.feature.tolist()
    assert [t.number for t in touches] == list(range(1, len(plan) + 1))
    sides = np.array([t.side for t in touches])[:, rotary]
    planned_sides = np.array([plan.visits[v].side for v in plan.visit])
    # chain order is C, B
    assert np.array_equal(sides, planned_sides[:, ::-1])


def test_touches_start_off_the_surface_and_run_against_its_normal(plan, read, chain):
    """By plain kinematics from the readings in the text: start = p + (R + standoff) n."""
    touches = [touch for program in read for touch in program.touches]
    q = np.array([t.q for t in touches])
    T_table_artefact = plan.setup.T_table_artefact
    p, n = apply(T_table_artefact, plan.point), turn(T_table_artefact, plan.normal)
    expected = p + (plan.probe.radius + plan.options.standoff) * n
    assert np.abs(tip(chain, q, plan.probe.length) - expected).max() < ROUNDING
    D = linear_directions(chain, q)
    columns = [chain.axis_index(a) for a in chain.linear_axes]
    motion = np.einsum("nij,nj->ni", D, np.array([t.direction for t in touches])[:, columns])
    assert np.abs(motion + n).max() < ROUNDING


def test_what_happens_without_contact_is_read_too(read):
    for touch in read[0].touches:
        up, line, halt = touch.on_miss
        assert isinstance(up, Move)
        assert up.feed is None
        assert isinstance(line, Print)
        assert line.lines[0].text.startswith("NOCONTACT")
        assert isinstance(halt, Halt)


def test_rotary_axes_turn_only_at_the_top_and_from_the_stated_side(read, chain):
    z = chain.axis_index("Z")
    rotary = [chain.axis_index(a) for a in "BC"]
    for program in read:
        here = None
        for step in program.steps:
            if isinstance(step, ProbeStep):
                here = step.q
            elif isinstance(step, Move):
                if here is not None and np.any(np.abs(step.q - here)[rotary] > 0.0):
                    assert step.q[z] == -1.0
                    assert np.abs(step.q - here)[rotary].max() < 180.0 * DEG
                here = np.where(np.isnan(step.q), 0.0, step.q)


def test_golden_files_are_read_from_disk(golden_folder, chain, read):
    for program in read:
        again = read_program(golden_folder / f"{program.name}.H", chain)
        assert len(again.steps) == len(program.steps)
    with pytest.raises(BadFile, match="no such file"):
        read_program(golden_folder / "NONE.H", chain)


def trimmed(match: re.Match[str]) -> str:
    """A number as a control saves it: no zeros behind, no point without digits."""
    return match[0].rstrip("0").rstrip(".")


def without_blanks(text: str) -> str:
    """`Q1 =+50`, `LT+0`, `MB+5`."""
    return re.sub(r"(Q\d+) = ", r"\1 =", text).replace(" LT ", " LT").replace(" GT ", " GT")


SAVED: dict[str, Callable[[str], str]] = {
    "two blanks, padded numbers": lambda text: re.sub(
        r" ([XYZBC][+-])", r"  \1", re.sub(r"(?m)^(\d+) ", r"\1  ", text)
    ),
    "no blank after the equals sign": without_blanks,
    # in blocks only: what stands behind a semicolon is text
    "zeros left out": lambda text: re.sub(
        r"(?m)^[^;]*$", lambda line: re.sub(r"(?<=[+-])\d+\.\d+", trimmed, line[0]), text
    ),
    "a blank behind MM": lambda text: text.replace(" MM\r", " MM \r"),
    "no last line end": lambda text: text.rstrip(),
    "line feeds alone": lambda text: text.replace("\r\n", "\n"),
    "functions without a blank": lambda text: re.sub(r"FN (\d+):", r"FN\1:", text),
    "no block numbers": lambda text: re.sub(r"(?m)^\d+ ", "", text),
}


@pytest.mark.parametrize("name", SAVED)
def test_what_a_control_saves_is_the_same_program(name, first, programs, chain, read):
    saved = SAVED[name](first.text)
    assert saved != first.text
    again = interpret(saved.encode("ascii"), Path("MS_A_1.H"), programs.masks.get, chain)
    assert len(again.steps) == len(read[0].steps)
    for one, other in zip(again.steps, read[0].steps, strict=True):
        assert type(one) is type(other)
        assert one.line == other.line
        if isinstance(one, Move | ProbeStep):
            assert np.array_equal(one.q, other.q, equal_nan=True)
            assert one.feed == other.feed
    for one, other in zip(again.touches, read[0].touches, strict=True):
        assert np.array_equal(one.direction, other.direction)
        assert (one.distance, one.back, one.number) == (other.distance, other.back, other.number)
