"""Disturbances of a simulated campaign: effects of known size, and the record that drives them.

Effects act on the touches of the whole campaign: a lag depends on earlier touches, a slip of the
standard on later ones. The drivers of a lag (temperatures, spindle speed) are followed over the
whole record; the analysis of the run knows them at the touches only.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from matstd.twin.files import SensorRecord
from matstd.twin.frames import Array
from matstd.twin.machine import Contribution
from matstd.twin.model import Effect, contribution, traits
from matstd.twin.record import Setup, Touches, stacked

Disturbance = Callable[[Touches], Contribution]


def effects_over_record(
    effects: Sequence[tuple[Effect, Array]], record: SensorRecord | None = None
) -> Disturbance:
    """Disturbance by effects of known size.

    Args:
        effects: Each with its parameters (P,), base units.
        record: Temperatures and spindle speeds by the clock; None where nothing is recorded.

    Raises:
        UnknownEffect: When it is used: an effect follows a sensor that the record lacks.
    """
    if record is None:
        return lambda touches: contribution(effects, touches)
    # a touch repeated at every reading of the record is its history
    start, moments = record.begin, record.since(record.begin)
    driven = [pair for pair in effects if traits(pair[0]).needs_history]
    others = [pair for pair in effects if pair not in driven]

    def disturbance(touches: Touches) -> Contribution:
        touches = record.at_touches(touches, start)
        total = contribution(others, touches)
        if driven:
            again = touches[np.zeros(len(moments), dtype=np.int64)]
            history = record.at_touches(replace(again, time=moments), start)
            both = contribution(driven, joined_touches([history, touches]))
            total = Contribution(*(a + b[len(history) :] for a, b in zip(total, both, strict=True)))
        return total

    return disturbance


def joined_touches(parts: Sequence[Touches]) -> Touches:
    """Touches of one machine, one after the other; set-ups of the same name are one."""
    setups: dict[str, Setup] = {}
    counted = []
    for part in parts:
        for setup in part.setups:
            setups.setdefault(setup.name, setup)
        numbers = np.array([list(setups).index(s.name) for s in part.setups], dtype=np.int64)
        counted.append(replace(part, setup=numbers[part.setup]))
    return stacked(counted, tuple(setups.values()))


def in_campaign(
    disturbance: Disturbance, before: Sequence[Touches], after: Sequence[Touches]
) -> Disturbance:
    """The disturbance of some touches that are made between others of the same campaign."""
    if not before and not after:
        return disturbance
    skipped = sum(len(part) for part in before)

    def disturbed(touches: Touches) -> Contribution:
        whole = disturbance(joined_touches([*before, touches, *after]))
        mine = slice(skipped, skipped + len(touches))
        return Contribution(*(part[mine] for part in whole))

    return disturbed
