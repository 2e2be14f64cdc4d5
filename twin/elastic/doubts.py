"""Where the theory of beams is no longer good enough for a body."""

from collections.abc import Iterable, Iterator

from matstd.twin.elastic.body import SLENDER, Body
from matstd.twin.machine import Chain
from matstd.twin.model import Effect


def short_beams(chain: Chain, effects: Iterable[Effect]) -> Iterator[tuple[str, float]]:
    """Names of beams that are short for their depth over the whole travel, and length over depth.

    What holds such a body, and the bending of its walls, count as much as the beam.
    """
    for effect in effects:
        if isinstance(effect, Body):
            ratio = effect.slenderness(*chain.link(effect.axis).range)
            if ratio < SLENDER:
                yield effect.name, ratio
