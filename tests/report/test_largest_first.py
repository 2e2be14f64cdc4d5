"""The largest errors stand first on the console, rotary centres always."""

from dataclasses import replace

from matstd.diagnosis.geometry import Estimate, GeometryRow, LearntGeometry, Quantity
from matstd.diagnosis.policy import POLICY
from matstd.report.geometry.geometry_words import _is_usual, noted_lines, rotary_lines
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


def test_a_line_of_a_rotary_axis_beyond_twice_the_usual_is_explained():
    """158 of 64 µm is 2.5 times the usual size; 100 of 64 is 1.6 times; 400 is another fault."""

    def said(value: float) -> str:
        made = replace(LINE, estimate=Estimate(value * UM, UM), usual=64 * UM, expected=64 * UM)
        (line,) = rotary_lines(LearntGeometry(rows=(made,), ladder=(), corrections=()))
        return line

    assert said(100.0).endswith("usual ± 64 µm")
    explained = said(-158.0)
    assert "EX0C has 2.5 times that: the model corrects that" in explained
    assert f"{POLICY.far_line:g} times and more is taken for a mistake" in explained
    assert said(400.0).endswith("usual ± 64 µm")  # which a line of its own calls a mistake


def test_of_a_rotary_axis_its_positioning_is_asked_for_most() -> None:
    motion = row(Quantity.ROTARY_MOTION, "ECC", ("C",), "rad", URAD, URAD, 100.0, URAD)
    assert _is_usual(motion)
    assert not _is_usual(replace(motion, symbol="EAC"))
