"""Ten lines for a machine with known errors: its deviations, and a part program without them."""

import tempfile
from pathlib import Path

import numpy as np

import matstd

PLATE = "G0 X0 Y0 Z5\nG1 Z0 F800\nG1 X300\nG1 Y200\nG1 X0\nG1 Y0\nG0 Z5\n"


def main(folder):
    files = matstd.machine_file("hmc1995"), matstd.machine_file("hmc1995", errors=True)
    ends = np.array([[-375.0, 0.0, 0.0, 0.0], [375.0, 0.0, 0.0, 0.0]])  # of X; then Z, Y, C1
    deviations = matstd.volumetric(*files, (ends, np.zeros(2)))
    datum = {"X": -150.0, "Y": -100.0, "Z": -250.0}
    machine = matstd.compensate(*files, tool_length=150.0, datum=datum)
    (folder / "plate.ngc").write_text(PLATE)
    plate = machine.program(folder / "plate.ngc", folder / "plate-compensated.ngc")
    return {"deviations": deviations.deviation, "plate": plate}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        result = main(Path(place))
    print(np.ptp(result["deviations"], axis=0) / matstd.UM, "µm over the travel of X")
