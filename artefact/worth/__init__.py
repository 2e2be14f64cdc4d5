"""What touches on a standard are worth, and which of them to choose.

In: machine with expected errors, blank, the user's workspace, wanted touches. Out: a `Criterion`
that turns touches into rows of information, the best table poses and touches under quotas, the
effects that touches could show, and the errors that each patch is for. A new criterion is an entry
in `CRITERIA` and in `criterion_for`.
"""

from matstd.artefact.worth.attribution import with_error_shares
from matstd.artefact.worth.ball_choice import BallPlaces, ball_places
from matstd.artefact.worth.calibration import Calibration
from matstd.artefact.worth.effect_visibility import Visibility, visibility
from matstd.artefact.worth.touch_choice import (
    Surfaces,
    TouchOptions,
    chosen_poses,
    chosen_touches_on,
    each_at,
    face_grid,
    pose_quota,
    poses_within,
    repaired_touches,
    some_touches,
    sphere_grid,
    touches_to_choose_from,
)
from matstd.artefact.worth.touch_criterion import (
    Criterion,
    CriterionOptions,
    criterion_for,
    random_touches,
    setup_parameters,
)
from matstd.artefact.worth.touch_curves import TouchCurve, touch_curve

__all__ = [
    "BallPlaces",
    "Calibration",
    "Criterion",
    "CriterionOptions",
    "Surfaces",
    "TouchCurve",
    "TouchOptions",
    "Visibility",
    "ball_places",
    "chosen_poses",
    "chosen_touches_on",
    "criterion_for",
    "each_at",
    "face_grid",
    "pose_quota",
    "poses_within",
    "random_touches",
    "repaired_touches",
    "setup_parameters",
    "some_touches",
    "sphere_grid",
    "touch_curve",
    "touches_to_choose_from",
    "visibility",
    "with_error_shares",
]
