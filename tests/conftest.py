"""One thread a worker: several workers, each with as many BLAS threads as cores, only wait."""

import os

import pytest

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

pytest_plugins = ["machines", "standards", "runs"]
"""Fixtures that the tests of several rooms share, in `tests/fixtures`."""


@pytest.fixture(autouse=True)
def _library_as_it_was():
    """Kinds that a test registers are forgotten after it: the next may have another machine."""
    from twin.library import catalogue

    kinds, files = dict(catalogue._REGISTER), dict(catalogue._FILES)
    yield
    for register, before in ((catalogue._REGISTER, kinds), (catalogue._FILES, files)):
        register.clear()
        register.update(before)
