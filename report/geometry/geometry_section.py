"""The section of a page on the geometry of the machine, as a run determines it."""

from matstd.diagnosis.geometry import LearntGeometry
from matstd.report.geometry.copied_numbers import file_lines
from matstd.report.geometry.geometry_words import geometry_lines
from matstd.report.layout import Section, Table
from matstd.report.numbers import digits
from matstd.twin.record import Touches
from matstd.twin.units import UM

_SPANS = (
    "Quantities that this run determines, ± standard uncertainty{before}. Straightness, angular "
    "errors and error motions are peak to valley over the probed readings"
)
_FILE = (
    "Points and directions that this run estimates; below each, the alternatives that the run "
    "does not distinguish from it, of which only one is wrong. Lines of rotary axes are stated "
    "against the linear axes: copy the directions of linear axes first and compare again, then "
    "copy all numbers of the rotary axes that this second page has."
)


def geometry_sections(touches: Touches, geometry: LearntGeometry) -> list[Section]:
    """Fit of the models, quantities of the geometry, and numbers for the machine file."""
    ladder = [
        [f"{'+ ' if i else ''}{s.rung.value}", digits(s.rms / UM), digits(s.test_rms / UM)]
        for i, s in enumerate(geometry.ladder)
    ]
    known = [line for line in geometry_lines(geometry) if line.is_determined]
    unknown = [line for line in geometry_lines(geometry) if not line.is_determined]
    has_before = any(row.before is not None for row in geometry.rows)
    quantities = Table.of(
        known,
        {
            "quantity": lambda n: n.name,
            "value": lambda n: n.value,
            "over the travel": lambda n: n.at_ends,
            "expected": lambda n: f"± {n.expected}",
            "": lambda n: n.note,
        },
        _SPANS.format(before="; before → now" if has_before else ""),
        lambda n: n.is_noted,
    )
    ladder_caption = "Error of the models, from the set-ups alone to all effects"
    out = [
        Section(
            "Geometry of the machine",
            table=Table(("model", "fitted, µm", "held out, µm"), ladder, ladder_caption),
        ),
        Section(table=quantities),
    ]
    if unknown:
        cells = [[line.name, line.note] for line in unknown]
        fold = f"{len(unknown)} quantities that this run does not determine"
        out.append(Section(fold=fold, table=Table(("quantity", "remaining uncertainty"), cells)))
    if lines := file_lines(touches, geometry):
        fold = "The same as numbers for the machine file"
        out.append(Section(fold=fold, sentences=[_FILE], code="\n".join(lines)))
    return out
