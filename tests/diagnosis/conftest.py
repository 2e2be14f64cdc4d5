"""Runs of the independent simulator and what is made of them, each once a session."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from simulator_case import DETECTABLE, read_back, simulate_case

from diagnosis.answer.diagnose import diagnose
from diagnosis.fit.identification import fit_run
from twin.library.ordinary import ordinary_model
from twin.record.run import Run


class Case(NamedTuple):
    """A simulated run with the truth about it."""

    run: Run
    truth: dict


@cache
def _simulated(seed, machine="hsm600u", hidden=(), hard=False, signal_to_noise=(12.0, 40.0)):
    """Run and truth of a case; every random number comes from the seed."""
    run_file, machine_file, truth = simulate_case(
        np.random.default_rng(seed),
        machine,
        hidden,
        hard,
        signal_to_noise,
        with_alike=False,
        keep_weak=signal_to_noise[1] < DETECTABLE,
    )
    return Case(read_back(run_file, machine_file), truth)


@pytest.fixture(scope="session")
def case():
    """A function (seed, machine, hidden, hard, signal_to_noise) -> (run, truth)."""
    return _simulated


@pytest.fixture(scope="session")
def simulated(case):
    """The same by another word."""
    return case


@pytest.fixture(scope="session")
def fitted():
    """A function with the same arguments -> the ordinary model fitted to the run."""

    @cache
    def fit(*arguments):
        run = _simulated(*arguments).run
        return fit_run(run, ordinary_model(run.touches.chain))

    return fit


@pytest.fixture(scope="session")
def diagnosed():
    """A function with the same arguments -> the diagnosis with the whole library."""

    @cache
    def make(*arguments):
        return diagnose(_simulated(*arguments).run, rng=np.random.default_rng(0))

    return make
