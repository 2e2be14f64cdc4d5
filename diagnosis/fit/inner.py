"""Inner parameters of effects in a fit: their tangent columns, and the steps that refine them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.model import (
    Effect,
    Inner,
    Model,
    Parameter,
    Term,
    Tunable,
    columns,
    is_tunable,
    with_inner,
)
from matstd.twin.record import Touches

DIFFERENCE_STEP = 0.02
"""Step of the central difference, as a share of the distance to the neighbour on the grid."""

TANGENT_PRIOR_SD = 5.0
"""Prior standard deviation of a displacement, in distances of the grid's points."""


@dataclass(frozen=True, eq=False)
class Tangent:
    """What changes when an inner parameter moves: one linear parameter, its displacement.

    ``d/dtau sum_k theta_k column_k(tau)`` by central difference. With it in a fit the covariance
    of the amplitudes carries the uncertainty of the inner parameter, and its estimate is a step of
    Gauss and Newton.
    """

    effect: Tunable
    index: int
    theta: tuple[float, ...]  # present linear parameters of the effect, (K,), base units
    step: float  # step of the difference, base unit of the inner parameter
    sd: float  # prior standard deviation of the displacement

    kind = "tangent"

    @property
    def name(self) -> str:
        """`thermal-lag(EZZ) tau`."""
        return f"{self.effect.name} {list(self.effect.tuning)[self.index]}"

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The displacement of the inner parameter."""
        return (Parameter("displacement", "1", self.sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Differences of the effect's terms."""
        out = []
        for sign in (1.0, -1.0):
            moved = shifted(self.effect, self.index, sign * self.step)
            weight = sign / (2.0 * self.step)
            for term in moved.terms(touches):
                amount = weight * self.theta[term.parameter] * term.amount
                out.append(Term(0, term.where, amount))
        return out


def shifted(effect: Tunable, index: int, by: float) -> Tunable:
    """The effect with one inner parameter moved."""
    return with_inner(effect, index, list(effect.tuning.values())[index] + by)


def spacing(inner: Inner, value: float) -> float:
    """Distance of the grid's points around a value."""
    grid = np.asarray(inner.grid, dtype=float)
    if len(grid) < 2:
        return abs(float(grid[0])) * 0.1 or 1.0
    i = int(np.clip(np.searchsorted(grid, value), 1, len(grid) - 1))
    return float(grid[i] - grid[i - 1])


def continuous_inner(effect: Effect, touches: Touches) -> list[tuple[int, Inner, float]]:
    """Index, description and present value of the inner parameters that can be refined."""
    if not is_tunable(effect):
        return []
    inner = effect.inner(touches)
    values = list(effect.tuning.values())
    return [(i, p, values[i]) for i, p in enumerate(inner) if p.continuous and len(p.grid) > 1]


def is_smooth(effect: Tunable, index: int, step: float, touches: Touches) -> bool:
    """Whether the columns change evenly with an inner parameter; an instant only makes jumps."""
    slopes = []
    for h in (step, 0.5 * step):
        moved = [columns([shifted(effect, index, s * h)], touches) for s in (1.0, -1.0)]
        slopes.append((moved[0] - moved[1]) / (2.0 * h))
    size = float(np.linalg.norm(slopes[1]))
    return size > 0.0 and float(np.linalg.norm(slopes[0] - slopes[1])) < 0.1 * size


def tangents(model: Model, touches: Touches, theta: Array) -> list[Tangent]:
    """Tangents of every inner parameter in a model with which its columns change smoothly.

    Args:
        theta: Present linear parameters, (P,).
    """
    out: list[Tangent] = []
    start = 0
    for effect in model.effects:
        count = len(effect.parameters)
        own = tuple(float(v) for v in theta[start : start + count])
        start += count
        for index, inner, value in continuous_inner(effect, touches):
            assert is_tunable(effect)
            step = DIFFERENCE_STEP * spacing(inner, value)
            if not is_smooth(effect, index, step, touches):
                continue
            sd = TANGENT_PRIOR_SD * spacing(inner, value)
            out.append(Tangent(effect=effect, index=index, theta=own, step=step, sd=sd))
    return out
