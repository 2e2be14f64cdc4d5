"""False alarms and power of control charts: histories of normal values, with and without a step.

    python benchmarks/trend_alarms.py

Every history has 20 quantities whose true scatter is a multiple of the stated uncertainty; the
second figure is the share of steps of 6 s in the middle of one of them that are found at their
place.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np

from matstd.diagnosis.charts import Charted, History, Occasion, Overall, history
from matstd.diagnosis.geometry import Estimate
from matstd.twin.frames import Array
from matstd.twin.machine import Chain

QUANTITIES, HISTORIES = 20, 100


def made(values: Array, chain: Any) -> History:
    """A history of values (runs, quantities) with unit uncertainty."""
    keys = [Charted(Overall.EFFECT, f"q{k}") for k in range(values.shape[1])]
    return history(
        [
            Occasion(
                name=f"run {i:03d}",
                date=None,
                chain=chain,
                standard="",
                prints=(str(i),),
                touches=100,
                values=dict(zip(keys, map(lambda v: Estimate(float(v), 1.0), row), strict=True)),
            )
            for i, row in enumerate(values)
        ]
    )


def main() -> None:
    rng = np.random.default_rng(1)
    chain: Chain | Any = SimpleNamespace(difference=lambda _: None)
    print("runs  scatter/stated  histories with a false alarm  steps of 6 s found")
    for runs in (3, 4, 6, 10, 20):
        for factor in (0.7, 1.0, 2.0, 3.0):
            alarms = found = 0
            for _ in range(HISTORIES):
                values = rng.normal(0.0, factor, (runs, QUANTITIES))
                alarms += bool(made(values, chain).changed)
                values[runs // 2 :, 0] += 6.0 * factor
                chart = next(c for c in made(values, chain).charts if c.of.symbol == "q0")
                found += [step.after for step in chart.course.steps] == [runs // 2]
            print(f"{runs:4}  {factor:14}  {alarms / HISTORIES:28.2f}  {found / HISTORIES:18.2f}")


if __name__ == "__main__":
    main()
