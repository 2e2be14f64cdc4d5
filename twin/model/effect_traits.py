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
    """Traits of one effect.

    Attributes:
        symbol: The error parameter that it acts on, where it acts on one alone.
        axis: Name of its axis, where it has no symbol.
        is_ordinary: Whether it is one distribution of an error parameter, as the ordinary model
            has them (`ordinary_model`).
        distribution: For an ordinary component error: constant, linear, parabolic, sinusoidal.
        is_curve: Whether its parameters are coefficients of one curve over a reading, which is
            reported from peak to valley.
        is_reported_whole: For a curve, whether it is reported as the effect alone explains
            it, without what the rest of the model could take over.
        is_tensor: Whether its parameters have no common size: reported is the rms that it explains.
        is_by_parameter: Whether every parameter is a quantity of its own, without a common size.
        changes: For an effect that outlasts the run: what is reported in place of its final
            values, as names of changes, each with two touches, before and after.
        is_shrunk: Whether its parameters share a prior whose size the run chooses; reported as a
            tensor, and weighed against single effects by what it predicts.
        is_table: Whether it could imitate most other effects; it is chosen only where it predicts
            clearly better than effects with a cause.
        reversal: For a curve by direction: forward minus backward at every touch, per unit of
            every parameter, (N, P).
        harmonic: Waves a turn of what repeats over a rotary axis; 0 of a curve, which has many.
        wave: What repeats over a linear axis.
        with_sines: For a wave: the same error with another period and number of sines.
        driver: Of an effect that follows a record: the sensor, `spindle_rpm` or own column; a field
            `sensor` states it.
        parameter_drives: For an effect with several drives: the drive of every parameter.
        needs_history: Whether it depends on what drove it before the first touch.
        stated_number: Number of a run that is wrong where this effect acts: `radius`.
        original: The effect that this one repeats, or whose change it is. All other traits are then
            asked of the original.
        repetition: 2 for the second of two effects that differ in their inner parameters alone.
        since_run: For a change: number of the first run that shows it, as in `Touches.run`.
    """

    symbol: Symbol | None = None
    axis: str = ""
    is_ordinary: bool = False
    distribution: str = ""
    is_curve: bool = False
    is_reported_whole: bool = False
    is_tensor: bool = False
    is_by_parameter: bool = False
    changes: Callable[[Touches], Sequence[tuple[str, Touches]]] | None = None
    is_shrunk: bool = False
    is_table: bool = False
    reversal: Callable[[Touches], Array] | None = None
    harmonic: float | None = None
    wave: Wave | None = None
    with_sines: Callable[[float, int], Effect] | None = None
    driver: str = ""
    parameter_drives: tuple[str, ...] = ()
    needs_history: bool = False
    stated_number: str = ""
    original: Effect | None = None
    repetition: int = 1
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
