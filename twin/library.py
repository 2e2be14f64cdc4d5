"""The library of effects by name: what can be added to a model, proposed, and written by a user.

A user's own effect is a `Kind` in a Python file (`load_user_effects`) or behind the entry point
group `material_standard.effects`; from then on it is named, proposed and diagnosed like the rest.
"""

import importlib.util
import re
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np

from twin.chain import Chain
from twin.effect import Effect, Tunable
from twin.effects import (
    artefact,
    artefact_form,
    backlash,
    column_bending,
    coupling,
    geometric,
    gravity,
    location,
    periodic,
    probe,
    stiffness,
    thermal_expansion,
    thermal_lag,
)
from twin.effects.kind import Kind
from twin.errors import BadFile, DesignError, UnknownEffect
from twin.model import columns
from twin.touches import Touches
from twin.units import NM

__all__ = [
    "ENTRY_POINT_GROUP",
    "Kind",
    "kinds",
    "load_installed_effects",
    "load_user_effects",
    "parse_effect",
    "proposals",
    "register",
]

ENTRY_POINT_GROUP = "material_standard.effects"

ROUNDING = 1e-3 * NM
"""Deviations below this are those of floating-point numbers, mm."""

_NAME = re.compile(r"\s*([A-Za-z][\w-]*)\s*(?:\((.*)\))?\s*\Z")

_REGISTER: dict[str, Kind] = {}


def register(kind: Kind) -> Kind:
    """Make a kind known by its word, which must be new.

    Raises:
        DesignError: The word is taken by another kind, or is no word.
    """
    if _NAME.match(kind.word) is None or "(" in kind.word:
        raise DesignError(f"kind '{kind.word}': expected letters, digits and hyphens")
    known = _REGISTER.get(kind.word)
    if known is not None and known != kind:
        raise DesignError(f"kind '{kind.word}' is already in the library, expected another word")
    _REGISTER[kind.word] = kind
    return kind


def kinds() -> tuple[Kind, ...]:
    """Every kind of the library, in the order of registration."""
    return tuple(_REGISTER.values())


def parse_effect(text: str, chain: Chain) -> Effect:
    """Effect of a name such as `backlash(X)`, `thermal-lag(EZZ,spindle_rpm)`, `probe-lobing`.

    Raises:
        UnknownEffect: No such kind, or arguments that it does not take.
        UnknownAxis, UnknownSymbol: An axis or error parameter that the machine does not have.
    """
    match = _NAME.match(text)
    kind = _REGISTER.get(match.group(1)) if match else None
    if match is None or kind is None:
        available = ", ".join(k.usage for k in kinds())
        raise UnknownEffect(f"unknown effect '{text}'; available: {available}")
    inside = match.group(2)
    arguments = [a.strip() for a in inside.split(",")] if inside and inside.strip() else []
    return kind.make(chain, arguments)


def proposals(touches: Touches, only: Sequence[str] | None = None) -> list[Effect]:
    """Every effect of the library that makes sense for some touches, each name once.

    One that moves nothing at these touches, such as the roll of a spindle ram about the axis on
    which the ball hangs, is left out.

    Args:
        touches: The touches, all of the run.
        only: Words of the kinds to propose; None for all.
    """
    wanted = [k for k in kinds() if only is None or k.word in only]
    by_name = {effect.name: effect for kind in wanted for effect in kind.propose(touches)}
    return [effect for effect in by_name.values() if is_seen(effect, touches)]


def is_seen(effect: Effect, touches: Touches) -> bool:
    """Whether an effect of its expected size changes any deviation beyond rounding."""
    if isinstance(effect, Tunable):
        effect = effect.tuned(
            *(inner.grid[len(inner.grid) // 2] for inner in effect.inner(touches))
        )
    sd = np.array([p.sd for p in effect.parameters])
    return bool(np.any(np.abs(columns([effect], touches) * sd) > ROUNDING))


def load_user_effects(path: Path) -> tuple[Kind, ...]:
    """Register every `Kind` that stands at the top level of a user's Python file.

    Args:
        path: The file. It is run: load only what you trust.

    Raises:
        BadFile: It is no Python file, fails when run, or has no `Kind` in it.
    """
    spec = importlib.util.spec_from_file_location(f"matstd_user_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise BadFile(path, "file", "nothing that Python can load", "a .py file with a Kind in it")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as cause:  # whatever a user's file does wrong is one line about that file
        found = f"{type(cause).__name__}: {cause}"
        raise BadFile(path, "file", found, "a Python file that runs") from cause
    own = {id(k): k for k in vars(module).values() if isinstance(k, Kind)}
    if not own:
        raise BadFile(path, "file", "no Kind", "at least one twin.library.Kind at its top level")
    return tuple(register(kind) for kind in own.values())


def load_installed_effects() -> tuple[Kind, ...]:
    """Register the kinds that installed packages offer under `material_standard.effects`.

    Raises:
        DesignError: An entry point that cannot be loaded or is no `Kind`.
    """
    loaded = []
    for point in entry_points(group=ENTRY_POINT_GROUP):
        try:
            found = point.load()
        except Exception as cause:  # a stranger's package may fail in any way
            raise DesignError(f"entry point '{point.name}' ({point.value}): {cause}") from cause
        if not isinstance(found, Kind):
            raise DesignError(f"entry point '{point.name}' ({point.value}): expected a Kind")
        loaded.append(register(found))
    return tuple(loaded)


for _kind in (
    geometric.KIND,
    location.KIND,
    coupling.KIND,
    backlash.KIND,
    periodic.KIND,
    thermal_expansion.KIND,
    thermal_lag.KIND,
    column_bending.KIND,
    gravity.KIND,
    stiffness.KIND,
    probe.LOBING,
    probe.RADIUS,
    probe.BENDING,
    artefact.EXPANSION,
    artefact.SLIP,
    artefact_form.KIND,
    artefact.DRIFT,
):
    register(_kind)
