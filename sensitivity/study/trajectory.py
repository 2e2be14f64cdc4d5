"""Poses along a path of the machine, and the deviations that errors cause on it.

The D-MT paper shows the effect of the error motions of one axis along a path on which X and C run
linearly and B swings (its figures 2 and 3). Everything that takes poses takes the readings of a
trajectory too: `montecarlo.volumetric(population, path.q, path.length, ...)`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.sensitivity.first_order import Workspace
from matstd.twin.effects import ComponentError, component
from matstd.twin.errors import DesignError, OutsideTravel, UnknownAxis
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Ranges
from matstd.twin.model import Effect, Model, traits
from matstd.twin.record import at_poses
from matstd.twin.units import UM, URAD

TRAJECTORY_POSES = 361
_QUARTER = 0.5 * np.pi


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A path through readings."""

    chain: Chain
    q: Array  # readings, (N, A), mm and rad
    length: float  # tool length, mm
    name: str  # what it is, in words

    @property
    def along(self) -> Array:
        """Share of the way, 0 to 1, (N,)."""
        return np.linspace(0.0, 1.0, len(self.q))

    @property
    def moving(self) -> tuple[str, ...]:
        """Axes that move on the way."""
        return tuple(a for a, span in zip(self.chain.axes, np.ptp(self.q, axis=0), strict=True)
                     if span > 0.0)  # fmt: skip


def paper_trajectory(
    workspace: Workspace, count: int = TRAJECTORY_POSES, held: Mapping[str, float] | None = None
) -> Trajectory:
    """The path of the D-MT paper: some axes run linearly over their limits, another one swings.

    ``q = low + s (high - low)``, and twice to and fro ``q = middle + half sin(4 pi s)``, s from 0
    to 1. Linearly run the first linear axis and the rotary axis with the widest limits, X and C on
    the machine of the paper; the other rotary axis swings, B there, or else a second linear one.

    Args:
        held: Readings of other axes; those left out stay in the middle of their limits.

    Raises:
        UnknownAxis: An axis that the machine does not have, or that is not programmed.
        OutsideTravel: A held reading beyond the travel.
        DesignError: A held axis that moves, fewer than two poses, or a path on which nothing moves.

    Reference:
        D-MT paper, figures 2 and 3.
    """
    chain, held = workspace.chain, held or {}
    linear, swinging = _roles(workspace)
    if count < 2:
        raise DesignError(f"a path of {count} poses: expected two at least")
    # equal steps of s, not of time: no feed is implied
    s = np.linspace(0.0, 1.0, count)
    q = np.tile(workspace.centre, (count, 1))
    for name, value in held.items():
        if name not in chain.programmed_axes:
            raise UnknownAxis(name, chain.programmed_axes)
        if name in (*linear, swinging):
            raise DesignError(f"{name} held: expected an axis that does not move on this path")
        low, high = chain.link(name).range
        if not low <= value <= high:
            raise OutsideTravel(f"{name} held at {value:g}: beyond its travel {low:g} to {high:g}")
        q[:, chain.axis_index(name)] = value
    for name in linear:
        low, high = workspace.limit(name)
        q[:, chain.axis_index(name)] = low + s * (high - low)
    if swinging:
        low, high = workspace.limit(swinging)
        wave = np.sin(4.0 * np.pi * s)
        q[:, chain.axis_index(swinging)] = 0.5 * (low + high) + 0.5 * (high - low) * wave
    words = [f"{' and '.join(linear)} linear"] if linear else []
    words += [f"{swinging} sinusoidal"] if swinging else []
    made = Trajectory(chain, q, workspace.length, ", ".join(words))
    if not made.moving:
        raise DesignError("the path: no axis has room to move within its limits")
    return made


def _roles(workspace: Workspace) -> tuple[tuple[str, ...], str | None]:
    """Default axes that run, and the one that swings."""
    chain = workspace.chain
    linear = sorted(a for a in workspace.open_axes if a in chain.linear_axes)
    rotary = sorted(
        (a for a in workspace.open_axes if a in chain.rotary_axes),
        key=lambda a: -float(np.ptp(workspace.limit(a))),
    )
    spare = rotary[1:] or rotary or linear[1:]
    swinging = spare[0] if spare else None
    return tuple(a for a in (*linear[:1], *rotary[:1]) if a != swinging), swinging


@dataclass(frozen=True, eq=False)
class AlongPath:
    """Deviations of the tool point along a trajectory by some errors."""

    trajectory: Trajectory
    errors: tuple[tuple[Effect, Array], ...]  # effects with their amplitudes, mm and rad
    deviation: Array  # exact deviation of the tool point in the table frame, (N, 3), mm
    # length of the deviation that each error makes alone, by its name, (N,) each, mm
    each: Mapping[str, Array] = field(default_factory=dict)
    axis: str = ""  # whose error motions they are; empty for any others

    @property
    def size(self) -> Array:
        """Volumetric error, (N,), mm."""
        return np.linalg.norm(self.deviation, axis=1)

    @property
    def dominant(self) -> list[str]:
        """Errors by the root mean square of what they make alone, the largest first."""
        return sorted(self.each, key=lambda name: -float(np.mean(self.each[name] ** 2)))


def along_path(trajectory: Trajectory, errors: Sequence[tuple[Effect, Array]]) -> AlongPath:
    """Deviation of the tool point along a trajectory, all errors together and each alone.

    Errors are effects with their amplitudes, as an error file holds them.
    """
    chain = trajectory.chain
    poses = at_poses(chain, trajectory.q, trajectory.length)

    def deviation(some: Sequence[tuple[Effect, Array]]) -> Array:
        theta = np.concatenate([np.atleast_1d(a) for _, a in some]) if some else np.zeros(0)
        return Model(chain, tuple(e for e, _ in some)).tip_deviation(poses, theta)

    each: dict[str, Array] = {}
    names = [_short(effect) for effect, _ in errors]
    for name in dict.fromkeys(names):
        own = [pair for pair, n in zip(errors, names, strict=True) if n == name]
        each[name] = np.linalg.norm(deviation(own), axis=1)
    return AlongPath(trajectory, tuple(errors), deviation(errors), each)


def _short(effect: Effect) -> str:
    """Symbol of an error parameter; the whole name of anything else."""
    symbol = traits(effect).symbol
    return symbol.name if symbol is not None else effect.name


def axis_errors(chain: Chain, axis: str) -> list[tuple[ComponentError, Array]]:
    """Error motions of one axis as the D-MT paper draws them; raises UnknownAxis.

    A linear axis (figure 2): all six linear, translations of 50, 75 and 100 µm, rotations of as
    many µrad, over which the paper is silent. A rotary axis (figure 3): all six sinusoidal; the two
    radial ones of 10 µm, a quarter turn apart, the others at the lower end of what random machines
    have, so that the radial ones dominate as in the paper.
    """
    if axis not in chain.programmed_axes:
        raise UnknownAxis(axis, chain.programmed_axes)
    link, out = chain.link(axis), []
    radial = [i for i in range(3) if i != link.own]
    for i, letter in enumerate("XYZABC"):
        name = f"E{letter}{axis}"
        unit = UM if i < 3 else URAD
        if link.kind == "linear":
            size = (50.0, 75.0, 100.0)[i % 3] * unit
            out.append((component(chain, name, "linear"), np.array([size])))
            continue
        phase = _QUARTER if i == radial[1] else 0.0
        low = Ranges().of(chain, chain.symbol(name))[0]
        size = 10.0 * UM if i in radial else low
        out.append((component(chain, name, "sinusoidal", phase=phase), np.array([size])))
    return out


def axis_effect(trajectory: Trajectory, axis: str) -> AlongPath:
    """Effect of the error motions of one axis along a trajectory.

    Reference:
        D-MT paper, figure 2 (X) and figure 3 (C).
    """
    return replace(along_path(trajectory, axis_errors(trajectory.chain, axis)), axis=axis)
