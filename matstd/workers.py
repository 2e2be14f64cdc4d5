"""`--scheduler`: the random machines of the Monte Carlo drawn by the workers of a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from matstd.options import Options

if TYPE_CHECKING:
    from matstd.sensitivity.montecarlo import Workers


SCHEDULER: Options = {
    "--scheduler tcp://HOST:PORT": "draw the random machines on the workers of this Dask "
    "scheduler; the results do not change"
}


@contextmanager
def connected(address: str | None) -> Iterator[Workers]:
    """The workers at an address, None without one; raises DesignError where none answers."""
    if address is None:
        yield None
        return
    from matstd.sensitivity.montecarlo import cluster

    with cluster(address) as client:
        yield client
