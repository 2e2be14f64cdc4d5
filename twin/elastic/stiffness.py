"""Compliance of an axis, or of the tool, under the load on the tool."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import Argument, Refuse
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Declared, Kind, Parameter, Term, Title, Where
from matstd.twin.record import Touches
from matstd.twin.units import UM


def _link(text: str, chain: Chain, refuse: Refuse) -> str:
    known = (*chain.programmed_axes, "t")
    if text not in known:
        raise refuse(f"one of {', '.join(known)}")
    return text


def _loaded(touches: Touches) -> Iterable[str]:
    """Every axis and the tool, where loads were recorded and vary."""
    if touches.force is None or float(np.max(np.ptp(touches.force, axis=0))) == 0.0:
        return ()
    return (*touches.chain.programmed_axes, "t")


@dataclass(frozen=True)
class Stiffness(Declared):
    """An axis or the tool yields to the load on the tool.

    F acts on the tool, M is its moment about the axis, d the direction of the axis; on either side
    of the machine the tool moves with the load relative to the workpiece. The tool, `t`, yields
    sideways and along: two compliances.
    """

    link: Annotated[str, Argument("axis or t", _link, offered=_loaded)]  # name of the axis, or `t`
    # indices of the components that yield, and the parameter of each
    components: tuple[tuple[int, int], ...] = ((0, 0), (1, 0), (2, 1))

    kind = "stiffness"
    is_by_parameter = True

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With the component of an axis that yields."""
        if self.link == "t":
            return self
        return replace(self, components=((chain.link(self.link).own_component, 0),))

    @cached_property
    def title(self) -> Title:
        return Title(f"compliance of {'the tool' if self.link == 't' else self.link}", self.link)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        if self.link == "t":
            return tuple(Parameter(word, "mm/N", 0.5 * UM) for word in ("sideways", "along"))
        if self.components[0][0] >= 3:
            return (Parameter("compliance", "rad/(N mm)", 1.0e-9),)
        return (Parameter("compliance", "mm/N", 0.1 * UM),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the link.

        The load conjugate to a component is force times the motion of the tip per unit of it.
        """
        i = touches.chain.link_index(self.link)
        force = recorded_force(touches, self.name)
        loads = np.einsum("nci,ni->nc", touches.reach.twist[:, i], force)
        return tuple(Term(k, Where("twist", i, c), loads[:, c]) for c, k in self.components)


def recorded_force(touches: Touches, name: str) -> Array:
    """Load on the tool, (N, 3), N; raises UnknownEffect for that name where none is recorded."""
    if touches.force is None:
        raise UnknownEffect(f"'{name}': the load on the tool at these touches is unknown")
    return touches.force


KIND = Kind.of(
    Stiffness,
    title="compliance under load",
    synonyms="flexibility, deflection under load, cutting force, loaded, stiffness",
    formula="E = c F.d (linear axis, tool); E = c M.d (rotary axis); F, M the load on the tool",
    units="c: µm/N; µrad/(N mm)",
    typical="0.02 to 0.1 µm/N (10 to 50 N/µm) at the tool; the rotary table is the weakest",
    source="static compliance, ISO 230-1 (machine under load); loaded double ball bar",
)
