"""The errors of a machine as a model knows them, taken back: tables, programs, a live service."""

import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from matstd.api.diagnosing import Diagnosis
from matstd.api.known_errors import drives_stated, machine_errors, with_added, with_unknowns
from matstd.api.saved import REPORT_FILES
from matstd.compensation import field
from matstd.compensation.field import Datum, MachineErrors, Share, State, datum_of, sample_workspace
from matstd.compensation.part_programs import Frame, Program, read_loads, read_part_program
from matstd.compensation.programs import (
    TOLERANCE,
    Compensated,
    compensated,
    passed,
    write_program_result,
    write_shares,
    write_trajectory,
)
from matstd.compensation.service import OutputLimits, Service
from matstd.compensation.tables import (
    FORMATS,
    Harmful,
    Header,
    VerifiedTables,
    hashed,
    header_of,
    refuse_harmful,
    verify_tables,
    write_table_results,
    write_tables,
)
from matstd.diagnosis.files import SavedModel
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.remarks import Remark, short_beam
from matstd.effect_kinds import register_effects
from matstd.report.compensation import (
    draw_program,
    draw_shares_along,
    table_lines,
    write_compensation_page,
)
from matstd.report.style import save
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Displayed, text
from matstd.twin.elastic import short_beams
from matstd.twin.errors import BadArgument, BadFile, DesignError
from matstd.twin.files import read_any_text, read_poses, read_text, results_folder, write_whole
from matstd.twin.files.whole import refuse_to_overwrite
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import is_saved
from matstd.twin.record import Touches
from matstd.twin.units import USUAL_TOOL_LENGTH, doubtful_length

SOMETIMES = ("*/*", *REPORT_FILES, "pictures/*.png", "compensation.json")
"""Files that not every compensation by tables leaves."""


@dataclass(frozen=True, eq=False, repr=False)
class TableResults(Displayed):
    """Tables of controls that were written, read back and played on the exact twin."""

    done: tuple[VerifiedTables, ...]  # what the tables of every control correct and leave
    # why tables of other controls were not written: they would make the machine worse
    refused: tuple[Harmful, ...]


@text.register
def _of_control(played: VerifiedTables) -> str:
    return next(table_lines(played))


@text.register
def _text(found: TableResults) -> str:
    lines = [text(played) for played in found.done]
    return "\n".join([*lines, *(f"not written: {refusal}" for refusal in found.refused)])


@dataclass(frozen=True, eq=False, repr=False)
class Shares(Displayed):
    """What every error adds along a program or at poses."""

    touches: Touches  # the poses
    whole: Array  # deviation of the tool point from the datum's, (N, 3), mm
    each: tuple[Share, ...]  # what each error has of it

    def save(self, folder: str | Path, force: bool = False) -> None:
        """Write contributions.csv and contributions.png, whole or not at all."""
        names = ("contributions.csv", "contributions.png")
        with results_folder(folder, force, names) as place:
            write_shares(place / names[0], self.touches, self.whole, self.each)
            save(draw_shares_along(self.touches.time, self.whole, self.each), place / names[1])


PROBING = re.compile(r"\bSTANDARD (\S+) SETUP \S+")
"""Stands in the head of every probing program: the standard that it was written for."""


@dataclass(frozen=True, slots=True)
class ProgramOptions:
    """What a part program leaves open.

    Example:
        >>> ProgramOptions(tools={1: 120.0}, pass_m=[88]).tools
        {1: 120.0}
    """

    # lengths by number or name of the tool, mm; other tools have that of the datum
    tools: Mapping[int | str, float] | None = None
    # radii of tools, mm, where the program goes beside a contour (RL, RR, G41, G42)
    radii: Mapping[int | str, float] | None = None
    # M functions of the machine that move nothing and change no coordinates
    pass_m: Sequence[int] = ()
    tcp_m: Sequence[int] = ()  # M functions of G-code that switch tool-point control on and off
    # file with the process forces by the lines of the program; None for none
    loads: str | Path | None = None

    def read(self, path: str | Path, frame: Frame) -> Program:
        """A part program with these options; raises BadFile for a probing program."""
        if probing := PROBING.search(read_any_text(path)):
            raise BadFile(
                path,
                "head",
                f"a probing program, written for {probing[1]}",
                "a part program; `matstd simulate` runs probing programs, `matstd show` plays them",
            )
        tools, radii = dict(self.tools or {}), dict(self.radii or {})
        program = read_part_program(path, frame, tools, radii, self.pass_m, self.tcp_m)
        return replace(program, loads=read_loads(self.loads)) if self.loads else program


@dataclass(frozen=True, eq=False, repr=False)
class Compensation(Displayed):
    """A machine to be compensated; `compensate` and `Diagnosis.compensate` return it.

    Example:
        >>> files = machine_file("hmc1995"), machine_file("hmc1995", errors=True)
        >>> found = compensate(*files, tool_length=100.0).tables("tables", ["iso230"])
        >>> [tables.files for tables in found.done]
        [('iso230.csv',)]
    """

    errors: MachineErrors  # as they are known, in their state
    datum: Datum  # to which everything refers
    poses: Array  # over which a compensation is judged, (N, A)
    model: str  # hash of what the errors were read from; tables state it
    title: str  # name of the model
    remarks: tuple[Remark, ...] = ()  # what the user should know of the model

    def header(self, sign: int = 1) -> Header:
        """Head of a table; -1 where a control wants the opposite sign."""
        return header_of(self.errors.chain, self.model, self.datum, self.errors.state, sign)

    def tables(
        self,
        folder: str | Path,
        controls: str | Iterable[str] = (),
        *,
        opposite: str | Iterable[str] = (),
        force: bool = False,
        progress: Progress = silent,
    ) -> TableResults:
        """Write compensation tables, read them back and play them on the exact twin.

        Args:
            folder: New or empty; it appears whole or not at all, with report.html.
            controls: iso230, sinumerik, linuxcnc or heidenhain; all without it.
            opposite: Controls for which the sign of the values is turned.
            force: Replace the results of an earlier run.
            progress: Called with what is being done.

        Raises:
            BadArgument: A datum beyond the travel of its axis.
            Harmful: The tables of the only control, or of one that is named, would make the machine
                worse.
        """
        zero = dict(zip(self.errors.chain.axes, self.datum.zero.tolist(), strict=True))
        within_travel(self.errors.chain, "datum", zero)  # tables hold on the lines through it
        asked, turned = _controls("control", controls), _controls("opposite", opposite)
        names = asked or list(FORMATS)
        done: list[VerifiedTables] = []
        refused: list[Harmful] = []
        with results_folder(folder, force, SOMETIMES) as place:
            for k, name in enumerate(names):
                progress("tables", k, len(names))
                head = self.header(-1 if name in turned else 1)
                words = FORMATS[name], place / name, self.errors, self.datum, head, self.poses
                write_tables(*words)
                played = verify_tables(*words)
                try:
                    refuse_harmful(played)
                    done.append(played)
                except Harmful as refusal:
                    if asked or len(refused) + 1 == len(names):
                        raise
                    refused.append(refusal)
                    shutil.rmtree(place / name, ignore_errors=True)
            head = self.header()
            write_table_results(place / "compensation.json", self.errors, head, done)
            write_compensation_page(place, self.errors, head, done, self.title)
        return TableResults(tuple(done), tuple(refused))

    def program(
        self,
        source: str | Path,
        output: str | Path,
        *,
        tolerance: float = TOLERANCE,
        options: ProgramOptions | None = None,
        force: bool = False,
    ) -> Compensated:
        """Compensate a part program; its points, picture and figures go beside it.

        Args:
            source: A Klartext (`.H`) or G-code (`.ngc`, `.nc`) program.
            output: The compensated program.
            tolerance: Between a path and the lines that it becomes, mm.
            options: What the program leaves open.
            force: Overwrite earlier results.
        """
        output = Path(output)
        beside = beside_program(output)
        for path in (output, *beside):
            refuse_to_overwrite(path, force)
        frame = Frame(self.errors.chain, self.datum)
        program = (options or ProgramOptions()).read(source, frame)
        done = compensated(program, self.errors, self.header(), tolerance, output)
        write_whole(output, done.text)  # the first: where another run was faster, it is what stays
        write_trajectory(beside[0], done)
        save(draw_program(done), beside[1])
        write_program_result(beside[2], done)
        return done

    def along(self, source: str | Path, options: ProgramOptions | None = None) -> Shares:
        """What every error adds along a part program."""
        frame = Frame(self.errors.chain, self.datum)
        program = (options or ProgramOptions()).read(source, frame)
        return self._shares(passed(program, self.errors)[0])

    def at(self, poses: str | Path) -> Shares:
        """What every error adds at the poses of a file."""
        return self._shares(self.errors.touches(*read_poses(poses, self.errors.chain)))

    def _shares(self, touches: Touches) -> Shares:
        whole = field.deviation(self.errors, touches) - self.datum.deviation(self.errors)
        each = field.contributions(self.errors, touches, self.datum)
        return Shares(touches, whole, tuple(each))

    def service(self, limits: OutputLimits | None = None) -> Service:
        """Corrections for a machine that moves; `matstd serve` gives them to a control."""
        return Service(self.errors, self.datum.length, self.datum, limits or OutputLimits())


def beside_program(output: Path) -> list[Path]:
    """What is written beside a compensated program: its points, its picture, its figures."""
    return [output.with_suffix(ending) for ending in (".csv", ".png", ".json")]


@text.register
def _compensation(found: Compensation) -> str:
    return (
        f"compensation of {found.errors.chain.name} with {found.title}, tool of "
        f"{found.datum.length:g} mm, judged at {len(found.poses)} poses"
    )


def compensate(
    model: Diagnosis | Fit | SavedModel | str | Path,
    errors: str | Path | None = None,
    *,
    tool_length: float,
    datum: Mapping[str, float] | None = None,
    within: Mapping[str, tuple[float, float]] | None = None,
    state: State | None = None,
    add: Sequence[str] = (),
    switch: Mapping[str, float] | None = None,
    active: Sequence[str | Path] = (),
) -> Compensation:
    """A machine with known errors, to be compensated by tables, in programs or while it moves.

    Args:
        model: A diagnosis, a fit, a model, the path of a model file; or that of a machine file.
        errors: Error file of a machine file.
        tool_length: From the gauge point to the tip of the tool that stands at the datum, mm.
        datum: Readings of the program's zero, mm and rad; others are zero. That of a linear axis
            may lie beyond its travel for programs, not for tables.
        within: Workspace that is judged, mm and rad; other axes over their travel.
        state: Time, temperatures, speed and load of the machine; one just switched on without it.
        add: Further errors with their sizes, such as `"backlash(X)=3um"`.
        switch: Factors of errors, 0 is off: by symbol, effect, kind, class, axis or all.
        active: Tables that are active on the control, which must not be corrected twice.

    Raises:
        BadFile: A file that cannot be read, or an active table.
        BadArgument: A reading beyond the travel of its axis.
        DesignError: No error of an axis is known, or something that the model follows is not
            stated.

    Example:
        >>> files = machine_file("hmc1995"), machine_file("hmc1995", errors=True)
        >>> machine = compensate(*files, tool_length=100.0, within={"X": (-100.0, 100.0)})
        >>> machine.header().datum
        'X0 Z0 Y0 L100'
    """
    register_effects()
    name = str(model) if isinstance(model, str | Path) else "the model"
    state = state or State()
    with drives_stated(name):
        known, remarks, content, probes = machine_errors(model, errors, state)
    checked_length(tool_length, probes)
    for one in add:
        known = with_added(known, one)
    with drives_stated(name):
        known = with_unknowns(known)
    known = known.switched(dict(switch or {}))
    if not any(theta.any() for theta in known.theta):
        raise DesignError(f"{name}: no error of an axis is known and switched on")
    chain = known.chain
    beams = tuple(short_beam(*found) for found in short_beams(chain, known.effects))
    laws = [Path(e.path).read_bytes() for e in known.effects if is_saved(e)]
    title = model.title if isinstance(model, Diagnosis) else Path(name).name
    out = Compensation(
        errors=known,
        datum=stated_datum(chain, datum or {}, tool_length),
        poses=sample_workspace(chain, _limits(chain, within or {})),
        model=hashed(b"".join([content, *laws])),
        title=title,
        remarks=(*remarks, *beams),
    )
    for path in active:
        Header.of(read_text(path), path).refuse_active(out.header(), path)
    return out


def _controls(argument: str, names: str | Iterable[str]) -> list[str]:
    """Controls, each once."""
    names = [names] if isinstance(names, str) else list(names)
    for name in names:
        if name not in FORMATS:
            raise BadArgument(argument, name, f"one of {', '.join(FORMATS)}")
    return list(dict.fromkeys(names))


def checked_length(tool_length: float, probes: Sequence[float] = ()) -> None:
    """Refuse the length of a tool that no spindle holds, or that is in another unit.

    Args:
        tool_length: From the gauge point to the tip, mm; 0 for the gauge point itself.
        probes: Lengths of the probes with which the machine was measured, mm.

    Raises:
        BadArgument: With the unit in which it was probably stated.
    """
    question = doubtful_length(tool_length, probes or (USUAL_TOOL_LENGTH,))
    if tool_length == 0.0 or question is None:
        return
    probed = ", ".join(f"{length:g}" for length in probes)
    beside = f" (the machine was probed with {probed} mm)" if probes else ""
    raise BadArgument("tool_length", f"{tool_length:g}", f"mm; {question}{beside}")


def stated_datum(chain: Chain, readings: Mapping[str, float], tool_length: float) -> Datum:
    """Datum at stated readings; raises BadArgument for a rotary axis beyond its travel."""
    turned = {a: v for a, v in readings.items() if a not in chain.linear_axes}
    within_travel(chain, "datum", turned)
    return datum_of(chain, dict(readings), tool_length)


def within_travel(chain: Chain, argument: str, readings: Mapping[str, float]) -> None:
    """Raise BadArgument for a reading, mm or rad, beyond the travel of its axis."""
    for name, value in readings.items():
        link = chain.links[chain.link_index(chain.axes[chain.axis_index(name)])]
        low, high = link.range
        if not low <= value <= high:
            expected = f"{low / link.unit:g} to {high / link.unit:g}, the travel of {name}"
            raise BadArgument(argument, f"{name}={value / link.unit:g}", expected)


def _limits(
    chain: Chain, within: Mapping[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """Ranges by axis, mm and rad."""
    for name, ends in within.items():
        for end in ends:
            within_travel(chain, "within", {name: end})
        if not ends[0] <= ends[1]:
            raise BadArgument("within", f"{name}={ends[0]:g}:{ends[1]:g}", "the smaller end first")
    return dict(within)
