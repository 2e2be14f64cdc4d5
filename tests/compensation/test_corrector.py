"""The component for LinuxCNC beside a stand-in of its pins, its link, the files of a control."""

import argparse
import asyncio
import importlib.util
import json
import sys
import threading
import time
import types
from pathlib import Path

import numpy as np
import pytest
from bench import LENGTH

from matstd.compensation.linuxcnc import Control, control_files, serve_linuxcnc, write_control_files
from matstd.compensation.linuxcnc.control_files import SCALE, hal_text
from matstd.compensation.service import OutputLimits, Service
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.units import UM

RATE, PERIOD = 1.0, 0.002
FREE = [(-1e9, 1e9)] * 2


def load():
    """The script, which is no module of ours."""
    path = Path(control_files.__file__).parent / "beside" / "corrector.py"
    spec = importlib.util.spec_from_file_location("matstd_corrector", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


corrector = load()


class Axes:
    """External offsets of two axes, as axis.c of LinuxCNC 2.9 adds changes of counts up."""

    def __init__(self):
        self.on, self.old, self.requested = True, [0, 0], [0.0, 0.0]

    def period(self, counts):
        for k, (new, old) in enumerate(zip(counts, self.old, strict=True)):
            if self.on:
                self.requested[k] += (new - old) * SCALE
        self.old = list(counts)

    def switch(self, on):
        self.on, self.requested = on, [0.0, 0.0]


class Run:
    """A giver and a control, period by period."""

    def __init__(self, hold=1.0):
        self.giver = corrector.Giver(2, SCALE, 0.1, RATE, 0.3, hold)
        self.axes, self.now = Axes(), 0.0

    def pass_by(self, seconds, wanted=None, room=FREE):
        out = []
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            if wanted is not None:
                self.giver.answer(wanted, self.now)
            args = (self.now, self.axes.on, self.axes.requested, room)
            self.axes.period(self.giver.step(*args))
            out.append(self.axes.requested[0])
        return np.array(out)


def test_offsets_go_at_a_rate_to_what_is_wanted_and_no_farther_than_the_limit():
    run = Run()
    x = run.pass_by(0.1, [30 * UM, -500 * UM])
    assert np.abs(np.diff(x)).max() <= RATE * PERIOD + SCALE
    assert x[round(0.034 / PERIOD)] == pytest.approx(30 * UM)
    run.pass_by(0.1, [30 * UM, -500 * UM])
    assert run.axes.requested[1] == pytest.approx(-100 * UM)


def test_off_and_on_begins_at_zero_where_the_axes_are():
    run = Run()
    run.pass_by(0.1, [30 * UM, 0.0])
    run.axes.switch(False)
    run.pass_by(0.5, [30 * UM, 0.0])
    run.axes.switch(True)
    x = run.pass_by(0.1, [30 * UM, 0.0])
    assert x[0] <= RATE * PERIOD + SCALE
    assert x[-1] == pytest.approx(30 * UM)


def test_counts_that_were_lost_are_given_again():
    """The control drops changes for a moment of which the pin knew nothing: at last they agree."""
    run = Run()
    run.pass_by(0.02, [30 * UM, 0.0])
    run.axes.on = False  # and the pin has not reported it yet
    given = (run.now, True, run.axes.requested, FREE)
    for _ in range(5):
        run.now += PERIOD
        run.axes.period(run.giver.step(run.now, *given[1:]))
    run.axes.on = True
    x = run.pass_by(0.3, [30 * UM, 0.0])
    assert x[-1] == pytest.approx(30 * UM)
    assert np.abs(np.diff(x)).max() <= RATE * PERIOD + SCALE


def test_without_answers_it_holds_then_fades():
    run = Run()
    run.pass_by(0.2, [30 * UM, 0.0])
    held = run.pass_by(0.9)
    assert np.ptp(held) == 0.0
    assert not run.giver.is_valid(run.now)
    fading = run.pass_by(0.3)
    assert fading[-1] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(np.diff(fading)).max() <= RATE * PERIOD + SCALE
    assert run.pass_by(0.1, [30 * UM, 0.0])[-1] == pytest.approx(30 * UM)


def test_an_answer_that_is_no_number_is_none():
    """As without answers: the last correction is held, then fades, and the component lives on."""
    run = Run()
    run.pass_by(0.2, [30 * UM, 0.0])
    held = run.pass_by(0.9, [float("nan"), 0.0])
    assert np.ptp(held) == 0.0
    assert not run.giver.is_valid(run.now)
    assert run.pass_by(0.3, [0.0, float("inf")])[-1] == pytest.approx(0.0, abs=1e-9)


def test_room_before_the_end_of_the_travel():
    """However fast an axis comes, what was added can be taken back in time."""
    for speed in (0.0, 0.5, 20.0, 200.0):
        low, high = corrector.room_of(-400.0 + speed * 0.05, -speed, (-400.0, 400.0), RATE)
        assert -low <= 0.05 * RATE + 1e-12
        assert high > 700.0
    assert corrector.room_of(-400.0, 0.0, (-400.0, 400.0), RATE)[0] == 0.0
    run = Run()
    x = run.pass_by(0.2, [-50 * UM, 0.0], [(-20 * UM, 1.0), (-1.0, 1.0)])
    assert x[-1] == pytest.approx(-20 * UM)


# --- pins and link ----------------------------------------------------------------------------


class Pins(dict):
    """What a component of the module `hal` does for us."""

    def newpin(self, name, kind, way):
        self[name] = 0


@pytest.fixture
def hal(monkeypatch):
    names = ("HAL_FLOAT", "HAL_S32", "HAL_BIT", "HAL_IN", "HAL_OUT")
    monkeypatch.setitem(sys.modules, "hal", types.SimpleNamespace(**{n: n for n in names}))


@pytest.fixture
def answering(known, datum, tmp_path):
    """The service on a socket, in a thread of its own."""
    service = Service(known, LENGTH, datum, OutputLimits(rate=50.0))
    path, ready, ends = tmp_path / "s", threading.Event(), []

    async def run():
        until = asyncio.Event()
        ends.append((asyncio.get_running_loop(), until))
        await serve_linuxcnc(service, path, ready.set, until)

    thread = threading.Thread(target=lambda: asyncio.run(run()), daemon=True)
    thread.start()
    assert ready.wait(10.0)
    yield service, path
    loop, until = ends[0]
    loop.call_soon_threadsafe(until.set)
    thread.join(10.0)
    assert not path.exists()


def test_pins_are_answered_by_the_inverse(hal, answering, bench_chain, poses):
    service, path = answering
    words = ["--socket", str(path), "--axes", "XYZBC", "--linear", "XYZ", "--rate", "50"]
    words += ["--scale", str(SCALE)]
    pins = Pins()
    one = corrector.Corrector(corrector.arguments([*words, "--sensors", "bed"]), pins)
    pins["machine-on"] = pins["homed"] = True
    q = poses[3]
    for letter in "XYZBC":
        value = q[bench_chain.axis_index(letter)]
        pins[f"position-{letter.lower()}"] = float(np.degrees(value) if letter in "BC" else value)
    expected = service.correction.at(q.tolist())
    for _ in range(500):
        one.look(time.monotonic())
        time.sleep(0.001)
        given = [pins[f"counts-{x}"] * SCALE for x in "xyz"]
        for x, v in zip("xyz", given, strict=True):
            pins[f"requested-{x}"] = v
        if pins["valid"] and np.allclose(given, expected, atol=0.6 * SCALE, rtol=0.0):
            break
    np.testing.assert_allclose(given, expected, atol=0.6 * SCALE)
    assert pins["enable"] is True
    assert pins["age"] < 1.0
    one.link.close()


def asked(path, line):
    async def ask():
        reader, writer = await asyncio.open_unix_connection(path)
        writer.write(line)
        answer = json.loads(await reader.readline())
        writer.close()
        return answer

    return asyncio.run(ask())


def test_nonsense_on_the_link_is_no_question(answering):
    _, path = answering
    for line in (b"nonsense\n", b"{}\n", b"[1]\n", b'{"number":1,"readings":7,"directions":{}}\n'):
        assert asked(path, line)["number"] == 0
    far = {"number": 5, "readings": {"x": 1e5}, "directions": {}}
    answer = asked(path, json.dumps(far).encode() + b"\n")
    assert answer["number"] == 5
    assert "beyond its travel" in answer["refused"]


def test_a_second_service_is_refused(answering):
    service, path = answering
    with pytest.raises(DesignError, match="another service answers there already"):
        asyncio.run(serve_linuxcnc(service, path))


# --- files of the control ---------------------------------------------------------------------

INI = """[HAL]
HALFILE = machine.hal
HALFILE = corrector.hal
[TRAJ]
COORDINATES = X Y Z B C
LINEAR_UNITS = mm
[AXIS_X]
OFFSET_AV_RATIO = 0.2 # enough
MIN_LIMIT = -400
MAX_LIMIT = 400
[AXIS_Y]
OFFSET_AV_RATIO = 0.2
MIN_LIMIT = -300
MAX_LIMIT = 300
[AXIS_Z]
OFFSET_AV_RATIO = 0.2
MIN_LIMIT = -500
MAX_LIMIT = 0
"""


@pytest.fixture
def ini(tmp_path):
    path = tmp_path / "machine.ini"
    path.write_text(INI)
    (tmp_path / "machine.hal").write_text("net xpos axis.x.pos-cmd => foo.in # mine\n")
    return path


def test_files_for_the_control(ini, known, datum, unchanged):
    service, limits = Service(known, LENGTH, datum), OutputLimits()
    control = Control(ini)
    control.check(known.chain)
    hal, script = write_control_files(control, service, limits)
    text = hal.read_text()
    words = next(s for s in text.splitlines() if s.startswith("loadusr")).split()[4:]
    args = corrector.arguments([w.strip("'") for w in words])
    assert isinstance(args, argparse.Namespace)
    assert (args.axes, args.linear, args.most) == ("XYZBC", "XYZ", limits.most)
    for x in "xyz":  # a count is as large for the component as for the control
        assert f"setp axis.{x}.eoffset-scale {args.scale!r}" in text
    assert script.stat().st_mode & 0o111
    write_control_files(control, service, limits)  # ours may be replaced
    hal.write_text("# mine\n")
    with pytest.raises(DesignError, match=r"corrector\.hal already exists and is not ours"):
        write_control_files(control, service, limits)
    assert hal_text(control, service, limits) == text
    unchanged(text.replace(str(ini.parent), ""))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("LINEAR_UNITS = mm", "LINEAR_UNITS = inch", "LINEAR_UNITS: found inch, expected mm"),
        ("X Y Z B C", "X Y Z", "COORDINATES: found XYZ, expected the axes of bench"),
        ("OFFSET_AV_RATIO = 0.2 # enough\n", "", "found no OFFSET_AV_RATIO"),
        ("0.2 # enough", "0", "OFFSET_AV_RATIO: found 0, expected above 0, and 0.9 at most"),
        ("0.2 # enough", "much", "OFFSET_AV_RATIO: found much, expected a number"),
        ("[HAL]\n", "HAL\n", "line 1: found 'HAL\\n', expected a section"),
    ],
)
def test_a_control_that_cannot_be_corrected(ini, known, old, new, said):
    ini.write_text(INI.replace(old, new))
    with pytest.raises(BadFile) as refused:
        Control(ini).check(known.chain)
    assert said in str(refused.value)
