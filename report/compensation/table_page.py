"""The page of a compensation: what it corrects, what remains, how to test its sign."""

from collections.abc import Sequence
from pathlib import Path

from matstd.compensation.field import MachineErrors, Result
from matstd.compensation.tables import Header, VerifiedTables
from matstd.report.compensation.compensation_pictures import draw_errors_left, draw_shares
from matstd.report.compensation.compensation_words import (
    SMALLEST_OF_TOOL,
    control_title,
    extent_of,
    grown_sentence,
    left_out_sentence,
    poses_words,
    result_sentence,
    small,
)
from matstd.report.layout import KeyFigure, Page, Picture, Section, Table, write_page
from matstd.report.numbers import capital, digits, signed, with_uncertainty
from matstd.twin.machine import Chain
from matstd.twin.numbers import rms_length
from matstd.twin.units import DEG, UM

SMALLEST_LISTED = 1e-2 * UM
"""Errors below this size are not listed: 10 nm are below the resolution of the tables."""

_MEANS = (
    "The figures are what the tables do on the exact twin with the estimates as the truth, and "
    "what the model does not know. They hold in the state, with the datum and for the machine that "
    "are named above."
)
_NEXT = (
    "Enter one table, run its one-point test, then probe the standard again "
    "and compare (`matstd compare RUN.csv --model`)."
)
_FIGURES = (
    "All figures are deviations of the tool point in the table frame with the workpiece aligned: "
    "the best-fit rigid motion is removed, since presets and alignment are determined on the "
    "machine itself (determine them with the tables active). Each file was read back from its "
    "text by a separate reader and applied on the exact twin, with the estimates of the model as "
    "the truth; the uncertainty of the model comes in addition."
)
_TOOLS = (
    "This holds for tools whose length and offset are set relative to the probe of the "
    "measurement. For other tools add {u} µm rms: a run with one probe cannot distinguish the "
    "position of the probe in the spindle from the lines of the rotary axes."
)
_TEST = (
    "Zero an indicator at the datum, move {moved} alone, to {place}, and read it again: along the "
    "motion against a gauge block, across it against a straightedge. Check first that the way is "
    "free: this page does not know the table, the clamps and the spindle. The change is exact; the "
    "other figures carry the uncertainty of the model. If the indicator changes in the opposite "
    "direction (sign wrong), write the tables again with `--opposite {name}`."
)


def write_compensation_page(
    folder: str | Path,
    errors: MachineErrors,
    head: Header,
    done: Sequence[VerifiedTables],
    title: str,
) -> None:
    """Write `report.html` and its pictures into a folder."""
    first = done[0].result
    is_noted = first.u_tool > SMALLEST_OF_TOOL
    tools = _TOOLS.format(u=digits(first.u_tool / UM, 2)) if is_noted else ""
    names = ", ".join(f"`{name}`" for name in errors.left_out)
    results = {control_title(p.format): p.result for p in done}
    overview = "Error of the tool point over the workspace, before and after."
    page = Page(
        heading=f"Compensation with {title}",
        lead=f"{head.machine}; datum {head.datum}; state {head.state}; model {head.model}.",
        means=_MEANS,
        next=_NEXT,
        key=_key(first, done),
        sections=[
            Section(
                sentences=[" ".join(filter(None, (_FIGURES, tools)))],
                pictures=[Picture("pictures/left.png", overview, draw_errors_left(results))],
                notes=[f"Not errors of the axes, and in no table: {names}."] if names else [],
            ),
            *(section for p in done for section in _control(p, errors.chain)),
        ],
    )
    write_page(Path(folder) / "report.html", page)


def _key(first: Result, done: Sequence[VerifiedTables]) -> list[KeyFigure]:
    before = f"error of the tool point before, rms of {poses_words(first)}"
    u = first.u_rms / UM
    known = (
        KeyFigure(f"{digits(u, 2)} µm", "standard uncertainty of the model, rms")
        if u > 0.0
        else KeyFigure("–", "uncertainty unknown: these errors were stated, not estimated")
    )
    # what the model does not know remains with every table
    after = [
        KeyFigure(
            f"{small(p.result.expected / UM, 2)} µm",
            f"to expect with {control_title(p.format)}, rms; "
            f"{small(rms_length(p.result.after) / UM)} µm if the model were exact",
        )
        for p in done
    ]
    return [KeyFigure(f"{digits(rms_length(first.before) / UM)} µm", before), known, *after]


def _control(played: VerifiedTables, chain: Chain) -> list[Section]:
    """One control: its figures, what it cannot represent, its one-point test."""
    result, least = played.result, max(played.interpolation, SMALLEST_LISTED)
    rows = [
        [e.name, digits(e.before / UM), with_uncertainty(e.rms / UM, e.u / UM or None)]
        for e in result.left
        if e.rms > least
    ]
    pictures = []
    if any(e.rms >= least for e in result.left):
        caption = "Each error by itself: before, and what remains with the table."
        drawn = draw_shares(result.left)
        pictures.append(Picture(f"pictures/{played.format}.png", caption, drawn))
    caption = (
        "Errors that this format cannot represent, µm rms over the workspace, each by itself; "
        "together they partly offset each other"
    )
    words = (
        f"{result_sentence(result)}. Interpolation and rounding leave at most "
        f"{small(played.interpolation / UM, 2)} µm {extent_of(played)}. "
        f"Files: {', '.join(played.files)}."
    )
    held = []
    if grown := grown_sentence([e for e in result.left if e.rms > least]):
        held = [f"{capital(grown)}."]
    if played.left_out:
        held.append(f"{capital(left_out_sentence(played.left_out))}.")
    elif not rows:
        held = ["It represents every error of the model."]
    return [
        Section(
            control_title(played.format),
            sentences=[words, *held],
            table=Table(("error", "before", "remaining"), rows, caption),
            pictures=pictures,
        ),
        _one_point_test(played, chain),
    ]


def _one_point_test(played: VerifiedTables, chain: Chain) -> Section:
    """Readings of an indicator that prove the sign of a table."""
    test = played.acceptance
    place = []
    for name in chain.programmed_axes:
        unit, label = (DEG, "°") if chain.link(name).kind == "rotary" else (1.0, " mm")
        place.append(f"{name} {test.q[chain.axis_index(name)] / unit + 0.0:.1f}{label}")
    rows = [
        [label, *(_cell(v / UM, u / UM) for v, u in zip(values, test.u, strict=True))]
        for label, values in (
            ("table off", test.without),
            ("table on", test.with_table),
            ("table on, sign wrong", test.wrong_sign),
        )
    ]
    change = (test.with_table - test.without) / UM
    rows.append(["change when switched on", *(_cell(v, 0.0) for v in change)])
    caption = "Deviation of the tool point relative to the datum, table frame, µm"
    return Section(
        "One-point test of the sign",
        is_part=True,
        sentences=[_TEST.format(moved=test.axis, place=", ".join(place), name=played.format)],
        table=Table(("", "x", "y", "z"), rows, caption),
    )


def _cell(value: float, u: float) -> str:
    """A deviation in µm: no indicator shows a nanometre."""
    return "0" if max(abs(value), u) < 1e-3 else signed(value, u or None)
