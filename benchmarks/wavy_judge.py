"""Signals of a designed wavy face against rings and grids of balls, by code of its own.

    python benchmarks/wavy_judge.py OUT [--noise-um 1] [--scan-um 2] [--stretch 8]

OUT is a folder of `matstd design examples/wavy_face.toml`, of which only the files are read:
`run.csv` (touches), `scan_path.csv` (lines of the scan) and, for the sides of the base,
`standard.toml`. Numpy alone judges; nothing of this project is imported. The machine has three
axes and one table pose, so that a smooth error g of one direction shows as ``n_d g(q)``.

What explains a deviation is projected out, with a prior: set-up (6 numbers of 1 mm and mrad),
three component errors and three rotations of every axis as polynomials up to the third degree
(50 um and urad), the centre of every ball (0.3 um), position and rotations of the face (1 um,
10 urad) and its form (0.3 um, alike over 6 mm). The signal of a field is the root of its mean
square in units of noise. Rivals are 13, 25 and 49 balls at the places of 40 random layouts that
are best for their least signal, 300 touches each, between the equator and the top.
"""

import argparse
import csv
import tomllib
from pathlib import Path

import numpy as np

WIDTHS = (40.0, 25.0)
BUMPS = (40.0, 20.0)
SIZE = 2e-3  # mm
TILTS = ((90.0, 60.0, 90.0, 5.0), (90.0, 45.0, 75.0, 5.0), (80.0, 60.0, 45.0, 5.0))
"""Directions of touches on a ball against its top, degrees; the best of these is taken."""


def rows(path):
    """Records of a CSV file without its comments."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def columns(table, names):
    return np.array([[float(row[name]) for name in names] for row in table])


def explained(p, q, n, feature, tip):
    """Columns of all that is known to be possible, times the size of its prior, mm."""
    arm = np.cross(p, n)  # of a rotation about the origin of the standard
    out = [n, 1e-3 * arm]
    scaled = (q - q.mean(axis=0)) / 150.0
    lever = np.cross(q - q.mean(axis=0) + tip, n)
    for k in range(3):
        for power in (1, 2, 3):
            shape = scaled[:, [k]] ** power
            out += [0.05 * shape * n, 5e-5 * shape * lever]
    for name in np.unique(feature):
        mine = (feature == name)[:, None]
        if name.startswith("SPH"):
            out.append(0.3e-3 * mine * n)
            continue
        middle = p[mine[:, 0]].mean(axis=0)
        out += [1e-3 * mine * n, 1e-5 * mine * np.cross(p - middle, n)]
    return np.hstack(out)


def signals(p, q, n, u, feature, tip):
    """Signal of every field and bump along X, Y and Z, (4, 3)."""
    size = len(p)
    cov = np.diag(u**2)
    face = np.array([name.startswith("FF") for name in feature])
    apart = np.sum((p[:, None] - p) ** 2, axis=-1)
    cov += np.outer(face, face) * 0.3e-3**2 * np.exp(-0.5 * apart / 6.0**2)
    B = explained(p, q, n, feature, tip)
    cov += B @ B.T
    inverse = np.linalg.inv(cov + 1e-18 * np.eye(size))
    out = []
    for width in WIDTHS:
        K = SIZE**2 * np.exp(-2.0 * np.log(2.0) * np.sum((q[:, None] - q) ** 2, axis=-1) / width**2)
        out.append([np.sqrt(np.sum(inverse * K * np.outer(n[:, d], n[:, d]))) for d in range(3)])
    rng = np.random.default_rng(0)
    places = rng.uniform(q.min(axis=0), q.max(axis=0), (40, 3))
    for width in BUMPS:
        square = np.zeros(3)
        for k in range(3):
            span = max(np.ptp(places[:, k]), width)
            peak = SIZE * np.sqrt(span / (width * np.sqrt(np.pi / (8.0 * np.log(2.0)))))
            g = peak * np.exp(-4.0 * np.log(2.0) * (q[:, [k]] - places[:, k]) ** 2 / width**2)
            for d in range(3):
                f = n[:, [d]] * g
                square[d] += np.mean(np.sum(f * (inverse @ f), axis=0)) / 3.0
        out.append(np.sqrt(square))
    return np.array(out)


def rival(count, half, tip, noise, rng):
    """The best of 40 random layouts of balls of 25 mm on a base."""
    best = None
    for number in range(40):
        centres, tilts = [], TILTS[number % len(TILTS)]
        while len(centres) < count:
            c = np.append(rng.uniform(12.5 - half, half - 12.5), rng.uniform(58.0, 112.0))
            if all(np.linalg.norm(c[:2] - other[:2]) > 26.0 for other in centres):
                centres.append(c)
            elif rng.random() < 1e-4:
                centres = []
        each = 300 / count
        p, n, feature = [], [], []
        for k, c in enumerate(centres):
            for j in range(int((k + 1) * each) - int(k * each)):
                phi = 2.399963 * (j + k)  # the golden angle
                tilt = np.radians(tilts[j % 4])
                d = np.array([np.sin(tilt) * np.cos(phi), np.sin(tilt) * np.sin(phi), np.cos(tilt)])
                p.append(c + 12.5 * d)
                n.append(d)
                feature.append(f"SPH{k}")
        p, n = np.array(p), np.array(n)
        found = signals(p, p + 3.0 * n, n, np.full(len(p), noise), np.array(feature), tip)
        if best is None or found.min() > best.min():
            best = found
    return best


def line(name, found):
    print(f"{name:38s} " + "   ".join(" / ".join(f"{v:5.2f}" for v in row) for row in found))


def main():
    """Print signals and ratios."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--noise-um", type=float, default=1.0)
    parser.add_argument("--scan-um", type=float, default=2.0)
    parser.add_argument("--stretch", type=float, default=8.0, help="of line in one mean, mm")
    args = parser.parse_args()
    noise, tip = 1e-3 * args.noise_um, np.array([0.0, 0.0, -160.0])
    made = tomllib.loads((args.folder / "standard.toml").read_text(encoding="utf-8"))
    half = np.array(made["base"]["half_size_mm"])
    table = rows(args.folder / "run.csv")
    p, n = (columns(table, names) for names in (("px_mm", "py_mm", "pz_mm"), ("nx", "ny", "nz")))
    feature = np.array([row["feature"] for row in table])
    rng = np.random.default_rng(1)
    some = np.sort(rng.permutation(len(p))[:300])
    q = p + 3.0 * n
    touched = signals(p[some], q[some], n[some], np.full(300, noise), feature[some], tip)
    scan = rows(args.folder / "scan_path.csv")
    sp, sn = (columns(scan, names) for names in (("x_mm", "y_mm", "z_mm"), ("nx", "ny", "nz")))
    # a mean of as many recorded points as lie within a square of the stretch
    cell = np.floor(sp[:, :2] / args.stretch).astype(int)
    _, at, inverse, many = np.unique(
        cell, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    middle = np.array([np.mean(sp[inverse.ravel() == k], axis=0) for k in range(len(at))])
    near = np.array([np.argmin(np.sum((sp - m) ** 2, axis=1)) for m in middle])
    balls = np.flatnonzero([name.startswith("SPH") for name in feature])
    balls = np.sort(rng.permutation(balls)[:150])
    both_p, both_n = np.vstack([p[balls], sp[near]]), np.vstack([n[balls], sn[near]])
    u = np.concatenate([np.full(len(balls), noise), 1e-3 * args.scan_um / np.sqrt(many)])
    names = np.concatenate([feature[balls], np.full(len(near), "FF1")])
    scanned = signals(both_p, both_p + 3.0 * both_n, both_n, u, names, tip)
    print(f"{'':38s} fields 40 mm: X / Y / Z   25 mm   bumps of one axis 40 mm   20 mm")
    line("300 touches of the design", touched)
    line(f"150 touches on balls, {len(sp)} of a scan", scanned)
    for count in (13, 25, 49):
        found = rival(count, half, tip, noise, rng)
        line(f"{count} balls", found)
        line("  touched over these", touched / found)
        line("  scanned over these", scanned / found)


if __name__ == "__main__":
    main()
