"""Programs run on the twin, logs evaluated to measurements.

In: program files and a `VirtualMachine` (the machine as it really is), or the logs of a real one.
Out: a `Run`. `simulate` checks every move for collisions before it runs the programs; `evaluate`
uses nothing that only the virtual machine knows. `visits` repeats the runs.
"""

from matstd.probe_paths.campaign.as_programmed import check_as_programmed as check_as_programmed
from matstd.probe_paths.campaign.as_programmed import with_program_lines as with_program_lines
from matstd.probe_paths.campaign.ball_change import BallChange as BallChange
from matstd.probe_paths.campaign.ball_change import ball_changes as ball_changes
from matstd.probe_paths.campaign.ball_change import check_changes as check_changes
from matstd.probe_paths.campaign.ball_change import effective_radii as effective_radii
from matstd.probe_paths.campaign.ball_change import read_heights as read_heights
from matstd.probe_paths.campaign.collisions import check_moves as check_moves
from matstd.probe_paths.campaign.contact_points import foot_points as foot_points
from matstd.probe_paths.campaign.contact_solver import ContactSolver as ContactSolver
from matstd.probe_paths.campaign.contact_solver import VirtualMachine as VirtualMachine
from matstd.probe_paths.campaign.disturbances import effects_over_record as effects_over_record
from matstd.probe_paths.campaign.disturbances import in_campaign as in_campaign
from matstd.probe_paths.campaign.evaluation import LARGEST_GAPS as LARGEST_GAPS
from matstd.probe_paths.campaign.evaluation import ball_centres as ball_centres
from matstd.probe_paths.campaign.evaluation import evaluate as evaluate
from matstd.probe_paths.campaign.evaluation import fitted_setup as fitted_setup
from matstd.probe_paths.campaign.evaluation import sag_remarks as sag_remarks
from matstd.probe_paths.campaign.evaluation import touch_uncertainty as touch_uncertainty
from matstd.probe_paths.campaign.log_parts import checked_parts as checked_parts
from matstd.probe_paths.campaign.simulation import Campaign as Campaign
from matstd.probe_paths.campaign.simulation import simulate as simulate
from matstd.probe_paths.campaign.simulation import simulate_search as simulate_search
from matstd.probe_paths.campaign.simulation import visits as visits
from matstd.probe_paths.campaign.stamps import read_program_of as read_program_of
from matstd.probe_paths.campaign.tolerance import setup_tolerance as setup_tolerance
