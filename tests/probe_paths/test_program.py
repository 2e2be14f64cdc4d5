"""Emitted programs: golden files, limits of the control, what an operator relies on."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import as_read

from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import check_moves
from matstd.probe_paths.control import Clock, Move, interpret
from matstd.probe_paths.emit import Feeds, make_dry_run, make_programs
from matstd.probe_paths.emit.writer import visit_title
from matstd.probe_paths.language import MAX_LINE, Dialect, Kind, read_blocks, read_dialect
from matstd.probe_paths.plan import PlanOptions, plan_touches, requests_at
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.machine import Axis, make_chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG

LAST_DIGIT = 2e-4
"""Two units of the fourth decimal: what another processor may round otherwise, mm or degrees."""

NUMBER = re.compile(r"[+-]\d+\.\d+")


def tokens(text):
    """Words of a program, and its numbers apart."""
    numbers = np.array([float(v) for v in NUMBER.findall(text)])
    return NUMBER.sub("#", text), numbers


def test_programs_are_those_of_the_golden_files(programs, golden_folder):
    """Made by tests/golden/make_programs.py."""
    found = {p.name for p in golden_folder.iterdir()}
    assert found == {f"{p.name}.H" for p in programs.programs} | set(programs.masks)
    for program in programs.programs:
        golden = (golden_folder / f"{program.name}.H").read_bytes().decode("ascii")
        words, numbers = tokens(program.text)
        golden_words, golden_numbers = tokens(golden)
        assert words == golden_words
        assert np.abs(numbers - golden_numbers).max() < LAST_DIGIT
    for name, mask in programs.masks.items():
        assert (golden_folder / name).read_bytes().decode("ascii") == mask


def test_two_makes_do_not_differ_in_a_byte(golden, programs):
    again = golden.programs()
    assert [p.text for p in again.programs] == [p.text for p in programs.programs]
    assert again.masks == programs.masks


def test_files_are_what_the_control_takes(programs, tmp_path):
    for path in programs.write(tmp_path):
        data = path.read_bytes()
        assert data.count(b"\n") == data.count(b"\r\n")
        lines = data.decode("ascii").split("\r\n")
        assert max(map(len, lines)) <= 72
        assert len(path.stem) <= 16
        assert re.fullmatch(r"[A-Z][A-Z0-9_]*", path.stem)
        kinds = {b.kind for b in read_blocks(data, path)}
        assert kinds == set(Kind) - {
            Kind.TCPM_ON,
            Kind.HEAD_OFF,
            Kind.ORIENTATION,
            Kind.SHORTER_WAY,
            Kind.PLANE,
        }
    masks = sorted(tmp_path.glob("*.A"))
    assert {m.name for m in masks} == set(programs.masks)
    for mask in masks:
        assert max(map(len, mask.read_bytes().decode("ascii").split("\r\n"))) <= 72


def test_a_program_never_starts_the_spindle_and_resets_before_it_moves(programs):
    for program in programs.programs:
        code = [line.split(";")[0] for line in program.text.split("\r\n")]
        assert not [line for line in code if re.search(r"\bM0?[34]\b|\bM1[34]\b| S\d", line)]
        first_move = next(i for i, line in enumerate(code) if re.match(r"\d+ L ", line))
        before = "\n".join(code[:first_move])
        assert "M129" in before
        assert "PLANE RESET STAY" in before
        assert all(f"CYCL DEF 7.{i}" in before for i in range(4))
        assert "ID230 NR3 IDX3" in before  # the upper end of Z is tested before anything moves
        assert "GT +5 GOTO LBL 103" in before
        assert "M91" in code[first_move]


def test_coordinates_have_sign_and_four_decimals(programs):
    moves = [
        line
        for program in programs.programs
        for line in program.text.split("\r\n")
        if re.match(r"\d+ (L [XYZBC]|TCH PROBE 4\.[23])", line)
    ]
    assert len(moves) > 300
    for line in moves:
        words = re.findall(r"\b(?:I?[XYZBC]|MB|SET UP )([+-]?[\d.]+)", line)
        assert words
        assert all(re.fullmatch(r"[+-]\d+\.\d{4}", word) for word in words), line


def test_files_end_between_visits_and_share_all_touches(plan, programs):
    assert sum(p.touches for p in programs.programs) == len(plan)
    one = make_programs(plan, feeds=Feeds(touches_per_file=10_000))
    assert len(one.programs) == 1
    assert one.programs[0].touches == len(plan)
    visits = sum(p.text.count("* - VISIT") for p in programs.programs)
    assert visits == len(plan.visits)


def test_no_file_takes_longer_than_asked(plan, programs):
    made = make_programs(plan, feeds=Feeds(minutes_per_file=2.0)).programs
    assert max(p.duration for p in made) <= 120.0
    assert sum(p.touches for p in made) == len(plan)
    assert len(made) < 2.0 * programs.duration / 120.0
    # a visit is not cut however short a file shall be
    assert len(make_programs(plan, feeds=Feeds(minutes_per_file=0.1)).programs) == len(plan.visits)


def test_a_program_starts_at_any_visit(plan, programs, chain, golden):
    """Its touches, their readings and their sides are those of the whole program from there on."""
    rotary = [chain.axis_index(a) for a in chain.rotary_axes]
    for made in (programs, golden.programs("linuxcnc")):
        whole, first = as_read(made, chain), made.programs[0].text
        sizes = np.unique([t.pose for t in whole.touches], return_counts=True)[1]
        assert len(sizes) > 2
        for start in range(1, len(sizes) + 1):
            text = first.replace("1640 = +1", f"1640 = +{start}")
            tail = as_read(made, chain, text=text).touches
            wanted = whole.touches[len(whole.touches) - len(tail) :]
            assert len({t.pose for t in tail}) == len(sizes) - start + 1
            for one, other in zip(tail, wanted, strict=True):
                for name in ("number", "pose", "feature"):
                    assert getattr(one, name) == getattr(other, name)
                assert np.array_equal(one.q, other.q)
                assert np.array_equal(one.side[rotary], other.side[rotary])


def test_a_dry_run_goes_to_every_place_and_touches_nothing(plan, chain, small):
    made = make_dry_run(plan, 100.0)
    (program,) = made.programs
    assert program.touches == 0
    assert "TCH PROBE" not in program.text
    assert "FN 16" not in program.text
    read = as_read(made, chain)
    check_moves(read, small, chain)
    x, z = chain.axis_index("X"), chain.axis_index("Z")
    down = [
        step.q for step in read.steps if isinstance(step, Move) and step.feed and step.q[z] < 0.0
    ]
    there = [q for q in down if not np.isnan(q[x])]
    top = chain.link("Z").range[1] - plan.options.retract
    lows = np.array([q[z] for q in there if q[z] < top - 1e-6])
    assert len(lows) > 0.5 * len(plan)
    assert lows.min() > plan.start[:, z].min() + 99.9
    spoilt = program.text.replace("DRY RUN, RAISED BY", "DRY RUN, BY")
    with pytest.raises(BadFile, match="TOUCHES <first> TO <last>"):
        as_read(made, chain, text=spoilt)


def test_a_dry_run_that_touches_is_refused(plan, programs, chain):
    text = programs.programs[0].text
    text = re.sub(
        r"TOUCHES 1 TO \d+, ABOUT \d+ MIN", "DRY RUN, RAISED BY +100.0 MM, NO TOUCH", text
    )
    with pytest.raises(BadFile, match="expected none: a dry run"):
        as_read(programs, chain, text=text)


def test_the_duration_is_that_of_the_read_text(plan, programs):
    """By hand: a slower clock makes it longer by what it says."""
    slow = make_programs(plan, feeds=Feeds(touches_per_file=24), clock=Clock(probing=10.8))
    longer = slow.duration - programs.duration
    assert abs(longer - 10.0 * len(plan)) < 1e-6
    for program in programs.programs:
        assert f"ABOUT {program.duration / 60.0:.0f} MIN" in program.text


def test_dialect_words_reach_the_text(plan):
    dialect = Dialect(
        cycle_name="MEASURING IN 3-D",
        distance_word="ABST",
        folder="TNC:\\CAL",
        tool=12,
        preset=4,
        prefix="FF",
    )
    text = make_programs(plan, dialect).programs[0].text
    assert "TCH PROBE 4.0 MEASURING IN 3-D\r\n" in text
    assert "TCH PROBE 4.3 ABST +8.0000 F250 MB+5.0000 REFERENCE SYSTEM:0" in text
    assert "TOOL CALL 12 Z" in text
    assert "Q339=+4" in text
    assert "F-PRINT TNC:\\CAL\\MSPOINT.A / TNC:\\CAL\\FF_A_1.TXT" in text


def test_a_folder_with_too_long_a_name_is_refused(plan):
    with pytest.raises(DesignError, match="at most 72 are emitted"):
        make_programs(plan, Dialect(folder="TNC:\\" + "LONG" * 10))


@pytest.mark.parametrize(
    ("notation", "axes", "reason"),
    [
        ("[w X' f Z t]", "XZ", "needs exactly X, Y and Z"),
        ("[w X' Y' f Z A B C t]", "XYZABC", "expected at most two"),
    ],
)
def test_machines_that_a_program_cannot_name_are_refused(golden, notation, axes, reason):
    chain = make_chain("other", notation, {a: Axis((-300.0, 300.0)) for a in axes})
    small = golden.standard()
    rotary = np.zeros(sum(a in "ABC" for a in axes))
    wanted = requests_at(small, "FF1", np.zeros((1, 2)), rotary)
    with pytest.raises(DesignError, match=reason):
        plan_touches(small, chain, Probe(), Setup("a"), wanted)


def test_an_axis_that_does_not_point_along_its_letter_is_refused(golden):
    skewed = {"X": Axis((-300.0, 300.0), direction=(1.0, 0.1, 0.0))}
    rest = {a: Axis((-300.0, 300.0)) for a in "YZ"}
    chain = make_chain("skewed", "[w X' Y' f Z t]", skewed | rest)
    wanted = requests_at(golden.standard(), "FF1", np.zeros((1, 2)), np.zeros(0))
    with pytest.raises(DesignError, match="does not point along its letter"):
        plan_touches(golden.standard(), chain, Probe(), Setup("a"), wanted)


def plan_on(golden, notation, letters, pose):
    """Two touches and an anchor on one face of another machine, at one pose, degrees."""
    axes = {a: Axis((-400.0, 400.0)) for a in "XY"} | {"Z": Axis((-600.0, 0.0))}
    axes |= {a: Axis((-120.0 * DEG, 120.0 * DEG), (0.0, 0.0, -420.0)) for a in letters}
    if "B t" in notation:
        axes["B"] = Axis((-40.0 * DEG, 40.0 * DEG), (0.0, 0.0, 0.0))
    chain = make_chain("other", notation, axes, (0.0, 0.0, -500.0))
    small = golden.standard()
    wanted = requests_at(small, "FF1", np.array([[0.0, 3.0], [5.0, -4.0]]), np.array(pose) * DEG)
    return plan_touches(small, chain, Probe(), Setup("a"), wanted, PlanOptions())


@pytest.mark.parametrize(
    ("notation", "letters", "pose"),
    [
        ("[w X' Y' f Z t]", "", ()),
        ("[w B' X' f Y Z (C1) t]", "B", (-20.0,)),
        ("[w C' f X Y Z B t]", "CB", (40.0, 10.0)),
        ("[w C' A' Y' f X Z t]", "CA", (70.0, -25.0)),
    ],
)
def test_other_machines_are_programmed_by_the_same_code(golden, notation, letters, pose):
    """Three axes, one rotary axis, a tilting head, a trunnion about X: plan, text, text read."""
    made = make_programs(plan_on(golden, notation, letters, pose))
    assert made.programs[0].touches == 3
    of_turns = set(re.findall(r"M1[124][4-9]\b|PLANE \w+ \w+", made.programs[0].text))
    expected = {"M126", "M127", "M129", "PLANE RESET STAY"} if letters else set()
    expected |= {"M115", "M145"} if "B t" in notation else set()
    # of software options 1 and 2, which a machine of three axes lacks
    assert of_turns == expected
    words = [f"{a}{v:+.4f}" for a, v in sorted(zip(letters, pose, strict=True))]
    assert " ".join(["L", *words, "R0 F1000"]) in made.programs[0].text or not letters


@pytest.mark.parametrize(("control", "words"), [("itnc530", "M115 M145"), ("tnc640", "M145")])
def test_an_offset_of_the_head_is_switched_off_before_any_move(golden, control, words):
    """Each word is demanded of a program whose control is stated, M145 of every program."""
    plan, dialect = plan_on(golden, "[w C' f X Y Z B t]", "CB", (40.0, 10.0)), read_dialect(control)
    made = make_programs(plan, dialect)
    lines = [re.sub(r"^\d+ ", "", line) for line in made.programs[0].text.splitlines()]
    first_move = next(i for i, line in enumerate(lines) if line.startswith("L "))
    assert [s for s in lines[:first_move] if s in ("M115", "M145")] == words.split()
    for word in words.split():
        left = "\r\n".join(line for line in lines if line != word) + "\r\n"
        stated = (dialect, None) if word == "M145" else (dialect,)
        for one in stated:
            with pytest.raises(BadFile, match=f"expected {word} before it"):
                interpret(left.encode(), Path("MS_A_1.H"), made.masks.get, plan.chain, dialect=one)


def test_titles_of_many_visits_fit_on_their_lines(plan):
    """Three digits of visits and poses, and two readings of three digits."""
    visit = replace(plan.visits[0], pose=104, rotary=np.array([-120.25, -110.5]) * DEG)
    title = visit_title(("C", "B"), 118, 240, visit)
    assert re.match(
        r"VISIT 118/240 POSE 105: B-110\.50 (BELOW|ABOVE) C-120\.25 (BELOW|ABOVE)", title
    )
    assert len(f"12345 * - {title}") <= MAX_LINE
