"""What benchmarks share: where fixtures are, numbered runs in processes, folders of cases, timing.

Importing it puts the checkout, the independent simulator of `tests/oracles` and the fixtures of the
tests on the path, so the line must stand before imports from there.
"""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:  # timings of other rooms do not load the diagnosis
    from matstd.diagnosis.answer import Diagnosis, Step

Job, Result = TypeVar("Job"), TypeVar("Result")

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / part) for part in (".", "tests/oracles", "tests/fixtures")]

MACHINES = ("hsm600u", "fork", "hmc1995")
"""Machines of the simulator; run k is made on machine k modulo 3."""


def parser_of(doc: str) -> argparse.ArgumentParser:
    """Parser of a script whose docstring begins with its question."""
    return argparse.ArgumentParser(description=doc.splitlines()[0])


def run_options(doc: str, runs: int) -> argparse.ArgumentParser:
    """Parser with `--runs`, `--first` and `--jobs`, as `in_processes` takes them."""
    parser = parser_of(doc)
    parser.add_argument("--runs", type=int, default=runs)
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    return parser


def in_processes(one: Callable[[Job], Result], jobs: Sequence[Job], processes: int) -> list[Result]:
    """Results of all jobs in their order; one process needs no pool, and its traceback is whole."""
    if processes == 1:
        return [one(job) for job in jobs]
    with ProcessPoolExecutor(processes) as pool:
        return list(pool.map(one, jobs))


def cases(folders: Sequence[Path], needed: str = "truth.json") -> list[Path]:
    """Folders of cases among those given, which are cases or hold cases."""
    out = []
    for folder in folders:
        own = [folder] if (folder / "run.csv").exists() else sorted(folder.iterdir())
        out += [case for case in own if (case / needed).exists()]
    return out


def named_steps(result: "Diagnosis") -> "list[Step]":
    """Steps of a diagnosis that name an effect."""
    return [step for step in result.steps if step.effect is not None]


def names_of(step: "Step") -> set[str]:
    """The effect of a step and all that the run cannot distinguish from it."""
    rivals = step.confusion.rivals if step.confusion else ()
    return {e.name for e in (step.effect, *(r.effect for r in rivals)) if e is not None}


def listed(steps: "Sequence[Step]") -> str:
    """Names of effects, each with the size of its class."""
    return ", ".join(
        step.effect.name + (f"~{len(step.confusion.rivals)}" if step.confusion else "")
        for step in steps
        if step.effect is not None
    )


def alike_names(hidden: dict) -> set[str]:
    """A hidden effect of the simulator and all that its touches cannot distinguish from it."""
    return {hidden["effect"], *(alike[1] for alike in hidden["alike"])}


def mark(is_right: bool) -> str:
    """First word of a line on a case."""
    return "ok   " if is_right else "WRONG"


def best_of(
    work: Callable[[], object], repeats: int = 5, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Shortest of some timings, s; of all threads together with `time.process_time`."""
    times = []
    for _ in range(repeats):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def matrix_rate() -> float:
    """float64 matrix products, GFLOP/s: the measure of the machine at hand."""
    a = np.random.default_rng(0).normal(size=(1500, 1500))
    return 2 * 1500**3 / best_of(lambda: a @ a) / 1e9
