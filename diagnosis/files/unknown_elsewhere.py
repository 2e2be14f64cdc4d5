"""What laws of a saved model say of a run that it was not learnt from."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.laws import REPEATED, error_left, fit_beside, log_odds
from matstd.diagnosis.next_visit import DECIDED
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.twin.errors import NotEnoughData, UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.laws import Law, law_of
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Run, with_commanded


def unknown_elsewhere(
    model: Model, theta: Array, left_out: Sequence[EffectOfOtherRun]
) -> tuple[Effect, ...]:
    """In place of laws of another run: zero, as unsure as they are large.

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


def judged_laws(
    model: Model, theta: Array, left_out: Sequence[EffectOfOtherRun], run: Run, learnt_in: str
) -> tuple[tuple[EffectOfOtherRun, ...], tuple[EffectOfOtherRun, ...]]:
    """What the touches of a run say of laws that were learnt from another one.

    Set-ups and model are fitted to them with the laws as they were learnt. A law that belongs to
    its run is applied where the touches show it, too: what switches with the program, such as
    coolant, begins with it in every run. A law of the machine is expected everywhere, unless the
    touches speak against it with odds of 20 : 1.

    Args:
        model: With all laws.
        theta: Its estimates, (P,), base units.
        left_out: Effects of other runs.
        learnt_in: Run that the model was learnt from; "" where that is this one, which doubts none.

    Returns:
        Those of them that this run shows, and laws of the machine that it speaks against.
    """
    bound = [one for one in left_out if law_of(one.effect) is not None]
    names = {one.effect.name for one in left_out}
    own = [law for law in map(law_of, model.effects) if law and not law.is_margin]
    lasting = [law for law in own if law.name not in names]
    if not bound and not (learnt_in and lasting):
        return (), ()
    kept = (e for e in model.effects if law_of(e) is None and e.name not in names)
    others = Model(model.chain, tuple(kept))
    run = with_commanded(run)
    shown, refuted = list[EffectOfOtherRun](), list[EffectOfOtherRun]()

    def moved(law: Effect) -> Array:
        here = theta[[effect is law for effect, _ in model.parameters]]
        return columns([law], run.touches) @ here

    try:
        added = {law.name: moved(law) for law in lasting}
        known = np.sum([np.zeros(len(run)), *added.values()], axis=0)
        least = fit_beside(known, run, others)
        for law in lasting if learnt_in else ():
            tried = fit_beside(known - added[law.name], run, others, least.gross)
            if log_odds(tried, least, 0.0) > DECIDED:
                refuted.append(
                    EffectOfOtherRun(
                        effect=law,
                        owner="machine",
                        inner={},
                        run=learnt_in,
                        share=0.0,
                        is_refuted=True,
                    )
                )
                known, least = known - added[law.name], tried
        for one in bound:
            # on the same rows: touches that contradict the law are no gross errors
            tried = fit_beside(known + moved(one.effect), run, others, least.gross)
            if error_left(tried) < REPEATED * error_left(least):
                shown.append(replace(one, is_repeated=True))
                known, least = known + moved(one.effect), tried
    except (NotEnoughData, UnknownEffect):  # too few touches, or a column that this run has not
        pass
    return tuple(shown), tuple(refuted)


def kept_law(effect: Effect, is_of_run: bool) -> Effect:
    """An effect of a model file; a law that belongs to its run for other reasons is marked so."""
    law = law_of(effect)
    return effect if law is None else replace(law, is_of_run=is_of_run)
