"""A whole standard as STEP AP242 and STL, both read back and measured before they count.

Four saddles on columns, three balls, a datum plane, mounting holes with screws. The faces in
the STEP text are compared with the design by a reader that shares no code with the CAD kernel.
"""

import tempfile
from pathlib import Path

import numpy as np

from matstd.artefact.body import OVERHANG, Limits, check
from matstd.artefact.layout import Site, standard_from_sites
from matstd.cad_out.verify import export_standard
from matstd.twin.units import DEG, UM

HERE = Path(__file__).parent


def site(azimuth, radius, height, tilt):
    square = np.array([1.0, -1.0, 1.0]) * (20.0 + OVERHANG) ** 2  # as in ex04
    heights = square[:, None] / 120.0 - square[None, :] / 180.0
    return Site(azimuth * DEG, radius, height, tilt * DEG, (20.0, 20.0), heights, degree=(2, 2))


def standard():
    places = [(0, 0, 150, 0), (0, 85, 110, 40), (120, 85, 95, 50), (240, 85, 80, 60)]
    made = standard_from_sites("SADDLES", [site(*place) for place in places])
    check(made, Limits())  # refuses what cannot be made or probed, and says which limit binds
    return made


def main(folder):
    measured = export_standard(standard(), folder, chord=0.02)
    return {
        "solids": measured.solids,
        "named faces": measured.names,
        "watertight": measured.is_watertight,
        "volume, mm3": measured.volume,
        "volume by signed distances, mm3": standard().volume(),
        "largest deviation of a face, µm": measured.worst_face[1] / UM,
    }


if __name__ == "__main__":
    from PIL import Image

    from matstd.report.scenes import draw_standard

    with tempfile.TemporaryDirectory() as scratch:
        for name, value in main(scratch).items():
            print(f"{name}: {value}")
        picture = Path(scratch) / "both_sides.png"
        draw_standard(standard(), Path(scratch) / "standard.stl", picture)
        Image.open(picture).resize((1000, 500)).save(HERE / "pictures" / "ex06.png")
