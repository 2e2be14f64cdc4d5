"""Programs of a design on LinuxCNC from beginning to end: planned again, run, log evaluated."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign import VirtualMachine, check_moves, evaluate, read_program_of
from matstd.probe_paths.control import MAX_FEED, read_log, read_program
from matstd.probe_paths.emit import Feeds, ProgramSet, make_programs
from matstd.probe_paths.linuxcnc.machine_config import latch_error, latch_u, machine_files
from matstd.probe_paths.linuxcnc.replanned import shortened
from matstd.probe_paths.linuxcnc.session import machine_folder, run_on_linuxcnc
from matstd.probe_paths.linuxcnc.twin_contact import TwinContact
from matstd.twin.errors import DesignError
from matstd.twin.files import write_whole
from matstd.twin.frames import Array
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
