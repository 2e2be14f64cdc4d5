"""The exact twin, asked where a stroke that has begun will meet the surface."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign import ContactSolver, VirtualMachine, in_campaign
from matstd.probe_paths.control import LogPart, ReadProgram, step_times
from matstd.probe_paths.plan import ProgramFrame
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.record import Touches
from matstd.twin.units import UM

_ON_LINE = 0.1 * UM
"""How far beside the line of a programmed touch the axes may stand, mm, or as much in mrad: digits
of a program, and of a position that was read back."""


@dataclass(frozen=True)
class Stroke:
    """One stroke that the twin was asked about."""

    number: int
    # readings where the true ball meets the true surface, (A,); nan where it does not
    contact: Array
    direction: Array  # direction of the motion in readings, (A,)


class TwinContact:
    """Decides every contact from joint positions, with all errors and the true surfaces."""

    def __init__(
        self,
        programs: Sequence[ReadProgram],
        standard: Standard,
        machine: VirtualMachine,
        rng: np.random.Generator,
    ) -> None:
        self.standard, self.machine = standard, machine
        self.touches = [(program, touch) for program in programs for touch in program.touches]
        self.noise = rng.normal(0.0, 1.0, len(self.touches)) * machine.noise
        chain = machine.chain
        frame = ProgramFrame(chain, programs[0].heading.probe)
        self.letters = sorted(frame.letters, key="XYZABC".index)
        self.columns = [chain.axis_index(a) for a in self.letters]
        self.units = np.array([chain.link(a).unit for a in self.letters])
        self.begin = time.monotonic()
        self.strokes: list[Stroke] = []
        self.failure = ""
        self.late: list[tuple[int, float]] = []  # place in strokes, mm
        self.made: dict[int, Touches] = {}
        self.planned = [t for program in programs for t in _planned(program, standard, machine)]

    def travel(self, joints: Sequence[float], direction: Sequence[float]) -> float | None:
        """Way from joint positions to the contact along a direction, mm; None for no contact.

        Args:
            joints: Positions of the control's joints, mm and degrees.

        Raises:
            DesignError: No programmed touch goes along this line.
        """
        q = np.zeros(len(self.machine.chain.axes))
        q[self.columns] = np.array(joints) * self.units
        way = np.zeros(len(q))
        way[self.columns[:3]] = direction
        row, along = self._programmed(q, way)
        program, step = self.touches[row]
        # from the start of the programmed touch: the second stroke begins within the errors
        touch = replace(step, q=q - along * way, direction=way, index=0, on_miss=[])
        alone, noise = replace(program, steps=(touch,)), self.noise[[row]]
        solver = ContactSolver(alone, self.standard, self._machine_at(row), noise)
        now = np.array([time.monotonic() - self.begin])
        solver.solve(now)
        solver.classify()
        self.made[row] = solver.touches(now)
        met = bool(solver.is_contact[0])
        reached = solver.q[0] if met else np.full(len(q), np.nan)
        self.strokes.append(Stroke(step.number, reached, way))
        return float(solver.travel[0]) - along if met else None

    def arrived_late(self, beyond: float) -> None:
        """The axes were already beyond the contact of the last stroke by so much, mm."""
        self.late.append((len(self.strokes) - 1, beyond))

    def check_in_time(self) -> None:
        """Raise DesignError where the computer was too busy to arm the probe before a contact."""
        last = {stroke.number: i for i, stroke in enumerate(self.strokes)}
        late = [(self.strokes[i].number, mm) for i, mm in self.late if i in last.values()]
        if late:
            number, beyond = max(late, key=lambda pair: pair[1])
            raise DesignError(
                f"{len(late)} touches were past their contact before the probe knew it, touch "
                f"{number} by {beyond / UM:.1f} µm: the computer was too busy, run it again"
            )

    def latched(self, parts: Sequence[LogPart]) -> Array:
        """How far the logged position of every touch lies beyond the twin's contact, (N,), mm.

        Along its stroke; of two strokes of a touch the last one counts.
        """
        last = {stroke.number: stroke for stroke in self.strokes}
        frame = ProgramFrame(self.machine.chain, self.touches[0][0].heading.probe)
        out = []
        for part in parts:
            for number, xyz in zip(part.number, part.xyz, strict=True):
                stroke = last[int(number)]
                z = xyz[2] - part.tool_length
                words = zip("XYZ", (xyz[0], xyz[1], z), strict=True)
                logged = np.array([frame.reading(a, float(v)) for a, v in words])
                columns = self.columns[:3]
                out.append((logged - stroke.contact[columns]) @ stroke.direction[columns])
        return np.array(out)

    def _programmed(self, q: Array, way: Array) -> tuple[int, float]:
        """Row of the touch along whose line the axes go, and how far along they have come, mm.

        An anchor is touched again along the very same line: the next one in order counts.
        """
        start = np.array([touch.q for _, touch in self.touches])
        along = (q - start) @ way
        beside = np.linalg.norm(q - start - along[:, None] * way, axis=1)
        turned = np.array([np.linalg.norm(touch.direction - way) for _, touch in self.touches])
        longest = np.array([touch.distance for _, touch in self.touches])
        wrong = (along < -_ON_LINE) | (along > longest) | (turned > 1e-3)
        off = np.where(wrong, np.inf, beside)
        same = np.flatnonzero(off <= off.min() + 1e-3 * _ON_LINE)
        row = int(next((k for k in same if k >= max(self.made, default=0)), same[0]))
        if wrong[row] or beside[row] > _ON_LINE:
            here = np.round(q[self.columns] / self.units, 4).tolist()
            along_it = np.round(way[self.columns[:3]], 4).tolist()
            found = f"LinuxCNC probes from {here} along {along_it}"
            raise DesignError(f"{found}, where no programmed touch begins")
        return row, float(along[row])

    def _machine_at(self, row: int) -> VirtualMachine:
        """The machine at this touch, between the touches already made and those planned."""
        disturbance = self.machine.disturbance
        if disturbance is None:
            return self.machine
        before = [self.made[k] for k in sorted(self.made) if k < row]
        between = in_campaign(disturbance, before, self.planned[row + 1 :])
        return replace(self.machine, disturbance=between)


def _planned(program: ReadProgram, standard: Standard, machine: VirtualMachine) -> list[Touches]:
    """Touches of a program on a perfect machine, one by one."""
    solver = ContactSolver(program, standard, machine, np.zeros(len(program.touches)))
    times = step_times(machine.chain, program.steps, machine.clock, solver.travel)
    touches = solver.touches(times[program.touch_rows])
    return [touches[i : i + 1] for i in range(len(touches))]
