"""identifiability.json: what the touches of a design can and cannot determine."""

from dataclasses import asdict
from typing import Any

from matstd.artefact.compare import Alternative, IdentifiabilityReport
from matstd.information.identifiability import Degree
from matstd.report.identifiability.identifiability_words import (
    combination_words,
    degree_words,
    freedom_words,
    gist,
    group_words,
    in_words,
    reason_words,
    resolution_words,
    short,
)
from matstd.report.numbers import shown
from matstd.twin.machine import Chain, Link
from matstd.twin.numbers import significant

FORMAT = "identifiability/1"  # format of the file


def identifiability_table(known: IdentifiabilityReport) -> dict[str, Any]:
    """The record as plain data, units in the names of the keys."""
    g, chain = known.gauge, known.chain
    names = [short(name) for name in known.model.names]
    units = [parameter.unit for _, parameter in known.model.parameters]
    return {
        "format": FORMAT,
        "words": gist(known),
        "touches": known.touches,
        "readings": dict(_reading(known.chain.link(a), known.readings[a]) for a in known.readings),
        "parameters": g.parameters,
        "rank": g.rank,
        "condition": {
            "columns_of_length_one": significant(g.condition),
            "in_units_of_expected_sizes": significant(g.condition_prior),
            "per_um_and_urad": significant(g.condition_raw),
        },
        "freedoms": [
            {
                "parameter": f.parameter,
                "words": freedom_words(f, chain),
                "why": reason_words(f),
                "resolved_by": resolution_words(f),
                "alike": [{"parameter": t.name, "per_unit": significant(t.value)} for t in f.alike],
            }
            for f in g.freedoms
        ],
        "groups": [
            asdict(group) | {"words": group_words(group.members, group.known)} for group in g.groups
        ],
        "combinations": [
            {
                "words": combination_words(names, units, c.weights, c.importance),
                "u": significant(c.u / shown(c.unit)[1]),
                "unit": shown(c.unit)[0],
                "prior_over_posterior": significant(c.gain),
            }
            for c in known.combinations
        ],
        "alone": [
            {
                "parameter": a.name,
                "words": in_words(a.name, chain),
                "expected": significant(a.expected / shown(a.unit)[1]),
                "u": significant(a.u / shown(a.unit)[1]),
                "unit": shown(a.unit)[0],
            }
            for a in known.alone
        ],
        "degrees": [_degree(d, chain) for d in known.degrees],
        "alternatives": [_alternative(a) for a in known.alternatives],
    }


def _alternative(other: Alternative) -> dict[str, Any]:
    plain = {key: value for key, value in asdict(other).items() if key != "refusal"}
    return plain | {"words": _alternative_words(other)}


def _alternative_words(other: Alternative) -> str:
    """Benefit of another stylus length or set-up."""
    if not other.is_possible:
        return f"{other.name}: {other.refusal}"
    gained, ratio = other.rank_gained, other.variance_ratio
    seen = f"{gained or 'no'} additional combinations of machine errors visible"
    change = f"{100 * abs(ratio - 1.0):.0f} % {'less' if ratio < 1.0 else 'more'}"
    return (
        f"{other.name}: {seen}; mean predicted variance of the tool point {change} at equal touches"
    )


def _reading(link: Link, limits: tuple[float, float]) -> tuple[str, list[float]]:
    return link.column, [significant(v / link.unit) for v in limits]


def _degree(degree: Degree, chain: Chain) -> dict[str, Any]:
    label, factor = shown(degree.unit)
    return {
        "parameter": degree.symbol,
        "supported": list(degree.supported),
        "largest": degree.largest,
        "u": significant(degree.u / factor),
        "unit": label,
        "words": degree_words(degree, chain),
    }
