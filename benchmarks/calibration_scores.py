"""Errors of calibrations of pieces with known truth, over their stated uncertainties.

    python benchmarks/calibration_scores.py [-n 20] [--without-lines]

Sets of points come from `tests/oracles/cmm_sets.py`, which shares no code with the calibration:
waves of 8 to 15 mm on the faces, an error that the points of a feature share, one scale of the CMM.
The root mean square of every score is to lie between 0.8 and 1.2; without dense lines the waves are
an assumption of the user, which these pieces exceed.
"""

import tempfile
import tomllib
from pathlib import Path

import numpy as np
from harness import parser_of  # puts the oracles on the path


def main() -> None:
    """Print the scores of every kind of feature."""
    import cmm_sets

    from matstd.api.standards import calibrate, read_standard

    parser = parser_of(__doc__)
    parser.add_argument("standard", help="standard.toml of a design")
    parser.add_argument("-n", type=int, default=20, help="pieces (20)")
    parser.add_argument("--waves-um", type=float, default=0.7, help="rms of the waves, µm (0.7)")
    parser.add_argument("--without-lines", action="store_true", help="no dense lines")
    args = parser.parse_args()
    file, nominal = tomllib.loads(Path(args.standard).read_text()), read_standard(args.standard)
    parts: tuple[list[np.ndarray], ...] = ([], [], [])
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(args.n):
            piece = cmm_sets.Piece(file, seed, args.waves_um * cmm_sets.UM)
            points = Path(folder) / "cmm.csv"
            cmm_sets.write_rows(points, piece.rows(not args.without_lines))
            found = calibrate(
                nominal,
                points,
                u=cmm_sets.U_POINT,
                u_feature=cmm_sets.U_FEATURE,
                u_scale=cmm_sets.U_SCALE,
                body_u=0.0,
                accept=True,
            )
            found.save(Path(folder) / "made.toml")
            made = tomllib.loads((Path(folder) / "made.toml").read_text())
            for part, one in zip(
                parts, cmm_sets.scores(file, made, piece, np.random.default_rng(seed)), strict=True
            ):
                part.append(one)
    for name, part in zip(("distances of balls", "radii", "faces"), parts, strict=True):
        z = np.concatenate(part)
        print(f"{name:20s} {len(z):5d} scores, rms {np.sqrt(np.mean(z**2)):.2f}, "
              f"within 2 u {100 * np.mean(np.abs(z) <= 2.0):.1f} %")  # fmt: skip


if __name__ == "__main__":
    main()
