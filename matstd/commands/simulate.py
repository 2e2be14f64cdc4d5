"""`matstd simulate`: an emitted program on the machine's twin, and the run file it leaves."""

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "programs", metavar="PROGRAM.H", nargs="+", help="in the order in which they are run"
    )
    parser.add_argument("--standard", metavar="STANDARD.toml", required=True, help="what is probed")
    parser.add_argument("--machine", metavar="MACHINE.toml", required=True, help="the machine")
    errors = parser.add_mutually_exclusive_group()
    errors.add_argument("--errors", metavar="ERRORS.toml", help="the machine's errors")
    errors.add_argument(
        "--random-errors", action="store_true", help="errors drawn from the default distributions"
    )
    parser.add_argument(
        "--noise-um", type=float, default=1.0, help="standard deviation of one touch (1.0)"
    )
    parser.add_argument("--seed", type=int, default=0, help="of noise and random errors (0)")
    parser.add_argument("--probe-length", type=float, help="mm; must be the program's")
    parser.add_argument("--probe-radius", type=float, help="mm; must be the program's")
    parser.add_argument("--logs", metavar="FOLDER", help="also write what FN 16 prints")
    parser.add_argument("-o", "--output", metavar="RUN.csv", required=True, help="to be written")
    parser.add_argument("--force", action="store_true", help="overwrite the output")


def run(args: argparse.Namespace) -> int:
    """Write the run file; a touch without contact stops the program and writes nothing."""
    import os
    from pathlib import Path

    import numpy as np

    from artefact.body import read_standard
    from probe_paths.campaign import VirtualMachine, simulate
    from probe_paths.control import stated_probe
    from sensitivity.population import Population, drawn_errors
    from twin.errors import DesignError
    from twin.files import read_errors, read_machine, refuse_to_overwrite, write_run, write_whole
    from twin.model import contribution
    from twin.units import UM

    if not 0.0 <= args.noise_um < 1000.0 or args.seed < 0:
        raise DesignError(
            f"--noise-um {args.noise_um:g} --seed {args.seed}: "
            "expected noise from 0 to 1000 µm and a seed from 0 up"
        )
    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.machine)
    standard = read_standard(args.standard)
    for_errors, for_noise = np.random.default_rng(args.seed).spawn(2)
    errors = read_errors(args.errors, chain) if args.errors else []
    if args.random_errors:
        errors = drawn_errors(Population(chain), for_errors)
    machine = VirtualMachine(
        chain, lambda touches: contribution(errors, touches), noise=args.noise_um * UM
    )
    probe = stated_probe(args.programs[0], args.probe_radius, args.probe_length)
    campaign = simulate(args.programs, standard, machine, for_noise, probe)
    for name, text in campaign.logs.items() if args.logs else ():
        write_whole(Path(args.logs) / name, text, newline="\r\n")
    folder = Path(args.output).resolve().parent
    write_run(args.output, campaign.run, Path(os.path.relpath(args.machine, folder)).as_posix())
    rms = float(np.sqrt(np.mean(campaign.run.deviation**2))) / UM
    minutes = campaign.runs[-1].end / 60.0
    print(
        f"{args.output}: {len(campaign.run)} touches in {minutes:.0f} min, "
        f"deviations {rms:.3f} µm rms after the set-up was fitted"
    )
    return 0
