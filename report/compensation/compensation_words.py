"""What tables and compensated programs correct and what remains, in sentences."""

from collections.abc import Iterator, Sequence

import numpy as np

from matstd.compensation.field import Result, UncorrectedError
from matstd.compensation.programs import Compensated
from matstd.compensation.tables import VerifiedTables
from matstd.report.numbers import digits, um
from matstd.twin.numbers import rms_length
from matstd.twin.units import MINUTE, NM, UM
from matstd.twin.words import few


def program_lines(name: str, done: Compensated) -> Iterator[str]:
    """A heading, and lines below it."""
    motions, points = len(done.program.motions), len(done.q)
    yield f"{name}: {motions} motions as {points} lines"
    before, after = (rms_length(field[done.is_stated]) / UM for field in (done.before, done.after))
    worst = np.linalg.norm(done.after[done.is_stated], axis=1).max() / UM
    words = f"tool point at line ends {digits(before)} -> {digits(after)} µm rms"
    words += f" (worst {digits(worst)} µm)"
    if done.u.any() and rms_length(done.u[:, None]) > NM:
        u = rms_length(done.u[:, None])
        words += f"; the uncertainty of the model is {um(u, 2)} there{_tool_words(u, done.u_tool)}"
    yield words
    if done.is_cut:
        row = int(np.nanargmax(done.between))
        words = f"between line ends up to {digits(done.worst_between / UM)} µm off the path"
        words += f" (line {done.program.motions[done.motion[row]].line})"
        words += f"; lines were divided down to {digits(done.tolerance / UM)} µm"
        if done.worst_between > done.tolerance:
            words += ", except where a reversal or a load changes the correction abruptly"
        yield words
    if len(done.leans):
        most = digits(done.leans.max() / UM)
        yield f"{len(done.leans)} holes by cycles, exact at their bottom; lean at most {most} µm"
    added = np.abs(done.added[:, done.program.frame.linear]).max() / UM
    minutes = digits(done.elapsed[-1] / MINUTE)
    yield f"largest correction {digits(added)} µm; {minutes} min of motion"
    if done.unmoved:
        lines = ", ".join(str(line) for line in done.unmoved)
        yield f"lines not compensated (machine coordinates, or no position yet): {lines}"


_TITLES = {
    "iso230": "ISO 230 names (ISG kernel, TwinCAT CNC)",
    "sinumerik": "Sinumerik CEC",
    "linuxcnc": "LinuxCNC COMP_FILE",
    "heidenhain": "iTNC 530 positioning tables (.COM)",
}

SMALLEST_OF_TOOL = 0.1 * UM
"""Uncertainty of the probe's place in the spindle from which it is stated, rms over the poses."""
_GROWN = 1.01  # times an error of which more remains than there was, beyond rounding
MAX_NAMED_ERRORS = 5  # errors that a control cannot represent, named on the console


def control_title(name: str) -> str:
    """A control's tables in words."""
    return _TITLES.get(name, name)


def result_sentence(result: Result) -> str:
    """Error before and after, and what to expect in view of the uncertainty of the model, rms."""
    before, after = rms_length(result.before) / UM, rms_length(result.after) / UM
    words = f"{digits(before)} -> {small(after)} µm rms over the workspace"
    worst = np.linalg.norm(result.after, axis=1).max() / UM
    words += f" (worst of {poses_words(result)} {small(worst)} µm)"
    if result.u_rms > NM:
        numbers = (result.u_rms, result.expected_before, result.expected)
        u, was, will = (digits(v / UM, 2) for v in numbers)
        words += f"; the uncertainty of the model is {u} µm there, so expect {was} -> {will} µm"
    return words + _tool_words(result.expected, result.u_tool)


def _tool_words(known: float, u_tool: float) -> str:
    """For which tools a figure holds, mm, and what it is for others; empty where they are alike."""
    if u_tool <= SMALLEST_OF_TOOL:
        return ""
    others = digits(float(np.hypot(known, u_tool)) / UM, 2)
    return f" with tools set relative to the probe of the measurement ({others} µm with others)"


def poses_words(result: Result) -> str:
    """`256 poses in both directions`: where an axis reverses, each is judged after both motions."""
    return f"{len(result.q)} poses" + (" in both directions" if result.has_directions else "")


def small(value: float, significant: int = 3) -> str:
    """A size in µm, nothing below a nanometre."""
    return digits(value, significant) if value >= 1e-3 else "< 0.001"


def extent_of(played: VerifiedTables) -> str:
    """Where a bound on interpolation holds."""
    return "over the workspace" if played.by_name else "along the axes through the datum"


def held_words(left: UncorrectedError) -> str:
    """`EX0C (20.1 of 21.0 µm remain)`: an error that a control cannot represent."""
    return f"{left.name} ({digits(left.rms / UM)} of {digits(left.before / UM)} µm remain)"


def grown_sentence(left: Sequence[UncorrectedError]) -> str:
    """Why more of some errors remains than there was; empty where nothing has grown."""
    grown = [one.name for one in left if one.rms > _GROWN * one.before]
    if not grown:
        return ""
    named = ", ".join(grown[:MAX_NAMED_ERRORS]) + (" ..." if len(grown) > MAX_NAMED_ERRORS else "")
    return (
        f"more of {named} remains than there was: a table is right on the lines through the datum; "
        "beside them, as after a turn of the table, its correction can add to the error. What "
        "remains of all errors together is the first figure"
    )


def left_out_sentence(axes: tuple[str, ...]) -> str:
    """Which axes have no table, and why."""
    which, it = ("a table is", "it") if len(axes) == 1 else ("tables are", "they")
    return (
        f"{which} left out for {', '.join(axes)}: {it} would raise the error beside the line "
        f"through the datum"
    )


def table_lines(played: VerifiedTables) -> Iterator[str]:
    """The heading of a control, and lines below it."""
    yield f"{control_title(played.format)}: {result_sentence(played.result)}"
    bound = small(played.interpolation / UM)
    yield f"interpolation and rounding leave at most {bound} µm {extent_of(played)}"
    if played.left_out:
        yield left_out_sentence(played.left_out)
    held = [left for left in played.result.left if left.rms > max(played.interpolation, 10 * NM)]
    if held:
        words = few([held_words(left) for left in held], MAX_NAMED_ERRORS)
        yield f"cannot represent, rms over the workspace, each by itself: {words}"
        if grown := grown_sentence(held):
            yield grown
    elif not played.left_out:
        yield "represents every error of the model"
