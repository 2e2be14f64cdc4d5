"""Static stiffness at the tool point, of the whole machine, as it varies over the travels."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.elastic.stiffness import recorded_force
from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import check_count, moving_linear_axes
from matstd.twin.machine import Chain
from matstd.twin.model import Declared, Kind, Parameter, Term, Where
from matstd.twin.record import Touches
from matstd.twin.units import UM

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Entries of the symmetric compliance: force along the second, motion along the first."""


@dataclass(frozen=True)
class ToolPointStiffness(Declared):
    """The tool point yields to its load by a compliance that depends on place and direction.

    ``d = C(p) F``, ``C(p) = C0 + sum over linear axes of Ca s``, s from -1 to 1 over the travel; C0
    and every Ca are symmetric, so a machine is as stiff one way as back. Quasi-static, below 1 Hz.
    """

    axes: tuple[str, ...]  # linear axes, of which the last carries the deflection

    kind, called = "tool-point-stiffness", "stiffness at the tool point over the workspace"
    is_tensor = True
    """Reported as a whole: its entries one by one depend on what the zero of a bar takes up."""

    @cached_property
    def name(self) -> str:
        """`tool-point-stiffness(X,Y,Z)`; the last axis carries it."""
        return f"tool-point-stiffness({','.join(self.axes)})"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """Six entries at the middle of the travels, and their change to the end of each axis."""
        out = []
        for place in ("", *(f" {axis}" for axis in self.axes)):
            for i, j in PAIRS:
                sd = (0.05 if i == j else 0.02) * UM * (0.5 if place else 1.0)
                out.append(Parameter(f"C{'XYZ'[i]}{'XYZ'[j]}{place}", "mm/N", sd))
        return tuple(out)

    def terms(self, touches: Touches) -> Sequence[Term]:
        force = recorded_force(touches, self.name)
        chain = touches.chain
        i = chain.link_index(self.axes[-1])
        # the load in the frame of the axis, which a rotary table may have turned away from
        loads = np.einsum("nci,ni->nc", touches.reach.twist[:, i, :3], force)
        shapes = [np.ones(len(touches))]
        shapes += [chain.link(a).scaled(touches.reading(a)) for a in self.axes]
        out = []
        for p, shape in enumerate(shapes):
            for k, (a, b) in enumerate(PAIRS):
                at = p * len(PAIRS) + k
                out.append(Term(at, Where("twist", i, a), shape * loads[:, b]))
                if a != b:
                    out.append(Term(at, Where("twist", i, b), shape * loads[:, a]))
        return out


def make(chain: Chain, arguments: Sequence[str]) -> ToolPointStiffness:
    """From the linear axes; without arguments all of the machine."""
    check_count(KIND.usage, arguments, 0, len(chain.linear_axes))
    for axis in arguments:
        chain.link(axis)
    if any(a not in chain.linear_axes for a in arguments) or len(set(arguments)) < len(arguments):
        known = ", ".join(chain.linear_axes)
        raise UnknownEffect(f"effect '{KIND.word}': expected linear axes of {known}, each once")
    return ToolPointStiffness(tuple(arguments) or tuple(chain.linear_axes))


def propose(touches: Touches) -> Iterable[ToolPointStiffness]:
    """The linear axes that moved, where a load changed its direction."""
    if touches.force is None:
        return
    axes = moving_linear_axes(touches)
    if axes and float(np.ptp(touches.force, axis=0).min()) > 1.0:
        yield ToolPointStiffness(tuple(axes))


KIND = Kind(
    word="tool-point-stiffness",
    arguments="[linear axis,...]",
    title="stiffness at the tool point over the workspace",
    synonyms="aggregated stiffness, loaded double ball bar, LDBB, static compliance, workspace",
    formula="d = C(p) F, C(p) = C0 + sum C_a s_a, symmetric; s_a = -1 ... 1 over the travel",
    units="C: µm/N",
    typical="0.01 to 0.1 µm/N (10 to 100 N/µm), varying by tens of percent over the workspace",
    source="Archenti and Nicolescu, CIRP Annals 62, 2013 (loaded double ball bar); second paper",
    make=make,
    propose=propose,
    classes=(ToolPointStiffness,),
)
