"""Measures the figures of docs/decisions.md, named parts of them or all; times are of one core.

Run as ``OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python docs/decision_figures.py [columns ...]``.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from matstd.twin.files import read_machine
from matstd.twin.library import ordinary_model
from matstd.twin.machine import Contribution, Family, exact_tip, tip
from matstd.twin.record import at_poses
from matstd.twin.units import DEG, UM

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
MACHINE = EXAMPLES / "hsm600u-machine.toml"
LENGTH = 160.0


def _readings(count: int) -> np.ndarray:
    chain = read_machine(MACHINE)
    low, high = np.array([link.range for link in chain.links if link.kind != "fixed"]).T
    return np.random.default_rng(0).uniform(low, high, (count, len(low)))


def _seconds(work: Callable[[], object], rounds: int = 5) -> float:
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def columns() -> dict[str, str]:
    """All columns in closed form against central differences of the exact product."""
    chain, q = read_machine(MACHINE), _readings(1000)
    step = 1e-5

    def differences() -> np.ndarray:
        out = []
        for symbol in chain.symbols:
            both = []
            for sign in (1.0, -1.0):
                added = Contribution.zeros(len(q), len(chain.links))
                part = added.twist if symbol.family is Family.COMPONENT else added.place
                part[:, chain.link_index(symbol.link), symbol.component] = sign * step
                both.append(exact_tip(chain, q, LENGTH, added))
            out.append((both[0] - both[1]) / (2.0 * step))
        return np.stack(out, axis=1)

    from matstd.sensitivity.first_order import jacobian

    closed = jacobian(chain, q, LENGTH)
    off = np.abs(closed - differences()).max() / np.abs(closed).max()
    seconds = _seconds(lambda: jacobian(chain, q, LENGTH))
    return {
        "71 parameters at 1000 poses, closed form": f"{seconds * 1e3:.0f} ms",
        "the same by central differences": f"{_seconds(differences, 2) * 1e3:.0f} ms",
        "largest difference, relative": f"{off:.0e}",
    }


def terms() -> dict[str, str]:
    """Memory of sparse terms against one dense contribution a parameter."""
    chain = read_machine(MACHINE)
    model = ordinary_model(chain)
    touches = at_poses(chain, _readings(480), LENGTH)
    sparse = sum(t.amount.nbytes for e in model.effects for t in e.terms(touches))
    dense = len(model.parameters) * sum(
        part.nbytes for part in Contribution.zeros(len(touches), len(chain.links))
    )
    return {
        "parameters of the ordinary model": str(len(model.parameters)),
        "terms at 480 touches": f"{sparse / 1e6:.1f} MB",
        "dense contributions": f"{dense / 1e6:.0f} MB",
    }


def location() -> dict[str, str]:
    """A displaced line of C: where the reading is zero nothing moves."""
    chain = read_machine(MACHINE)
    out = {}
    for c in (0.0, 90.0, 180.0):
        q = np.zeros((1, len(chain.axes)))
        q[:, chain.axis_index("C")] = c * DEG
        added = Contribution.zeros(1, len(chain.links))
        added.place[:, chain.link_index("C"), 0] = 10 * UM
        moved = np.linalg.norm(exact_tip(chain, q, LENGTH, added) - tip(chain, q, LENGTH))
        out[f"EX0C = 10 µm at C = {c:.0f}"] = f"{moved / UM:.2f} µm"
    return out


def foot_points() -> dict[str, str]:
    """A standard 0.5 mm beside its stated place, on a perfect machine without noise."""
    from ex06_step import standard
    from ex08_virtual_probing import probed

    from matstd.diagnosis.regression import solve
    from matstd.probe_paths.campaign import foot_points as foot
    from matstd.sensitivity.population import Population
    from matstd.twin.effects import setup_errors
    from matstd.twin.frames import pose
    from matstd.twin.model import columns as columns_of
    from matstd.twin.record import Setup, Touches

    chain, made, rng = read_machine(MACHINE), standard(), np.random.default_rng(0)
    beside = pose(t=np.array([0.4, 0.3, 0.0]))
    run = probed(Population(chain), [], rng, noise=0.0, setup_error=beside)
    t = run.touches
    ball = tip(chain, t.q, t.length)  # the stated set-up is the table frame itself
    point, normal = foot(made, t.feature, ball)
    kept = Touches(
        chain, t.q, t.length, t.radius, point, normal, (Setup("a"),), t.setup, t.time, t.approach
    )
    deviation = np.einsum("ni,ni->n", normal, ball - point) - t.radius
    X = columns_of(setup_errors(kept), kept)
    left = solve(X * 1e6, deviation * 1e6).residual / 1e6
    return {
        "foot points at the stated place, set-up fitted linearly": f"{_rms(left):.2f} µm rms",
        "worst touch of those": f"{np.abs(left).max() / UM:.1f} µm",
        "foot points anew after every step of the fit": f"{_rms(run.deviation):.6f} µm rms",
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) / UM


def step_file() -> dict[str, str]:
    """Our AP242 writer against build123d's export_step, on the standard of example 6."""
    from ex06_step import standard

    from matstd.cad_out.verify import export_standard

    made = standard()
    with tempfile.TemporaryDirectory() as folder:
        ours = export_standard(made, folder, chord=0.05)
        code = (
            "import sys; from build123d import Solid, export_step\n"
            "from matstd.artefact.body import read_standard\n"
            "from matstd.cad_out.details import details_of\n"
            "from matstd.cad_out.kernel.solid import build_solid\n"
            "standard = read_standard(sys.argv[1])\n"
            "built = build_solid(standard, details_of(standard))\n"
            "export_step(Solid(built.shape), sys.argv[2])\n"
        )
        from matstd.artefact.body import write_standard

        source, theirs = Path(folder) / "standard.toml", Path(folder) / "theirs.step"
        write_standard(source, made)
        subprocess.run([sys.executable, "-c", code, source, theirs], check=True, cwd=ROOT)
        text = theirs.read_text(encoding="latin-1")
        schema = text.split("FILE_SCHEMA", 1)[1].split(";", 1)[0].strip()
    named = sum(f"'{name}'" in text for name in ours.names)
    return {
        "faces named, our writer": f"{len(ours.names)} of {len(ours.names) + len(ours.missing)}",
        "largest deviation of a face": f"{ours.worst_face[1] / UM:.0e} µm",
        "faces named, export_step of the same solid": f"{named} of {len(ours.names)}",
        "schema, export_step": schema,
    }


def heavy() -> dict[str, str]:
    """What imports cost, each in a fresh process."""
    out = {}
    for name in ("OCP.BRepAlgoAPI", "build123d", "pydantic", "scipy.stats", "pyvista"):
        code = (
            f"import time; t = time.perf_counter(); import {name}\n"
            "m = int(open('/proc/self/status').read().split('VmHWM:')[1].split()[0]) / 1024\n"
            "print(f'{time.perf_counter() - t:.2f} s, {m:.0f} MB')"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        )
        out[f"import {name}"] = done.stdout.split("\n")[0]

    def help_page() -> None:
        subprocess.run(
            [sys.executable, "-m", "matstd", "--help"], check=True, capture_output=True, cwd=ROOT
        )

    out["matstd --help"] = f"{_seconds(help_page, 3):.2f} s"
    return out


def clearance() -> dict[str, str]:
    """Room for the probe at touches, from distances to convex bodies."""
    from ex06_step import standard

    from matstd.artefact.reach import clearance
    from matstd.probe_paths.plan import Probe

    made = standard()
    rng = np.random.default_rng(0)
    centre = rng.uniform([-140, -140, 35], [140, 140, 200], (2000, 3))
    axis = rng.normal(size=(2000, 3)) * 0.5 + [0.0, 0.0, 1.0]
    seconds = _seconds(lambda: clearance(made, centre, axis, Probe().shape), 2)
    return {"touches a second, 12 bodies": f"{2000 / seconds:.0f}"}


PARTS = (columns, terms, location, foot_points, step_file, heavy, clearance)


def main() -> None:
    """Print every figure, or those of the parts named."""
    sys.path.append(str(EXAMPLES))
    for part in PARTS:
        if len(sys.argv) > 1 and not any(word in part.__name__ for word in sys.argv[1:]):
            continue
        print(f"{part.__name__}: {(part.__doc__ or '').splitlines()[0]}")
        for what, value in part().items():
            print(f"    {what}: {value}")


if __name__ == "__main__":
    main()
