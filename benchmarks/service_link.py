"""The OPC UA service for a while: every request answered once, and how fast a step settles.

    python benchmarks/service_link.py [--minutes 10] [--rate 20] [--steps 20]

A server and a client of their own process each, as a control would have them. The client asks at a
steady pace, waits for the answer of every request, and compares each with the inverse that it works
out itself. Then the reading jumps to and fro between two places whose corrections lie 20 um apart.
"""

import argparse
import asyncio
import logging
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from matstd.compensation.field import MachineErrors, datum_of
from matstd.compensation.service import NAMESPACE, PointCorrection
from matstd.twin.files import read_errors, read_machine

MACHINE = """format = "machine/1"
name = "bench"
chain = "[w C' B' X' f Y Z (C1) t]"
axis.X.range = [-400.0, 400.0]
axis.Y.range = [-300.0, 300.0]
axis.Z.range = [-500.0, 0.0]
axis.B = { range = [-110.0, 30.0], point = [0.0, 0.0, -420.0] }
axis.C = { range = [-360.0, 360.0], point = [0.0, 0.0, 0.0] }
workpiece.origin = [0.0, 0.0, -500.0]
"""
ERRORS = """format = "errors/1"
EXX = { shape = "linear", amplitude = 20.0 }
EYX = { shape = "sinusoidal", amplitude = 15.0, periods = 2 }
EC0Y = { amplitude = 45.0 }
EA0C = { amplitude = 35.0 }
"""
LENGTH, Z = 160.0, -200.0
BEFORE = 1_000_000  # numbers of requests that went before
INPUTS = ("Readings", "Sequence")
OUTPUTS = ("Answered", "K0", "Correction", "Lag", "Quality")


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


async def connected(url: str):
    """A client, when the server is there."""
    from asyncua import Client

    for _ in range(200):
        client = Client(url)
        try:
            await client.connect()
            return client
        except (OSError, ConnectionError):
            await asyncio.sleep(0.1)
    raise SystemExit(f"{url} does not answer")


async def found(client) -> dict:
    space = await client.get_namespace_index(NAMESPACE)
    find = client.nodes.objects.get_child
    return {n: await find([f"{space}:Compensation", f"{space}:{n}"]) for n in (*INPUTS, *OUTPUTS)}


async def ask(client, nodes, number: int, readings: list[float]) -> list[float]:
    """One request; its answer when it is there."""
    await client.write_values([nodes["Readings"], nodes["Sequence"]], [readings, number])
    while True:
        answered, k0 = await client.read_values([nodes["Answered"], nodes["K0"]])
        if answered == number:
            return k0
        if answered > number:
            raise SystemExit(f"request {number} was passed over: {answered} is answered")
        await asyncio.sleep(0.002)


async def steady(client, nodes, corrects, chain, minutes: float, rate: float) -> None:
    """Requests along a path, each compared with the inverse."""
    waits, worst, lost, late = [], 0.0, 0, 0
    begin, count = time.perf_counter(), round(60.0 * minutes * rate)
    x = chain.axis_index("X")
    for number in range(1, count + 1):
        pause = begin + number / rate - time.perf_counter()
        late += pause < 0.0
        await asyncio.sleep(max(pause, 0.0))
        q = [0.0] * len(chain.axes)
        q[x], q[chain.axis_index("Z")] = 390.0 * np.sin(0.01 * number), Z
        asked = time.perf_counter()
        k0 = await ask(client, nodes, BEFORE + number, [float(v) for v in q])
        waits.append(time.perf_counter() - asked)
        off = float(np.abs(np.array(k0) - corrects.at(q)).max())
        lost += off > 1e-9
        worst = max(worst, off)
    median, most = np.median(waits) * 1e3, np.quantile(waits, 0.999) * 1e3
    print(
        f"{count} requests at {rate:g} Hz: {lost} lost or repeated (farthest from the inverse "
        f"{worst * 1e6:.2g} nm), {late} asked late; answered after {median:.1f} ms (median), "
        f"{most:.0f} ms (99.9 %)"
    )


async def steps(client, nodes, corrects, chain, begin: int, count: int) -> None:
    """Jumps of the reading by which the correction of X changes by 20 um."""
    x = chain.axis_index("X")
    times = []
    for k in range(count):
        q = [0.0] * len(chain.axes)
        q[x], q[chain.axis_index("Z")] = (200.0 if k % 2 else -200.0), Z
        wanted = np.array(corrects.at(q))
        asked = time.perf_counter()
        await client.write_values([nodes["Readings"], nodes["Sequence"]], [q, begin + k])
        while True:
            value = await nodes["Correction"].read_value()
            if np.abs(np.array(value) - wanted).max() < 0.5e-3:
                break
            await asyncio.sleep(0.001)
        times.append(time.perf_counter() - asked)
        await asyncio.sleep(0.3)
    away = [0.0] * len(chain.axes)
    away[chain.axis_index("Z")] = Z
    size = []
    for place in (-200.0, 200.0):
        away[x] = place
        size.append(corrects.at(away))
    step = np.abs(np.subtract(*size)).max() * 1e3
    print(
        f"{count} steps of {step:.1f} um, settled to 0.5 um and read by the client after "
        f"{np.median(times) * 1e3:.0f} ms (median), {max(times) * 1e3:.0f} ms at most"
    )


async def play(url: str, folder: Path, args: argparse.Namespace) -> None:
    chain = read_machine(folder / "machine.toml")
    errors = MachineErrors.of_errors(chain, read_errors(folder / "errors.toml", chain))
    corrects = PointCorrection(errors, LENGTH, datum_of(chain, {"Z": Z}, LENGTH))
    client = await connected(url)
    try:
        nodes = await found(client)
        await steps(client, nodes, corrects, chain, 1, args.steps)
        await steady(client, nodes, corrects, chain, args.minutes, args.rate)
    finally:
        await client.disconnect()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=20.0)
    parser.add_argument("--steps", type=int, default=20)
    args = parser.parse_args()
    logging.getLogger("asyncua").setLevel(logging.ERROR)
    url = f"opc.tcp://127.0.0.1:{free_port()}"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "machine.toml").write_text(MACHINE)
        (folder / "errors.toml").write_text(ERRORS)
        words = [sys.executable, "-m", "matstd", "serve", "machine.toml"]
        words += ["--errors", "errors.toml", "--tool-length", f"{LENGTH:g}"]
        words += ["--datum", f"Z={Z:g}", "--endpoint", url, "--rate", "4000"]
        server = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL)
        try:
            asyncio.run(play(url, folder, args))
        finally:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
