"""Faulty logs: every whole touch is kept once, and every fault has its one line."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import all_read, parts_of

from matstd.artefact.tool import Probe
from matstd.probe_paths.campaign import VirtualMachine, evaluate
from matstd.probe_paths.campaign.as_programmed import check_numbers
from matstd.probe_paths.campaign.virtual_run import run_programs
from matstd.probe_paths.control import UNDATED, read_log
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import PlanOptions, plan_touches
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import pose
from matstd.twin.units import NM, UM

U = 1.0 * UM
HEAD = 14
"""Lines of a head, from MATSTD LOG 1 to EX EY TL."""
TOUCH = 5
"""Lines of a touch on a machine with two rotary axes."""


@pytest.fixture(scope="module")
def runs(read, small, perfect):
    return run_programs(read, small, perfect, np.random.default_rng(0))


@pytest.fixture(scope="module")
def lines(runs):
    return runs[0].log["MS_A_1.TXT"].splitlines()


def touch_line(number, part=0):
    """Index of a line of a touch: 0 counters, 1 XYZ, 2 rotary, 3 sides, 4 clock."""
    return HEAD + TOUCH * (number - 1) + part


def without(index, count=1):
    return lambda lines: [*lines[:index], *lines[index + count :]]


def instead(index, text):
    return lambda lines: [*lines[:index], text, *lines[index + 1 :]]


def before(index, *more):
    return lambda lines: [*lines[:index], *more, *lines[index:]]


def edited(index, old, new):
    def change(lines):
        assert old in lines[index], lines[index]
        return instead(index, lines[index].replace(old, new, 1))(lines)

    return change


def at_hour(hour, first):
    """Eight o'clock is another hour from a line on."""
    return lambda lines: [
        *lines[:first],
        *(s.replace("T  8:", f"T  {hour}:") for s in lines[first:]),
    ]


def again(number, to):
    """The lines of a touch a second time, behind touch `to`."""

    def change(lines):
        copy = lines[touch_line(number) : touch_line(number + 1)]
        return before(touch_line(to + 1), *copy)(lines)

    return change


def all_of(*changes):
    def change(lines):
        for one in changes:
            lines = one(lines)
        return lines

    return change


FAULTS = {
    # what is done to the log: (change, touches that are lost, words of the one line about it)
    **{
        f"line {part} of touch 7 lost": (without(touch_line(7, part)), {7}, "touch that begins")
        for part in range(1, TOUCH)
    },
    "counters of touch 7 lost": (without(touch_line(7)), {7}, "the beginning of no touch"),
    **{
        f"line {part} of touch 9 garbled": (
            instead(touch_line(9, part), "X\ufffd#~ 12"),
            {9},
            "touch that begins" if part else "beginning of no touch",
        )
        for part in range(TOUCH)
    },
    **{
        f"line {part} of touch 4 cut": (
            lambda lines, part=part: instead(touch_line(4, part), lines[touch_line(4, part)][:9])(
                lines
            ),
            {4},
            "touch that begins",
        )
        for part in range(TOUCH)
    },
    **{
        f"a number of touch 5 overflows, line {part}": (
            lambda lines, part=part: instead(
                touch_line(5, part), re.sub(r"-?\d+\.\d+", "********", lines[touch_line(5, part)])
            )(lines),
            {5},
            "touch that begins" if part else "beginning of no touch",
        )
        for part in range(TOUCH - 1)
    },
    "touch 6 lost whole": (without(touch_line(6), TOUCH), {6}, ""),
    "touches 6 to 8 lost whole": (without(touch_line(6), 3 * TOUCH), {6, 7, 8}, ""),
    "a foreign line in a touch": (
        before(touch_line(3, 2), "OPERATOR JM"),
        {3},
        "touch that begins",
    ),
    "a foreign line between touches": (before(touch_line(3), "OPERATOR JM"), set(), "left out"),
    "foreign lines between touches": (before(touch_line(3), "A", "B", "C"), set(), "lines"),
    "blank lines": (all_of(before(touch_line(3), "", " "), before(22, "\t")), set(), ""),
    "blank at every end": (lambda lines: [f"  {line} \t" for line in lines], set(), ""),
    "decimal commas": (
        lambda lines: [re.sub(r"(\d)\.(\d)", r"\1,\2", s) for s in lines],
        set(),
        "",
    ),
    "a touch twice": (again(5, 5), set(), "touch 5 again; the first counts"),
    "a touch twice, elsewhere": (again(5, 12), set(), "touch 5 again; the first counts"),
    "a touch number twice": (
        edited(touch_line(6), "P     6.0", "P     5.0"),
        {6},
        "touch 5 again with other numbers",
    ),
    "a number that is none": (edited(touch_line(6), "P     6.0", "P     6.5"), {6}, "begins"),
    "a feature of zero": (edited(touch_line(6), "F     ", "F     -"), {6}, "touch that begins"),
    "END lost": (lambda lines: lines[:-1], set(), ""),
    "END garbled": (lambda lines: [*lines[:-1], "END T 99: 9: 9"], set(), "no end of a program"),
    "lines behind the end": (lambda lines: [*lines, "PRINTED BY FN16"], set(), "left out"),
    "lines before the head": (before(0, "SOME OTHER PROGRAM"), set(), "before the head"),
    "the first line lost": (without(0), set(), ""),
    "the first line garbled": (instead(0, "MATXTD L0G 1"), set(), "before the head"),
    "no date": (without(9), set(), "without a date"),
    "month 13": (edited(9, "-  1-", "- 13-"), set(), "without a date"),
    "no time in the head": (without(10), set(), "the first touch's is taken"),
    "hour 25 in the head": (edited(10, "T  8:", "T 25:"), set(), "the first touch's is taken"),
    "tool and preset lost": (without(11), set(), "it is left out"),
    "tool garbled": (instead(11, "TOOL ????"), set(), "it is left out"),
    "offsets lost": (without(13), set(), "it is left out"),
    "offsets garbled": (instead(13, "EX   0.0"), set(), "it is left out"),
    "hour 25": (edited(touch_line(8, 4), "T  8:", "T 25:"), {8}, "touch that begins"),
    "the clock an hour back": (
        at_hour(7, touch_line(12)),
        set(),
        "the clock goes back by 60 min|the clock goes back by 59 min",
    ),
    "summer time begins": (
        at_hour(9, touch_line(12)),
        set(),
        "summer time",
    ),
    "a third of the log": (lambda lines: lines[: touch_line(9, 0)], set(range(9, 25)), ""),
    "cut off in a touch": (lambda lines: lines[: touch_line(9, 2)], set(range(9, 25)), "begins"),
}
"""Touch numbers as those of the first golden program, 1 to 24."""


@pytest.mark.parametrize("name", FAULTS)
def test_every_whole_touch_is_kept_once_and_every_fault_said_once(name, lines, chain):
    change, lost, words = FAULTS[name]
    broken = change(list(lines))
    assert broken != lines
    (part,) = read_log("L", chain.rotary_axes, "\n".join(broken) + "\n")
    assert sorted(part.number.tolist()) == sorted(set(range(1, 25)) - lost)
    assert np.all(np.diff(part.time) >= 0.0)
    if words is not None:
        assert len(part.remarks) == (1 if words else 0), part.remarks
    if words:
        assert re.search(words, part.remarks[0]), part.remarks
    (whole,) = read_log("L", chain.rotary_axes, "\n".join(lines) + "\n")
    kept = np.isin(whole.number, part.number)
    order = np.argsort(part.number)
    assert np.array_equal(part.xyz[order], whole.xyz[kept])
    assert np.array_equal(part.rotary["B"][order], whole.rotary["B"][kept])


HEAD_FAULTS = {
    "nothing": (lambda lines: [], "found nothing, expected MATSTD LOG 1"),
    "another version": (instead(0, "MATSTD LOG 2"), "MATSTD LOG 2"),
    "no name": (without(1), "PGM <name>"),
    "no standard": (without(2), "STANDARD <name> SETUP <name>"),
    "no origin": (instead(3, "ORIGIN X+1.0"), "ORIGIN X"),
    "no rotation": (without(4), "TURNED A"),
    "no probe": (instead(5, "PROBE"), "PROBE RADIUS"),
    "no calibration": (without(12), "R <number> L <number>"),
    "calibration garbled": (instead(12, "R 3.0"), "R <number> L <number>"),
    "the head alone, cut": (lambda lines: lines[:12], "the end of the part"),
}


@pytest.mark.parametrize("name", HEAD_FAULTS)
def test_a_head_without_which_no_touch_means_anything_is_refused(name, lines, chain):
    change, words = HEAD_FAULTS[name]
    with pytest.raises(BadFile, match=words) as caught:
        read_log("MS_A_1.TXT", chain.rotary_axes, "".join(f"{s}\n" for s in change(list(lines))))
    assert str(caught.value).startswith("MS_A_1.TXT: line ")


def test_a_bad_head_costs_its_own_part_only(lines, chain):
    broken = without(3)(list(lines))
    parts = read_log("L", chain.rotary_axes, "\n".join([*broken, *lines]) + "\n")
    assert [len(part.number) for part in parts] == [24]
    assert "the touches of this part are left out" in parts[0].remarks[0]


def test_a_last_line_without_its_end(lines, chain):
    whole = "\n".join(lines)
    assert read_log("L", chain.rotary_axes, whole)[0].is_complete
    cut = read_log("L", chain.rotary_axes, whole[:-1])[0]
    assert not cut.is_complete
    assert len(cut.number) == 24
    half = "\n".join(lines[: touch_line(9, 5)])
    assert len(read_log("L", chain.rotary_axes, half)[0].number) == 9
    # a clock that has lost its last digit is no time
    assert len(read_log("L", chain.rotary_axes, half[:-1])[0].number) == 8


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_what_an_editor_makes_of_a_log(lines, chain, tmp_path, encoding, line_end):
    path = tmp_path / "LOG.TXT"
    path.write_bytes("".join(f"{s}{line_end}" for s in lines).encode(encoding))
    (part,) = read_log(path, chain.rotary_axes)
    assert len(part.number) == 24
    assert not part.remarks


@pytest.mark.parametrize("after", [0, 1, 11])
def test_a_touch_without_contact_ends_its_run_and_no_other(lines, chain, after):
    stopped = [*lines[: touch_line(after + 1)], f"NOCONTACT P     {after + 1}.0", "T  8:  1:  1"]
    parts = read_log("L", chain.rotary_axes, "\n".join([*stopped, *lines]) + "\n")
    assert [len(part.number) for part in parts] == [after, 24]
    assert [part.is_complete for part in parts] == [False, True]


def test_a_stop_at_the_first_touch_is_evaluated(lines, small, chain):
    """The part without touches has a probe all the same."""
    stopped = [*lines[:HEAD], "NOCONTACT P     1.0", "T  8:  0: 30"]
    parts = read_log("L", chain.rotary_axes, "\n".join([*stopped, *lines]) + "\n")
    parts[1] = replace(parts[1], begin=parts[1].begin.replace(hour=9))
    assert len(evaluate(parts, small, chain, U)) == 24


def test_the_same_log_twice_counts_once(lines, small, chain):
    whole = "\n".join(lines) + "\n"
    once = evaluate(read_log("L", chain.rotary_axes, whole), small, chain, U)
    twice = evaluate(read_log("L", chain.rotary_axes, whole + whole), small, chain, U)
    assert np.array_equal(once.deviation, twice.deviation)
    assert "24 touches stand in L too and count once" in twice.remarks[0]
    half = "\n".join(lines[: touch_line(9)]) + "\n"
    parts = [*read_log("H", chain.rotary_axes, half), *read_log("L", chain.rotary_axes, whole)]
    both = evaluate(parts, small, chain, U)
    assert np.array_equal(once.deviation, both.deviation)


def test_two_versions_of_one_log_are_refused(lines, small, chain):
    whole = "\n".join(lines) + "\n"
    other = edited(touch_line(5, 1), ".", ".1")(list(lines))
    parts = [
        *read_log("L", chain.rotary_axes, whole),
        *read_log("M", chain.rotary_axes, "\n".join(other) + "\n"),
    ]
    with pytest.raises(BadFile, match="the same numbers as in"):
        evaluate(parts, small, chain, U)


def test_a_clock_set_back_between_two_programs_is_said(runs, small, chain):
    parts = parts_of(runs, chain)
    assert evaluate(parts, small, chain, U).remarks == ()
    begin = parts[1].begin.replace(minute=parts[0].begin.minute + 1)
    run = evaluate([parts[0], replace(parts[1], begin=begin), parts[2]], small, chain, U)
    assert any("the clock was set between them" in remark for remark in run.remarks)


def test_touches_far_off_are_left_out_and_said(lines, small, chain):
    """A digit of X and a feature that the standard lacks: two touches less, two remarks."""
    x = re.search(r"X\s*(-?\d+)", lines[touch_line(7, 1)])
    broken = edited(touch_line(7, 1), x[0], f"X {int(x[1]) + 400}")(list(lines))
    broken = edited(touch_line(12), "F     ", "F    9")(broken)
    parts = read_log("L", chain.rotary_axes, "\n".join(broken) + "\n")
    run = evaluate(parts, small, chain, U)
    assert len(run) == 22
    assert np.abs(run.deviation).max() < NM
    assert any("touch 7 with" in remark for remark in run.remarks)
    assert any("touch 12 is left out" in remark for remark in run.remarks)


def test_halves_of_two_touches_make_none(lines, small, chain):
    """From the middle of touch 3 into the next visit: coordinates of one, table of the other."""
    broken = without(touch_line(3, 2), 6 * TOUCH)(list(lines))
    (part,) = read_log("L", chain.rotary_axes, "\n".join(broken) + "\n")
    run = evaluate([part], small, chain, U)
    assert np.abs(run.deviation).max() < NM
    assert len(run) == 17
    assert any("touch 3 with" in remark for remark in run.remarks)


def test_a_ball_far_off_the_spindle_axis_is_said(lines, small, chain):
    parts = read_log("L", chain.rotary_axes, "\n".join(lines) + "\n")
    off = replace(parts[0], offset=1.0)
    assert "calibrated 1.000 mm off the spindle axis" in evaluate([off], small, chain, U).remarks[0]


def test_two_tools_for_one_probe_are_refused_whatever_probe_came_first(lines, chain):
    (first,) = read_log("L", chain.rotary_axes, "\n".join(lines) + "\n")
    heading = replace(first.heading, probe=Probe(2.0, 260.0))
    long = replace(first, heading=heading, radius=2.0, tool_length=262.0, tool=31.0, path=Path("M"))
    check_numbers([first, long], chain)
    with pytest.raises(BadFile, match=r"TOOL: found 32, where M has 31, expected one tool"):
        check_numbers([first, long, replace(long, tool=32.0)], chain)


@pytest.mark.parametrize(
    ("key", "limit", "found"),
    [
        ("radius", 0.2, r"3\.21 mm as radius of the ball"),
        ("tool_length", 1.0, "length of the tool"),
    ],
)
def test_a_calibration_at_which_the_program_stops_is_refused(
    key, limit, found, lines, small, chain
):
    (part,) = read_log("L", chain.rotary_axes, "\n".join(lines) + "\n")
    for off in (limit, -limit):  # a calibrated ball differs a little from the planned one
        check_numbers([replace(part, **{key: getattr(part, key) + off})], chain)
    other = replace(part, **{key: getattr(part, key) + limit + 0.01})
    with pytest.raises(BadFile, match=rf"{found}, expected .* within {limit:g} mm, the probe of"):
        evaluate([other], small, chain, U)


def test_the_log_of_a_machine_with_its_axes_in_another_order_is_refused(lines, small, golden):
    parts = read_log("L", golden.machine().rotary_axes, "\n".join(lines) + "\n")
    found = "MACHINE: found axes C-B-X-F-Y-Z from workpiece to tool, expected B-C-X-F-Y-Z"
    with pytest.raises(BadFile, match=found):
        evaluate(parts, small, golden.machine("[w B' C' X' f Y Z (C1) t]"), U)
    corrected = golden.machine("[w C' B' X' f Z Y (C1) t]")
    assert len(evaluate(parts, small, corrected, U)) == 24
    earlier = [replace(parts[0], heading=replace(parts[0].heading, arrangement=""))]
    assert len(evaluate(earlier, small, corrected, U)) == 24


def test_another_serial_number_is_refused(lines, small, chain):
    numbered = before(8, "SERIAL 007")(list(lines))
    parts = read_log("L", chain.rotary_axes, "\n".join(numbered) + "\n")
    assert parts[0].heading.serial == "007"
    assert len(evaluate(parts, replace(small, serial="007"), chain, U)) == 24
    with pytest.raises(DesignError, match=r"written for SMALL-1 007 .*you gave SMALL-1 008"):
        evaluate(parts, replace(small, serial="008"), chain, U)


def test_a_sphere_beside_its_calibrated_place_is_said(golden, small, chain):
    """0.3 mm, of which the set-up takes up some; a standard in order has no such remark."""
    wanted = golden.requests(small, each=6)
    options = PlanOptions(tolerated=len(wanted))
    plan = plan_touches(small, chain, Probe(), golden.setup(), wanted, options)
    programs = all_read(make_programs(plan), chain)
    ball = small.spheres[1]
    moved = replace(ball, centre=ball.centre + np.array([0.0, 0.3, 0.0]))
    true = replace(small, spheres=(small.spheres[0], moved, small.spheres[2]))
    for standard, expected in ((small, []), (true, ["SPH2"])):
        machine = VirtualMachine(chain, setup_error=pose(t=np.array([0.2, 0.1, 0.0])), noise=U)
        runs = run_programs(programs, standard, machine, np.random.default_rng(0))
        remarks = evaluate(parts_of(runs, chain), small, chain, U).remarks
        assert [remark.split()[0] for remark in remarks] == expected


def test_a_run_without_a_date_begins_long_ago(lines, chain):
    (part,) = read_log("L", chain.rotary_axes, "\n".join(without(9)(list(lines))) + "\n")
    assert part.begin.date() == UNDATED.date()
    assert (part.begin.hour, part.begin.minute) == (8, 0)


def test_a_run_without_a_date_beside_others_takes_theirs(runs, small, chain):
    texts = [next(iter(r.log.values())) for r in runs]
    texts[1] = re.sub(r"DATE.*\n", "", texts[1])
    parts = [p for text in texts for p in read_log("L", chain.rotary_axes, text)]
    run = evaluate(parts, small, chain, U)
    assert np.ptp(run.touches.time) < 3600.0
    assert any("its date is taken from another log" in remark for remark in run.remarks)
