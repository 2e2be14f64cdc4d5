"""Section of the set-up sheet on a head that carries the tool: where it turns, what it sweeps."""

import numpy as np

from matstd.artefact.tool import NOSE_HEIGHT
from matstd.probe_paths.plan import LINEAR, TouchPlan
from matstd.report.layout import Section, Table
from matstd.twin.frames import Array
from matstd.twin.units import DEG

_SPACE = (
    "Space that ball, probe and spindle nose sweep while the head turns, with Z retracted. Machine "
    "coordinates, as of the gauge point of the upright head"
)
_UNSTATED = (
    f"The fork, and the spindle farther than {NOSE_HEIGHT:g} mm above the gauge line, are not "
    "among the bodies that are kept clear, and no key of the project states them. Side walls, "
    "covers and a tool magazine are not known either unless they stand under [[workshop.bodies]]. "
    "Keep the space of this table, and that of the fork round it, free of them."
)


def head_sections(plan: TouchPlan) -> list[Section]:
    """Where the head turns and what it sweeps, if a rotary axis carries the tool."""
    turns = plan.head_turns
    if turns is None:
        return []
    chain = plan.chain
    travel = np.array([chain.link(a).range for a in LINEAR]).T
    rows = [
        ["the head turns at", *(f"{v:g}" for v in turns.place)],
        ["the programs sweep", *_spans(turns.planned)],
        ["from any position of the head", *_spans(turns.anywhere)],
        ["travel", *_spans(travel)],
    ]
    angles = " and ".join(
        f"{name} from {low / DEG:.4g}° to {high / DEG:.4g}°"
        for name, (low, high) in zip(chain.tool_rotary_axes, turns.limits, strict=True)
    )
    margin = 0.5 * plan.options.clearance
    notes = [
        f"The programs turn {angles}, at this place only, with X and Y in machine coordinates. The "
        "first turn of each begins where the tool change leaves the head, and is fed.",
        f"In all turns of the programs, ball, probe and spindle nose stay at least {margin:g} "
        "mm higher than standard, table and all stated bodies.",
        *(
            f"{a} moves the table, not the head: seen from the spindle, the programs sweep "
            f"{span} mm in {a}."
            for a, span, is_table in zip(
                LINEAR,
                _spans(turns.planned - turns.place),
                (chain.link(a).carries_workpiece for a in LINEAR),
                strict=True,
            )
            if is_table
        ),
    ]
    columns = ("", *(f"{a} in mm" for a in LINEAR))
    beyond = np.maximum(travel[0] - turns.planned[0], turns.planned[1] - travel[1])[:2]
    warnings = [
        f"The programs sweep up to {np.ceil(more):.0f} mm beyond the travel of {a}."
        for a, more in zip("XY", beyond, strict=True)
        if more > 0.0
    ]
    return [
        Section(
            "Turns of the head",
            table=Table(columns, rows, _SPACE),
            notes=notes,
            warnings=[*warnings, _UNSTATED],
        )
    ]


def _spans(ends: Array) -> list[str]:
    """Spans of X, Y and Z (2, 3) in whole mm, rounded outwards."""
    low, high = np.floor(ends[0]) + 0.0, np.ceil(ends[1]) + 0.0
    return [f"{a:.0f} to {b:.0f}" for a, b in zip(low, high, strict=True)]
