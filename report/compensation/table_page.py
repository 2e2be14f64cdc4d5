"""The page of a compensation: what is corrected, what is left, how to try its sign."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matstd.compensation.field import MachineErrors
from matstd.compensation.tables import Header, Played
from matstd.report.compensation.table_pictures import draw_errors_left, draw_shares
from matstd.report.compensation.table_words import control_title, result_sentence, small
from matstd.report.numbers import digits, signed, with_uncertainty
from matstd.report.pages import Picture, write_page
from matstd.twin.machine import Chain
from matstd.twin.numbers import rms_length
from matstd.twin.units import DEG, UM

PAGE = "report.html"
PICTURES = "pictures"


def write_compensation_page(
    folder: str | Path, errors: MachineErrors, head: Header, done: Sequence[Played], title: str
) -> None:
    """Draw the pictures of tables and write their page, which stands alone.

    Args:
        folder: Where `report.html` and the folder `pictures` go.
        errors: Of the machine.
        head: Of the tables.
        done: Tables of every control.
        title: Name of the model file.
    """
    place = Path(folder) / PICTURES
    place.mkdir(parents=True, exist_ok=True)
    draw_errors_left(place / "left.png", {control_title(p.format): p.result for p in done})
    first = done[0].result
    write_page(
        Path(folder) / PAGE,
        "compensation.html",
        place=place,
        title=title,
        head=head,
        poses=len(first.q),
        before=rms_length(first.before) / UM,
        model_u=first.u_rms / UM,
        tool_u=first.u_tool / UM,
        left_out=errors.left_out,
        controls=[_control(place, p, errors.chain) for p in done],
        overview=Picture(
            "left.png", "Error of the tool point over the workspace, before and after."
        ),
    )


def _control(place: Path, played: Played, chain: Chain) -> dict[str, Any]:
    """One control: its figures, what it cannot hold, its one-point test."""
    file = f"{played.format}.png"
    held = [x for x in played.result.left if x.rms < max(played.interpolation, 1e-2 * UM)]
    has_picture = len(held) < len(played.result.left)
    if has_picture:
        draw_shares(place / file, played.result.left)
    result = played.result
    return {
        "name": played.format,
        "title": control_title(played.format),
        "files": ", ".join(played.files),
        "sentence": result_sentence(result),
        "after": small(rms_length(result.after) / UM),
        "expected": small(result.expected / UM, 2),
        "interpolation": small(played.interpolation / UM, 2),
        "where": "over the workspace" if played.by_name else "along the axes through the datum",
        "by_name": played.by_name,
        "left": [
            {
                "name": item.name,
                "before": digits(item.before / UM),
                "rms": with_uncertainty(item.rms / UM, item.u / UM or None),
            }
            for item in result.left
            if item.rms > played.interpolation and item.rms > 1e-2 * UM
        ],
        "picture": has_picture
        and Picture(file, "Every error by itself: before, and what the table leaves."),
        "test": _test(played, chain),
    }


def _test(played: Played, chain: Chain) -> dict[str, Any]:
    """The one-point test in words."""
    test = played.acceptance
    words = []
    for name in chain.programmed_axes:
        is_rotary = chain.link(name).kind == "rotary"
        at = test.q[chain.axis_index(name)] / (DEG if is_rotary else 1.0) + 0.0
        words.append(f"{name} {at:.1f}{'°' if is_rotary else ' mm'}")
    rows = []
    for label, values in (
        ("table off", test.without),
        ("table on", test.with_table),
        ("table on, sign wrong", test.wrong_sign),
    ):
        u = test.u / UM
        cells = [_cell(v / UM, s) for v, s in zip(values, u, strict=True)]
        rows.append({"label": label, "cells": cells})
    change = (test.with_table - test.without) / UM
    rows.append({"label": "change by switching it on", "cells": [_cell(v, 0.0) for v in change]})
    return {"place": ", ".join(words), "rows": rows}


def _cell(value: float, u: float) -> str:
    """A deviation in µm: no indicator shows a nanometre."""
    return "0" if max(abs(value), u) < 1e-3 else signed(value, u or None)
