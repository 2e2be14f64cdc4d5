"""A machine that moves on a page, with its errors and a program that is played."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from matstd.api.compensating import PROBING, ProgramOptions, checked_length, stated_datum
from matstd.api.known_errors import drives_stated, machine_errors, with_added, with_unknowns
from matstd.api.machines import chain_of
from matstd.api.standards import standard_of
from matstd.artefact.body import Standard
from matstd.artefact.reach import Workshop
from matstd.compensation.field import Datum, MachineErrors, State
from matstd.compensation.part_programs import Frame
from matstd.diagnosis.files import SavedModel, read_model
from matstd.diagnosis.fit import Fit
from matstd.effect_kinds import register_effects
from matstd.probe_paths.campaign import read_program_of
from matstd.probe_paths.control import ReadProgram, read_program
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.plan import ToolClearance
from matstd.report.machine import (
    Drawn,
    Played,
    ShownMachine,
    body_meshes,
    error_functions,
    machine_html,
    played_part,
    played_probing,
    probe_body,
    set_up_bodies,
    shown_lines,
    with_clearance,
)
from matstd.report.words import remark_sentence
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Displayed, html, text
from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.errors import BadArgument, BadFile
from matstd.twin.files import read_any_text, read_errors, write_whole
from matstd.twin.files.whole import refuse_to_overwrite
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Ranges
from matstd.twin.model import Effect
from matstd.twin.units import HOUR, USUAL_TOOL_LENGTH

DURATION = 8.0 * HOUR  # after the start over which drifts are shown at least, s: a shift


@dataclass(frozen=True, eq=False, repr=False)
class MachinePage(Displayed):
    """A machine that moves; `show` returns it, and a notebook shows it.

    Example:
        >>> page = show(machine_file("hmc1995"), machine_file("hmc1995", errors=True))
        >>> page.save("machine.html")
    """

    shown: ShownMachine  # what is on the page

    @property
    def html(self) -> str:
        """The page, one file that loads nothing."""
        return machine_html(self.shown)

    def save(self, path: str | Path, force: bool = False) -> None:
        """Write the page, whole or not at all.

        Args:
            path: Of the file.
            force: Overwrite an earlier one.
        """
        refuse_to_overwrite(path, force)
        write_whole(path, self.html)


@text.register
def _text(page: MachinePage) -> str:
    return shown_lines(page.shown)[0]


@html.register
def _html(page: MachinePage) -> str:
    """In a frame of its own, whose styles and names are not those of the notebook."""
    style = "width:100%;height:44rem;border:0"
    return f'<iframe style="{style}" srcdoc="{escape(page.html)}"></iframe>'


def show(
    machine: Chain | str | Path,
    errors: str | Path | None = None,
    *,
    model: SavedModel | Fit | str | Path | None = None,
    program: str | Path | Sequence[str | Path] = (),
    standard: Standard | str | Path | None = None,
    tool_length: float = USUAL_TOOL_LENGTH,
    datum: Mapping[str, float] | None = None,
    options: ProgramOptions | None = None,
    control: str = "itnc530",
    state: State | None = None,
    add: Sequence[str] = (),
    progress: Progress = silent,
) -> MachinePage:
    """A page on which a machine moves: axes, errors that are switched, a program that is played.

    Args:
        machine: A machine, or the path of its file, whose table `bodies` may name drawings.
        errors: Error file. Without errors and model every error that the machine can have is
            listed in its expected size, switched off.
        model: A fit, a model, or the path of a model file of the same machine.
        program: A part program, or probing programs of `matstd design` in their order.
        standard: That stands on the table while probing programs are played.
        tool_length: From the gauge point to the tip, mm; a program may have others.
        datum: Readings where the preset is taken, mm and rad; others are zero.
        options: What a part program leaves open.
        control: Whose words probing programs have, or a dialect file.
        state: Time, temperatures, speed and load of the machine.
        add: Further errors with their sizes, such as `"backlash(X)=3um"`.
        progress: Called with what is being done.

    Raises:
        BadFile: A file that cannot be read: machine, errors, model, mesh, program.
        BadArgument: Arguments that do not go together.

    Example:
        >>> page = show("machine.toml", program="programs/MS_A_1.H", standard="standard.toml")
        >>> len(page.shown.program) > 200
        True
    """
    register_effects()
    chain = chain_of(machine)
    checked_length(tool_length)
    progress("errors", 0, 1)
    known, source, remarks = _known(chain, errors, model, add, state or State())
    preset = stated_datum(chain, datum or {}, tool_length)
    files = [program] if isinstance(program, str | Path) else list(program)
    if standard is not None and not files:
        raise BadArgument("standard", str(standard), "probing programs (--program) beside it")
    played, bodies = None, body_meshes(chain)
    from_files = [body.on for body in bodies]
    replaced = set(from_files)
    if files:
        progress("program", 0, 1)
        played, beside = _played(known, files, standard, preset, options, control)
        bodies += beside
        replaced |= {"t"} if beside else set()
    duration = max(DURATION, float(played.time[-1]) if played else 0.0)
    progress("errors", 1, 2)
    with drives_stated(source or chain.name):
        # after the program: errors that drift are needed over all of its time
        functions = error_functions(known, tool_length, duration)
    return MachinePage(
        ShownMachine(
            chain=chain,
            length=tool_length,
            duration=duration,
            errors=functions,
            source=source,
            is_assumed=not source,
            bodies=bodies,
            replaced=sorted(replaced),
            from_files=from_files,
            program=played,
            datum=(preset.zero, preset.length),
            remarks=remarks,
        )
    )


def _known(
    chain: Chain,
    errors: str | Path | None,
    model: SavedModel | Fit | str | Path | None,
    add: Sequence[str],
    state: State,
) -> tuple[MachineErrors, str, list[str]]:
    """The errors, where they are from, and sentences on their model."""
    if errors is not None and model is not None:
        raise BadArgument("errors", errors, "only one of --errors and --model")
    remarks: list[str] = []
    names: list[str] = []
    if model is not None:
        saved = read_model(model) if isinstance(model, str | Path) else model
        with drives_stated(str(model) if isinstance(model, str | Path) else "the model"):
            known, found, *_ = machine_errors(saved, None, state)
        _refuse_other_machine(chain, known.chain, model)
        remarks += [remark_sentence(one) for one in found]
        names.append(Path(model).name if isinstance(model, str | Path) else "the model")
    elif errors is not None:
        known = MachineErrors.of_errors(chain, read_errors(errors, chain), state)
        names.append(Path(errors).name)
    else:
        known = MachineErrors.of_errors(chain, [] if add else expected_errors(chain), state)
    for added in add:
        known = with_added(known, added)
        names.append(added.partition("=")[0])
    return with_unknowns(known), " and ".join(names), remarks


def _refuse_other_machine(chain: Chain, other: Chain, model: SavedModel | Fit | str | Path) -> None:
    """Refuse a model of another machine; raises BadFile."""
    differs = chain.difference(other)
    if differs is not None:
        key, found, expected = differs[0], differs[2], differs[1]
        name = model if isinstance(model, str | Path) else "the model"
        raise BadFile(name, f"machine.{key}", found, f"{expected}, as in the machine file")


def expected_errors(chain: Chain) -> list[tuple[Effect, Array]]:
    """Every error of the axes in the largest size expected of its class, linear over the travel."""
    out: list[tuple[Effect, Array]] = []
    ranges = Ranges()
    for symbol in chain.symbols:
        if symbol.family is Family.SETUP or not chain.link(symbol.link).programmed:
            continue
        is_component = symbol.family is Family.COMPONENT
        effect = ComponentError(symbol, "linear") if is_component else LocationError(symbol)
        out.append((effect, np.array([ranges.of(chain, symbol)[1]])))
    return out


def _played(
    errors: MachineErrors,
    files: Sequence[str | Path],
    standard: Standard | str | Path | None,
    preset: Datum,
    options: ProgramOptions | None,
    control: str,
) -> tuple[Played, list[Drawn]]:
    """A part program, or probing programs with what they probe; and bodies that come with it."""
    texts = [read_any_text(file) for file in files]
    is_probing = [bool(PROBING.search(text)) for text in texts]
    if not any(is_probing):
        if len(files) > 1:
            raise BadArgument("program", str(files[1]), "one part program, or probing programs")
        if standard is not None:
            raise BadArgument("standard", str(standard), "probing programs; this is a part program")
        frame = Frame(errors.chain, preset)
        program = (options or ProgramOptions()).read(files[0], frame)
        return played_part(program, errors, texts[0]), []
    if not all(is_probing):
        other = files[is_probing.index(False)]
        raise BadArgument("program", str(other), "probing programs alone, or one part program")
    dialect = read_dialect(control)
    if standard is None:
        read = [read_program(file, errors.chain, dialect=dialect) for file in files]
        return played_probing(errors.chain, read, texts), [probe_body(read[0].heading.probe)]
    piece = standard_of(standard)
    read = [read_program_of(piece, file, errors.chain, None, dialect) for file in files]
    played, stands = played_probing(errors.chain, read, texts), _stands(errors.chain, read, piece)
    return with_clearance(played, stands), set_up_bodies(stands)


def _stands(chain: Chain, programs: Sequence[ReadProgram], standard: Standard) -> ToolClearance:
    """What the heads of programs state, which must be the same in all; raises BadFile."""
    first = programs[0].heading
    for program in programs:
        head = program.heading
        if head.setup.name != first.setup.name or head.probe != first.probe:
            found = f"set-up {head.setup.name}, probe of {head.probe.length:g} mm"
            expected = f"{first.setup.name} and {first.probe.length:g} mm, as in the first program"
            raise BadFile(program.path, "head", found, expected)
    return ToolClearance(
        chain=chain,
        standard=first.touched(standard),
        setup=first.setup,
        probe=first.probe,
        workshop=first.workshop or Workshop(),
    )
