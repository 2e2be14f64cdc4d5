"""What drivers that no run recorded may do in a run that a saved model does not know."""

from collections.abc import Sequence
from dataclasses import replace

from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.twin.frames import Array
from matstd.twin.laws import law_of
from matstd.twin.model import Effect, Model


def unknown_elsewhere(
    model: Model, theta: Array, left_out: Sequence[EffectOfOtherRun]
) -> tuple[Effect, ...]:
    """In the place of laws of another run: zero, as unsure as they are large.

    Args:
        model: With the effects that are left out.
        theta: Its estimates, (P,), base units.
    """
    out: dict[str, Effect] = {}
    for one in left_out:
        law = law_of(one.effect)
        if law is not None:
            unknown = law.elsewhere(theta[[effect is law for effect, _ in model.parameters]])
            out[unknown.name] = unknown
    return tuple(out.values())


def kept_law(effect: Effect, is_of_run: bool) -> Effect:
    """An effect of a model file; a law that belongs to its run for other reasons is marked so."""
    law = law_of(effect)
    return effect if law is None else replace(law, is_of_run=is_of_run)
