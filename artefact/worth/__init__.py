"""What touches on a standard are worth, and which of them to choose.

In: machine with expected errors, blank, the user's workspace, wanted touches. Out: a `Criterion`
that turns touches into rows of information, the best table poses and touches under quotas, the
effects that touches could show, and the errors that each patch is for. A new criterion is an entry
in `CRITERIA` and in `criterion_for`.
"""

from matstd.artefact.worth.attribution import with_error_shares as with_error_shares
from matstd.artefact.worth.ball_choice import BallPlaces as BallPlaces
from matstd.artefact.worth.ball_choice import ball_places as ball_places
from matstd.artefact.worth.calibration import Calibration as Calibration
from matstd.artefact.worth.effect_visibility import Visibility as Visibility
from matstd.artefact.worth.effect_visibility import visibility as visibility
from matstd.artefact.worth.touch_choice import TouchOptions as TouchOptions
from matstd.artefact.worth.touch_choice import chosen_poses as chosen_poses
from matstd.artefact.worth.touch_choice import chosen_touches_on as chosen_touches_on
from matstd.artefact.worth.touch_choice import each_at as each_at
from matstd.artefact.worth.touch_choice import face_grid as face_grid
from matstd.artefact.worth.touch_choice import pose_quota as pose_quota
from matstd.artefact.worth.touch_choice import poses_within as poses_within
from matstd.artefact.worth.touch_choice import repaired_touches as repaired_touches
from matstd.artefact.worth.touch_choice import some_touches as some_touches
from matstd.artefact.worth.touch_choice import sphere_grid as sphere_grid
from matstd.artefact.worth.touch_choice import touches_to_choose_from as touches_to_choose_from
from matstd.artefact.worth.touch_criterion import Criterion as Criterion
from matstd.artefact.worth.touch_criterion import CriterionOptions as CriterionOptions
from matstd.artefact.worth.touch_criterion import criterion_for as criterion_for
from matstd.artefact.worth.touch_criterion import random_touches as random_touches
from matstd.artefact.worth.touch_criterion import setup_parameters as setup_parameters
from matstd.artefact.worth.touch_curves import TouchCurve as TouchCurve
from matstd.artefact.worth.touch_curves import touch_curve as touch_curve
