"""Draft machine files for imported measurements; the user checks what the data cannot determine."""

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import DEG, UM

ORDINARY_ERROR = (1.0 * UM, 15e-6)
"""Ordinary translational error of a linear axis: a constant (mm) and a share of the travel. New
machines of ordinary accuracy have 8.5 µm over 500 mm (ISO 10791-4 tolerates 22 µm there)."""

SIDES = "# PLACEHOLDER: the data do not show which axes carry the workpiece (prime)"


def machine_text(chain: Chain, source: str, is_known: bool = False) -> str:
    """Text of a machine file whose travels are those of some data.

    Args:
        source: What it was made from, for the first line.
        is_known: Whether order, lines and sides of the axes are stated by the source.

    Returns:
        TOML; every line that the data do not determine is marked PLACEHOLDER.
    """
    lines = [
        f"# Made from {source}. The data do not determine lines marked PLACEHOLDER: check them.",
        'format = "machine/1"',
        f'name = "{chain.name}"  # PLACEHOLDER',
        *(() if is_known else (SIDES,)),
        f'chain = "{chain.notation}"',
    ]
    for axis in chain.programmed_axes:
        link = chain.link(axis)
        unit = 1.0 if link.kind == "linear" else DEG
        low, high = link.range
        lines += [
            "",
            f"[axis.{axis}]",
            f"range = [{low / unit:.12g}, {high / unit:.12g}]  # PLACEHOLDER: that of the data",
        ]
        if link.kind == "linear":
            expected = link.expected or usual(high - low)
            lines.append(f"expected = {expected:.2g}  # PLACEHOLDER: mm; reports name larger ones")
        if link.kind == "rotary":
            doubt = "" if is_known else "  # PLACEHOLDER: a point of its line, mm"
            lines.append(f"point = {_listed(link.point)}{doubt}")
        if not link.points_along_letter:
            lines.append(f"direction = {_listed(link.direction)}")
    if np.any(chain.table_origin):
        lines += ["", "[workpiece]", f"origin = {_listed(chain.table_origin)}"]
    return "\n".join(lines) + "\n"


def usual(travel: float) -> float:
    """Ordinary translational error of a linear axis, mm."""
    return ORDINARY_ERROR[0] + ORDINARY_ERROR[1] * travel


def _listed(values: Array) -> str:
    return f"[{', '.join(repr(float(v)) for v in values)}]"
