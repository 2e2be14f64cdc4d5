"""A carriage, ram, column or crossbeam as a Timoshenko beam that carries the frame of its axis."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from matstd.twin.elastic.beam import SUPPORTS, Plane, Section, Support, along, bending, section
from matstd.twin.elastic.materials import MATERIALS, Material, material
from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import Refuse, no_values, read_linear_axis, refusal
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Declared, Effect, Kind, Parameter, Term, Where
from matstd.twin.record import Touches

GRAVITY = 9.80665  # standard acceleration, m/s2, N/kg
SLENDER = 3.0
"""Below this ratio of length to depth the supports of a beam yield as much as the beam; a warning
is given."""
KEYS = ("at", "sense", "span", "mass", "offset", "material", "down")
DIRECTIONS = {s + a: i for i, (s, a) in enumerate((s, a) for a in "XYZ" for s in "+-")}


@dataclass(frozen=True)
class Body(Declared):
    """A beam whose deflection and rotation at the frame of an axis move all that it carries.

    The point stands ``x = at + sense q`` from the root, q the reading. Loads on it are its mass at
    its offset, the beam's own weight, and the load on the tool with its moment. A cantilever
    without a span is a ram: only what has left its guide bends.
    """

    axis: str  # linear axis whose frame it carries
    support: Support  # how the beam is held
    shape: str  # of the section as the file writes it
    at: float  # distance of the point from the root at reading zero, mm
    sense: int  # 1 where the point goes away from the root with the reading, -1 the other way
    span: float  # length of the beam, mm; 0 of a ram
    mass: float | str  # that it carries, kg, or a column of the user's own, `V_name_kg`
    offset: tuple[float, float, float]  # from the point to the mass, machine frame, mm
    stuff: str  # word of the material
    down: str  # direction of the weight, `-Z`
    outward: tuple[int, int]  # from root to point along X, Y or Z of the machine: index, sign
    on_tool_side: bool

    kind, called = "beam", "bending of the body of {axis} under weight and load"
    # multiples of what the theory of the beam predicts: 1 and 1 where it is as stated
    parameters = (Parameter("weight", "1", 1.0), Parameter("load", "1", 1.0))

    @cached_property
    def name(self) -> str:
        """`beam(Z,cantilever,220x180x20,at:420,sense:-1,mass:80)`."""
        words = [self.axis, self.support, self.shape, f"at:{self.at:g}"]
        words += [f"sense:{self.sense}"] if self.sense < 0 else []
        words += [f"span:{self.span:g}"] if self.span else []
        mass = self.mass if isinstance(self.mass, str) else f"{self.mass:g}"
        words += [f"mass:{mass}"] if self.mass else []
        words += ["offset:" + ":".join(f"{v:g}" for v in self.offset)] if any(self.offset) else []
        words += [f"material:{self.stuff}"] if self.stuff != "steel" else []
        words += [f"down:{self.down}"] if self.down != "-Z" else []
        return f"beam({','.join(words)})"

    @property
    def material(self) -> Material:
        """Material of the beam."""
        found = material(self.stuff)
        assert found is not None
        return found

    @property
    def section(self) -> Section:
        """Section of the beam."""
        found = section(self.shape, self.material.poisson)
        assert found is not None
        return found

    def slenderness(self, low: float, high: float) -> float:
        """Length over depth where the beam is longest, for readings between two."""
        longest = max(self.at + self.sense * low, self.at + self.sense * high)
        return (self.span or longest) / self.section.depth

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis: under weight, and under the load on the tool where it is known."""
        i = touches.chain.link_index(self.axis)
        by_load, own = self._answers(touches.reading(self.axis))
        side = 1.0 if self.on_tool_side else -1.0
        moved = np.einsum("ncd,nd->nc", by_load, self._carried(touches))
        moved += own @ _unit(self.down)
        link = touches.chain.links[i]
        moved = link.in_frame(moved)
        out = [Term(0, Where("twist", i, c), side * moved[:, c]) for c in range(6)]
        if touches.force is not None:
            # force and moment at the frame, conjugate to its six motions; on either side of the
            # machine the tool moves with its load relative to the workpiece
            loads = np.einsum("nci,ni->nc", touches.reach.twist[:, i], touches.force)
            bent = link.in_frame(np.einsum("ncd,nd->nc", by_load, link.in_machine(loads)))
            out += [Term(1, Where("twist", i, c), bent[:, c]) for c in range(6)]
        return out

    def _carried(self, touches: Touches) -> Array:
        """Force and moment of the carried mass at the point, (N, 6), N and N mm."""
        if isinstance(self.mass, str):
            name = self.mass.removeprefix("V_")
            if name not in touches.value:
                known = ", ".join(f"V_{n}" for n in touches.value) or "none"
                raise UnknownEffect(f"'{self.name}': no column '{self.mass}'; there is {known}")
            mass = touches.value[name]
        else:
            mass = np.full(len(touches), self.mass)
        force = mass[:, None] * GRAVITY * _unit(self.down)
        return np.hstack([force, np.cross(np.array(self.offset), force)])

    def _answers(self, q: Array) -> tuple[Array, Array]:
        """Motions per force and moment (N, 6, 6), and per unit of weight's direction (N, 6, 3)."""
        stuff, shape = self.material, self.section
        x = self.at + self.sense * q
        if np.any(x <= 0.0) or (self.span and np.any(x >= self.span)):
            raise UnknownEffect(
                f"'{self.name}': the frame stands {x.min():g} to {x.max():g} mm from the root"
            )
        span = np.full(len(x), self.span) if self.span else x
        weight = stuff.density * shape.area * GRAVITY
        axis, sign = self.outward
        C, own = np.zeros((len(x), 6, 6)), np.zeros((len(x), 6, 3))
        C[:, axis, axis] = along(self.support, x, span, stuff.young * shape.area)
        C[:, 3 + axis, 3 + axis] = along(self.support, x, span, stuff.shear * shape.torsion)
        own[:, axis, axis] = weight * self._stretched(x, span) / (stuff.young * shape.area)
        for k, across in enumerate(((axis + 1) % 3, (axis + 2) % 3)):
            EI, GA = stuff.young * shape.bending[k], stuff.shear * shape.shear_area[k]
            plane = bending(self.support, x, span, EI, GA)
            # outward x across is the direction about which a force across turns the point
            about = 3 + ((axis + 2) % 3 if k == 0 else (axis + 1) % 3)
            turn = sign * (1.0 if k == 0 else -1.0)
            self._place(C, own, plane, across, about, turn, weight)
        return C, own

    def _stretched(self, x: Array, span: Array) -> Array:
        """Motion along the beam under its own weight along it, per weight over stiffness, (N,)."""
        beyond = span - x
        return x * (x / 2.0 + beyond) if self.support == "cantilever" else x * beyond / 2.0

    @staticmethod
    def _place(
        C: Array, own: Array, plane: Plane, across: int, about: int, turn: float, weight: float
    ) -> None:
        """One plane of bending among the six motions."""
        C[:, across, across] = plane.by_force
        C[:, about, about] = plane.by_moment
        C[:, across, about] = C[:, about, across] = turn * plane.coupled
        own[:, across, across] = weight * plane.own
        own[:, about, across] = turn * weight * plane.own_rotation


def _unit(direction: str) -> Array:
    """`-Z` as a vector, (3,)."""
    return (-1.0 if direction[0] == "-" else 1.0) * np.eye(3)["XYZ".index(direction[-1])]


def make(chain: Chain, arguments: Sequence[str]) -> Body:
    """From axis, support, section and `key:value` words."""
    refuse = partial(refusal, KIND.usage, arguments)
    if len(arguments) < 4:
        raise refuse("an axis, a support, a section and where the frame stands")
    axis = read_linear_axis(arguments[0], chain, refuse)
    if arguments[1] not in SUPPORTS:
        raise refuse(f"a support: {', '.join(SUPPORTS)}")
    keys = _keys(arguments[3:], refuse)
    stuff = keys.get("material", "steel")
    known = material(stuff)
    if known is None:
        raise refuse(f"a material: {', '.join(MATERIALS)}")
    if section(arguments[2], known.poisson) is None:
        raise refuse("a section such as 220x180, 220x180x20, d120 or d120x10")
    if "at" not in keys:
        raise refuse("at:MM, the frame's place from the root at reading zero")
    # any positive number is the sense 1: only its sign matters
    sense = 1 if _number(keys, "sense", 1.0, refuse) > 0.0 else -1
    span = _number(keys, "span", 0.0, refuse)
    if arguments[1] != "cantilever" and span <= 0.0:
        raise refuse("span:MM between the supports")
    down, mass = keys.get("down", "-Z"), keys.get("mass", "")
    if down not in DIRECTIONS:
        raise refuse(f"down:{' or '.join(DIRECTIONS)}")
    body = Body(
        axis=axis,
        support=next(s for s in SUPPORTS if s == arguments[1]),
        shape=arguments[2],
        at=_number(keys, "at", 0.0, refuse),
        sense=sense,
        span=span,
        mass=mass if mass.startswith("V_") else _number(keys, "mass", 0.0, refuse),
        offset=_offset(keys.get("offset", "0:0:0"), refuse),
        stuff=stuff,
        down=down,
        outward=_outward(chain, axis, sense, refuse),
        on_tool_side=not chain.link(axis).carries_workpiece,
    )
    _check_travel(chain, body, refuse)
    return body


def _keys(words: Sequence[str], refuse: Refuse) -> dict[str, str]:
    """The `key:value` words, each key once."""
    out: dict[str, str] = {}
    for word in words:
        key, colon, value = word.partition(":")
        if not colon or key not in KEYS or key in out:
            raise refuse(f"each of {', '.join(KEYS)} once at most, as KEY:VALUE")
        out[key] = value
    return out


def _number(keys: dict[str, str], key: str, missing: float, refuse: Refuse) -> float:
    try:
        value = float(keys.get(key, missing))
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or (key in ("span", "mass") and value < 0.0):
        raise refuse(f"a number in {key}:{keys[key]}")
    return value


def _offset(text: str, refuse: Refuse) -> tuple[float, float, float]:
    try:
        x, y, z = (float(part) for part in text.split(":"))
    except ValueError:
        raise refuse("offset:X:Y:Z of the mass in mm") from None
    return x, y, z


def _outward(chain: Chain, axis: str, sense: int, refuse: Refuse) -> tuple[int, int]:
    """From root to point along the machine: the way that the body goes when x grows."""
    link = chain.link(axis)
    i = chain.link_index(axis)
    ground = chain.links[i + 1 :] if link.carries_workpiece else chain.links[:i]
    turned = [
        k.name for k in ground
        if k.kind == "rotary" and k.carries_workpiece == link.carries_workpiece
    ]  # fmt: skip
    if turned:
        raise refuse(f"an axis that no rotary axis carries ({turned[0]} does)")
    if not link.points_along_letter and not np.allclose(np.abs(link.direction).max(), 1.0):
        raise refuse("an axis along X, Y or Z of the machine")
    own = int(np.argmax(np.abs(link.direction)))
    moves = np.sign(link.direction[own]) * (-1.0 if link.carries_workpiece else 1.0)
    return own, int(moves * sense)


def _check_travel(chain: Chain, body: Body, refuse: Refuse) -> None:
    """The frame stays on the beam over the whole travel."""
    ends = [body.at + body.sense * r for r in chain.link(body.axis).range]
    if min(ends) <= 0.0 or (body.span and max(ends) >= body.span):
        limit = f"below {body.span:g}" if body.span else "more"
        raise refuse(
            f"a frame that stays on the beam, above 0 and {limit}; it goes from {min(ends):g} to "
            f"{max(ends):g} mm from the root"
        )


KIND = Kind(
    word="beam",
    arguments="axis,support,section,at:MM,...",
    title="bending and torsion of a carriage, ram or column",
    synonyms="Timoshenko beam, elastic model, dead weight, workpiece mass, deflection, crossbeam",
    formula="E = C(q) (weight, load): Timoshenko, e.g. cantilever F (L^3/(3 E I) + L/(kappa G A))",
    units="weight, load: times what the beam says; at, span, offset: mm, mass: kg or V_name_kg",
    typical="1 where the beam is as stated; joints make it 1.5 to 3",
    source="Timoshenko beam with Cowper's shear coefficients; first paper, 2.2",
    make=make,
    propose=no_values,  # only the user knows sections
    classes=(Body,),
)


def short_beams(chain: Chain, effects: Iterable[Effect]) -> Iterator[tuple[str, float]]:
    """Names of beams that are short for their depth over the whole travel, and length over depth.

    Supports and walls of such a body yield as much as the beam.
    """
    for effect in effects:
        if isinstance(effect, Body):
            ratio = effect.slenderness(*chain.link(effect.axis).range)
            if ratio < SLENDER:
                yield effect.name, ratio
