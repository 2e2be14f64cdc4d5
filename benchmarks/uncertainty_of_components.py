"""What the stated uncertainty of a task covers where the machine's errors are random numbers.

    python benchmarks/uncertainty_of_components.py [--repeats N] [--seed N]
        [--features N ...] [--visits N ...]

A machine's systematic error is the sum of normal numbers by feature, by table pose, by region of
the machine and by place, whose sizes are given; every feature's calibration is wrong by a normal
number; visits repeat within 1 µm, of which 0.2 µm moves all places alike. U is evaluated from that
alone, and the probability that it covers a result at a new feature, pose, region and place in a new
visit is known exactly. Wanted: 93 to 97 %, averaged over machines. Where the calibration is as
uncertain as the error that is looked for, faces cannot distinguish the two: too much is covered
where there is no such error, too little where there is.
"""

import argparse
import itertools

import numpy as np
from scipy.stats import norm

from matstd.diagnosis.task import Visits, task_uncertainty

SIZES = (0.0, 0.3, 1.0, 3.0, 10.0)  # of the machine's error, µm, all parts together
PARTS = {
    "feature": (1, 0, 0, 0),
    "pose": (0, 1, 0, 0),
    "region": (0, 0, 1, 0),
    "place": (0, 0, 0, 1),
    "all": (1, 1, 1, 1),
}
POSES, REGIONS = 8, 8
COMMON = 0.2  # µm, of all places of a visit


def covered(
    sizes: np.ndarray, features: int, visits: int, calibration: float, rng: np.random.Generator
) -> float:
    """Probability that U of one machine covers the next result; sizes as in `PARTS`."""
    by_feature, by_pose, by_region, by_place = sizes
    found = np.empty((visits, features, POSES))
    of_feature = by_feature * rng.normal(size=features)
    of_pose = by_pose * rng.normal(size=POSES)
    region = rng.integers(0, REGIONS, (features, POSES))
    of_region = by_region * rng.normal(size=REGIONS)
    wrong = calibration * rng.normal(size=features)
    for a in range(features):
        for b in range(POSES):
            found[:, a, b] = of_feature[a] + of_pose[b] + of_region[region[a, b]] - wrong[a]
            found[:, a, b] += by_place * rng.normal()
    found += rng.normal(0.0, np.sqrt(1.0 - COMMON**2), found.shape)
    found += rng.normal(0.0, COMMON, (visits, 1, 1))
    feature = np.repeat(np.arange(features), POSES)
    known = calibration * (feature[:, None] == np.arange(features))
    poses = np.tile(np.arange(POSES), features)
    places = feature.astype(str), poses, region.ravel()
    said = task_uncertainty(Visits(found.reshape(visits, -1), *places, known))
    sd = np.sqrt(np.sum(sizes**2) + 1.0)
    return float(norm.cdf((said.bias + said.U) / sd) - norm.cdf((said.bias - said.U) / sd))


def main() -> None:
    """Print a line for every kind of error, number of features and visits, and calibration."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--features", type=int, nargs="+", default=[3, 6, 12])
    parser.add_argument("--visits", type=int, nargs="+", default=[3, 10, 20])
    args = parser.parse_args()
    print("% within U; the machine's error in µm: " + " ".join(f"{s:9.1f}" for s in SIZES))
    for calibration, features, visits in itertools.product((0.1, 1.0), args.features, args.visits):
        what = f"calibration {calibration} µm, {features:2d} features, {visits:2d} visits"
        for number, (name, parts) in enumerate(PARTS.items()):
            shape = np.array(parts) / np.linalg.norm(parts)
            cells = []
            for size in SIZES:
                if size == 0.0 and name != "all":
                    continue
                rng = np.random.default_rng([args.seed, features, visits, number, int(10 * size)])
                p = [
                    100 * covered(size * shape, features, visits, calibration, rng)
                    for _ in range(args.repeats)
                ]
                cells.append(f"{np.mean(p):4.1f} ± {np.std(p) / np.sqrt(len(p)):3.1f}")
            print(f"{what}, by {name:7}: " + "  ".join(cells).rjust(58), flush=True)


if __name__ == "__main__":
    main()
