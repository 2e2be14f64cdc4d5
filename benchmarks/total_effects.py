"""How fast are total-effect indices of |d|?   python benchmarks/total_effects.py

60 errors, 10 000 poses, N = 1024: compiled and in numpy, wall and processor time (of all threads),
with the matrix-product rate of the run.
"""

import time

import numpy as np
from harness import best_of, matrix_rate

from matstd.sensitivity.shares import total_effects


def main() -> None:
    """Print the figures."""
    rng = np.random.default_rng(1)
    J, (a, b) = rng.normal(size=(60, 3, 10_000)), rng.normal(size=(2, 60, 1024))
    total_effects(J[:, :, :4], a, b)  # compiles
    print(f"matrix product, float64: {matrix_rate():.0f} GFLOP/s")
    wall = best_of(lambda: total_effects(J, a, b))
    busy = best_of(lambda: total_effects(J, a, b), clock=time.process_time)
    print(f"compiled: {wall:.3f} s, {busy:.3f} s of processor time")
    some = J[:, :, :1000]
    plain = best_of(lambda: total_effects(some, a, b, compiled=False), repeats=2)
    print(f"numpy: {10 * plain:.2f} s (ten times 1000 poses)")


if __name__ == "__main__":
    main()
