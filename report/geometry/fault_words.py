"""Mistakes in the description of a machine or a run, in words, each with its figures."""

from collections.abc import Sequence

from matstd.diagnosis.faults import DescriptionFault, Fault
from matstd.report.numbers import digits, microns, with_uncertainty
from matstd.twin.units import DEG
from matstd.twin.words import listed


def fault_sentences(faults: Sequence[DescriptionFault]) -> list[str]:
    """One sentence for each mistake, with the alternatives that explain the run equally."""
    return [_sentence(fault) for fault in faults]


def _sentence(fault: DescriptionFault) -> str:
    if fault.fault is Fault.MINUTES:
        return f"{_what(fault)}; nothing was changed"
    names = [_what(f) for f in (fault, *fault.alike)]
    either = "either " if len(names) > 1 else ""
    before, after = fault.test_rms
    was = f"{microns(before)} as described"
    if fault.widened[0] > 1.0:
        was += f", with errors {digits(fault.widened[0], 2)} times the expected ones"
    return (
        f"the description looks wrong: {either}{listed(names, 'or')}. With this corrected, the "
        f"held-out error is {microns(after)} ({was}); nothing was changed"
    )


_MISTAKES = {
    Fault.AXIS_REVERSED: "{axes} moves in the direction opposite to that in the machine file",
    Fault.AXES_SWAPPED: "the columns of {axes} are exchanged",
    Fault.ROTARY_ORDER: "{axes} are in the wrong order in the chain ({chain} fits)",
    Fault.OTHER_SIDE: "{axes} is on the wrong side of the chain ({chain} fits)",
    Fault.RADIANS: "readings of {axes} are radians, not degrees",
    Fault.INCHES: "{axes} are inches, not mm",
    Fault.FROM_INCHES: "{axes} are 25.4 times too large, mm converted as if they were inches",
    Fault.NORMALS_INWARD: "the normals point into the standard",
    Fault.MINUTES: "touches are less than a second apart: time_s looks like minutes",
}


def _what(fault: DescriptionFault) -> str:
    """The mistake itself."""
    axes = listed(list(fault.axes))
    match fault.fault:
        case Fault.TOOL_LENGTH:
            return f"the tool is {_by(fault, 'longer', 'shorter')} than probe.length_mm"
        case Fault.BALL_RADIUS:
            return f"the ball's radius is {_by(fault, 'larger', 'smaller')} than probe.radius_mm"
        case Fault.PIVOT:
            return f"axis.{axes}.point is wrong by {_numbers(fault)}"
        case Fault.ZERO:
            return f"the zero of {axes} is wrong by {_numbers(fault)}"
    return _MISTAKES[fault.fault].format(axes=axes, chain=fault.notation)


def _by(fault: DescriptionFault, more: str, less: str) -> str:
    """`2.01 ± 0.08 mm longer`."""
    (number,) = fault.numbers
    size = with_uncertainty(abs(number.change), number.u, "mm")
    return f"{size} {more if number.change > 0.0 else less}"


def _numbers(fault: DescriptionFault) -> str:
    """`2.01 ± 0.08 mm in X`; angles in degrees."""
    out = []
    for number in fault.numbers:
        letter = number.name[1]
        if letter in "ABC":
            out.append(with_uncertainty(number.change / DEG, number.u / DEG, "°"))
        else:
            out.append(f"{with_uncertainty(number.change, number.u, 'mm')} in {letter}")
    return listed(out)
