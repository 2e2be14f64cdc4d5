"""One campaign of several probes and several clampings of one standard.

In: a brief's wishes for the programs, the touches that are wanted, the probes and the places of the
standard. Out: a `Station` for every probe in every clamping, with its plan and its programs, in the
order in which they are run. Their logs are evaluated together
(`matstd.probe_paths.campaign.evaluate`). `orders` and `probing_time` estimate the cost of a plan.
"""

from matstd.probe_paths.stations.from_brief import Station as Station
from matstd.probe_paths.stations.from_brief import all_programs as all_programs
from matstd.probe_paths.stations.from_brief import dialects_of as dialects_of
from matstd.probe_paths.stations.from_brief import feeds_of as feeds_of
from matstd.probe_paths.stations.from_brief import make_stations as make_stations
from matstd.probe_paths.stations.from_brief import plan_options_of as plan_options_of
from matstd.probe_paths.stations.order_study import Ordering as Ordering
from matstd.probe_paths.stations.order_study import orders as orders
from matstd.probe_paths.stations.order_study import probing_time as probing_time
from matstd.probe_paths.stations.planned import plan_campaign as plan_campaign
