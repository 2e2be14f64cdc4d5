"""The largest errors stand first on the console, rotary centres always."""

from matstd.diagnosis.geometry import Estimate, GeometryRow, LearntGeometry, Quantity
from matstd.report.geometry.geometry_words import noted_lines
from matstd.twin.units import UM, URAD


def row(quantity, symbol, axes, unit, value, u, lever, expected, **more) -> GeometryRow:
    return GeometryRow(
        quantity=quantity,
        symbol=symbol,
        axes=axes,
        unit=unit,
        estimate=Estimate(value, u),
        lever=lever,
        expected=expected,
        is_determined=True,
        **more,
    )


SCALE = row(Quantity.SCALE, "EZZ", ("Z",), "1", 0.74e-6, 0.97e-6, 500.0, 100e-6)
LINE = row(Quantity.ROTARY_LINE, "EX0C", ("C",), "mm", 29.4 * UM, 1.2 * UM, 1.0, 77.0 * UM)
SMALL = row(Quantity.ROTARY_LINE, "EY0C", ("C",), "mm", 0.2 * UM, 1.1 * UM, 1.0, 77.0 * UM)
SQUARE = row(
    Quantity.SQUARENESS, "EC0Y", ("X", "Y"), "rad", -40.0 * URAD, 2.0 * URAD, 600.0, 5.0 * URAD
)


def lines(*rows: GeometryRow) -> list[str]:
    return noted_lines(LearntGeometry(rows=rows, ladder=(), corrections=()))


def test_the_largest_at_the_tool_stands_first_and_what_is_nothing_is_left_out():
    """29.4 µm of a centre before 24 µm of a squareness; 0.4 ± 0.5 µm of a scale not at all."""
    found = lines(SCALE, SMALL, SQUARE, LINE)
    assert [line.partition(":")[0] for line in found] == [
        "line of C in X (EX0C)",
        "squareness of Y to X (EC0Y)",
        "line of C in Y (EY0C)",
    ]
    assert "29.4 ± 1.2 µm" in found[0]
    assert "larger than expected" in found[1]
    assert "larger than expected" not in found[0]


def test_without_anything_clear_the_usual_quantities_stand():
    (line,) = lines(SCALE)
    assert line.startswith("scale of Z (EZZ): 0.74 ± 0.97 ppm")
