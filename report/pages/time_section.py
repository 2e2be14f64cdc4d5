"""Time on the machine in the report of a design: of every artefact, and of every order."""

from dataclasses import replace
from typing import Any

import numpy as np

from matstd.probe_paths.campaign import Order, Ordering, orders, probing_time
from matstd.report.numbers import percent
from matstd.report.pages.design_result import Design
from matstd.twin.units import HOUR, MINUTE, UM, URAD

_ORDERINGS = {
    Ordering.AS_PLANNED: "as planned: mixed, twice, from both sides, anchor touches",
    Ordering.WITHOUT_ANCHORS: "the same without the anchor touches",
    Ordering.ONCE: "mixed, every pose once",
    Ordering.SHORTEST: "shortest ways, every pose once, from whichever side",
}


def minutes(design: Design) -> dict[str, float]:
    """Minutes on the machine by artefact, by one planner and one clock; nan without a body."""
    brief, placement = design.brief, design.placement
    probe = design.plan.probe
    found = {}
    for rival in placement.rivals:
        seconds = np.nan
        if rival.body is not None:
            seconds = probing_time(
                rival.body, brief.chain, probe, brief.setup, rival.touches, design.plan.options
            )
        found[rival.name] = float(seconds) / MINUTE
    return found


def proof_words(design: Design) -> str:
    """How long the proving touches take in a visit of their own; empty where none can be planned.

    They are planned as the programs are, and with every table pose once: half as many motions of
    rotary axes, which then come from one side alone.
    """
    brief, placement, plan = design.brief, design.placement, design.plan
    once = replace(plan.options, shortest_visit=len(placement.proof) + 1)
    body, chain, setup = placement.standard, brief.chain, brief.setup
    as_planned, quicker = (
        probing_time(body, chain, plan.probe, setup, placement.proof, options) / MINUTE
        for options in (plan.options, once)
    )
    if not np.isfinite(as_planned + quicker):
        return ""
    return (
        f"In a visit of their own the {len(placement.proof)} touches that prove take "
        f"{as_planned:.0f} minutes, {quicker:.0f} with every pose once."
    )


def order_content(design: Design) -> dict[str, Any]:
    """Table of the orders in which the same touches could be made, and its sentence."""
    found = orders(design.plan, design.placement.criterion.model, design.brief.noise)
    planned, quickest = found[0], min(found, key=lambda order: order.duration)
    return {
        "orders": [_row(order) for order in found],
        "proof_words": proof_words(design),
        "rotary_axes": design.plan.chain.rotary_axes,
        "order_words": (
            f"The order costs {(planned.duration - quickest.duration) / MINUTE:.0f} minutes more "
            f"than the shortest ways ({percent(planned.duration / quickest.duration - 1.0)}). "
            f"For that the rate of a drift is known {quickest.drift / planned.drift:.1f} times "
            f"better"
            f"{_reversals(planned, quickest, design.plan.chain.rotary_axes)}."
        ),
    }


def _row(order: Order) -> dict[str, Any]:
    return {
        "name": _ORDERINGS[order.ordering],
        "touches": order.touches,
        "minutes": order.duration / MINUTE,
        "drift_um_h": order.drift / UM,
        "drift_um": order.drift * order.duration / HOUR / UM,
        "reversal_urad": [value / URAD for value in order.reversal],
    }


def _reversals(planned: Order, quickest: Order, axes: tuple[str, ...]) -> str:
    words = [
        f"the reversal of {axis} {there / here:.1f} times"
        for axis, here, there in zip(axes, planned.reversal, quickest.reversal, strict=True)
    ]
    return ", " + " and ".join(words) if words else ""
