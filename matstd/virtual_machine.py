"""Options of commands that probe on the twin: how machine, set-up and probe really are."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from probe_paths.campaign import VirtualMachine
    from probe_paths.language import Dialect
    from twin.files import SensorRecord


def add_planted(parser: argparse.ArgumentParser) -> None:
    """Errors, noise, effects, set-up and probe as they really are."""
    errors = parser.add_mutually_exclusive_group()
    errors.add_argument("--errors", metavar="ERRORS.toml", help="the machine's errors")
    errors.add_argument(
        "--random-errors", action="store_true", help="errors drawn from the default distributions"
    )
    parser.add_argument(
        "--noise-um", type=float, default=1.0, help="standard deviation of one touch (1.0)"
    )
    parser.add_argument(
        "--add",
        metavar="EFFECT=SIZE",
        action="extend",
        nargs="+",
        default=[],
        help="plant effects: 'thermal-lag(EZZ)=25um,tau=18min', 'backlash(X)=3um', "
        "'drift=X=2um/h'; every size with its unit",
    )
    parser.add_argument(
        "--effects", metavar="FILE.py", action="append", default=[], help="effects of your own"
    )
    parser.add_argument(
        "--setup-error",
        metavar="NAME=SIZE",
        help="how the standard really stands, in its own frame: X=0.3mm,Y=-0.1mm,C=0.05deg",
    )
    parser.add_argument(
        "--probe-error",
        metavar="NAME=SIZE",
        help="of the probe, true less calibrated: radius=1um,length=20um",
    )
    parser.add_argument("--seed", type=int, default=0, help="of noise and random errors (0)")


def checked_noise(args: argparse.Namespace) -> None:
    """Refuse noise and seed that mean nothing; raises DesignError."""
    from twin.errors import DesignError

    if not 0.0 <= args.noise_um < 1000.0 or args.seed < 0:
        raise DesignError(
            f"--noise-um {args.noise_um:g} --seed {args.seed}: "
            "expected noise from 0 to 1000 µm and a seed from 0 up"
        )


def virtual_machine(
    args: argparse.Namespace,
    machine_file: str | Path,
    rng: np.random.Generator,
    dialect: Dialect,
    record: SensorRecord | None = None,
) -> VirtualMachine:
    """The machine as it really is, with the effects that the user plants in it.

    Args:
        args: With the options of `add_planted`.
        machine_file: Its nominal kinematics.
        rng: For random errors.
        dialect: Of its control.
        record: What drives effects, by the clock.
    """
    import numpy as np

    from probe_paths.campaign import FIRST_MORNING, VirtualMachine, effects_over_record
    from sensitivity.population import Population, drawn_errors
    from twin.files import read_errors, read_machine
    from twin.frames import fixed_xyz, pose
    from twin.library import (
        load_installed_effects,
        load_user_effects,
        parse_sized_effect,
        parse_sizes,
    )
    from twin.units import UM

    chain = read_machine(machine_file)
    load_installed_effects()
    for path in args.effects:
        load_user_effects(Path(path))
    errors = read_errors(args.errors, chain) if args.errors else []
    if args.random_errors:
        errors = drawn_errors(Population(chain), rng)
    planted = [parse_sized_effect(text, chain) for text in args.add]
    units = {**dict.fromkeys("XYZ", "mm"), **dict.fromkeys("ABC", "rad")}
    given = args.setup_error
    stands = parse_sizes(f"--setup-error {given}", given, units) if given else {}
    units = {"radius": "mm", "length": "mm"}
    given = args.probe_error
    probe = parse_sizes(f"--probe-error {given}", given, units) if given else {}
    return VirtualMachine(
        chain,
        effects_over_record([*errors, *planted], record),
        setup_error=pose(
            fixed_xyz(np.array([stands.get(a, 0.0) for a in "ABC"])),
            np.array([stands.get(a, 0.0) for a in "XYZ"]),
        ),
        radius_error=probe.get("radius", 0.0),
        length_error=probe.get("length", 0.0),
        noise=args.noise_um * UM,
        begin=FIRST_MORNING if record is None else record.begin,
        dialect=dialect,
    )
