"""`matstd calibrate`: the calibration of a standard by a CMM, and the program for the CMM."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.options import add_output

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matstd.artefact.body import Standard, Verdict


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
    from matstd.api.standards import as_designed, calibrate
    from matstd.console import say, say_each
    from matstd.report.task import calibration_lines, verdict_lines
    from matstd.twin.errors import DesignError
    from matstd.twin.files import refuse_to_overwrite
    from matstd.twin.units import UM

    refuse_to_overwrite(args.output, args.force)
    nominal = as_designed(args.standard)
    if args.program and args.cad:
        raise DesignError(f"--cad {args.cad}: beside --program, expected it beside --points")
    if args.program:
        return _program(args.output, nominal)
    found = calibrate(
        nominal,
        args.points,
        u=args.u_um * UM,
        u_feature=args.u_feature_um * UM,
        body_u=args.body_u_K,
        accept=True,
    )
    _show(found.verdicts)
    if not args.accept:
        found.check()
    found.save(args.output, args.cad, args.force)
    first, *others = calibration_lines(found)
    say(f"{args.output}: {first}")
    say_each([*others, *verdict_lines(found.verdicts)])
    return 0


def _program(output: str, nominal: Standard) -> int:
    """Write the program for the CMM."""
    from matstd.api.standards import cmm_program
    from matstd.console import say
    from matstd.twin.files import write_whole

    text = cmm_program(nominal)
    write_whole(output, text, newline="\r\n")
    count = text.count("PTMEAS/")
    say(f"{output}: {count} points on {len(nominal.features)} features, DMIS 5.2")
    return 0


def _show(verdicts: Sequence[Verdict]) -> None:
    """What conforms to the drawing and what does not, one row per characteristic."""
    from rich.table import Column, Table

    from matstd.console import console
    from matstd.report.task import verdict_rows

    numbers = [Column(f"{word} µm", justify="right") for word in ("deviation", "allowed", "u")]
    words = "feature", "characteristic"
    table = Table(*words, *numbers, Column("verdict", no_wrap=True), box=None)
    for verdict, row in zip(verdicts, verdict_rows(verdicts), strict=True):
        table.add_row(*row, style="bold" if verdict.is_refused else None)
    console().print(table)
