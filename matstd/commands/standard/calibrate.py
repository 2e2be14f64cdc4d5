"""`matstd calibrate`: the calibration of a standard by a CMM, and the program for the CMM."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.console import console, say, say_each
from matstd.options import EXACTLY_ONE, Options, output
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matstd.artefact.body import Standard, Verdict


OPTIONS: Options = {
    "standard STANDARD.toml": "standard as designed",
    EXACTLY_ONE: {
        "--points CMM.csv ...": "points measured by the CMM: columns feature, x, y, z (mm unless "
        "the header names a unit); a ball may be given by its centre and a column diameter; "
        "several files are several orientations of the standard on the CMM",
        "--program": "write the DMIS program that measures the points",
    },
    "--orientation=0.0 DEG": "with --program: orientation of the standard on the CMM about z, "
    "degrees (0); four of them (0, 90, 180, 270) cancel squareness and differences of scales",
    "--u-um=0.3": "standard uncertainty of one point, µm (0.3)",
    "--u-feature-um=0.3": "standard uncertainty of the position of a feature that its points share "
    "(squareness and stylus of the CMM), from the certificate, µm (0.3)",
    "--body-u-K=0.5 U": "standard uncertainty of the temperature of the standard during the "
    "measurement, about 20 °C, K (0.5); it enters the assessment of the scale",
    "--scale-u-ppm=1.0 U": "standard uncertainty of the scales of the CMM, ppm (1): of 1.2 + L/350 "
    "µm (ISO 10360-2) it is 1.6; all features share it, with that of the temperature",
    "--waviness-um=0.5 W": "root mean square of waves that is assumed along a direction of a face "
    "without a dense line of points, µm (0.5)",
    "--accept": "write the standard even if it does not conform to its drawing; the file states "
    "this",
    "--cad FOLDER": "also write STEP, STL, 3MF and glTF of the standard as measured",
    **output("FILE"),
}


def run(args: argparse.Namespace) -> int:
    """Write the calibrated standard, or the program, whole or not at all."""
    from matstd.api.standards import as_designed, calibrate
    from matstd.report.task import calibration_lines, verdict_lines
    from matstd.twin.files.whole import refuse_to_overwrite

    refuse_to_overwrite(args.output, args.force)
    nominal = as_designed(args.standard)
    if args.program and args.cad:
        raise DesignError(f"--cad {args.cad}: beside --program, expected it beside --points")
    if args.program:
        return _program(args.output, nominal, args.orientation)
    found = calibrate(
        nominal,
        args.points,
        u=args.u_um * UM,
        u_feature=args.u_feature_um * UM,
        body_u=args.body_u_K,
        u_scale=1e-6 * args.scale_u_ppm,
        waviness=args.waviness_um * UM,
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


def _program(output: str, nominal: Standard, orientation: float) -> int:
    """Write the program for the CMM."""
    from matstd.api.standards import cmm_program
    from matstd.twin.files import write_whole

    text = cmm_program(nominal, orientation)
    write_whole(output, text, newline="\r\n")
    count = text.count("PTMEAS/")
    say(f"{output}: {count} points on {len(nominal.features)} features, DMIS 5.2")
    return 0


def _show(verdicts: Sequence[Verdict]) -> None:
    """What conforms to the drawing and what does not, one row per characteristic."""
    from rich.table import Column, Table

    from matstd.report.task import verdict_rows

    numbers = [Column(f"{word} µm", justify="right") for word in ("deviation", "allowed", "u")]
    words = "feature", "characteristic"
    table = Table(*words, *numbers, Column("verdict", no_wrap=True), box=None)
    for verdict, row in zip(verdicts, verdict_rows(verdicts), strict=True):
        table.add_row(*row, style="bold" if verdict.is_refused else None)
    console().print(table)
