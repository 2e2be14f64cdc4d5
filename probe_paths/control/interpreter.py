"""Reads an emitted program and its masks, and executes the text: moves, touches, printed lines.

Only the text counts: the plan is not known here, so a discrepancy between plan and text shows. A
touch is assumed to find its surface; the branch of the program for a miss is executed too and
stored with the touch.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.probe_paths.control.runner import MaskSource, Runner
from matstd.probe_paths.control.state import State
from matstd.probe_paths.control.steps import ProbeStep, ReadProgram
from matstd.probe_paths.control.structure import (
    Promise,
    check_axes,
    check_cycles,
    heading,
    labels,
    program_name,
    promise,
)
from matstd.probe_paths.language import (
    Dialect,
    Label,
    Q,
    interlocks,
    language_of,
    read_blocks,
    turn_tests,
)
from matstd.probe_paths.plan import Heading, Probe, ProgramFrame
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain
from matstd.twin.words import not_read

_OFF_LIMIT_FACTOR = 1.05
"""Multiple of its limit by which a value is off when the program has to stop."""


_ANY = Dialect(head_off=("M145",))
"""Of a program whose control is not stated: what every control of its language has."""


def read_program(
    path: str | Path, chain: Chain, probe: Probe | None = None, dialect: Dialect | None = None
) -> ReadProgram:
    """Read a program file and its masks, and execute it.

    Args:
        path: The program; masks (`.A`) of an `.H` file stand in the same folder.
        probe: In the spindle; None takes the one that the program's head states.

    Raises:
        BadFile: Whatever the control, or a cautious operator, would not run.
    """
    path = Path(path)

    def mask(name: str) -> str | None:
        try:
            return (path.parent / name).read_bytes().decode("ascii", "replace")
        except FileNotFoundError:
            return None

    return interpret(_content(path), path, mask, chain, probe, dialect)


def stated_probe(
    path: str | Path, radius: float | None, length: float | None, dialect: Dialect | None = None
) -> Probe | None:
    """The probe that a user states, mm; unstated values come from the program's head."""
    if radius is None and length is None:
        return None
    head = stated_heading(path, dialect)
    return Probe(
        head.probe.radius if radius is None else radius,
        head.probe.length if length is None else length,
    )


def stated_heading(path: str | Path, dialect: Dialect | None = None) -> Heading:
    """The head of a program, whatever machine its blocks are for."""
    return heading(read_blocks(_content(Path(path)), path, dialect), Path(path))[0]


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise BadFile(path, "file", not_read(path, error), "a program file") from error


def interpret(
    data: bytes,
    path: Path,
    masks: MaskSource,
    chain: Chain,
    probe: Probe | None = None,
    dialect: Dialect | None = None,
) -> ReadProgram:
    """Execute the text of a program; arguments and errors as of `read_program`.

    Args:
        path: Its name: it must agree with the program's.
        masks: Where FN 16 finds its masks.
    """
    blocks = read_blocks(data, path, dialect)
    name = program_name(blocks, path)
    places = labels(blocks, path)
    check_cycles(blocks, path)
    head, features = heading(blocks, path)
    frame = ProgramFrame(chain, _probe(head, probe, path))
    check_axes(blocks, frame.letters, head, path)
    head.check_machine(chain, path)
    stated = promise(blocks, head, path)
    runner = Runner(blocks, places, frame, path, name, masks, head)
    axes, language = len(chain.axes), language_of(path)
    reset = language.reset(chain, dialect or _ANY)
    begin = State(
        path,
        frame,
        q=np.full(axes, np.nan),
        side=np.zeros(axes),
        is_tcpm_off=language.terms.reset not in reset,
        is_plane_off=language.terms.plane not in reset,
        orientation_left=len(language.orientation) if dialect and dialect.is_oriented else 0,
        head_left={"M115", "M145"} & set(reset),
        is_search=stated.is_search,
        is_first=stated.is_first,
        is_tilted=head.is_tilted,
    )
    state = begin.copied()
    steps = runner.run(0, state)
    runner.check_logged()
    _check_promise(stated, state, runner.touches, path)
    # the program must stop in every run in which one tested value is off its limit
    for test in (*interlocks(language, frame, stated.is_first), *turn_tests(language, frame)):
        for off in (-_OFF_LIMIT_FACTOR * test.limit, _OFF_LIMIT_FACTOR * test.limit):
            runner.run(0, replace(begin.copied(), fault=test, off=off))
    program = ReadProgram(
        path=path,
        name=name,
        heading=head,
        features=features,
        steps=tuple(steps),
        is_search=stated.is_search,
        is_first=stated.is_first,
        tool=state.tool,
        preset=state.preset,
    )
    for touch in program.touches:
        if not touch.is_air and touch.feature not in features:
            expected = "a number of the head's list (;FEATURE <number> IS <name>)"
            raise BadFile(path, touch.line, f"feature {touch.feature}", expected)
    return program


def _check_promise(stated: Promise, state: State, touches: Sequence[ProbeStep], path: Path) -> None:
    """Refuse a program that differs from the statements of its head."""
    for what in ("tool", "preset"):
        said, done = getattr(stated, what), getattr(state, what)
        if said != done:
            raise BadFile(path, "head", f"{what} {said}", f"{done}, as the program calls it")
    made = [touch.number for touch in touches if not touch.is_air]
    wanted = list(stated.touches)
    if stated.is_first and sum(touch.is_air for touch in touches) != 1:
        expected = f"one touch in the air, which goes on at LBL {Label.AIR:d}"
        raise BadFile(path, "head", "commissioning without a touch in the air", expected)
    start = state.parameters.get(Q.START, 1.0)
    if start != 1.0:  # at a later visit
        if not made and wanted:
            what = f"start at visit {start}, after which there is no touch"
            raise BadFile(path, "head", what, f"Q{Q.START:d} = +1 or a later visit of the program")
        wanted = wanted[-len(made) :] if made else []
    if made != wanted:
        promised = f"touches {wanted[0]} to {wanted[-1]} in order" if wanted else "none: a dry run"
        where, found = touches[-1].line if touches else "file", f"{len(made)} touches before M30"
        raise BadFile(path, where, found, f"{promised}, as the head says")


def _probe(head: Heading, probe: Probe | None, path: Path) -> Probe:
    """The probe in the spindle, which must be the one that the program was made for."""
    if probe is None:
        return head.probe
    for what in ("radius", "length"):
        stated, actual = getattr(head.probe, what), getattr(probe, what)
        if abs(stated - actual) > 1e-5:
            raise BadFile(
                path,
                "head",
                f"a probe of {what} {stated:g} mm",
                f"{actual:g} mm, as in the spindle",
            )
    return head.probe
