"""What a run could have shown: the smallest size of every effect that would have been found."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ScaledEffect, Signatures, needed_lengths, projected
from matstd.diagnosis.fit import inner_unit
from matstd.diagnosis.search import Search
from matstd.twin.frames import Array
from matstd.twin.model import Effect, inner_values
from matstd.twin.record import Touches

MAX_SIZE_RATIO = 30.0
"""Beyond so many times its expected size an effect is called invisible in these touches."""


@dataclass(frozen=True, slots=True)
class Scanned:
    """Range in which an inner parameter was looked for, refinement between its points included."""

    quantity: str  # `period`, `tau`
    unit: str  # as in files: `mm`, `min`
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Detectable:
    """Smallest size of one effect that these touches would have shown."""

    effect: Effect
    # in the base unit of its first parameter, at the median of its inner parameters; None where the
    # model in use imitates the effect
    size: float | None
    unit: str
    # largest deviation of a touch that an effect of this size causes, mm; None as size
    largest: float | None
    survives: float  # share of its signature (as squares) that the model cannot imitate
    # where its inner parameters were looked for; outside, nothing is said of it
    scanned: tuple[Scanned, ...] = ()


def detectable(
    pool: Signatures, found: Sequence[ScaledEffect], touches: int | None = None
) -> tuple[Detectable, ...]:
    """Smallest detectable size of every candidate, with the other found effects in the model.

    The squared length of a signature that the search finds in four of five runs, under this name or
    under one that does nearly the same, over the squared signature per unit of prior, averaged over
    the directions of the effect's parameters.

    Args:
        touches: Number of touches of the run, where set and pool are an even choice of them.
    """
    share = 1.0 if touches is None else len(pool.complement.u) / touches
    effects = EffectSet(pool.complement, projected(pool.complement, found))
    mean, whole = _surviving(effects, pool)
    for one in found:  # which would hide itself
        rest = projected(pool.complement, [f for f in found if f is not one])
        own = np.array([v.name == one.effect.name for v in pool.variants], dtype=bool)
        mean[own] = _surviving(EffectSet(pool.complement, rest), pool)[0][own]
    middle = np.array([_middle(pool, mean, k) for k in range(len(pool.names))], dtype=np.int64)
    if not len(middle):
        return ()
    beside, dof = effects.whiten(pool.C), max(effects.dof, 1.0)
    needed = needed_lengths(pool, middle, Search(pool).prior, beside, dof)
    scale = share * effects.objective / dof
    with np.errstate(divide="ignore"):
        length = np.sqrt(needed * scale / np.maximum(mean[middle], 1e-300))
    survives = np.maximum(mean[middle] / np.maximum(whole[middle], 1e-300), 0.0)
    return tuple(
        _one(pool, int(v), float(one), float(own))
        for v, one, own in zip(middle, length, survives, strict=True)
    )


def _middle(pool: Signatures, mean: Array, candidate: int) -> int:
    """The point of the grid of a candidate with the median signature."""
    own = np.flatnonzero(pool.owner == candidate)
    return int(own[np.argsort(-mean[own], kind="stable")[len(own) // 2]])


def _surviving(effects: EffectSet, pool: Signatures) -> tuple[Array, Array]:
    """Squares of signatures that a set cannot imitate, and of whole ones, by variant, (V,) each."""
    E = effects.whiten(pool.C)
    mean, whole = np.zeros((2, len(pool.variants)))
    for k, (which, cols) in pool.by_width.items():
        own = np.einsum("kvi,kvi->vi", E[:, cols], E[:, cols])
        diagonal = np.einsum("vii->vi", pool.gram[k])
        mean[which] = (diagonal - own).sum(axis=1) / k
        whole[which] = (pool.size[cols] ** 2).sum(axis=1) / k
    return mean, whole


def _one(pool: Signatures, variant: int, length: float, survives: float) -> Detectable:
    """Smallest size of one candidate at one point of its grid.

    Args:
        length: Of its parameters, in units of their prior standard deviations.
        survives: Share of its signature that the model cannot imitate.
    """
    effect, visible = pool.variants[variant], length < MAX_SIZE_RATIO
    C = pool.complement.columns([effect]) * pool.complement.u[:, None]
    first, touch = effect.parameters[0], float(np.sqrt((C**2).sum(axis=1).max()))
    return Detectable(
        effect=effect,
        size=length * first.sd if visible else None,
        unit=first.unit,
        largest=length * touch if visible else None,
        survives=survives,
        scanned=tuple(_scans(effect, pool.complement.touches)),
    )


def _scans(effect: Effect, touches: Touches) -> Iterator[Scanned]:
    """Ranges of the inner parameters of an effect; an instant is looked for in all of the run."""
    for inner, _ in inner_values(effect, touches):
        suffix, factor = inner_unit(inner)
        if inner.acts != "at an instant" and len(inner.grid) > 1:
            low, high = float(np.min(inner.grid)) / factor, float(np.max(inner.grid)) / factor
            yield Scanned(inner.name, suffix.removeprefix("_"), low, high)
