"""`matstd simulate`: an emitted program on the machine's twin, and the run file it leaves."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matstd.console import say, say_each
from matstd.options import EFFECTS, ONE_OF, Options, Required, body, output
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

if TYPE_CHECKING:
    from matstd.artefact.body import Standard
    from matstd.probe_paths.campaign import VirtualMachine
    from matstd.probe_paths.control import ReadProgram


PLANTED: Options = {
    ONE_OF: {
        "--errors ERRORS.toml": "errors of the machine",
        "--random-errors": "draw the errors from the default distributions",
    },
    "--noise-um=1.0": "standard deviation of one touch, µm (1.0)",
    "--add EFFECT=SIZE ...": "simulate these effects, each size with its unit: "
    "'thermal-lag(EZZ)=25um,tau=18min', 'backlash(X)=3um', 'drift=X=2um/h'",
    **EFFECTS,
    "--setup-error NAME=SIZE": "offset of the standard from its planned set-up, in its own frame: "
    "X=0.3mm,Y=-0.1mm,C=0.05deg",
    "--probe-error NAME=SIZE": "error of the probe, true minus calibrated value: "
    "radius=1um,length=20um",
    "--seed=0": "seed of noise and random errors (0)",
}
"""Errors, noise, effects, set-up and probe as they really are."""

OPTIONS: Options = {
    "programs PROGRAM ...": "probing programs, in the order in which they run",
    "--standard STANDARD.toml": Required("standard that is probed"),
    "--real-standard STANDARD.toml": "true geometry of the standard, such as a calibrated one, if "
    "it differs from --standard",
    "--machine MACHINE.toml": Required("machine file"),
    **body("temperature of the standard, °C; the run file states it (default: 20, not stated)"),
    **PLANTED,
    "--sensors SENSORS.csv": "temperatures and spindle speed over time, as for `evaluate`: columns "
    "clock (2031-05-06T07:08:09), T_<sensor>_degC, spindle_rpm; the run begins at the first row",
    "--probe-length:float": "length of the probe, mm; must equal the program's",
    "--probe-radius:float": "radius of the probe ball, mm; must equal the program's",
    "--control=itnc530 NAME|FILE.toml": "control that the programs are written for; needed for "
    "your own dialect (itnc530)",
    "--logs FOLDER": "also write the logs of the control to this folder",
    **output("RUN.csv"),
}


def run(args: argparse.Namespace) -> int:
    """Write the run file; a touch without contact stops the program and writes nothing."""
    from matstd.api.probing import leaves_no_run, simulate
    from matstd.api.standards import read_standard
    from matstd.progress import stages
    from matstd.twin.files.whole import refuse_to_overwrite
    from matstd.twin.numbers import rms

    refuse_to_overwrite(args.output, args.force)
    machine = planted_machine(args, args.machine, args.control, args.sensors)
    standard = read_standard(args.standard)
    if program := leaves_no_run(args.programs[0], standard, machine):
        return _search(args, program, standard, machine)
    with stages() as show:
        found = simulate(
            args.programs,
            standard,
            machine,
            sensors=args.sensors,
            probe_radius=args.probe_radius,
            probe_length=args.probe_length,
            progress=show,
            **_piece(args),
        )
    run = found.campaign.run
    left = rms(run.deviation) / UM
    found.save(args.output, args.machine, args.logs, args.force)
    minutes = found.campaign.runs[-1].end / 60.0
    say(
        f"{args.output}: {len(run)} touches in {minutes:.0f} min, "
        f"deviations {left:.3f} µm rms after the set-up was fitted"
    )
    say_each(f"planted: {text}" for text in args.add)
    say_each(run.touches.chain.remarks)
    say_each(found.remarks)
    return 0


def _piece(args: argparse.Namespace) -> dict[str, Any]:
    """What the options say of the standard as it really is, and of the noise."""
    return {
        "real_standard": args.real_standard,
        "body_temperature": args.body_degC,
        "body_u": args.body_u_K,
        "seed": args.seed,
    }


def _search(
    args: argparse.Namespace, program: ReadProgram, standard: Standard, machine: VirtualMachine
) -> int:
    """Write the log of a program that measures nothing and leaves no run file."""
    from matstd.api.probing import save_logs, simulate_log

    if not args.logs or len(args.programs) > 1:
        raise DesignError(
            f"{program.path}: a search for the standard and a commissioning program leave a log "
            "and no run file: run it alone, with --logs FOLDER"
        )
    reader = "replan" if program.is_search else "evaluate"
    logs = simulate_log(program, standard, machine, **_piece(args))
    for path in save_logs(args.logs, logs, args.force):
        say(f"{path}: {len(program.touches)} touches; matstd {reader} reads it")
    return 0


def planted_machine(
    args: argparse.Namespace, machine: str | Path, control: str, sensors: str | None = None
) -> VirtualMachine:
    """The machine as it really is, with what the options `PLANTED` plant in it."""
    from matstd.api.probing import virtual_machine
    from matstd.effect_kinds import register_effects

    register_effects(*args.effects)
    return virtual_machine(
        machine,
        args.errors,
        random_errors=args.random_errors,
        add=args.add,
        noise=args.noise_um * UM,
        setup_error=args.setup_error or "",
        probe_error=args.probe_error or "",
        sensors=sensors,
        control=control,
        seed=args.seed,
    )
