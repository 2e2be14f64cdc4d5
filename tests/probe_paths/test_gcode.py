"""Programs for LinuxCNC: the same steps as for the iTNC, read strictly, taken by rs274."""

import re
from datetime import datetime

import numpy as np
import pytest
import rs274
from programs import as_read, parts_of

from matstd.probe_paths.campaign import VirtualMachine, check_moves, evaluate
from matstd.probe_paths.campaign.virtual_run import run_programs
from matstd.probe_paths.control import Halt, Move, Print, ProbeStep, read_log
from matstd.probe_paths.emit import make_dry_run
from matstd.probe_paths.language import Touch, read_blocks, read_dialect
from matstd.probe_paths.language.gcode import GCODE
from matstd.twin.errors import BadFile
from matstd.twin.units import NM, UM

LAST_DIGIT = 2e-4
NUMBER = re.compile(r"[+-]\d+\.\d+")


def test_programs_are_those_of_the_golden_files(for_linuxcnc, golden):
    assert for_linuxcnc.masks == {}
    assert {p.name for p in golden.LINUXCNC.iterdir()} == {p.file for p in for_linuxcnc.programs}
    for program in for_linuxcnc.programs:
        text = (golden.LINUXCNC / program.file).read_bytes().decode("ascii")
        assert NUMBER.sub("#", text) == NUMBER.sub("#", program.text)
        ours, golden_numbers = (
            np.array([float(v) for v in NUMBER.findall(t)]) for t in (program.text, text)
        )
        assert np.abs(ours - golden_numbers).max() < LAST_DIGIT


def test_steps_are_those_of_the_itnc(twins, read):
    """Moves, touches, logs and stops in the same order, with the same readings."""
    for ours, klartext in zip(twins, read, strict=True):
        assert ours.heading.lines == klartext.heading.lines
        for a, b in zip(ours.steps, klartext.steps, strict=True):
            assert type(a) is type(b)
            assert type(a) in (Move, ProbeStep, Print, Halt)
            if isinstance(a, Move | ProbeStep):
                np.testing.assert_array_equal(a.q, b.q)
                assert a.feed == b.feed
            if isinstance(a, ProbeStep):
                assert [type(s) for s in a.on_miss] == [type(s) for s in b.on_miss]
                assert (a.number, a.pose, a.feature) == (b.number, b.pose, b.feature)
                assert a.slow_feed * 60.0 == 12.0


def test_the_collision_check_is_the_same(twins, small, chain, for_linuxcnc):
    for program in twins:
        check_moves(program, small, chain)
    text = for_linuxcnc.programs[0].text
    lines = text.splitlines()
    place = next(i for i, line in enumerate(lines) if line.startswith("G1 Z"))
    for i in (place, place + 3):  # to the start of the touch, and back to it
        lines[i] = re.sub(r"Z([+-][\d.]+)", lambda m: f"Z{float(m[1]) - 6.0:+.4f}", lines[i])
    dipped = as_read(for_linuxcnc, chain, text="\n".join([*lines, ""]))
    with pytest.raises(BadFile, match=r"line 2\d\d: found a gap of"):
        check_moves(dipped, small, chain)


@pytest.fixture(scope="module")
def parts(twins, small, chain):
    runs = run_programs(twins, small, VirtualMachine(chain), np.random.default_rng(0))
    return parts_of(runs, chain)


def test_logs_evaluate_to_nothing_on_a_perfect_machine(parts, small, chain, plan):
    run = evaluate(parts, small, chain, UM)
    assert len(run) == len(plan)
    assert np.abs(run.deviation).max() < NM
    assert all(part.is_complete and not part.remarks for part in parts)
    assert parts[0].begin == datetime(2000, 1, 1, 8, 0, 0)


def test_a_log_as_linuxcnc_prints_it_is_read(parts, tmp_path):
    text = """MATSTD LOG 1
PGM MS_A_1
STANDARD SMALL-1 SETUP a
ORIGIN X+12.000000 Y-8.000000 Z+5.000000
TURNED A+0.000000 B+0.000000 C+20.053523
PROBE RADIUS +3.000000 LENGTH TO BALL CENTRE +160.000000
STYLUS L+80.000000 R+2.000000 BODY R+25.000000
NOSE R+45.000000 TABLE R+160.000000
DATE20310506.000000
T86390.000000
TOOL30.000000 PRESET1.000000
R3.000000 L163.000000
EX0.000000 EY0.000000 TL163.000000
P1.000000 S1.000000 F3.000000
X-55.123456 Y35.891800 Z197.838900
C-100.000000 B20.000000
UC-1.000000 UB-1.000000
T5.000000
END T6.000000
"""
    (tmp_path / "MS_A_1.TXT").write_text(text)
    (part,) = read_log(tmp_path / "MS_A_1.TXT", ("C", "B"))
    assert part.is_complete
    assert part.begin == datetime(2031, 5, 6, 23, 59, 50)
    assert part.time.tolist() == [15.0]  # over midnight
    assert part.xyz.tolist() == [[-55.123456, 35.8918, 197.8389]]
    assert {a: v.tolist() for a, v in part.side.items()} == {"C": [-1.0], "B": [-1.0]}


def test_two_touches_take_longer_than_one(for_linuxcnc, programs, plan):
    """By hand: 0.3 mm back at 250 mm/min and 0.3 mm at 12 mm/min."""
    longer = 0.3 * 60.0 * (1.0 / 250.0 + 1.0 / 12.0)
    assert abs(for_linuxcnc.duration - programs.duration - len(plan) * longer) < 1e-6


def changed(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("G91\n", "G90\n", r"line \d+: found 'G90', expected G91"),
        ("F#7\n", "F#5\n", r"line \d+: .*F#5', expected .*F#7"),
        ("#1613 = [#5070 - 1]", "#1613 = 0", r"expected #1613 = \[#5070 - 1\]"),
        ("O191 ENDIF\n", "", r"expected O191 ENDIF"),
        ("O191 IF [#1613 LT +0]\nO91 CALL\nO191 ENDIF\n", "", "IF on the status of the touch"),
        ("G53 G0 Z-1.0000\nT30", "G53 G0 Z-100.0000\nT30", r"at least Z-20"),
        ("G61\n", "G64\n", r"'G64', expected"),
        ("M5\n", "", r"M5 before it"),
        ("G61\n", "", r"G61 before it"),
        ("G92.1\n", "", r"G92.1 before it"),
        ("G43 G54\n", "G54\n", r"'G54', expected"),
        ("G43 G54\n", "", r"G43 G54 before it"),
        ("T30 M6\n", "T30 M6 S500\n", "no speed"),
        ("T30 M6\n", "M3\nT30 M6\n", "no spindle start"),
        ("T30 M6\n", "T31 M6\n", r"tool 30, expected 31"),
        (" G94\n", "\n", r"expected"),
        ("O192 IF", "O192 IF [1 EQ 1]\nO192 IF", "expected O<number> SUB"),
        ("[#5403 - +163.0000]", "[#5403 - +165.0000]", r"after a touch without contact"),
        ("#1613 = -1\n", "", r"status of the touch before|expected #1613 = -1"),
        ("[250] [+5.0000]", "[2500] [+5.0000]", r"F2500, expected F1 to F1000"),
        ("[+8.0000] [250]", "[+80.0000] [250]", r"at most 10 mm beyond"),
        ("O90 CALL\n", "", r"IF on the status"),
        ("(LOGAPPEND,MS_A_1.TXT)", "(LOGAPPEND,OTHER.TXT)", r"a log OTHER.TXT, expected MS_A_1"),
        ("(LOGAPPEND,MS_A_1.TXT)", "(LOGOPEN,MS_A_1.TXT)", r"expected \(LOGAPPEND"),
        ("(LOG,X#1610", "(LOG,X#1699", "as they are emitted"),
        ("G0 X", "G0 U", r"axis U, expected"),
        ("M30\n", "", "no M30"),
        ("(END PGM MS_A_1 MM)\n", "", "as the last block"),
        ("G0 B+25.0000", "G38.3 Z-5.0000 F100\nG0 B+25.0000", "probing moves stand in subprogram"),
        ("(BEGIN PGM MS_A_1 MM)", "(BEGIN PGM MS_A_2 MM)", r"MS_A_1"),
    ],
)
def test_what_must_not_run_is_one_line(old, new, reason, for_linuxcnc, chain):
    text = changed(for_linuxcnc.programs[0].text, old, new)
    with pytest.raises(BadFile, match=reason) as refusal:
        as_read(for_linuxcnc, chain, text=text)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.slow)])
def test_every_line_that_is_lost_is_noticed_or_a_remark(for_linuxcnc, chain, step):
    """A touch less, a status less, half a test: no line of the code can go without a word."""

    def is_taken(lines):
        try:
            as_read(for_linuxcnc, chain, 1, "\n".join([*lines, ""]))
        except BadFile:
            return False
        return True

    lines = for_linuxcnc.programs[1].text.splitlines()
    code = [i for i, line in enumerate(lines) if not line.startswith(";")][::step]
    silent = [lines[i] for i in code if is_taken(lines[:i] + lines[i + 1 :])]
    # these the control or the operator does not need, or a move or touch follows all the same; B
    # and C stand at zero where their zero is tested, and the number before is zero too
    for line in silent:
        assert re.match(r"M66 E0 L0$|M0$|G0 |G53 G0 Z|#1614 = #<_abs_[bc]>", line), line
    assert sum(line.startswith("#1614") for line in silent) <= 2


def test_words_have_one_spelling_at_both_ends(golden):
    """Every function of the language, read back by its reader."""
    d = read_dialect("linuxcnc")
    touch = Touch([0.0, 0.6, -0.8], 8.0, 250.0, 5.0)
    blocks = [
        GCODE.begin("ALL"), GCODE.label(90, "WHY"), GCODE.jump_if_less(1613, 0, 91),
        GCODE.label_end, *GCODE.reset(golden.machine(), d), GCODE.tool_call(7), GCODE.preset(3),
        GCODE.wait, GCODE.line({"Z": 1.0}), GCODE.line({"B": -30.0}, 1000),
        GCODE.assign(1601, -2.5),
        *GCODE.probe_vector(d, 1610, touch), GCODE.program_stop, GCODE.end("ALL"),
    ]  # fmt: skip
    found = read_blocks(GCODE.listed(blocks).encode(), "ALL.ngc")
    preset = next(b for b in found if b.kind.name == "PRESET")
    assert preset.word("row") == "+3"
    path = next(b for b in found if b.kind.name == "PROBE_PATH")
    assert (path.number("distance"), path.number("back"), path.number("slow")) == (8.0, 5.0, 12.0)
    assert [b.kind.name for b in found[-4:]] == ["LABEL", "JUMP", "LABEL", "END"]


@rs274.is_there
@pytest.mark.parametrize("number", [0, 1, 2])
def test_the_interpreter_of_linuxcnc_takes_every_block(number, for_linuxcnc, tmp_path):
    """Every touch is taken as met, so that no block is left out; a bad block is not taken."""
    program = for_linuxcnc.programs[number]
    met = rs274.all_met(program.text)
    done = rs274.interpreted(met, tmp_path)
    assert "PROGRAM_END" in done
    assert done.count("STRAIGHT_PROBE") == 2 * program.touches
    # rs274 stops the spindle at M6, too, which may be remapped: M5 comes before the first move
    assert "STOP_SPINDLE_TURNING" in done[: done.index("STRAIGHT_")]
    assert "PROGRAM_END" not in rs274.interpreted(met.replace("\nG0 Z", "\nG0 H", 1), tmp_path)
    at = np.zeros(6)
    for name, words in re.findall(r"(STRAIGHT_\w+)\(([^()]*)\)", done):
        end = np.array([float(v) for v in words.split(",")[:6]])
        moves = ~np.isclose(end, at, atol=2e-4)
        # F is degrees a minute for turns alone, mm a minute for lines alone, and neither for both
        assert name == "STRAIGHT_TRAVERSE" or not (moves[:3].any() and moves[3:].any())
        at = end
    missed = rs274.interpreted(program.text, tmp_path)  # where nothing is simulated nothing is met
    assert "(ABORT,1014)" in missed
    assert "PROGRAM_END" not in missed
    other_probe = re.sub(r"#1614 = .*", "#1614 = +5", program.text)
    assert "(ABORT,1011)" in rs274.interpreted(other_probe, tmp_path)


@rs274.is_there
@pytest.mark.parametrize(
    ("offsets", "tool", "alarm"),
    [
        ({5221: 25.0}, "", 104),
        ({5222: -1.5}, "", 105),
        ({5223: -490.0}, "", 106),
        ({5230: 2.0}, "", 102),
        ({5226: 10.0}, "", 107),
        ({5225: 5.0}, "", 108),
        ({}, "X1.0", 110),
        ({}, "Y-0.2", 110),
        ({5220: 2.0, 5241: 25.0}, "", None),
        ({5210: 1.0, 5211: 30.0}, "", None),
    ],
)
def test_linuxcnc_stops_before_it_goes_down_where_it_is_not_set_up_so(
    for_linuxcnc, tmp_path, offsets, tool, alarm
):
    """Its own interpreter, with what an earlier job left in force; none of G55 and G92 matters."""
    text = rs274.all_met(for_linuxcnc.programs[0].text)
    done = rs274.interpreted(text, tmp_path, offsets, tool)
    if alarm is None:  # the program itself selects G54 and cancels G92
        assert "PROGRAM_END" in done
        return
    assert "PROGRAM_END" not in done
    assert "STRAIGHT_PROBE" not in done
    assert "(ABORT,1011)" in done
    lines = text.splitlines()
    sub = next(i for i, line in enumerate(lines) if line.startswith(f"O{alarm} SUB"))
    lines[sub + 2] = f"(ABORT,{alarm})"  # the subprogram that it went to
    again = rs274.interpreted("\n".join([*lines, ""]), tmp_path, offsets, tool)
    assert f"(ABORT,{alarm})" in again


@rs274.is_there
@pytest.mark.parametrize(
    ("higher", "stops"), [(-6.0, True), (-4.9, False), (4.9, False), (6.0, True)]
)
def test_linuxcnc_does_not_move_where_z_ends_elsewhere(for_linuxcnc, tmp_path, higher, stops):
    """The upper end stands in its INI file; one without it ends the program, too."""
    text = rs274.all_met(for_linuxcnc.programs[0].text)
    done = rs274.interpreted(text, tmp_path, higher=higher)
    assert ("STRAIGHT" not in done) == ("(ABORT,1011)" in done) == stops
    assert ("PROGRAM_END" in done) != stops
    unknown = rs274.interpreted(text.replace("[AXIS_Z]", "[AXIS_W]"), tmp_path)
    assert "not defined" in unknown
    assert "STRAIGHT" not in unknown


@rs274.is_there
def test_linuxcnc_stops_where_a_turn_ended_elsewhere(for_linuxcnc, tmp_path):
    """As a wrapped rotary axis would: C-100 is a turn to 100 degrees."""
    text = rs274.all_met(for_linuxcnc.programs[0].text)
    assert "\nG1 B+20.0000 C-100.0000 F1000" in text
    wrapped = text.replace("\nG1 B+20.0000 C-100.0000 F", "\nG1 B+20.0000 C+100.0000 F", 1)
    done = rs274.interpreted(wrapped, tmp_path)
    assert "STRAIGHT_PROBE" not in done
    assert "(ABORT,1011)" in done


def fed_turns(text, folder):
    """By LinuxCNC: ways of X, Y, Z, turned angle and F of every fed line that turns an axis."""
    at, feed, out = None, 0.0, []
    for name, words in re.findall(r"([A-Z_]+)\((.*)\)", rs274.interpreted(text, folder)):
        if name == "SET_FEED_RATE":
            feed = float(words)
        elif name.startswith("STRAIGHT_"):
            new = np.array([float(v) for v in words.split(",")])
            if name != "STRAIGHT_TRAVERSE" and at is not None and np.any((new - at)[3:]):
                out.append((np.abs(new - at)[:3].max(), np.linalg.norm((new - at)[3:]), feed))
            at = new
    return np.array(out)


@rs274.is_there
def test_fed_turns_move_rotary_axes_alone(for_linuxcnc, plan, tmp_path):
    """F is then degrees a minute, on LinuxCNC as on the iTNC: 1000 of them, whatever the way."""
    found = {p.name: rs274.all_met(p.text) for p in for_linuxcnc.programs}
    dry = make_dry_run(plan, 100.0, read_dialect("linuxcnc"))
    found |= {p.name: rs274.all_met(p.text) for p in dry.programs}
    turns = [fed_turns(text, tmp_path) for text in found.values()]
    assert sum(map(len, turns)) > 10
    for far, turned, feed in np.vstack([t for t in turns if len(t)]):
        assert far == 0.0
        assert feed == 1000.0
        assert turned > 0.0


def test_fed_turns_of_klartext_name_rotary_axes_alone(golden):
    """Blocks with a feed and a rotary axis; the manual counts F in degrees a minute there."""
    blocks = [b for p in golden.programs("itnc530").programs for b in p.text.splitlines()]
    turns = [b for b in blocks if re.search(r" L .*[ABC][+-]\d.* F\d", b)]
    assert len(turns) >= 10
    for block in turns:
        assert not re.search(r"[XYZ][+-]?\d", block)
