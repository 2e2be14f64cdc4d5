"""Work by others: the same numbers to the last bit, whichever process counts or dies."""

import socket
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from os import _exit

import numpy as np
import pytest

from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.montecarlo import cluster, volumetric
from matstd.sensitivity.montecarlo.workers import in_order
from matstd.sensitivity.population import Population
from matstd.twin.errors import DesignError

LENGTH, DRAWS = 160.0, 53_000  # five batches and a part of one
START = 30.0  # s, for the processes of a cluster on a busy machine


@pytest.fixture(scope="module")
def study(chain, workspace):
    population = Population(chain)
    q = latin_hypercube(workspace, 10, np.random.default_rng(7))

    def run(workers, report=None):
        progress = {"progress": lambda _, done, __: report(done)} if report else {}
        return volumetric(
            population, q, LENGTH, DRAWS, np.random.default_rng(5), workers=workers, **progress
        )

    return run, run(None)


def same(found, expected):
    assert found.draws == expected.draws == DRAWS
    for name in ("mean", "sd", "quantile", "recurrence", "exceedance"):
        np.testing.assert_array_equal(
            getattr(found, name), getattr(expected, name), err_msg=name, strict=True
        )


class OwnCluster:
    """A scheduler and its workers, each a process of its own."""

    def __init__(self, folder, workers=2):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{port}"
        self.folder, self.log = folder, (folder / "log").open("w", encoding="utf-8")
        here = ("--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
        self.scheduler = self.process("dask_scheduler", *here)
        self.workers = [self.worker() for _ in range(workers)]

    def answers(self):
        """Wait until the scheduler listens."""
        host, port = self.address.removeprefix("tcp://").split(":")
        until = time.monotonic() + START
        while time.monotonic() < until:
            try:
                socket.create_connection((host, int(port)), timeout=1.0).close()
                return
            except OSError:
                time.sleep(0.1)

    def worker(self):
        return self.process("dask_worker", self.address, "--nthreads", "1", "--no-nanny",
                            "--no-dashboard", "--local-directory", str(self.folder))  # fmt: skip

    def process(self, module, *words):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *words]
        return subprocess.Popen(command, stdout=self.log, stderr=self.log)

    def close(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()
        self.log.close()


@pytest.fixture
def own_cluster(tmp_path):
    made = OwnCluster(tmp_path)
    yield made
    made.close()


@pytest.mark.slow
@pytest.mark.usefixtures("compiled_loops")  # further processes count with them
def test_workers_of_a_cluster_give_the_same_bits_and_may_die(study, own_cluster, capfd):
    run, _ = study
    local = run(None)
    with cluster(own_cluster.address, START) as client:
        client.wait_for_workers(2, timeout=START)
        same(run(client), local)

        def one_dies(done):
            if done == 10_240:
                own_cluster.workers[0].kill()

        same(run(client, one_dies), local)
        assert len(client.nthreads()) == 1

        def all_end(done):
            if done == 10_240:
                own_cluster.scheduler.kill()

        with pytest.raises(DesignError, match="the scheduler is gone; nothing was written"):
            run(client, all_end)
    assert capfd.readouterr().err == ""


@pytest.mark.usefixtures("compiled_loops")  # further processes count with them
def test_executors_give_the_same_bits(study):
    run, _ = study
    local = run(None)
    with ThreadPoolExecutor(2) as threads:
        same(run(threads), local)
    with ProcessPoolExecutor(1, get_context("spawn")) as processes:
        same(run(processes), local)


def test_a_dead_process_is_said():
    with (
        ProcessPoolExecutor(1, get_context("spawn")) as processes,
        pytest.raises(DesignError, match="ended before its work was done"),
    ):
        list(in_order(processes, int, ending, range(3)))


def ending(shared, job):
    _exit(shared + job + 1)


def test_jobs_are_taken_as_they_are_needed():
    taken = []

    def jobs():
        for i in range(1000):
            taken.append(i)
            yield i

    with ThreadPoolExecutor(2) as threads:
        results = in_order(threads, lambda: 10, lambda shared, job: shared + job, jobs())
        assert [next(results) for _ in range(5)] == [10, 11, 12, 13, 14]
        results.close()
    assert len(taken) < 20


def test_something_else_does_no_work():
    with pytest.raises(DesignError, match="str is neither an executor nor a Dask client"):
        list(in_order("tcp://somewhere", int, max, [1]))


def test_a_scheduler_that_does_not_answer_is_one_line():
    with (
        pytest.raises(
            DesignError, match=r"scheduler tcp://127\.0\.0\.1:1: no answer within 0\.5 s"
        ),
        cluster("tcp://127.0.0.1:1", answer=0.5),
    ):
        pytest.fail("no worker is there")


def test_a_scheduler_without_workers_is_one_line(tmp_path):
    made = OwnCluster(tmp_path, workers=0)
    try:
        made.answers()
        with (
            pytest.raises(DesignError, match="has no workers; expected at least one"),
            cluster(made.address, answer=1.0),
        ):
            pytest.fail("no worker works")
    finally:
        made.close()
