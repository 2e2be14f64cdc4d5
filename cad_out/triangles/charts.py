"""Plane charts of surfaces, in which equal triangles keep an equal distance from the surface."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array

Map = Callable[[Array], Array]

_STRETCH = 4.0
"""Triangles on cones and cylinders are this much longer along them: a quarter of the number."""

_SHARE = 0.75  # of the chord for a step along a curve; triangles between lie farther off
_TURN = 0.3  # rad at most a step; the chord decides on all but tiny radii
_TABLE = 400  # places at which the length along a profile is tabulated


@dataclass(frozen=True, slots=True)
class Chart:
    """A plane chart of a surface."""

    place: Map  # parameters of the surface to places in the chart, (N, 2) both
    point: Map  # places to points, (N, 2) to (N, 3), mm
    spacing: float = 0.0  # of places, at which the chord is kept; 0 if the refinement is to find it
    is_flat: bool = False


@dataclass(frozen=True, slots=True)
class Frame:
    """Where a surface of the kernel stands; its directions may be left-handed."""

    x: Array  # direction from which angles are counted, (3,)
    y: Array  # direction to which they are, (3,)
    z: Array  # axis, (3,)
    origin: Array  # shape (3,), mm


@dataclass(frozen=True, slots=True)
class Profile:
    """What turns round the axis of a surface of revolution, by its parameter v."""

    radius: Map  # distance from the axis, mm
    height: Map  # along the axis, mm
    pace: float  # length per unit of v, mm
    stretch: float  # of triangles, along the profile over round the axis
    tip: float = np.nan  # parameter at which a cone ends; nan elsewhere
    turn: float = np.nan  # angle of a cone unrolled over that round its axis


def cylinder(radius: float) -> Profile:
    """Straight along the axis."""
    return Profile(
        radius=lambda v: np.full_like(v, radius), height=lambda v: v, pace=1.0, stretch=_STRETCH
    )


def cone(radius: float, half_angle: float) -> Profile:
    """From a radius at v = 0 along a slanted line."""
    sine, cosine = float(np.sin(half_angle)), float(np.cos(half_angle))
    return Profile(
        radius=lambda v: radius + v * sine,
        height=lambda v: v * cosine,
        pace=1.0,
        stretch=_STRETCH,
        tip=-radius / sine,
        turn=abs(sine),
    )


def torus(large: float, small: float) -> Profile:
    """A circle beside the axis."""
    return Profile(
        radius=lambda v: large + small * np.cos(v),
        height=lambda v: small * np.sin(v),
        pace=small,
        stretch=max(np.sqrt(small / large), 1.0 / _STRETCH),  # as the steps of one chord
    )


def arc_step(radius: float, chord: float) -> float:
    """Angle of a step round a circle that keeps a chord, rad."""
    return min(float(2.0 * np.arccos(max(1.0 - _SHARE * chord / radius, 0.0))), _TURN)


def bisected(at: Map, t: Array, chord: float) -> Array:
    """Parameters between which a curve leaves its secants by no more than a chord asks for."""
    while True:
        low, high = at(t[:-1]), at(t[1:])
        along = (high - low) / np.linalg.norm(high - low, axis=1)[:, None]
        off = np.zeros(len(low))
        for share in (0.25, 0.5, 0.75):
            on = at((1.0 - share) * t[:-1] + share * t[1:]) - low
            aside = on - np.einsum("ni,ni->n", on, along)[:, None] * along
            off = np.maximum(off, np.linalg.norm(aside, axis=1))
        far = off > _SHARE * chord
        if not far.any():
            return t
        t = np.sort(np.concatenate([t, (0.5 * (t[:-1] + t[1:]))[far]]))


def plane_chart(frame: Frame) -> Chart:
    """A plane is its own chart."""
    axes = np.array([frame.x, frame.y])
    return Chart(place=lambda uv: uv, point=lambda xy: frame.origin + xy @ axes, is_flat=True)


def revolved_chart(frame: Frame, profile: Profile, low: Array, high: Array, chord: float) -> Chart:
    """Chart of a surface of revolution, true in its angles but for a stretch.

    Args:
        low: Smallest u and v of the face, (2,).
        chord: To be kept, mm.
    """

    def in_space(u: Array, v: Array) -> Array:
        around = np.cos(u)[:, None] * frame.x + np.sin(u)[:, None] * frame.y
        along = profile.height(v)[:, None] * frame.z
        return frame.origin + profile.radius(v)[:, None] * around + along

    v = np.linspace(low[1], high[1], _TABLE)
    if np.abs(v - profile.tip).min() < 0.1 * np.ptp(v):
        side = float(np.sign(np.mean(v) - profile.tip))
        return _unrolled(profile, 0.5 * (low[0] + high[0]), side, in_space)
    rim = profile.radius(v)
    mean = float(rim.mean())
    slope = profile.pace * mean / rim / profile.stretch
    length = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(v))])

    def place(uv: Array) -> Array:
        return np.column_stack([mean * uv[:, 0], np.interp(uv[:, 1], v, length)])

    def point(xy: Array) -> Array:
        return in_space(xy[:, 0] / mean, np.interp(xy[:, 1], length, v))

    return Chart(place=place, point=point, spacing=mean * arc_step(float(rim.max()), chord))


def _unrolled(
    profile: Profile, middle: float, side: float, in_space: Callable[[Array, Array], Array]
) -> Chart:
    """A cone unrolled into a plane, with the tip at the origin."""

    def place(uv: Array) -> Array:
        away, angle = side * (uv[:, 1] - profile.tip), profile.turn * (uv[:, 0] - middle)
        return np.column_stack([away * np.cos(angle), -side * away * np.sin(angle)])

    def point(xy: Array) -> Array:
        angle = np.arctan2(-side * xy[:, 1], xy[:, 0])
        away = side * np.hypot(xy[:, 0], xy[:, 1])
        return in_space(angle / profile.turn + middle, profile.tip + away)

    return Chart(place=place, point=point)


def scaled_chart(in_space: Map, low: Array, high: Array) -> Chart:
    """The parameters of any other surface, each times the length that it runs in its middle.

    Args:
        in_space: Parameters to points, (N, 2) to (N, 3), mm.
    """
    middle, step = 0.5 * (low + high), 1e-3 * (high - low)
    ends = [middle + sign * step * axis for axis in np.eye(2) for sign in (-1.0, 1.0)]
    a, b, c, d = in_space(np.array(ends))
    scale = np.array([np.linalg.norm(b - a), np.linalg.norm(d - c)]) / (2.0 * step)
    return Chart(place=lambda uv: uv * scale, point=lambda xy: in_space(xy / scale))
