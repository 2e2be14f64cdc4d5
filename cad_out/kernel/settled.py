"""STEP texts made the same for the same standard, with what the kernel leaves out or gets wrong."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from matstd.twin.errors import NotBuildable

if TYPE_CHECKING:
    from matstd.cad_out.kernel.assembly import Product

_FIRST = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION("
_ENTITY = re.compile(r"^#(\d+) = (.*?);$", re.S | re.M)
_REFERENCE = re.compile(r"#(\d+)")


def with_reproducible_order(whole: str) -> str:
    """A STEP text whose colours follow in the order of the parts.

    The kernel writes them in an order that depends on its memory. Everything from the first
    of them on is renumbered: roots are sorted by their content, and the entities that they refer to
    follow.
    """
    at = whole.find(_FIRST)
    if at < 0:
        return whole
    start, end = whole.rindex("\n#", 0, at) + 1, whole.index("\nENDSEC;", at)
    found = [(int(key), body) for key, body in _ENTITY.findall(whole[start : end + 1])]
    tail = dict(found)
    if list(tail) != list(range(found[0][0], found[0][0] + len(found))):
        raise NotBuildable("the CAD kernel did not number the end of its STEP file in order")
    children = {k: [int(r) for r in _REFERENCE.findall(body)] for k, body in tail.items()}
    referred = {child for some in children.values() for child in some}
    first = found[0][0]
    roots = [key for key in tail if key not in referred]
    roots.sort(key=lambda key: _own_words(tail[key], first))
    order: dict[int, int] = {}
    waiting = roots[::-1]
    while waiting:
        key = waiting.pop()
        if key in tail and key not in order:
            order[key] = first + len(order)
            waiting += children[key][::-1]

    def renumbered(match: re.Match[str]) -> str:
        return f"#{order.get(int(match[1]), int(match[1]))}"

    lines = [f"#{new} = {_REFERENCE.sub(renumbered, tail[old])};" for old, new in order.items()]
    return whole[:start] + "\n".join(lines) + whole[end:]


def _own_words(body: str, first: int) -> tuple[str, list[int]]:
    """Sort key of an entity: its kind, and its references to entities that keep their numbers."""
    kept = [int(r) for r in _REFERENCE.findall(body) if int(r) < first]
    return re.sub(r"\s+", "", body).split("(")[0], kept


def without_runout_zones(whole: str) -> str:
    """A STEP text without the zones of a run-out that the kernel adds to every position."""
    angle = r"#\d+ = RUNOUT_ZONE_ORIENTATION\(#(\d+)\);\n"
    for number in re.findall(angle, whole):
        whole = re.sub(
            rf"^#{number} = PLANE_ANGLE_MEASURE_WITH_UNIT\([^;]*;\n", "", whole, flags=re.M
        )
    return re.sub(
        r"^#\d+ = RUNOUT_ZONE_(?:DEFINITION|ORIENTATION)\([^;]*;\n", "", whole, flags=re.M
    )


def with_units_of_density(whole: str, count: int) -> str:
    """A STEP text whose densities are in g/cm^3, as their numbers are.

    The kernel always writes exponents 3 of the gram and 2 of the centimetre.

    Raises:
        NotBuildable: The densities are not written as they were when this was found.
    """
    items = set(re.findall(r"'density',POSITIVE_RATIO_MEASURE\([^)]*\),#(\d+)\)", whole))
    found = re.findall(r"'density',POSITIVE_RATIO_MEASURE\(", whole)
    units = dict(re.findall(r"^#(\d+) = DERIVED_UNIT\(\(([^)]*)\)\);", whole, re.M))
    if len(found) != count or not items <= set(units):
        raise NotBuildable(
            f"the CAD kernel wrote {len(found)} densities with a unit of mass and length, "
            f"expected {count}"
        )
    for item in sorted(items, key=int):
        elements = _REFERENCE.findall(units[item])
        for number, (written, meant) in zip(elements, (("3.", "1."), ("2.", "-3.")), strict=True):
            element = rf"^(#{number} = DERIVED_UNIT_ELEMENT\(#\d+,){re.escape(written)}\);"
            whole, changed = re.subn(element, rf"\g<1>{meant});", whole, flags=re.M)
            if changed != 1:
                raise NotBuildable(f"the CAD kernel wrote another unit of density in #{number}")
    return whole


def with_descriptions(whole: str, products: Sequence[Product]) -> str:
    """A STEP text whose products say what they are; the kernel leaves the field empty."""
    for product in products:
        name = re.escape(product.name)
        whole, changed = re.subn(
            rf"(PRODUCT\('{name}','{name}',)''", rf"\g<1>'{product.about}'", whole
        )
        if changed != 1:
            raise NotBuildable(f"the CAD kernel wrote {changed} products '{product.name}'")
    return whole
