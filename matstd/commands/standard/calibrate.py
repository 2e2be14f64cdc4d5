"""`matstd calibrate`: a standard as a CMM finds it, and the program for the CMM."""

from __future__ import annotations

import argparse

from matstd.options import add_output


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("standard", metavar="STANDARD.toml", help="as designed")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--points",
        metavar="CMM.csv",
        help="points of the CMM: columns feature, x, y, z, with their units (mm); of a ball also "
        "its centre with a column diameter",
    )
    what.add_argument(
        "--program", action="store_true", help="write the DMIS program that takes the points"
    )
    parser.add_argument(
        "--u-um", type=float, default=0.3, help="standard uncertainty of one point, µm (0.3)"
    )
    parser.add_argument(
        "--u-feature-um",
        type=float,
        default=0.3,
        help="of the place of a feature by what its points share (scales, squareness and stylus of "
        "the CMM), as its certificate has it, µm (0.3)",
    )
    parser.add_argument(
        "--cad", metavar="FOLDER", help="also STEP, STL, 3MF and glTF of the standard as it is"
    )
    add_output(parser, "FILE")


def run(args: argparse.Namespace) -> int:
    """Write the calibrated standard, or the program, whole or not at all."""
    from artefact.body import read_standard, write_standard
    from artefact.certify import calibrated, dmis_program, read_cmm_points
    from cad_out.details import datum_touches, engraved_on
    from matstd.console import say, say_each
    from report.task import calibration_lines
    from twin.errors import DesignError
    from twin.files import refuse_to_overwrite, write_whole
    from twin.units import UM

    refuse_to_overwrite(args.output, args.force)
    nominal = read_standard(args.standard)
    if nominal.known is not None:
        raise DesignError(
            f"{args.standard}: calibrated with {nominal.known.source} already, expected the "
            "standard as designed"
        )
    if args.program and args.cad:
        raise DesignError(f"--cad {args.cad}: beside --program, expected it beside --points")
    if args.program:
        text = dmis_program(nominal, datum_touches(nominal), engraved_on(nominal))
        write_whole(args.output, text, newline="\r\n")
        count = text.count("PTMEAS/")
        say(f"{args.output}: {count} points on {len(nominal.features)} features, DMIS 5.2")
        return 0
    for name in ("u_um", "u_feature_um"):
        if not 0.001 <= getattr(args, name) <= 100.0:
            option = f"--{name.replace('_', '-')} {getattr(args, name):g}"
            raise DesignError(f"{option}: expected an uncertainty from 0.001 to 100 µm")
    points = read_cmm_points(args.points, nominal)
    found = calibrated(nominal, points, args.u_um * UM, args.u_feature_um * UM)
    if args.cad:
        from cad_out.verify import export_standard

        export_standard(found.standard, args.cad)
    write_standard(args.output, found.standard)
    first, *others = calibration_lines(found)
    say(f"{args.output}: {first}")
    say_each(others)
    return 0
