"""What touches on a standard are worth: how well the tool point can be predicted after them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from artefact.potential import Potential, potential
from artefact.sites import Frame
from artefact.touchable import Probing, Requests
from sensitivity.blocks import blocks
from sensitivity.information import whitened
from sensitivity.purpose import (
    Purpose,
    determinant,
    parameters,
    purpose,
    robust,
    with_potential,
    without_potential,
    worst_pattern,
    worst_pose,
)
from sensitivity.sampling import Population
from sensitivity.scales import drawn_scales
from sensitivity.workspace import Box, Workspace, latin_hypercube
from twin.errors import DesignError, NotReachable
from twin.frames import Array, apply
from twin.model import Model
from twin.symbols import Family
from twin.touches import at_poses
from twin.units import DEG

SETUP_SD = (1.0, 5e-3)
"""How far the standard may stand from where it is believed to stand, mm and rad. It is never known,
so the set-up of the workpiece is free and the tool point is predicted relative to the standard."""

CRITERIA = {
    "I": "mean variance of the predicted tool point over probed volume and workspace",
    "G": "largest variance of the predicted tool point at any pose of probed volume and workspace",
    "D": "volume of what stays unknown of the parameters, in units of what is expected",
    "A": "mean variance of the parameters, in units of what is expected",
    "E": "variance of the error pattern that is known worst, as the tool point feels it",
}
"""What touches can be chosen for."""

_POSES = 400  # over which predictions are judged, in the probed volume and as many of the user's
_SCATTER = 3000  # random touches that span all that touches can show
_ROWS_A_BLOCK = 4000


@dataclass(frozen=True, eq=False)
class Criterion:
    """Worth of touches on a machine.

    Attributes:
        probing: Machine, probe, set-up.
        model: Errors that are expected.
        prior_sd: Their standard deviations with the set-up free, (P,).
        noise: Standard deviation of one touch, mm.
        rotary: Smallest and largest reading of every rotary axis, (R, 2), rad.
        volume: Box that the standard fills, artefact frame, mm.
        tip_volume: Deviation of the tip per unit of every parameter at poses over the probed
            volume, (M, 3, P).
        tip_user: The same at poses over the user's workspace, (M, 3, P).
        purposes: What touches can be chosen for, by the names in `CRITERIA`.
        name: The one that they are chosen for.
        potential: Effects that may be there or not, which touches shall show; None for none.
    """

    probing: Probing
    model: Model
    prior_sd: Array
    noise: float
    rotary: Array
    volume: Box
    tip_volume: Array
    tip_user: Array
    purposes: Mapping[str, Purpose]
    name: str = "I"
    potential: Potential | None = None

    @property
    def purpose(self) -> Purpose:
        """What touches are chosen for."""
        return self.purposes[self.name]

    @property
    def plain(self) -> "Criterion":
        """The same criterion without potential terms, for choices that do not hang on them."""
        if self.potential is None:
            return self
        plain = {name: without_potential(aim) for name, aim in self.purposes.items()}
        return replace(self, purposes=plain, potential=None)

    def whitened(self, wanted: Requests) -> Array:
        """Rows of touches in units of noise and prior, (N, P)."""
        out = np.empty((len(wanted), len(self.prior_sd)))
        for rows in blocks(len(wanted), _ROWS_A_BLOCK):
            columns = self.model.columns(self.probing.touches(wanted[rows]))
            out[rows] = whitened(columns, self.prior_sd, self.noise)
        return out

    def rows(self, wanted: Requests) -> Array:
        """Rows of touches in the directions that matter and in the potential terms, (N, R).

        The same for every purpose.
        """
        reduced = self.purpose.rows(self.whitened(wanted))
        if self.potential is None:
            return reduced
        parts = [
            self.potential.rows(self.probing.touches(wanted[rows]), reduced[rows])
            for rows in blocks(len(wanted), _ROWS_A_BLOCK)
        ]
        return np.concatenate([reduced, np.concatenate(parts)], axis=1)


@dataclass(frozen=True)
class Wishes:
    """What a criterion shall be beside its name.

    Attributes:
        potential: Share of the criterion that goes to showing effects of the library, from 0 (they
            are left out) to below 1, judged after touches taken at random. In a D-criterion they
            simply join the determinant, whatever the share.
        touches: Number of touches that will be chosen.
        draws: Number of drawn machines over whose sizes of errors the criterion is averaged; 0 for
            the expected sizes alone.
        tail: Share of the drawn machines, the worst, that are averaged; 1 for all.
    """

    potential: float = 0.0
    touches: int = 480
    draws: int = 0
    tail: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.potential < 1.0:
            raise DesignError(f"potential {self.potential:g}, expected from 0 to below 1")
        if self.draws < 0:
            raise DesignError(f"draws {self.draws}, expected 0 or more")


def criterion(
    probing: Probing,
    model: Model,
    frame: Frame,
    workspace: Workspace,
    noise: float,
    rng: np.random.Generator,
    name: str = "I",
    wishes: Wishes | None = None,
    population: Population | None = None,
) -> Criterion:
    """Criterion of a machine, a blank and a user's workspace.

    Args:
        probing: Machine, probe, set-up.
        model: Errors that are expected, with their prior standard deviations.
        frame: Blank of the standard: it bounds the probed volume.
        workspace: Where the user works; the limits of its rotary axes are those of table poses.
        noise: Standard deviation of one touch, mm.
        rng: Draws the poses.
        name: One of `CRITERIA`.
        wishes: Potential terms and drawn machines; None for neither.
        population: From which machines are drawn, that of the model; None for the default one.

    Raises:
        DesignError: Another name.
    """
    if name not in CRITERIA:
        raise DesignError(f"criterion '{name}', expected one of {', '.join(CRITERIA)}")
    wishes = wishes or Wishes()
    volume = _probed_volume(frame)
    rotary = np.array([workspace.limit(n) for n in probing.chain.rotary_axes]).reshape(-1, 2)
    tips = _tips(probing, model, volume, workspace, rng)
    prior_sd = _with_free_setup(model)
    scatter = random_touches(probing, volume, rotary, _SCATTER, rng)
    touches = probing.touches(scatter)
    W = whitened(model.columns(touches), prior_sd, noise)
    G = np.concatenate(tips)
    aim = purpose(G, W, prior_sd)
    if wishes.draws:
        aim = robust(aim, _scales(probing, model, population, wishes.draws, rng), wishes.tail)
    purposes = {
        "I": aim,
        "G": worst_pose(aim, G, prior_sd),
        "D": determinant(aim),
        "A": parameters(aim),
        "E": worst_pattern(aim),
    }
    terms = None
    if wishes.potential > 0.0:
        reduced = aim.rows(W)
        terms = potential(touches, reduced, wishes.touches)
        rows = np.concatenate([reduced, terms.rows(touches, reduced)], axis=1)[: wishes.touches]
        purposes = {
            key: _sharing(one, rows, len(terms), wishes.potential) for key, one in purposes.items()
        }
    return Criterion(
        probing=probing,
        model=model,
        prior_sd=prior_sd,
        noise=noise,
        rotary=rotary,
        volume=volume,
        tip_volume=tips[0],
        tip_user=tips[1],
        purposes=purposes,
        name=name,
        potential=terms,
    )


def _sharing(aim: Purpose, rows: Array, count: int, share: float) -> Purpose:
    """A purpose of which potential terms have some share after touches taken at random."""
    R = len(aim.K)
    if aim.is_determinant:
        return with_potential(aim, count, 0.0)
    value = aim.value(rows[:, :R].T @ rows[:, :R])
    M = np.eye(R + count) + rows.T @ rows
    hidden = float(np.trace(np.linalg.solve(M, np.eye(R + count))[R:, R:])) / count
    return with_potential(aim, count, share / (1.0 - share) * value / hidden)


def _scales(
    probing: Probing,
    model: Model,
    population: Population | None,
    draws: int,
    rng: np.random.Generator,
) -> Array:
    """Sizes of the errors of drawn machines over the expected ones, (S, P); the set-up stays free.

    Raises:
        DesignError: The model is not that of the population.
    """
    population = population or Population(probing.chain)
    if not set(model.names) <= set(population.model.names):
        raise DesignError("machines can be drawn for the errors of a population alone")
    scale = drawn_scales(population, draws, rng, model)
    scale[:, _is_setup(model)] = 1.0
    return scale


def _probed_volume(frame: Frame) -> Box:
    """Box that the standard fills, artefact frame, mm."""
    half, top = frame.base.half_size, frame.blank_height
    return (
        (-0.8 * half[0], -0.8 * half[1], frame.base.thickness),
        (0.8 * half[0], 0.8 * half[1], 0.7 * top),
    )


def _tips(
    probing: Probing, model: Model, volume: Box, workspace: Workspace, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Deviation of the tip per unit of every parameter: probed volume, user's workspace."""
    chain = probing.chain
    limits = {name: workspace.limit(name) for name in chain.rotary_axes}
    on_table = apply(
        probing.setup.T_table_artefact, np.array(list(product(*zip(*volume, strict=True))))
    )
    corners = np.array([on_table.min(axis=0), on_table.max(axis=0)])
    box: Box = (tuple(corners[0]), tuple(corners[1]))
    probed = Workspace(chain, limits, probing.length, box)
    tips = []
    for area, length in ((probed, probing.length), (workspace, workspace.length)):
        q = latin_hypercube(area, _POSES, rng)
        tips.append(model.tip_columns(at_poses(chain, q, length)))
    return tips[0], tips[1]


def _is_setup(model: Model) -> NDArray[np.bool_]:
    """Parameters of the workpiece's set-up, (P,)."""
    symbols = [getattr(effect, "symbol", None) for effect, _ in model.parameters]
    return np.array(
        [s is not None and s.family is Family.SETUP and s.link == "w" for s in symbols], dtype=bool
    )


def _with_free_setup(model: Model) -> Array:
    """Prior standard deviations with the set-up of the workpiece as good as unknown."""
    prior_sd = model.prior_sd.copy()
    for i in np.flatnonzero(_is_setup(model)):
        prior_sd[i] = SETUP_SD[int(model.parameters[i][1].unit == "rad")]
    return prior_sd


def random_touches(
    probing: Probing, volume: Box, rotary: Array, count: int, rng: np.random.Generator
) -> Requests:
    """Touches with random points in a box and random normals, at random poses, all reachable.

    Args:
        probing: Machine, probe, set-up.
        volume: Box in the artefact frame, mm.
        rotary: Limits of every rotary axis (R, 2), from which readings are drawn evenly, rad.
        count: Number of touches; fewer where the machine reaches fewer.
        rng: Source of the random numbers.

    Raises:
        NotReachable: The machine reaches none.
    """
    low, high = np.array(volume)
    tries = 6 * count
    normal = rng.normal(size=(tries, 3))
    wanted = Requests(
        feature=np.full(tries, "scatter"),
        point=rng.uniform(low, high, (tries, 3)),
        normal=normal / np.linalg.norm(normal, axis=1, keepdims=True),
        rotary=rng.uniform(rotary[:, 0], rotary[:, 1], (tries, len(rotary))),
    )
    reached = np.flatnonzero(probing.is_reachable(wanted))[:count]
    if not len(reached):
        raise NotReachable(
            f"none of {tries} random touches looks within {probing.steepest / DEG:.1f} degrees of "
            "the tool axis with every axis within its travel"
        )
    return wanted[reached]
