"""What touches on a standard can and cannot know of a machine: one record for report and file."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from artefact.alternatives import Alternative, alternatives, both, tried_in, ways
from artefact.criterion import Criterion
from artefact.touchable import Requests
from sensitivity.combinations import EstimableCombination, combinations
from sensitivity.degrees import Degree, supported_degrees
from sensitivity.identifiability import Identifiability, identifiability
from sensitivity.information import Posterior
from twin.files.whole import write_whole
from twin.symbols import Family
from twin.units import shown

FORMAT = "identifiability/1"
"""Of the file."""


@dataclass(frozen=True, eq=False)
class Knowable:
    """What a design's touches can and cannot know.

    Attributes:
        touches: Their number.
        gauge: Rank, condition numbers, freedoms and groups, each freedom with what resolves it.
        combinations: Combinations of machine errors that are determined, the surest first.
        alone: Parameters whose variance falls at least tenfold.
        degrees: Of every component error, to which degree the touches support it.
        alternatives: What a second stylus length or a second set-up would buy.
    """

    touches: int
    gauge: Identifiability
    combinations: tuple[EstimableCombination, ...]
    alone: tuple[str, ...]
    degrees: tuple[Degree, ...]
    alternatives: tuple[Alternative, ...]

    @property
    def words(self) -> str:
        """The gist in one sentence."""
        g = self.gauge
        never = sum(f.resolved_by.startswith("nothing") for f in g.freedoms)
        return (
            f"{self.touches} touches see {g.rank} combinations of {g.parameters} parameters; "
            f"of the {len(g.freedoms)} freedoms that stay, {never} are of the machine and no touch "
            f"on a workpiece shows them"
        )


def knowable(aim: Criterion, requests: Requests, rng: np.random.Generator) -> Knowable:
    """What some touches can know of the machine.

    Args:
        aim: Machine, expected errors, noise.
        requests: The touches.
        rng: Draws the touches that alternatives are tried with.
    """
    model, touches = aim.model, aim.probing.touches(requests)
    W = aim.whitened(requests)
    more = tried_in(aim.probing, requests, rng)
    richer = {"more touches at the same table poses": aim.whitened(more)}
    for name, way in ways(aim).items():
        second = tried_in(way, requests, rng)
        if len(second):
            richer[name] = both(aim, requests, second, way).W
    units = [p.unit for _, p in model.parameters]
    symbols = [getattr(effect, "symbol", None) for effect, _ in model.parameters]
    setup = [p for p, s in enumerate(symbols) if s is not None and s.family is Family.SETUP]
    return Knowable(
        touches=len(requests),
        gauge=identifiability(W, aim.prior_sd, model.names, model.parameters, model.chain, richer),
        combinations=combinations(W, aim.prior_sd, model.names, units, setup),
        alone=Posterior(W, aim.prior_sd, model.names).alone,
        degrees=supported_degrees(model, touches, W, aim.noise),
        alternatives=alternatives(aim, requests, rng),
    )


def as_json(known: Knowable) -> dict[str, Any]:
    """The record as plain data, units in the names of the keys."""
    g = known.gauge
    return {
        "format": FORMAT,
        "words": known.words,
        "touches": known.touches,
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
        "alone": list(known.alone),
        "degrees": [asdict(d) for d in known.degrees],
        "alternatives": [asdict(a) for a in known.alternatives],
    }


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")


def write_identifiability(path: Path, known: Knowable) -> None:
    """Write the record as a JSON file, whole or not at all."""
    write_whole(path, json.dumps(as_json(known), indent=1, ensure_ascii=False) + "\n")
