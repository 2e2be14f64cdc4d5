"""Traits of an effect beyond its terms, with their defaults.

Above the twin nothing depends on the class of an effect, only on its traits. An effect states a
trait by an attribute or property of the same name; otherwise the default here holds.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache
from numbers import Integral, Real
from typing import Any, NamedTuple

from matstd.twin.frames import Array
from matstd.twin.machine import Family, Symbol
from matstd.twin.model.effect import Effect
from matstd.twin.record import Touches


class Wave(NamedTuple):
    """What repeats over a linear axis."""

    symbol: Symbol  # the component error that repeats
    period: float  # in which it repeats, mm
    sines: int  # sines of this period and of its whole fractions: 1 for a single one


@dataclass(frozen=True, kw_only=True, slots=True)
class Traits:
    """Traits of one effect."""

    symbol: Symbol | None = None  # the error parameter that it acts on, where it acts on one alone
    axis: str = ""  # name of its axis, where it has no symbol
    # whether it is one distribution of an error parameter, as the ordinary model has them
    # (`ordinary_model`)
    is_ordinary: bool = False
    # for an ordinary component error: constant, linear, parabolic, sinusoidal
    distribution: str = ""
    # whether it is a part of a component error: a function of the reading of that axis alone
    is_of_reading: bool = False
    # whether its parameters are coefficients of one curve over a reading, which is reported from
    # peak to valley
    is_curve: bool = False
    # for a curve, whether it is reported as the effect alone explains it, without what the rest of
    # the model could take over
    is_reported_whole: bool = False
    # whether its parameters have no common size: reported is the rms that it explains
    is_tensor: bool = False
    # whether every parameter is a quantity of its own, without a common size
    is_by_parameter: bool = False
    # for an effect that outlasts the run: what is reported in place of its final values, as names
    # of changes, each with two touches, before and after
    changes: Callable[[Touches], Sequence[tuple[str, Touches]]] | None = None
    # whether its parameters share a prior whose size the run chooses; reported as a tensor, and
    # weighed against single effects by what it predicts
    is_shrunk: bool = False
    # whether it could imitate most other effects; it is chosen only where it predicts clearly
    # better than effects with a cause
    is_table: bool = False
    # whether it is what another effect may do beyond the domain from which it was learnt
    is_margin: bool = False
    # for a curve by direction: forward minus backward at every touch, per unit of every parameter,
    # (N, P)
    reversal: Callable[[Touches], Array] | None = None
    # waves a turn of what repeats over a rotary axis; 0 of a curve, which has many
    harmonic: float | None = None
    wave: Wave | None = None  # what repeats over a linear axis
    # for a wave: the same error with another period and number of sines
    with_sines: Callable[[float, int], Effect] | None = None
    # of an effect that follows a record: the sensor, `spindle_rpm` or own column; a field `sensor`
    # states it
    driver: str = ""
    # for an effect with several drives: the drive of every parameter
    parameter_drives: tuple[str, ...] = ()
    needs_history: bool = False  # whether it depends on what drove it before the first touch
    stated_number: str = ""  # number of a run that is wrong where this effect acts: `radius`
    # the effect that this one repeats, or whose change it is. All other traits are then asked of
    # the original
    original: Effect | None = None
    # 2 for the second of two effects that differ in their inner parameters alone
    repetition: int = 1
    # for a change: number of the first run that shows it, as in `Touches.run`
    since_run: int | None = None

    @property
    def ordinary_component(self) -> Symbol | None:
        """The symbol of an ordinary component error; None of anything else."""
        own = self.symbol if self.is_ordinary else None
        return own if own is not None and own.family is Family.COMPONENT else None

    @property
    def ordinary_constant(self) -> Symbol | None:
        """The symbol of a location error or an error of set-up; None of anything else."""
        own = self.symbol if self.is_ordinary else None
        return own if own is not None and own.family is not Family.COMPONENT else None


_TYPES: dict[str, Any] = {one.name: type(one.default) for one in fields(Traits)} | {
    "symbol": Symbol,
    "reversal": Callable,
    "changes": Callable,
    "harmonic": Real,
    "wave": Wave,
    "with_sines": Callable,
    "original": object,
    "since_run": Integral,
}
_OTHER_NAMES = {"is_reported_whole": "is_told_whole", "driver": "sensor"}
"""Names by which effects state a trait, too: an old one, and a field that is its driver."""


_NAMES = frozenset(_TYPES) | frozenset(_OTHER_NAMES.values())


def traits(effect: Effect) -> Traits:
    """The traits of an effect, with defaults where it states none.

    A field of a user's effect may have the name of a trait by chance, so values of another type are
    ignored: `wave: float` is not a `Wave`.
    """
    # asked of a hundred thousand effects in a search, most of which have two or three traits
    stated = _of_class(type(effect)) | (_NAMES & getattr(effect, "__dict__", {}).keys())
    found = {name: getattr(effect, name, None) for name in stated}
    for name, other in _OTHER_NAMES.items():
        if other in found and found.get(name) is None:
            found[name] = found[other]
    answers = {n: v for n, v in found.items() if n in _TYPES and isinstance(v, _TYPES[n])}
    return Traits(**answers)


@cache
def _of_class(kind: type) -> frozenset[str]:
    """Names of traits that all effects of a class have; all of one that makes attributes up."""
    return frozenset(n for n in _NAMES if hasattr(kind, n) or hasattr(kind, "__getattr__"))


def original_of(effect: Effect) -> Effect:
    """The effect that another repeats or changes; any other effect itself."""
    return traits(effect).original or effect
