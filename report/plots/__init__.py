"""Pictures of plans and proofs, of residuals, and of the effects that were found.

Each takes a result (`TouchPlan`, `Proof`, `Fit`, `Diagnosis`) and the path of a PNG, which is
written whole or not at all.
"""

from matstd.report.plots.effect_pictures import draw_candidates, draw_effect, draw_fall, draw_rivals
from matstd.report.plots.form_pictures import draw_form, is_form
from matstd.report.plots.pattern_pictures import draw_pattern, draw_region
from matstd.report.plots.plan_pictures import draw_order, draw_setup, draw_touches
from matstd.report.plots.proof_pictures import draw_proof, draw_touch_curves
from matstd.report.plots.reach_picture import draw_reach, draw_room
from matstd.report.plots.residual_pictures import draw_normal_plot, draw_over_variables
from matstd.report.plots.spatial_pictures import draw_on_standard, draw_pose_arrows, is_spread
from matstd.report.plots.trend_picture import draw_trend

__all__ = [
    "draw_candidates",
    "draw_effect",
    "draw_fall",
    "draw_form",
    "draw_normal_plot",
    "draw_on_standard",
    "draw_order",
    "draw_over_variables",
    "draw_pattern",
    "draw_pose_arrows",
    "draw_proof",
    "draw_reach",
    "draw_region",
    "draw_rivals",
    "draw_room",
    "draw_setup",
    "draw_touch_curves",
    "draw_touches",
    "draw_trend",
    "is_form",
    "is_spread",
]
