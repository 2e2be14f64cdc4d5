"""`matstd volumetric`: exact deviation of the tool point, one row per pose."""

import argparse

from matstd.options import add_output


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("machine", metavar="MACHINE.toml", help="machine file")
    parser.add_argument("errors", metavar="ERRORS.toml", help="errors of the machine")
    parser.add_argument("poses", metavar="POSES.csv", help="axis readings, one row per pose")
    add_output(parser, "OUT.csv")


def run(args: argparse.Namespace) -> int:
    """Write dx_um, dy_um, dz_um in the table frame, actual minus nominal."""
    import numpy as np

    from matstd.console import say_assumed
    from matstd.progress import stages, table_blocks
    from matstd.twin.files import (
        read_errors,
        read_machine,
        read_poses,
        refuse_to_overwrite,
        written_whole,
    )
    from matstd.twin.model import Model
    from matstd.twin.record import at_poses
    from matstd.twin.units import UM

    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.machine)
    errors = read_errors(args.errors, chain)
    model = Model(chain, tuple(effect for effect, _ in errors))
    theta = np.concatenate([amplitude for _, amplitude in errors] or [np.zeros(0)])
    with (
        stages() as show,
        written_whole(args.output) as part_file,
        open(part_file, "w", newline="\n") as out,
    ):
        q, length = read_poses(args.poses, chain)
        size = np.empty(len(q))
        out.write("dx_um,dy_um,dz_um\n")
        for part in table_blocks("poses", len(q), show):
            deviation = model.tip_deviation(at_poses(chain, q[part], length[part]), theta) / UM
            size[part] = np.linalg.norm(deviation, axis=1)
            # one format for all rows of a block takes a quarter of one a number
            out.write("%.9f,%.9f,%.9f\n" * len(deviation) % tuple(deviation.ravel().tolist()))
    print(f"{args.output}: {len(q)} poses, mean {size.mean():.3f} µm, worst {size.max():.3f} µm")
    say_assumed(chain)
    return 0
