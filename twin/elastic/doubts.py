"""Bodies that are too short for the theory of beams."""

from collections.abc import Iterable, Iterator

from matstd.twin.elastic.body import SLENDER, Body
from matstd.twin.machine import Chain
from matstd.twin.model import Effect


def short_beams(chain: Chain, effects: Iterable[Effect]) -> Iterator[tuple[str, float]]:
    """Names of beams that are short for their depth over the whole travel, and length over depth.

    Supports and walls of such a body yield as much as the beam.
    """
    for effect in effects:
        if isinstance(effect, Body):
            ratio = effect.slenderness(*chain.link(effect.axis).range)
            if ratio < SLENDER:
                yield effect.name, ratio
