"""Trial of effects that users wrote: every fault is reported in one line about their file.

An effect is tried at the touches of a run before anything is computed with it: its name, its
parameters, and its formula, twice, at the first, middle and last value of its inner parameters. It
gets read-only arrays. A fault that raises nothing, such as noise or zeros, is reported with the
line of its method.
"""

import traceback
from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from itertools import islice, product
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Kind, Parameter, Term, Tunable, Where, is_tunable
from matstd.twin.record import Touches

_PARTS = {"twist": 6, "place": 6, "shift": 3, "bias": 1}
"""Parts of a contribution with the number of their components."""
_HAS = ("name", "kind", "parameters", "terms")
_TUNABLE_HAS = ("inner", "tuned", "tuning")
MAX_COMBINATIONS = 512
"""Combinations of inner parameters that are tried before an effect is reported to move nothing."""


def try_kind(kind: Kind, touches: Touches, path: str | Path) -> None:
    """Try everything that a user's kind proposes for some touches; raises BadFile."""
    guarded = read_only(touches)
    try:
        proposed = list(kind.propose(guarded))
    except (Exception, SystemExit) as cause:
        raise users_fault(cause, path, f"propose of '{kind.word}'", "effects in a list") from cause
    names: set[str] = set()
    for effect in proposed:
        try_effect(effect, touches, path)
        if effect.name.partition("(")[0] != kind.word:
            expected = f"a name that begins with the word of its Kind: '{kind.word}'"
            raise _bad(effect, "name", path, f"the name '{effect.name}'", expected)
        if effect.name in names:
            raise _bad(effect, "name", path, "its name proposed twice", "another for each effect")
        names.add(effect.name)


def try_effect(effect: Effect, touches: Touches, path: str | Path) -> None:
    """Try one effect of a user at some touches; raises BadFile."""
    _try_attributes(effect, path)
    _try_parameters(effect, path)
    touches = read_only(touches)
    if not is_tunable(effect):
        if not _moves(effect, touches, path):
            raise _moves_nothing(effect, path)
        return
    try:
        grids = list(effect.inner(touches))
        _try_grids(effect, grids, path)
        values = [tuple(float(g.grid[k]) for g in grids) for k in (0, -1)]
        values.append(tuple(float(g.grid[len(g.grid) // 2]) for g in grids))
        moves = [_moves(_tuned(effect, v, path), touches, path) for v in values]
        others = islice(product(*(g.grid for g in grids)), 0 if any(moves) else MAX_COMBINATIONS)
        if not any(moves) and not any(_moves(effect.tuned(*v), touches, path) for v in others):
            raise _moves_nothing(effect, path)
    except BadFile:
        raise
    except (Exception, SystemExit) as cause:
        expected = "an effect for every value of its inner parameters"
        raise users_fault(cause, path, effect.name, expected) from cause


def read_only(touches: Touches) -> Touches:
    """The same touches, none of whose arrays can be written to."""
    arrays: dict[str, Any] = {
        f.name: _locked(value)
        for f in fields(touches)
        if isinstance(value := getattr(touches, f.name), np.ndarray)
    }
    temperature = {name: _locked(record) for name, record in touches.temperature.items()}
    guarded = replace(touches, temperature=MappingProxyType(temperature), **arrays)
    for name in ("T_table_artefact", "point_table", "normal_table", "ball_artefact"):
        getattr(guarded, name).flags.writeable = False
    for array in (*guarded.reach, *vars(guarded.signature).values()):
        array.flags.writeable = False
    return guarded


def _locked(array: Array) -> Array:
    view = array.view()
    view.flags.writeable = False
    return view


def _try_attributes(effect: Effect, path: str | Path) -> None:
    """Everything is there that an effect has, and all or nothing of what a tunable one has."""
    for attribute in _HAS:
        if not hasattr(effect, attribute):
            expected = f"{', '.join(_HAS)}, as every effect has"
            raise _bad(effect, "", path, f"no {attribute}", expected)
    if not isinstance(effect.name, str) or not isinstance(effect.kind, str):
        raise _bad(effect, "", path, f"the name {effect.name!r}", "name and kind as text")
    there = [attribute for attribute in _TUNABLE_HAS if hasattr(effect, attribute)]
    missing = [attribute for attribute in _TUNABLE_HAS if attribute not in there]
    if there and missing:
        found = f"{' and '.join(there)} without {' and '.join(missing)}"
        raise _bad(effect, there[0], path, found, "inner, tuned and tuning, or none of them")


def _try_parameters(effect: Effect, path: str | Path) -> None:
    """Parameters are there, named, and expected to be of some size."""
    found = effect.parameters
    if not isinstance(found, Sequence) or not all(isinstance(p, Parameter) for p in found):
        expected = "a tuple of Parameter(name, unit, sd); of one: (Parameter(...),)"
        raise _bad(effect, "parameters", path, type(found).__name__, expected)
    if not found:
        raise _bad(effect, "parameters", path, "none", "at least one to be fitted")
    for parameter in found:
        part = f"parameters, {parameter.name}"
        if not (np.isfinite(parameter.sd) and parameter.sd > 0.0):
            expected = "the size it may have, above zero"
            raise _bad(effect, part, path, f"sd = {parameter.sd:g}", expected)
        head = parameter.unit.partition("/")[0]
        if head not in ("mm", "rad", "1", ""):
            expected = "a base unit: mm or rad, over K, s, N ... where it is per something, or 1"
            raise _bad(effect, part, path, f"the unit '{parameter.unit}'", expected)


def _try_grids(effect: Tunable, grids: Sequence[Inner], path: str | Path) -> None:
    """Inner parameters have the names of the tuning, and grids that ascend."""
    names = [grid.name for grid in grids]
    if names != list(effect.tuning):
        found = f"inner parameters {', '.join(names)}"
        raise _bad(effect, "inner", path, found, f"those of tuning: {', '.join(effect.tuning)}")
    for inner in grids:
        grid = np.asarray(inner.grid, dtype=float)
        is_list = grid.ndim == 1 and len(grid) > 0 and bool(np.isfinite(grid).all())
        if not is_list or np.any(np.diff(grid) <= 0.0):
            where = f"inner, grid of {inner.name}"
            shown = " ".join(str(inner.grid).split())
            raise _bad(effect, where, path, shown[:80], "finite numbers that ascend")


def _tuned(effect: Tunable, values: tuple[float, ...], path: str | Path) -> Tunable:
    """The effect at some inner values, which must be those of its tuning then."""
    out = effect.tuned(*values)
    if not is_tunable(out) or out.name != effect.name:
        found = f"{type(out).__name__} '{getattr(out, 'name', '')}'"
        raise _bad(effect, "tuned", path, found, f"another '{effect.name}'")
    now = tuple(float(v) for v in out.tuning.values())
    if now != values:
        found = f"tuning {now} after tuned{values}"
        raise _bad(effect, "tuned", path, found, "the values that it was given")
    return out


def _moves(effect: Effect, touches: Touches, path: str | Path) -> bool:
    """Whether the formula gives more than zeros; it must give the same at every call."""
    first, again = (_terms(effect, touches, path) for _ in range(2))
    alike = len(first) == len(again) and all(
        a.parameter == b.parameter
        and a.where == b.where
        and np.array_equal(a.amount, b.amount, equal_nan=True)
        for a, b in zip(first, again, strict=True)
    )
    if not alike:
        expected = "the same amounts at every call: nothing random, nothing that is remembered"
        raise _bad(effect, "terms", path, "other amounts at a second call", expected)
    return any(np.any(term.amount) for term in first)


def _moves_nothing(effect: Effect, path: str | Path) -> BadFile:
    expected = "an amount at some touch; let propose offer the effect only where it acts"
    return _bad(effect, "terms", path, "zero at every touch of this run", expected)


def _terms(effect: Effect, touches: Touches, path: str | Path) -> list[Term]:
    """Terms of the formula: a finite number for every touch, at a place that there is."""
    try:
        with np.errstate(all="ignore"):
            found: object = effect.terms(touches)
        terms = list(found) if isinstance(found, Iterable) else None
    except (Exception, SystemExit) as cause:
        raise users_fault(cause, path, effect.name, "an amount for every touch") from cause
    if terms is None or isinstance(found, np.ndarray | Term):
        what = f"{type(found).__name__} from terms"
        raise _bad(effect, "terms", path, what, "a tuple of Term; of one: (Term(...),)")
    for term in terms:
        if not isinstance(term, Term) or not isinstance(term.where, Where):
            expected = "Term(parameter, Where(...), amount)"
            raise _bad(effect, "terms", path, f"{type(term).__name__} in terms", expected)
        _try_place(effect, term, touches, path)
        _try_amount(effect, term, touches, path)
    return terms


def _try_place(effect: Effect, term: Term, touches: Touches, path: str | Path) -> None:
    """Parameter, part, link and component of a term exist."""
    count, links = len(effect.parameters), len(touches.chain.links)
    part, link, component = term.where
    if not _is_index(term.parameter, count):
        found = f"a term of parameter {term.parameter}"
        raise _bad(effect, "terms", path, found, f"0 to {count - 1}, for it has {count}")
    if part not in _PARTS:
        raise _bad(effect, "terms", path, f"Where('{part}', ...)", f"one of {', '.join(_PARTS)}")
    if not _is_index(link, links):
        expected = f"0 to {links - 1}: touches.chain.link_index(axis)"
        raise _bad(effect, "terms", path, f"link {link}", expected)
    if not _is_index(component, _PARTS[part]):
        expected = f"0 to {_PARTS[part] - 1}, in the order X Y Z A B C"
        raise _bad(effect, "terms", path, f"component {component} of '{part}'", expected)


def _is_index(value: object, count: int) -> bool:
    return isinstance(value, int | np.integer) and 0 <= int(value) < count


def _try_amount(effect: Effect, term: Term, touches: Touches, path: str | Path) -> None:
    """The amount is one finite number a touch."""
    n = len(touches)
    amount = np.asarray(term.amount)
    if amount.shape != (n,):
        found = f"an amount of shape {amount.shape}"
        raise _bad(effect, "terms", path, found, f"({n},), one a touch")
    if amount.dtype.kind not in "fiub":
        raise _bad(effect, "terms", path, f"an amount of {amount.dtype}", "real numbers")
    bad = np.flatnonzero(~np.isfinite(amount))
    if len(bad):
        found = f"no finite amount at {len(bad)} of {n} touches"
        raise _bad(effect, "terms", path, found, "a number at every touch")


def _bad(effect: object, part: str, path: str | Path, found: str, expected: str) -> BadFile:
    """A fault of an effect, with the line of the user's file for that part."""
    name = getattr(effect, "name", None)
    named = name if part and isinstance(name, str) else type(effect).__name__
    attribute = part.partition(",")[0]
    line = _line(type(effect), attribute, path)
    named = f"{named}.{part}" if attribute not in ("", "terms", "name") else named
    return BadFile(path, f"line {line}, {named}" if line else named, found, expected)


def _line(cls: type, attribute: str, path: str | Path) -> int | None:
    """Line of a user's file on which a class, or a method of it, begins."""
    own = Path(path).resolve()
    named = getattr(cls, attribute, None) if attribute else None
    methods: list[Any] = [getattr(named, "fget", named), *vars(cls).values()]
    codes = [m.__code__ for m in methods if hasattr(m, "__code__")]
    lines = (code.co_firstlineno for code in codes if Path(code.co_filename).resolve() == own)
    return next(lines, None)


def users_fault(cause: BaseException, path: str | Path, where: str, expected: str) -> BadFile:
    """A failure of a user's code as one line, with the line of his file where there is one."""
    lines = users_lines(cause, path)
    place = f"line {lines[-1]}" if lines else where
    found = str(cause) if isinstance(cause, DesignError) else f"{type(cause).__name__}: {cause}"
    return BadFile(path, place, found.partition("\n")[0], expected)


def users_lines(cause: BaseException, path: str | Path) -> list[int]:
    """Lines of a user's file through which a failure passed, outermost first."""
    own = Path(path).resolve()
    frames = traceback.extract_tb(cause.__traceback__)
    return [f.lineno for f in frames if f.lineno and Path(f.filename).resolve() == own]
