"""Pictures of plans and proofs, of residuals, and of the effects that were found.

Each takes a result (`TouchPlan`, `Proof`, `Fit`, `Diagnosis`) and the path of a PNG, which is
written whole or not at all.
"""

from matstd.report.plots.effect_pictures import draw_candidates as draw_candidates
from matstd.report.plots.effect_pictures import draw_effect as draw_effect
from matstd.report.plots.effect_pictures import draw_fall as draw_fall
from matstd.report.plots.effect_pictures import draw_form as draw_form
from matstd.report.plots.effect_pictures import draw_rivals as draw_rivals
from matstd.report.plots.effect_pictures import is_form as is_form
from matstd.report.plots.pattern_pictures import draw_pattern as draw_pattern
from matstd.report.plots.pattern_pictures import draw_region as draw_region
from matstd.report.plots.plan_pictures import draw_order as draw_order
from matstd.report.plots.plan_pictures import draw_setup as draw_setup
from matstd.report.plots.plan_pictures import draw_touches as draw_touches
from matstd.report.plots.proof_pictures import draw_proof as draw_proof
from matstd.report.plots.proof_pictures import draw_touch_curves as draw_touch_curves
from matstd.report.plots.reach_picture import draw_reach as draw_reach
from matstd.report.plots.reach_picture import draw_room as draw_room
from matstd.report.plots.residual_pictures import draw_normal_plot as draw_normal_plot
from matstd.report.plots.residual_pictures import draw_over_variables as draw_over_variables
from matstd.report.plots.spatial_pictures import draw_on_standard as draw_on_standard
from matstd.report.plots.spatial_pictures import draw_pose_arrows as draw_pose_arrows
from matstd.report.plots.spatial_pictures import is_spread as is_spread
from matstd.report.plots.trend_picture import draw_trend as draw_trend
