"""Programs of a design on LinuxCNC from beginning to end: planned again, run, log evaluated."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign import (
    VirtualMachine,
    check_moves,
    evaluate,
    foot_points,
    read_program_of,
)
from matstd.probe_paths.control import (
    MAX_FEED,
    Move,
    ProbeStep,
    ReadProgram,
    read_log,
    read_program,
)
from matstd.probe_paths.emit import Feeds, ProgramSet, make_programs
from matstd.probe_paths.linuxcnc.machine_config import latch_error, latch_u, machine_files
from matstd.probe_paths.linuxcnc.session import machine_folder, run_on_linuxcnc
from matstd.probe_paths.linuxcnc.twin_contact import TwinContact
from matstd.probe_paths.plan import LINEAR, PlanOptions, TouchPlan, Visit
from matstd.twin.errors import DesignError
from matstd.twin.files import write_whole
from matstd.twin.frames import Array, IntArray, apply, inverse
from matstd.twin.machine import Chain, tip
from matstd.twin.record import Run


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """What LinuxCNC measured."""

    run: Run
    u: float  # standard uncertainty of every touch, noise and latch, mm
    latched: Array  # how far each logged position lies beyond the twin's contact, (N,), mm
    modelled: float  # how far it may at most, mm


def rehearse(
    files: Sequence[Path],
    standard: Standard,
    machine: VirtualMachine,
    rng: np.random.Generator,
    out: Path,
    count: int | None = None,
    user: str = "",
    announce: Callable[[ProgramSet], None] = lambda made: None,
) -> Rehearsal:
    """Run programs of one set-up on LinuxCNC; programs and logs stay in a folder, come what may.

    Args:
        machine: As it really is; its dialect is that of LinuxCNC.
        count: Touches that are made; None for all.

    Raises:
        DesignError: A control that stopped, died or was too busy; the folder says how far it came.
        BadFile: A program that no cautious operator would start.
    """
    chain, dialect = machine.chain, machine.dialect
    given = [read_program_of(standard, path, chain) for path in files]
    # feeds near nothing that is measured: as high as a program may state them
    feeds = Feeds(approach=MAX_FEED, turning=MAX_FEED)
    made = make_programs(shortened(given, standard, chain, count), dialect, feeds)
    programs = [read_program(path, chain) for path in made.write(out)]
    for program in programs:
        check_moves(program, standard, chain)
    contact = TwinContact(programs, standard, machine, rng)
    announce(made)
    folder = machine_folder(user)
    try:
        config = machine_files(chain, programs[0].heading.probe, dialect, str(folder / "probe"))
        session = run_on_linuxcnc(made.programs, config, contact, folder / "probe", user)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    for name, text in {**session.logs, "linuxcnc.txt": session.said}.items():
        write_whole(out / name, text)
    if session.outcome:
        raise DesignError(f"{session.outcome}; what was logged is kept in {out}")
    contact.check_in_time()
    parts = [p for name in session.logs for p in read_log(out / name, chain.rotary_axes)]
    slow = programs[0].touches[0].slow_feed
    u = float(np.hypot(machine.stated_u, latch_u(slow)))
    run = evaluate(parts, standard, chain, u, dialect)
    return Rehearsal(run, u, contact.latched(parts), latch_error(slow))


def shortened(
    programs: Sequence[ReadProgram], standard: Standard, chain: Chain, count: int | None = None
) -> TouchPlan:
    """The plan that programs of one set-up carry out, or every so many-th touch of it.

    Args:
        count: How many touches are kept, spread evenly over all; None for all.

    Raises:
        DesignError: No touch, or none is to be kept.
    """
    all_touches = [touch for program in programs for touch in program.touches]
    if count is not None and count < 1:
        raise DesignError(f"{count} touches: expected at least 1")
    many = len(all_touches) if count is None else min(count, len(all_touches))
    kept = set(np.round(np.linspace(0, len(all_touches) - 1, many)).astype(int).tolist())
    stops = [stop for program in programs for stop in _stops(program, chain)]
    touches: list[ProbeStep] = []
    visits: list[Visit] = []
    visit: list[int] = []
    row = 0
    for stop, made in stops:
        mine = [t for i, t in enumerate(made, start=row) if i in kept]
        row += len(made)
        if mine:
            visit += [len(visits)] * len(mine)
            visits.append(stop)
            touches += mine
    names = {n: name for program in programs for n, name in program.features.items()}
    return _plan(programs[0], standard, chain, touches, visits, np.array(visit), names)


def _plan(
    program: ReadProgram,
    standard: Standard,
    chain: Chain,
    touches: Sequence[ProbeStep],
    visits: Sequence[Visit],
    visit: IntArray,
    names: dict[int, str],
) -> TouchPlan:
    heading, first = program.heading, touches[0]
    assert heading.workshop is not None, "no program is read without it"
    start = np.array([t.q for t in touches])
    way = np.array([t.direction for t in touches])
    contact = start + first.back * way
    feature = np.array([names[t.feature] for t in touches])
    ball = tip(chain, contact, heading.probe.length)
    ball = apply(inverse(heading.setup.T_table_artefact), ball)
    point, normal = foot_points(standard, feature, ball)
    # programs retract to their highest Z
    z = chain.axis_index("Z")
    retracted = np.nanmax([step.q[z] for step in program.steps if isinstance(step, Move)])
    options = PlanOptions(
        standoff=first.back,
        search=first.distance - first.back,
        retract=chain.link("Z").range[1] - float(retracted),
        workshop=heading.workshop,
    )
    return TouchPlan(
        chain=chain,
        probe=heading.probe,
        standard=standard,
        setup=heading.setup,
        options=options,
        visits=tuple(visits),
        visit=visit,
        request=np.arange(len(touches)),
        feature=feature,
        point=point,
        normal=normal,
        start=start,
        contact=contact,
        direction=way[:, [chain.axis_index(a) for a in LINEAR]],
    )


def _stops(program: ReadProgram, chain: Chain) -> list[tuple[Visit, list[ProbeStep]]]:
    """Visits of a program in order, each with its touches."""
    rotary, z = chain.rotary_columns, chain.axis_index("Z")
    found: list[tuple[Visit, list[ProbeStep]]] = []
    here: Array | None = None
    before, is_new = np.zeros(len(rotary)), True
    height: float | None = None
    for step in program.steps:
        if isinstance(step, Move):
            if here is not None and np.any(step.q[rotary] != here[rotary]):
                before, is_new, height = here[rotary], True, None
            elif height is None and here is not None and step.q[z] < here[z]:
                height = float(step.q[z])  # the first move down goes to the clearance height
            here = step.q
        elif isinstance(step, ProbeStep):
            if is_new:
                assert height is not None, "no touch without a move down"
                q = step.q[rotary]
                stop = Visit(
                    pose=step.pose - 1,
                    rotary=q,
                    side=step.side[rotary],
                    before=before,
                    rows=np.zeros(0, dtype=np.int64),
                    height=height,
                )
                found.append((stop, []))
                is_new = False
            found[-1][1].append(step)
            here = step.q
    return found
