"""Lines with rotary axes keep their time: by LinuxCNC's interpreter and by its motion."""

import json
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest
from bench import part_program
from control import AXES, AXIS, INI, a_user, run_linuxcnc
from rs274 import interpreted, is_there

from matstd.compensation.programs import compensated
from matstd.twin.errors import BadFile
from matstd.twin.units import UM

SAME = 0.02
"""Of a time: what a correction may change of the way of linear axes in feed per minute."""

GCODE = """G21 G90 G94 G17
G0 X0 Y0 Z-20
G4 P0.4
G1 C90 F720
G4 P0.4
G1 B-20 C120 F600
G4 P0.4
G1 X10 F300
G4 P0.4
G1 X40 Y20 C180 F400
G4 P0.4
G2 X60 Y20 I10 J0 C200 F500
G4 P0.4
G1 C205 F72
G4 P0.4
G93 G1 C120 F20
G4 P0.4
G94 G1 C100 F600
G4 P0.4
G1 C80
G4 P0.4
G1 X10 Y10 F900
G4 P0.4
G0 C0 B0
G20 G4 P0.4
G1 X1 F30
G4 P0.4
G1 C45 F360
G4 P0.4
G93 G1 B-9 F20
G4 P0.4
G94 G21
M30
"""
"""Rotary axes alone, two of them, beside a line, on an arc; slow, in inverse time, in inches."""

SECONDS = {
    4: 90 / 720 * 60,
    6: np.hypot(20, 30) / 600 * 60,
    8: 10 / 300 * 60,
    10: np.hypot(30, 20) / 400 * 60,
    12: np.pi * 10 / 500 * 60,
    14: 5 / 72 * 60,
    16: 60 / 20,
    18: 20 / 600 * 60,
    20: 20 / 600 * 60,
    22: np.hypot(50, 10) / 900 * 60,
    26: (25.4 - 10) / (30 * 25.4) * 60,
    28: 45 / 360 * 60,
    30: 60 / 20,
}
"""Of every fed line by hand: degrees over degrees a minute, mm over mm a minute, 1 over F."""


@pytest.fixture
def corrected(known, frame, head, tmp_path):
    def of(text, name="part.ngc", tolerance=1.0 * UM):
        return compensated(part_program(text, frame, tmp_path, name), known, head, tolerance)

    return of


# --- by the interpreter -----------------------------------------------------------------------


def seconds_of(text, folder):
    """Time of every line of a compensated program: its ways, over what LinuxCNC makes of F.

    The interpreter works out F of inverse time by itself, and its lowest; ways are taken from the
    text, since it prints coordinates to 0.1 um alone.
    """
    feed, feeds = 0.0, []
    for name, words in re.findall(r"([A-Z_]+)\((.*)\)", interpreted(text, folder)):
        if name == "SET_FEED_RATE":
            feed = float(words)
        elif name.startswith("STRAIGHT_"):
            feeds.append(feed if name == "STRAIGHT_FEED" else np.inf)
    at, unit, out = dict.fromkeys("XYZBC", 0.0), 1.0, []
    for line in text.splitlines():
        if found := re.search(r"\bG2[01]\b", line):
            unit = 25.4 if found[0] == "G20" else 1.0
        named = re.findall(r"([XYZBC])([-\d.]+)", line)
        new = {k: float(v) * (unit if k in "XYZ" else 1.0) for k, v in named}
        if not new or line.startswith("("):
            continue
        moved = {k: (v - at[k]) for k, v in new.items()}
        far = np.linalg.norm([moved.get(k, 0.0) for k in "XYZ"])
        turned = np.linalg.norm([moved.get(k, 0.0) for k in "BC"])
        out.append((far / unit if far > 1e-9 else turned) / feeds[len(out)] * 60.0)
        at |= new
    assert len(out) == len(feeds)
    return np.array(out), np.array(feeds)


@is_there
def test_every_line_takes_its_time(corrected, tmp_path):
    done = corrected(GCODE)
    found, feeds = seconds_of(done.text, tmp_path)
    lines = np.array([m.line for m in done.program.motions])[done.motion]
    for line, seconds in SECONDS.items():
        np.testing.assert_allclose(found[lines == line].sum(), seconds, rtol=SAME, err_msg=line)
        assert found[lines == line].max() < seconds * 1.02
    assert feeds.min() == pytest.approx(0.12, rel=0.2)  # LinuxCNC has no lower one than 0.1


@is_there
@pytest.mark.parametrize("feed", [3600, 720, 72, 36, 6, 1.2])
def test_slow_and_fast(corrected, tmp_path, feed):
    """From where LinuxCNC's lowest feed does not matter to where it always does."""
    done = corrected(f"G0 X30 Y-20 Z-20\nG1 C1 F{feed}\nG1 C31\nG1 C16\n")
    found, _ = seconds_of(done.text, tmp_path)
    lines = np.array([m.line for m in done.program.motions])[done.motion]
    for line, turned in ((2, 1.0), (3, 30.0), (4, 15.0)):
        np.testing.assert_allclose(found[lines == line].sum(), turned / feed * 60.0, rtol=0.01)
    assert np.linalg.norm(done.after, axis=1).max() < 0.6 * UM
    assert np.nanmax(done.between) < 1.0 * UM


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.ngc", "G1 X30.02 C90 F720", r"line 2: .* while X, Y, Z go 0.02 mm, .*G93"),
        (
            "a.ngc",
            "G43.4 H1\nG1 C90 F720",
            "line 3: .* no documented way .* with tool-point control",
        ),
        ("a.ngc", "G20 G1 C90 F720", "line 2: .* right behind G20 or G21"),
        ("a.ngc", "G53 G0 Z-10\nG1 Z-50 C90 F720", "line 3: .* where X, Y or Z is not known"),
        ("a.ngc", "G1 C9 F0.1", r"line 2: .* 0.12 degrees/min or more: LinuxCNC's slowest in G93"),
        ("a.ngc", "G93 G1 X5 F9\nG94 G1 C90", "line 3: found a motion without feed"),
        ("a.H", "L C+90 F720", r"line 3: found C turning by 90 degrees at F720, .* in Klartext"),
        ("a.H", "M128\nL B-9 C+90 F720", "line 4: found B and C turning by 90.45 degrees at F720"),
        ("a.H", "M116\nL C+90 F720", "line 4: "),
    ],
)
def test_what_cannot_keep_its_time_is_refused_with_its_line(corrected, name, text, said):
    start = {"a.ngc": "G0 X30 Y20 Z-20\n", "a.H": "BEGIN PGM A MM\nL X+30 Y+20 Z-20 FMAX\n"}
    with pytest.raises(BadFile, match=said):
        corrected(f"{start[name]}{text}\n", name)


@pytest.mark.parametrize(
    ("mode", "turned", "said"),
    [
        ("M126", 200, "line 4: found C turning by 200 degrees with M126, expected at most 180"),
        ("M126", 170, ""),
        ("M127", 200, ""),
        ("M126\nL X+31 FMAX M127", 200, ""),
    ],
)
def test_a_turn_the_shorter_way_is_not_divided_into_the_longer(corrected, mode, turned, said):
    """Manual: M126, modal, takes rotary axes the shorter way; +200 degrees is then -160.

    Divided for its correction the block would have pieces that go +200 degrees.
    """
    text = f"BEGIN PGM A MM\nL X+30 Y+20 Z-20 FMAX\n{mode}\nL X+130 C+{turned} F900\n"
    if said:
        with pytest.raises(BadFile, match=said):
            corrected(text, "a.H")
    else:
        corrected(text, "a.H")
    corrected(text.replace("F900", "FMAX"), "a.H")  # is not divided


def test_what_is_rapid_or_long_stays_in_feed_per_minute(corrected):
    klartext = "BEGIN PGM A MM\nL X+0 Y+0 Z-20 FMAX\nL C+90 FMAX\nL X+60 B-20 F900\nM128\n"
    klartext += "L X+10 Y+20 C+120 F900\nL Z-9\n"
    text = corrected(klartext, "a.H").text
    assert set(re.findall(r"F\S*\d", text)) == {"F900"}
    text = corrected("G0 X0 Y0 Z-20\nG0 C90\nG1 X60 B-20 F900\nG43.4 H1\nG1 X10 C60\n").text
    assert "G93" not in text


def test_feed_per_minute_comes_back_once(corrected):
    """Motions in a row share one G93; what stands behind them has its feed."""
    done = corrected("G0 X30 Y0 Z-20\nG1 C9 F720 M8 (turn)\nG94 G1 C18 F360\nG1 X9 F300\n")
    lines = done.text.splitlines()
    assert lines.count("G93") == 1
    assert sum(line.startswith("G94 F") for line in lines) == 1
    (turn,) = (line for line in lines if "M8" in line)
    assert re.fullmatch(r"\(turn\) M8 G1 X\S+ Y\S+ Z\S+ C\S+ F\S+", turn)
    assert lines[-1].startswith("G1") or lines[-1].startswith("F300 G1")
    assert lines.index("G94 F360") > lines.index(turn)


# --- by the running control -------------------------------------------------------------------

HAL = """loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt sampler depth=16000 cfg=ffffff
addf motion-command-handler servo-thread
addf motion-controller servo-thread
addf sampler.0 servo-thread
net stop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
""" + "".join(
    f"net position-{k} joint.{k}.motor-pos-cmd => joint.{k}.motor-pos-fb sampler.0.pin.{k}\n"
    for k in range(5)
)
STANDS = 200
"""Periods of 1 ms without motion, by which motions are distinguished: dwells take 400."""


def run_on_linuxcnc(texts):
    """Joints at every period of some programs, (N, 5) each."""
    user, folder = a_user(), Path(tempfile.mkdtemp(prefix="matstd-times-"))
    axes = [AXIS.format(a, i, low, high, kind) for i, (a, low, high, kind) in enumerate(AXES)]
    files = {"machine.ini": INI.replace("#more", "") + "".join(axes), "machine.hal": HAL}
    files |= {"tool.tbl": "T1 P1 Z0 D1\n", "machine.var": "", **texts}
    files |= {"programs.txt": "\n".join(texts)}
    source = Path(__file__).parents[1] / "fixtures" / "timed_scenario.py"
    files |= {"scenario.py": source.read_text()}
    for name, text in files.items():
        (folder / name).write_text(text)
    (folder / "scenario.py").chmod(0o755)
    for path in (folder, *folder.iterdir()):
        if user:
            shutil.chown(path, user)
    try:
        assert json.loads(run_linuxcnc(folder, user, 300.0))["failed"] == ""
        lines = [s.split() for s in (folder / "samples.txt").read_text().splitlines()]
        table = np.array([s for s in lines if len(s) == 7 and "overrun" not in s], dtype=float)
        assert np.diff(table[:, 0]).max() == 1.0
        return [table[table[:, 6] == k, 1:6] for k in range(1, len(texts) + 1)]
    finally:
        shutil.rmtree(folder)


def motions_of(joints):
    """Time in motion between every two dwells, s."""
    moving = np.flatnonzero(np.abs(np.diff(joints, axis=0)).max(axis=1) > 1e-9)
    cuts = np.flatnonzero(np.diff(moving) > STANDS)
    begins, ends = moving[np.append(0, cuts + 1)], moving[np.append(cuts, len(moving) - 1)]
    return (ends - begins + 1) * 1e-3


@pytest.mark.slow
def test_the_control_takes_as_long_as_before(corrected):
    """The program as it was, and compensated; and what F of degrees does beside a micrometre."""
    done = corrected(GCODE)
    wrong = "G21 G90 G94\nG0 X0 Y0 Z-20\nG4 P0.4\nG1 X-0.02481 Y-0.06266 C90 F720\nM30\n"
    texts = {"before.ngc": GCODE, "after.ngc": done.text, "wrong.ngc": wrong}
    before, after, by_mistake = (motions_of(joints) for joints in run_on_linuxcnc(texts))
    assert len(before) == len(after) == len(SECONDS) + 2  # the two rapid ones
    np.testing.assert_allclose(after, before, rtol=SAME, atol=0.05)
    fed = np.delete(before, [0, list(SECONDS).index(22) + 2])
    np.testing.assert_allclose(fed, list(SECONDS.values()), rtol=SAME, atol=0.05)
    assert by_mistake[-1] < 0.1 * SECONDS[4]
