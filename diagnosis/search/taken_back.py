"""Gross errors that fit once effects are found: foretold by them, or bending them?"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.evidence import ScaledEffect
from diagnosis.fit import Fit
from diagnosis.regression import GrossErrors, shots
from diagnosis.search.task import DiagnosisTask


def foretold(task: DiagnosisTask, effects: Sequence[ScaledEffect], before: GrossErrors) -> Fit:
    """The fit with effects, of whose gross errors before only those return that it foretells.

    A touch that its neighbours know little of, as the only pose of an arm far out, bends an effect
    until it fits. It returns if effects that were found without it, and fitted without it, say what
    it reads; where they merely do not contradict it, it stays out.

    Args:
        effects: Everything that was found or added.
        before: Gross errors beside the model without what was found.
    """
    whole = task.fit(effects)
    returned = before.rows & ~whole.gross.rows
    if not returned.any():
        return whole
    without = task.fit(effects, before)
    noise = without.noise.factor * task.run.u
    missed = returned & (np.abs(without.residual) > before.limit * noise)
    if not missed.any():
        return whole
    shot = shots(task.run.touches)
    missed = returned & np.isin(shot, shot[missed])
    return task.fit(effects, replace(whole.gross, rows=whole.gross.rows | missed))
