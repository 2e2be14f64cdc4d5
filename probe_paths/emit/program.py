"""A plan as programs: rotary axes by moves of their own, X Y Z from our own kinematics.

Every program starts from any state, sets what it reads, touches only after a retract and a pre-move
from the stated side, looks at the status of every touch, and is read back by the strict interpreter
before it is handed out.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from probe_paths.control import Clock, interpret, step_times
from probe_paths.emit.writer import Feeds, Writer
from probe_paths.language import LANGUAGES, Dialect, checked_name, head_mask, shared_masks
from probe_paths.plan import TouchPlan
from twin.files import write_whole


@dataclass(frozen=True)
class Program:
    """One program file.

    Attributes:
        name: Without its ending.
        ending: Of its file.
        text: Whole file.
        touches: How many it makes.
        duration: By the clock, s.
    """

    name: str
    ending: str
    text: str
    touches: int
    duration: float

    @property
    def file(self) -> str:
        """Name of its file."""
        return f"{self.name}{self.ending}"


@dataclass(frozen=True)
class ProgramSet:
    """Programs of one plan, and the masks that they print through, by file name."""

    programs: tuple[Program, ...]
    masks: dict[str, str]

    @property
    def duration(self) -> float:
        """Of all programs, s."""
        return sum(program.duration for program in self.programs)

    def write(self, folder: str | Path) -> list[Path]:
        """Write programs and masks into a folder; the paths of the programs, in order."""
        folder = Path(folder)
        programs = {program.file: program.text for program in self.programs}
        for name, text in {**self.masks, **programs}.items():
            newline = "\r\n" if "\r\n" in text else "\n"
            write_whole(folder / name, text.replace(newline, "\n"), newline=newline)
        return [folder / name for name in programs]


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
    dialect = dialect or Dialect()
    language = LANGUAGES[dialect.language]
    masks = shared_masks(language.LOG, dialect.log_decimals, plan.chain.rotary_axes)
    writer = Writer(plan, dialect, feeds or Feeds(), masks)
    parts = _parts(plan, writer.feeds.touches_per_file)
    programs = []
    for i, part in enumerate(parts):
        setup = "".join(c for c in plan.setup.name.upper() if c.isalnum() or c == "_")
        name = checked_name(f"{dialect.prefix}_{setup}_{i + 1}")
        masks[f"{name}.A"] = head_mask(language.LOG, name, writer.heading.log_lines)
        title = f"FREEFORM STANDARD, PART {i + 1} OF {len(parts)}"
        file = f"{name}{language.ENDING}"
        # the head states the duration, which is known once the program has been read back
        read_back = partial(_duration, file=file, masks=masks, writer=writer, clock=clock)
        duration = read_back(writer.text(name, title, part, 0.0))
        text = writer.text(name, title, part, duration)
        read_back(text)
        touches = int(np.isin(plan.visit, part).sum())
        programs.append(
            Program(
                name=name,
                ending=language.ENDING,
                text=text,
                touches=touches,
                duration=duration,
            )
        )
    if not language.HAS_MASKS:
        masks = {}
    return ProgramSet(tuple(programs), masks)


def _duration(
    text: str, file: str, masks: dict[str, str], writer: Writer, clock: Clock | None
) -> float:
    """Duration of a program, read back from its text."""
    plan = writer.plan
    data = text.encode("ascii")
    read = interpret(data, Path(file), masks.get, plan.chain, plan.probe, writer.dialect)
    travel = np.full(len(read.touches), plan.options.standoff)
    return float(step_times(plan.chain, read.steps, clock or Clock(), travel)[-1])


def _parts(plan: TouchPlan, touches_per_file: int) -> list[list[int]]:
    """Visits of each file: whole visits, as evenly as their sizes allow."""
    sizes = np.bincount(plan.visit, minlength=len(plan.visits))
    count = max(int(np.ceil(sizes.sum() / touches_per_file)), 1)
    before = np.cumsum(sizes) - sizes
    part = np.minimum(before * count // max(int(sizes.sum()), 1), count - 1)
    return [list(np.flatnonzero(part == i)) for i in range(count) if np.any(part == i)]
