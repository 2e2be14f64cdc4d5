"""`matstd calibrate`: a standard as a CMM finds it, and the program for the CMM."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.options import add_output

if TYPE_CHECKING:
    from matstd.artefact.body import Standard
    from matstd.artefact.certify import Calibrated


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("standard", metavar="STANDARD.toml", help="standard as designed")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--points",
        metavar="CMM.csv",
        help="points measured by the CMM: columns feature, x, y, z (mm unless the header "
        "names a unit); a ball may be given by its centre and a column diameter",
    )
    what.add_argument(
        "--program", action="store_true", help="write the DMIS program that measures the points"
    )
    parser.add_argument(
        "--u-um", type=float, default=0.3, help="standard uncertainty of one point, µm (0.3)"
    )
    parser.add_argument(
        "--u-feature-um",
        type=float,
        default=0.3,
        help="standard uncertainty of the position of a feature that its points share "
        "(scales, squareness and stylus of the CMM), from the certificate, µm (0.3)",
    )
    parser.add_argument(
        "--body-u-K",
        metavar="U",
        type=float,
        default=0.5,
        help="standard uncertainty of the temperature of the standard during the "
        "measurement, about 20 °C, K (0.5); it enters the assessment of the scale",
    )
    parser.add_argument(
        "--accept",
        action="store_true",
        help="write the standard even if it does not conform to its drawing; the file states this",
    )
    parser.add_argument(
        "--cad",
        metavar="FOLDER",
        help="also write STEP, STL, 3MF and glTF of the standard as measured",
    )
    add_output(parser, "FILE")


def run(args: argparse.Namespace) -> int:
    """Write the calibrated standard, or the program, whole or not at all."""
    from matstd.artefact.body import read_standard, write_standard
    from matstd.artefact.certify import calibrated, dmis_program, read_cmm_points
    from matstd.cad_out.details import datum_touches, engraved_on
    from matstd.console import say, say_each
    from matstd.report.task import calibration_lines, verdict_lines
    from matstd.twin.errors import DesignError
    from matstd.twin.files import refuse_to_overwrite, write_whole
    from matstd.twin.units import UM

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
    if not 0.0 <= args.body_u_K <= 20.0:
        raise DesignError(f"--body-u-K {args.body_u_K:g}: expected 0 to 20 K")
    points = read_cmm_points(args.points, nominal)
    found = calibrated(nominal, points, args.u_um * UM, args.u_feature_um * UM)
    found = _judged(args, nominal, found)
    if args.cad:
        from matstd.cad_out.verify import export_standard

        export_standard(found.standard, args.cad)
    write_standard(args.output, found.standard)
    first, *others = calibration_lines(found)
    say(f"{args.output}: {first}")
    say_each([*others, *verdict_lines(found.verdicts)])
    return 0


def _judged(args: argparse.Namespace, nominal: Standard, found: Calibrated) -> Calibrated:
    """Show what conforms to the drawing; refuse what does not unless it is accepted."""
    from rich.table import Column, Table

    from matstd.artefact.certify import Allowed, judged
    from matstd.cad_out.details import CALIBRATED
    from matstd.console import console
    from matstd.report.task import refusal_sentence, verdict_rows
    from matstd.twin.errors import NotConforming
    from matstd.twin.units import UM

    allowed = Allowed(CALIBRATED, args.u_feature_um * UM, args.body_u_K)
    found, causes = judged(nominal, found, allowed)
    numbers = [Column(f"{word} µm", justify="right") for word in ("deviation", "allowed", "u")]
    words = "feature", "characteristic"
    table = Table(*words, *numbers, Column("verdict", no_wrap=True), box=None)
    for verdict, row in zip(found.verdicts, verdict_rows(found.verdicts), strict=True):
        table.add_row(*row, style="bold" if verdict.is_refused else None)
    console().print(table)
    if any(v.is_refused for v in found.verdicts) and not args.accept:
        raise NotConforming(f"{args.points}: {refusal_sentence(found.verdicts, causes)}")
    return found
