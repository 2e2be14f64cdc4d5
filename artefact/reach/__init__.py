"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

In: machine, probe and set-up (`ProbeReach`), a standard, wanted touches (`Requests`). Out: masks of
those that can be made, the reason against each of the others, axis readings, and the touches as the
twin's effects understand them. A new hindrance is one more look in `ProbeReach`; a body beside the
standard is a `Solid` of the `Workshop`.
"""

from matstd.artefact.reach.bodies import Body as Body
from matstd.artefact.reach.bodies import Clamping as Clamping
from matstd.artefact.reach.face_of_table import hangs as hangs
from matstd.artefact.reach.face_of_table import standing_remarks as standing_remarks
from matstd.artefact.reach.face_of_table import table_face as table_face
from matstd.artefact.reach.mesh_cover import mesh_triangles as mesh_triangles
from matstd.artefact.reach.mesh_cover import read_drawn_body as read_drawn_body
from matstd.artefact.reach.probe_clearance import ProbeShape as ProbeShape
from matstd.artefact.reach.probe_clearance import clearance as clearance
from matstd.artefact.reach.touchable import TRAVEL_ROUNDING as TRAVEL_ROUNDING
from matstd.artefact.reach.touchable import ProbeReach as ProbeReach
from matstd.artefact.reach.touchable import Requests as Requests
from matstd.artefact.reach.touchable import joined as joined
from matstd.artefact.reach.within_reach import ANGLE as ANGLE
from matstd.artefact.reach.within_reach import Limit as Limit
from matstd.artefact.reach.within_reach import PlacesInReach as PlacesInReach
from matstd.artefact.reach.within_reach import places_on as places_on
from matstd.artefact.reach.within_reach import reach_of as reach_of
from matstd.artefact.reach.within_reach import spread_poses as spread_poses
from matstd.artefact.reach.workshop import TABLE as TABLE
from matstd.artefact.reach.workshop import TABLE_RADIUS as TABLE_RADIUS
from matstd.artefact.reach.workshop import DatumBall as DatumBall
from matstd.artefact.reach.workshop import Solid as Solid
from matstd.artefact.reach.workshop import Workshop as Workshop
from matstd.artefact.reach.workshop import round_table as round_table
from matstd.artefact.reach.workshop import still_frames as still_frames
