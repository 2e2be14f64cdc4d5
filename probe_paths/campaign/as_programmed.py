"""Consistency of logs: a running clock, enough decimals, agreement with the program.

A log is text that passes through many hands. The evaluation relies on its sides, tool and preset,
and the program that wrote it states them too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import timedelta

import numpy as np

from matstd.probe_paths.control import UNDATED, LogPart, ProbeStep, ReadProgram
from matstd.probe_paths.language import LANGUAGES, Label, interlocks
from matstd.probe_paths.plan import ProgramFrame
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain
from matstd.twin.record import Run
from matstd.twin.units import DEG, NM

LONGEST_CAMPAIGN = timedelta(days=30)
"""Longest time between the logs of one evaluation: a standard stays clamped for days."""

COARSEST_STEP = 0.01
"""Step of positions that is too coarse for a measurement, mm; the masks print 0.000001."""

MIN_TOUCHES = 5  # touches from which a clock or a step is judged

SAME_ANGLE = 0.05
"""Largest deviation of a rotary axis from its programmed position, degrees; as in the programs."""


def check_numbers(parts: Sequence[LogPart], chain: Chain) -> None:
    """Raise BadFile for a stopped clock, rounded positions, another probe, different campaigns."""
    dated = sorted((p for p in parts if p.begin.year != UNDATED.year), key=lambda p: p.begin)
    if dated and dated[-1].begin - dated[0].begin > LONGEST_CAMPAIGN:
        first, last = dated[0], dated[-1]
        found = f"{first.begin.date()}, where {last.path.name} has {last.begin.date()}"
        expected = f"logs of one campaign, within {LONGEST_CAMPAIGN.days} days; evaluate them apart"
        raise BadFile(first.path, "DATE", found, f"{expected}, or correct the clock of the control")
    for part in parts:
        _check_probe(part, chain)
        if len(part.number) >= MIN_TOUCHES:
            _check_steps(part)
    for key in ("tool", "preset"):
        _check_common(key, [p for p in parts if getattr(p, key) is not None])


def _check_probe(part: LogPart, chain: Chain) -> None:
    """Refuse a calibration at which the program would have stopped."""
    frame = ProgramFrame(chain, part.heading.probe)
    found = {Label.OTHER_PROBE: part.tool_length, Label.RADIUS: part.radius}
    for test in interlocks(LANGUAGES["klartext"], frame):
        if test.label in found and abs(found[test.label] - test.planned) > test.limit + NM:
            stated = f"{found[test.label]:g} mm as {test.what}"
            expected = f"{test.planned:g} within {test.limit:g} mm, the probe of {part.program}"
            raise BadFile(part.path, "R, L", stated, expected)


def _check_steps(part: LogPart) -> None:
    """Refuse a clock that stands still and positions that are rounded."""
    if np.ptp(part.time) == 0.0:
        found = f"the same time at all {len(part.time)} touches"
        expected = "a clock that runs: one that stands hides every drift"
        raise BadFile(part.path, part.line[-1], found, expected)
    steps = part.xyz / COARSEST_STEP
    if np.allclose(steps, np.round(steps), rtol=0.0, atol=1e-4):
        found = f"positions in steps of {COARSEST_STEP:g} mm or more at all touches"
        raise BadFile(part.path, part.line[-1], found, "six decimals, as the program prints them")


def _check_common(key: str, parts: Sequence[LogPart]) -> None:
    """Refuse different presets in one campaign, or different tools of one probe."""
    for part in parts:
        first = next(p for p in parts if key == "preset" or p.heading.probe == part.heading.probe)
        own, stated = getattr(part, key), getattr(first, key)
        if own != stated:
            found = f"{own:g}, where {first.path.name} has {stated:g}"
            raise BadFile(part.path, key.upper(), found, f"one {key} for all logs of a campaign")


def check_as_programmed(
    parts: Sequence[LogPart], programs: Mapping[str, ReadProgram], chain: Chain
) -> None:
    """Refuse logs that contradict the programs that wrote them; raises BadFile.

    Args:
        programs: By name; logs of other programs are ignored.
    """
    for part in parts:
        program = programs.get(part.program)
        if program is None:
            continue
        for key in ("tool", "preset"):
            found, planned = getattr(part, key), getattr(program, key)
            if None not in (found, planned) and found != planned:
                expected = f"{planned:g}, as {program.path.name} calls it"
                raise BadFile(part.path, key.upper(), f"{found:g}", expected)
        planned_touches = {touch.number: touch for touch in program.touches if not touch.is_air}
        for i, number in enumerate(part.number.tolist()):
            if number not in planned_touches:
                expected = f"one of the touches of {program.path.name}"
                raise BadFile(part.path, part.line[i], f"touch {number}", expected)
            _check_touch(part, i, planned_touches[number], program, chain)


def _check_touch(
    part: LogPart, i: int, touch: ProbeStep, program: ReadProgram, chain: Chain
) -> None:
    """Compare counters, sides and rotary positions of one touch with the program."""
    number = int(part.number[i])
    rows = [
        ("pose", int(part.pose[i]), touch.pose),
        ("feature", int(part.feature[i]), touch.feature),
    ]
    for letter, side in part.side.items():
        column = chain.axis_index(letter)
        rows.append((f"side of {letter}", int(side[i]), int(touch.side[column])))
        at, sent = float(part.rotary[letter][i]), float(touch.q[column]) / DEG
        if abs(at - sent) > SAME_ANGLE:
            found = f"{letter} at {at:.4f} degrees at touch {number}"
            raise BadFile(part.path, part.line[i], found, f"{sent:.4f}, where it was sent")
    for what, has, wanted in rows:
        if has != wanted:
            found = f"{what} {has:+d} at touch {number}"
            raise BadFile(
                part.path, part.line[i], found, f"{wanted:+d}, as {program.path.name} has it"
            )


def with_program_lines(run: Run, programs: Mapping[str, ReadProgram]) -> Run:
    """A run that knows the line of its program at every touch; 0 of programs that are not there."""
    line = {
        (name, touch.number): touch.line
        for name, program in programs.items()
        for touch in program.touches
        if not touch.is_air
    }
    where = zip(run.program.tolist(), run.touch.tolist(), strict=True)
    return replace(run, program_line=np.array([line.get(one, 0) for one in where]))
