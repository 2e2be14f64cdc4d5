"""`matstd import` on every kind of table: what it prints, the run and the machine, whole."""

import json
from itertools import product

import numpy as np
import pytest
from foreign_cases import BENCH, DH, ENCODERS, HOLES, LASER, MAP
from foreign_tables import (
    BLANKS,
    CHARACTERISTICS,
    DIRECTIONS,
    KLIPPER,
    REPORT,
    SPINDLE,
    SPINDLE_MACHINE,
    SPINDLE_MAP,
)
from scipy.spatial.transform import Rotation
from written import folder_text

from matstd import machine_file
from matstd.cli import main
from matstd.twin.files import read_text
from matstd.twin.units import DEG

UNEVEN = np.array([0.0, 30.0, 70.0, 120.0, 200.0, 250.0])


def table(head: str, *columns, mark: str = ",") -> str:
    rows = ([f"{v:.6g}" for v in row] for row in zip(*columns, strict=True))
    return "\n".join([head, *(mark.join(row) for row in rows)]) + "\n"


def cycles() -> str:
    """A row a reading, both ways, three cycles; a computed mean is no reading."""
    rows = [
        (t, j, "+" if s > 0 else "-", 0.02 * t + 1.5 * s + 0.3 * ((7 * j + k) % 5 - 2))
        for j, s in product((1, 2, 3), (1, -1))
        for k, t in enumerate(UNEVEN[::s])
    ]
    lines = [f"{t:g},{j},{way},{d:.4f}" for t, j, way, d in rows]
    head = "Test of X\nLaser 5\n\ntarget_mm,cycle,direction,deviation_um"
    return "\n".join([head, *lines, "mean,,,3.1", ""])


def circle() -> str:
    a = np.arange(0.0, 360.0, 15.0)
    ccw = 3.0 * np.cos(2.0 * a * DEG) + np.sign(np.cos((a - 0.1) * DEG))
    return table("Angle [°];CCW [µm];CW [µm]", a, ccw, ccw[::-1] + 0.5, mark=";")


def arm(is_oriented: bool = False) -> str:
    """Joints, and two reflectors seen by a tracker, the second hidden once; torque and load.

    Or one target with its orientation, as a rotation vector.
    """
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (14, 6))
    rows = np.array([line.split(",") for line in DH.splitlines()[1:]], dtype=float)
    lines = ["j1,j2,j3,j4,j5,j6,x1,y1,z1,x2,y2,z2,tau2 [Nm],Fz [N],motor [°C],state"]
    for k, joints in enumerate(q):
        T = np.eye(4)
        for th, (a, alpha, d, _) in zip(joints, rows, strict=True):
            c, s, ca, sa = np.cos(th), np.sin(th), np.cos(alpha * DEG), np.sin(alpha * DEG)
            step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
            T = T @ np.array([*step, [0, 0, 0, 1]])
        noise = 0.01 * np.sin(5.0 * k + np.arange(6.0))
        places = [*(T @ [12, -35, 60, 1])[:3] + noise[:3], *(T @ [-12, 35, 50, 1])[:3] + noise[3:]]
        cells = [*(f"{v:.8f}" for v in joints / DEG), *(f"{v:.5f}" for v in places)]
        cells[9:12] = cells[9:12] if k != 4 else [""] * 3
        if is_oriented:
            turn = Rotation.from_matrix(T[:3, :3]).as_rotvec(degrees=True)
            cells[9:12] = [f"{v + 0.002 * np.cos(3.0 * k + v):.6f}" for v in turn]
        lines.append(",".join([*cells, f"{10.5 + k}", "-30", f"{35 + 0.1 * k:.1f}", "ok"]))
    if is_oriented:
        lines[0] = lines[0].replace("x1,y1,z1,x2,y2,z2", "x,y,z,rx [deg],ry [deg],rz [deg]")
    return "\n".join(lines) + "\n"


def channels() -> str:
    """Objects a line: a probing every 2 s, a temperature every 20 s."""
    lines = []
    for k in range(40):
        if k % 10 == 0:
            lines.append({"ts": 1e9 + 2.0 * k, "bed": 20.0 + k, "air": [{"temp": 18.5, "id": "C"}]})
        lines.append({"ts": 1e9 + 2.0 * k + 1.0, "steps": 0.001 * k, "ok": True})
    return "\n".join(json.dumps(line) for line in lines)


HEIGHTS = """RepRapFirmware height map file v2 generated at 2020
xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum
-20,20,5,45,-1,20.00,20.00,3,3
  0.011,  0.021,      0
 -0.012,  0.000, -0.032
  0.013,  0.023,  0.033
"""
STRAIGHT = table("position [mm],EYX [µm]", UNEVEN, [0.0, 1.2, 2.9, 2.1, 1.4, -0.7])
ANGLES = table("position [mm],up [µrad],down [µrad]", UNEVEN, UNEVEN / 20.0, UNEVEN / 25.0)
TURNS = table(
    "target [deg],up [arcsec],down [arcsec]", 30.0 * np.arange(12.0),
    *(5.0 * np.sin(30.0 * np.arange(12.0) * DEG) + way for way in (0.4, -0.3)),
)  # fmt: skip
SEVERAL = (
    f"Axis Y\n{LASER.partition(chr(10))[2]}\nAxis X\n{LASER.partition(chr(10))[2]}70,8,7,8,7\n"
)
IMPORTS = {
    "laser": ("laser.csv --positioning X --u-um 0.3", LASER),
    "cycles": ("cycles.csv --positioning X --u-um 0.3 --travel X -20 620", cycles()),
    "several": ("several.csv --positioning X --u-um 0.3", SEVERAL),
    "second": ("second.csv --positioning Y --u-um 0.3 --table 1", SEVERAL),
    "encoders": (
        "encoders.csv --positioning X --target motor --actual scale --u-um 1",
        ENCODERS,
    ),
    "rotary": ("rotary.csv --positioning C --u-urad 2", TURNS),
    "straightness": ("straightness.csv --component EYX --u-um 0.2", STRAIGHT),
    "pitch": ("pitch.csv --component EBX --u-urad 1", ANGLES),
    "circle": (
        "circle.csv --circle XY --radius 100 --feed 1500 --bar-force 20 --u-um 0.5",
        circle(),
    ),
    "beside": (
        "beside.csv --circle zx --radius 50 --u-um 0.5 --machine machine.toml --centre 5 0 -210",
        circle(),
    ),
    "part": ("part.csv --part --u-um 2 --in-order 30", HOLES),
    "standard": ("standard.csv --standard --u-um 2", HOLES),
    "directions": ("directions.csv --part --u-um 2", DIRECTIONS),
    "blanks": ("blanks.csv --part --u-um 2", BLANKS),
    "characteristics": ("characteristics.csv --part --u-um 2", CHARACTERISTICS),
    "axes": ("axes.csv --part --u-um 2 --unit mm", REPORT),
    "heights": ("heights.csv --part --u-um 5", HEIGHTS),
    "meshes": ("meshes.cfg --part --u-um 5", KLIPPER),
    "arm": ("arm.csv --arm --dh dh.csv --u-um 10", arm()),
    "oriented": ("oriented.csv --arm --dh dh.csv --u-um 10 --u-urad 40", arm(is_oriented=True)),
    "stated-arm": ("stated-arm.csv --arm --dh dh.csv --modified --u-um 10", arm()),
    "mapped": ("mapped.csv --map map.toml", BENCH),
    "channels": ("channels.json --map channels.toml", channels()),
    "clocks": ("clocks.csv --map clocks.toml", SPINDLE),
}


@pytest.mark.parametrize("name", IMPORTS)
def test_a_whole_import(name, tmp_path, monkeypatch, capsys, unchanged) -> None:
    words, text = IMPORTS[name]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    given = {words.split()[0]: text, "dh.csv": DH, "map.toml": MAP, "spindle.toml": SPINDLE_MACHINE}
    seconds = MAP.replace('{ from = "minutes", factor = 60.0 }', '{ from = "time [s]" }')
    spindle = SPINDLE_MAP.replace("machine.toml", "spindle.toml")
    given |= {"clocks.toml": spindle, "channels.toml": seconds}
    given |= {"machine.toml": read_text(machine_file("hsm600u"))}
    for file, content in given.items():
        (tmp_path / file).write_text(content, encoding="utf-8")
    code = main(["import", *words.split(), "-o", "run.csv"])
    for file in given:
        (tmp_path / file).unlink()
    said = capsys.readouterr()
    unchanged(f"{code}\n{said.out}{said.err}{folder_text(tmp_path, {})}\n")
