"""A plan as iTNC 530 programs: rotary axes by L blocks, X Y Z from our own kinematics, cycle 4.

Every program starts from any state, sets what it reads, touches only after a retract and a pre-move
from the stated side, looks at the status of every touch, and is read back by the strict interpreter
before it is handed out.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from probe_paths.control import Clock, interpret, step_times
from probe_paths.emit.writer import Feeds, Writer
from probe_paths.language import Dialect, head_mask, shared_masks
from probe_paths.language import klartext as k
from probe_paths.plan import TouchPlan
from twin.files import write_whole


@dataclass(frozen=True)
class Program:
    """One program file.

    Attributes:
        name: Without its ending.
        text: Whole file, CRLF.
        touches: How many it makes.
        duration: By the clock, s.
    """

    name: str
    text: str
    touches: int
    duration: float


@dataclass(frozen=True)
class ProgramSet:
    """Programs of one plan and the masks that they print through, by file name."""

    programs: tuple[Program, ...]
    masks: dict[str, str]

    @property
    def duration(self) -> float:
        """Of all programs, s."""
        return sum(program.duration for program in self.programs)

    def write(self, folder: str | Path) -> list[Path]:
        """Write programs and masks into a folder; the paths of the programs, in order."""
        folder = Path(folder)
        for name, text in self.masks.items():
            write_whole(folder / name, text.replace(k.LINE_END, "\n"), newline=k.LINE_END)
        paths = [folder / f"{program.name}.H" for program in self.programs]
        for path, program in zip(paths, self.programs, strict=True):
            write_whole(path, program.text.replace(k.LINE_END, "\n"), newline=k.LINE_END)
        return paths


def make_programs(
    plan: TouchPlan,
    dialect: Dialect | None = None,
    feeds: Feeds | None = None,
    clock: Clock | None = None,
) -> ProgramSet:
    """Programs of a plan; they do not depend on when or where they are made.

    Args:
        plan: Of one set-up.
        dialect: Words of the control.
        feeds: Feeds, and the length of a file.
        clock: For the duration that the head states.

    Raises:
        BadFile: The strict interpreter does not accept what was written.
        DesignError: A name or number that cannot stand in a program.
    """
    writer = Writer(plan, dialect or Dialect(), feeds or Feeds())
    masks = shared_masks(writer.dialect, plan.chain.rotary_axes)
    parts = _parts(plan, writer.feeds.touches_per_file)
    programs = []
    for i, part in enumerate(parts):
        setup = "".join(c for c in plan.setup.name.upper() if c.isalnum() or c == "_")
        name = k.checked_name(f"{writer.dialect.prefix}_{setup}_{i + 1}")
        masks[f"{name}.A"] = head_mask(name, writer.heading.log_lines)
        title = f"FREEFORM STANDARD, PART {i + 1} OF {len(parts)}"
        # the head states the duration, which is known once the program has been read back
        duration = _duration(writer.text(name, title, part, 0.0), name, masks, plan, clock)
        text = writer.text(name, title, part, duration)
        _duration(text, name, masks, plan, clock)
        touches = int(np.isin(plan.visit, part).sum())
        programs.append(Program(name, text, touches, duration))
    return ProgramSet(tuple(programs), masks)


def _duration(
    text: str, name: str, masks: dict[str, str], plan: TouchPlan, clock: Clock | None
) -> float:
    """Duration of a program, read back from its text."""
    read = interpret(text.encode("ascii"), Path(f"{name}.H"), masks.get, plan.chain, plan.probe)
    travel = np.full(len(read.touches), plan.options.standoff)
    return float(step_times(plan.chain, read.steps, clock or Clock(), travel)[-1])


def _parts(plan: TouchPlan, touches_per_file: int) -> list[list[int]]:
    """Visits of each file: whole visits, as evenly as their sizes allow."""
    sizes = np.bincount(plan.visit, minlength=len(plan.visits))
    count = max(int(np.ceil(sizes.sum() / touches_per_file)), 1)
    before = np.cumsum(sizes) - sizes
    part = np.minimum(before * count // max(int(sizes.sum()), 1), count - 1)
    return [list(np.flatnonzero(part == i)) for i in range(count) if np.any(part == i)]
