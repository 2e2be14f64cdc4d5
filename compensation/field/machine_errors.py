"""The errors of a machine as a model knows them, without what only the measurement had."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import compress
from typing import Literal, Protocol

import numpy as np
from scipy.linalg import block_diag

from matstd.compensation.field.state import SWITCHED_ON, State
from matstd.diagnosis.files import SavedModel, model_of
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry import Estimate
from matstd.twin.display import Displayed
from matstd.twin.errors import BadValue, UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.machine import (
    Chain,
    Contribution,
    Where,
    error_class,
    exact_tip,
    parse_symbol,
    tip,
)
from matstd.twin.model import Effect, contribution, traits
from matstd.twin.record import Touches
from matstd.twin.words import did_you_mean


class Disturbance(Protocol):
    """Whatever disturbs the axes of a machine: a model of its errors, or tables of them."""

    @property
    def chain(self) -> Chain: ...  # noqa: D102

    def contribution(self, touches: Touches) -> Contribution:
        """What it adds at every touch."""
        ...


def actual_tip(disturbance: Disturbance, touches: Touches) -> Array:
    """Where the tool point really is in the table frame, (N, 3), mm."""
    added = disturbance.contribution(touches)
    return exact_tip(disturbance.chain, touches.q, touches.target, added)


def deviation(disturbance: Disturbance, touches: Touches) -> Array:
    """Exact deviation of the tool point in the table frame, actual minus nominal, (N, 3), mm."""
    return actual_tip(disturbance, touches) - tip(disturbance.chain, touches.q, touches.target)


@dataclass(frozen=True, eq=False, repr=False)
class MachineErrors(Displayed):
    """What a model says of a machine's axes, and how well it knows it.

    Set-ups, probe and standard, and the constants of workpiece and tool (`EX0w`, `EX0t` ...) belong
    to the measurement: they are not in it.
    """

    chain: Chain
    effects: tuple[Effect, ...]  # the physics that moves the tool point through an axis
    theta: tuple[Array, ...]  # parameters of each effect, base units
    # root of the covariance of all parameters, effect by effect, (P, K), of a machine whose tools
    # are set against the probe that measured it
    root: Array
    # what the covariance has in addition, (P, T), where it is unknown how a tool stands in the
    # spindle against that probe: a run cannot distinguish that from the lines of rotary axes
    tool_root: Array
    state: State = SWITCHED_ON
    left_out: tuple[str, ...] = ()  # names of effects of the model that are not the machine's
    # location errors as the run of the model determines them, by symbol. A parameter shares with
    # others what the run cannot separate; this is what was reported
    determined: Mapping[str, Estimate] = field(default_factory=dict)

    @classmethod
    def of_model(cls, model: SavedModel | Fit, state: State = SWITCHED_ON) -> "MachineErrors":
        """The errors of the machine that a model file, or a fit, knows."""
        saved = model_of(model) if isinstance(model, Fit) else model
        effects, mean = saved.model.effects, saved.estimates.mean
        theta = np.split(mean, np.cumsum([len(e.parameters) for e in effects])[:-1])
        known = list(zip(effects, theta, strict=True))
        out = cls._of_machine(saved.model.chain, known, saved.estimates.root, state)
        others = (one.effect.name for one in saved.left_out)
        return replace(
            out,
            left_out=(*out.left_out, *others),
            determined={one.symbol: one.estimate for one in saved.determined},
        )

    @classmethod
    def of_errors(
        cls, chain: Chain, errors: Sequence[tuple[Effect, Array]], state: State = SWITCHED_ON
    ) -> "MachineErrors":
        """Errors that are known without uncertainty, as an error file states them."""
        count = sum(len(e.parameters) for e, _ in errors)
        return cls._of_machine(chain, errors, np.zeros((count, 0)), state)

    @classmethod
    def _of_machine(
        cls, chain: Chain, known: Sequence[tuple[Effect, Array]], root: Array, state: State
    ) -> "MachineErrors":
        at = state.touches(chain, chain.travels.mean(axis=1)[None], 0.0)
        _refuse_missing(at, [effect for effect, _ in known])
        counts = [len(theta) for _, theta in known]
        is_kept = [_is_of_machine(effect, at) for effect, _ in known]
        is_tool = [
            not kept and any(term.where.moves_tip for term in effect.terms(at))
            for (effect, _), kept in zip(known, is_kept, strict=True)
        ]
        own, tool = (root[np.repeat(rows, counts).astype(bool)] for rows in (is_kept, is_tool))
        shared = _row_space(tool)
        kept = list(compress(known, is_kept))
        return cls(
            chain=chain,
            effects=tuple(effect for effect, _ in kept),
            theta=tuple(theta for _, theta in kept),
            root=own - own @ shared @ shared.T,
            tool_root=own @ shared,
            state=state,
            left_out=tuple(e.name for (e, _), own in zip(known, is_kept, strict=True) if not own),
        )

    def with_known(
        self, errors: Sequence[tuple[Effect, Array]], root: Array | None = None
    ) -> "MachineErrors":
        """These errors and further ones, known independently.

        Args:
            root: Root of their covariance, (P', K'); None without uncertainty.
        """
        count = sum(len(e.parameters) for e, _ in errors)
        own = np.zeros((count, 0)) if root is None else root
        return replace(
            self,
            effects=(*self.effects, *(e for e, _ in errors)),
            theta=(*self.theta, *(t for _, t in errors)),
            root=block_diag(self.root, own),
            tool_root=np.vstack([self.tool_root, np.zeros((count, self.tool_root.shape[1]))]),
        )

    def widened(self, number: int, effect: Effect, theta: Array, root: Array) -> "MachineErrors":
        """These errors with further parameters appended to those of one effect.

        Args:
            theta: Values of the further parameters, (p,).
            root: Root of their covariance, (p, K'), independent of all others.
        """
        end = sum(len(t) for t in self.theta[: number + 1])
        before, behind = self.root[:end], self.root[end:]
        wide = np.vstack([block_diag(before, root), np.pad(behind, ((0, 0), (0, root.shape[1])))])
        effects, values = list(self.effects), list(self.theta)
        effects[number], values[number] = effect, np.append(values[number], theta)
        return replace(
            self,
            effects=tuple(effects),
            theta=tuple(values),
            root=wide,
            tool_root=np.insert(self.tool_root, [end] * len(theta), 0.0, axis=0),
        )

    def touches(
        self,
        q: Array,
        length: Array | float,
        approach: Array | None = None,
        elapsed: Array | None = None,
    ) -> Touches:
        """Poses in the state of these errors; arguments as of `State.touches`."""
        return self.state.touches(self.chain, q, length, approach, elapsed)

    def contribution(self, touches: Touches) -> Contribution:
        """What the errors add at every touch; nothing of set-up, standard and probe."""
        pairs = [(e, t) for e, t in zip(self.effects, self.theta, strict=True) if t.any()]
        total = contribution(pairs, touches)
        for i, link in enumerate(self.chain.links):
            if link.kind == "fixed":
                total.twist[:, i], total.place[:, i] = 0.0, 0.0
        total.shift[:], total.bias[:] = 0.0, 0.0
        return total

    def columns(self, touches: Touches, links: Collection[int] | None = None) -> Array:
        """Deviation of the tool point per unit of every parameter, first order, (N, 3, P).

        Args:
            links: Those that count; None for all.
        """
        out = np.zeros((len(touches), 3, len(self.root)))
        for row, where, amount in self._entries(touches):
            if links is None or where.link in links:
                out[:, :, row] += amount[:, None] * touches.reach.of(where)
        return out

    def amounts(
        self, touches: Touches, part: Literal["twist", "place"], links: Collection[int]
    ) -> Array:
        """What every parameter adds to one part of a contribution per unit, (N, L, 6, P).

        Args:
            links: Those that count; nothing of the others is in it.
        """
        out = np.zeros((len(touches), len(self.chain.links), 6, len(self.root)))
        for row, where, amount in self._entries(touches):
            if where.part == part and where.link in links:
                out[:, where.link, where.component, row] += amount
        return out

    def _entries(self, touches: Touches) -> Iterator[tuple[int, Where, Array]]:
        """Every parameter's places in the chain with its amount there, (N,)."""
        start = 0
        for effect, theta in zip(self.effects, self.theta, strict=True):
            for term in effect.terms(touches):
                if _moves_axis(self.chain, term.where):
                    yield start + term.parameter, term.where, term.amount
            start += len(theta)

    @cached_property
    def groups(self) -> dict[str, tuple[int, ...]]:
        """Numbers of effects by symbol of ISO 230-1, or by effect."""
        out: dict[str, tuple[int, ...]] = {}
        for i, effect in enumerate(self.effects):
            out[group_of(effect)] = (*out.get(group_of(effect), ()), i)
        return out

    def parameter_rows(self, group: str) -> Array:
        """Places of the parameters of a group in the vector of all, (p,)."""
        counts = [len(t) for t in self.theta]
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(int)
        return np.concatenate([np.arange(starts[i], starts[i + 1]) for i in self.groups[group]])

    def words(self, group: str) -> set[str]:
        """All words that switch the errors of a group (`switched`)."""
        return {w for i in self.groups[group] for w in words_of(self.chain, self.effects[i])}

    def only(self, group: str) -> "MachineErrors":
        """The errors of one group alone."""
        chosen, rows = self.groups[group], self.parameter_rows(group)
        return replace(
            self,
            effects=tuple(self.effects[i] for i in chosen),
            theta=tuple(self.theta[i] for i in chosen),
            root=self.root[rows],
            tool_root=self.tool_root[rows],
        )

    def switched(self, factors: Mapping[str, float]) -> "MachineErrors":
        """The errors scaled: 0 is off, 1 leaves them, 2 doubles; later words override earlier ones.

        Args:
            factors: By symbol (`EXX`), effect (`backlash(X)`), kind (`backlash`), class
                (`squareness`, `linear_rotation` ...), axis (`X`) or `all`.

        Raises:
            BadValue: A word that is none of these here, with those that are.
        """
        if not factors:
            return self
        known = {word for effect in self.effects for word in words_of(self.chain, effect)}
        for word in factors:
            if word not in known:
                listed = ", ".join(sorted(known, key=len)[:24])
                raise BadValue("switch", f"'{word}'{did_you_mean(word, known)}", f"one of {listed}")
        last_first, found = list(factors.items())[::-1], []
        for effect in self.effects:
            words = words_of(self.chain, effect)
            found.append(next((f for w, f in last_first if w in words), 1.0))
        scale = np.repeat(found, [len(own) for own in self.theta])[:, None]
        return replace(
            self,
            theta=tuple(f * own for f, own in zip(found, self.theta, strict=True)),
            root=scale * self.root,
            tool_root=scale * self.tool_root,
            determined={},
        )


def group_of(effect: Effect) -> str:
    """The name an effect is reported under: its symbol for a plain error of ISO 230-1."""
    symbol = traits(effect).symbol
    return symbol.name if symbol is not None and effect.kind in _PLAIN else effect.name


_PLAIN = ("geometric", "location")  # kinds of effects that are the errors of ISO 230-1 themselves


def words_of(chain: Chain, effect: Effect) -> set[str]:
    """All words that switch an effect."""
    words = {"all", effect.kind, effect.name, group_of(effect)}
    symbol = traits(effect).symbol or parse_symbol(group_of(effect))
    if symbol is not None:
        words |= {symbol.link, symbol.name}
        if effect.kind in _PLAIN:
            words.add(error_class(chain, symbol))
    axis = traits(effect).axis
    return words | ({axis} if axis else set())


def _row_space(rows: Array) -> Array:
    """Orthonormal basis of what some rows (t, K) span, (K, r)."""
    if not rows.size:
        return np.zeros((rows.shape[1], 0))
    _, strength, basis = np.linalg.svd(rows, full_matrices=False)
    return basis[strength > 1e-12 * strength[0]].T


def _moves_axis(chain: Chain, where: Where) -> bool:
    """Whether an entry is of an axis, not of workpiece, tool, standard or probe."""
    return where.moves_tip and chain.links[where.link].kind != "fixed"


def _refuse_missing(at: Touches, effects: Sequence[Effect]) -> None:
    """Raise UnknownEffect with everything that effects follow and the state does not have."""
    missing: list[str] = []
    for effect in effects:
        try:
            effect.terms(at)
        except UnknownEffect as error:
            missing.append(str(error))
    if missing:
        raise UnknownEffect("; ".join(dict.fromkeys(missing)))


def _is_of_machine(effect: Effect, at: Touches) -> bool:
    """Whether an effect moves an axis; errors of a rotating spindle depend on no pose."""
    symbol = traits(effect).symbol
    if symbol is not None and effect.kind in _PLAIN and not at.chain.link(symbol.link).programmed:
        return False
    return any(_moves_axis(at.chain, term.where) for term in effect.terms(at))


CorrectionFunction = Callable[[Touches], Array]
"""Readings that are added to the commanded ones, (N, A): what every compensation ends in."""
