"""One set: what was tested is what is reported, drawn and saved.

Of effects that the run cannot distinguish the likeliest is named, which makes another set. So the
reported set is tested as it stands, every member beside the others; a name that fails there is not
used, and is reported beside the set.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.answer.alike import periods_alike
from matstd.diagnosis.answer.ambiguity import ConfusionClass, confusion_class
from matstd.diagnosis.evidence import ScaledEffect
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import find_structure
from matstd.diagnosis.search import (
    EffectSubset,
    SearchState,
    Verified,
    follows_driver,
    is_own_sensor,
    likeliest_drift,
    refined,
)
from matstd.twin.model import Effect, original_of, traits


@dataclass(frozen=True, slots=True, eq=False)
class ReportedSet:
    """A set of effects with its tests."""

    # of the search, its members the effects as reported, what explains most first
    state: SearchState
    # what each cannot be distinguished from, none of it in the set; in the same order
    classes: tuple[ConfusionClass, ...]
    # of every member with the others in place, by the name of the effect
    tests: Mapping[str, Verified]
    # log odds of those that follow a driver against one that was not recorded
    against_drift: Mapping[str, float]

    @property
    def open_driver(self) -> str | None:
        """Name of an effect of which the run shows neither sensor nor that one was recorded.

        Other sensors explain it as well, so that none of them is shown, and a driver that was not
        recorded is not ruled out as a further one.
        """
        for sized, one in zip(self.state.effects, self.classes, strict=True):
            odds = self.against_drift.get(sized.effect.name, np.inf)
            drivers = {_driver(sized.effect), *(_driver(r.effect) for r in one.rivals)} - {""}
            is_open = odds < POLICY.log_odds_open_driver and len(drivers) > 1
            if is_open and not is_own_sensor(sized.effect) and not self.state.is_weighed:
                return sized.effect.name
        return None


def reported_set(final: SearchState) -> ReportedSet:
    """The set of a search as it is reported, with its tests.

    Names are those of the likeliest members of every class, as far as the set so made passes all
    tests; else the members of the search are reported.

    Args:
        final: Result of the search; of a set that was chosen by prediction nothing is exchanged.
    """
    search = final.search
    state = replace(final, chosen=_by_worth(final))
    classes = []
    for i, sized in enumerate(state.effects):
        if sized.effect.name in final.chances:
            classes.append(ConfusionClass(sized, (), ()))
            continue
        others = search.evaluate(state.chosen.others(state.chosen.members[i]))
        found = confusion_class(state.pool, sized, others.effects, others.names)
        if not final.is_weighed and found.effect.name != sized.effect.name:
            state = _with(state, i, refined(others.effects, found.effect)[0])
        own = state.effects[i]
        named, alike = periods_alike(own, others.sized, others.effects)
        if alike is not None:
            state = _with(state, i, named)
            alike = alike.beside(state.effects[i], named)
        classes.append(replace(found.headed(state.effects[i]), alike=alike))
    names = state.chosen.names
    tests = {v.member.effect.name: v for v in search.verify(state.chosen)}
    beside = tuple(c.beside(names) for c in classes)
    return ReportedSet(state, beside, tests, odds_against_drift(state))


def _driver(effect: Effect) -> str:
    return traits(original_of(effect)).driver


def _by_worth(state: SearchState) -> EffectSubset:
    """The set in the order in which its members explain most, one after the other."""
    chosen = state.search.evaluate(())
    while left := [m for m in state.chosen.members if not any(m is k for k in chosen.members)]:
        larger = (state.search.evaluate((*chosen.members, m)) for m in left)
        chosen = max(larger, key=lambda one: one.effects.evidence)
    return chosen


def _with(state: SearchState, i: int, sized: ScaledEffect) -> SearchState:
    """The state with another effect for one of its set where all stand then, else as it was."""
    members = list(state.chosen.members)
    members[i] = state.search.placed(sized)
    other = state.search.evaluate(members)
    is_better = state.is_weighed or state.search.stands(other)
    return replace(state, chosen=other) if is_better else state


def without(state: SearchState, name: str) -> SearchState:
    """The state less one effect of its set; what it explained is left to be explained."""
    chosen = state.search.evaluate(m for m in state.chosen.members if m.effect.name != name)
    left = tuple(find_structure(chosen.effects, smooth=state.smooth))
    return replace(state, chosen=chosen, left=left)


def odds_against_drift(state: SearchState) -> dict[str, float]:
    """Log odds for every effect that follows a driver against one that was not recorded, by name.

    The most likely law of such a driver stands in its place, with any smooth course in time.
    """
    out = {}
    for member in (m for m in state.chosen.members if follows_driver(m.effect)):
        drift = likeliest_drift(state.search.evaluate(state.chosen.others(member)).effects)
        if drift is not None:
            out[member.effect.name] = state.chosen.effects.evidence - drift[1]
    return out
