"""What the stated uncertainty of a measuring task covers: new places of workpieces, new machines.

    python benchmarks/task_uncertainty.py OUT PROJECT.toml [--machines N] [--visits N] [--first N]
        [--store FOLDER]

OUT is a folder that `matstd design` made of the brief. The emitted programs probe every machine
on the exact twin in several visits, the standard clamped anew and with calibration errors, the
model is identified from the balls of the first, and U is evaluated from the faces. Then workpieces
are measured on the same machine that have nothing of the standard but its datum balls: points
anywhere in the box of the faces, normals of the slopes of its touches in any azimuth, table poses
between those probed. Wanted: 93 to 97 % of the results, corrected by b, within U of the truth.

A machine takes 8 s of processor. With `--store` what it measured is kept and read by later calls:
many machines can be done in pieces, and U is computed of all of them with the code that is there.
"""

import argparse
import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard, read_standard
from matstd.artefact.brief import Brief, Task, read_project
from matstd.artefact.certify import displaced_features, like_task, that_prove
from matstd.artefact.worth import Calibration
from matstd.diagnosis.fit import Prior, fit_run
from matstd.diagnosis.task import Visits, task_uncertainty
from matstd.probe_paths.campaign import check_moves, visits
from matstd.probe_paths.control import ReadProgram, read_program
from matstd.sensitivity.population import drawn_errors
from matstd.stages.budgets import CLAMPING_SCATTER, UNCORRECTED, places_of
from matstd.stages.design import _twin
from matstd.twin.effects import setup_errors
from matstd.twin.frames import Array, pose, rotation
from matstd.twin.machine import inverse_linear
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Run, Touches

RESULTS = 400  # on workpieces, a machine
LEARNT = "with the identified model"
NAMES = (UNCORRECTED, LEARNT)
_KEYS = ("deviation", "face", "pose", "region", "shared")


@dataclass(frozen=True, eq=False)
class Measured:
    """Visits to one machine, and its errors on workpieces in mm, placed and corrected alike."""

    visits: Visits
    wrong: Array


def workpieces(run: Run, standard: Standard, rng: np.random.Generator) -> Touches:
    """Touches on surfaces without a calibration, in the volume of the faces, at new poses."""
    t = run.touches
    chain, setup = t.chain, t.setups[0]
    like = t[like_task(Task(), standard, t)]
    rotary = chain.rotary_columns
    low, high = like.point.min(axis=0), like.point.max(axis=0)
    limits = np.array([link.range for link in chain.links if link.kind != "fixed"])
    kept = []
    while sum(map(len, kept)) < RESULTS:
        k = rng.integers(0, len(like), RESULTS)
        q = like.q[k].copy()
        q[:, rotary] = rng.uniform(
            like.q[:, rotary].min(0), like.q[:, rotary].max(0), (RESULTS, len(rotary))
        )
        slope = np.arccos(like.normal[k, 2])
        azimuth = rng.uniform(-np.pi, np.pi, RESULTS)
        normal = np.stack(
            [np.sin(slope) * np.cos(azimuth), np.sin(slope) * np.sin(azimuth), np.cos(slope)], -1
        )
        point = rng.uniform(low, high, (RESULTS, 3))
        ball = point + like.radius[k, None] * normal
        place = ball @ setup.T_table_artefact[:3, :3].T + setup.T_table_artefact[:3, 3]
        q = inverse_linear(chain, place, q, float(like.length[0]))
        good = np.all((q >= limits[:, 0]) & (q <= limits[:, 1]), axis=1)
        kept.append(replace(like[k], q=q, point=point, normal=normal)[good])
    pieces = kept[0]
    for more in kept[1:]:
        pieces = pieces if len(pieces) >= RESULTS else more
    return pieces


def errors_of(
    truth: list[tuple[Effect, Array]],
    run: Run,
    pieces: Touches,
    standard: Standard,
    models: dict[str, tuple[Model, Prior] | None],
    noise: float,
    rng: np.random.Generator,
) -> dict[str, Array]:
    """Errors of results on workpieces that stand on the standard's datum balls, mm."""
    t = run.touches
    datum = t[~that_prove(standard, t)]
    real = Model(t.chain, tuple(e for e, _ in truth))
    theta = np.concatenate([np.atleast_1d(x) for _, x in truth])
    free = setup_errors(t)
    S, S_piece = columns(free, datum), columns(free, pieces)
    y = real.deviation(datum, theta) + noise * rng.normal(size=len(datum))
    y_piece = real.deviation(pieces, theta) + noise * rng.normal(size=len(pieces))
    out = {}
    for name, model in models.items():
        left, left_piece = y, y_piece
        if model is not None:
            left = y - model[0].columns(datum) @ model[1].mean
            left_piece = y_piece - model[0].columns(pieces) @ model[1].mean
        out[name] = left_piece - S_piece @ np.linalg.lstsq(S, left, rcond=1e-9)[0]
    return out


def machine(
    brief: Brief,
    standard: Standard,
    known: Calibration,
    programs: tuple[ReadProgram, ...],
    number: int,
    rng: np.random.Generator,
) -> dict[str, Measured]:
    """What one machine's visits found, and its errors on workpieces, by what corrects results."""
    truth = drawn_errors(brief.population, rng)
    true, twin = displaced_features(standard, known, rng), _twin(brief, truth)
    stands = [
        replace(twin, setup_error=pose(rotation(rng.normal(0.0, b, 3)), rng.normal(0.0, a, 3)))
        for a, b in [CLAMPING_SCATTER] * number
    ]
    runs = [c.run for c in visits(programs, true, stands, rng, calibrated=standard)]
    held_back = np.where(that_prove(standard, runs[0].touches), "test", "train")
    fit = fit_run(replace(runs[0], split=held_back), brief.population.expected())
    count = len(fit.model.parameters)
    models = {
        UNCORRECTED: None,
        LEARNT: (fit.model, Prior(fit.theta[:count], np.zeros((count, count)))),
    }
    found = places_of(runs, standard, known, Task(), models)
    pieces = workpieces(runs[0], standard, rng)
    wrong = errors_of(truth, runs[0], pieces, standard, models, brief.noise, rng)
    return {name: Measured(seen, wrong[name]) for name, seen in found.items()}


def stored(path: Path, of: str) -> dict[str, Measured]:
    """What an earlier call measured on a machine."""
    with np.load(path) as table:
        if str(table["of"]) != of:
            raise SystemExit(f"{path}: of another standard, project or number of visits")
        return {
            name: Measured(
                Visits(*(table[f"{name} {key}"] for key in _KEYS)), table[f"{name} wrong"]
            )
            for name in NAMES
        }


def store(path: Path, of: str, found: dict[str, Measured]) -> None:
    """Keep what was measured; whole or not at all."""
    table = {"of": np.array(of)}
    for name, one in found.items():
        table |= {f"{name} {key}": np.asarray(getattr(one.visits, key)) for key in _KEYS}
        table[f"{name} wrong"] = one.wrong
    beside = path.with_suffix(".part")
    with beside.open("wb") as file:
        np.savez_compressed(file, **table)
    beside.replace(path)


def covered(one: Measured) -> Array:
    """Coverage corrected by b and not, U and rms error in µm."""
    found = task_uncertainty(one.visits)
    return np.array(
        [
            np.mean(np.abs(one.wrong - found.bias) <= found.U),
            np.mean(np.abs(one.wrong) <= found.U_uncorrected),
            found.U / 1e-3,
            np.sqrt(np.mean(one.wrong**2)) / 1e-3,
        ]
    )


def main() -> None:
    """Print a line a machine, and what they say together."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("project", type=Path)
    parser.add_argument("--machines", type=int, default=200)
    parser.add_argument("--visits", type=int, default=10)
    parser.add_argument("--first", type=int, default=0, help="number of the first machine")
    parser.add_argument(
        "--store", type=Path, help="folder for what every machine measured; it is done once"
    )
    args = parser.parse_args()
    brief = read_project(args.project)
    standard = read_standard(args.out / "standard.toml")
    paths = sorted((args.out / "programs").glob("*_[0-9]*.H"))
    texts = [p.read_bytes() for p in (args.project, args.out / "standard.toml", *paths)]
    of = hashlib.sha256(b"".join([*texts, str(args.visits).encode()])).hexdigest()
    programs: tuple[ReadProgram, ...] = ()
    rows: dict[str, list[Array]] = {name: [] for name in NAMES}
    for k in range(args.first, args.first + args.machines):
        file = args.store / f"machine-{k:04d}.npz" if args.store else None
        if file and file.exists():
            found = stored(file, of)
        else:
            programs = programs or checked(paths, standard, brief)
            rng = np.random.default_rng([brief.seed, k])
            found = machine(brief, standard, Calibration(), programs, args.visits, rng)
            if file:
                file.parent.mkdir(parents=True, exist_ok=True)
                store(file, of, found)
        for name, one in found.items():
            rows[name].append(covered(one))
            print(f"{k} {name}: " + " ".join(f"{x:.3f}" for x in rows[name][-1]), flush=True)
    for name, table in rows.items():
        print(f"{name}: {summary(np.array(table))}")


def checked(paths: list[Path], standard: Standard, brief: Brief) -> tuple[ReadProgram, ...]:
    """The programs, read and checked once for all machines."""
    programs = tuple(read_program(path, brief.chain) for path in paths)
    for program in programs:
        check_moves(program, standard, brief.chain)
    return programs


def summary(table: Array) -> str:
    """Coverage of all machines together, with its standard uncertainty from their spread."""
    cover, plain, U, wrong = table.T
    u = np.std(table[:, :2], axis=0, ddof=1) / np.sqrt(len(table)) if len(table) > 1 else [1.0, 1.0]
    return (
        f"{len(table)} machines, U {np.median(U):.2f} µm (median), errors "
        f"{np.sqrt(np.mean(wrong**2)):.2f} µm rms; within U {100 * cover.mean():.1f} "
        f"± {100 * u[0]:.1f} % (corrected by b), {100 * plain.mean():.1f} ± {100 * u[1]:.1f} % "
        "(not corrected)"
    )


if __name__ == "__main__":
    main()
