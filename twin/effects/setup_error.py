"""Free parameters of every run: pose of the standard, further styli, size of the standard."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Annotated

import numpy as np

from matstd.twin.fields import Argument
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Declared, Parameter, Term, Where
from matstd.twin.record import Body, Touches
from matstd.twin.units import T_REF, UM

SHIFT_SD = 1000.0 * UM
TURN_SD = 5e-3
"""Prior standard deviations of a set-up, mm and rad: wide, since no clamping repeats to a
micrometre and the calibration of a machine must not depend on it."""
STYLUS_SD = 100.0 * UM
"""Prior standard deviation of place and radius of a further stylus against the first, mm: also
wide."""
_MAX_STYLI = 10  # largest number of further styli; more lengths belong to a target that is moved


def rigid_shift(here: Array, arm: Array) -> list[Term]:
    """Shifts of a standard that moves and turns: three displacements, then three rotations.

    Args:
        here: 1 at the touches that are moved, (N,).
        arm: From the centre of the rotation to the touched points, 0 at other touches, (N, 3), mm.
    """
    return [*(Term(i, Where("shift", 0, i), here) for i in range(3)), *turned_shift(arm, first=3)]


def turned_shift(arm: Array, first: int = 0) -> list[Term]:
    """Shifts of a standard that turns: three rotations, of which each moves two directions.

    Args:
        arm: As of `rigid_shift`.
        first: Index of the first rotation among the parameters.
    """
    terms = []
    for turn in range(3):
        a, b = (turn + 1) % 3, (turn + 2) % 3
        terms.append(Term(first + turn, Where("shift", 0, b), arm[:, a]))
        terms.append(Term(first + turn, Where("shift", 0, a), -arm[:, b]))
    return terms


@dataclass(frozen=True)
class SetupError(Declared):
    """Displacement and rotation of the standard in one set-up, against the stated one.

    ``shift = e + r x (x - c)`` in the table frame, with x the touched point and c the centre. Six
    parameters, mm and rad.
    """

    setup: Annotated[str, Argument("setup")]
    # c, table frame, mm: the middle of the touched points, so that displacement and rotation are
    # estimated nearly independently
    centre: tuple[float, float, float]
    # whether an instrument that feels angles alone stands there: three parameters
    turns_only: bool = False

    kind = "setup"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        shifts = [Parameter(f"d{c}", "mm", SHIFT_SD) for c in "xyz" if not self.turns_only]
        return (*shifts, *(Parameter(f"r{c}", "rad", TURN_SD) for c in "xyz"))

    def here(self, touches: Touches) -> Mask:
        """Touches of this set-up, (N,)."""
        names = [s.name for s in touches.setups]
        return touches.setup == (names.index(self.setup) if self.setup in names else -1)

    def terms(self, touches: Touches) -> Sequence[Term]:
        here = self.here(touches).astype(float)
        if self.turns_only:
            felt = np.cross(
                touches.point_table - touches.T_table_artefact[:, :3, 3], touches.normal_table
            )
            return [Term(i, Where("bias"), here * felt[:, i]) for i in range(3)]
        arm = (touches.point_table - np.array(self.centre)) * here[:, None]
        return rigid_shift(here, arm)


@dataclass(frozen=True)
class StylusError(Declared):
    """Calibration error of a further stylus against that of the first.

    The ball stands e beside its calibrated place in the tool frame, and its effective radius is r
    larger: ``dev = -n . (R e) + r``. Four parameters, mm; what is wrong with all styli alike is an
    error of the tool or of the probe.
    """

    length: float  # calibrated length of the stylus, gauge point to ball centre, mm
    radius: float  # calibrated radius of its ball, mm

    kind = "stylus"
    parameters = tuple(Parameter(name, "mm", STYLUS_SD) for name in ("dx", "dy", "dz", "radius"))

    @cached_property
    def name(self) -> str:
        """`stylus(210.004,2.5)`."""
        return f"stylus({self.length:.9g},{self.radius:.9g})"

    def here(self, touches: Touches) -> Mask:
        """Touches of this stylus, (N,)."""
        return np.asarray((touches.length == self.length) & (touches.radius == self.radius))

    def terms(self, touches: Touches) -> Sequence[Term]:
        here, tool = self.here(touches).astype(float), touches.chain.link_index("t")
        moves = [Term(i, Where("place", tool, i), here) for i in range(3)]
        return [*moves, Term(3, Where("bias"), here)]


@dataclass(frozen=True)
class BodyTemperature(Declared):
    """Deviation of the standard of one run from its stated temperature, or from 20 degC.

    ``shift = alpha dT p``, p from the origin of the standard: one scale of all its touches, within
    the uncertainty of the temperature. A common scale of X, Y and Z looks the same, so that what it
    leaves open stays in the uncertainty of theirs.
    """

    run: str
    body: Body

    kind = "body-temperature"

    @cached_property
    def name(self) -> str:
        """`body-temperature`, of several runs with the name of the run."""
        return f"{self.kind}({self.run})" if self.run else self.kind

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        return (Parameter("temperature", "K", self.body.u_temperature),)

    def here(self, touches: Touches) -> Mask:
        """Touches of this run, (N,)."""
        own = np.array([s.run == self.run and s.body == self.body for s in touches.setups])
        return np.asarray(own[touches.setup])

    def terms(self, touches: Touches) -> Sequence[Term]:
        return _grown(touches, self.here(touches).astype(float) * self.body.alpha)


@dataclass(frozen=True)
class BodyExpansion(Declared):
    """Deviation of the expansion of the standard from the stated one.

    ``shift = dalpha (T - 20 degC) p``. Runs that state the same standard share it.
    """

    body: Body

    kind = "body-expansion"

    @cached_property
    def name(self) -> str:
        """`body-expansion(1.05e-05)`."""
        return f"{self.kind}({self.body.alpha:g})"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        return (Parameter("expansion", "1/K", self.body.u_alpha),)

    def here(self, touches: Touches) -> Mask:
        """Touches of a standard of this expansion, (N,)."""
        return _of_body(touches, self.body, "alpha", "u_alpha")

    def terms(self, touches: Touches) -> Sequence[Term]:
        return _grown(touches, self.here(touches) * (touches.body_temperature - T_REF))


@dataclass(frozen=True)
class BodyScale(Declared):
    """Common relative error of all calibrated lengths of the standard, ``shift = s p``.

    Scale and temperature of the CMM that calibrated it. Runs that state the same standard share it.
    """

    body: Body

    kind = "body-scale"

    @cached_property
    def name(self) -> str:
        """`body-scale(5.2e-06)`."""
        return f"{self.kind}({self.body.u_scale:.3g})"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        return (Parameter("scale", "mm/mm", self.body.u_scale),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        return _grown(touches, _of_body(touches, self.body, "alpha", "u_scale").astype(float))


def _of_body(touches: Touches, body: Body, *names: str) -> Mask:
    """Touches of a standard whose stated figures of these names are those of a body, (N,)."""
    of = attrgetter(*names)
    own = [s.body is not None and of(s.body) == of(body) for s in touches.setups]
    return np.asarray(np.array(own)[touches.setup])


def _grown(touches: Touches, strain: Array) -> Sequence[Term]:
    """Shifts of a standard that is larger by a strain (N,) per unit."""
    held = touches.fixing_table
    arm = touches.point_table - np.where(np.isnan(held), touches.T_table_artefact[:, :3, 3], held)
    return [Term(0, Where("shift", 0, i), strain * arm[:, i]) for i in range(3)]


BodyError = BodyTemperature | BodyExpansion | BodyScale  # parameters of the size of a standard

Free = SetupError | StylusError | BodyError  # parameters estimated beside the model of the machine


def setup_errors(touches: Touches) -> tuple[Free, ...]:
    """Free parameters of set-ups, further styli and the size of the standard."""
    return (*placing_errors(touches), *body_errors(touches))


def placing_errors(touches: Touches) -> tuple[SetupError | StylusError, ...]:
    """One for every set-up that was touched, and for every stylus but the first."""
    out: list[SetupError | StylusError] = []
    for index, setup in enumerate(touches.setups):
        rows = touches.setup == index
        if rows.any():
            x, y, z = touches.point_table[rows].mean(axis=0).tolist()
            out.append(SetupError(setup.name, (x, y, z), touches.instrument.reads_angle))
    return (*out, *further_styli(touches))


def body_errors(touches: Touches) -> tuple[BodyError, ...]:
    """Free parameters of the size of every standard with a stated expansion."""
    stated = [touches.setups[i] for i in np.unique(touches.setup)]
    pairs = dict.fromkeys((s.run, s.body) for s in stated if s.body is not None)
    warm = [BodyTemperature(run, body) for run, body in pairs]
    grown = {(b.alpha, b.u_alpha): BodyExpansion(b) for _, b in pairs}
    at = touches.body_temperature != T_REF
    scaled = {(b.alpha, b.u_scale): BodyScale(b) for _, b in pairs if b.u_scale}
    expanded = [one for one in grown.values() if np.any(at & one.here(touches))]
    return (*warm, *expanded, *scaled.values())


def further_styli(touches: Touches) -> tuple[StylusError, ...]:
    """Every stylus but the first that touched; of a ball on the tool axis alone."""
    if not touches.instrument.is_ball_on_standard or np.any(touches.offset):
        return ()
    pairs = zip(touches.length.tolist(), touches.radius.tolist(), strict=True)
    _, *others = dict.fromkeys(pairs)
    if len(others) > _MAX_STYLI or not np.all(touches.radius > 0.0):
        return ()
    return tuple(StylusError(length, radius) for length, radius in others)
