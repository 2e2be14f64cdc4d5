"""A machine whose geometry may change between runs: the model, and its state in every run.

Every component and location error stands in the model once, as of the first run, and once for every
change: between two runs anything of the geometry may become anything. The state of a run is then a
linear function of all parameters, ``theta_r = L_r theta``, so that values, changes and their
uncertainties come from one covariance, whatever the runs have in common. Effects that are no
geometry are common to all runs.
"""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.fit import Prior
from matstd.diagnosis.geometry.quantities import is_geometry
from matstd.twin.effects import Change
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Model, original_of, traits
from matstd.twin.record import Touches


def changing(model: Model, touches: Touches, since: Sequence[int]) -> Model:
    """The model with a geometry that may be another from some runs on.

    Args:
        since: Runs from which on it may differ, as in `Touches.run`.
    """
    own = standing(model)
    changes = [Change(e, i, touches.runs[i]) for i in since for e in own if is_geometry(e)]
    return Model(model.chain, (*own, *changes))


def standing(model: Model) -> tuple[Effect, ...]:
    """The effects of a model that are no changes."""
    return tuple(e for e in model.effects if traits(e).since_run is None)


def changed_since(model: Model) -> tuple[int, ...]:
    """Runs from which on the geometry of a model may differ."""
    since = (traits(e).since_run for e in model.effects)
    return tuple(sorted({run for run in since if run is not None}))


def since_first_run(model: Model) -> Model:
    """The model without changes since an earlier model: what its own runs determine."""
    kept = [e for e in model.effects if traits(e).since_run != 0]
    return Model(model.chain, tuple(kept))


def with_changes(prior: Prior, model: Model) -> Prior:
    """What is believed of a changing model, from what is believed of its standing effects.

    A machine that bends less than its class, as the run says, changes by less as well.
    """
    factors, at = {}, 0
    for effect in standing(model):
        factors[effect.name] = prior.factor[at : at + len(effect.parameters)]
        at += len(effect.parameters)
    for change in (e for e in model.effects if traits(e).since_run is not None):
        factor = factors[original_of(change).name]
        stated = Prior.of_effects([change])
        prior = prior.joined(Prior(stated.mean, factor[:, None] * stated.root, factor))
    return prior


def of_first(prior: Prior, model: Model) -> Prior:
    """Prior of the effects before the first change of a model."""
    since = [traits(e).since_run for e, _ in model.parameters]
    first = next((i for i, run in enumerate(since) if run is not None), None)
    return prior if first is None else Prior(prior.mean[:first], prior.root[:first, :first])


def state(model: Model, run: int) -> Array:
    """``L_r``: parameters in a run from all parameters of a model, (P, P).

    Rows of effects have their changes up to that run added; rows of changes are those of the
    changes themselves.
    """
    places, at = {}, 0
    for effect in model.effects:
        places[effect.name] = at
        at += len(effect.parameters)
    out = np.eye(at)
    for effect in model.effects:
        since = traits(effect).since_run
        if since is not None and since <= run:
            k = np.arange(len(effect.parameters))
            out[places[original_of(effect).name] + k, places[effect.name] + k] = 1.0
    return out


def state_of_standing(model: Model, run: int) -> Array:
    """The rows of `state` of the effects that are no changes, (P0, P)."""
    keep = [traits(e).since_run is None for e, _ in model.parameters]
    return state(model, run)[np.array(keep, dtype=bool)]
