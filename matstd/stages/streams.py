"""Random numbers of a project: one stream for each use, by name."""

from typing import NamedTuple

import numpy as np


class Streams(NamedTuple):
    """Independent streams of one seed.

    The order is part of the results: a stream depends on its place in it, so a new one goes to the
    end.
    """

    study: np.random.Generator  # random machines of the sensitivity study
    placement: np.random.Generator  # candidates and restarts of the search for standard and touches
    # machines that are probed and identified, their noise, poses that judge them
    proof: np.random.Generator
    # random machines that show what errors do to the length of the deviation
    maps: np.random.Generator
    other_setups: np.random.Generator  # poses at which other ways to measure are weighed
    # what calibration leaves open of the standard, noise and clamping of every visit
    visits: np.random.Generator


def streams(seed: int) -> Streams:
    """The streams of a seed."""
    return Streams(*np.random.default_rng(seed).spawn(len(Streams._fields)))
