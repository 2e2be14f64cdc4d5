"""Runs a program, as read from its text, on the exact twin: the true ball meets the true surface.

The axes go where the text sends them. At every touch the ball, displaced by all errors at the
actual readings, travels along the probing vector until it touches the B-spline or the sphere; what
the control then knows are the readings, which it prints through the masks into the log.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from enum import StrEnum

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign.contact_solver import ContactSolver, VirtualMachine
from matstd.probe_paths.campaign.disturbances import in_campaign
from matstd.probe_paths.control import (
    STATUS,
    Halt,
    Print,
    ProbeStep,
    ReadProgram,
    Result,
    Step,
    Value,
    step_times,
)
from matstd.probe_paths.plan import LINEAR, ProgramFrame, Sensor
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.record import Labels, Touches

CHANGEOVER = 60.0  # between two programs, s


class Outcome(StrEnum):
    """How a simulated program ended."""

    DONE = "done"
    NO_CONTACT = "no contact"
    IN_AIR = "contact in the air"


@dataclass(frozen=True, eq=False)
class VirtualRun:
    """What a program brought about."""

    program: ReadProgram
    q: Array  # readings at the trigger, (N, A); nan for touches without contact
    time: Array  # time of the trigger, s since the start of the campaign, (N,)
    feature: Labels  # what was touched, (N,)
    # what the ball ran into, (N,), values of `Meeting`; a contact is one with a surface
    meeting: np.ndarray
    reached: int  # number of touches tried before the program ended
    log: Mapping[str, str]
    outcome: Outcome
    end: float  # s since the start of the campaign

    def check_done(self) -> None:
        """Raise NotReachable for a program that stopped; its attribute `run` is this run."""
        if self.outcome is Outcome.DONE:
            return
        touch = self.program.touches[self.reached - 1]
        name, planned = self.feature[touch.index], self.program.features.get(touch.feature, "")
        what = f"touch {touch.number} on {planned} has no contact: the ball "
        what += f"{self.meeting[touch.index]}" + (f" ({name})" if name else "")
        if touch.is_air:
            what = f"the touch in the air meets {name or 'something'}"
        raise NotReachable(f"{self.program.path}: line {touch.line}: {what}", run=self)


def run_programs(
    programs: Sequence[ReadProgram],
    standard: Standard,
    machine: VirtualMachine,
    rng: np.random.Generator,
) -> list[VirtualRun]:
    """Run programs one after the other; a stopped one ends the campaign; raises DesignError."""
    solvers = []
    for program in programs:
        noise = rng.normal(0.0, 1.0, len(program.touches)) * machine.noise
        solvers.append(ContactSolver(program, standard, machine, noise))
    # a disturbance may depend on the touches of other programs
    planned = [] if machine.disturbance is None else _planned_touches(solvers)
    runs: list[VirtualRun] = []
    begin = 0.0
    for i, solver in enumerate(solvers):
        if machine.disturbance is not None:
            before, after = planned[:i], planned[i + 1 :]
            solver.disturbance = in_campaign(machine.disturbance, before, after)
        runs.append(_run(solver, begin))
        if runs[-1].outcome is not Outcome.DONE:
            break
        begin = runs[-1].end + CHANGEOVER
    return runs


def _planned_touches(solvers: Sequence[ContactSolver]) -> list[Touches]:
    """Touches of every program on a perfect machine."""
    planned: list[Touches] = []
    begin = 0.0
    for solver in solvers:
        times = begin + _step_times(solver)
        planned.append(solver.touches(times[solver.program.touch_rows]))
        begin = float(times[-1]) + CHANGEOVER
    return planned


def _step_times(contacts: ContactSolver) -> Array:
    machine, steps = contacts.machine, contacts.program.steps
    return step_times(machine.chain, steps, machine.clock, contacts.travel)


def _run(contacts: ContactSolver, begin: float) -> VirtualRun:
    """Solve the contacts, then execute the printing of the program."""
    program = contacts.program
    rows = program.touch_rows
    contacts.solve((begin + _step_times(contacts))[rows])
    contacts.classify()
    times = begin + _step_times(contacts)
    control = _Control(program, contacts, contacts.machine)
    outcome, reached, end = control.run(program.steps, times)
    return VirtualRun(
        program=program,
        q=np.where(contacts.is_contact[:, None], contacts.q, np.nan),
        time=times[rows],
        feature=contacts.feature,
        meeting=contacts.meeting,
        reached=reached,
        log=control.log,
        outcome=outcome,
        end=end,
    )


class _Control:
    """What the control knows and prints."""

    def __init__(
        self, program: ReadProgram, contacts: ContactSolver, machine: VirtualMachine
    ) -> None:
        self.program, self.contacts = program, contacts
        self.frame = ProgramFrame(machine.chain, program.heading.probe)
        self.dialect, self.begin = machine.dialect, machine.begin
        self.temperature = machine.temperature
        self.lines: dict[str, list[str]] = {}
        self.results = self._results()

    def _results(self) -> Array:
        """X, Y, Z and status of every touch as cycle 4 returns them, (N, 4)."""
        q = self.contacts.q
        out = np.empty((len(q), 4))
        frames = [self.frame] * len(q)
        if self.program.heading.is_tilted:
            frames = [self.frame.tilted(rotary) for rotary in q[:, self.frame.rotary]]
        for i, (letter, column) in enumerate(zip(LINEAR, self.frame.linear, strict=True)):
            values = zip(frames, q[:, column], strict=True)
            out[:, i] = [frame.coordinate(letter, v) for frame, v in values]
        if self.dialect.result_height == "gauge":
            out[:, 2] += self.frame.probe.tool_length
        out[:, STATUS] = np.where(self.contacts.is_contact, 0.0, -1.0)
        return out

    @property
    def log(self) -> Mapping[str, str]:
        """Text of every log file."""
        return {name: "\n".join(lines) + "\n" for name, lines in self.lines.items()}

    def run(self, steps: Sequence[Step], times: Array) -> tuple[Outcome, int, float]:
        """Print what the program prints; outcome, touches tried and time of the end."""
        tried, now = 0, float(times[0]) if len(times) else 0.0
        for step, time in zip(steps, times, strict=True):
            now = float(time)
            if isinstance(step, Print):
                self._print(step, now)
            elif isinstance(step, Halt):
                return Outcome.NO_CONTACT, tried, now
            elif isinstance(step, ProbeStep):
                tried += 1
                if bool(self.contacts.is_contact[step.index]) is step.is_air:
                    for branch in step.on_miss:
                        if isinstance(branch, Print):
                            self._print(branch, now)
                    return Outcome.IN_AIR if step.is_air else Outcome.NO_CONTACT, tried, now
        return Outcome.DONE, tried, now

    def _print(self, step: Print, now: float) -> None:
        values = {q: self._number(value, now) for q, value in step.values.items()}
        moment = self.begin + timedelta(seconds=int(now))
        lines = self.lines.setdefault(step.target, [])
        lines += [line.filled(values, moment) for line in step.lines if line.prints]

    def _number(self, value: Value | Sensor, now: float) -> float:
        if isinstance(value, Sensor):
            return (self.temperature(value.name, now) - value.offset) / value.factor
        return float(self.results[value.touch, value.part]) if isinstance(value, Result) else value
