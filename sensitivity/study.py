"""The sensitivities of one machine over one workspace: computed once, written as data and maps."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

import numpy as np

from sensitivity.blocks import Progress, silent
from sensitivity.exact import ExactCheck, exact_check
from sensitivity.indices import covariance, rms, variance_shares
from sensitivity.jacobian import sensitivity
from sensitivity.montecarlo import Volumetric, volumetric
from sensitivity.normal_length import NormalLength, normal_length
from sensitivity.sampling import Population
from sensitivity.workspace import Workspace, latin_hypercube, section
from twin.chain import Chain
from twin.files.pose_file import reading_columns
from twin.files.whole import write_whole, written_whole
from twin.frames import Array
from twin.units import UM, URAD

SECTION = 25
"""Values of each of the two readings of a section."""

_CHECKED = (20, 60)  # machines and poses on which first order is compared with the exact product


@dataclass(frozen=True, eq=False)
class Section:
    """Volumetric error over two readings, the others as in the worst pose of the study.

    Attributes:
        axes: Names of the two axes.
        first: Values of the first reading, (n,), mm or rad.
        second: Values of the second one, (n,).
        q: Readings, (n n, A), the second reading fastest.
        volumetric: Statistics at these poses.
    """

    axes: tuple[str, str]
    first: Array
    second: Array
    q: Array
    volumetric: Volumetric


@dataclass(frozen=True, eq=False)
class Study:
    """Where errors show on a machine.

    Attributes:
        population: Machines that were drawn from.
        workspace: Where was looked.
        q: Poses, (N, A), a Latin hypercube of the workspace.
        sensitivity: S of every error parameter, (N, P), mm/mm and mm/rad.
        shares: Share of every parameter in the variance of the deviation, (N, P).
        rms: Root mean square of the volumetric error without sampling, (N,), mm.
        volumetric: Its statistics over random machines.
        sections: The same over pairs of readings.
        exact: How far first order is from the exact product.
    """

    population: Population
    workspace: Workspace
    q: Array
    sensitivity: Array
    shares: Array
    rms: Array
    volumetric: Volumetric
    sections: tuple[Section, ...]
    exact: ExactCheck

    @property
    def chain(self) -> Chain:
        """The machine."""
        return self.population.chain

    @property
    def worst_pose(self) -> Array:
        """Readings of the pose with the largest root mean square, (A,)."""
        worst: Array = self.q[np.argmax(self.rms)]
        return worst

    @cached_property
    def closed(self) -> NormalLength:
        """The volumetric error without sampling, as if every error were normally distributed."""
        return normal_length(covariance(self.population, self.q, self.workspace.length))

    @property
    def tail(self) -> tuple[float, float]:
        """By how much the sampled 95 % quantile differs from the closed one: mean and worst.

        As shares of the closed one; what is beyond the sampling error is not normal in its shape.
        """
        closed, sampled = self.closed.p95, self.volumetric.p95
        seen = closed > 0.0
        if not seen.any():
            return 0.0, 0.0
        off = sampled[seen] / closed[seen] - 1.0
        return float(off.mean()), float(off[np.argmax(np.abs(off))])

    def ranking(self) -> list[tuple[str, float]]:
        """Error parameters by their mean share of the variance over the workspace."""
        mean = self.shares.mean(axis=0)
        order = np.argsort(-mean, kind="stable")
        return [(self.chain.symbols[i].name, float(mean[i])) for i in order]


def run_study(
    population: Population,
    workspace: Workspace,
    poses: int,
    draws: int,
    rng: np.random.Generator,
    progress: Progress = silent,
) -> Study:
    """Sensitivities, shares of variance and Monte Carlo over a workspace.

    Args:
        population: Machines to draw from.
        workspace: Where to look.
        poses: Number of poses.
        draws: Number of random machines.
        rng: Source of the random numbers.
        progress: Told what is being done.

    Raises:
        NotReachable: The workspace has no pose.
        DesignError: Too few draws or poses.
    """
    rng_poses, rng_draws, rng_check = rng.spawn(3)
    length = workspace.length
    q = latin_hypercube(workspace, poses, rng_poses)
    spread = rms(population, q, length)
    worst = q[np.argmax(spread)]
    planes = [
        (pair, *section(workspace, *pair, SECTION, worst)) for pair in section_pairs(workspace)
    ]
    everywhere = np.concatenate([q, *(plane[3] for plane in planes)])
    found = volumetric(population, everywhere, length, draws, rng_draws, progress, reference=len(q))
    sections = []
    start = len(q)
    for pair, first, second, q_plane in planes:
        rows = slice(start, start + len(q_plane))
        sections.append(Section(pair, first, second, q_plane, found[rows]))
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
        exact=exact_check(population, q[:checked], length, machines, rng_check),
    )


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


def write_study(study: Study, folder: str | Path) -> None:
    """Write the data of a study into a folder; `sensitivity.maps.draw_maps` draws it.

    `poses.csv` (readings and statistics of the volumetric error with their standard errors by
    sampling), `sensitivity.csv` (S a column a parameter), `shares.csv` and `sections.npz`.

    Args:
        study: The study.
        folder: Made where it does not exist; files in it are replaced.
    """
    folder = Path(folder)
    columns = reading_columns(study.chain)
    readings = {
        column: study.q[:, study.chain.axis_index(axis)] / factor
        for axis, (column, factor) in columns.items()
        if study.chain.link(axis).programmed
    }
    v = study.volumetric
    statistics = {"mean": v.mean, "mean_u": v.mean_u, "sd": v.sd, "rms": study.rms}
    statistics["p95_normal"] = study.closed.p95
    for i, level in enumerate(v.levels):
        statistics[f"p{100 * level:g}"] = v.quantile[i]
        statistics[f"p{100 * level:g}_u"] = v.quantile_u[i]
    table = readings | {f"{name}_um": value / UM for name, value in statistics.items()}
    table |= {"recurrence": v.recurrence, "recurrence_u": v.recurrence_u}
    write_whole(folder / "poses.csv", csv_text(table))
    symbols = study.chain.symbols
    unit = [URAD / UM if s.is_angular else 1.0 for s in symbols]
    S = {s.name: study.sensitivity[:, i] * unit[i] for i, s in enumerate(symbols)}
    write_whole(folder / "sensitivity.csv", csv_text(readings | S))
    shares = {s.name: study.shares[:, i] for i, s in enumerate(symbols)}
    write_whole(folder / "shares.csv", csv_text(readings | shares))
    _write_sections(study, folder / "sections.npz")


def _write_sections(study: Study, path: Path) -> None:
    """Sections as arrays: readings in mm and rad, deviations in mm."""
    arrays: dict[str, Array] = {}
    for s in study.sections:
        n = len(s.first)
        name = "".join(s.axes)
        arrays |= {
            f"{name}_first": s.first,
            f"{name}_second": s.second,
            f"{name}_mean": s.volumetric.mean.reshape(n, n),
            f"{name}_p95": s.volumetric.p95.reshape(n, n),
            f"{name}_recurrence": s.volumetric.recurrence.reshape(n, n),
        }
    with written_whole(path) as part, part.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)


def csv_text(table: dict[str, Array]) -> str:
    """Columns of numbers as CSV with seven digits."""
    rows = np.stack(list(table.values()), axis=1)
    lines = [",".join(table)] + [",".join(f"{v:.7g}" for v in row) for row in rows]
    return "\n".join(lines) + "\n"
