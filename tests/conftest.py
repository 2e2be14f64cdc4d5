"""One thread a worker: several workers, each with as many BLAS threads as cores, only wait."""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

pytest_plugins = ["machines", "standards", "runs"]
"""Fixtures that the tests of several rooms share, in `tests/fixtures`."""
