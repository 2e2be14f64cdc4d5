"""Programs planned again: for where the standard stands, as logs show it, or for a visit."""

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from matstd.api.saved import REPORT_FILES
from matstd.artefact.body import Standard, read_standard
from matstd.artefact.reach import DatumBall
from matstd.options import SHEET, SHEET_FILES, asked_printer
from matstd.probe_paths.campaign import (
    VirtualMachine,
    ball_centres,
    check_moves,
    checked_parts,
    evaluate,
    read_program_of,
    simulate,
)
from matstd.probe_paths.control import (
    BALL,
    LogPart,
    Move,
    ProbeStep,
    ReadProgram,
    read_log,
    read_program,
)
from matstd.probe_paths.emit import SEARCH, Feeds, ProgramSet, make_programs
from matstd.probe_paths.language import Dialect, language_of, read_dialect
from matstd.probe_paths.locate import PlannedVisit, Spread, find_standard, planned_again, read_visit
from matstd.probe_paths.stations import Station, all_programs
from matstd.report.laws import made_on_twin, visit_conditions
from matstd.report.pages import Printer
from matstd.report.words import located_lines
from matstd.stages.sheets import write_sheets
from matstd.twin.display import Displayed
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_machine, results_folder
from matstd.twin.machine import Chain
from matstd.twin.record import Setup
from matstd.twin.units import DEG, MINUTE, UM

SEED = 0  # of the places that are tried first: the same log gives the same programs
ROUGH_UNCERTAINTY = 1.0 * UM
"""Uncertainty of a touch where only the place of the standard is asked for, mm."""
OURS = (*REPORT_FILES, *SHEET_FILES, "programs/*")  # files that not every replan leaves


@dataclass(frozen=True, eq=False, repr=False)
class Replanned(Displayed):
    """Programs for where the standard stands; `replan` and `planned_visit` return it.

    Example:
        >>> found = replan(["logs/MS_A_1.TXT"], ".")
        >>> found.left_alone
        ()
    """

    design: Path  # folder of the design
    setup: Setup  # where the standard stands
    stations: tuple[Station, ...]  # plans and programs of every probe
    feeds: Feeds  # of the programs
    lines: tuple[str, ...]  # sentences on the place that was found, or on how a visit is made
    left_alone: tuple[str, ...]  # set-ups whose programs stay as they are
    conditions: tuple[str, ...] = ()  # in which the programs of a visit are to run, for the sheet

    @property
    def programs(self) -> ProgramSet:
        """Programs of all probes."""
        return all_programs(self.stations)

    def save(self, folder: str | Path, pdf: bool = False, force: bool = False) -> None:
        """Write programs and set-up sheet into a folder, whole or not at all.

        Args:
            folder: New or empty.
            pdf: Print the sheet, too.
            force: Replace the results of an earlier run.
        """
        printed_by = asked_printer(pdf)
        with results_folder(folder, force, OURS) as place:
            self.write(place, printed_by)

    def write(self, folder: Path, printed_by: Printer | None = None) -> None:
        """Write programs and set-up sheet into a folder that is there."""
        for name in ("machine.toml", "standard.toml"):
            shutil.copyfile(self.design / name, folder / name)
        self.programs.write(folder / "programs")
        sheets = folder / SHEET
        write_sheets(sheets, self.stations, self.feeds, printed_by, conditions=self.conditions)


def replan(
    logs: Sequence[str | Path],
    design: str | Path,
    *,
    control: str | None = None,
    distance: float | None = None,
    angle: float | None = None,
) -> Replanned:
    """Plan the programs of a design again for where the standard stands, as logs show it.

    Args:
        logs: Of the search for the standard, or of programs that ran beside their place.
        design: Folder of a design, or of an earlier replan.
        control: Whose words the programs have; that of the programs of the design without it.
        distance: Largest expected offset of the standard from its planned place, mm.
        angle: Largest expected rotation, rad.

    Raises:
        BadFile: A folder without programs, or a file that cannot be read.
        DesignError: Logs of several set-ups.
        NotReachable: The standard is not found, or cannot be probed where it stands.

    Example:
        >>> found = replan(["logs/MS_A_1.TXT"], ".")
        >>> sum(program.touches for program in found.programs.programs)
        33
    """
    design = Path(design)
    made_for = spread_of(design)
    spread = Spread(
        made_for.distance if distance is None else distance,
        made_for.angle if angle is None else angle,
    )
    chain = read_machine(design / "machine.toml")
    standard = read_standard(design / "standard.toml")
    files = programs_of(design)
    words = _dialect(control, files[0])
    programs = [read_program_of(standard, file, chain, None, words) for file in files]
    parts = [part for log in logs for part in read_log(log, chain.rotary_axes)]
    here, others = of_one_setup(programs, parts)
    setup, lines = _place(parts, standard, chain, words, spread)
    stations = _stations(by_probe(here, control), standard, chain, setup)
    return Replanned(
        design=design,
        setup=setup,
        stations=tuple(stations),
        feeds=feeds_of(programs, chain),
        lines=tuple(lines),
        left_alone=tuple(others),
    )


def planned_visit(
    touches: str | Path, design: str | Path, *, control: str | None = None
) -> Replanned:
    """Programs of a planned visit: its touches, in its order, from its sides.

    Args:
        touches: `next_visit.csv` of `learn` or `diagnose`, or a plan of a diagnosis.
        design: Folder of the design whose programs made the run, or of a replan.
        control: Whose words the programs have; that of the programs of the design without it.

    Raises:
        BadFile: A folder without programs, or a file that cannot be read.
        DesignError: A set-up that no program has.
        NotReachable: More touches cannot be made than may be dropped.
    """
    design = Path(design)
    chain = read_machine(design / "machine.toml")
    standard = read_standard(design / "standard.toml")
    visits, schedule = read_visit(touches, chain, standard)
    files = programs_of(design)
    words = _dialect(control, files[0])
    programs = [read_program(file, chain, dialect=words) for file in files]
    names = list(dict.fromkeys(program.heading.setup.name for program in programs))
    if missing := [name for name in visits if name not in names]:
        found = f"set-up {', '.join(missing)}"
        raise BadFile(touches, "setup", found, f"one that programs are for: {', '.join(names)}")
    stations = []
    for name, visit in visits.items():
        here = [program for program in programs if program.heading.setup.name == name]
        words, first = next(iter(by_probe(here, control).items()))
        words = words.of_visit(f"{name}_{SEARCH}")
        stations += _stations({words: first}, standard, chain, here[0].heading.setup, visit)
    resumed = _after_standstill(stations)
    conditions = visit_conditions(schedule, resumed)
    return Replanned(
        design=design,
        setup=stations[0].plan.setup,
        stations=tuple(stations),
        feeds=feeds_of(programs, chain),
        lines=(made_on_twin(*_on_twin(stations, chain)), *conditions),
        left_alone=(),
        conditions=tuple(conditions),
    )


def _on_twin(stations: Sequence[Station], chain: Chain) -> tuple[int, float]:
    """Touches that the programs make on the twin, every move checked, and their duration, s."""
    touches, duration = 0, 0.0
    for one in stations:
        programs = [program.read for program in one.programs.programs]
        for program in programs:
            check_moves(program, one.plan.standard, chain)
        rng = np.random.default_rng(SEED)
        made = simulate(programs, one.plan.standard, VirtualMachine(chain), rng)
        touches += len(made.run)
        duration += sum(program.duration for program in one.programs.programs)
    return touches, duration


def _after_standstill(stations: Sequence[Station]) -> str:
    """Name of the first program after the standstill; "" without one."""
    for one in stations:
        stretch = np.array([visit.stretch for visit in one.plan.visits])[one.plan.visit]
        ends = np.cumsum([program.touches for program in one.programs.programs])
        for program, end in zip(one.programs.programs, ends, strict=True):
            if stretch[end - 1] > 0:
                return program.name
    return ""


def of_one_setup(
    programs: list[ReadProgram], parts: list[LogPart]
) -> tuple[list[ReadProgram], list[str]]:
    """Programs of the set-up that logs are of, and the names of the other set-ups.

    Raises:
        DesignError: Logs of several set-ups, or of one that no program has.
    """
    logged = list(dict.fromkeys(part.heading.setup.name for part in parts))
    names = list(dict.fromkeys(program.heading.setup.name for program in programs))
    if len(logged) != 1 or logged[0] not in names:
        raise DesignError(
            f"{parts[0].path}: logs of set-up {', '.join(logged)}, expected those of one of the "
            f"set-ups that the programs are for: {', '.join(names)}"
        )
    here = [program for program in programs if program.heading.setup.name == logged[0]]
    return here, [name for name in names if name != logged[0]]


def _stations(
    programs: Mapping[Dialect, list[ReadProgram]],
    standard: Standard,
    chain: Chain,
    setup: Setup,
    visit: PlannedVisit | None = None,
) -> list[Station]:
    """The programs of every probe, planned again for where the standard stands."""
    out = []
    for words, mine in programs.items():
        ball = _ball_of(mine[0], words, chain)
        plan = planned_again(mine, standard, chain, setup, ball, visit)
        out.append(Station(plan, words, make_programs(plan, words, feeds_of(mine, chain))))
    return out


def _ball_of(program: ReadProgram, words: Dialect, chain: Chain) -> DatumBall | None:
    """The ball on the table, as the program that touches it states it."""
    file = program.path.parent.parent / SHEET / f"{program.name.rpartition('_')[0]}_{BALL}.H"
    return read_program(file, chain, dialect=words).heading.ball if file.exists() else None


def by_probe(programs: list[ReadProgram], control: str | None) -> dict[Dialect, list[ReadProgram]]:
    """Programs by the words, with tool and first letters, that they were written with."""
    found: dict[Dialect, list[ReadProgram]] = {}
    for program in programs:
        words, head = _dialect(control, program.path), program.heading
        if words.language == "klartext":
            tilted = head.is_tilted and words.has_planes
            words = replace(words, is_tilted=tilted, sensors=head.sensors)
        found.setdefault(words, []).append(program)
    return found


def programs_of(design: Path) -> list[Path]:
    """Programs of a design in the order in which they are run; raises BadFile for none."""
    folder = design / "programs"
    found = [p for p in folder.glob("*") if p.suffix.lower() in (".h", ".ngc")]
    if not found:
        raise BadFile(folder, "folder", "no program", "the folder that `matstd design` made")
    return sorted(found, key=lambda p: (len(p.name), p.name))


def spread_of(design: Path) -> Spread:
    """Within which the search of a design finds the standard, as its program states."""
    for program in sorted((design / SHEET).glob(f"*_{SEARCH}.*")):
        text = program.read_text(encoding="ascii", errors="replace")
        if stated := re.search(r"STANDS WITHIN ([\d.]+) MM AND ([\d.]+) DEG", text):
            return Spread(float(stated[1]), float(stated[2]) * DEG)
    return Spread()


def _place(
    parts: Sequence[LogPart], standard: Standard, chain: Chain, dialect: Dialect, spread: Spread
) -> tuple[Setup, list[str]]:
    """Where the standard stands, and sentences on it."""
    believed = parts[0].heading.setup
    is_search = [part.program.endswith(SEARCH) for part in parts]
    if not any(is_search):
        run = evaluate(parts, standard, chain, ROUGH_UNCERTAINTY, dialect)
        found = run.touches.setups[0]
        return found, list(located_lines(believed, found))
    searches = [part for part, is_one in zip(parts, is_search, strict=True) if is_one]
    searches, remarks = checked_parts(searches, standard, chain)
    part = searches[-1]
    balls = ball_centres(part, chain, dialect)
    rng = np.random.default_rng(SEED)
    made = find_standard(standard, believed, balls, part.radius, rng, spread)
    lines = located_lines(believed, made.setup, made)
    return made.setup, [*(f"- {remark}" for remark in remarks), *lines]


def _dialect(control: str | None, program: Path) -> Dialect:
    """Words of the control, with tool, preset and folder of a program that was made for it."""
    name = control or ("linuxcnc" if language_of(program).ending != ".H" else "itnc530")
    dialect, text = read_dialect(name), program.read_text(encoding="ascii", errors="replace")
    if tool := re.search(r";TOOL (\d+) IS THE PROBE", text):
        dialect = replace(dialect, tool=int(tool[1]))
    if prefix := re.match(r"(.+?)_[A-Z0-9_]+_\d+\Z", program.stem.upper()):
        dialect = replace(dialect, prefix=prefix[1])
    if preset := re.search(r";PRESET (\d+):", text):
        dialect = replace(dialect, preset=int(preset[1]))
    if folder := re.search(r"F-PRINT (\S+)\\[A-Z0-9_]+\.A ", text):
        dialect = replace(dialect, folder=folder[1])
    return dialect


def feeds_of(programs: list[ReadProgram], chain: Chain) -> Feeds:
    """Feeds of programs: of touches, of moves down to them, of the last turn to a pose."""
    rotary = chain.rotary_columns
    feeds = Feeds(probing=programs[0].touches[0].feed * MINUTE)
    steps = [s for program in programs for s in program.steps if isinstance(s, (Move, ProbeStep))]
    for before, step in pairwise(steps):
        if isinstance(step, ProbeStep) or step.feed is None:
            continue
        if np.any(step.q[rotary] != before.q[rotary]):
            feeds = replace(feeds, turning=round(step.feed * MINUTE / DEG))
        else:
            feeds = replace(feeds, approach=round(step.feed * MINUTE))
    return feeds
