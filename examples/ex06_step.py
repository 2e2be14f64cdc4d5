"""A whole standard as STEP AP242 and STL, both read back and measured before they count.

Four saddles on columns, three balls, a datum plane, mounting holes with screws. The faces in
the STEP text are compared with the design by a reader that shares no code with the CAD kernel.
"""

import tempfile
from pathlib import Path

from matstd.artefact.body import Limits, check, read_standard
from matstd.cad_out.verify import export_standard
from matstd.twin.units import UM

HERE = Path(__file__).parent


def standard():
    made = read_standard(HERE / "saddles.toml")
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
