"""Candidates of a run: all of the library for most, a screened choice of it for a long run.

The cost of a search is touches times points of all grids. Up to `WHOLE_BELOW` touches that is paid
in full. In a long run the library is first scored against an even choice of the touches: what a
signature has in common with the residual is counted over all touches, which is one product, and
only its length after the projection, which is the work, over the choice. A shortlist names the
points of grids that may matter beside a set of effects; the search then has exact signatures of
those points alone, and a search asks for another shortlist once it knows more effects. How many
sets all searches of one diagnosis may try is limited as well.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.evidence import (
    EffectSet,
    Grid,
    Progress,
    ResidualSpace,
    ScaledEffect,
    Scores,
    Signatures,
    blocks,
    projected,
    quiet,
    ranked,
    scanned_grids,
    screen,
    signatures,
)
from matstd.diagnosis.search.missing_driver import is_unrecorded
from matstd.twin.frames import Array
from matstd.twin.model import Effect

WHOLE_BELOW = 4000
"""Up to so many touches the whole library is searched at every point of its grids; beyond, a choice
of as many touches screens it first."""

MAX_CANDIDATES = 40  # candidates that a screening lets through
MAX_POINTS = 12  # best points of a candidate's grid that it lets through


MOST_SETS = 1500.0
"""Sets of effects that all searches of one diagnosis may try. A usual run needs a hundred, an
unexplained one three hundred; long records of many related sensors need more, and a remark says so
when the limit ended the search."""

UNIT_CHARGE_SIZE = 5e7  # touches times squared columns from which a set counts for more than one

USUAL_POOL = 1.3e6
"""Touches times columns of all candidates in a usual run; a set of a small one counts for less."""

MIN_CHARGE = 0.1  # least charge of a set


@dataclass(slots=True)
class Budget:
    """Number of sets that searches may still try, shared; then they return what they have."""

    left: float = MOST_SETS  # number of sets of ordinary size

    def spend(self, touches: int, columns: int, pool: int) -> None:
        """Charge for one set, and for all columns of the pool beside it."""
        beside = min(MIN_CHARGE + float(touches) * pool / USUAL_POOL, 1.0)
        self.left -= beside + float(touches) * columns * columns / UNIT_CHARGE_SIZE

    @property
    def is_spent(self) -> bool:
        """Whether some search was ended before its end."""
        return self.left <= 0.0


Shortlist = Mapping[int, frozenset[int]]
"""Points of grids, as numbers of variants, by the number of the candidate."""


def joined_shortlists(first: Shortlist, second: Shortlist) -> Shortlist:
    """Every candidate of two shortlists at the points of either."""
    nothing: frozenset[int] = frozenset()
    return {k: first.get(k, nothing) | second.get(k, nothing) for k in {*first, *second}}


def tried(grids: Sequence[Grid]) -> int:
    """Candidates that may be named; what only competes with them costs no chance."""
    return sum(not is_unrecorded(g.effect) for g in grids)


@dataclass(frozen=True, eq=False)
class Library:
    """Candidate effects with what is needed to search among them in one run."""

    complement: ResidualSpace
    grids: tuple[Grid, ...]
    sample: Signatures  # signatures of all of them over the touches, or over an even choice of many

    @classmethod
    def of(
        cls, complement: ResidualSpace, candidates: Sequence[Effect], progress: Progress = quiet
    ) -> "Library":
        """Candidates at every point of their grids, with their signatures."""
        grids = scanned_grids(candidates, complement)
        n = len(complement.u)
        seen = complement if n <= WHOLE_BELOW else complement.thinned(WHOLE_BELOW)
        return cls(complement, tuple(grids), signatures(seen, grids, tried(grids), progress))

    def without(self, is_left_out: Callable[[Effect], bool]) -> "Library":
        """The same less some candidates, which must be the last ones."""
        grids = tuple(g for g in self.grids if not is_left_out(g.effect))
        complement, sample = self.complement, self.sample.without(is_left_out)
        return Library(complement, grids, sample)

    @property
    def is_whole(self) -> bool:
        """Whether every candidate is searched over all touches."""
        return self.sample.complement is self.complement

    @cached_property
    def variants(self) -> tuple[Effect, ...]:
        """Every candidate at every point, in the order of the signatures."""
        return self.sample.variants

    def pool(self, shortlist: Shortlist) -> Signatures:
        """Signatures over all touches, of the whole library or of a shortlist of it."""
        if self.is_whole:
            return self.sample
        grids = []
        for index in sorted(shortlist):
            variants = tuple(self.variants[v] for v in sorted(shortlist[index]))
            grid = self.grids[index]
            grids.append(Grid(grid.effect, variants, grid.tries))
        return signatures(self.complement, grids, tried(self.grids))

    def shortlist(self, found: Sequence[ScaledEffect], effects: EffectSet) -> Shortlist:
        """Candidates that may matter beside a set of effects; empty where all are searched."""
        if self.is_whole:
            return {}
        scores = self._screen(found, effects)
        best: dict[int, list[int]] = {}
        for variant in ranked(scores.evidence):
            best.setdefault(int(self.sample.owner[variant]), []).append(int(variant))
        names = {s.effect.name for s in found}
        known = [i for i, grid in enumerate(self.grids) if grid.effect.name in names]
        let_through = dict.fromkeys([*list(best)[:MAX_CANDIDATES], *known])
        return {i: frozenset(best[i][:MAX_POINTS]) for i in let_through}

    def _screen(self, found: Sequence[ScaledEffect], effects: EffectSet) -> Scores:
        """Scores of all variants beside a set of effects."""
        seen = self.sample.complement
        sample = EffectSet(seen, projected(seen, found))
        residual = effects.residual[: len(self.complement.u)]
        return screen(effects, sample, self.sample, self._along(residual))

    def _along(self, residual: Array) -> Array:
        """Inner products of every raw column with a residual, all touches, (M,)."""
        out = np.empty(self.sample.C.shape[1])
        start = self.sample.start
        for first, last in blocks(self.variants):
            C = self.complement.columns(self.variants[first:last])
            out[start[first] : start[last]] = C.T @ residual
        return out
