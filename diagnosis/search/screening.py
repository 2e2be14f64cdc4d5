"""Candidates of a run: all of the library for most, a screened choice of it for a long run."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.evidence import (
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
    screen,
    signatures,
    whole_grids,
)
from twin.frames import Array
from twin.model import Effect

WHOLE_BELOW = 4000
"""Up to so many touches the whole library is searched at every point of its grids; beyond, a choice
of as many touches screens it first."""

SHORT = 40
"""Candidates that a screening lets through."""

POINTS = 12
"""Best points of a candidate's grid that it lets through."""


@dataclass(frozen=True, eq=False)
class Library:
    """Candidate effects with what is needed to search among them in one run.

    Attributes:
        complement: What the fitted model leaves, all touches.
        grids: Every candidate at every point of its grid.
        sample: Signatures of all of them over the touches, or over an even choice of many.
    """

    complement: ResidualSpace
    grids: tuple[Grid, ...]
    sample: Signatures

    @classmethod
    def of(
        cls, complement: ResidualSpace, candidates: Sequence[Effect], progress: Progress = quiet
    ) -> "Library":
        """Candidates of a run."""
        grids = whole_grids(candidates, complement.touches)
        n = len(complement.u)
        seen = complement if n <= WHOLE_BELOW else complement.thinned(WHOLE_BELOW)
        return cls(complement, tuple(grids), signatures(seen, grids, len(grids), progress))

    @property
    def is_whole(self) -> bool:
        """Whether every candidate is searched over all touches."""
        return self.sample.complement is self.complement

    @cached_property
    def variants(self) -> tuple[Effect, ...]:
        """Every candidate at every point, in the order of the signatures."""
        return self.sample.variants

    def pool(self, keep: Sequence[str]) -> Signatures:
        """Signatures over all touches, of the whole library or of what a screening keeps.

        Args:
            keep: Names of candidates that have been let through so far.
        """
        if self.is_whole:
            return self.sample
        grids = [g for g in self._screened if g.effect.name in keep]
        return signatures(self.complement, grids, len(self.grids))

    def shortlist(self, found: Sequence[ScaledEffect], effects: EffectSet) -> list[str]:
        """Names of the candidates that may matter beside a set of effects, the best first.

        Args:
            found: Effects of the set.
            effects: The set over all touches.
        """
        if self.is_whole:
            return list(self.sample.names)
        scores = self._screen(found, effects)
        best: dict[int, list[int]] = {}
        for variant in np.argsort(-scores.evidence, kind="stable"):
            best.setdefault(int(self.sample.owner[variant]), []).append(int(variant))
        for index in list(best)[:SHORT]:
            self._let_through(index, best[index][:POINTS])
        return [self.sample.names[index] for index in list(best)[:SHORT]]

    @cached_property
    def _points(self) -> dict[int, set[int]]:
        """Variants of every candidate that have been let through."""
        return {}

    def _let_through(self, index: int, variants: Sequence[int]) -> None:
        self._points.setdefault(index, set()).update(variants)

    @property
    def _screened(self) -> list[Grid]:
        """Candidates let through, at the points let through."""
        out = []
        for index in sorted(self._points):
            variants = tuple(self.variants[v] for v in sorted(self._points[index]))
            grid = self.grids[index]
            out.append(Grid(grid.effect, variants, grid.tries))
        return out

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
