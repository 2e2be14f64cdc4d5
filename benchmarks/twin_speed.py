"""How fast is the twin beside loops compiled for the purpose, and `matstd volumetric`?

    python benchmarks/twin_speed.py [--poses 10000] [--rows 1000000]

Exact tool points with all 71 errors of the HSM 600U, and the Jacobian of all of them, each beside a
numba kernel that is written here for nothing else (one thread, arrays of any chain). Both are timed
in turn, so that whatever else the processor does disturbs both, and the shortest times are divided.
Then the command, with a table of a million poses: seconds and peak memory of its process.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numba
import numpy as np

from matstd.sensitivity.first_order import Workspace, jacobian_by_parameter, latin_hypercube
from matstd.twin.files import read_machine
from matstd.twin.machine import Chain, Contribution, Family, exact_tip
from matstd.twin.units import DEG

MACHINE = Path(__file__).parents[1] / "examples" / "hsm600u-machine.toml"
ERRORS = """format = "errors/1"
[EXX]
shape = "linear"
amplitude = 12.0
[EC0Y]
amplitude = 15.0
"""
LENGTH = 160.0
FIXED, LINEAR, ROTARY = range(3)
MEASURED = """
import resource, subprocess, sys, time
begun = time.perf_counter()
subprocess.run([sys.executable, "-m", *sys.argv[1:]], check=True)
ended, used = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"{ended - begun:.2f} s ({used.ru_utime + used.ru_stime:.2f} s of processor), "
      f"{used.ru_maxrss / 1024:.0f} MiB")
"""
"""A small process runs the command: the peak memory of a child is never below its parent's."""


@numba.njit(inline="always")
def turned(a, b, c, x, y, z):
    """A vector behind a rotation vector; the series is exact to a double below 10 mrad."""
    square = a * a + b * b + c * c
    if square < 1e-4:
        first = 1.0 - square * (1.0 / 6.0 - square / 120.0)
        second = 0.5 - square * (1.0 / 24.0 - square / 720.0)
    else:
        angle = np.sqrt(square)
        first, second = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
    u, v, w = b * z - c * y, c * x - a * z, a * y - b * x
    return (
        x + first * u + second * (b * w - c * v),
        y + first * v + second * (c * u - a * w),
        z + first * w + second * (a * v - b * u),
    )


@numba.njit(inline="always")
def about(d0, d1, d2, angle, x, y, z):
    """A vector behind a rotation about a unit direction."""
    c, s = np.cos(angle), np.sin(angle)
    along = (1.0 - c) * (d0 * x + d1 * y + d2 * z)
    return (
        along * d0 + c * x + s * (d1 * z - d2 * y),
        along * d1 + c * y + s * (d2 * x - d0 * z),
        along * d2 + c * z + s * (d0 * y - d1 * x),
    )


@numba.njit(fastmath=True, error_model="numpy")
def exact_kernel(links, order, direction, point, origin, q, length, twist, place, out):
    """Tool points (N, 3): `links` (L, 4) is kind, sign, column of the reading, own letter."""
    for n in range(len(q)):
        x, y, z = 0.0, 0.0, -length
        for i in order:
            kind, sign, column, own = links[i]
            d0, d1, d2 = direction[i]
            p0, p1, p2 = point[i]
            travel = 0.0 if kind == FIXED else sign * q[n, column]
            for motion in (sign > 0, sign < 0):
                if not motion:
                    l0, l1, l2 = p0, p1, p2
                    if kind == LINEAR:
                        l0, l1, l2 = p0 + travel * d0, p1 + travel * d1, p2 + travel * d2
                    x, y, z = turned(
                        twist[i, 3, n], twist[i, 4, n], twist[i, 5, n], x - l0, y - l1, z - l2
                    )
                    x, y, z = (
                        x + l0 + twist[i, 0, n],
                        y + l1 + twist[i, 1, n],
                        z + l2 + twist[i, 2, n],
                    )
                elif kind == FIXED and sign > 0:
                    x, y, z = turned(
                        place[i, 3, n], place[i, 4, n], place[i, 5, n], x - p0, y - p1, z - p2
                    )
                    x, y, z = (
                        x + p0 + place[i, 0, n],
                        y + p1 + place[i, 1, n],
                        z + p2 + place[i, 2, n],
                    )
                elif kind == FIXED:
                    x, y, z = (
                        x - p0 - place[i, 0, n],
                        y - p1 - place[i, 1, n],
                        z - p2 - place[i, 2, n],
                    )
                    x, y, z = turned(-place[i, 3, n], -place[i, 4, n], -place[i, 5, n], x, y, z)
                    x, y, z = x + p0, y + p1, z + p2
                elif kind == LINEAR:
                    a, b, c = turned(place[i, 3, n], place[i, 4, n], place[i, 5, n], d0, d1, d2)
                    far = sign * (travel + sign * place[i, own, n])
                    x, y, z = x + far * a, y + far * b, z + far * c
                else:
                    t0 = 0.0 if own == 0 else place[i, 3, n]
                    t1 = 0.0 if own == 1 else place[i, 4, n]
                    t2 = 0.0 if own == 2 else place[i, 5, n]
                    a, b, c = turned(t0, t1, t2, d0, d1, d2)
                    o0, o1, o2 = p0 + place[i, 0, n], p1 + place[i, 1, n], p2 + place[i, 2, n]
                    angle = sign * (travel + sign * place[i, 3 + own, n])
                    x, y, z = about(a, b, c, angle, x - o0, y - o1, z - o2)
                    x, y, z = x + o0, y + o1, z + o2
        out[n, 0], out[n, 1], out[n, 2] = x - origin[0], y - origin[1], z - origin[2]


@numba.njit(fastmath=True, error_model="numpy")
def placed(R, p0, p1, p2, count, sign, out):
    """Add a fixed point of a body, or subtract it, in table coordinates."""
    for k in range(3):
        for n in range(count):
            out[k, n] += sign * (R[k, 0, n] * p0 + R[k, 1, n] * p1 + R[k, 2, n] * p2)


@numba.njit(fastmath=True, error_model="numpy")
def walk(links, direction, point, origin, q, length, R, arm):  # noqa: C901
    """Rotations (axes + 1, 3, 3, n) behind each rotary axis, and arms (L, 3, n) to the tip."""
    count, body = len(q), 0
    t, c, s = np.empty((3, count)), np.empty(count), np.empty(count)
    for k in range(3):
        R[0, k, :, :count] = 0.0
        R[0, k, k, :count] = 1.0
        t[k] = -origin[k]
    for i in range(len(links)):
        kind, sign, column, _ = links[i]
        d0, d1, d2 = direction[i]
        p0, p1, p2 = point[i]
        if sign < 0:
            arm[i, :, :count] = t
            placed(R[body], p0, p1, p2, count, 1.0, arm[i])
        if kind == LINEAR:
            B = R[body]
            for k in range(3):
                for n in range(count):
                    t[k, n] += (B[k, 0, n] * d0 + B[k, 1, n] * d1 + B[k, 2, n] * d2) * q[n, column]
        if kind == ROTARY:
            for n in range(count):
                c[n], s[n] = np.cos(q[n, column]), np.sin(q[n, column])
            placed(R[body], p0, p1, p2, count, 1.0, t)
            B, A = R[body], R[body + 1]
            for k in range(3):
                for n in range(count):
                    x, y, z = B[k, 0, n], B[k, 1, n], B[k, 2, n]
                    along = (1.0 - c[n]) * (d0 * x + d1 * y + d2 * z)
                    A[k, 0, n] = along * d0 + c[n] * x - s[n] * (d1 * z - d2 * y)
                    A[k, 1, n] = along * d1 + c[n] * y - s[n] * (d2 * x - d0 * z)
                    A[k, 2, n] = along * d2 + c[n] * z - s[n] * (d0 * y - d1 * x)
            body += 1
            placed(R[body], p0, p1, p2, count, -1.0, t)
        if sign > 0:
            arm[i, :, :count] = t
            placed(R[body], p0, p1, p2, count, 1.0, arm[i])
    for i in range(len(links)):
        for k in range(3):
            for n in range(count):
                arm[i, k, n] = t[k, n] - R[body, k, 2, n] * length - arm[i, k, n]


@numba.njit(fastmath=True, error_model="numpy")
def filled(R, arm, u, v, w, turns, start, count, out):
    """One column (3, n): the direction (u, v, w) of a body, or what a rotation about it does."""
    for n in range(count):
        a = R[0, 0, n] * u + R[0, 1, n] * v + R[0, 2, n] * w
        b = R[1, 0, n] * u + R[1, 1, n] * v + R[1, 2, n] * w
        c = R[2, 0, n] * u + R[2, 1, n] * v + R[2, 2, n] * w
        if turns:
            x, y, z = arm[0, n], arm[1, n], arm[2, n]
            a, b, c = b * z - c * y, c * x - a * z, a * y - b * x
        out[0, start + n], out[1, start + n], out[2, start + n] = a, b, c


@numba.njit(fastmath=True, error_model="numpy")
def component(R, arm, m, turns, start, count, out):
    """The same along, or about, one of the three directions of a body."""
    for n in range(count):
        a, b, c = R[0, m, n], R[1, m, n], R[2, m, n]
        if turns:
            x, y, z = arm[0, n], arm[1, n], arm[2, n]
            a, b, c = b * z - c * y, c * x - a * z, a * y - b * x
        out[0, start + n], out[1, start + n], out[2, start + n] = a, b, c


@numba.njit(fastmath=True, error_model="numpy")
def difference(before, after, arm, m, turns, start, count, out):
    """What the displaced line of a rotary axis does."""
    for n in range(count):
        a = before[0, m, n] - after[0, m, n]
        b = before[1, m, n] - after[1, m, n]
        c = before[2, m, n] - after[2, m, n]
        if turns:
            x, y, z = arm[0, n], arm[1, n], arm[2, n]
            a, b, c = b * z - c * y, c * x - a * z, a * y - b * x
        out[0, start + n], out[1, start + n], out[2, start + n] = a, b, c


@numba.njit(fastmath=True, error_model="numpy")
def jacobian_kernel(links, direction, point, origin, q, length, at, out):  # noqa: C901
    """Columns (P, 3, N) of all errors; `at` (2, L, 6) says which of component, of place."""
    count, block = len(links), 256
    rotary = (links[:, 0] == ROTARY).astype(np.int64)
    after = rotary.cumsum()
    before, bodies = after - rotary, np.empty((after[-1] + 1, 3, 3, block))
    arm, unit = np.empty((count, 3, block)), np.eye(3)
    for start in range(0, len(q), block):
        some = q[start : start + block]
        n = len(some)
        walk(links, direction, point, origin, some, length, bodies, arm)
        for i in range(count):
            kind, sign, column, own = links[i]
            d0, d1, d2 = direction[i]
            R = bodies[before[i] if sign > 0 else after[i]]
            for j in range(6):
                p, m, turns = at[0, i, j], j % 3, j > 2
                if p >= 0:
                    component(R, arm[i], m, turns, start, n, out[p])
                p = at[1, i, j]
                if p < 0:
                    continue
                if kind == FIXED:
                    filled(
                        R,
                        arm[i],
                        sign * unit[m, 0],
                        sign * unit[m, 1],
                        sign * unit[m, 2],
                        turns,
                        start,
                        n,
                        out[p],
                    )
                elif kind == ROTARY and (j < 3 or m != own):
                    difference(
                        bodies[before[i]], bodies[after[i]], arm[i], m, turns, start, n, out[p]
                    )
                elif kind == LINEAR and turns:
                    u = unit[m, 1] * d2 - unit[m, 2] * d1
                    v = unit[m, 2] * d0 - unit[m, 0] * d2
                    w = unit[m, 0] * d1 - unit[m, 1] * d0
                    filled(R, arm[i], u, v, w, False, start, n, out[p])
                    for k in range(3):
                        for s in range(n):
                            out[p, k, start + s] *= some[s, column]
                else:
                    filled(R, arm[i], d0, d1, d2, turns, start, n, out[p])


def compiled_form(chain):
    """The chain as the arrays of the kernels: links, order, directions, points."""
    kinds = {"fixed": FIXED, "linear": LINEAR, "rotary": ROTARY}
    rows = []
    for link in chain.links:
        column = -1 if link.kind == "fixed" else chain.axis_index(link.name)
        own = -1 if link.kind == "fixed" else link.own
        rows.append((kinds[link.kind], -1 if link.carries_workpiece else 1, column, own))
    links = np.array(rows)
    order = [*np.flatnonzero(links[:, 1] > 0)[::-1], *np.flatnonzero(links[:, 1] < 0)[::-1]]
    direction = np.array([link.direction for link in chain.links])
    return links, np.array(order), direction, np.array([link.point for link in chain.links])


def every_error(chain, q, rng):
    """Contribution of all errors of a machine: component errors linear over the readings."""
    added = Contribution.zeros(len(q), len(chain.links))
    for symbol in chain.symbols:
        i = chain.link_index(symbol.link)
        size = rng.normal() * (50e-6 if symbol.is_angular else 0.02)
        if symbol.family is Family.COMPONENT:
            shape = chain.links[i].scaled(q[:, chain.axis_index(symbol.link)])
            added.twist[:, i, symbol.component] = size * shape
        else:
            added.place[:, i, symbol.component] = size
    return added


def shortest(*works: Callable[[], object], turns: int = 60) -> list[float]:
    """Shortest times of some works that are done in turn, s."""
    times = np.empty((turns, len(works)))
    for row in times:
        for i, work in enumerate(works):
            start = time.perf_counter()
            work()
            row[i] = time.perf_counter() - start
    return times.min(axis=0).tolist()


def against_kernels(chain: Chain, q) -> None:
    """Both ratios, and how far the results are apart."""
    links, order, direction, point = compiled_form(chain)
    origin, count = chain.table_origin, len(q)
    added = every_error(chain, q, np.random.default_rng(2))
    twist, place = (np.moveaxis(part, 0, -1) for part in (added.twist, added.place))

    def exact():
        out = np.empty((count, 3))
        args = (q, LENGTH, twist, place, out)
        exact_kernel(links, order, direction, point, origin, *args)
        return out

    at = np.full((2, len(chain.links), 6), -1)
    for p, symbol in enumerate(chain.symbols):
        family = 0 if symbol.family is Family.COMPONENT else 1
        at[family, chain.link_index(symbol.link), symbol.component] = p

    def columns():
        out = np.empty((len(chain.symbols), 3, count))
        jacobian_kernel(links, direction, point, origin, q, LENGTH, at, out)
        return out

    ours = {
        "exact points": (lambda: exact_tip(chain, q, LENGTH, added), exact),
        "Jacobians": (lambda: jacobian_by_parameter(chain, q, LENGTH), columns),
    }
    for name, (own, kernel) in ours.items():
        apart = np.abs(own() - kernel()).max()
        own_time, kernel_time = shortest(own, kernel)
        print(
            f"{name}: {count / own_time / 1e6:.2f} million poses a second, the kernel "
            f"{count / kernel_time / 1e6:.2f}: {own_time / kernel_time:.2f} times as long; "
            f"{apart:.0e} apart"
        )


def command(chain: Chain, rows: int) -> None:
    """Time and memory of the command."""
    rng = np.random.default_rng(0)
    names, columns = [], []
    for axis in chain.programmed_axes:
        link = chain.link(axis)
        turns = link.kind == "rotary"
        names.append(f"{axis}_deg" if turns else f"{axis}_mm")
        columns.append(rng.uniform(*link.range, rows) / (DEG if turns else 1.0))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        table = np.column_stack([*columns, np.full(rows, LENGTH)])
        head = ",".join([*names, "tool_length_mm"])
        np.savetxt(folder / "poses.csv", table, "%.4f", ",", header=head, comments="")
        (folder / "errors.toml").write_text(ERRORS)
        files = [str(MACHINE), *(str(folder / n) for n in ("errors.toml", "poses.csv"))]
        words = ["matstd", "volumetric", *files, "-o", str(folder / "out.csv")]
        subprocess.run([sys.executable, "-c", MEASURED, *words], check=True)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=10_000)
    parser.add_argument("--rows", type=int, default=1_000_000)
    args = parser.parse_args()
    chain = read_machine(MACHINE)
    rng = np.random.default_rng(1)
    # as in any process that freed a large array, freed memory is kept and not given back each time
    np.empty(3 << 20).fill(0.0)
    against_kernels(chain, latin_hypercube(Workspace(chain, {}, LENGTH), args.poses, rng))
    command(chain, args.rows)


if __name__ == "__main__":
    main()
