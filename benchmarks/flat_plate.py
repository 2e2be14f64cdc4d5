"""A flat plate touched along Z: noise alone, and a lag, over many seeds.

    python benchmarks/flat_plate.py [-n RUNS]

The reading of Z holds what was measured. Regressed on it, noise "varies with Z".
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fixtures"))
from flat_plate import lag, write_plate

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.twin.files import read_run


def main() -> None:
    """Count what is right."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=60, help="runs of each kind (60)")
    count = parser.parse_args().n
    empty, lags = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(count):
            empty += diagnose(read_run(write_plate(folder, seed))).verdict is Verdict.NONE
            found = diagnose(read_run(write_plate(folder, seed, lag)))
            kinds = [step.effect.kind for step in found.steps if step.effect is not None]
            lags += found.verdict is Verdict.MISSING and kinds == ["thermal-lag"]
    print(f"noise alone: nothing found in {empty} of {count}; a lag of 10 µm: found, and nothing")
    print(f"else, in {lags} of {count}")


if __name__ == "__main__":
    main()
