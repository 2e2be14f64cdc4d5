"""`matstd sensitivity`: S of every error parameter at every pose."""

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("machine", metavar="MACHINE.toml", help="the machine")
    parser.add_argument("poses", metavar="POSES.csv", help="axis readings, a row a pose")
    parser.add_argument("-o", "--output", metavar="OUT.csv", required=True, help="to be written")
    parser.add_argument("--force", action="store_true", help="overwrite the output")


def run(args: argparse.Namespace) -> int:
    """Write one column a parameter: µm/µm, or µm/µrad for an angular one."""
    from sensitivity.jacobian import sensitivity
    from twin.files.machine_file import read_machine
    from twin.files.pose_file import read_poses
    from twin.files.whole import refuse_to_overwrite, write_whole
    from twin.units import UM, URAD

    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.machine)
    q, length = read_poses(args.poses, chain)
    unit = [URAD / UM if symbol.is_angular else 1.0 for symbol in chain.symbols]
    lines = [",".join(symbol.name for symbol in chain.symbols)]
    lines += [",".join(f"{v:.9g}" for v in row) for row in sensitivity(chain, q, length) * unit]
    write_whole(args.output, "\n".join(lines) + "\n")
    print(f"{args.output}: {len(q)} poses, {len(chain.symbols)} parameters")
    return 0
