"""Compliance of an axis, or of the tool, under the load on the tool."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Kind, Parameter, Term, Title, Where, check_count, refusal
from matstd.twin.record import Touches
from matstd.twin.units import UM


@dataclass(frozen=True)
class Stiffness:
    """An axis or the tool yields to the load on the tool.

    F acts on the tool, M is its moment about the axis, d the direction of the axis; on either side
    of the machine the tool moves with the load relative to the workpiece. The tool, `t`, yields
    sideways and along: two compliances.

    Attributes:
        link: Name of the axis, or `t`.
        components: Indices of the components that yield, and the parameter of each.
    """

    link: str
    components: tuple[tuple[int, int], ...]

    kind = "stiffness"

    @property
    def name(self) -> str:
        """`stiffness(Z)`."""
        return f"stiffness({self.link})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"compliance of {'the tool' if self.link == 't' else self.link}", self.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Compliances."""
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
        force = _force(touches, self.name)
        loads = np.einsum("nci,ni->nc", touches.reach.twist[:, i], force)
        return tuple(Term(k, Where("twist", i, c), loads[:, c]) for c, k in self.components)


def _force(touches: Touches, name: str) -> Array:
    if touches.force is None:
        raise UnknownEffect(f"'{name}': the load on the tool at these touches is unknown")
    return touches.force


def stiffness(chain: Chain, link: str) -> Stiffness:
    """Compliance of an axis or of the tool."""
    if link == "t":
        return Stiffness(link, ((0, 0), (1, 0), (2, 1)))
    return Stiffness(link, ((chain.link(link).own_component, 0),))


def make(chain: Chain, arguments: Sequence[str]) -> Stiffness:
    """From the axis, or `t` for the tool."""
    check_count(KIND.usage, arguments, 1, 1)
    if arguments[0] not in (*chain.programmed_axes, "t"):
        known = ", ".join((*chain.programmed_axes, "t"))
        raise refusal(KIND.usage, arguments, f"one of {known}")
    return stiffness(chain, arguments[0])


def propose(touches: Touches) -> Iterable[Stiffness]:
    """Every axis and the tool, where loads were recorded and vary."""
    if touches.force is not None and float(np.max(np.ptp(touches.force, axis=0))) > 0.0:
        for link in (*touches.chain.programmed_axes, "t"):
            yield stiffness(touches.chain, link)


KIND = Kind(
    word="stiffness",
    arguments="axis or t",
    title="compliance under load",
    synonyms="flexibility, deflection under load, cutting force, loaded, stiffness",
    formula="E = c F.d (linear axis, tool); E = c M.d (rotary axis); F, M the load on the tool",
    units="c: µm/N; µrad/(N mm)",
    typical="0.02 to 0.1 µm/N (10 to 50 N/µm) at the tool; the rotary table is the weakest",
    source="static compliance, ISO 230-1 (machine under load); loaded double ball bar",
    make=make,
    propose=propose,
    classes=(Stiffness,),
)
