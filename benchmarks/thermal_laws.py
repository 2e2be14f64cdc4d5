"""How long the identification of an ARX law takes: a day at one row a minute, 20 sensors.

    python benchmarks/thermal_laws.py

Prints seconds of processor for choosing poles, orders and sensors and fitting, inside all of it.
"""

import time

import numpy as np

from matstd.diagnosis.drift import DriftRecord, offered
from matstd.twin.units import UM

ROWS, SENSORS, STEP = 1440, 20, 60.0


def day(rng: np.random.Generator) -> DriftRecord:
    """Temperatures that wander and five drifts that follow three of them."""
    T = 20.0 + np.cumsum(0.05 * rng.standard_normal((ROWS, SENSORS)), axis=0)
    y = 1e-3 * T[:, :3] @ rng.normal(size=(3, 5)) + 1e-4 * rng.standard_normal((ROWS, 5))
    return DriftRecord(
        time=np.arange(ROWS) * STEP,
        stretch=np.zeros(ROWS, dtype=np.int64),
        step=STEP,
        drives=tuple(f"t{k}" for k in range(SENSORS)),
        drive=T,
        components=tuple("xyzab"),
        units=("mm",) * 5,
        displacement=y,
    )


def main() -> None:
    """Measure once; it takes seconds."""
    record = day(np.random.default_rng(1))
    begin = time.process_time()
    law = offered(record, networks=False)["arx"](record, np.array_split(np.arange(ROWS), 4))
    spent = time.process_time() - begin
    print(f"ARX of {ROWS} rows, {SENSORS} sensors, 5 drifts: {spent:.2f} s of processor")
    left = np.sqrt(np.mean((law.predicted(record) - record.displacement) ** 2)) / UM
    print(f"left {left:.2f} µm of 0.10 µm of noise")


if __name__ == "__main__":
    main()
