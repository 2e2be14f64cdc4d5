"""A first try of effects that users wrote: every fault is one line about their file.

An effect is tried at the touches of a run before anything else is computed with it: what it is
called, what it depends on, what its formula returns at the first, the middle and the last value of
its inner parameters.
"""

import traceback
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from twin.errors import BadFile, DesignError
from twin.model import Effect, Inner, Kind, Parameter, Term, Tunable, Where
from twin.record import Touches

_PARTS = {"twist": 6, "place": 6, "shift": 3, "bias": 1}
"""Parts of a contribution with the number of their components."""

_HAS = ("name", "kind", "parameters", "terms")


def try_kind(kind: Kind, touches: Touches, path: str | Path) -> None:
    """Try everything that a user's kind proposes for some touches.

    Args:
        kind: The kind.
        touches: Of the run.
        path: The user's file.

    Raises:
        BadFile: File, effect, what it does, what was expected.
    """
    try:
        proposed = list(kind.propose(touches))
    except Exception as cause:
        raise users_fault(cause, path, f"propose of '{kind.word}'", "effects in a list") from cause
    for effect in proposed:
        try_effect(effect, touches, path)
        name = effect.name.partition("(")[0]
        if name != kind.word:
            expected = f"a name that begins with the word of its Kind: '{kind.word}'"
            raise BadFile(path, type(effect).__name__, f"the name '{effect.name}'", expected)


def try_effect(effect: Effect, touches: Touches, path: str | Path) -> None:
    """Try one effect of a user at some touches.

    Raises:
        BadFile: File, effect, what it does, what was expected.
    """
    cls = type(effect).__name__
    for attribute in _HAS:
        if not hasattr(effect, attribute):
            raise BadFile(path, cls, f"no {attribute}", f"{', '.join(_HAS)}, as every effect has")
    if not isinstance(effect.name, str) or not isinstance(effect.kind, str):
        raise BadFile(path, cls, f"the name {effect.name!r}", "name and kind as text")
    _try_parameters(effect, path)
    if not isinstance(effect, Tunable):
        _try_terms(effect, touches, path)
        return
    try:
        grids = list(effect.inner(touches))
        _try_grids(effect, grids, path)
        tuned = [effect.tuned(*(g.grid[k] for g in grids)) for k in (0, -1)]
        tuned.append(effect.tuned(*(g.grid[len(g.grid) // 2] for g in grids)))
    except DesignError:
        raise
    except Exception as cause:
        expected = "an effect for every value of its inner parameters"
        raise users_fault(cause, path, effect.name, expected) from cause
    for one in tuned:
        _try_terms(one, touches, path)


def _try_parameters(effect: Effect, path: str | Path) -> None:
    """Parameters are there, named, and expected to be of some size."""
    found = effect.parameters
    if not isinstance(found, Sequence) or not all(isinstance(p, Parameter) for p in found):
        expected = "a tuple of Parameter(name, unit, sd); of one: (Parameter(...),)"
        raise BadFile(path, f"{effect.name}.parameters", type(found).__name__, expected)
    if not found:
        raise BadFile(path, f"{effect.name}.parameters", "none", "at least one to be fitted")
    for parameter in found:
        where = f"{effect.name}.parameters, {parameter.name}"
        if not (np.isfinite(parameter.sd) and parameter.sd > 0.0):
            raise BadFile(path, where, f"sd = {parameter.sd:g}", "the size it may have, above zero")
        head = parameter.unit.partition("/")[0]
        if head not in ("mm", "rad", "1", ""):
            expected = "a base unit: mm or rad, over K, s, N ... where it is per something, or 1"
            raise BadFile(path, where, f"the unit '{parameter.unit}'", expected)


def _try_grids(effect: Tunable, grids: Sequence[Inner], path: str | Path) -> None:
    """Inner parameters have the names of the tuning, and grids that ascend."""
    names = [grid.name for grid in grids]
    if names != list(effect.tuning):
        found = f"inner parameters {', '.join(names)}"
        raise BadFile(path, effect.name, found, f"those of tuning: {', '.join(effect.tuning)}")
    for inner in grids:
        grid = np.asarray(inner.grid, dtype=float)
        if (
            grid.ndim != 1
            or not len(grid)
            or not np.isfinite(grid).all()
            or np.any(np.diff(grid) <= 0)
        ):
            where = f"{effect.name}, grid of {inner.name}"
            raise BadFile(path, where, f"{inner.grid}", "finite numbers that ascend")


def _try_terms(effect: Effect, touches: Touches, path: str | Path) -> None:
    """The formula gives a finite number for every touch, at a place that there is."""
    try:
        with np.errstate(all="ignore"):
            terms: object = effect.terms(touches)
    except Exception as cause:
        raise users_fault(cause, path, effect.name, "an amount for every touch") from cause
    if not isinstance(terms, Iterable) or isinstance(terms, np.ndarray | Term):
        found = f"{type(terms).__name__} from terms"
        raise BadFile(path, effect.name, found, "a tuple of Term; of one: (Term(...),)")
    for term in terms:
        if not isinstance(term, Term) or not isinstance(term.where, Where):
            expected = "Term(parameter, Where(...), amount)"
            raise BadFile(path, effect.name, f"{type(term).__name__} in terms", expected)
        _try_place(effect, term, touches, path)
        _try_amount(effect, term, touches, path)


def _try_place(effect: Effect, term: Term, touches: Touches, path: str | Path) -> None:
    """Parameter, part, link and component of a term exist."""
    count, links = len(effect.parameters), len(touches.chain.links)
    part, link, component = term.where
    if term.parameter not in range(count):
        found = f"a term of parameter {term.parameter}"
        raise BadFile(path, effect.name, found, f"0 to {count - 1}, for it has {count}")
    if part not in _PARTS:
        raise BadFile(path, effect.name, f"Where('{part}', ...)", f"one of {', '.join(_PARTS)}")
    if link not in range(links):
        expected = f"0 to {links - 1}: touches.chain.link_index(axis)"
        raise BadFile(path, effect.name, f"link {link}", expected)
    if component not in range(_PARTS[part]):
        expected = f"0 to {_PARTS[part] - 1}, in the order X Y Z A B C"
        raise BadFile(path, effect.name, f"component {component} of '{part}'", expected)


def _try_amount(effect: Effect, term: Term, touches: Touches, path: str | Path) -> None:
    """The amount is one finite number a touch."""
    n = len(touches)
    shape = np.shape(term.amount)
    if shape not in ((n,), ()):
        raise BadFile(path, effect.name, f"an amount of shape {shape}", f"({n},), one a touch")
    bad = np.flatnonzero(~np.isfinite(np.broadcast_to(term.amount, n)))
    if len(bad):
        found = f"no finite amount at {len(bad)} of {n} touches"
        raise BadFile(path, effect.name, found, "a number at every touch")


def users_fault(cause: BaseException, path: str | Path, where: str, expected: str) -> BadFile:
    """A failure of a user's code as one line, with the line of his file where there is one."""
    lines = users_lines(cause, path)
    place = f"line {lines[-1]}" if lines else where
    found = str(cause) if isinstance(cause, DesignError) else f"{type(cause).__name__}: {cause}"
    return BadFile(path, place, found.splitlines()[0], expected)


def users_lines(cause: BaseException, path: str | Path) -> list[int]:
    """Lines of a user's file through which a failure passed, outermost first."""
    own = Path(path).resolve()
    frames = traceback.extract_tb(cause.__traceback__)
    return [f.lineno for f in frames if f.lineno and Path(f.filename).resolve() == own]
