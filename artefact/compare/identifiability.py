"""What touches on a standard can and cannot know of a machine: one record for report and file."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from artefact.compare.alternatives import (
    Alternative,
    alternatives,
    joined_rows,
    other_setups,
    setup_parameters,
    touches_reached_in,
)
from artefact.reach import Requests
from artefact.worth import Criterion
from information.criteria import Posterior
from information.identifiability import (
    NEVER,
    Degree,
    EstimableCombination,
    FreedomWords,
    Identifiability,
    combinations,
    identifiability,
    in_families,
    in_words,
    short,
    supported_degrees,
)
from twin.files import write_whole
from twin.frames import Array
from twin.machine import Chain, Link
from twin.units import DEG, shown

FORMAT = "identifiability/1"
"""Of the file."""


@dataclass(frozen=True)
class Alone:
    """A parameter whose variance the touches cut at least tenfold; base units.

    Attributes:
        name: Of the parameter.
        words: What it is.
        expected: Standard deviation before the touches.
        u: Standard uncertainty after them.
        unit: Base unit.
    """

    name: str
    words: str
    expected: float
    u: float
    unit: str


@dataclass(frozen=True, eq=False)
class IdentifiabilityReport:
    """What a design's touches can and cannot know.

    Attributes:
        touches: Their number.
        chain: The machine.
        readings: Smallest and largest reading of every programmed axis in them, mm or rad.
        gauge: Rank, condition numbers, freedoms and groups, each freedom with what resolves it.
        freedoms: The freedoms in words; shapes of the same error share a line.
        combinations: Combinations of machine errors that are determined, the surest first.
        alone: Machine errors that are known for themselves, the surest first.
        degrees: Of every component error, to which degree the touches support it.
        alternatives: What a second stylus length or a second set-up would buy.
    """

    touches: int
    chain: Chain
    readings: Mapping[str, tuple[float, float]]
    gauge: Identifiability
    freedoms: tuple[FreedomWords, ...]
    combinations: tuple[EstimableCombination, ...]
    alone: tuple[Alone, ...]
    degrees: tuple[Degree, ...]
    alternatives: tuple[Alternative, ...]

    @property
    def words(self) -> str:
        """The gist in one sentence."""
        g = self.gauge
        never = sum(f.resolved_by == NEVER for f in g.freedoms)
        return (
            f"{self.touches} touches see {g.rank} independent combinations of {g.parameters} "
            f"parameters. Of the {len(g.freedoms)} that stay free, {never} are free on every "
            f"workpiece and fixed by convention"
        )


def identifiability_report(
    criterion: Criterion, requests: Requests, rng: np.random.Generator
) -> IdentifiabilityReport:
    """What some touches can know of the machine.

    Args:
        criterion: Machine, expected errors, noise.
        requests: The touches.
        rng: Draws the touches that alternatives are tried with.
    """
    model, touches = criterion.model, criterion.reach.touches(requests)
    W = criterion.whitened(requests)
    more = touches_reached_in(criterion.reach, requests, rng)
    richer = {"more touches at the same table poses": criterion.whitened(more)}
    for name, other in other_setups(criterion).items():
        second = touches_reached_in(other, requests, rng)
        if len(second):
            richer[name] = joined_rows(criterion, requests, second, other).W
    gauge = identifiability(
        W, criterion.prior_sd, model.names, model.parameters, model.chain, richer
    )
    units = [p.unit for _, p in model.parameters]
    setup = setup_parameters(criterion)
    names = [short(name) for name in model.names]
    chain = model.chain
    return IdentifiabilityReport(
        touches=len(requests),
        chain=chain,
        readings={
            name: (float(touches.reading(name).min()), float(touches.reading(name).max()))
            for name in chain.programmed_axes
        },
        gauge=gauge,
        freedoms=in_families(gauge.freedoms, chain),
        combinations=combinations(W, criterion.prior_sd, names, units, setup.tolist()),
        alone=_alone(criterion, W, setup.tolist()),
        degrees=supported_degrees(model, touches, W, criterion.noise),
        alternatives=alternatives(criterion, requests, rng),
    )


def _alone(criterion: Criterion, W: Array, setup: Sequence[int]) -> tuple[Alone, ...]:
    """Machine errors that are known for themselves; the set-up is of no interest."""
    known = Posterior(W, criterion.prior_sd, criterion.model.names)
    alone = set(known.alone)
    out = [
        Alone(
            name, in_words(name, criterion.model.chain), float(before), float(after), parameter.unit
        )
        for p, (name, before, after, (_, parameter)) in enumerate(
            zip(known.names, known.prior_sd, known.sd, criterion.model.parameters, strict=True)
        )
        if name in alone and p not in setup
    ]
    return tuple(sorted(out, key=lambda a: a.u / a.expected))


def as_json(known: IdentifiabilityReport) -> dict[str, Any]:
    """The record as plain data, units in the names of the keys."""
    g = known.gauge
    return {
        "format": FORMAT,
        "words": known.words,
        "touches": known.touches,
        "readings": dict(_reading(known.chain.link(a), known.readings[a]) for a in known.readings),
        "parameters": g.parameters,
        "rank": g.rank,
        "condition": {
            "columns_of_length_one": _rounded(g.condition),
            "in_units_of_expected_sizes": _rounded(g.condition_prior),
            "per_um_and_urad": _rounded(g.condition_raw),
        },
        "freedoms": [
            {
                "parameter": f.parameter,
                "words": f.words,
                "why": f.why,
                "resolved_by": f.resolved_by,
                "alike": [{"parameter": n, "per_unit": _rounded(v)} for n, v in f.alike],
            }
            for f in g.freedoms
        ],
        "groups": [asdict(group) for group in g.groups],
        "combinations": [
            {
                "words": c.words,
                "u": _rounded(c.u / shown(c.unit)[1]),
                "unit": shown(c.unit)[0],
                "prior_over_posterior": _rounded(c.gain),
            }
            for c in known.combinations
        ],
        "alone": [
            {
                "parameter": a.name,
                "words": a.words,
                "expected": _rounded(a.expected / shown(a.unit)[1]),
                "u": _rounded(a.u / shown(a.unit)[1]),
                "unit": shown(a.unit)[0],
            }
            for a in known.alone
        ],
        "degrees": [_degree(d) for d in known.degrees],
        "alternatives": [asdict(a) for a in known.alternatives],
    }


def _reading(link: Link, limits: tuple[float, float]) -> tuple[str, list[float]]:
    suffix, unit = ("_mm", 1.0) if link.kind == "linear" else ("_deg", DEG)
    return link.name + suffix, [_rounded(v / unit) for v in limits]


def _degree(degree: Degree) -> dict[str, Any]:
    label, factor = shown(degree.unit)
    return {
        "parameter": degree.symbol,
        "supported": list(degree.supported),
        "largest": degree.largest,
        "u": _rounded(degree.u / factor),
        "unit": label,
        "words": degree.words,
    }


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def write_identifiability(path: Path, known: IdentifiabilityReport) -> None:
    """Write the record as a JSON file, whole or not at all."""
    write_whole(path, json.dumps(as_json(known), indent=1, ensure_ascii=False) + "\n")
