"""The library of effects: register, find, parse, propose and load the effects of users.

A user's own effect is a `Kind` in a Python file (`load_user_effects`) or behind the entry point
group `material_standard.effects`; from then on it is named, proposed and diagnosed like the rest.
"""

import importlib.util
import inspect
import math
import os
import re
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np

from matstd.twin.effects import (
    MARK,
    ComponentError,
    LocationError,
    Repeated,
    artefact,
    artefact_form,
    backlash,
    coupling,
    geometric,
    gravity,
    joint_sag,
    jump,
    location,
    periodic,
    position_table,
    probe,
    servo_lag,
)
from matstd.twin.elastic import body, load_play, stiffness, tool_point
from matstd.twin.errors import BadFile, DesignError, UnknownEffect
from matstd.twin.laws import KIND as LAW
from matstd.twin.library.trial import users_fault
from matstd.twin.machine import Chain, Family, Ranges, Symbol
from matstd.twin.model import Effect, Kind, Model, Title, columns, is_tunable, own_title
from matstd.twin.record import Touches
from matstd.twin.thermal import (
    axis_warming,
    column_bending,
    follows,
    thermal_expansion,
    thermal_field,
    thermal_lag,
)
from matstd.twin.units import NM
from matstd.twin.words import listed, nearest

ENTRY_POINT_GROUP = "material_standard.effects"
SIZE_ROUNDING = 1e-3 * NM  # deviations below this are those of floating-point numbers, mm
_NAME = re.compile(r"\s*([A-Za-z][\w-]*)\s*(?:\((.*)\))?\s*\Z")
_REGISTER: dict[str, Kind] = {}
_FILES: dict[str, Path] = {}
"""The users' files that kinds come from, so that a file can be read again when it has changed."""


def register(kind: Kind) -> Kind:
    """Make a kind known by its word, which must be new; raises DesignError."""
    if _NAME.match(kind.word) is None or "(" in kind.word:
        raise DesignError(f"kind '{kind.word}': expected letters, digits and hyphens")
    known = _REGISTER.get(kind.word)
    if known is not None and known != kind:
        raise DesignError(f"kind '{kind.word}' is already in the library, expected another word")
    _REGISTER[kind.word] = kind
    return kind


def _register_from(kind: Kind, path: Path) -> Kind:
    """Register a kind of a user's file, in place of its former version; raises BadFile."""
    place = path.resolve()
    if _FILES.get(kind.word) == place:
        del _REGISTER[kind.word]
    try:
        register(kind)
    except DesignError as error:
        taken = str(_FILES.get(kind.word, "the library")) if kind.word in _REGISTER else ""
        found = f"a word that {taken} has already" if taken else "a word that is no name"
        expected = "another word" if taken else "letters, digits and hyphens"
        raise BadFile(path, f"Kind '{kind.word}'", found, expected) from error
    _FILES[kind.word] = place
    return kind


def kinds() -> tuple[Kind, ...]:
    """Every kind of the library, in the order of registration."""
    return tuple(_REGISTER.values())


def find_kinds(query: str) -> tuple[Kind, ...]:
    """Kinds that a user may mean: by word, title, synonym, formula; in the order of the library.

    Example:
        >>> [kind.word for kind in find_kinds("spindle growth")]
        ['thermal-lag']
    """
    word = query.partition("(")[0].strip()
    if word in _REGISTER:
        return (_REGISTER[word],)
    return tuple(kind for kind in kinds() if kind.matches(query))


def title_of(effect: Effect) -> Title:
    """Title of an effect; else that of its kind, else its name."""
    own = own_title(effect)
    if own is not None:
        return own
    kind = _REGISTER.get(effect.kind)
    return Title(kind.title if kind is not None and kind.title else effect.name)


def owner_of(effect: Effect) -> str:
    """What an effect belongs to, one of `Kind.OWNERS`, as its kind states, or the effect itself."""
    kind = _REGISTER.get(effect.kind)
    usual = "machine" if kind is None else kind.belongs_to
    return str(getattr(effect, "belongs_to", usual))


def parse_effect(text: str, chain: Chain) -> Effect:
    """Effect of a name such as `backlash(X)`, `thermal-lag(EZZ,bed)#2`, `probe-lobing`.

    Raises:
        UnknownEffect: No such kind, or arguments that it does not take.
        UnknownAxis, UnknownSymbol: An axis or error parameter that the machine does not have.
    """
    whole, mark, number = text.strip().rpartition(MARK)
    if mark:
        return _parse_repeated(whole, number, text, chain)
    match = _NAME.match(text)
    kind = _REGISTER.get(match.group(1)) if match else None
    if match is None or kind is None:
        raise _unknown(text, chain)
    inside = match.group(2)
    arguments = [a.strip() for a in inside.split(",")] if inside and inside.strip() else []
    return kind.make(chain, arguments)


def _parse_repeated(whole: str, number: str, text: str, chain: Chain) -> Effect:
    """Effect of a name that ends in #2; raises UnknownEffect."""
    effect = parse_effect(whole, chain)
    if not number.isdecimal() or int(number) < 2:
        raise UnknownEffect(f"effect '{text}': expected a number from 2 after {MARK}")
    if not is_tunable(effect) or not effect.tuning:
        raise UnknownEffect(
            f"effect '{text}': {effect.kind} has no inner parameter, so a second one is the first"
        )
    return Repeated(effect, int(number))


def _unknown(text: str, chain: Chain) -> UnknownEffect:
    """The exception for an unknown name, with suggestions."""
    word, bracket, inside = (part.strip() for part in text.partition("("))
    near = nearest(word.replace("_", "-"), _REGISTER)
    written = [f"{k.word}({word})" for k in kinds() if _is_taken(k, chain, word)]
    meant = ""
    if word in _REGISTER:
        meant = ", whose bracket does not end"
    elif written:
        meant = f", an error parameter; did you mean {listed(written, 'or')}?"
    elif near:
        meant = f"; did you mean {near}{bracket}{inside}?"
    available = ", ".join(k.word for k in kinds())
    return UnknownEffect(
        f"unknown effect '{text}'{meant}; available: {available} (matstd effects describes them)"
    )


def _is_taken(kind: Kind, chain: Chain, symbol: str) -> bool:
    """Whether a kind acts on an error parameter of the machine."""
    if not kind.arguments.startswith("symbol"):
        return False
    try:
        kind.make(chain, [symbol])
    except DesignError:
        return False
    return True


def proposals(touches: Touches, only: Sequence[str] | None = None) -> list[Effect]:
    """Every effect of the library, or of some of its words, that makes sense for a whole run.

    One that moves nothing at these touches, such as the roll of a spindle ram about the axis on
    which the ball hangs, is left out.
    """
    wanted = [k for k in kinds() if only is None or k.word in only]
    by_name = {effect.name: effect for kind in wanted for effect in kind.propose(touches)}
    return [effect for effect in by_name.values() if is_visible(effect, touches)]


def is_visible(effect: Effect, touches: Touches) -> bool:
    """Whether an effect of its expected size changes any deviation beyond rounding."""
    if is_tunable(effect):
        effect = effect.tuned(
            *(inner.grid[len(inner.grid) // 2] for inner in effect.inner(touches))
        )
    sd = np.array([p.sd for p in effect.parameters])
    return bool(np.any(np.abs(columns([effect], touches) * sd) > SIZE_ROUNDING))


def load_user_effects(path: Path) -> tuple[Kind, ...]:
    """Register every `Kind` at the top level of a user's Python file, which is run: trust it first.

    Raises:
        BadFile: It is no Python file, fails when run, or has no `Kind` in it.
    """
    spec = importlib.util.spec_from_file_location(f"matstd_user_{path.stem}", path)
    if spec is None or spec.loader is None or not os.path.isfile(path):
        found = "nothing that Python can load" if os.path.isfile(path) else "no such file"
        raise BadFile(path, "file", found, "a .py file with a Kind in it")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where data classes look for the types of their fields
    try:
        spec.loader.exec_module(module)
    except SyntaxError as cause:
        line = cause.lineno or "file"
        found = f"{(cause.text or '').strip()!r} ({cause.msg})" if cause.text else cause.msg
        expected = "Python saved as UTF-8" if "codec" in cause.msg else "Python"
        found = "a byte that is no UTF-8" if "codec" in cause.msg else found
        raise BadFile(path, line, found, expected) from cause
    except (Exception, SystemExit) as cause:  # whatever is wrong is one line about that file
        expected = "a Python file that runs"
        if isinstance(cause, ModuleNotFoundError) and str(cause.name).startswith("twin"):
            expected = f"the name that is installed, matstd.{cause.name}"
        raise users_fault(cause, path, "file", expected) from cause
    finally:
        del sys.modules[spec.name]
    own = {id(k): k for k in vars(module).values() if isinstance(k, Kind)}
    if not own:
        raise BadFile(path, "file", "no Kind", "at least one twin.Kind at its top level")
    for kind in own.values():
        _check_card(kind, path)
    return tuple(_register_from(kind, path) for kind in own.values())


def _check_card(kind: Kind, path: Path) -> None:
    """What a user wrote into a `Kind` is text, or can be called, where it has to be."""
    card = ("formula", "units", "typical", "source", "about", "title", "synonyms")
    for name in ("word", "arguments", *card):
        if not isinstance(getattr(kind, name), str):
            raise BadFile(path, f"Kind '{kind.word}'", f"{name} = {getattr(kind, name)!r}", "text")
    if kind.belongs_to not in Kind.OWNERS:
        expected = listed([repr(word) for word in Kind.OWNERS], "or")
        raise BadFile(path, f"Kind '{kind.word}'", f"belongs_to = {kind.belongs_to!r}", expected)
    for name in ("make", "propose"):
        if not callable(getattr(kind, name)):
            raise BadFile(path, f"Kind '{kind.word}'", f"{name} of no function", "a function")


def users_files() -> dict[str, Path]:
    """The users' files, loaded or installed, by the word of each kind that comes from them."""
    return dict(_FILES)


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
        if found not in _REGISTER.values():
            _FILES[register(found).word] = _source(found)
        loaded.append(found)
    return tuple(loaded)


def _source(kind: Kind) -> Path:
    """The file that the effects of an installed kind are made in."""
    maker = kind.classes[0] if kind.classes else kind.make
    return Path(inspect.getsourcefile(maker) or "").resolve()


for _kind in (
    geometric.KIND,
    location.KIND,
    coupling.KIND,
    backlash.KIND,
    periodic.KIND,
    jump.KIND,
    position_table.KIND,
    thermal_expansion.KIND,
    axis_warming.KIND,
    thermal_lag.KIND,
    follows.STATIC,
    thermal_field.KIND,
    follows.FOLLOWS,
    column_bending.KIND,
    gravity.KIND,
    joint_sag.KIND,
    servo_lag.KIND,
    stiffness.KIND,
    load_play.KIND,
    body.KIND,
    tool_point.KIND,
    probe.LOBING,
    probe.RADIUS,
    probe.BENDING,
    artefact.EXPANSION,
    artefact.SLIP,
    artefact_form.KIND,
    artefact.DRIFT,
    LAW,
):
    register(_kind)


def component_errors(chain: Chain, symbol: Symbol, sd: float) -> list[Effect]:
    """One component error in the ordinary distributions.

    On a linear axis linear and parabolic over its range, and sinusoidal with free phase (sine and
    cosine, one period over the range); on a rotary axis, whose errors repeat every turn, harmonic 1
    with free phase. A spindle that is not programmed stays at one angle, where an error can only be
    constant.
    """
    link = chain.link(symbol.link)
    if not link.programmed:
        return [ComponentError(symbol, "constant", sd=sd)]
    waves: list[Effect] = [
        ComponentError(symbol, "sinusoidal", sd=sd),
        ComponentError(symbol, "sinusoidal", phase=math.pi / 2.0, sd=sd),
    ]
    if link.kind == "rotary":
        return waves
    return [
        ComponentError(symbol, "linear", sd=sd),
        ComponentError(symbol, "parabolic", sd=sd),
        *waves,
    ]


def ordinary_model(chain: Chain) -> Model:
    """Every component error in its ordinary distributions and every location error.

    Set-ups of the standard are not in it: they belong to a run (`diagnosis`). The prior standard
    deviations are those of amplitudes drawn from the default ranges with random sign.
    """
    effects: list[Effect] = []
    for symbol in chain.symbols:
        sd = Ranges().sd(chain, symbol)
        if symbol.family is Family.COMPONENT:
            effects += component_errors(chain, symbol, sd)
        else:
            effects.append(LocationError(symbol, sd))
    return Model(chain, tuple(effects))
