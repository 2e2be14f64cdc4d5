"""What every error adds: by hand, in sum, and by the command."""

import numpy as np
from bench import LENGTH

from matstd.cli import main
from matstd.compensation.field import contributions, deviation
from matstd.twin.numbers import rms_length as rms
from matstd.twin.units import UM


def test_each_alone_and_all_together(known, datum, poses):
    touches = known.touches(poses, LENGTH)
    shares = contributions(known, touches, datum)
    assert {s.name for s in shares} == {e.symbol.name for e in known.effects}
    sizes = [rms(s.field) for s in shares]
    assert sizes == sorted(sizes, reverse=True)
    whole = deviation(known, touches) - datum.deviation(known)
    np.testing.assert_allclose(sum(s.field for s in shares), whole, atol=0.2 * UM)


def test_one_by_hand(known, datum, bench_chain):
    """EYY of 40 µm over 300 mm at Y 150: 20 µm along y; nothing at the datum."""
    q = np.tile(datum.q, (2, 1))
    q[1, bench_chain.axis_index("Y")] = 150.0
    shares = contributions(known, known.touches(q, LENGTH), datum)
    field = next(s.field for s in shares if s.name == "EYY")
    np.testing.assert_allclose(field, [[0, 0, 0], [0, 20 * UM, 0]], atol=1e-9)


def test_command(bench, errors_file, tmp_path, answer, refusal):
    source, out = tmp_path / "part.ngc", tmp_path / "out"
    source.write_text("G0 X0 Y0 Z0\nG1 X200 F1000\nG1 B-30\nM30\n")
    command = [
        "contributions",
        str(bench),
        "--errors",
        str(errors_file),
        "--datum",
        "Z=-200",
        "--tool-length",
        "0",
    ]
    command += ["--program", str(source), "-o", str(out), "--switch", "EBX=0"]
    said = answer(command)
    assert said.startswith("all together ")
    table = np.genfromtxt(out / "contributions.csv", delimiter=",", names=True)
    assert table["X_mm"][-1] == 200.0
    assert not table["EBX_dx_um"].any()
    assert (out / "contributions.png").stat().st_size > 4_000
    poses = tmp_path / "poses.csv"
    poses.write_text("X_mm,Y_mm,Z_mm,B_deg,C_deg\n0,150,-200,0,0\n")
    command[command.index("--program") : command.index("-o") + 2] = ["--poses", str(poses)]
    assert main([*command, "-o", str(tmp_path / "at")]) == 0
    at = np.genfromtxt(tmp_path / "at" / "contributions.csv", delimiter=",", names=True)
    np.testing.assert_allclose(at["EYY_dy_um"], 20.0, atol=1e-3)
    assert "expected one of --program FILE and --poses" in refusal(
        [*command, "-o", str(tmp_path / "no"), "--program", str(source)]
    )
