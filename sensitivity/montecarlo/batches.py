"""Batches of random machines: the unit of work that any worker can take, and how it is counted."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from matstd.sensitivity.montecarlo.lengths import BINS, Lengths, count_lengths
from matstd.sensitivity.population import DRAWS_A_CHILD, Population, coefficients, draw
from matstd.twin.compute import blocks
from matstd.twin.frames import Array
from matstd.twin.model import Model
from matstd.twin.record import at_poses

MACHINES_A_BATCH = 20 * DRAWS_A_CHILD
"""10 240: as many as JCGM 101, 7.9.4 b) wants for a coverage of up to 99 %."""
_SPAN = 5.0
"""The histogram of |d| at a pose reaches to this multiple of its root mean square. A sum of many
independent errors exceeds it in less than one case of a million, and then sits in the last bin."""
_MIN_SCALE = 1e-12  # mm: scale of the histogram where no machine has an error


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
