"""A machine with the effects that are in its model: exact deviations, and linear columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.display import Displayed
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.machine import Chain, Contribution, exact_tip, tip
from matstd.twin.model.effect import Effect, Parameter, numbered_terms
from matstd.twin.record import Touches


@dataclass(frozen=True, eq=False, repr=False)
class Model(Displayed):
    """Chain plus effects; parameters of all effects stand in one vector, effect after effect."""

    chain: Chain  # the machine
    effects: tuple[Effect, ...]  # the physics in the model

    @cached_property
    def parameters(self) -> tuple[tuple[Effect, Parameter], ...]:
        """Every parameter with its effect, in the order of the parameter vector."""
        return tuple((e, p) for e in self.effects for p in e.parameters)

    @cached_property
    def prior_sd(self) -> Array:
        """Expected standard deviation of every parameter, (P,), base units."""
        return np.array([p.sd for _, p in self.parameters])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """`effect: parameter`, or the effect alone where it has one parameter."""
        return tuple(
            e.name if len(e.parameters) == 1 else f"{e.name}: {p.name}" for e, p in self.parameters
        )

    def columns(self, touches: Touches) -> Array:
        """Deviation along the normal per unit of every parameter, first order, (N, P)."""
        return columns(self.effects, touches)

    def tip_columns(self, touches: Touches) -> Array:
        """Deviation of the tip in the table frame per unit of every parameter, (N, 3, P).

        What moves only the standard or the reading of the probe does not move the tip.
        """
        return self._displacements(touches, with_standard=False)

    def relative_columns(self, touches: Touches) -> Array:
        """Displacement of the tip relative to the standard per unit of every parameter, (N, 3, P).

        In the table frame: the deviation of the tip minus the shift of the standard.
        """
        return self._displacements(touches, with_standard=True)

    def _displacements(self, touches: Touches, with_standard: bool) -> Array:
        out = np.zeros((len(touches), 3, len(self.parameters)))
        for k, term in numbered_terms(self.effects, touches):
            if with_standard or term.where.moves_tip:
                out[:, :, k] += term.amount[:, None] * touches.reach.of(term.where)
        return out

    def contribution(self, touches: Touches, theta: Array) -> Contribution:
        """What all effects add at every touch for a parameter vector (P,)."""
        total = Contribution.zeros(len(touches), len(touches.chain.links))
        for k, term in numbered_terms(self.effects, touches):
            total.add(term.where, theta[k] * term.amount)
        return total

    def tip(self, touches: Touches, theta: Array) -> Array:
        """Exact tip in the table frame with all effects, (N, 3), mm."""
        return exact_tip(self.chain, touches.q, touches.target, self.contribution(touches, theta))

    def tip_deviation(self, touches: Touches, theta: Array) -> Array:
        """Exact deviation of the tip in the table frame, actual minus nominal, (N, 3), mm."""
        return self.tip(touches, theta) - tip(self.chain, touches.q, touches.target)

    def relative_deviation(self, touches: Touches, theta: Array) -> Array:
        """Exact displacement of the ball centre relative to the standard, artefact frame, (N, 3).

        Where the ball really is, as seen from the standard, minus where readings and stated set-up
        put it, mm.
        """
        added = self.contribution(touches, theta)
        actual = exact_tip(self.chain, touches.q, touches.target, added) - added.shift
        return apply(inverse(touches.T_table_artefact), actual) - touches.ball_artefact

    def deviation(self, touches: Touches, theta: Array) -> Array:
        """Deviation along the normal that a controller would measure, with the exact chain, (N,).

        ``dev = -n . (tip deviation - shift of the standard) + bias``. Holds where the surface is
        plane over the deviation; a curved one is met by moving the axes (`probe_paths`).
        """
        moved = self.relative_deviation(touches, theta)
        bias = self.contribution(touches, theta).bias
        along = np.einsum("ni,ni->n", touches.normal, moved)
        if touches.instrument.reads_angle:
            other = touches.opposite
            across = np.einsum("ni,ni->n", other.normal, self.relative_deviation(other, theta))
            along = 0.5 * (along + across)
        return bias - along


def columns(effects: Sequence[Effect], touches: Touches) -> Array:
    """Deviation along the normal per base unit of every parameter of some effects, (N, P), mm."""
    out = np.zeros((len(touches), sum(len(e.parameters) for e in effects)), order="F")
    signature = touches.signature
    for k, term in numbered_terms(effects, touches):
        out[:, k] += term.amount * signature.of(term.where)
    return out
