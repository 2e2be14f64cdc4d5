"""The part of a design page that says what the touches can and cannot tell apart."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from matstd.artefact.compare import Alone, IdentifiabilityReport
from matstd.information.identifiability import STRONG, Degree, FreedomFamily, Resolution, ties
from matstd.report.identifiability import (
    combination_words,
    family_words,
    gist,
    in_words,
    pair_words,
    reason_words,
    resolution_words,
    short,
)
from matstd.report.maps import draw_ties
from matstd.report.numbers import shown
from matstd.report.pages.design_result import Design
from matstd.report.pages.page import digits
from matstd.report.style import save
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG

CORRELATION = "correlation.png"
"""Picture of the parameters that the touches tie together."""

_SHOWN_COMBINATIONS = 20
_SHOWN_TIES = 12  # pairs; the others are folded
_COMPONENTS = 6


def known_content(design: Design, folder: Path) -> dict[str, Any]:
    """What the part shows; draws its picture.

    Args:
        design: What was made.
        folder: The results.
    """
    known = design.identifiability
    never = [f for f in known.freedoms if f.first.resolution is Resolution.NEVER]
    resolved = [f for f in known.freedoms if f not in never]
    names = [short(name) for name in known.model.names]
    units = [parameter.unit for _, parameter in known.model.parameters]
    return {
        "known": known,
        "gist": gist(known),
        "effective": design.effective,
        "conditions": _conditions(known),
        "degree_rows": _degree_rows(known),
        "alone": [_alone(a, known.chain) for a in known.alone],
        "combinations": [
            {
                "words": _with_minus(combination_words(names, units, c.weights, c.importance)),
                "u": _size(c.u, c.unit),
                "gain": c.gain,
            }
            for c in known.combinations[:_SHOWN_COMBINATIONS]
        ],
        "resolved": _by_cause(resolved, known.chain),
        "never": _by_cause(never, known.chain),
        "resolved_count": sum(f.count for f in resolved),
        "never_count": sum(f.count for f in never),
        **_ties(design, folder),
    }


def _size(value: float, unit: str) -> str:
    label, factor = shown(unit)
    return f"{digits(value / factor, 2)} {label}"


def _alone(alone: Alone, chain: Chain) -> dict[str, str]:
    expected, u = _size(alone.expected, alone.unit), _size(alone.u, alone.unit)
    return {"words": in_words(alone.name, chain), "expected": expected, "u": u}


def _conditions(known: IdentifiabilityReport) -> list[tuple[str, str]]:
    gauge = known.gauge
    found = {
        "every column brought to length one": gauge.condition,
        "parameters in units of their expected sizes": gauge.condition_prior,
        "parameters in µm and µrad": gauge.condition_raw,
    }
    return [(words, _rounded(value)) for words, value in found.items()]


def _rounded(value: float) -> str:
    """A large number with the digits that make sense, `15 000`."""
    return f"{float(f'{value:.2g}'):,.0f}".replace(",", "\u202f")


def _with_minus(words: str) -> str:
    """Signs of an equation as they are set in print."""
    return words.replace("= - ", "= −").replace(" - ", " − ")


def _degree_rows(known: IdentifiabilityReport) -> list[dict[str, Any]]:
    """A row an axis, a cell a component error."""
    by_symbol = {d.symbol: d for d in known.degrees}
    rows = []
    for axis in known.readings:
        link = known.chain.link(axis)
        symbols = [f"E{letter}{axis}" for letter in "XYZABC"[:_COMPONENTS]]
        rows.append(
            {
                "axis": axis,
                "what": "degrees" if link.kind == "linear" else "harmonics",
                "touched": _span(link, known.readings[axis]),
                "travel": _span(link, link.range),
                "cells": [_cell(by_symbol[s]) if s in by_symbol else ("", "") for s in symbols],
            }
        )
    return rows


def _span(link: Link, limits: Sequence[float]) -> str:
    unit, label = (1.0, "mm") if link.kind == "linear" else (DEG, "°")
    low, high = (f"{v / unit:.0f}".replace("-", "−") for v in limits)
    return f"{low} to {high} {label}"


def _cell(degree: Degree) -> tuple[str, str]:
    """Degrees that are supported, and how well the last is."""
    if not degree.supported:
        return "–", ""
    first, last = degree.supported[0], degree.supported[-1]
    which = f"{first}" if first == last else f"{first} to {last}"
    return which, f"± {_size(degree.u, degree.unit)}"


def _by_cause(freedoms: Sequence[FreedomFamily], chain: Chain) -> list[dict[str, Any]]:
    """Freedoms under what would resolve them and what makes them, in the order of their firsts."""

    def cause(family: FreedomFamily) -> tuple[str, str]:
        return resolution_words(family.first), reason_words(family.first)

    order = list(dict.fromkeys(map(cause, freedoms)))
    ranked = sorted(freedoms, key=lambda f: order.index(cause(f)))
    return [
        {
            "resolved_by": by,
            "why": why,
            "words": [_with_minus(family_words(f, chain)) for f in members],
        }
        for (by, why), members in groupby(ranked, key=cause)
    ]


def _ties(design: Design, folder: Path) -> dict[str, Any]:
    """Which parameters the touches tie together, short of never telling them apart."""
    fit = design.machines[0].fit
    found = ties(fit.covariance, [short(name) for name in fit.names])
    save(draw_ties(found), folder / CORRELATION)
    words = [pair_words(pair, found.names) for pair in found.pairs]
    return {"ties": found, "tied": words, "ties_limit": STRONG, "ties_first": _SHOWN_TIES}
