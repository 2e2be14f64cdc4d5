"""Programs run on the twin, their logs read back and evaluated: text in, measurements out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign.as_programmed import with_program_lines
from matstd.probe_paths.campaign.collisions import check_moves
from matstd.probe_paths.campaign.contact_solver import VirtualMachine
from matstd.probe_paths.campaign.evaluation import evaluate
from matstd.probe_paths.campaign.stamps import check_program_stamp, read_program_of
from matstd.probe_paths.campaign.virtual_run import VirtualRun, run_programs
from matstd.probe_paths.control import LogPart, ReadProgram, read_log
from matstd.probe_paths.plan import Probe
from matstd.twin.compute import Progress, silent
from matstd.twin.record import Run


@dataclass(frozen=True, eq=False)
class Campaign:
    """All programs of one set-up or several, run one after the other."""

    run: Run
    runs: tuple[VirtualRun, ...]
    parts: tuple[LogPart, ...]  # parts of their logs, as read back
    begin: datetime  # what the clock said at the run's time zero

    @property
    def logs(self) -> Mapping[str, str]:
        """Text of every log file by name; a program that is run again appends to its log."""
        texts: dict[str, str] = {}
        for one in self.runs:
            for name, text in one.log.items():
                texts[name] = texts.get(name, "") + text
        return texts


def simulate_search(
    program: ReadProgram, standard: Standard, machine: VirtualMachine, rng: np.random.Generator
) -> VirtualRun:
    """What a search or a commissioning program does on the twin, with the log that it leaves.

    Raises:
        BadFile: A touch without contact, or a tool too close to an obstacle, where the
            standard is believed to stand.
        NotReachable: A touch that meets nothing where it stands.
        DesignError: A program made for another standard.
    """
    check_program_stamp(program, standard, believed=False)
    check_moves(program, standard, machine.chain)
    (run,) = run_programs([program], standard, machine, rng)
    run.check_done()
    return run


def simulate(
    programs: Sequence[str | Path | ReadProgram],
    standard: Standard,
    machine: VirtualMachine,
    rng: np.random.Generator,
    probe: Probe | None = None,
    progress: Progress = silent,
    calibrated: Standard | None = None,
) -> Campaign:
    """Run program files on the twin and evaluate the logs that they leave.

    Args:
        programs: Files, masks of `.H` files beside them, in the order in which they are run; one
            that is read already is taken for checked.
        machine: As it really is; the evaluation knows only its nominal chain.
        probe: In the spindle; None takes the one that each program states.
        calibrated: What is believed of the standard; None for the truth.

    Raises:
        BadFile: A program that the control, or a cautious operator, would not run.
        NotReachable: A touch without contact; the program stopped there.
        DesignError: A program made for another standard.
    """
    return visits(programs, standard, [machine], rng, probe, progress, calibrated)[0]


def visits(
    programs: Sequence[str | Path | ReadProgram],
    standard: Standard,
    machines: Sequence[VirtualMachine],
    rng: np.random.Generator,
    probe: Probe | None = None,
    progress: Progress = silent,
    calibrated: Standard | None = None,
) -> tuple[Campaign, ...]:
    """Run program files on the twin several times, the texts read and their moves checked once.

    Args:
        programs: Files; one that is read already is taken for checked.
        machines: As they really are at every visit: with other noise, the standard clamped again.

    Other arguments and errors as of `simulate`.
    """
    chain, dialect = machines[0].chain, machines[0].dialect
    believed = calibrated or standard
    texts = []
    for done, program in enumerate(programs):
        if not isinstance(program, ReadProgram):
            progress("moves of the programs", done, len(programs))
            program = read_program_of(believed, program, chain, probe, dialect)
            check_moves(program, believed, chain)
        texts.append(program)
    out = []
    for done, machine in enumerate(machines):
        progress("touches on the twin", done, len(machines))
        out.append(_campaign(texts, standard, machine, rng, believed))
    return tuple(out)


def _campaign(
    texts: Sequence[ReadProgram],
    standard: Standard,
    machine: VirtualMachine,
    rng: np.random.Generator,
    believed: Standard,
) -> Campaign:
    """All programs on one machine, and the run evaluated from their logs."""
    runs = run_programs(texts, standard, machine, rng)
    runs[-1].check_done()
    parts = [
        part
        for one in runs
        for name, text in one.log.items()
        for part in read_log(name, machine.chain.rotary_axes, text)
    ]
    u = machine.stated_u
    run = evaluate(parts, believed, machine.chain, u, machine.dialect)
    run = with_program_lines(run, {program.name: program for program in texts})
    begin = min(part.begin for part in parts if part.is_measuring)
    return Campaign(run, tuple(runs), tuple(parts), begin)
