"""How fast are the Jacobians of all error parameters?   python benchmarks/jacobians.py

Prints poses per second of `matstd.sensitivity.first_order.jacobians` for the 71 parameters of the
HSM 600U and for the 60 of the same machine without its spindle axis, beside two measures of the
same run: central differences of the exact product, and filling an array with a number.
"""

import platform
from pathlib import Path

import numpy as np
from harness import best_of, matrix_rate

from matstd.sensitivity.first_order import (
    Workspace,
    jacobian,
    jacobian_by_parameter,
    latin_hypercube,
)
from matstd.twin.files import read_machine
from matstd.twin.machine import Chain, Contribution, Family, exact_tip

MACHINE = Path(__file__).parent.parent / "examples" / "hsm600u-machine.toml"
LENGTH = 160.0


def central_differences(chain, q):
    """Jacobian by two exact products a parameter."""
    out = np.empty((len(q), len(chain.symbols), 3))
    for p, symbol in enumerate(chain.symbols):
        h = 1e-4 if symbol.is_angular else 0.1
        moved = []
        for size in (h, -h):
            added = Contribution.zeros(len(q), len(chain.links))
            part = added.twist if symbol.family is Family.COMPONENT else added.place
            part[:, chain.link_index(symbol.link), symbol.component] = size
            moved.append(exact_tip(chain, q, LENGTH, added))
        out[:, p] = (moved[0] - moved[1]) / (2.0 * h)
    return out


def main() -> None:
    """Print the figures."""
    print(f"{platform.processor() or platform.machine()}, numpy {np.__version__}")
    print(f"matrix product, float64: {matrix_rate():.0f} GFLOP/s")
    whole = read_machine(MACHINE)
    bare = tuple(link for link in whole.links if link.kind == "fixed" or link.programmed)
    for chain in (whole, Chain(whole.name, "without spindle axis", bare, whole.table_origin)):
        figures(chain)


def figures(chain):
    """Rates for one machine."""
    q = latin_hypercube(Workspace(chain, {}, LENGTH), 10_000, np.random.default_rng(1))
    shape = (len(chain.symbols), 3, len(q))
    closed = best_of(lambda: jacobian_by_parameter(chain, q, LENGTH), repeats=15)
    filled = best_of(lambda: np.empty(shape).fill(1.0), repeats=15)
    few = q[:500]
    slow = best_of(lambda: central_differences(chain, few), repeats=2) * len(q) / len(few)
    print(f"{len(chain.symbols)} parameters: {len(q) / closed:,.0f} poses/s")
    print(f"  {closed / filled:.0f} times as long as filling the array once")
    print(f"  central differences: {len(q) / slow:,.0f} poses/s, {slow / closed:.0f} times as long")
    worst = np.abs(central_differences(chain, few) - jacobian(chain, few, LENGTH)).max()
    print(f"  largest difference between the two: {worst:.1e} mm/rad")


if __name__ == "__main__":
    main()
