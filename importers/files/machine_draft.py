"""Draft machine files for imported measurements; the user checks what the data cannot determine."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.files import machine_questions
from matstd.twin.machine import Chain
from matstd.twin.record import Run
from matstd.twin.text import toml_value
from matstd.twin.units import UM

ORDINARY_ERROR = (1.0 * UM, 15e-6)
"""Ordinary translational error of a linear axis: a constant (mm) and a share of the travel. New
machines of ordinary accuracy have 8.5 µm over 500 mm (ISO 10791-4 tolerates 22 µm there)."""
DATA_TRAVEL = "  # PLACEHOLDER: that of the data; --travel states it"
SIDES = "# PLACEHOLDER: the data do not show which axes carry the workpiece (prime)"


def machine_text(chain: Chain, source: str, is_known: bool) -> str:
    """Text of a machine file whose travels are those of some data.

    Every line that the data do not determine is marked PLACEHOLDER; if the source states order,
    lines and sides of the axes (`is_known`), those are not.
    """
    lines = [
        f"# Made from {source}. The data do not determine lines marked PLACEHOLDER: check them.",
        'format = "machine/1"',
        f'name = "{chain.name}"  # PLACEHOLDER',
        *(() if is_known else (SIDES,)),
        f'chain = "{chain.notation}"',
    ]
    # a travel of some data may be short beside the others; it is no mistake of a user
    asked = machine_questions(chain, is_placed=bool(np.any(chain.table_origin)))
    if keys := list(dict.fromkeys(str(one.facts["key"]) for one in asked)):
        lines.append(f"confirmed = {toml_value(keys)}")
    for axis in chain.programmed_axes:
        link = chain.link(axis)
        low, high = (end / link.unit for end in link.range)
        doubt = "  # PLACEHOLDER: travel of the joint" if is_known else DATA_TRAVEL
        lines += ["", f"[axis.{axis}]", f"range = [{low:.12g}, {high:.12g}]{doubt}"]
        if link.kind == "linear":
            expected = link.expected or usual(high - low)
            lines.append(f"expected = {expected:.2g}  # PLACEHOLDER: mm; reports name larger ones")
        if link.kind == "rotary":
            doubt = "" if is_known else "  # PLACEHOLDER: a point of its line, mm"
            lines.append(f"point = {toml_value(link.point.tolist())}{doubt}")
        if not link.points_along_letter:
            lines.append(f"direction = {toml_value(link.direction.tolist())}")
    if np.any(chain.table_origin):
        lines += ["", "[workpiece]", f"origin = {toml_value(chain.table_origin.tolist())}"]
    return "\n".join(lines) + "\n"


def with_travels(run: Run, travels: Mapping[str, tuple[float, float]]) -> Run:
    """The run on its machine with stated travels, mm and rad; those of the data say nothing beyond.

    Raises:
        UnknownAxis: An axis that the machine does not have.
        DesignError: Limits in the wrong order, or readings beyond them.
    """
    chain = run.touches.chain
    for axis, (low, high) in travels.items():
        q = run.touches.q[:, chain.axis_index(axis)]
        unit = chain.link(axis).unit
        if not (low < high and low <= q.min() and q.max() <= high):
            raise DesignError(
                f"--travel {axis} {low / unit:g} {high / unit:g}: expected limits about the "
                f"readings, {q.min() / unit:g} to {q.max() / unit:g}"
            )
    links = tuple(
        replace(link, range=travels[link.name]) if link.name in travels else link
        for link in chain.links
    )
    return replace(run, touches=replace(run.touches, chain=replace(chain, links=links)))


def usual(travel: float) -> float:
    """Ordinary translational error of a linear axis, mm."""
    return ORDINARY_ERROR[0] + ORDINARY_ERROR[1] * travel
