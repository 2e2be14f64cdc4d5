"""What touches on a standard are worth: how well the tool point can be predicted after them.

A touch is a row: what every expected error does to the deviation along its normal, in units of the
touch's noise and of the error's own expected size. After touches with rows W the parameters have
the covariance ``(1 + W^T W)^-1`` in those units, and the tool point at a pose has that of its own
rows. A criterion condenses it into one number over many poses of the probed volume and of the
user's workspace. The workpiece's set-up is a free parameter like any other: it is not known where
exactly the standard stands, and what is predicted is the tool relative to the workpiece.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.layout import Blank
from matstd.artefact.reach import ProbeReach, Requests
from matstd.artefact.worth.calibration import Calibration
from matstd.artefact.worth.potential import Potential, potential
from matstd.information.criteria import (
    DesignCriterion,
    Posterior,
    five_criteria,
    robust,
    whitened,
    with_potential,
)
from matstd.sensitivity.first_order import Box, Workspace, latin_hypercube
from matstd.sensitivity.population import Population, drawn_scales
from matstd.twin.compute import blocks
from matstd.twin.errors import DesignError, NotReachable
from matstd.twin.frames import Array, IntArray, apply, unit
from matstd.twin.machine import Family
from matstd.twin.model import Model, traits
from matstd.twin.record import Touches, at_poses
from matstd.twin.units import DEG

SETUP_SD = (1.0, 5e-3)
"""How far the standard may stand from where it is believed to stand, mm and rad. It is never known,
so the set-up of the workpiece is free and the tool point is predicted relative to the standard."""

CRITERIA = ("I", "G", "D", "A", "E")
"""What touches can be chosen for, by the letters of optimal design."""

_POSES = 400  # over which predictions are judged, in the probed volume and as many of the user's
_SPANNING_TOUCHES = 3000  # random touches that span all that touches can show
_ROWS_A_BLOCK = 4000  # of 71 columns: 2 MiB, held beside what is made of them


@dataclass(frozen=True, eq=False)
class Criterion:
    """Worth of touches on a machine."""

    reach: ProbeReach
    model: Model
    prior_sd: Array  # their standard deviations with the set-up free, (P,)
    noise: float  # standard deviation of one touch, mm
    rotary: Array  # smallest and largest reading of every rotary axis, (R, 2), rad
    volume: Box  # box that the standard fills, artefact frame, mm
    at_volume: Touches  # poses over the probed volume, M of them
    tip_volume: Array  # deviation of the tip per unit of every parameter at them, (M, 3, P)
    tip_user: Array  # the same at poses over the user's workspace, (M, 3, P)
    # what touches can be chosen for, by the names in `CRITERIA`
    objectives: Mapping[str, DesignCriterion]
    name: str = "I"
    # effects that may be there or not, which touches shall show; None for none
    potential: Potential | None = None
    calibration: Calibration = field(default_factory=Calibration)
    # whose features they are; None while there is none, so that none is uncertain
    body: Standard | None = None

    @property
    def objective(self) -> DesignCriterion:
        """What touches are chosen for."""
        return self.objectives[self.name]

    @property
    def plain(self) -> "Criterion":
        """The same criterion without potential terms, for choices that do not hang on them.

        Asked before `on`, which adds the columns of a body.
        """
        if self.potential is None:
            return self
        assert self.body is None
        plain = {name: one.primary or one for name, one in self.objectives.items()}
        return replace(self, objectives=plain, potential=None)

    def on(self, body: Standard) -> "Criterion":
        """The same criterion for touches on a body whose features are known by calibration."""
        assert self.body is None
        count = self.calibration.columns(body, _no_touches(self.reach)).shape[1]
        if not count:
            return replace(self, body=body)
        objectives = {key: with_potential(one, count, 0.0) for key, one in self.objectives.items()}
        return replace(self, objectives=objectives, body=body)

    def calibrated(self, wanted: Requests) -> Array:
        """Columns of the features' places in units of the touches' noise, (N, Q)."""
        if self.body is None:
            return np.zeros((len(wanted), 0))
        return self.calibration.columns(self.body, wanted) / self.noise

    def known_rows(self, wanted: Requests) -> Array:
        """Rows (N, P) in which the features' places are averaged over, and not known.

        The deviations of touches on one feature are correlated, ``1 + C C^T`` in units of the
        noise; rows multiplied by the inverse of its Cholesky factor are as good as independent.
        """
        W, C = self.whitened(wanted), self.calibrated(wanted)
        factor = np.linalg.cholesky(np.eye(len(W)) + C @ C.T)
        return np.asarray(np.linalg.solve(factor, W), dtype=np.float64)

    def after(self, wanted: Requests) -> Posterior:
        """What is known of the machine after touches, with the features' places averaged over."""
        return Posterior(self.known_rows(wanted), self.prior_sd, self.model.names)

    def whitened(self, wanted: Requests) -> Array:
        """Rows of touches in units of noise and prior, (N, P)."""
        out = np.empty((len(wanted), len(self.prior_sd)))
        for rows in blocks(len(wanted), _ROWS_A_BLOCK):
            columns = self.model.columns(self.reach.touches(wanted[rows]))
            out[rows] = whitened(columns, self.prior_sd, self.noise)
        return out

    def rows(self, wanted: Requests) -> Array:
        """Rows of touches in the directions that matter, the potential terms, the features' places.

        Shape (N, R), the same for every objective.
        """
        reduced = self.objective.rows(self.whitened(wanted))
        columns = [reduced]
        if self.potential is not None:
            parts = [
                self.potential.rows(self.reach.touches(wanted[rows]), reduced[rows])
                for rows in blocks(len(wanted), _ROWS_A_BLOCK)
            ]
            columns.append(np.concatenate(parts))
        return np.concatenate([*columns, self.calibrated(wanted)], axis=1)


@dataclass(frozen=True)
class CriterionOptions:
    """What touches are chosen for."""

    name: str = "I"  # one of `CRITERIA`
    # share of the criterion that goes to showing effects of the library, from 0 (they are left out)
    # to below 1, judged after touches taken at random. In a D-criterion they simply join the
    # determinant, whatever the share
    potential: float = 0.0
    # number of drawn machines over whose sizes of errors the criterion is averaged; 0 for the
    # expected sizes alone
    robust_machines: int = 0
    # share of the drawn machines, the worst, that are averaged; 1 for all
    robust_share: float = 1.0
    # how well the features of a standard are known
    calibration: Calibration = field(default_factory=Calibration)

    def __post_init__(self) -> None:
        if self.name not in CRITERIA:
            raise DesignError(f"criterion '{self.name}', expected one of {', '.join(CRITERIA)}")
        if not 0.0 <= self.potential < 1.0:
            raise DesignError(f"potential {self.potential:g}, expected from 0 to below 1")
        if self.robust_machines < 0:
            raise DesignError(f"drawn machines {self.robust_machines}, expected 0 or more")


def criterion_for(
    reach: ProbeReach,
    model: Model,
    blank: Blank,
    workspace: Workspace,
    noise: float,
    rng: np.random.Generator,
    options: CriterionOptions,
    touches: int,
    population: Population,
) -> Criterion:
    """Criterion of a machine, a blank and a user's workspace.

    Args:
        model: Errors that are expected, with their prior standard deviations.
        blank: Blank of the standard: it bounds the probed volume.
        workspace: Where the user works; the limits of its rotary axes are those of table poses.
        noise: Standard deviation of one touch, mm.
        options: What touches are chosen for.
        touches: Number of touches after which potential terms are judged.
        population: From which machines are drawn, that of the model.
    """
    volume = _probed_volume(blank)
    rotary = np.array([workspace.limit(n) for n in reach.chain.rotary_axes]).reshape(-1, 2)
    at = _poses_to_judge(reach, volume, workspace, rng)
    tips = [model.tip_columns(poses) for poses in at]
    prior_sd = _with_free_setup(model)
    # touches all over the probed volume stand for those of a standard that does not exist yet
    scatter = random_touches(reach, volume, rotary, _SPANNING_TOUCHES, rng)
    free = reach.touches(scatter)
    W = whitened(model.columns(free), prior_sd, noise)
    G = np.concatenate(tips)
    objectives = five_criteria(G, W, prior_sd)
    if options.robust_machines:
        scales = _drawn_error_scales(reach, model, population, options.robust_machines, rng)
        objectives = {
            key: robust(one, scales, options.robust_share) for key, one in objectives.items()
        }
    terms = None
    if options.potential > 0.0:
        reduced = objectives[options.name].rows(W)
        terms = potential(free, reduced, touches)
        rows = np.concatenate([reduced, terms.rows(free, reduced)], axis=1)[:touches]
        objectives = {
            key: _with_potential_share(one, rows, len(terms), options.potential)
            for key, one in objectives.items()
        }
    return Criterion(
        reach=reach,
        model=model,
        prior_sd=prior_sd,
        noise=noise,
        rotary=rotary,
        volume=volume,
        at_volume=at[0],
        tip_volume=tips[0],
        tip_user=tips[1],
        objectives=objectives,
        name=options.name,
        potential=terms,
        calibration=options.calibration,
    )


def _no_touches(reach: ProbeReach) -> Requests:
    """No touches."""
    rotary = np.zeros((0, len(reach.chain.rotary_axes)))
    return Requests(np.zeros(0, dtype=np.str_), np.zeros((0, 3)), np.zeros((0, 3)), rotary)


def _with_potential_share(
    objective: DesignCriterion, rows: Array, count: int, share: float
) -> DesignCriterion:
    """An objective of which potential terms have some share after touches taken at random."""
    R = objective.size
    value = objective.value(rows[:, :R].T @ rows[:, :R])
    M = np.eye(R + count) + rows.T @ rows
    hidden = float(np.trace(np.linalg.solve(M, np.eye(R + count))[R:, R:])) / count
    return with_potential(objective, count, share / (1.0 - share) * value / hidden)


def _drawn_error_scales(
    reach: ProbeReach, model: Model, population: Population, draws: int, rng: np.random.Generator
) -> Array:
    """Sizes of the errors of drawn machines over the expected ones, (S, P); the set-up stays free.

    Raises:
        DesignError: The model is not that of the population.
    """
    if not set(model.names) <= set(population.model.names):
        raise DesignError("machines can be drawn for the errors of a population alone")
    scale = drawn_scales(population, draws, rng, model)
    scale[:, setup_parameters(model, "w")] = 1.0
    return scale


def _probed_volume(blank: Blank) -> Box:
    """Box that the standard fills, artefact frame, mm."""
    half, top = blank.base.half_size, blank.height
    return (
        (-0.8 * half[0], -0.8 * half[1], blank.base.thickness),
        (0.8 * half[0], 0.8 * half[1], 0.7 * top),
    )


def _poses_to_judge(
    reach: ProbeReach, volume: Box, workspace: Workspace, rng: np.random.Generator
) -> list[Touches]:
    """Poses over the probed volume and over the user's workspace."""
    chain = reach.chain
    limits = {name: workspace.limit(name) for name in chain.rotary_axes}
    on_table = apply(
        reach.setup.T_table_artefact, np.array(list(product(*zip(*volume, strict=True))))
    )
    corners = np.array([on_table.min(axis=0), on_table.max(axis=0)])
    box: Box = (tuple(corners[0]), tuple(corners[1]))
    probed = Workspace(chain, limits, reach.length, box)
    return [
        at_poses(chain, latin_hypercube(area, _POSES, rng), area.length)
        for area in (probed, workspace)
    ]


def setup_parameters(model: Model, links: str = "wt") -> IntArray:
    """Parameters of the set-up of the workpiece (w), the tool (t) or both."""
    symbols = [traits(effect).symbol for effect, _ in model.parameters]
    mine = [s is not None and s.family is Family.SETUP and s.link in links for s in symbols]
    return np.flatnonzero(mine)


def _with_free_setup(model: Model) -> Array:
    """Prior standard deviations with the set-up of the workpiece as good as unknown."""
    prior_sd = model.prior_sd.copy()
    for i in setup_parameters(model, "w"):
        prior_sd[i] = SETUP_SD[int(model.parameters[i][1].unit == "rad")]
    return prior_sd


def random_touches(
    reach: ProbeReach, volume: Box, rotary: Array, count: int, rng: np.random.Generator
) -> Requests:
    """Touches with random points in a box and random normals, at random poses, all reachable.

    Args:
        volume: Box in the artefact frame, mm.
        rotary: Limits of every rotary axis (R, 2), from which readings are drawn evenly, rad.
        count: Number of touches; fewer where the machine reaches fewer.

    Raises:
        NotReachable: The machine reaches none.
    """
    low, high = np.array(volume)
    tries = 6 * count
    normal = rng.normal(size=(tries, 3))
    wanted = Requests(
        feature=np.full(tries, "scatter"),
        point=rng.uniform(low, high, (tries, 3)),
        normal=unit(normal),
        rotary=rng.uniform(rotary[:, 0], rotary[:, 1], (tries, len(rotary))),
    )
    reached = np.flatnonzero(reach.is_reachable(wanted))[:count]
    if not len(reached):
        raise NotReachable(
            f"none of {tries} random touches looks within {reach.steepest / DEG:.1f} degrees of "
            "the tool axis with every axis within its travel"
        )
    return wanted[reached]
