"""Programs run on the twin of a machine."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.api.machines import chain_of
from matstd.api.standards import standard_of
from matstd.artefact.body import Standard
from matstd.diagnosis.remarks import body_sizes
from matstd.effect_kinds import register_effects
from matstd.options import seen_from
from matstd.probe_paths.campaign import (
    Campaign,
    VirtualMachine,
    ball_changes,
    effective_radii,
    effects_over_record,
    read_program_of,
    simulate_search,
)
from matstd.probe_paths.campaign import simulate as run_on_twin
from matstd.probe_paths.control import ReadProgram, stated_probe
from matstd.probe_paths.language import read_dialect
from matstd.report.words import ball_lines, remark_sentence
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Displayed, text
from matstd.twin.errors import BadArgument, BadFile, BadValue
from matstd.twin.files import SensorRecord, read_errors, read_sensors, write_run
from matstd.twin.files.whole import write_into
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.library import parse_sized_effect, parse_sizes
from matstd.twin.machine import Chain
from matstd.twin.record import Run, StatedBody, with_body
from matstd.twin.units import MINUTE, UM
from matstd.twin.words import not_read

T_NORMAL = 20.0  # what the control reads of a sensor that no record has, degC


def virtual_machine(
    machine: Chain | str | Path,
    errors: str | Path | None = None,
    *,
    random_errors: bool = False,
    add: Sequence[str] = (),
    noise: float = 1.0 * UM,
    setup_error: str = "",
    probe_error: str = "",
    sensors: str | Path | None = None,
    control: str = "itnc530",
    seed: int = 0,
) -> VirtualMachine:
    """A machine as it really is, with the errors and effects that are planted in it.

    Args:
        machine: Its nominal kinematics.
        errors: Error file.
        random_errors: Draw the errors from the default distributions instead.
        add: Effects with their sizes: `"thermal-lag(EZZ)=25um,tau=18min"`, `"backlash(X)=3um"`.
        noise: Standard deviation of one touch, mm.
        setup_error: How the standard really stands, in its own frame: `"X=0.3mm,C=0.05deg"`.
        probe_error: Of the probe, true less calibrated: `"radius=1um,length=20um"`.
        sensors: File with what temperatures and spindle do by the clock; the run begins at its
            first row.
        control: Name of the control, or a dialect file of your own.
        seed: Of the random errors.

    Raises:
        BadFile: A file that cannot be read.
        BadArgument: Noise or a seed that makes no sense.
        DesignError: An effect or a size that makes no sense.

    Example:
        >>> machine = virtual_machine("machine.toml", add=["backlash(X)=3um"])
        >>> simulate(["programs/MS_A_1.H"], "standard.toml", machine).save("x.csv", "machine.toml")
    """
    register_effects()
    if not 0.0 <= noise < 1000.0 * UM:
        raise BadArgument("noise_um", f"{noise / UM:g}", "noise from 0 to 1000 µm")
    if seed < 0:
        raise BadArgument("seed", seed, "a seed from 0 up")
    chain = chain_of(machine)
    record = read_sensors(sensors) if sensors else None
    known = read_errors(errors, chain) if errors else []
    if random_errors:
        known = drawn_errors(Population(chain), _children(seed)[0])
    planted = [parse_sized_effect(text, chain) for text in add]
    units = {**dict.fromkeys("XYZ", "mm"), **dict.fromkeys("ABC", "rad")}
    stands = parse_sizes(f"--setup-error {setup_error}", setup_error, units) if setup_error else {}
    units = {"radius": "mm", "length": "mm"}
    probe = parse_sizes(f"--probe-error {probe_error}", probe_error, units) if probe_error else {}
    return VirtualMachine(
        chain,
        effects_over_record([*known, *planted], record),
        setup_error=pose(
            fixed_xyz(np.array([stands.get(a, 0.0) for a in "ABC"])),
            np.array([stands.get(a, 0.0) for a in "XYZ"]),
        ),
        radius_error=probe.get("radius", 0.0),
        length_error=probe.get("length", 0.0),
        noise=noise,
        begin=VirtualMachine.begin if record is None else record.begin,
        dialect=read_dialect(control),
        temperature=_thermometers(record),
    )


def _children(seed: int) -> list[np.random.Generator]:
    """Generators for errors and for noise: the same noise whatever errors are drawn."""
    return np.random.default_rng(seed).spawn(2)


def _thermometers(record: SensorRecord | None) -> Callable[[str, float], float]:
    """What the control reads of a sensor at a time."""
    if record is None:
        return lambda name, now: T_NORMAL
    since, known = record.since(record.begin), record.temperature
    return lambda name, now: (
        float(np.interp(now, since, known[name])) if name in known else T_NORMAL
    )


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Displayed):
    """Programs that were run on the twin; `simulate` returns it.

    Example:
        >>> found = simulate(["programs/MS_A_1.H"], "standard.toml", "machine.toml")
        >>> found.save("simulated.csv", "machine.toml")
    """

    run: Run  # the measurements
    campaign: Campaign  # what each program did, with the logs
    remarks: tuple[str, ...]  # what the logs say of the probe, and what else the user should know

    def save(
        self,
        path: str | Path,
        machine: str | Path,
        logs: str | Path | None = None,
        force: bool = False,
    ) -> None:
        """Write the run file, and the logs into a folder, each whole or not at all.

        Args:
            path: Run file.
            machine: Machine file that the run file names, as it is seen from the current folder;
                the run file has it as seen from its own.
            logs: Folder; None for none.
            force: Replace logs of an earlier run.

        Raises:
            BadFile: There is no such machine file.
            DesignError: A log of the same name exists; the logs are kept in a free folder beside.
        """
        save_run(path, self.run, machine)
        # after it: a run that comes second does not touch the logs of the first
        if logs is not None:
            save_logs(logs, self.campaign.logs, force)


@text.register
def _text(found: Simulation) -> str:
    minutes = found.campaign.runs[-1].end / MINUTE
    return "\n- ".join([f"{found.run!r}, in {minutes:.0f} min", *found.remarks])


def simulate(
    programs: Sequence[str | Path],
    standard: Standard | str | Path,
    machine: VirtualMachine | Chain | str | Path,
    *,
    real_standard: Standard | str | Path | None = None,
    body_temperature: float | None = None,
    body_u: float | None = None,
    sensors: str | Path | None = None,
    probe_radius: float | None = None,
    probe_length: float | None = None,
    seed: int = 0,
    progress: Progress = silent,
) -> Simulation:
    """Run emitted probing programs on the twin of a machine, and evaluate the logs they leave.

    Args:
        programs: Files in the order in which they are run.
        standard: What is believed to be probed.
        machine: As it really is (`virtual_machine`); a plain one has 1 µm of noise and no errors.
        real_standard: The piece as it really is, a calibrated one, say.
        body_temperature: Of the standard, degC, which the run states; 20, not stated, without it.
        body_u: Its standard uncertainty, K.
        sensors: The record that the machine was made with, to be joined to the run.
        probe_radius: mm; must be that of the programs.
        probe_length: mm; must be that of the programs.
        seed: Of the noise.
        progress: Called with what is being done.

    Raises:
        BadFile: A file that cannot be read, or a program made for another machine or standard.
        NotReachable: A touch without contact.

    Example:
        >>> found = simulate(["programs/MS_A_1.H"], "standard.toml", "machine.toml")
        >>> len(found.run)
        33
    """
    believed = standard_of(standard)
    stated = stated_body(believed, body_temperature, body_u)
    real = _piece(believed, real_standard, body_temperature, body_u)
    twin = machine if isinstance(machine, VirtualMachine) else virtual_machine(machine)
    probe = stated_probe(programs[0], probe_radius, probe_length, twin.dialect)
    campaign = run_on_twin(programs, real, twin, _children(seed)[1], probe, progress, believed)
    run, sizes = campaign.run, []
    if sensors is not None:
        run = read_sensors(sensors).joined(run, campaign.begin)
    if body_temperature is not None:
        run = with_body(run, stated)
        sizes = [remark_sentence(size) for size in body_sizes(run.touches)]
    u = twin.stated_u
    changes = ball_changes(campaign.parts, believed, twin.chain, u, twin.dialect)
    radii = effective_radii(campaign.parts, twin.chain, u, twin.dialect)
    return Simulation(run, campaign, (*ball_lines(changes, radii=radii), *sizes, *run.remarks))


def leaves_no_run(
    program: str | Path, standard: Standard, machine: VirtualMachine
) -> ReadProgram | None:
    """A search for the standard or a commissioning program, which leave a log alone; else None."""
    read = read_program_of(standard, program, machine.chain, None, machine.dialect)
    return read if read.is_search or read.is_first else None


def simulate_log(
    program: ReadProgram,
    standard: Standard | str | Path,
    machine: VirtualMachine,
    *,
    real_standard: Standard | str | Path | None = None,
    body_temperature: float | None = None,
    body_u: float | None = None,
    seed: int = 0,
) -> Mapping[str, str]:
    """Logs, by file name, of a program that leaves no measurements; arguments as of `simulate`."""
    real = _piece(standard_of(standard), real_standard, body_temperature, body_u)
    return simulate_search(program, real, machine, _children(seed)[1]).log


def _piece(
    believed: Standard,
    real_standard: Standard | str | Path | None,
    body_temperature: float | None,
    body_u: float | None,
) -> Standard:
    """The standard as it really is, at its temperature.

    Raises:
        BadFile: The calibration of another standard than the design that is believed of it.
        BadArgument: The uncertainty of a temperature that is not stated.
    """
    if body_temperature is None and body_u is not None:
        raise BadArgument("body_u_K", f"{body_u:g}", "--body-degC as well")
    real = believed if real_standard is None else standard_of(real_standard)
    if real.known and not believed.known and real.known.nominal != believed.fingerprint:
        raise BadFile(
            real.name if isinstance(real_standard, Standard) else str(real_standard),
            "calibration.nominal",
            real.known.nominal,
            f"{believed.fingerprint}, the fingerprint of '{believed.name}' (--standard)",
        )
    return real if body_temperature is None else real.at(body_temperature)


def stated_body(standard: Standard, temperature: float | None, u: float | None) -> StatedBody:
    """What is stated of a standard: its material, its temperature with the uncertainty of it.

    Raises:
        BadArgument: A temperature, or an uncertainty, that makes no sense.
    """
    material, known = standard.material, standard.known
    scale = None if known is None or known.u_scale is None else 1e6 * known.u_scale
    try:
        return StatedBody(
            material.expansion,
            material.u_expansion,
            body_degC=temperature,
            body_u_K=u,
            scale_u_ppm=scale,
        )
    except BadValue as error:
        found, expected = error.facts["found"], str(error.facts["expected"])
        raise BadArgument(str(error.facts["key"]), found, expected) from None


def save_run(path: str | Path, run: Run, machine: str | Path) -> None:
    """Write a run file that names its machine file as it is seen from there.

    Args:
        machine: Path of the machine file from the current folder, absolute or relative.

    Raises:
        BadFile: There is no such machine file.
    """
    if not Path(machine).is_file():
        found = not_read(Path(machine), FileNotFoundError())
        raise BadFile(machine, "machine", found, "the machine file, from the current folder")
    write_run(path, run, seen_from(Path(path).parent, machine))


def save_logs(folder: str | Path, logs: Mapping[str, str], force: bool = False) -> list[Path]:
    """Write logs as a control leaves them; arguments and errors as of `Simulation.save`."""
    return write_into(folder, logs, force, newline="\r\n")
