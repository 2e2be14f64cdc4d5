"""What is left between the ends of lines, by the second model of the machine in its own loop."""

import json

import numpy as np
import pytest
from bench import oracle_tip, part_program, readings

from matstd.compensation.field import State
from matstd.compensation.part_programs import Frame
from matstd.compensation.programs import compensated
from matstd.compensation.tables import header_of
from matstd.twin.units import UM

GCODE = """G0 X0 Y0 Z-20
G1 X300 F800
G2 X300 Y0 I-30 J0
G1 Y200 C20 B-10
G1 C90 F720
G0 Z0
"""
KLARTEXT = """BEGIN PGM A MM
L X+0 Y+0 Z-20 FMAX
L B-10 C+20 FMAX
M128
L X+10 Y+20 Z-25 F1500
L X+60 Y-10 Z-15 B-60 C+120
END PGM A MM
"""
INSIDE = np.linspace(0.0, 1.0, 25)


def places(text):
    """X, Y, Z, B and C at the end of every line of motion; degrees."""
    out, at = [], dict.fromkeys("XYZBC", 0.0)
    for line in text.splitlines():
        bare = line.partition(";")[0].partition("(")[0]
        words = {
            w[0]: float(w[1:]) for w in bare.split() if w[0] in "XYZBC" and w[1:2] in "+-0123456789"
        }
        if "X" in words:
            at |= words
            out.append([at[k] for k in "XYZBC"])
    return np.array(out)


def of_tool_point(xyzbc, frame):
    """Coordinates of the machine that bring the tool point to x, y, z on the turning table.

    It is linear in X, Y and Z: its place with all at zero, and one unit of each.
    """
    zero = oracle_tip(frame.datum.q[None], frame.chain, with_errors=False)[0]
    out = xyzbc.copy()
    for row in out:
        at = np.tile(row, (4, 1))
        at[:, :3] = np.vstack([np.zeros(3), np.eye(3)])
        tips = oracle_tip(readings(at, frame), frame.chain, with_errors=False)
        row[:3] = np.linalg.solve((tips[1:] - tips[0]).T, zero + row[:3] - tips[0])
    return out


def distance(points, path):
    """Largest distance of points from the nearest piece of a path."""
    start, along = path[:-1], np.diff(path, axis=0)
    size = np.maximum(np.einsum("ni,ni->n", along, along), 1e-30)
    off = points[:, None] - start
    share = np.clip(np.einsum("pni,ni->pn", off, along) / size, 0.0, 1.0)
    return np.linalg.norm(off - share[..., None] * along, axis=-1).min(axis=1).max()


def straight(a, b, n=3000):
    return a + np.linspace(0.0, 1.0, n)[:, None] * (np.array(b) - a)


def circle():
    t = np.linspace(0.0, -2.0 * np.pi, 3000)
    zero = 0.0 * t
    return np.column_stack([270 + 30 * np.cos(t), 30 * np.sin(t), zero - 20, zero, zero])


PATHS = {
    "part.ngc": (
        GCODE,
        {
            1: straight(np.array([0.0, 0, -20, 0, 0]), [300, 0, -20, 0, 0]),
            2: circle(),
            3: straight(np.array([300.0, 0, -20, 0, 0]), [300, 200, -20, -10, 20]),
            4: straight(np.array([300.0, 200, -20, -10, 20]), [300, 200, -20, -10, 90]),
        },
    ),
    "part.H": (
        KLARTEXT,
        {3: straight(np.array([10.0, 20, -25, -10, 20]), [60, -10, -15, -60, 120])},
    ),
}


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        ("part.ngc", 4.0 * UM),
        ("part.H", 1.0 * UM),
        pytest.param("part.ngc", 1.0 * UM, marks=pytest.mark.slow),
        pytest.param("part.H", 4.0 * UM, marks=pytest.mark.slow),
    ],
)
def test_the_largest_distance_is_that_of_the_second_model(
    bench_chain, datum, known, tmp_path, name, tolerance
):
    text, paths = PATHS[name]
    frame = Frame(bench_chain, datum)
    head = header_of(bench_chain, "0123456789ab", datum, State())
    done = compensated(part_program(text, frame, tmp_path, name), known, head, tolerance)
    at = places(done.text)
    assert len(at) == len(done.motion)
    aim = oracle_tip(datum.q[None], bench_chain) - oracle_tip(
        datum.q[None], bench_chain, with_errors=False
    )
    by_tool = of_tool_point if name == "part.H" else lambda values, _: values
    worst = {}
    for k, path in paths.items():
        nominal = oracle_tip(readings(by_tool(path, frame), frame), bench_chain, with_errors=False)
        rows = np.flatnonzero(done.motion == k)
        for r in rows:
            passed = at[r - 1] + INSIDE[:, None] * (at[r] - at[r - 1])
            real = oracle_tip(readings(by_tool(passed, frame), frame), bench_chain) - aim
            near = nominal[max(0, int(3000 * _begin(done, r, rows)) - 30) :]
            worst[k] = max(worst.get(k, 0.0), distance(real, near))
        own = np.nanmax(done.between[rows])
        assert own == pytest.approx(worst[k], rel=0.05, abs=0.02 * UM)
    assert 0.05 * UM < max(worst.values()) < 1.1 * tolerance
    assert done.worst_between == pytest.approx(max(worst.values()), rel=0.05)


def _begin(done, row, rows):
    """Share of its motion where a line begins, as its time says."""
    seconds = done.elapsed[[rows[0] - 1, row - 1, rows[-1]]]
    return (seconds[1] - seconds[0]) / (seconds[2] - seconds[0])


def test_the_command_states_both_and_the_limit(bench, errors_file, tmp_path, answer):
    source, output = tmp_path / "part.ngc", tmp_path / "better.ngc"
    source.write_text(GCODE)
    command = ["compensate", str(bench), "--errors", str(errors_file), "--program", str(source)]
    command += ["--tool-length", "160", "--datum", "Z=-200", "--tolerance", "2", "-o", str(output)]
    said = answer(command)
    data = json.loads(output.with_suffix(".json").read_text())
    inside, ends = data["between_line_ends"]["worst_um"], data["at_line_ends"]["after"]["worst_um"]
    assert ends < 0.6 < 1.0 < inside < 2.2
    assert f"between line ends up to {inside:.2f} µm off the path (line " in said
    assert "lines were divided down to 2.00 µm" in said
    assert "tool point at line ends" in said
    table = np.genfromtxt(output.with_suffix(".csv"), delimiter=",", names=True)
    assert np.nanmax(table["between_um"]) == pytest.approx(inside, abs=1e-3)
    assert np.isnan(table["between_um"][[0, -1]]).all()  # rapid


def test_a_reversal_is_seen_between_line_ends(bench, tmp_path, answer):
    """8 um of backlash, taken up along the first line behind the reversal: by hand.

    X errs by 8 (1 - s) um along it, the way goes at 45 degrees to X, and s = 1/4 is the place
    nearest its beginning that is looked at.
    """
    errors, source = tmp_path / "errors.toml", tmp_path / "part.ngc"
    errors.write_text('format = "errors/1"\nEXX = { shape = "linear", amplitude = 1e-3 }\n')
    source.write_text("G0 X0 Y0 Z0\nG1 X10 Y10 F900\nG1 X0 Y20\n")
    command = ["compensate", str(bench), "--errors", str(errors), "--program", str(source)]
    command += ["--tool-length", "160", "--datum", "Z=-200", "--add", "backlash(X)=8um"]
    said = answer([*command, "-o", str(tmp_path / "better.ngc")])
    assert "(line 3)" in said
    assert "except where a reversal or a load changes the correction abruptly" in said
    inside = json.loads((tmp_path / "better.json").read_text())["between_line_ends"]["worst_um"]
    assert inside == pytest.approx(8.0 * 0.75 * np.sqrt(0.5), rel=0.02)
