"""A plan as programs: rotary axes by moves of their own, X Y Z from our own kinematics.

Every program starts from any state, sets what it reads, touches only after a retract and a pre-move
from the stated side, tests the status of every touch, and is read back by the strict interpreter
before it is returned.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from matstd.probe_paths.control import BALL, FIRST, Clock, ReadProgram, interpret, step_times
from matstd.probe_paths.emit.first import FirstWriter
from matstd.probe_paths.emit.writer import Feeds, Purpose, Writer
from matstd.probe_paths.language import LANGUAGES, Dialect, checked_name, head_mask, shared_masks
from matstd.probe_paths.plan import TouchPlan
from matstd.twin.display import Displayed
from matstd.twin.errors import DesignError
from matstd.twin.files import write_whole
from matstd.twin.frames import IntArray
from matstd.twin.units import DEG, MINUTE

DRY_RUN, SEARCH = "DRY", "LOC"
"""Last letters of the names of these programs; others have `BALL` and `FIRST`."""

SEARCH_FEED = 800.0
"""Feed of a search, mm/min: its touches are 100 mm long; the place is needed to 0.3 mm only."""


@dataclass(frozen=True, repr=False)
class Program(Displayed):
    """One program file."""

    name: str
    ending: str
    text: str
    touches: int
    duration: float  # by the clock, s
    read: ReadProgram = field(compare=False)  # what the interpreter understood of it

    @property
    def blocks(self) -> int:
        """Number of its blocks."""
        return sum(line[:1].isdigit() for line in self.text.splitlines())

    @property
    def file(self) -> str:
        """Name of its file."""
        return f"{self.name}{self.ending}"


@dataclass(frozen=True, repr=False)
class ProgramSet(Displayed):
    """Programs of one plan."""

    programs: tuple[Program, ...]
    masks: dict[str, str]

    @property
    def duration(self) -> float:
        """Duration of all programs, s."""
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

    Raises:
        BadFile: The strict interpreter does not accept what was written.
        DesignError: A name or number that cannot stand in a program.
    """
    maker = _Maker(plan, dialect, feeds, clock=clock)
    limits, sizes = maker.writer.feeds, np.bincount(plan.visit, minlength=len(plan.visits))
    stretch = np.array([visit.stretch for visit in plan.visits])
    count = max(int(np.ceil(sizes.sum() / limits.touches_per_file)), 1)
    while True:
        parts = _parts(sizes, count, stretch)
        made = maker.made(parts)
        too_long = [
            program.duration > limits.minutes_per_file * MINUTE and len(part) > 1
            for program, part in zip(made.programs, parts, strict=True)
        ]
        if not any(too_long):
            return made
        count += 1


def make_dry_run(
    plan: TouchPlan, raised: float, dialect: Dialect | None = None, feeds: Feeds | None = None
) -> ProgramSet:
    """One program that goes where a plan's programs go, higher, and touches nothing.

    Args:
        raised: By how much, mm; moves that would end above the retract end there.
    """
    return _one_program(plan, Purpose(DRY_RUN, raised=raised), dialect, feeds)


def make_search(
    plan: TouchPlan,
    within: tuple[float, float],
    dialect: Dialect | None = None,
    feeds: Feeds | None = None,
) -> ProgramSet:
    """One program that comes down on a standard from above wherever it stands.

    Args:
        within: How far beside its place the standard may stand, mm and rad.
    """
    feeds = replace(feeds or Feeds(), probing=SEARCH_FEED)
    mm, angle = within
    stands = f"SEARCH FROM ABOVE, STANDS WITHIN {mm:.1f} MM AND {angle / DEG:.2f} DEG"
    return _one_program(plan, Purpose(SEARCH, (stands,)), dialect, feeds)


def make_ball(
    plan: TouchPlan, dialect: Dialect | None = None, feeds: Feeds | None = None
) -> ProgramSet:
    """One program that measures a ball of the standard, before the others and after them."""
    purpose = Purpose(BALL, (f"PROBE ON BALL {plan.feature[0]}, BEFORE AND AFTER THE OTHERS",))
    return _one_program(plan, purpose, dialect, feeds)


def make_first(
    plan: TouchPlan, dialect: Dialect | None = None, feeds: Feeds | None = None
) -> ProgramSet:
    """The program that a control is tried with: one touch in the air and one on a ball.

    Args:
        plan: Touches on one ball, with the rotary axes at home.

    Raises:
        NotReachable: The ball is touched at another pose than home, or not from above.
        DesignError: A control of another language.
    """
    if dialect is not None and not LANGUAGES[dialect.language].has_masks:
        raise DesignError(f"a commissioning program in {dialect.language}: expected klartext")
    remark = f"COMMISSIONING: ONE TOUCH IN AIR, ONE ON BALL {plan.feature[0]}"
    return _one_program(plan, Purpose(FIRST, (remark,), is_first=True), dialect, feeds)


def _one_program(
    plan: TouchPlan, purpose: Purpose, dialect: Dialect | None, feeds: Feeds | None
) -> ProgramSet:
    """All visits of a plan in one program."""
    return _Maker(plan, dialect, feeds, purpose).made([list(range(len(plan.visits)))])


class _Maker:
    """Makes programs of parts of a plan, each read back before it is returned."""

    def __init__(
        self,
        plan: TouchPlan,
        dialect: Dialect | None,
        feeds: Feeds | None,
        purpose: Purpose | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.plan, self.dialect, self.clock = plan, dialect or Dialect(), clock or Clock()
        self.purpose, self.language = purpose or Purpose(), LANGUAGES[self.dialect.language]
        form, rotary = self.language.log, plan.chain.rotary_axes
        self.shared = shared_masks(form, self.dialect.log_decimals, rotary, self.dialect.sensors)
        self.masks = dict(self.shared)
        written_by = FirstWriter if self.purpose.is_first else Writer
        self.writer = written_by(plan, self.dialect, feeds or Feeds(), self.masks, self.purpose)

    def made(self, parts: list[list[int]]) -> ProgramSet:
        """One program of each part, and mask files where the control has them."""
        setup = "".join(c for c in self.plan.setup.name.upper() if c.isalnum() or c == "_")
        programs, before = [], self.plan.visits[parts[0][0]].stretch
        for number, part in enumerate(parts, start=1):
            title = f"FREEFORM STANDARD, PART {number} OF {len(parts)}"
            stretch = self.plan.visits[part[0]].stretch
            title, before = title + ", AFTER STANDSTILL" * (stretch != before), stretch
            ending = self.purpose.ending or str(number)
            name = checked_name(f"{self.dialect.prefix}_{setup}_{ending}")
            programs.append(self._program(name, title, part))
        is_dry = self.purpose.raised is not None
        if is_dry or not self.language.has_masks:
            return ProgramSet(tuple(programs), {})
        # the commissioning program prints its whole log with a mask of its own
        unused = self.shared if self.purpose.is_first else ()
        masks = {name: text for name, text in self.masks.items() if name not in unused}
        return ProgramSet(tuple(programs), masks)

    def _program(self, name: str, title: str, part: list[int]) -> Program:
        form, remarks = self.language.log, self.writer.heading.log_lines
        rotary = self.plan.chain.rotary_axes if self.purpose.is_first else None
        self.masks[f"{name}.A"] = head_mask(form, name, remarks, rotary, self.dialect.log_decimals)
        # the head states the duration, which is known once the program has been read back
        first = self.writer.text(name, title, part, 0.0)
        read = self._read(name, first)
        duration = self._duration(read)
        text = self.writer.text(name, title, part, duration)
        if not _is_same_but_for_a_remark(first, text):
            read = self._read(name, text)
        touches = 0 if self.purpose.raised is not None else np.isin(self.plan.visit, part).sum()
        return Program(
            name=name,
            ending=self.language.ending,
            text=text,
            touches=1 if self.purpose.is_first else int(touches),
            duration=duration,
            read=read,
        )

    def _read(self, name: str, text: str) -> ReadProgram:
        plan, path = self.plan, Path(f"{name}{self.language.ending}")
        data, masks = text.encode("ascii"), self.masks.get
        return interpret(data, path, masks, plan.chain, plan.probe, self.dialect)

    def _duration(self, read: ReadProgram) -> float:
        plan = self.plan
        # the contacts of a search are unknown: every touch takes its longest path
        travel = np.full(len(read.touches), plan.options.standoff)
        travel = np.full(len(travel), plan.distance) if read.is_search else travel
        return float(step_times(plan.chain, read.steps, self.clock, travel)[-1])


def _is_same_but_for_a_remark(text: str, other: str) -> bool:
    """Whether two programs differ at most in the remark of one line."""
    lines, others = text.splitlines(), other.splitlines()
    changed = [pair for pair in zip(lines, others, strict=False) if pair[0] != pair[1]]
    before = [{line.partition(";")[0] for line in pair} for pair in changed]
    return len(lines) == len(others) and len(changed) <= 1 and all(len(b) == 1 for b in before)


def _parts(sizes: IntArray, count: int, stretch: IntArray) -> list[list[int]]:
    """Whole visits for each of `count` files, distributed evenly; a standstill ends a file."""
    before = np.cumsum(sizes) - sizes
    part = np.minimum(before * count // max(int(sizes.sum()), 1), count - 1) + stretch * count
    return [list(np.flatnonzero(part == i)) for i in np.unique(part)]
