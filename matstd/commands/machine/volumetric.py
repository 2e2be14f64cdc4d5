"""`matstd volumetric`: exact deviation of the tool point, one row per pose."""

import argparse

from matstd.console import say_each
from matstd.options import Options, output
from matstd.twin.units import UM

OPTIONS: Options = {
    "machine MACHINE.toml": "machine file",
    "errors ERRORS.toml": "errors of the machine",
    "poses POSES.csv": "axis readings, one row per pose",
    **output("OUT.csv"),
}


def run(args: argparse.Namespace) -> int:
    """Write dx_um, dy_um, dz_um in the table frame, actual minus nominal."""
    from matstd.api.machines import read_machine, volumetric
    from matstd.progress import stages
    from matstd.twin.files.whole import refuse_to_overwrite

    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.machine)
    with stages() as show:
        found = volumetric(chain, args.errors, args.poses, show)
        found.save(args.output, show)
    size = found.size / UM
    count = f"{len(size)} poses" if len(size) > 1 else "1 pose"
    print(f"{args.output}: {count}, mean {size.mean():.3f} µm, worst {size.max():.3f} µm")
    say_each(chain.remarks)
    return 0
