"""Which way the table's face looks: along the coordinate axis that the standard stands up on.

The table frame is parallel to the machine's with every axis at zero, so the face of a horizontal
machine's table, on which a standard stands upright, looks along Y and not along Z.
"""

import numpy as np

from matstd.twin.frames import Array, pose
from matstd.twin.machine import Chain, table_to_tool

_SAME_AXIS_COSINE = 0.7  # cosine above which two directions count as one axis: half a right angle
_UPRIGHT = ("[0, 90, 0]", "[-90, 0, 0]", "[0, 0, 0]")  # takes z to x, y, z of the table
_X = 0  # place of X among the letters
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


def hangs(chain: Chain, T_table_artefact: Array) -> bool:
    """Whether a standard on a rotary table looks away from the tool with every axis at zero.

    Its seat would then have to be on the lower side of the table. A table that turns about an axis
    across the tool has no such side: it turns the standard round.
    """
    axis, q = _turns_about(chain), np.zeros((1, len(chain.axes)))
    tool, up = table_to_tool(chain, q)[0, :3, 2], T_table_artefact[:3, 2]
    return (
        axis is not None
        and abs(float(axis @ tool)) > _SAME_AXIS_COSINE
        and float(up @ tool) < -_SAME_AXIS_COSINE
    )


def standing_remarks(chain: Chain, T_table_artefact: Array, down: str = "") -> tuple[str, ...]:
    """What is taken for granted of the face that carries the standard.

    Args:
        down: Direction of weight in machine coordinates, such as `-Z`; empty leaves it aside.
    """
    axis, face = _turns_about(chain), table_face(T_table_artefact)[:3, 2]
    if axis is None:
        return ()
    sign, letter = "-" if face.min() < -0.5 else "+", "XYZ"[int(np.argmax(np.abs(face)))]
    table, along = _innermost(chain), int(np.argmax(np.abs(axis)))
    # X is horizontal on every machine (ISO 841): what turns about it tilts its table
    if abs(float(axis @ face)) <= _SAME_AXIS_COSINE and along != _X:
        return (
            f"The standard stands on a face that looks along {sign}{letter} of the table frame, "
            f"and {table} turns about {'XYZ'[along]}. Where {table} tilts a table, that table is "
            f"[workshop.table], and this is right. Where the table of {table} looks along "
            f"{'XYZ'[along]} and the standard stands on an angle plate on it, [workshop.table] is "
            f"the face of the plate, and the table of {table} is kept clear only as one of the "
            f"[[workshop.bodies]]; rotation_deg = {_UPRIGHT[along]} of the set-up stands the "
            "standard on it.",
        )
    if not down or letter in down:
        return ()
    return (
        f"Weight pulls along {down}, and the face of {table} on which the standard stands looks "
        f"along {sign}{letter}: that table is upright. Where it lies level, "
        f'standard.down = "{"-" if sign == "+" else "+"}{letter}"; the sag depends on it.',
    )


def _innermost(chain: Chain) -> str:
    """The rotary axis nearest to the workpiece, of those that carry it; empty for none."""
    turning = (k.name for k in chain.links if k.kind == "rotary" and k.carries_workpiece)
    return next(turning, "")


def _turns_about(chain: Chain) -> Array | None:
    name = _innermost(chain)
    return chain.link(name).direction if name else None
