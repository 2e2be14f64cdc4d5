"""The real control without a screen: a part is probed with and without, and nothing jumps."""

import asyncio
import json
import shutil
import tempfile
import threading
from pathlib import Path

import numpy as np
import pytest
from bench import LENGTH
from control import AXES, AXIS, INI, a_user, run_linuxcnc

from matstd.compensation.field import MachineErrors
from matstd.compensation.linuxcnc import SOCKET, Control, serve_linuxcnc, write_control_files
from matstd.compensation.service import OutputLimits, Service
from matstd.twin.library import parse_effect
from matstd.twin.units import UM

pytestmark = pytest.mark.slow

RATE = 4.0
"""mm/s: 20 um take 5 ms, and as long again LinuxCNC's own ramps."""

PLACES = (-300.0, -100.0, 60.0, 250.0)
LATCH = 0.5 * UM
"""0.1 mm/s in a servo period, and as much again where the rig's own loop is late."""

LIMITS = OutputLimits(most=200.0 * UM, rate=RATE, patience=0.3, hold=1.0)
HAL = """loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt comp count=2
loadrt or2 count=1
loadrt sampler depth=16000 cfg=fffbfffb
addf motion-command-handler servo-thread
addf motion-controller servo-thread
addf comp.0 servo-thread
addf comp.1 servo-thread
addf or2.0 servo-thread
addf sampler.0 servo-thread
setp comp.0.in0 1e6
setp comp.1.in1 -1e6
net position-0 joint.0.motor-pos-cmd => joint.0.motor-pos-fb comp.0.in1 sampler.0.pin.0
net position-1 joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net position-2 joint.2.motor-pos-cmd => joint.2.motor-pos-fb comp.1.in0 sampler.0.pin.1
net position-3 joint.3.motor-pos-cmd => joint.3.motor-pos-fb
net position-4 joint.4.motor-pos-cmd => joint.4.motor-pos-fb
net on-x comp.0.out => or2.0.in0
net on-z comp.1.out => or2.0.in1
net contact or2.0.out => motion.probe-input sampler.0.pin.3
net offset-x axis.x.eoffset => sampler.0.pin.2
net program-z axis.z.pos-cmd => sampler.0.pin.6
net limited motion.eoffset-limited => sampler.0.pin.7
net program-x axis.x.pos-cmd => sampler.0.pin.4
net stop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""


def errors_of(chain):
    """The two waves of the part's machine, and a backlash that only the model has."""
    known = [
        (parse_effect("geometric(EXX,sinusoidal,2)", chain), np.array([30.0 * UM])),
        (parse_effect("geometric(EZX,sinusoidal,2)", chain), np.array([20.0 * UM])),
        (parse_effect("backlash(X)", chain), np.array([20.0 * UM])),
    ]
    return MachineErrors.of_errors(chain, known)


class Server:
    """The service in a thread of this process, started and cut as the scenario asks."""

    def __init__(self, folder, errors, datum):
        self.folder, self.errors, self.datum = folder, errors, datum
        self.thread = self.loop = self.until = None

    def start(self, limits=LIMITS):
        ready = threading.Event()

        async def run():
            self.loop, self.until = asyncio.get_running_loop(), asyncio.Event()
            service = Service(self.errors, LENGTH, self.datum, limits)
            path = self.folder / SOCKET

            def open_to_all():
                path.chmod(0o777)
                ready.set()

            await serve_linuxcnc(service, path, open_to_all, self.until)

        self.thread = threading.Thread(target=lambda: asyncio.run(run()), daemon=True)
        self.thread.start()
        assert ready.wait(30.0)

    def cut(self):
        if self.thread is not None:
            self.loop.call_soon_threadsafe(self.until.set)
            self.thread.join(30.0)
            self.thread = None


@pytest.fixture(scope="module")
def rows(bench_chain, datum):
    """Samples of every servo period, and what LinuxCNC said."""
    user = a_user()
    folder = Path(tempfile.mkdtemp(prefix="matstd-offsets-"))
    axes = [AXIS.format(a, i, low, high, kind) for i, (a, low, high, kind) in enumerate(AXES)]
    texts = {
        "machine.ini": INI.replace("#more", "HALFILE = corrector.hal") + "".join(axes),
        "machine.hal": HAL,
        "tool.tbl": "T1 P1 Z0 D1\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "machine.var").write_text("")
    source = Path(__file__).parents[1] / "fixtures" / "offset_scenario.py"
    shutil.copyfile(source, folder / "scenario.py")
    (folder / "scenario.py").chmod(0o755)
    errors = errors_of(bench_chain)
    control = Control(folder / "machine.ini")
    control.check(bench_chain)
    assert control.reads_ours
    write_control_files(control, Service(errors, LENGTH, datum, LIMITS), LIMITS)
    server = Server(folder, errors, datum)
    for path in (folder, *folder.iterdir()):
        if user:
            shutil.chown(path, user)
    try:
        run(folder, user, server)
        yield table(folder), json.loads((folder / "outcome.json").read_text())
    finally:
        server.cut()
        shutil.rmtree(folder)


def run(folder, user, server):
    small = OutputLimits(most=12.0 * UM, rate=RATE, patience=0.3, hold=1.0)
    doings = {
        "serve": server.start,
        "cut": server.cut,
        "again": server.start,
        "least": lambda: (server.cut(), server.start(small)),
    }
    run_linuxcnc(folder, user, 150.0, doings)


def table(folder):
    """Periods: number, joints X and Z, offset, contact, program X, mark, program Z, limit."""
    lines = [s.split() for s in (folder / "samples.txt").read_text().splitlines()]
    whole = [s for s in lines if len(s) == 9 and "overrun" not in s]
    return np.array(whole, dtype=float)


@pytest.fixture(scope="module")
def samples(rows):
    """Columns by name, mm; equal steps of 1 ms, none lost."""
    table, outcome = rows
    assert outcome["failed"] == ""
    names = (
        "number",
        "joint_x",
        "joint_z",
        "offset",
        "contact",
        "program_x",
        "mark",
        "program_z",
        "limited",
    )
    assert np.diff(table[:, 0]).max() == 1.0
    return dict(zip(names, table.T, strict=True))


def during(samples, mark):
    return samples["mark"] == mark


def probed(samples, first):
    """Where the program thought that the part was met, less where it is, X and Z, (4, 2)."""
    out = []
    for k, x in enumerate(PLACES):
        at = [
            np.flatnonzero(during(samples, first + n + k) & (samples["contact"] > 0))[0]
            for n in (0, 4)
        ]
        out.append((samples["program_x"][at[0]] - x, samples["program_z"][at[1]] + 200.0))
    return np.array(out)


def test_a_part_probed_with_and_without(samples):
    """Up to 40 um without, the latch of the probe with."""
    without, corrected = probed(samples, 100), probed(samples, 200)
    turn = 4.0 * np.pi * (np.array(PLACES) + 400.0) / 800.0
    expected = -np.column_stack([30.0 * UM * np.sin(turn) + 10.0 * UM, 20.0 * UM * np.sin(turn)])
    np.testing.assert_allclose(without, expected, atol=LATCH)
    assert np.abs(without).max() > 35.0 * UM
    assert np.abs(corrected).max() < LATCH


def test_a_step_of_20_um_settles(samples):
    """From the first motion of the axis that turns the backlash over."""
    settled = []
    for number in range(300, 305):
        rows = np.flatnonzero(during(samples, number))
        x, offset = samples["program_x"][rows], samples["offset"][rows]
        turns = np.flatnonzero(np.diff(x) < -1e-7)
        begin = turns[turns > np.flatnonzero(np.diff(x) > 1e-7)[0]][0]
        after = offset[begin : begin + 200]
        assert abs(after[-1] - after[0]) == pytest.approx(20.0 * UM, abs=0.2 * UM)
        settled.append(np.flatnonzero(np.abs(after - after[-1]) > 0.5 * UM)[-1] + 1)
    assert np.median(settled) <= 25, settled


def test_nothing_jumps(samples):
    """Whatever happens: joints within their acceleration, offsets within their rate."""
    speed = np.diff(samples["joint_x"]) * 1e3
    assert np.abs(np.diff(speed)).max() * 1e3 < 5000.0
    stands = np.abs(np.diff(samples["program_x"])) < 1e-9
    assert np.abs(speed[stands]).max() < 1.5 * RATE  # the control catches up what came late


def test_a_cut_link_is_held_then_fades_and_comes_back(samples):
    gone, back = (samples["offset"][during(samples, m)] for m in (400, 401))
    assert abs(gone[0]) > 15.0 * UM
    np.testing.assert_allclose(gone[:1000], gone[0], atol=0.02 * UM)
    assert abs(gone[-1]) < 0.02 * UM
    assert back[-1] == pytest.approx(gone[0], abs=0.1 * UM)


def test_the_machine_off_and_on_stays_where_it_is(samples):
    joint, offset = samples["joint_x"], samples["offset"]
    off = during(samples, 500)
    assert np.ptp(joint[off]) < 0.01 * UM
    again = np.flatnonzero(during(samples, 501))
    assert offset[again].max() == pytest.approx(0.0, abs=0.01 * UM)  # LinuxCNC forgets it
    assert offset[again[-1]] == pytest.approx(offset[off][0], abs=0.2 * UM)
    assert np.ptp(joint[again]) == pytest.approx(abs(offset[again[-1]]), abs=0.2 * UM)


def test_the_ends_of_the_travel_and_the_largest_offset(samples, rows):
    """At its end an axis is not pushed beyond, at the limit of the service it stays."""
    assert samples["joint_x"].min() >= -350.0 - 1e-6
    at_end = during(samples, 601)
    assert samples["offset"][at_end][0] == pytest.approx(-5.0 * UM, abs=0.1 * UM)
    assert np.abs(samples["offset"][at_end]).max() > 15.0 * UM
    assert not samples["limited"].any()
    assert rows[1]["errors"] == []
    assert abs(samples["offset"][during(samples, 999)][-1]) == pytest.approx(12.0 * UM, abs=1e-6)
