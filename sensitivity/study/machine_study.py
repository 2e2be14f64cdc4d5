"""The sensitivities of one machine over one workspace, computed once."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np

from matstd.sensitivity.first_order import (
    NormalLength,
    Workspace,
    covariance,
    latin_hypercube,
    normal_length,
    rms,
    section,
    sensitivity,
    variance_shares,
)
from matstd.sensitivity.montecarlo import ExactCheck, Volumetric, Workers, exact_check, volumetric
from matstd.sensitivity.population import Population
from matstd.sensitivity.shares import TotalEffects, norm_shares
from matstd.sensitivity.study.trajectory import AlongPath, Trajectory, axis_effect, paper_trajectory
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Tabular
from matstd.twin.files import reading_columns
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import UM

SECTION = 25  # values of each of the two readings of a section
_TOTAL_POSES = 300  # at which total effects are taken: their mean over a workspace needs no more
_CHECKED = (20, 60)  # machines and poses on which first order is compared with the exact product


class _Streams(NamedTuple):
    """Random numbers of a study; their order is part of its results, new ones go to the end."""

    poses: np.random.Generator
    machines: np.random.Generator
    exact_check: np.random.Generator
    total_effects: np.random.Generator


@dataclass(frozen=True, eq=False)
class Section:
    """Volumetric error over two readings, the others as in the worst pose of the study."""

    axes: tuple[str, str]  # names of the two axes
    first: Array  # values of the first reading, (n,), mm or rad
    second: Array  # values of the second one, (n,)
    q: Array  # readings, (n n, A), the second reading fastest
    volumetric: Volumetric  # statistics at these poses


@dataclass(frozen=True, eq=False)
class PathStudy:
    """Volumetric error along a trajectory."""

    trajectory: Trajectory
    volumetric: Volumetric  # statistics at its poses; the worst ones are those of the workspace
    closed: NormalLength  # the same without sampling, as if every error were normally distributed
    effects: tuple[AlongPath, ...]  # what the error motions of single axes do on the way


@dataclass(frozen=True, eq=False, repr=False)
class Study(Tabular):
    """Where errors show on a machine."""

    population: Population  # machines that were drawn from
    workspace: Workspace
    q: Array  # poses, (N, A), a Latin hypercube of the workspace
    sensitivity: Array  # s of every error parameter, (N, P), mm/mm and mm/rad
    shares: Array  # share of every parameter in the variance of the deviation, (N, P)
    rms: Array  # root mean square of the volumetric error without sampling, (N,), mm
    volumetric: Volumetric  # its statistics over random machines
    sections: tuple[Section, ...]  # the same over pairs of readings
    exact: ExactCheck  # how far first order is from the exact product
    # total effects of the errors on the length |d| at the first poses; None for errors that depend
    # on each other
    total: TotalEffects | None
    path: PathStudy | None  # volumetric error along a trajectory; None where nothing moves

    @property
    def chain(self) -> Chain:
        """The machine."""
        return self.population.chain

    @property
    def worst_pose(self) -> Array:
        """Readings of the pose with the largest root mean square, (A,)."""
        return self.q[np.argmax(self.rms)]

    @cached_property
    def closed(self) -> NormalLength:
        """The volumetric error without sampling, as if every error were normally distributed."""
        return normal_length(covariance(self.population, self.q, self.workspace.length))

    @property
    def tail(self) -> tuple[float, float]:
        """Difference of the sampled 95 % quantile from the closed one: mean and worst.

        As shares of the closed one; what is beyond the sampling error is not normal in its shape.
        """
        closed, sampled = self.closed.p95, self.volumetric.p95
        moves = closed > 0.0
        if not moves.any():
            return 0.0, 0.0
        off = sampled[moves] / closed[moves] - 1.0
        return float(off.mean()), float(off[np.argmax(np.abs(off))])

    def columns(self) -> dict[str, Array]:
        """Every pose with the statistics of the volumetric error there, as in `poses.csv`."""
        table = statistics_columns(self.volumetric, self.closed)
        return pose_columns(self.chain, self.q) | table

    def ranking(self) -> list[tuple[str, float]]:
        """Error parameters by their mean share of the variance over the workspace."""
        mean = self.shares.mean(axis=0)
        order = np.argsort(-mean, kind="stable")
        return [(self.chain.symbols[i].name, float(mean[i])) for i in order]


def run_study(
    population: Population,
    workspace: Workspace,
    poses: int | Array,
    draws: int,
    rng: np.random.Generator,
    progress: Progress = silent,
    tolerance: float = np.inf,
    digits: int = 0,
    workers: Workers = None,
) -> Study:
    """Sensitivities, shares of variance and Monte Carlo over a workspace and along a trajectory.

    Args:
        poses: Number of poses, or their readings, shape (N, A).
        draws: Number of random machines, at most so many with digits.
        tolerance: For the exceedance, mm.
        digits: Significant digits that have to be stable (JCGM 101); 0 for none.
        workers: Who draws the machines (`matstd.sensitivity.montecarlo.workers`).

    Raises:
        NotReachable: The workspace has no pose.
        DesignError: Too few draws or poses.
    """
    streams = _Streams(*rng.spawn(len(_Streams._fields)))
    length = workspace.length
    q = latin_hypercube(workspace, poses, streams.poses) if isinstance(poses, int) else poses
    spread = rms(population, q, length)
    worst = q[np.argmax(spread)]
    planes = [
        (pair, *section(workspace, *pair, SECTION, worst)) for pair in section_pairs(workspace)
    ]
    way = paper_trajectory(workspace) if workspace.open_axes else None
    # one Monte Carlo for all: sections and path share its machines and the limits of the worst 5 %
    everywhere = np.concatenate([q, *(plane[3] for plane in planes), *([way.q] if way else [])])
    found = volumetric(
        population,
        everywhere,
        length,
        draws,
        streams.machines,
        progress,
        reference=len(q),
        tolerance=tolerance,
        digits=digits,
        workers=workers,
    )
    sections = []
    start = len(q)
    for pair, first, second, q_plane in planes:
        rows = slice(start, start + len(q_plane))
        sections.append(
            Section(axes=pair, first=first, second=second, q=q_plane, volumetric=found[rows])
        )
        start = rows.stop
    machines, checked = _CHECKED
    return Study(
        population=population,
        workspace=workspace,
        q=q,
        sensitivity=sensitivity(population.chain, q, length),
        shares=variance_shares(population, q, length),
        rms=spread,
        volumetric=found[slice(0, len(q))],
        sections=tuple(sections),
        exact=exact_check(population, q[:checked], length, machines, streams.exact_check),
        total=None
        if population.dependence
        else norm_shares(population, q[:_TOTAL_POSES], length, streams.total_effects),
        path=_along(population, way, found[slice(start, None)]) if way else None,
    )


def _along(population: Population, way: Trajectory, found: Volumetric) -> PathStudy:
    """What random machines and single axes do along a trajectory."""
    closed = normal_length(covariance(population, way.q, way.length))
    span = dict(zip(way.chain.axes, np.ptp(way.q, axis=0), strict=True))
    linear = [a for a in way.moving if a in way.chain.linear_axes]
    rotary = sorted((a for a in way.moving if a in way.chain.rotary_axes), key=lambda a: -span[a])
    effects = tuple(axis_effect(way, axis) for axis in (*linear[:1], *rotary[:1]))
    return PathStudy(way, found, closed, effects)


def section_pairs(workspace: Workspace) -> list[tuple[str, str]]:
    """Pairs of readings to show: every pair of linear axes, the rotary ones, at most six in all."""
    chain = workspace.chain
    free = workspace.open_axes
    linear = sorted(a for a in free if a in chain.linear_axes)
    rotary = sorted(a for a in free if a in chain.rotary_axes)
    pairs = list(combinations(linear[:3], 2)) + list(combinations(rotary[:3], 2))
    if len(rotary) == 1:
        pairs += [(a, rotary[0]) for a in linear[:3]]
    return pairs[:6]


def pose_columns(chain: Chain, q: Array) -> dict[str, Array]:
    """Readings (N, A) of the programmed axes."""
    return {
        column: q[:, chain.axis_index(axis)] / factor
        for axis, (column, factor) in reading_columns(chain).items()
        if chain.link(axis).programmed
    }


def statistics_columns(v: Volumetric, closed: NormalLength) -> dict[str, Array]:
    """Statistics of the volumetric error with their standard errors by sampling."""
    each = {"mean": v.mean, "mean_u": v.mean_u, "sd": v.sd, "rms": closed.rms}
    each["p95_normal"] = closed.p95
    for i, level in enumerate(v.levels):
        each[f"p{100 * level:g}"] = v.quantile[i]
        each[f"p{100 * level:g}_u"] = v.quantile_u[i]
    table = {f"{name}_um": value / UM for name, value in each.items()}
    table |= {"recurrence": v.recurrence, "recurrence_u": v.recurrence_u}
    if np.isfinite(v.tolerance):
        table |= {"exceedance": v.exceedance, "exceedance_u": v.exceedance_u}
    return table
