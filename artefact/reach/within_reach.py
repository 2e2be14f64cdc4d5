"""What of a blank a machine reaches, before anything is designed, and which limits bind.

Places and directions that faces of a standard may have are tried at table poses all over the user's
workspace. How far each touch is beyond every limit is kept, so that a refusal can say which travel,
or which angle, would have to give way, and by how much.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.layout import Blank
from matstd.artefact.reach.touchable import TRAVEL_ROUNDING, ProbeReach
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.units import DEG

ANGLE = "angle"  # name of the limit that is no travel: between a surface's normal and the tool axis
PLACES = 240  # tried on a blank
_LOWEST, _HIGHEST = 20.0, 0.7  # of a touch: mm above the base, and share of the blank's height
_TILT = 90.0 * DEG  # of a touch from the standard's z: balls are touched down to their equators
_MM_PER_RAD = 5.0 / DEG  # mm of travel that weigh as much as an angle where both are in the way


@dataclass(frozen=True, eq=False)
class Limit:
    """One end of a travel, or the angle."""

    name: str  # of the axis, or `ANGLE`
    at: float  # where it ends, mm or rad
    upper: bool = True  # whether readings beyond are larger


@dataclass(frozen=True, eq=False)
class PlacesInReach:
    """Places on a blank, table poses, and how far each touch is beyond each limit."""

    point: Array  # places, artefact frame, (N, 3), mm
    normal: Array  # outward normals there, (N, 3)
    poses: Array  # rotary readings, (K, R), rad
    limits: tuple[Limit, ...]  # ends of the travels of the linear axes, and the angle, L of them
    beyond: Array  # how far each touch is beyond each limit, (N, K, L), mm and rad; zero within

    @property
    def reached(self) -> Mask:
        """Which place is reached at which pose, (N, K)."""
        return (self.beyond == 0.0).all(axis=2)

    @property
    def places(self) -> int:
        """Number of places that are reached at some pose."""
        return int(self.reached.any(axis=1).sum())

    def wanting(self, enough: int) -> tuple[Array, list[tuple[Limit, float]]]:
        """What would have to give way for so many places to be reached at one pose, and how far.

        Returns:
            The pose that asks for least, (R,), and the limits with the reading or angle that they
            would have to allow there, mm or rad.
        """
        cost = self.beyond @ [_MM_PER_RAD if m.name == ANGLE else 1.0 for m in self.limits]
        pose = int(np.argmin(np.sort(cost, axis=0)[:enough].max(axis=0)))
        first = np.argsort(cost[:, pose], kind="stable")[:enough]
        most = self.beyond[first, pose].max(axis=0)
        return self.poses[pose], [
            (m, m.at + (1.0 if m.upper else -1.0) * float(more))
            for m, more in zip(self.limits, most, strict=True)
            if more > 0.0
        ]

    def barred(self) -> list[tuple[Limit, float]]:
        """Limits with the share of all touches that are beyond them, the largest first."""
        shares = (self.beyond > 0.0).mean(axis=(0, 1))
        order = np.argsort(-shares, kind="stable")
        return [(self.limits[i], float(shares[i])) for i in order if shares[i] > 0.0]


def places_on(blank: Blank, count: int = PLACES) -> tuple[Array, Array]:
    """Places and normals that touches of a standard may have, all over the blank, (N, 3) each.

    No randomness: the values follow the multiples of the roots of small primes.
    """
    share = (np.arange(count)[:, None] * np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0])) % 1.0
    (a, b), (low, high) = blank.base.half_size, (_LOWEST, _HIGHEST * blank.height)
    height = blank.base.thickness + low + (high - blank.base.thickness - low) * share[:, 2]
    point = np.column_stack([a * (1.8 * share[:, 0] - 0.9), b * (1.8 * share[:, 1] - 0.9), height])
    tilt, azimuth = _TILT * share[:, 3], 2.0 * np.pi * share[:, 4]
    sin = np.sin(tilt)
    normal = np.column_stack([sin * np.cos(azimuth), sin * np.sin(azimuth), np.cos(tilt)])
    return point, normal


def reach_of(reach: ProbeReach, point: Array, normal: Array, poses: Array) -> PlacesInReach:
    """What a machine reaches of places on a blank, by angle and travels alone.

    Args:
        point: Places, artefact frame, (N, 3), mm.
        normal: Outward unit normals, (N, 3).
        poses: Rotary readings, (K, R), rad.

    Raises:
        NotReachable: The machine has not three independent linear axes at some pose.
    """
    chain = reach.chain
    lots = [reach.everywhere(point, normal, poses, gap) for gap in reach.gaps]
    q = np.stack([readings for readings, _ in lots])  # (3, N, K, 3)
    limits, beyond = [Limit(ANGLE, reach.steepest)], [lots[0][1] - reach.steepest]
    for i, name in enumerate(chain.linear_axes):
        low, high = chain.link(name).range
        limits += [Limit(name, low, upper=False), Limit(name, high)]
        beyond += [low - q[..., i].min(axis=0), q[..., i].max(axis=0) - high]
    far = np.stack(beyond, axis=-1)
    return PlacesInReach(
        point=point,
        normal=normal,
        poses=poses,
        limits=tuple(limits),
        beyond=np.where(far > TRAVEL_ROUNDING, far, 0.0),
    )


def spread_poses(poses: Array, count: int) -> Array:
    """Some of the poses, spread over their list without the rhythm of its grid."""
    spread: IntArray = np.unique((np.arange(count) * 0.618034 % 1.0 * len(poses)).astype(np.int64))
    return poses[spread]
