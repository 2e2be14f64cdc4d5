"""The model that predicts: members of a class share what they explain together.

Members that a run does not distinguish may differ at other places, or on a day when their sensors
part. Which of them it is, nothing has shown; so prediction takes their mean. All of them stand in
one fit, each with a prior variance ``w_k a_k^2``, w_k its probability and a_k the size at which it
alone would do: given their sum the members then have the variances ``w_k (1 - w_k) a_k^2`` of a
mixture, in the uncertainty of a prediction and in the error to expect. A sum of n times its
uncertainty is drawn to zero by one n-th of that.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.accuracy import other_places
from matstd.diagnosis.answer.ambiguity import ConfusionClass, Rival, plausibility
from matstd.diagnosis.answer.steps import Step, left_by
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.search import FOUND_PRIOR_FACTOR, DiagnosisTask
from matstd.twin.frames import Array
from matstd.twin.model import Effect, columns, original_of, traits
from matstd.twin.numbers import rms
from matstd.twin.record import Touches

MAX_MEMBERS = 6
"""Most members of one class, the likeliest first; what a further one adds is less than a tenth."""

MIN_DIFFERENCE = 0.01
"""Share of the square of its columns at other places that those before it must leave of a member: a
tenth of an effect is less than its uncertainty usually is."""


def averaged(
    task: DiagnosisTask,
    steps: Sequence[Step],
    classes: Sequence[ConfusionClass],
    gross: GrossErrors,
) -> Fit:
    """The fit with all members of every class that predict differently.

    Args:
        steps: The error falling; the last has the named members alone, and stands where no other
            member predicts anything else.
        classes: Of the found effects, which follow those of the user.
    """
    touches, single = task.run.touches, steps[-1].fit
    there = other_places(touches, np.random.default_rng(0))
    effects = [s.effect for s in steps if s.effect is not None]
    sized = [replace(one, effect=e) for one, e in zip(task.added, effects, strict=False)]
    names = {effect.name for effect in effects}
    for effect, own in zip(effects[len(task.added) :], classes, strict=True):
        head = Rival(replace(own.sized, effect=effect), 0.0, 1.0)
        rivals = (r for r in own.rivals if r.effect.name not in names)
        members = list(_different([head, *rivals], there))
        names |= {m.effect.name for m in members}
        prior = plausibility([m.effect for m in members], touches)
        log_odds = np.array([prior[m.effect.name] - m.log_odds for m in members])
        weights = np.exp(log_odds - log_odds.max())
        roots = np.sqrt(weights / weights.sum())
        if len(members) == 1:
            sized.append(head.sized)
            continue
        explained = columns([effect], touches) @ single.theta[single.of_effect(effect.name)]
        sized += [
            replace(m.sized, scale=_size(m.effect, explained, touches) * float(root))
            for m, root in zip(members, roots, strict=True)
        ]
    return single if len(sized) == len(effects) else task.fit(sized, gross)


def _size(effect: Effect, explained: Array, touches: Touches) -> float:
    """Scale of the prior of an effect that explains a deviation (N,) by itself."""
    theta = np.linalg.lstsq(columns([effect], touches), explained, rcond=None)[0]
    size = rms(theta / np.array([p.sd for p in effect.parameters]))
    return max(size, 1e-6) / FOUND_PRIOR_FACTOR


def _different(members: Sequence[Rival], there: Touches) -> Iterator[Rival]:
    """Members that follow another driver than those before, or act otherwise at other places."""
    taken: list[tuple[str, Array]] = []
    for one in members:
        C, driver = columns([one.effect], there), traits(original_of(one.effect)).driver
        if all(left_by(C, B) > MIN_DIFFERENCE for other, B in taken if other == driver):
            taken.append((driver, C))
            yield one
        if len(taken) == MAX_MEMBERS:
            return
