"""What drivers that no run recorded may do in a run that a saved model does not know."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.laws import REPEATED, left_beside
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.twin.errors import NotEnoughData, UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.laws import Law, law_of
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Run, with_commanded


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
            own = theta[[effect is law for effect, _ in model.parameters]]
            unknown = law.elsewhere(own, _largest(law, model))
            out[unknown.name] = unknown
    return tuple(out.values())


def _largest(law: Law, model: Model) -> float:
    """Largest amount of a law in its run, base unit: the last place of its margin or its curve."""
    laws = [one for one in map(law_of, model.effects) if one is not None]
    margins = [m for m in laws if m.is_margin and m.carrier == law.carrier]
    sizes = [m.places[-1] for m in margins if set(m.drivers) <= set(law.drivers)]
    return max(sizes, default=law.places[-1])


def repeated_laws(
    model: Model, theta: Array, left_out: Sequence[EffectOfOtherRun], run: Run
) -> tuple[EffectOfOtherRun, ...]:
    """Laws of another run that the touches of this one show, too.

    What switches with the program, such as coolant, begins with it in every run. The touches
    decide: set-ups and model are fitted to them with the law as it was learnt and without it.

    Args:
        model: With the effects that are left out.
        theta: Its estimates, (P,), base units.
    """
    laws = [one for one in left_out if law_of(one.effect) is not None]
    if not laws:
        return ()
    names = {one.effect.name for one in left_out}
    others = Model(model.chain, tuple(e for e in model.effects if e.name not in names))
    run = with_commanded(run)
    known, out = np.zeros(len(run)), list[EffectOfOtherRun]()
    try:
        least = left_beside(known, run, others)
        for one in laws:
            own = theta[[effect is one.effect for effect, _ in model.parameters]]
            tried = known + columns([one.effect], run.touches) @ own
            error = left_beside(tried, run, others)
            if error < REPEATED * least:
                out.append(replace(one, is_repeated=True))
                known, least = tried, error
    except (NotEnoughData, UnknownEffect):  # too few touches, or a column that this run has not
        pass
    return tuple(out)


def kept_law(effect: Effect, is_of_run: bool) -> Effect:
    """An effect of a model file; a law that belongs to its run for other reasons is marked so."""
    law = law_of(effect)
    return effect if law is None else replace(law, is_of_run=is_of_run)
