"""What may carry an error that has no name: components of the axes, the standard, the probe."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, carrier_of
from matstd.twin.machine import Family
from matstd.twin.record import Touches

SAME_COSINE = 0.99999  # cosine of carriers that no touch of a run distinguishes


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
