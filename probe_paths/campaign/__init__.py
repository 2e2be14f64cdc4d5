"""Programs run on the twin, logs evaluated to measurements.

In: program files and a `VirtualMachine` (the machine as it really is), or the logs of a real one.
Out: a `Run`. `simulate` checks every move for collisions before it runs the programs; `evaluate`
uses nothing that only the virtual machine knows. `visits` repeats the runs.
"""

from matstd.probe_paths.campaign.as_programmed import check_as_programmed, with_program_lines
from matstd.probe_paths.campaign.ball_change import (
    BallChange,
    ball_changes,
    check_changes,
    effective_radii,
    read_heights,
)
from matstd.probe_paths.campaign.collisions import check_moves
from matstd.probe_paths.campaign.contact_points import foot_points
from matstd.probe_paths.campaign.contact_solver import ContactSolver, VirtualMachine
from matstd.probe_paths.campaign.disturbances import effects_over_record, in_campaign
from matstd.probe_paths.campaign.evaluation import (
    LARGEST_GAPS,
    ball_centres,
    evaluate,
    fitted_setup,
    sag_remarks,
    touch_uncertainty,
)
from matstd.probe_paths.campaign.log_parts import checked_parts
from matstd.probe_paths.campaign.simulation import Campaign, simulate, simulate_search, visits
from matstd.probe_paths.campaign.stamps import read_program_of
from matstd.probe_paths.campaign.tolerance import setup_tolerance

__all__ = [
    "LARGEST_GAPS",
    "BallChange",
    "Campaign",
    "ContactSolver",
    "VirtualMachine",
    "ball_centres",
    "ball_changes",
    "check_as_programmed",
    "check_changes",
    "check_moves",
    "checked_parts",
    "effective_radii",
    "effects_over_record",
    "evaluate",
    "fitted_setup",
    "foot_points",
    "in_campaign",
    "read_heights",
    "read_program_of",
    "sag_remarks",
    "setup_tolerance",
    "simulate",
    "simulate_search",
    "touch_uncertainty",
    "visits",
    "with_program_lines",
]
