"""`matstd replan`: programs planned again for where the standard stands, as a log tells it."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.options import (
    REPORT_FILES,
    SHEET,
    SHEET_FILES,
    add_output,
    add_pdf,
    asked_printer,
)

if TYPE_CHECKING:
    from matstd.artefact.body import Standard
    from matstd.artefact.reach import DatumBall
    from matstd.probe_paths.control import LogPart, ReadProgram
    from matstd.probe_paths.emit import Feeds
    from matstd.probe_paths.language import Dialect
    from matstd.probe_paths.locate import Spread
    from matstd.probe_paths.stations import Station
    from matstd.twin.machine import Chain
    from matstd.twin.record import Setup

SEED = 0
"""Of the places that are tried first: the same log gives the same programs."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "logs",
        metavar="LOG.TXT",
        nargs="+",
        help="logs of the search in OUT/setup, or of programs that missed the standard",
    )
    parser.add_argument(
        "--design",
        metavar="OUT",
        required=True,
        help="output folder of `matstd design` or `matstd replan`",
    )
    parser.add_argument(
        "--control",
        metavar="NAME|FILE.toml",
        help="control that the programs are written for (default: that of the programs in OUT)",
    )
    parser.add_argument(
        "--within-mm",
        type=float,
        help="largest expected offset of the standard from its planned position, mm "
        "(default: that of the search in OUT/setup)",
    )
    parser.add_argument(
        "--within-deg",
        type=float,
        help="largest expected rotation of the standard from its planned orientation, degrees "
        "(default: as --within-mm)",
    )
    add_pdf(parser)
    add_output(parser)


def run(args: argparse.Namespace) -> int:
    """Find the place, plan, write programs and set-up sheet; the folder appears whole or not."""
    import shutil

    from matstd.artefact.body import read_standard
    from matstd.console import say, say_each
    from matstd.probe_paths.control import read_log, read_program
    from matstd.probe_paths.locate import Spread
    from matstd.probe_paths.stations import all_programs
    from matstd.stages.sheets import write_sheets
    from matstd.twin.files import read_machine, results_folder
    from matstd.twin.units import DEG

    printed_by, design = asked_printer(args), Path(args.design)
    made_for = spread_of(design)
    spread = Spread(
        made_for.distance if args.within_mm is None else args.within_mm,
        made_for.angle if args.within_deg is None else args.within_deg * DEG,
    )
    chain = read_machine(design / "machine.toml")
    standard = read_standard(design / "standard.toml")
    files = programs_of(design)
    words = _dialect(args.control, files[0])
    programs = [read_program(file, chain, dialect=words) for file in files]
    parts = [part for log in args.logs for part in read_log(log, chain.rotary_axes)]
    here, others = _of_one_setup(programs, parts)
    setup = _place(parts, standard, chain, words, spread)
    stations = _stations(here, standard, chain, setup, args.control)
    ours = [*REPORT_FILES, *SHEET_FILES, "programs/*"]
    with results_folder(args.output, args.force, ours) as folder:
        for name in ("machine.toml", "standard.toml"):
            shutil.copyfile(design / name, folder / name)
        made = all_programs(stations)
        made.write(folder / "programs")
        write_sheets(folder / SHEET, stations, feeds_of(programs, chain), printed_by)
    touches = sum(program.touches for program in made.programs)
    say(f"{args.output}: {touches} touches in {len(made.programs)} programs; {SHEET}/setup.html")
    say_each(f"touch dropped: {refusal}" for one in stations for refusal in one.plan.refused)
    say_each(f"programs of set-up {name} were left alone" for name in others)
    return 0


def _of_one_setup(
    programs: list[ReadProgram], parts: list[LogPart]
) -> tuple[list[ReadProgram], list[str]]:
    """Programs of the set-up that logs are of, and the names of the other set-ups.

    Raises:
        DesignError: Logs of several set-ups, or of one that no program has.
    """
    from matstd.twin.errors import DesignError

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
    programs: list[ReadProgram],
    standard: Standard,
    chain: Chain,
    setup: Setup,
    control: str | None,
) -> list[Station]:
    """The programs of every probe, planned again for where the standard stands."""
    from matstd.probe_paths.emit import make_programs
    from matstd.probe_paths.locate import planned_again
    from matstd.probe_paths.stations import Station

    out = []
    for words, mine in _by_probe(programs, control).items():
        plan = planned_again(mine, standard, chain, setup, _ball_of(mine[0], words, chain))
        out.append(Station(plan, words, make_programs(plan, words, feeds_of(mine, chain))))
    return out


def _ball_of(program: ReadProgram, words: Dialect, chain: Chain) -> DatumBall | None:
    """The ball on the table, as the program that touches it states it."""
    from matstd.probe_paths.control import BALL, read_program

    file = program.path.parent.parent / SHEET / f"{program.name.rpartition('_')[0]}_{BALL}.H"
    return read_program(file, chain, dialect=words).heading.ball if file.exists() else None


def _by_probe(programs: list[ReadProgram], control: str | None) -> dict[Dialect, list[ReadProgram]]:
    """Programs by the words, with tool and first letters, that they were written with."""
    from dataclasses import replace

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
    from matstd.twin.errors import BadFile

    folder = design / "programs"
    found = [p for p in folder.glob("*") if p.suffix.lower() in (".h", ".ngc")]
    if not found:
        raise BadFile(folder, "folder", "no program", "the folder that `matstd design` made")
    return sorted(found, key=lambda p: (len(p.name), p.name))


def spread_of(design: Path) -> Spread:
    """Within which the search of a design finds the standard, as its program states."""
    from matstd.probe_paths.emit import SEARCH
    from matstd.probe_paths.locate import Spread
    from matstd.twin.units import DEG

    for program in sorted((design / SHEET).glob(f"*_{SEARCH}.*")):
        text = program.read_text(encoding="ascii", errors="replace")
        if stated := re.search(r"STANDS WITHIN ([\d.]+) MM AND ([\d.]+) DEG", text):
            return Spread(float(stated[1]), float(stated[2]) * DEG)
    return Spread()


def _place(
    parts: list[LogPart], standard: Standard, chain: Chain, dialect: Dialect, spread: Spread
) -> Setup:
    """Where the standard stands, and words on it."""
    import numpy as np

    from matstd.console import say
    from matstd.probe_paths.campaign import ball_centres, checked_parts, evaluate
    from matstd.probe_paths.emit import SEARCH
    from matstd.probe_paths.locate import find_standard
    from matstd.report.words import located_lines

    believed = parts[0].heading.setup
    is_search = [part.program.endswith(SEARCH) for part in parts]
    if not any(is_search):
        run = evaluate(parts, standard, chain, 1e-3, dialect)
        found = run.touches.setups[0]
        for line in located_lines(believed, found):
            say(line)
        return found
    searches = [part for part, is_one in zip(parts, is_search, strict=True) if is_one]
    searches, remarks = checked_parts(searches, standard)
    for remark in remarks:
        say(f"- {remark}")
    part = searches[-1]
    balls = ball_centres(part, chain, dialect)
    rng = np.random.default_rng(SEED)
    made = find_standard(standard, believed, balls, part.radius, rng, spread)
    for line in located_lines(believed, made.setup, made):
        say(line)
    return made.setup


def _dialect(control: str | None, program: Path) -> Dialect:
    """Words of the control, with tool, preset and folder of a program that was made for it."""
    from dataclasses import replace

    from matstd.probe_paths.language import language_of, read_dialect

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
    from dataclasses import replace
    from itertools import pairwise

    import numpy as np

    from matstd.probe_paths.control import Move, ProbeStep
    from matstd.probe_paths.emit import Feeds
    from matstd.twin.units import DEG, MINUTE

    rotary = [chain.axis_index(a) for a in chain.rotary_axes]
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
