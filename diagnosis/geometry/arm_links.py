"""Links and joints of a serial arm: what stays of its lines however the whole arm is placed.

Every joint turns about a line. Where all of them stand with every joint reading zero, and where the
reflector sits, is the whole geometry of an arm; but a line by itself is never known: moved along
with all that follow it is a displaced tracker, or the zero of the joint before. What is known is
how each lies to its neighbours, as Denavit and Hartenberg have it:

- the length of a link: the distance of two neighbouring lines along their common normal, which
  leads from the first to the second; where they meet, along the cross product of their directions;
- the twist of a link: the angle between them about it (of two that are parallel, two small angles,
  about the normal and about what is square to it and to the first line);
- the offset along a joint: the distance along its line between the normals to both neighbours;
- the zero of a joint: the angle about its line between those normals, at reading zero.

The first joint's zero and offset are the tracker's place, those of the last one the reflector's.

Reference:
    Denavit and Hartenberg, J. Applied Mechanics 22 (1955) 215; Hayati and Mirmirani, J. Robotic
    Systems 2 (1985) 397 (parallel joints).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.quantities import Functional, Quantity, geometric_effects
from matstd.twin.frames import Array, rotation
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import traits

MAX_PARALLEL_SINE = 0.05
"""Sine of the angle between two lines below which their distance, not their crossing, is
reported."""

MIN_LINE_DISTANCE = 1.0  # distance (mm) of parallel lines below which no link has a direction

LINE_STEP = 1e-4
"""Step (mm, rad) of the differences by which a parameter moves the lines: all are nearly linear."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines of joints with every joint at zero, from the foundation outwards."""

    point: Array  # one on every line, (J, 3), mm
    direction: Array  # unit, (J, 3)

    def normal(self, i: int) -> Array:
        """Common normal of line i and the next one, unit, (3,); zero where they are one line."""
        d, e = self.direction[i], self.direction[i + 1]
        across, between = np.cross(d, e), self.point[i + 1] - self.point[i]
        if np.linalg.norm(across) < MAX_PARALLEL_SINE:
            across = between - (between @ d) * d
            if np.linalg.norm(across) < MIN_LINE_DISTANCE:
                return np.zeros(3)
        n = across / np.linalg.norm(across)
        return np.asarray(-n if n @ between < -MIN_LINE_DISTANCE else n)

    def foot(self, i: int, other: int) -> Array:
        """Where the common normal with another line stands on line i, (3,)."""
        d, e = self.direction[i], self.direction[other]
        between = self.point[other] - self.point[i]
        c = float(d @ e)
        return np.asarray(self.point[i] + d * (between @ (d - c * e)) / (1.0 - c * c))

    def is_parallel(self, i: int) -> bool:
        """Whether line i and the next one are parallel, or nearly so."""
        across = np.cross(self.direction[i], self.direction[i + 1])
        return bool(np.linalg.norm(across) < MAX_PARALLEL_SINE)


def arm_functionals(fit: Fit, joints: Sequence[str]) -> Iterator[Functional]:
    """Lengths, twists, offsets and zeros of the joints that were probed."""
    chain = fit.model.chain
    names = [j for j in chain.joints if j in joints]
    if not names:
        return
    links = [chain.link(j) for j in names]
    nominal = Lines(np.stack([k.point for k in links]), np.stack([k.direction for k in links]))
    levers = _levers(chain, names)
    weights: dict[tuple[Quantity, str], Array] = {}
    for start, effect in geometric_effects(fit):
        constant = traits(effect).ordinary_constant
        if constant is not None and constant.link in names:
            ahead, behind = (
                _measures(_moved(nominal, names, chain, constant, s), nominal, names)
                for s in (LINE_STEP, -LINE_STEP)
            )
            for key, (_, value) in ahead.items():
                row = weights.setdefault(key, np.zeros(len(fit.model.parameters)))
                change = value - behind[key][1]
                if key[0] in (Quantity.JOINT_ZERO, Quantity.LINK_TWIST):  # may lie at half a turn
                    change = (change + np.pi) % (2.0 * np.pi) - np.pi
                row[start] = change / (2.0 * LINE_STEP)
    for (quantity, symbol), (axes, _) in _measures(nominal, nominal, names).items():
        is_length = quantity in (Quantity.LINK_LENGTH, Quantity.JOINT_OFFSET)
        w = weights.get((quantity, symbol), np.zeros(0))
        if np.any(w):
            yield Functional(
                quantity=quantity,
                symbol=symbol,
                axes=axes,
                unit="mm" if is_length else "rad",
                weights=w,
                lever=1.0 if is_length else levers[axes[-1]],
            )


def _levers(chain: Chain, names: Sequence[str]) -> dict[str, float]:
    """Length of the arm behind every joint, stretched out, mm."""
    points = [*(chain.link(j).point for j in names), chain.links[-1].point]
    lengths = [float(np.linalg.norm(b - a)) for a, b in pairwise(points)]
    return {name: sum(lengths[i:]) for i, name in enumerate(names)}


def _moved(lines: Lines, names: Sequence[str], chain: Chain, symbol: Symbol, step: float) -> Lines:
    """Lines at reading zero with one location error of a joint."""
    i, link = names.index(symbol.link), chain.link(symbol.link)
    e = link.frame[:, symbol.component % 3] * step
    point, direction = lines.point.copy(), lines.direction.copy()
    if symbol.component < 3:
        point[i] += e
    elif symbol.component != link.own_component:
        direction[i] = rotation(e) @ direction[i]
    else:  # all that follow turn about it
        R = rotation(step * direction[i])
        point[i + 1 :] = point[i] + (point[i + 1 :] - point[i]) @ R.T
        direction[i + 1 :] = direction[i + 1 :] @ R.T
    return Lines(point, direction)


def _measures(
    lines: Lines, nominal: Lines, names: Sequence[str]
) -> Mapping[tuple[Quantity, str], tuple[tuple[str, ...], float]]:
    """What neighbouring lines say of one another: joints and value by quantity and symbol."""
    out: dict[tuple[Quantity, str], tuple[tuple[str, ...], float]] = {}
    normals = [lines.normal(i) for i in range(len(names) - 1)]
    is_parallel = [nominal.is_parallel(i) for i in range(len(names) - 1)]
    for i, (one, other) in enumerate(pairwise(names)):
        pair, n = (one, other), normals[i]
        if not np.any(n):
            continue
        between = lines.point[i + 1] - lines.point[i]
        out[Quantity.LINK_LENGTH, f"a({one},{other})"] = pair, float(n @ between)
        across = np.cross(lines.direction[i], lines.direction[i + 1])
        twist = float(np.arctan2(n @ across, lines.direction[i] @ lines.direction[i + 1]))
        out[Quantity.LINK_TWIST, f"alpha({one},{other})"] = pair, twist
        if is_parallel[i]:
            lean = float(np.cross(lines.direction[i], n) @ across)
            out[Quantity.LINK_TWIST, f"beta({one},{other})"] = pair, lean
    for i in range(1, len(names) - 1):
        before, after = normals[i - 1], normals[i]
        if np.any(before) and np.any(after):
            d = lines.direction[i]
            angle = float(np.arctan2(d @ np.cross(before, after), before @ after))
            out[Quantity.JOINT_ZERO, f"E{names[i][0]}0{names[i]}"] = (names[i],), angle
        # the place of an offset along successive parallel lines is undetermined
        last = i
        while last < len(names) - 1 and is_parallel[last]:
            last += 1
        if not is_parallel[i - 1] and last < len(names) - 1:
            along = lines.foot(last, last + 1) - lines.foot(i, i - 1)
            offset = float(lines.direction[i] @ along)
            label = ",".join(names[i : last + 1])
            out[Quantity.JOINT_OFFSET, f"d({label})"] = tuple(names[i : last + 1]), offset
    return out
