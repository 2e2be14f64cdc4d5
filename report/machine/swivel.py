"""What to check of an axis that is inclined by design, such as the 45 degrees of a swivel table."""

import numpy as np

from matstd.twin.frames import Array, rotation
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG

_INCLINED = 0.999
"""Cosine of a rotary axis to its letter below which it is inclined by design: 2.6 degrees."""
_LOOKED_AT = 90.0 * DEG  # reading at which both signs of a direction look clearly different


def swivel_remarks(chain: Chain) -> list[str]:
    """Where table or tool look at a large angle of each inclined axis, and with the other sign.

    No file shows which sign the machine has, and a wrong one passes every test at zero. Joints of
    an arm are not asked about.
    """
    links = [chain.link(axis) for axis in chain.rotary_axes]
    return [
        _swivel(link)
        for link in links
        if not link.is_joint and abs(float(link.direction[link.own])) < _INCLINED
    ]


def _swivel(link: Link) -> str:
    low, high = link.range
    at = _LOOKED_AT if low <= _LOOKED_AT <= high else max(low, high, key=abs)
    side = -1.0 if link.carries_workpiece else 1.0
    # the face of the table looks along its z, the tool points against its own
    this, other = (
        _listed(-side * rotation(sign * side * at * link.direction)[:, 2]) for sign in (1.0, -1.0)
    )
    what = "the face of the table looks" if link.carries_workpiece else "the tool points"
    return (
        f"Axis {link.name} turns about {_listed(link.direction)}. At {link.name} = {at / DEG:g}° "
        f"{what} towards {this} of the machine. Turn it by hand before the first program and look: "
        f"if it looks towards {other}, the direction in the machine file has the other sign, and "
        "programs would hit the standard."
    )


def _listed(vector: Array) -> str:
    return f"[{', '.join(f'{v:g}' for v in np.round(vector, 3) + 0.0)}]"
