"""Which way the table's face looks: along the coordinate axis that the standard stands up on.

The table frame is parallel to the machine's with every axis at zero, so the face of a horizontal
machine's table, on which a standard stands upright, looks along Y and not along Z.
"""

import numpy as np

from twin.frames import Array, pose

_TURNED = {0: (1, 2, 0), 1: (2, 0, 1), 2: (0, 1, 2)}  # coordinate axes that become x, y, z


def table_face(T_table_artefact: Array) -> Array:
    """Pose T_table_face (4, 4) of the table's face: at the table's origin, z out of the face.

    The face is square to the coordinate axis of the table frame that is nearest to the artefact's
    own z axis: a standard that is tilted by less than half a right angle stands on a wedge, one
    that is turned by a right angle stands on another side of the table.

    Args:
        T_table_artefact: Where the standard stands, shape (4, 4).
    """
    up = T_table_artefact[:3, 2]
    # a tilt by exactly half a right angle: Z before Y before X, whatever the last digit
    axis = 2 - int(np.argmax(np.round(np.abs(up[::-1]), 9)))
    R = np.eye(3)[:, _TURNED[axis]]
    if up[axis] < 0.0:
        R = R @ np.diag([1.0, -1.0, -1.0])
    return pose(R)
