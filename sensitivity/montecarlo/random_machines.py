"""Volumetric error of many random machines at many poses, and how exact first order is."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from matstd.sensitivity.first_order import rms
from matstd.sensitivity.montecarlo.lengths import BINS, Lengths, count_lengths
from matstd.sensitivity.montecarlo.stability import Stabiliser
from matstd.sensitivity.montecarlo.tally import QUANTILES, Tally, Volumetric, moments, quantiles
from matstd.sensitivity.montecarlo.workers import Workers, in_order
from matstd.sensitivity.population import DRAWS_A_CHILD, Population, coefficients, draw
from matstd.twin.compute import Progress, blocks, silent
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.model import Model
from matstd.twin.numbers import rms_length
from matstd.twin.record import at_poses

MACHINES_A_BATCH = 20 * DRAWS_A_CHILD
"""10 240: JCGM 101, 7.9.4 b) requires 10 000 trials for a coverage probability of 99 %."""
_SPAN = 5.0
"""The histogram of |d| at a pose reaches to this multiple of its root mean square. A sum of many
independent errors exceeds it in less than one case of a million, and then sits in the last bin."""
_MIN_SCALE = 1e-12  # mm: scale of the histogram where no machine has an error

WORST_SHARE = 0.05  # share of the poses that counts as the worst ones of a machine


class Batch(NamedTuple):
    """Random machines to be drawn, 512 from each generator."""

    children: tuple[np.random.Generator, ...]
    machines: int


class SharedArrays(NamedTuple):
    """Data that all batches share; made once per process."""

    population: Population  # what to draw from
    G: Array  # deviation of the tip per unit of every parameter, (N, 3, K), mm
    width: Array  # of a bin of the histogram at every pose, (N,), mm
    tolerance: float  # mm
    # number of first poses among which the worst are searched, and how many count as worst
    worst: tuple[int, int]
    threads: int | None  # of one batch; None for one a core


def bin_width(rms: Array) -> Array:
    """Width of a bin of the histogram for a root mean square of |d|, (N,), mm."""
    return np.maximum(rms, _MIN_SCALE) * (_SPAN / BINS)


def batches(count: int, rng: np.random.Generator) -> Iterator[Batch]:
    """Cut machines into batches; the children of `rng` are spawned as the batches are asked for."""
    for lot in blocks(count, MACHINES_A_BATCH):
        machines = lot.stop - lot.start
        yield Batch(tuple(rng.spawn(-(-machines // DRAWS_A_CHILD))), machines)


def count_batch(shared: SharedArrays, batch: Batch) -> Lengths:
    """Draw the machines of a batch and count the lengths of their deviations at all poses."""
    lots, left = [], batch.machines
    for child in batch.children:
        machines = draw(shared.population, min(DRAWS_A_CHILD, left), child)
        lots.append(coefficients(shared.population, machines))
        left -= len(machines)
    theta = np.concatenate(lots).T
    return count_lengths(
        shared.G, theta, shared.width, shared.tolerance, shared.worst, threads=shared.threads
    )


def first_order(model: Model, q: Array, length: Array | float) -> Array:
    """Deviation of the tip per unit of every parameter, (N, 3, K), in blocks."""
    length = np.broadcast_to(np.asarray(length, dtype=float), (len(q),))
    G = np.empty((len(q), 3, len(model.parameters)))
    for rows in blocks(len(q), 1000):
        G[rows] = model.tip_columns(at_poses(model.chain, q[rows], length[rows]))
    return G


def seed_words(rng: np.random.Generator) -> str:
    """Seed of a generator and the path of its children: `600/1.0` is child 0 of child 1 of 600.

    Children that it has spawned already, and their number, follow after a plus.

    Example:
        >>> seed_words(np.random.default_rng(600).spawn(2)[1])
        '600/1'
    """
    source = rng.bit_generator.seed_seq
    assert isinstance(source, np.random.SeedSequence)
    words = str(source.entropy)
    if source.spawn_key:
        words += "/" + ".".join(str(k) for k in source.spawn_key)
    return words + (f"+{source.n_children_spawned}" if source.n_children_spawned else "")


def volumetric(
    population: Population,
    q: Array,
    length: Array | float,
    draws: int,
    rng: np.random.Generator,
    progress: Progress = silent,
    reference: int | None = None,
    tolerance: float = np.inf,
    precision: float = 0.0,
    digits: int = 0,
    recurrence: bool = True,
    workers: Workers = None,
) -> Volumetric:
    """Statistics of the volumetric error over random machines, at every pose.

    The deviations are one product of matrices, taken in blocks; only sums and a histogram are kept.
    Memory: 24 K + 14 000 bytes a pose, K the parameters of `Population.model`, and 128 MiB for the
    recurrence. Quantiles are read from 2048 bins up to five times the root mean square, so they are
    off by a quarter of a percent of it at most. It ends before all draws are taken

    - with `digits`, as soon as mean, standard deviation and quantiles are stable to so many
      significant digits of the standard deviation at every pose (JCGM 101:2008, 7.9.4);
    - with `precision`, as soon as twice the standard error of mean and 95 % quantile is below it
      at every pose.

    Args:
        q: Readings, shape (N, A).
        length: Tool length, scalar or (N,), mm.
        draws: S, or at most S.
        reference: Number of first poses that define the worst 5 %; a later pose counts where it
            reaches their limit. None for all poses.
        tolerance: For the exceedance, mm.
        precision: Half width of mean and 95 % quantile at a coverage of 95 %, mm; 0 for none.
        digits: Significant digits that have to be stable; 0 for none.
        recurrence: Whether to search the worst poses of every machine; NaN otherwise.
        workers: Workers: None for this process, an executor of `concurrent.futures`, or
            the client of a Dask cluster (`matstd.sensitivity.montecarlo.dask_cluster`). The result
            for a seed is the same to the last bit wherever numpy and processor are the same.

    Raises:
        DesignError: Fewer than two draws, no pose, fewer draws than two batches for stable digits,
            or workers that are gone.
    """
    if draws < 2 or not len(q):
        raise DesignError(
            f"{draws} draws at {len(q)} poses; expected two draws and a pose at least"
        )
    if digits and draws < 2 * MACHINES_A_BATCH:
        raise DesignError(
            f"{draws} draws at most for stable digits; expected {2 * MACHINES_A_BATCH} or more, "
            "which are two batches"
        )
    draws -= draws % MACHINES_A_BATCH if digits else 0  # batches of equal size
    width = bin_width(rms(population, q, length))
    reference = reference or len(q)
    worst = (reference, max(1, round(WORST_SHARE * reference))) if recurrence else (0, 0)
    seed = seed_words(rng)

    threads = None if workers is None else 1
    # of module level, without the workers: a cluster takes it to another process
    prepare = partial(_shared_arrays, population, q, length, width, tolerance, worst, threads)
    tally, stabiliser = Tally(width, tolerance), Stabiliser(digits) if digits else None
    for found in in_order(workers, prepare, count_batch, batches(draws, rng)):
        tally.add(found)
        progress("random machines", tally.count, draws)
        if stabiliser:
            stabiliser.add(_statistics(found, width))
            sd = moments(tally.count, tally.sum, tally.squares)[1]
            if stabiliser.stability(sd).is_stable:
                break
        elif precision and tally.result(seed, recurrence).achieved <= precision:
            break
    sd = moments(tally.count, tally.sum, tally.squares)[1]
    return tally.result(seed, recurrence, stabiliser.stability(sd) if stabiliser else None)


def _shared_arrays(
    population: Population,
    q: Array,
    length: float | Array,
    width: Array,
    tolerance: float,
    worst: tuple[int, int],
    threads: int | None,
) -> SharedArrays:
    """What all batches share: the lever of every error at every pose."""
    return SharedArrays(
        population=population,
        G=first_order(population.model, q, length),
        width=width,
        tolerance=tolerance,
        worst=worst,
        threads=threads,
    )


def _statistics(found: Lengths, width: Array) -> Array:
    """Mean, standard deviation and quantiles of one batch, (2 + Q, N), mm."""
    mean, sd = moments(found.draws, found.sum, found.squares)
    return np.concatenate([[mean, sd], quantiles(found.histogram, width, QUANTILES)])


@dataclass(frozen=True, eq=False)
class ExactCheck:
    """Differences of first order from the exact product, for some machines and poses."""

    machines: int
    poses: int
    rms: float  # root mean square of the difference between the deviation vectors, mm
    worst: float  # largest difference, mm
    rms_deviation: float  # root mean square of the deviations themselves, mm


def exact_check(
    population: Population, q: Array, length: float, machines: int, rng: np.random.Generator
) -> ExactCheck:
    """Compare first-order deviations of a few random machines with the exact product."""
    model = population.model
    touches = at_poses(population.chain, q, length)
    G = model.tip_columns(touches)
    drawn = coefficients(population, draw(population, machines, rng))
    exact = np.stack([model.tip_deviation(touches, theta) for theta in drawn])  # (S, N, 3)
    off = exact - np.einsum("nik,sk->sni", G, drawn)
    return ExactCheck(
        machines=machines,
        poses=len(q),
        rms=rms_length(off.reshape(-1, 3)),
        worst=float(np.linalg.norm(off, axis=2).max()),
        rms_deviation=rms_length(exact.reshape(-1, 3)),
    )
