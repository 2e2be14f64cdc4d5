"""A Dask cluster as workers: connect to its scheduler, wait for results, report lost workers."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matstd.twin.errors import DesignError, MissingLibrary

ANSWER_TIME = 5.0  # seconds in which a scheduler has to answer and to have a worker
_POLL_INTERVAL = 1.0  # s between checks that workers are alive
_NO_WORKER_TIMEOUT = 20.0  # s without any worker after which the work is given up


@contextmanager
def cluster(address: str, answer: float = ANSWER_TIME) -> Iterator[Any]:
    """Client of the Dask scheduler at an address, such as `tcp://10.0.0.7:8786`.

    Raises:
        MissingLibrary: Dask is not installed.
        DesignError: The address does not answer, or the scheduler has no worker.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise MissingLibrary(
            f"work on a cluster needs dask[distributed] ({error}): "
            "pip install 'material-standard[cluster]'"
        ) from error
    with _quiet("distributed", "asyncio", "tornado"):
        try:
            client = Client(address, timeout=answer, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise DesignError(
                f"scheduler {address}: no answer within {answer:g} s; expected the address of a "
                f"running Dask scheduler, such as tcp://localhost:8786"
            ) from error
        try:
            _wait_for_workers(client, address, answer)
            yield client
        finally:
            client.close(timeout=answer)


@contextmanager
def _quiet(*families: str) -> Iterator[None]:
    """Silence some loggers and their children; faults are reported in one line of our own."""
    loggers = [
        logging.getLogger(name)
        for name in logging.root.manager.loggerDict
        if name.partition(".")[0] in families
    ]
    before = [logger.disabled for logger in loggers]
    for logger in loggers:
        logger.disabled = True
    try:
        yield
    finally:
        for logger, disabled in zip(loggers, before, strict=True):
            logger.disabled = disabled


def _wait_for_workers(client: Any, address: str, answer: float) -> None:
    deadline = time.monotonic() + answer
    while not client.nthreads():
        if time.monotonic() > deadline:
            raise DesignError(
                f"scheduler {address}: has no workers; expected at least one "
                f"(start it with: dask worker {address})"
            )
        time.sleep(0.1)


def is_cluster(workers: object) -> bool:
    """Whether something is a Dask client, without loading Dask."""
    return any(c.__module__.partition(".")[0] == "distributed" for c in type(workers).__mro__)


def awaited(client: Any, future: Any) -> Any:
    """Result of a future, or the reason why there will be none; raises DesignError."""
    from distributed import KilledWorker

    alone_since = None
    while True:
        try:
            return future.result(timeout=_POLL_INTERVAL)
        except TimeoutError:
            if client.status != "running":
                raise _lost(client, "the scheduler is gone") from None
            somebody = bool(client.scheduler_info(n_workers=-1)["workers"])
            alone_since = None if somebody else alone_since or time.monotonic()
            if alone_since and time.monotonic() - alone_since > _NO_WORKER_TIMEOUT:
                raise _lost(client, f"no worker for {_NO_WORKER_TIMEOUT:g} s") from None
        except KilledWorker as error:
            raise _lost(client, f"workers die over this work ({error})") from error
        except ImportError as error:
            raise _lost(client, f"a worker lacks what this needs ({error})") from error
        except Exception as error:
            if future.status == "cancelled" or isinstance(error, OSError):
                raise _lost(client, "the scheduler is gone") from None
            raise


def _lost(client: Any, why: str) -> DesignError:
    address = getattr(client.scheduler, "address", "of the cluster")
    return DesignError(f"scheduler {address}: {why}; nothing was written, start the work again")
