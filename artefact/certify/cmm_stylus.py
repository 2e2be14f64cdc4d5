"""Stylus lengths and head angles with which a CMM reaches points of a standard.

The probe is a ball, a shaft, a module and an indexing head as cylinders about one axis. At every
point, and on the way straight down to it from the clearance plane, it has to keep a gap from the
body. Of the angles that do, the least tilted is taken; of the lengths, the shortest with which all
points are reached.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, Mask
from matstd.twin.units import DEG

TIP = 1.5  # radius of the ball of the stylus, mm
LENGTHS = (50.0, 75.0, 100.0, 150.0)  # from the ball's centre to the module, mm

TO_PIVOT = 110.0
"""From the end of the stylus to the pivot of the head, mm: module of 50 and half a head of 120."""

_SHAFT, _MODULE, _HEAD = 1.0, 7.0, 32.0  # radii, mm
_MODULE_LENGTH, _HEAD_LENGTH = 50.0, 120.0
_GAP = 1.0  # between probe and body, mm
_TILTS = (0.0, 15.0, 30.0, 45.0)
_TURNS = tuple(np.arange(-180.0, 180.0, 45.0).tolist())
_HEIGHTS = 6  # heights between a point and the clearance plane


@dataclass(frozen=True, slots=True)
class Angle:
    """Angles of an indexing head, degrees: A tilts the stylus, B turns the tilted stylus about z.

    At A = 0 the stylus points down; at B = 0 a tilted stylus points to -y, its head stands at +y.
    """

    A: float
    B: float

    @property
    def label(self) -> str:
        """`A30_BM45`."""
        return f"A{self.A:.0f}_B{'M' if self.B < 0 else ''}{abs(self.B):.0f}"

    @property
    def axis(self) -> Array:
        """From the ball up to the head, in the frame of the machine, (3,)."""
        a, b = self.A * DEG, self.B * DEG
        return np.array([-np.sin(a) * np.sin(b), np.sin(a) * np.cos(b), np.cos(a)])


UPRIGHT = Angle(0.0, 0.0)
ANGLES = (UPRIGHT, *(Angle(a, b) for a in _TILTS[1:] for b in _TURNS))
"""Angles in the order in which they are tried."""


def reaches(standard: Standard, centres: Array, high: float, length: float, angle: Angle) -> Mask:
    """Whether the probe is free at ball centres (N, 3), and above them up to `high` mm, (N,)."""
    # upright, what is free below is free above: the probe moves along its own axis
    count = 1 if angle == UPRIGHT else _HEIGHTS
    steps = np.linspace(0.0, 1.0, count)[:, None, None]
    above = np.maximum(high + TIP - centres[:, 2], 0.0)[:, None] * np.array([0.0, 0.0, 1.0])
    balls = (centres + steps * above).reshape(-1, 3)
    free = np.ones(len(balls), dtype=bool)
    for low, end, radius, gap in (
        (3.0 * TIP, length, _SHAFT, _GAP),
        (length, length + _MODULE_LENGTH, _MODULE, _GAP),
        (length + _MODULE_LENGTH, length + _MODULE_LENGTH + _HEAD_LENGTH, _HEAD, 5.0 * _GAP),
    ):
        along = np.arange(low, end + 1e-9, max(radius, 4.0))
        left = np.flatnonzero(free)
        # all places of a cylinder at once: a third of the time of one after the other
        places = balls[left, None] + along[:, None] * angle.axis
        apart = standard.distance(places.reshape(-1, 3)).reshape(places.shape[:2])
        free[left] = np.all((apart > radius + gap) & (places[..., 2] > radius), axis=1)
    return np.asarray(free.reshape(count, len(centres)).all(axis=0), dtype=np.bool_)


def choose_stylus(
    standard: Standard, groups: dict[str, tuple[Array, bool]], high: float
) -> tuple[float, dict[str, list[Angle | None]]]:
    """Length of the stylus, and the angle of every point; None for a point that no angle reaches.

    Args:
        groups: By feature, centres of the tip (N, 3) and whether one angle has to serve all: the
            points of a ball share the offset of one stylus.

    Raises:
        NotReachable: A feature of which no length reaches half of the points.
    """
    angles: dict[str, list[Angle | None]] = {}
    for length in LENGTHS:
        angles = {}
        for name, (centres, is_one) in groups.items():
            angles[name] = _angles(standard, centres, is_one, high, length)
            if None in angles[name] and length < LENGTHS[-1]:
                break
        else:
            break
    for name, chosen in angles.items():
        if sum(angle is None for angle in chosen) > len(chosen) // 2:
            raise NotReachable(
                f"no stylus up to {LENGTHS[-1]:g} mm at 45 degrees or less reaches {name} on a CMM"
            )
    return length, angles


def _angles(
    standard: Standard, centres: Array, is_one: bool, high: float, length: float
) -> list[Angle | None]:
    """Angle of every point, the least tilted first."""
    out: list[Angle | None] = [None] * len(centres)
    left, most = np.arange(len(centres)), 0
    for angle in ANGLES:
        if is_one:
            free = reaches(standard, centres, high, length, angle)
            if free.sum() > most:
                most = int(free.sum())
                out = [angle if f else None for f in free]
            if free.all():
                break
            continue
        free = reaches(standard, centres[left], high, length, angle)
        for i in left[free]:
            out[i] = angle
        left = left[~free]
        if not len(left):
            break
    return out
