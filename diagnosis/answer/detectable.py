"""What a run could have shown: the smallest size of every effect that would have been found."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from matstd.diagnosis.evidence import EffectSet, ScaledEffect, Signatures, projected
from matstd.diagnosis.fit import inner_unit
from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array
from matstd.twin.model import Effect, inner_values
from matstd.twin.record import Touches

MAX_SIZE_RATIO = 30.0
"""Beyond so many times its expected size an effect is called invisible in these touches."""


@dataclass(frozen=True, slots=True)
class Scanned:
    """Range in which an inner parameter was looked for, refinement between its points included.

    Attributes:
        quantity: `period`, `tau`.
        unit: As in files: `mm`, `min`.
    """

    quantity: str
    unit: str
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Detectable:
    """Smallest size of one effect that these touches would have shown.

    Attributes:
        size: In the base unit of its first parameter, at the median of its inner parameters; None
            where the model in use imitates the effect.
        largest: Largest deviation of a touch that an effect of this size causes, mm; None as size.
        survives: Share of its signature (as squares) that the model cannot imitate.
        scanned: Where its inner parameters were looked for; outside, nothing is said of it.
    """

    effect: Effect
    size: float | None
    unit: str
    largest: float | None
    survives: float
    scanned: tuple[Scanned, ...] = ()


def detectable(
    pool: Signatures, found: Sequence[ScaledEffect], touches: int | None = None
) -> tuple[Detectable, ...]:
    """Smallest detectable size of every candidate, with the other found effects in the model.

    The non-centrality that passes the corrected threshold in four of five runs, over the squared
    signature per unit of prior, averaged over the directions of the effect's parameters.

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
    needed = _needed(pool)
    scale = share * effects.objective / max(effects.dof, 1.0)
    with np.errstate(divide="ignore"):
        length = np.sqrt(needed * scale / np.maximum(mean, 1e-300))
    out = []
    for index in range(len(pool.names)):
        own_variants = np.flatnonzero(pool.owner == index)
        order = own_variants[np.argsort(length[own_variants])]
        middle = int(order[len(order) // 2])
        survives = mean[middle] / whole[middle] if whole[middle] > 0.0 else 0.0
        out.append(_one(pool, middle, float(length[middle]), max(float(survives), 0.0)))
    return tuple(out)


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


def _needed(pool: Signatures) -> Array:
    """Non-centrality that every variant needs, (V,)."""
    k = pool.width.astype(float)
    threshold = chdtri(k, POLICY.false_alarm / (pool.tries[pool.owner] * pool.tried))
    # k + L - POLICY.detection_power sqrt(2 k + 4 L) = threshold, a quadratic in sqrt(2 k + 4 L)
    root = 2.0 * POLICY.detection_power + np.sqrt(
        4.0 * POLICY.detection_power**2 + 4.0 * threshold - 2.0 * k
    )
    return np.asarray((root**2 - 2.0 * k) / 4.0)


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
