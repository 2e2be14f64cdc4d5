"""What may carry an error that has no name: components of the axes, the standard, the probe."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, carrier_of
from matstd.twin.machine import Family
from matstd.twin.record import Touches

SAME_COSINE = 0.99999  # cosine of carriers that no touch of a run distinguishes

SPREAD = np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0])
"""Steps of readings, in travels, that fill the travels of all axes evenly (Weyl's sequence)."""


class Bearer(NamedTuple):
    """A carrier with its columns, and others that do the same at every touch."""

    carrier: Carrier
    C: Array  # as whitened, (n, count)
    alike: tuple[Carrier, ...]


def bearers(
    touches: Touches, white: Callable[[Array], Array], others: Sequence[str]
) -> list[Bearer]:
    """Every carrier of a run once; those with equal columns are kept as alike of the first.

    Args:
        touches: Of the run.
        white: Columns of all touches (N, K) as the tests need them, (n, K).
        others: Carriers beside the component errors of the axes.
    """
    chain = touches.chain
    names = [s.name for s in chain.symbols if s.family is Family.COMPONENT]
    firsts: list[tuple[Carrier, Array, list[Carrier]]] = []
    for name in (*names, *others):
        carrier = carrier_of(name, chain)
        C = white(carrier.columns(touches))
        size = np.linalg.norm(C)
        if size < 1e-12 * np.sqrt(len(C)):
            continue
        for _, other, alike in firsts:
            same = other.shape == C.shape
            if same and abs(float((other * C).sum())) > SAME_COSINE * size * np.linalg.norm(other):
                alike.append(carrier)
                break
        else:
            firsts.append((carrier, C, []))
    return [Bearer(carrier, C, tuple(alike)) for carrier, C, alike in firsts]


def apart_elsewhere(carrier: Carrier, alike: Sequence[Carrier], touches: Touches) -> list[Carrier]:
    """Of carriers that do the same at every touch of a run, those that differ in other poses.

    A run with B at one angle does not distinguish what B carries from what Z carries; another run
    does. Of several that are the same in all poses the first stands for all.
    """
    chain, q = touches.chain, touches.q.copy()
    moved = [chain.axis_index(axis) for axis in chain.programmed_axes]
    share = np.mod(np.outer(np.arange(len(q)), SPREAD[: len(moved)]), 1.0)
    limits = chain.travels[moved]
    q[:, moved] = limits[:, 0] + np.ptp(limits, axis=1) * share
    anywhere = replace(touches, q=q)
    others = [c.name for c in (carrier, *alike) if c.symbol is None]
    groups = [
        {b.carrier.name, *(c.name for c in b.alike)}
        for b in bearers(anywhere, lambda columns: columns, others)
    ]
    found = (next((c for c in alike if c.name in g), None) for g in groups if carrier.name not in g)
    return [c for c in found if c is not None]
