"""What drivers that no run recorded may do in a run that a saved model does not know."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.laws import REPEATED
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.laws import law_of
from matstd.twin.library import ordinary_model
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
            unknown = law.elsewhere(theta[[effect is law for effect, _ in model.parameters]])
            out[unknown.name] = unknown
    return tuple(out.values())


def repeated_laws(
    model: Model, theta: Array, left_out: Sequence[EffectOfOtherRun], run: Run
) -> tuple[EffectOfOtherRun, ...]:
    """Laws of another run that this one repeats, at the same times.

    What switches with the program, such as coolant, begins with it in every run. The touches
    decide: set-ups and ordinary model are fitted to them with the law as learnt and without it.

    Args:
        model: With the effects that are left out.
        theta: Its estimates, (P,), base units.
    """
    run = with_commanded(run)
    ordinary = ordinary_model(run.touches.chain)

    def left(known: Array) -> float:
        fit = fit_run(replace(run, deviation=run.deviation - known), ordinary)
        return float(fit.noise.chi2_ratio**0.5)

    out: list[EffectOfOtherRun] = []
    known, least = np.zeros(len(run)), np.nan
    for one in (other for other in left_out if law_of(other.effect) is not None):
        own = theta[[effect is one.effect for effect, _ in model.parameters]]
        try:
            tried = known + columns([one.effect], run.touches) @ own
            least = left(known) if np.isnan(least) else least
            error = left(tried)
        except DesignError:  # a column that this run has not, or too few touches
            continue
        if error < REPEATED * least:
            out.append(replace(one, is_repeated=True))
            known, least = tried, error
    return tuple(out)


def kept_law(effect: Effect, is_of_run: bool) -> Effect:
    """An effect of a model file; a law that belongs to its run for other reasons is marked so."""
    law = law_of(effect)
    return effect if law is None else replace(law, is_of_run=is_of_run)
