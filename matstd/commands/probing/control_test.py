"""`matstd control-test`: emitted programs on an installed LinuxCNC, and what its own log says."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.probing.simulate import PLANTED, planted_machine
from matstd.console import say, say_each
from matstd.options import Options, output
from matstd.twin.units import MINUTE, UM

if TYPE_CHECKING:
    from matstd.probe_paths.emit import ProgramSet


OPTIONS: Options = {
    "design OUT": "output folder of `matstd design`, for any control",
    **PLANTED,
    "--touches:int N": "run only N touches, spread evenly over the programs",
    "--user= USER": "user that runs LinuxCNC if you are root (LinuxCNC refuses root)",
    **output(),
}


def run(args: argparse.Namespace) -> int:
    """Run the programs, keep the log whatever happens, evaluate it where all touches were made."""
    import numpy as np

    from matstd.api.probing import save_run
    from matstd.api.replanning import programs_of
    from matstd.artefact.body import read_standard
    from matstd.probe_paths.linuxcnc import installed, rehearse
    from matstd.twin.files.whole import claimed

    user = installed(args.user)
    design = Path(args.design)
    standard = read_standard(design / "standard.toml")
    machine = planted_machine(args, design / "machine.toml", "linuxcnc")
    for_noise = np.random.default_rng(args.seed).spawn(2)[1]
    files = _of_first_probe(programs_of(design))

    def announce(made: ProgramSet) -> None:
        touches = sum(program.touches for program in made.programs)
        say(f"{touches} touches on LinuxCNC, about {made.duration / MINUTE:.0f} min")

    with claimed(args.output, args.force) as out:
        for old in [*out.glob("*.TXT"), out / "run.csv"]:  # of an earlier run, which is replaced
            old.unlink(missing_ok=True)
        made = rehearse(files, standard, machine, for_noise, out, args.touches, user, announce)
        save_run(out / "run.csv", made.run, design / "machine.toml")
    say(
        f"{out / 'run.csv'}: {len(made.run)} touches from LinuxCNC's own log, "
        f"u = {made.u / UM:.3f} µm with the latch"
    )
    low, mean, high = (f(made.latched) / UM for f in (np.min, np.mean, np.max))
    say(
        f"- latched {low:.3f} to {high:.3f} µm beyond the twin's contact, mean {mean:.3f}; "
        f"modelled 0 to {made.modelled / UM:.3f} µm"
    )
    say_each(f"planted: {text}" for text in args.add)
    say_each(made.run.remarks)
    return 0


def _of_first_probe(files: list[Path]) -> list[Path]:
    """Programs of the first probe in the first set-up; the others have other first letters."""
    first = files[0].stem.rpartition("_")[0]
    return [file for file in files if file.stem.rpartition("_")[0] == first]
