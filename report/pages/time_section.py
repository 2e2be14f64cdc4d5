"""Time on the machine in the report of a design: of every artefact, and of every order."""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.brief import Brief
from matstd.artefact.place import Placement
from matstd.probe_paths.plan import TouchPlan
from matstd.probe_paths.stations import Ordering, orders, probing_time
from matstd.report.layout import Table
from matstd.report.numbers import digits, percent, um
from matstd.twin.units import HOUR, MINUTE, UM, URAD
from matstd.twin.words import listed

_ORDERINGS = {
    Ordering.AS_PLANNED: "as planned: mixed, twice, from both sides, anchor touches",
    Ordering.WITHOUT_ANCHORS: "as planned, without the anchor touches",
    Ordering.ONCE: "mixed, each pose once",
    Ordering.SHORTEST: "shortest paths, each pose once, from either side",
}
_CAPTION = (
    "Cost and benefit of the order: standard deviations of a steady drift of the set-up (its worst "
    "direction) and of the reversal of the rotary axes, each of unknown size, fitted together with "
    "all errors of the machine; {noise} noise, all touches in one program"
)


@dataclass(frozen=True)
class MachineTimes:
    """What time on the machine buys."""

    minutes: dict[str, float]  # of every artefact, by name; nan without a body
    orders: Table  # orders in which the same touches could be made
    words: str  # cost of the planned order, and time of the touches that prove


def machine_times(brief: Brief, placement: Placement, plan: TouchPlan) -> MachineTimes:
    """Time on the machine of every artefact, and of every order of a plan's touches."""
    table, words = _order_content(placement, plan, brief.noise)
    return MachineTimes(
        minutes=_minutes(brief, placement, plan),
        orders=table,
        words=f"{words} {_proof_words(brief, placement, plan)}".rstrip(),
    )


def _minutes(brief: Brief, placement: Placement, plan: TouchPlan) -> dict[str, float]:
    """Minutes on the machine by artefact, by one planner and one clock; nan without a body."""
    found = {}
    for rival in placement.rivals:
        seconds = np.nan
        if rival.body is not None:
            seconds = probing_time(
                rival.body, brief.chain, plan.probe, brief.setup, rival.touches, plan.options
            )
        found[rival.name] = float(seconds) / MINUTE
    return found


def _proof_words(brief: Brief, placement: Placement, plan: TouchPlan) -> str:
    """Time of the proving touches in a visit of their own; empty where none can be planned.

    They are planned as the programs are, and with each table pose once: half as many motions of
    rotary axes, which then come from one side alone.
    """
    once = replace(plan.options, shortest_visit=len(placement.proof) + 1)
    body, chain, setup = placement.standard, brief.chain, brief.setup
    as_planned, quicker = (
        probing_time(body, chain, plan.probe, setup, placement.proof, options) / MINUTE
        for options in (plan.options, once)
    )
    if not np.isfinite(as_planned + quicker):
        return ""
    return (
        f"In a visit of their own, the {len(placement.proof)} proving touches take "
        f"{as_planned:.0f} minutes, or {quicker:.0f} with each pose once."
    )


def _order_content(placement: Placement, plan: TouchPlan, noise: float) -> tuple[Table, str]:
    """Orders in which the same touches could be made, and what the planned one costs."""
    found = orders(plan, placement.criterion.model, noise)
    planned, quickest = found[0], min(found, key=lambda order: order.duration)
    axes = plan.chain.rotary_axes
    rows = [
        [
            _ORDERINGS[order.ordering],
            str(order.touches),
            f"{order.duration / MINUTE:.0f}",
            digits(order.drift / UM),
            digits(order.drift * order.duration / HOUR / UM),
            *(digits(value / URAD) for value in order.reversal),
        ]
        for order in found
    ]
    columns = ("order", "touches", "minutes", "drift, µm/h", "drift over\nthe whole run, µm")
    reversals = [f"reversal of {axis}, µrad" for axis in axes]
    table = Table((*columns, *reversals), rows, _CAPTION.format(noise=um(noise)))
    better = [
        f"the reversal of {axis} by a factor of {there / here:.1f}"
        for axis, here, there in zip(axes, planned.reversal, quickest.reversal, strict=True)
    ]
    better.insert(0, f"the rate of a drift by a factor of {quickest.drift / planned.drift:.1f}")
    longer = (planned.duration - quickest.duration) / MINUTE
    share = percent(planned.duration / quickest.duration - 1.0)
    return table, (
        f"This order takes {longer:.0f} minutes longer than the shortest paths ({share}). It "
        f"reduces the uncertainty of {listed(better)}."
    )
