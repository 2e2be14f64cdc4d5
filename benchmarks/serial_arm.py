"""The diagnosis of a serial arm under a tracker, beside a Gauss-Newton that shares no code.

    python benchmarks/serial_arm.py [--poses 60] [--runs 3] [--play 0] [--gross 0]

The arm, its errors, the sag of its second joint and the tracker are simulated here by products of
exponentials. The other one is least squares without a prior over every number that such poses may
determine: points, tilts and zeros of all lines, two weights, tracker and reflector; the rest is
left at zero. Held out are poses, one after the other. With play every joint is off by something of
its own in every pose, and nothing but the sag may be named. Gross errors are poses that read wrong
by 0.3 to 1 mm; exactly these may be left out.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1])]

NAMES = ("C1", "B2", "B3", "A4", "B5", "A6")
LINES = np.array([(0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0)], dtype=float)
POINTS = np.array(
    [(0, 0, 0), (350, 0, 675), (350, 0, 1825), (350, 0, 1866), (1550, 0, 1866), (1765, 0, 1866)],
    dtype=float,
)
REFLECTOR = np.array([1790.0, 62.0, 1783.0])
LOW, HIGH = np.radians([[-100, -45, -35, -150, -100, -170], [100, 55, 60, 150, 100, 170]])
NOISE = 0.015
TRUTH = {"EB0B3": -180.0, "EB0B5": 320.0, "a(B2,B3)": 300.0}
SAG = np.array([99e-6, 121e-6])
"""Of joint B2, rad a metre of lever of the upper arm's and of the forearm's weight."""


def about(axis, angle):
    """Rotation about a unit vector."""
    K = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def seen(q, p):
    """Places of the reflector; p: points, tilts, zeros, weights, reflector, base, (53,)."""
    points = POINTS + p[:18].reshape(6, 3)
    tilts = p[18:36].reshape(6, 3)
    lines = LINES + np.cross(tilts, LINES)
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    out = []
    for angles in q:
        upper = 1.15 * np.sin(angles[1])
        lever = np.array([0.45 * upper, upper + 0.5 * np.cos(angles[1] + angles[2])])
        turned = angles + p[36:42]
        turned[1] += p[42:44] @ lever
        x = REFLECTOR + p[44:47]
        for i in range(5, -1, -1):
            x = about(lines[i], turned[i]) @ (x - points[i]) + points[i]
        out.append(x)
    base = about([1, 0, 0], p[50]) @ about([0, 1, 0], p[51]) @ about([0, 0, 1], p[52])
    return np.array(out) @ base.T + p[47:50]


def truth():
    p = np.zeros(53)
    p[36:42] = [0.0, 0.0, TRUTH["EB0B3"] * 1e-6, 0.0, TRUTH["EB0B5"] * 1e-6, 0.0]
    p[[8, 11, 14, 17, 46]] = TRUTH["a(B2,B3)"] * 1e-3  # all behind the upper arm stands higher
    p[42:44] = SAG
    return p


def least_squares(q, places):
    """Error of left-out poses of the fit to all others, and the scatter about the whole, mm."""
    scale = np.concatenate([np.ones(18), np.full(26, 1e-3), np.ones(6), np.full(3, 1e-3)])
    p = np.zeros(53)
    for _ in range(5):
        left = (places - seen(q, p)).ravel()
        J = np.stack(
            [(seen(q, p + 0.01 * scale * e) - seen(q, p)).ravel() / 0.01 for e in np.eye(53)], 1
        )
        U, S, V = np.linalg.svd(J, full_matrices=False)
        rank = int((2e-5 * S[0] < S).sum())
        p = p + scale * (V[:rank].T @ ((U[:, :rank].T @ left) / S[:rank]))
    left = (places - seen(q, p)).ravel()
    errors = []
    for k in range(len(q)):
        own = U[3 * k : 3 * k + 3, :rank]
        errors.append(np.linalg.solve(np.eye(3) - own @ own.T, left[3 * k : 3 * k + 3]))
    dof = len(left) - rank
    return float(np.sqrt(np.mean(np.square(errors)))), float(np.sqrt(left @ left / dof)), rank


def diagnosed(folder, q, places):
    """The diagnosis of the same poses, by a run file."""
    from matstd.diagnosis.answer import diagnose
    from matstd.twin.files import read_run

    zero = REFLECTOR
    text = ['format = "machine/1"', 'name = "arm"', f'chain = "[w f {" ".join(NAMES)} t]"']
    for name, low, high, point in zip(NAMES, LOW, HIGH, POINTS - zero, strict=True):
        ends = [round(float(np.degrees(v))) for v in (low, high)]
        text += [f"[axis.{name}]", f"range = {ends}", f"point = {point.tolist()}"]
    text += ["[workpiece]", f"origin = {(-zero).tolist()}"]
    (folder / "arm.toml").write_text("\n".join(text))
    rows = [
        '# format = "run/1"\n# machine = "arm.toml"\n# instrument = "tracker"',
        f"# probe = {{ radius_mm = 0.0, length_mm = 0.0 }}\n# u_um = {1e3 * NOISE}",
        ",".join([*(f"{n}_deg" for n in NAMES), "px_mm,py_mm,pz_mm,nx,ny,nz,pose"]),
    ]
    for k, (angles, place) in enumerate(zip(np.degrees(q), places, strict=True)):
        for normal in ("1,0,0", "0,1,0", "0,0,1"):
            numbers = ",".join(f"{v:.9f}" for v in (*angles, *place))
            rows.append(f"{numbers},{normal},{k}")
    (folder / "run.csv").write_text("\n".join(rows))
    return diagnose(read_run(folder / "run.csv"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=60)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--play", type=float, default=0.0, help="of every joint, rms, µrad")
    parser.add_argument("--gross", type=int, default=0, help="poses that read wrong")
    args = parser.parse_args()
    for seed in range(args.runs):
        rng = np.random.default_rng(seed)
        q = rng.uniform(LOW, HIGH, (args.poses, 6))
        off = 1e-6 * args.play * rng.normal(size=q.shape) if args.play else 0.0
        places = seen(q + off, truth()) + rng.normal(0.0, NOISE, (args.poses, 3))
        wrong = rng.choice(args.poses, args.gross, replace=False)
        places[wrong] += rng.uniform(0.3, 1.0, (args.gross, 3)) * rng.choice(
            [-1, 1], (args.gross, 3)
        )
        found, _, rank = least_squares(q, places)
        with tempfile.TemporaryDirectory() as folder:
            result = diagnosed(Path(folder), q, places)
        plain = float(np.sqrt(np.mean(result.fit.held_out_errors**2)))
        names = ", ".join(e.name for e in result.found) or "nothing"
        print(
            f"run {seed}: poses left out {1e3 * plain:.1f} µm, least squares of {rank} numbers "
            f"{1e3 * found:.1f} µm (noise {1e3 * NOISE:.0f}); missing: {names}"
        )
        out, wrong = set(result.run.touches.pose[result.fit.gross.rows].tolist()), set(wrong)
        print(f"  gross errors: {len(out & wrong)} of {len(wrong)}, others: {len(out - wrong)}")
        rows = {r.symbol: r for r in result.geometry.rows}
        for symbol, true in TRUTH.items():
            unit = 1e-6 if rows[symbol].unit == "rad" else 1e-3
            got = rows[symbol].estimate
            print(f"  {symbol}: {got.value / unit:.0f} ± {got.u / unit:.0f} (planted {true:.0f})")


if __name__ == "__main__":
    main()
