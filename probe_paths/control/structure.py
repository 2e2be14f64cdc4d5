"""What must hold for a program as a whole before a single block of it is executed."""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from matstd.nc.grammar import label_places
from matstd.probe_paths.control.motion import AXIS
from matstd.probe_paths.language import Block, Kind, Label, language_of
from matstd.probe_paths.plan import Heading, parse_heading
from matstd.twin.errors import BadFile

_TOUCHES = re.compile(r"TOUCHES (\d+) TO (\d+),.*")
_DRY = re.compile(r"DRY RUN, RAISED BY [+-][\d.]+ MM, NO TOUCH")
_SEARCH = re.compile(r"SEARCH FROM ABOVE, STANDS WITHIN [\d.]+ MM AND [\d.]+ DEG")
_FIRST = re.compile(r"COMMISSIONING: ONE TOUCH IN AIR, ONE ON BALL \S+")
_PRESET = re.compile(r"PRESET (\d+):.*")
_TOOL = re.compile(r"TOOL (\d+) IS THE PROBE: L([+-][\d.]+) R([+-][\d.]+),.*")
_FEATURE = re.compile(r"FEATURE (\d+) IS (\S+)")
_CYCLE = (Kind.PROBE_NAME, Kind.PROBE_RESULT, Kind.PROBE_VECTOR, Kind.PROBE_PATH)

_DIGITS = 1e-4
"""Largest difference of a stated coordinate from the planned one, mm: the last decimal."""


class Promise(NamedTuple):
    """What the head of a program promises of its blocks."""

    touches: range  # numbers of the touches; none of a dry run
    tool: int  # number of the probe in the tool table
    preset: int  # row of the preset table
    is_search: bool = False  # its touches are long ones from above that look for the standard
    # it is the one that a control is tried with: few tests, a touch in the air
    is_first: bool = False


def program_name(blocks: Sequence[Block], path: Path) -> str:
    """Name of the program, after its frame has been checked; raises BadFile."""
    first, last = blocks[0], blocks[-1]
    if first.kind is not Kind.BEGIN:
        raise BadFile(path, first.line, repr(first.text), "BEGIN PGM <name> MM")
    if last.kind is not Kind.END:
        raise BadFile(path, last.line, f"{last.text!r} as the last block", "END PGM: cut off?")
    for block in blocks[1:-1]:
        if block.kind in (Kind.BEGIN, Kind.END):
            raise BadFile(path, block.line, repr(block.text), "one frame per file")
    name = first.word("name")
    for block in (first, last):
        if block.word("unit") != "MM":
            raise BadFile(path, block.line, block.word("unit"), "MM")
        if block.word("name") != name:
            raise BadFile(path, block.line, block.word("name"), f"{name} as in BEGIN PGM")
    if path.stem.upper() != name.upper():
        raise BadFile(path, first.line, f"program name {name}", f"{path.stem}")
    return name


def labels(blocks: Sequence[Block], path: Path) -> dict[str, int]:
    """Block index of every label; raises BadFile."""
    kinds = [block.kind for block in blocks]
    if Kind.PROGRAM_STOP not in kinds:
        raise BadFile(path, blocks[-1].line, "no M30", "M30 at the end of the program")
    labelled = [(i, b) for i, b in enumerate(blocks) if b.kind is Kind.LABEL]
    found = label_places(((i, b.line, b.word("label")) for i, b in labelled), path)
    stop = kinds.index(Kind.PROGRAM_STOP)
    inside = {name for name in found if Label.stands_inside(int(name))}
    for name, i in found.items():
        if i < stop and name not in inside:
            raise BadFile(path, blocks[i].line, f"LBL {name}", "subprograms after M30")
    for block in blocks:
        if block.kind in (Kind.CALL, Kind.JUMP) and block.word("label") not in found:
            available = ", ".join(n for n in found if n not in inside) or "none"
            expected = f"a label that is defined; available: {available}"
            raise BadFile(path, block.line, f"LBL {block.word('label')}", expected)
    asked = {b.word("label") for b in blocks if b.kind is Kind.JUMP}
    for name in sorted(inside - asked):
        line, lost = blocks[found[name]].line, f"LBL {name} that nothing goes to"
        raise BadFile(path, line, lost, "a test of the visit to start at")
    return found


def check_cycles(blocks: Sequence[Block], path: Path) -> None:
    """Cycles 4 and 7 stand in four blocks, in order and together; raises BadFile."""
    for before, block in pairwise(blocks):
        is_in_7 = before.kind in (Kind.SHIFT_NAME, Kind.SHIFT)
        if block.kind is Kind.SHIFT and not is_in_7 and language_of(path).has_masks:
            raise BadFile(path, block.line, repr(block.text), "CYCL DEF 7.0 before it")
    expected = 0
    for block in blocks:
        place = _CYCLE.index(block.kind) if block.kind in _CYCLE else None
        if (place is None and expected) or (place is not None and place != expected):
            wanted = f"TCH PROBE 4.{expected} in its place"
            raise BadFile(path, block.line, repr(block.text), wanted)
        expected = 0 if place is None else (place + 1) % len(_CYCLE)


def check_axes(blocks: Sequence[Block], letters: Sequence[str], head: Heading, path: Path) -> None:
    """Refuse a program whose axes are not those of the machine; raises BadFile."""
    named = {
        letter: block.line
        for block in reversed(blocks)
        if block.kind is Kind.LINE
        for letter, _ in AXIS.findall(block.word("axes"))
    }
    of_machine = ", ".join(letters)
    written = f"the program was written for {head.stamp}: is this its machine?"
    for letter, line in sorted(named.items(), key=lambda one: one[1]):
        if letter not in letters:
            expected = f"an axis of the machine: {of_machine}; {written}"
            raise BadFile(path, line, f"axis {letter}", expected)
    missing = [] if head.is_tilted else [a for a in letters if a not in named]
    if missing:
        found = f"no position of {' and '.join(missing)}"
        raise BadFile(path, "program", found, f"every axis of the machine, {of_machine}; {written}")


def heading(blocks: Sequence[Block], path: Path) -> tuple[Heading, Mapping[int, str]]:
    """Head of a program, and the feature that every number stands for; raises BadFile."""
    remarks = _remarks(blocks)
    starts = [i for i, (_, text) in enumerate(remarks) if text.startswith("STANDARD ")]
    if not starts:
        raise BadFile(path, "head", "no comment ';STANDARD ... SETUP ...'", "the program's head")
    head, _ = parse_heading(remarks[starts[0] :], path)
    if head.workshop is None:
        found = "no comments ';STACK ...' and ';BODY ...'"
        raise BadFile(path, "head", found, "what must be kept clear: emit the program again")
    features: dict[int, str] = {}
    for line, text in remarks:
        match = _FEATURE.fullmatch(text)
        if match is None:
            continue
        if int(match[1]) in features:
            raise BadFile(path, line, repr(text), "every feature number once")
        features[int(match[1])] = match[2]
    return head, features


def _remarks(blocks: Sequence[Block]) -> list[tuple[int, str]]:
    return [(b.line, b.word("text").strip()) for b in blocks if b.kind is Kind.COMMENT]


def promise(blocks: Sequence[Block], head: Heading, path: Path) -> Promise:
    """Touches, tool and preset as the head states them; raises BadFile."""
    remarks = _remarks(blocks)
    # a dry run makes no touches
    if any(_DRY.fullmatch(text) for _, text in remarks):
        made = range(0)
    else:
        touches, _ = _remark(_TOUCHES, ";TOUCHES <first> TO <last>, ...", remarks, path)
        made = range(int(touches[0]), int(touches[1]) + 1)
    preset, _ = _remark(_PRESET, ";PRESET <row>: ...", remarks, path)
    form = ";TOOL <number> IS THE PROBE: L<signed> R<signed>, ..."
    tool, line = _remark(_TOOL, form, remarks, path)
    planned_words = (("L", head.probe.tool_length), ("R", head.probe.radius))
    for (name, planned), stated in zip(planned_words, tool[1:], strict=True):
        if abs(float(stated) - planned) > _DIGITS:
            raise BadFile(path, line, f"{name}{stated}", f"{planned:+.4f} as PROBE says")
    return Promise(
        touches=made,
        tool=int(tool[0]),
        preset=int(preset[0]),
        is_search=any(_SEARCH.fullmatch(text) for _, text in remarks),
        is_first=any(_FIRST.fullmatch(text) for _, text in remarks),
    )


def _remark(
    pattern: re.Pattern[str], form: str, remarks: Sequence[tuple[int, str]], path: Path
) -> tuple[tuple[str, ...], int]:
    """Groups of the first remark that matches, and its line."""
    for line, text in remarks:
        match = pattern.fullmatch(text)
        if match is not None:
            return match.groups(), line
    raise BadFile(path, "head", f"no comment '{form}'", "the program's head")
