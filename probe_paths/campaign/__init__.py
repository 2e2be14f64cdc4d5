"""Programs run on the twin, logs evaluated to measurements."""

from probe_paths.campaign.contacts import VirtualMachine
from probe_paths.campaign.duration import probing_time
from probe_paths.campaign.evaluation import evaluate
from probe_paths.campaign.foot_point_search import foot_points
from probe_paths.campaign.order_study import Order, orders
from probe_paths.campaign.simulation import Campaign, simulate

__all__ = [
    "Campaign",
    "Order",
    "VirtualMachine",
    "evaluate",
    "foot_points",
    "orders",
    "probing_time",
    "simulate",
]
