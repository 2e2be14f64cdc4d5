"""One campaign of several probes and several clampings of one standard.

In: a brief's wishes for the programs, the touches that are wanted, the probes and the places of the
standard. Out: a `Station` for every probe in every clamping, with its plan and its programs, in the
order in which they are run. Their logs are evaluated together
(`matstd.probe_paths.campaign.evaluate`). `orders` and `probing_time` estimate the cost of a plan.
"""

from matstd.probe_paths.stations.from_brief import (
    Station,
    all_programs,
    dialects_of,
    feeds_of,
    make_stations,
    plan_options_of,
)
from matstd.probe_paths.stations.order_study import Ordering, orders, probing_time
from matstd.probe_paths.stations.planned import plan_campaign

__all__ = [
    "Ordering",
    "Station",
    "all_programs",
    "dialects_of",
    "feeds_of",
    "make_stations",
    "orders",
    "plan_campaign",
    "plan_options_of",
    "probing_time",
]
