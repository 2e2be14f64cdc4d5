"""Effects with their sizes as a user writes them: `thermal-lag(EZZ)=25um,tau=18min`."""

import re
from collections.abc import Mapping
from math import pi
from typing import NamedTuple

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.library.catalogue import parse_effect, users_files
from matstd.twin.library.trial import try_effect
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, is_tunable
from matstd.twin.record import Touches, at_poses
from matstd.twin.units import DAY, DEG, HOUR, MINUTE, NM, UM, URAD
from matstd.twin.words import listed

_SIZE = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)\Z")
_BASES = ("mm", "s", "K", "N")
_UNITS: Mapping[str, tuple[float, str]] = {
    "nm": (NM, "mm"),
    "um": (UM, "mm"),
    "µm": (UM, "mm"),
    "μm": (UM, "mm"),
    "mm": (1.0, "mm"),
    "m": (1e3, "mm"),
    "urad": (URAD, ""),
    "µrad": (URAD, ""),
    "μrad": (URAD, ""),
    "mrad": (1e-3, ""),
    "rad": (1.0, ""),
    "arcsec": (pi / 648000.0, ""),
    "deg": (DEG, ""),
    "ppm": (1e-6, ""),
    "s": (1.0, "s"),
    "min": (MINUTE, "s"),
    "h": (HOUR, "s"),
    "d": (DAY, "s"),
    "K": (1.0, "K"),
    "N": (1.0, "N"),
    "1": (1.0, ""),
}
"""Factor to the base unit and that unit; an angle is a number, as um/m is an angle."""

_TRIAL_POSES = 24
"""Poses and minutes at which an effect is asked for the units of its inner parameters."""


class SizedEffect(NamedTuple):
    """An effect and how large it is."""

    effect: Effect  # with its inner parameters
    theta: Array  # its parameters, (P,), base units


def parse_sized_effect(text: str, chain: Chain) -> SizedEffect:
    """Effect and sizes from `EFFECT=SIZE[,NAME=SIZE ...]`, every size with its unit.

    A size without a name belongs to the effect's only parameter; inner parameters, such as a time
    constant, go by name and must be given. Parameters that are not named are zero.

    Args:
        text: Such as `backlash(X)=3um`, `probe-lobing=2um,lobes=3`, `drift=X=2um/h,Z=-1um/h`.

    Raises:
        UnknownEffect, UnknownAxis, UnknownSymbol: A name that means nothing here.
        DesignError: A size that is missing, has another unit, or belongs to nothing.
    """
    name, equals, rest = text.partition("=")
    effect = parse_effect(name, chain)
    touches = _trial_touches(chain)
    if effect.kind in users_files():
        try_effect(effect, touches, users_files()[effect.kind])
    units = {p.name: p.unit for p in effect.parameters}
    inner = effect.inner(touches) if is_tunable(effect) else ()
    inner_units = {i.name: i.unit for i in inner}
    # a size without a name is clear only where the effect has one parameter
    only = next(iter(units)) if len(units) == 1 else None
    sizes = parse_sizes(text, rest, {**units, **inner_units}, only) if equals else {}
    if not set(sizes) & set(units) or not set(inner_units) <= set(sizes):
        first, unit = next(iter(units.items()))
        examples = [("" if len(units) == 1 else f"{first}=") + _example(unit)]
        examples += [
            f"{key}={'35mm' if unit == 'mm' else _example(unit)}"
            for key, unit in inner_units.items()
        ]
        what = "incomplete" if sizes else "no size"
        example = f"{name.strip()}={','.join(examples)}"
        raise DesignError(f"{text}: {what}, expected for example {example}")
    if is_tunable(effect):
        effect = effect.tuned(*(sizes[key] for key in inner_units))
    return SizedEffect(effect, np.array([sizes.get(key, 0.0) for key in units]))


def _trial_touches(chain: Chain) -> Touches:
    """Poses spread over the travels, a minute apart."""
    low, high = chain.travels.T
    share = np.linspace(0.0, 1.0, _TRIAL_POSES)[:, None]
    touches = at_poses(chain, low + share * (high - low), 100.0)
    touches.time[:] = MINUTE * np.arange(_TRIAL_POSES)
    return touches


def parse_sizes(
    text: str, sizes: str, units: Mapping[str, str], only: str | None = None
) -> dict[str, float]:
    """Values in base units of `NAME=SIZE,NAME=SIZE`.

    Args:
        text: What the user wrote, for messages.
        sizes: The part of it to be read.
        units: Base unit of every name that may stand there.
        only: The name that may be left out.

    Raises:
        DesignError: A name that is unknown, missing or given twice, a size in another unit.
    """
    found: dict[str, float] = {}
    for part in sizes.split(","):
        name, has_name, size = (word.strip() for word in part.partition("="))
        if not has_name:
            name, size = only or "", name
        if name not in units or name in found:
            known = listed(list(units), "or")
            what = f"'{name}' given twice" if name in found else f"no parameter '{name}'"
            what = what if name else "a size without a name"
            raise DesignError(f"{text}: {what}, expected NAME=SIZE, each of {known} once at most")
        found[name] = _in_base_units(text, size, units[name])
    return found


def _in_base_units(text: str, size: str, unit: str) -> float:
    match = _SIZE.match(size)
    expected = f"a number with its unit, such as {_example(unit)}"
    if match is None:
        raise DesignError(f"{text}: '{size}', expected {expected}")
    measure = _measure(match[2].strip() or "1")
    wanted = _measure(unit)
    assert wanted is not None, unit
    if measure is None or measure[1] != wanted[1] or (not match[2].strip() and unit != "1"):
        raise DesignError(f"{text}: '{size}', expected {expected}")
    value = float(match[1]) * measure[0] / wanted[0]
    if not abs(value) < 1e9:
        raise DesignError(f"{text}: '{size}', expected a size within reason")
    return value


def _example(unit: str) -> str:
    """A size in a unit that a user would take."""
    head, slash, tail = unit.partition("/")
    small = {"mm": "5um", "rad": "20urad", "s": "18min", "1": "3"}.get(head, f"5{head}")
    return "11.5um/(m K)" if unit == "1/K" else small + slash + tail


def _measure(unit: str) -> tuple[float, tuple[int, ...]] | None:
    """Factor to base units and powers of mm, s, K, N of a unit such as `um/(m K)`."""
    above, _, below = unit.partition("/")
    factor, powers = 1.0, [0] * len(_BASES)
    for words, sign in ((above, 1), (below.strip().removeprefix("(").removesuffix(")"), -1)):
        for word in words.split():
            if word not in _UNITS:
                return None
            scale, base = _UNITS[word]
            factor *= scale**sign
            if base:
                powers[_BASES.index(base)] += sign
    return factor, tuple(powers)
