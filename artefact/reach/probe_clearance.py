"""Room for the probe: how near its stylus and body come to the standard at each touch."""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, unit

_GROWTH = 1.15  # ratio of neighbouring stations along the tool axis
_MAX_THIN_RADIUS = 4.0
"""mm: up to this radius a cylinder is a row of balls on its axis, beyond it is wrapped."""
_WRAP_RATIO = 0.3  # radius of the wrapping balls, in radii of the cylinder
_BALLS_OF_LOT = 50_000  # balls looked at together
_PIECES = 6  # short cylinders in which the balls of a probe are gathered


@dataclass(frozen=True, slots=True)
class ProbeShape:
    """A touch probe as cylinders round the tool axis, from the ball centre upwards."""

    ball_radius: float  # of the stylus tip, mm
    # (end, radius) of each, mm from the ball centre, in ascending order; the first begins at the
    # ball
    cylinders: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        ends = [end for end, _ in self.cylinders]
        if not ends or ends != sorted(ends) or ends[0] <= self.ball_radius:
            raise ShapeMismatch(
                f"probe cylinders end at {ends} mm; expected ascending ends beyond the ball radius"
                f" {self.ball_radius:g} mm"
            )

    def stations(self) -> tuple[Array, Array]:
        """Balls on the tool axis that cover all cylinders, and more before their front faces.

        Returns:
            Distance of each from the ball centre, and its radius, each (K,), mm.
        """
        parts = [_row(low, high, radius, self.ball_radius) for low, high, radius in self._pieces()]
        return np.concatenate([c for c, _ in parts]), np.concatenate([r for _, r in parts])

    def rough_cover(self) -> tuple[Array, Array]:
        """The same balls as centres (K, 3) in the frame of the tip, tool axis +z, and radii."""
        place, radius = self.stations()
        return _on_axis(place), radius

    def fine_cover(self) -> tuple[Array, Array]:
        """Balls that cover the surface of all cylinders and stand out by an eighth of a radius.

        Enough for anything that, like the standard, is not small enough to be inside a cylinder.

        Returns:
            Centres in the frame of the tip, tool axis +z, (K, 3), and radii, (K,), mm.
        """
        parts = []
        for low, high, radius in self._pieces():
            if radius > _MAX_THIN_RADIUS:
                parts.append(_wrap(low, high, radius))
            else:
                place, cover = _row(low, high, radius, self.ball_radius)
                parts.append((_on_axis(place), cover))
        return np.concatenate([c for c, _ in parts]), np.concatenate([r for _, r in parts])

    def _pieces(self) -> list[tuple[float, float, float]]:
        ends = [end for end, _ in self.cylinders]
        lows = [0.0, *ends[:-1]]
        return [(low, end, r) for low, (end, r) in zip(lows, self.cylinders, strict=True)]


def _row(low: float, high: float, radius: float, ball_radius: float) -> tuple[Array, Array]:
    """Balls on the axis whose spacing grows with the distance from the tip."""
    # The stylus inside the ball touches nothing that the ball does not touch.
    first = max(low, 0.7 * ball_radius)
    count = max(int(np.ceil(np.log(high / first) / np.log(_GROWTH))), 1)
    cuts = np.geomspace(first, high, count + 1)
    return 0.5 * (cuts[1:] + cuts[:-1]), np.hypot(radius, 0.5 * np.diff(cuts))


def _on_axis(place: Array) -> Array:
    """Points (K, 3) on the tool axis at distances (K,) from the tip."""
    return np.column_stack([np.zeros((len(place), 2)), place])


def _wrap(low: float, high: float, radius: float) -> tuple[Array, Array]:
    """Balls over the front face and the mantle of a cylinder.

    A ball of radius rho that lies ``w = rho / sqrt 3`` below a surface covers a patch of half
    width w each way: the rings and rows are spaced by 2 w at most.
    """
    w = _WRAP_RATIO * radius / np.sqrt(3.0)
    rings = [(r, low + w) for r in np.linspace(0.0, radius - w, int(np.ceil(0.5 * radius / w)) + 1)]
    rows_up = int(np.ceil((high - low) / (2.0 * w)))
    rings += [(radius - w, low + w + 2.0 * w * k) for k in range(1, rows_up)]
    balls = []
    for ring, height in rings:
        count = max(int(np.ceil(np.pi * min(ring + w, radius) / w)), 1) if ring > 0.0 else 1
        angle = 2.0 * np.pi * np.arange(count) / count
        balls.append(
            np.column_stack([ring * np.cos(angle), ring * np.sin(angle), np.full(count, height)])
        )
    centres = np.concatenate(balls)
    return centres, np.full(len(centres), _WRAP_RATIO * radius)


@dataclass(frozen=True, eq=False)
class Clearance:
    """Room at N touches."""

    # of the probe above its ball from the standard, (N,), mm; never too large, negative where they
    # may collide, and then not a depth
    distance: Array
    body: np.ndarray  # name of the body that is nearest, (N,)


def clearance(
    standard: Standard,
    centre: Array,
    tool_axis: Array,
    probe: ProbeShape,
    enough: float = 2.0,
    is_near_lid: bool = False,
) -> Clearance:
    """How near the probe comes to the standard with its ball at each centre; from below.

    The cylinders are covered by balls, which are compared with the distance to every body, so
    the figure errs on the safe side. Where a cover of few balls leaves less than `enough`, a
    finer one is tried. The tip's ball itself is not looked at: it is meant to touch.

    Args:
        standard: In the artefact frame.
        centre: Ball centres, shape (N, 3), artefact frame, mm.
        tool_axis: From the tip to the spindle, artefact frame, shape (N, 3) or (3,).
        enough: Room beyond which the exact figure does not matter, mm.
        is_near_lid: Whether the nearest point of a face is sought where the bound of its distance
            by its steepest slope, 0.8 mm short above waves of 49 degrees, leaves less than that.
    """
    centre = np.atleast_2d(centre)
    axis = unit(np.broadcast_to(tool_axis, centre.shape))
    room, nearest = _room(standard, centre, axis, *probe.rough_cover())
    tight = np.flatnonzero(room < enough)
    if len(tight):
        cover = probe.fine_cover()
        wanted = enough if is_near_lid else -np.inf
        finer, body = _room(standard, centre[tight], axis[tight], *cover, wanted)
        better = finer > room[tight]
        room[tight[better]], nearest[tight[better]] = finer[better], body[better]
    return Clearance(room, nearest)


def _room(
    standard: Standard,
    centre: Array,
    axis: Array,
    places: Array,
    radii: Array,
    enough: float = -np.inf,
) -> tuple[Array, np.ndarray]:
    """Smallest distance of the covering balls from the standard (N,), and the body it is to.

    The body whose middle is nearest is looked at first, and after it only those that can be nearer
    by the balls that hold them: two or three, where a standard has twenty. Covering balls with less
    room than `enough` above a face are compared with its nearest point.
    """
    room = np.full(len(centre), np.inf)
    nearest = np.zeros(len(centre), dtype=int)
    bodies = list(standard.bodies.values())
    lids = [standard.columns.get(name) for name in standard.bodies]
    middles, hulls = (np.array(one) for one in zip(*(body.hull for body in bodies), strict=True))
    across = _across(axis)
    for some in np.array_split(
        np.arange(len(centre)), len(centre) * len(places) // _BALLS_OF_LOT + 1
    ):
        points = centre[some, None] + places @ across[some]  # (n, K, 3)
        to_middle = _to_points(middles, centre[some], axis[some], places, radii)
        first, least = np.argmin(to_middle, axis=1), to_middle - hulls
        best, which = np.full(len(some), np.inf), np.zeros(len(some), dtype=int)
        for is_first in (True, False):
            for b, body in enumerate(bodies):
                near = np.flatnonzero(((first == b) == is_first) & (least[:, b] < best))
                apart = body.distance(points[near].reshape(-1, 3)).reshape(-1, len(radii))
                lid = lids[b]
                if lid is not None and np.isfinite(enough):
                    # no farther than straight down: one ball too near there decides the place
                    can_do = np.all(apart / lid.steepest - radii >= enough, axis=1, keepdims=True)
                    few = np.nonzero((apart - radii < enough) & can_do)
                    apart[few] = np.maximum(apart[few], lid.distance_from_lid(points[near][few]))
                gap = (apart - radii).min(axis=1)
                closer = gap < best[near]
                best[near[closer]], which[near[closer]] = gap[closer], b
        room[some], nearest[some] = best, which
    return room, np.array(list(standard.bodies))[nearest]


def _to_points(middles: Array, centre: Array, axis: Array, places: Array, radii: Array) -> Array:
    """Distance of the probe at each touch from B points (B, 3), (N, B), mm; from below.

    The covering balls are gathered in a few short cylinders with round ends, which hold them.
    """
    v = middles - centre[:, None]  # (N, B, 3)
    along = np.einsum("nbi,ni->nb", v, axis)
    beside = np.sqrt(np.maximum(np.einsum("nbi,nbi->nb", v, v) - along**2, 0.0))
    out = np.full(along.shape, np.inf)
    reach = np.hypot(places[:, 0], places[:, 1]) + radii
    for piece in np.array_split(np.argsort(places[:, 2], kind="stable"), _PIECES):
        if len(piece):
            low, high = places[piece[0], 2], places[piece[-1], 2]
            beyond = np.maximum(np.maximum(low - along, along - high), 0.0)
            out = np.minimum(out, np.hypot(beside, beyond) - reach[piece].max())
    return out


def _across(axis: Array) -> Array:
    """Right-handed frames whose third row is the axis, (N, 3, 3)."""
    least = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
    first = unit(np.cross(least, axis))
    return np.stack([first, np.cross(axis, first), axis], axis=1)
