"""What was measured: touches, set-ups and runs, as arrays.

`Touches` is the one record that flows through the house: everything known about N contacts, base
units. A new quantity that is recorded at every touch becomes a field of it; `Run` adds deviations.
"""

from matstd.twin.record.alignment import aligned as aligned
from matstd.twin.record.alignment import rigid_motion as rigid_motion
from matstd.twin.record.alignment import turn_of as turn_of
from matstd.twin.record.body import BODY as BODY
from matstd.twin.record.body import U_SHARE as U_SHARE
from matstd.twin.record.body import StatedBody as StatedBody
from matstd.twin.record.body import with_body as with_body
from matstd.twin.record.commanded import with_commanded as with_commanded
from matstd.twin.record.copies import without_copies as without_copies
from matstd.twin.record.run import FAR_SHIFT as FAR_SHIFT
from matstd.twin.record.run import FAR_TURN as FAR_TURN
from matstd.twin.record.run import Moved as Moved
from matstd.twin.record.run import Run as Run
from matstd.twin.record.several_runs import joined as joined
from matstd.twin.record.several_runs import stacked as stacked
from matstd.twin.record.touches import Body as Body
from matstd.twin.record.touches import Instrument as Instrument
from matstd.twin.record.touches import Labels as Labels
from matstd.twin.record.touches import Setup as Setup
from matstd.twin.record.touches import Touches as Touches
from matstd.twin.record.touches import at_poses as at_poses
from matstd.twin.record.touches import computed_deviation as computed_deviation
from matstd.twin.record.touches import implied_approach as implied_approach
from matstd.twin.record.touches import last_signs as last_signs
from matstd.twin.record.touches import linear_approach as linear_approach
