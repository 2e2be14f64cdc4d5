"""Outliers that found effects predict are taken back into the fit; those that bend it stay out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import GrossErrors, shots
from matstd.diagnosis.search.task import DiagnosisTask


def restore_predicted_outliers(
    task: DiagnosisTask, effects: Sequence[ScaledEffect], before: GrossErrors
) -> Fit:
    """The fit with effects; outliers that the effects predict are taken back into it.

    Of an instrument that sees a target from afar (`shots`): a pose that its neighbours know little
    of, as the only one of an arm far out, bends an effect in all its coordinates until it fits. It
    returns if effects that were found without it, and fitted without it, say what it reads; where
    they merely do not contradict it, it stays out. Single touches return as they like: of a drift
    they are the first after a step, which what drives it explains.
    """
    whole = task.fit(effects)
    shot = shots(task.run.touches)
    is_several = np.bincount(shot)[shot] > 1
    returned = before.rows & ~whole.gross.rows & is_several
    if not returned.any():
        return whole
    without = task.fit(effects, before)
    noise = without.noise.factor * task.run.u
    missed = returned & (np.abs(without.residual) > before.limit * noise)
    if not missed.any():
        return whole
    missed = returned & np.isin(shot, shot[missed])
    return task.fit(effects, replace(whole.gross, rows=whole.gross.rows | missed))
