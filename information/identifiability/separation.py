"""Identifiability of touches: rank, condition, gauge freedoms, confounded groups.

A gauge freedom is a direction of parameter space that changes no touch: the constants of an axis
and the set-up of the standard, the tilt of a ram and its straightness at one tool length. They come
from the null space of the rows, by `matstd.information.identifiability.nullspace`, and are checked,
one by one, against richer touches that could have been made: another stylus length, another set-up,
the whole travel.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.information.identifiability.freedoms import (
    Freedom,
    Parameters,
    Reason,
    Resolution,
    Term,
    reason,
)
from matstd.information.identifiability.nullspace import (
    MIN_SINGULAR_RATIO,
    condition,
    groups,
    rank_analysis,
    sparse,
)
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model import traits
from matstd.twin.units import UM, URAD

_MIN_RESOLVED_SHARE = 1e-6
"""Part of its length that a gauge direction must show in richer touches to be resolved."""


@dataclass(frozen=True)
class Group:
    """Parameters that are tied to one another by gauge freedoms, and to no others."""

    members: tuple[str, ...]  # names
    known: int  # number of their combinations that the touches see; the rest is gauge


@dataclass(frozen=True, eq=False)
class Identifiability:
    """Identifiability of the parameters by some touches."""

    parameters: int  # their number
    rank: int  # number of independent combinations that move any touch
    # largest over smallest visible singular value of the columns, each scaled to length one
    condition: float
    condition_prior: float  # the same with every column times its parameter's expected size
    condition_raw: float  # the same unscaled, per µm and µrad
    freedoms: tuple[Freedom, ...]  # one for every parameter beyond the rank
    groups: tuple[Group, ...]  # of parameters that are confounded with one another


def identifiability(
    W: Array,
    prior_sd: Array,
    names: Sequence[str],
    parameters: Parameters = (),
    chain: Chain | None = None,
    richer: Mapping[str, Array] | None = None,
) -> Identifiability:
    """Rank, condition, gauge freedoms and confounded groups of some touches.

    Freedoms have as few members as could be found. By convention set-up, tool and zero positions
    are named first as the member to leave out.

    Args:
        W: Whitened rows, shape (N, P).
        parameters: The same with their effects (`Model.parameters`), for units, conventions and
            reasons.
        chain: The machine, for reasons, or None.
        richer: Rows of touches that could be made instead, by what they are called, cheapest first;
            columns as those of W, and after them those of set-ups and tools of their own.
    """
    found = rank_analysis(W)
    null = found.null
    more = {name: _without_own(R, W.shape[1]) for name, R in (richer or {}).items()}
    never = rank_analysis(np.concatenate([W, *more.values()])).null if more else None
    order = sorted(range(len(names)), key=lambda p: _convention(parameters, p))
    units = [p.unit for _, p in parameters] or ["1"] * len(names)
    freedoms = []
    for lead, z in sparse(null, order, never):
        size = np.abs(z).max()
        # W is per prior standard deviation, a freedom is stated in base units
        base = -z * prior_sd / prior_sd[lead]
        by_size = np.argsort(-np.abs(z).round(9), kind="stable")  # equal ones not by their rounding
        others = [k for k in by_size.tolist() if k != lead and z[k]]
        why = reason([lead, *others], parameters, chain) if chain is not None else None
        resolution, by = _resolved_by(z / size, more, why)
        freedom = Freedom(
            parameter=names[lead],
            unit=units[lead],
            alike=tuple(Term(names[k], units[k], float(base[k])) for k in others),
            reason=why,
            resolution=resolution,
            resolved_by=by,
        )
        freedoms.append(freedom)
    per_unit = np.array([URAD if u == "rad" else UM for u in units])
    raw = W / np.where(prior_sd > 0.0, prior_sd, 1.0) * per_unit
    return Identifiability(
        parameters=W.shape[1],
        rank=found.rank,
        condition=found.condition,
        condition_prior=condition(W, found.rank),
        condition_raw=condition(raw, found.rank),
        freedoms=tuple(freedoms),
        groups=_groups(null, names),
    )


def _convention(parameters: Parameters, p: int) -> tuple[int, int]:
    """Rank of a parameter among those by which a freedom is named: low ones are left out first."""
    symbol = traits(parameters[p][0]).symbol if parameters else None
    if not isinstance(symbol, Symbol):
        is_setup = bool(parameters) and parameters[p][0].kind == "setup"
        return (-2 if is_setup else 3, -p)
    if symbol.family is Family.SETUP:
        return (-2 if symbol.link == "w" else -1, -p)
    if symbol.family is Family.LOCATION:
        return (2 - int(symbol.is_angular), -p)
    still = traits(parameters[p][0]).distribution == "constant"
    return (0 if still else 3 if symbol.is_angular else 4, -p)


def _without_own(W: Array, P: int) -> Array:
    """Columns of the first P parameters, less what set-ups and tools of their own can imitate."""
    own = W[:, P:]
    length = np.linalg.norm(own, axis=0)
    own = own[:, length > 0.0] / length[length > 0.0]
    left = W[:, :P]
    if own.shape[1]:
        U, s, _ = np.linalg.svd(own, full_matrices=False)
        U = U[:, s > MIN_SINGULAR_RATIO * s[0]]
        left = left - U @ (U.T @ left)
        left = left - U @ (U.T @ left)
    return left


def _resolved_by(
    z: Array, richer: Mapping[str, Array], why: Reason | None
) -> tuple[Resolution, str]:
    """The first of the richer touches, freed of what is their own, in which a direction shows."""
    for name, W in richer.items():
        if np.linalg.norm(W @ z) > _MIN_RESOLVED_SHARE * np.linalg.norm(W, axis=0).max():
            return Resolution.TOUCHES, name
    if not richer:
        return Resolution.UNTRIED, ""
    # tools on the line of the spindle never feel what turns about it
    return (Resolution.SIDEWAYS if why is Reason.TURNS else Resolution.NEVER), ""


def _groups(null: Array, names: Sequence[str]) -> tuple[Group, ...]:
    """Confounded groups, the largest first; parameters that move nothing are in none."""
    out = []
    for group in groups(null):
        if len(group) == 1:
            continue
        size = np.linalg.svd(null[:, group], compute_uv=False)
        known = len(group) - int(np.sum(size > 1e-9 * size[0]))
        out.append(Group(tuple(names[p] for p in group), known))
    return tuple(sorted(out, key=lambda g: -len(g.members)))
