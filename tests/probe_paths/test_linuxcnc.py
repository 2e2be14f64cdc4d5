"""The machine that LinuxCNC gets, the twin as its probe, and sessions that end badly."""

import ast
import json
import socket
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import all_read, ran, stand_in

from matstd.artefact.tool import Probe
from matstd.nc.linuxcnc import variables
from matstd.probe_paths.campaign import VirtualMachine
from matstd.probe_paths.control import ProbeStep
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.linuxcnc import installed, shortened
from matstd.probe_paths.linuxcnc import session as session_module
from matstd.probe_paths.linuxcnc.machine_config import latch_error, latch_u, machine_files
from matstd.probe_paths.linuxcnc.session import _answer, _listen, run_on_linuxcnc
from matstd.probe_paths.linuxcnc.twin_contact import TwinContact
from matstd.twin.effects.backlash import Backlash
from matstd.twin.errors import DesignError
from matstd.twin.frames import pose, rotation
from matstd.twin.model import contribution
from matstd.twin.units import DEG, NM, UM

LATCH = 0.2 * UM
"""12 mm/min in one period of 1 ms."""


@pytest.fixture(scope="module")
def crooked(chain):
    """Backlash of X, and a standard that stands beside its place."""
    effects = [(Backlash("X", 0), np.array([10.0 * UM]))]
    stands = pose(rotation(np.array([1e-4, -2e-4, 5e-4])), np.array([0.08, -0.05, 0.03]))
    return VirtualMachine(chain, lambda t: contribution(effects, t), setup_error=stands)


# --- latch ----------------------------------------------------------------------------------


def test_the_latch_is_what_a_million_touches_would_show():
    """Contacts at any moment, positions kept at the next period; against the closed formulas."""
    rng = np.random.default_rng(3)
    feed, period, latency = 0.2, 1e-3, 0.4e-3
    contact = rng.uniform(0.0, 1.0, 1_000_000)
    kept = np.ceil((contact + latency) / period) * period
    beyond = feed * (kept - contact)
    assert beyond.max() < latch_error(feed, period, latency)
    assert beyond.max() > 0.999 * latch_error(feed, period, latency)
    assert abs(np.sqrt(np.mean(beyond**2)) / latch_u(feed, period, latency) - 1.0) < 2e-3
    assert latch_u(0.2) == pytest.approx(LATCH / np.sqrt(3.0))


# --- the machine ----------------------------------------------------------------------------


def test_preset_and_tool_make_words_of_readings(chain, plan):
    """A word and the offsets of the machine give the reading that the interpreter has."""
    files = machine_files(chain, Probe(), read_dialect("linuxcnc"), "/tmp/s")
    values = {int(k): float(v) for k, v in (s.split() for s in files["machine.var"].splitlines())}
    assert [values[5221 + i] for i in range(3)] == [0.0, 0.0, -500.0]
    assert values[5220] == 1.0
    assert files["tool.tbl"] == "T30 P30 Z163.000000 D6.000000\n"
    numbers = [int(line.split()[0]) for line in files["machine.var"].splitlines()]
    assert numbers == sorted(set(numbers))  # LinuxCNC refuses another order


def test_offsets_stand_at_the_numbers_of_the_manual():
    """LinuxCNC, G-code overview: 5221 to 5230 are G54 in X to W and its rotation, 5381 ff. G59.3;
    5220 is the system in force, 5161 and 5181 begin G28 and G30, 5210 to 5219 are G92."""
    lines = variables({1: (1, 2, 3), 9: (7, 8, 9)}).splitlines()
    found = [(int(number), float(value)) for number, value in map(str.split, lines)]
    blocks = [(5161, 9), (5181, 9), (5210, 10), (5220, 1), *((5221 + 20 * k, 10) for k in range(9))]
    assert [number for number, _ in found] == [a + k for a, n in blocks for k in range(n)]
    stated = {5220: 1.0, 5221: 1.0, 5222: 2.0, 5223: 3.0, 5381: 7.0, 5382: 8.0, 5383: 9.0}
    assert {number: value for number, value in found if value} == stated


def test_every_axis_has_its_joint_and_its_travel(chain):
    files = machine_files(chain, Probe(), read_dialect("linuxcnc"), "/tmp/s")
    assert (
        "KINEMATICS = trivkins coordinates=XYZBC kinstype=BOTH\nJOINTS = 5" in files["machine.ini"]
    )
    b = files["machine.ini"].split("[AXIS_B]")[1].split("[AXIS_C]")[0]
    assert "MIN_LIMIT = -110.0" in b
    assert "TYPE = ANGULAR" in b
    assert b.count("HOME = 0.0\n") == b.count("HOME_OFFSET = 0.0\n") == 1
    assert "[JOINT_3]" in b
    hal = files["machine.hal"]
    assert hal.count("motor-pos-fb") == 5
    summed = [line.split()[-1] for line in hal.splitlines() if "motor-pos-fb" in line][:3]
    assert summed == ["sum2.0.in0", "sum2.0.in1", "sum2.1.in0"]


# --- programs planned again -----------------------------------------------------------------


def test_all_touches_of_a_program_again_are_the_same_program(golden, programs, read, small, chain):
    """Text, read, planned again, written: only the word (ANCHOR) is gone."""
    again = make_programs(shortened(read, small, chain), feeds=golden.Feeds(touches_per_file=24))
    text = "".join(p.text for p in programs.programs).replace(" (ANCHOR)", "")
    assert "".join(p.text for p in again.programs) == text


@pytest.mark.parametrize("count", [1, 2, 7, 30])
def test_some_touches_are_those_of_the_whole(count, read, small, chain):
    made = make_programs(shortened(read, small, chain, count), read_dialect("linuxcnc"))
    touches = [t for p in all_read(made, chain) for t in p.touches]
    assert len(touches) == count
    whole = [t for p in read for t in p.touches]
    for touch in touches:
        same = [t for t in whole if np.allclose(t.q, touch.q, rtol=0.0, atol=1e-9)]
        assert any(np.array_equal(t.side[:2], touch.side[:2]) for t in same)  # of C and B


def test_no_touch_at_all_is_refused(read, small, chain):
    with pytest.raises(DesignError, match="expected at least 1"):
        shortened(read, small, chain, 0)


# --- the twin as the probe ------------------------------------------------------------------


def joints(chain, q):
    """Positions of the joints XYZBC, mm and degrees."""
    scale = {"B": 1.0 / DEG, "C": 1.0 / DEG}
    return [float(q[chain.axis_index(a)]) * scale.get(a, 1.0) for a in "XYZBC"]


def test_the_contact_is_that_of_the_virtual_probing(twins, small, chain, crooked):
    """From the start of a touch and from 0.3 mm before its contact, to a nanometre."""
    contact = TwinContact(twins, small, crooked, np.random.default_rng(0))
    run = ran(twins[0], small, crooked)
    linear = [chain.axis_index(a) for a in "XYZ"]
    for touch, q in zip(twins[0].touches[:8], run.q, strict=False):
        way = touch.direction[linear].tolist()
        travel = contact.travel(joints(chain, touch.q), way)
        assert np.linalg.norm(touch.q + travel * touch.direction - q) < NM
        near = q - 0.3 * touch.direction
        assert abs(contact.travel(joints(chain, near), way) - 0.3) < NM
    assert [s.number for s in contact.strokes[:4]] == [1, 1, 2, 2]


def test_a_touch_along_the_line_of_an_earlier_one_is_the_next_in_order(twins, small, chain):
    """An anchor is touched in both rounds at the same readings, other touches lie between."""
    first = twins[0]
    later = [
        replace(s, number=s.number + 100) if isinstance(s, ProbeStep) else s for s in first.steps
    ]
    twice, machine = [first, replace(first, steps=tuple(later))], VirtualMachine(chain)
    contact = TwinContact(twice, small, machine, np.random.default_rng(0))
    linear = [chain.axis_index(a) for a in "XYZ"]
    wanted = [step for program in twice for step in program.touches[:3]]
    for step in wanted:
        contact.travel(joints(chain, step.q), step.direction[linear].tolist())
    assert [s.number for s in contact.strokes] == [1, 2, 3, 101, 102, 103]


def test_backlash_acts_by_the_side_from_which_the_axis_came(twins, small, chain, crooked):
    """By hand: where X goes on in one direction only, the sign of the stroke is the sign."""
    perfect = VirtualMachine(chain, setup_error=crooked.setup_error)
    x = chain.axis_index("X")
    touch = max(twins[0].touches, key=lambda t: abs(t.direction[x]))
    linear = [chain.axis_index(a) for a in "XYZ"]
    start, way = joints(chain, touch.q), touch.direction[linear].tolist()
    with_it, without = (
        TwinContact(twins, small, m, np.random.default_rng(0)).travel(start, way)
        for m in (crooked, perfect)
    )
    assert 1.0 * UM < abs(with_it - without) < 20.0 * UM


def test_a_stroke_of_no_program_is_refused(twins, small, chain, crooked):
    contact = TwinContact(twins, small, crooked, np.random.default_rng(0))
    touch = twins[0].touches[0]
    beside = joints(chain, touch.q)
    beside[1] += 0.01
    with pytest.raises(DesignError, match="where no programmed touch begins"):
        contact.travel(beside, touch.direction[2:5].tolist())


def test_a_touch_that_meets_nothing_has_no_travel(twins, small, chain):
    away = VirtualMachine(chain, setup_error=pose(t=np.array([0.0, 0.0, -30.0])))
    contact = TwinContact(twins, small, away, np.random.default_rng(0))
    touch = twins[0].touches[0]
    linear = [chain.axis_index(a) for a in "XYZ"]
    assert contact.travel(joints(chain, touch.q), touch.direction[linear].tolist()) is None
    assert np.all(np.isnan(contact.strokes[0].contact))


def test_a_late_probe_is_said(twins, small, chain, crooked):
    contact = TwinContact(twins, small, crooked, np.random.default_rng(0))
    touch = twins[0].touches[0]
    linear = [chain.axis_index(a) for a in "XYZ"]
    ask = (joints(chain, touch.q), touch.direction[linear].tolist())
    contact.travel(*ask)
    contact.arrived_late(0.5)  # of the fast stroke, which measures nothing
    contact.travel(*ask)
    contact.check_in_time()
    contact.arrived_late(0.004)
    with pytest.raises(DesignError, match=r"1 touches .* touch 1 by 4.0 µm: the computer was too"):
        contact.check_in_time()


def test_the_twin_answers_over_a_socket(twins, small, chain, crooked, tmp_path):
    contact = TwinContact(twins, small, crooked, np.random.default_rng(0))
    server = _listen(tmp_path / "probe")
    answering = threading.Thread(target=_answer, args=(server, contact), daemon=True)
    answering.start()
    touch = twins[0].touches[0]
    linear = [chain.axis_index(a) for a in "XYZ"]
    link = socket.socket(socket.AF_UNIX)
    link.connect(str(tmp_path / "probe"))
    with link, server, link.makefile("rw") as stream:
        question = {"joints": joints(chain, touch.q), "direction": touch.direction[linear].tolist()}
        stream.write(json.dumps(question) + "\n")
        stream.flush()
        assert 4.0 < json.loads(stream.readline()) < 6.0
        stream.write(json.dumps(question | {"joints": [0.0] * 5}) + "\n")
        stream.flush()
        assert json.loads(stream.readline()) is None
        assert "where no programmed touch begins" in contact.failure


# --- sessions that end badly, with a stand-in for the control --------------------------------


def started(for_linuxcnc, twins, small, machine, folder):
    files = machine_files(machine.chain, Probe(), read_dialect("linuxcnc"), str(folder / "probe"))
    contact = TwinContact(twins, small, machine, np.random.default_rng(0))
    return run_on_linuxcnc(for_linuxcnc.programs, files, contact, folder / "probe")


@pytest.mark.parametrize(
    ("script", "outcome"),
    [
        (
            "echo 'stopped MS_A_2.ngc: Linear move would exceed Z limits' > headless.txt",
            "LinuxCNC stopped MS_A_2.ngc: Linear move would exceed Z limits",
        ),
        (
            "echo NOCONTACT P7.000000 > MS_A_1.TXT; echo stopped MS_A_1.ngc: 1014 > headless.txt",
            "LinuxCNC stopped MS_A_1.ngc: touch 7 has no contact",
        ),
        (
            "echo 'stopped MS_A_1.ngc: M0' > headless.txt",
            "LinuxCNC stopped MS_A_1.ngc: a test of probe, preset or machine",
        ),
        ("exit 1", "LinuxCNC died in MS_A_1.ngc: it said nothing of why"),
        (
            "for i in 1 2; do echo done MS_A_$i.ngc >> headless.txt; done",
            "LinuxCNC died in MS_A_3.ngc: it said nothing of why",
        ),
        ("for i in 1 2 3; do echo done MS_A_$i.ngc >> headless.txt; done", ""),
    ],
)
def test_what_stopped_it_is_one_line(
    script, outcome, for_linuxcnc, twins, small, crooked, tmp_path, monkeypatch
):
    bin_folder, folder = tmp_path / "bin", tmp_path / "machine"
    folder.mkdir()
    stand_in(bin_folder, monkeypatch, script)
    assert started(for_linuxcnc, twins, small, crooked, folder).outcome == outcome


def test_a_control_that_hangs_is_ended(for_linuxcnc, twins, small, crooked, tmp_path, monkeypatch):
    bin_folder, folder = tmp_path / "bin", tmp_path / "machine"
    folder.mkdir()
    stand_in(bin_folder, monkeypatch, f"touch {bin_folder}/lock; sleep 1000")
    files = machine_files(crooked.chain, Probe(), read_dialect("linuxcnc"), str(folder / "probe"))
    contact = TwinContact(twins, small, crooked, np.random.default_rng(0))
    contact.failure = "what the twin refused"
    session = run_on_linuxcnc(for_linuxcnc.programs, files, contact, folder / "probe")
    assert session.outcome == "what the twin refused"
    assert not (bin_folder / "lock").exists()


def test_a_second_linuxcnc_is_not_started(monkeypatch, tmp_path):
    stand_in(tmp_path, monkeypatch, "exit 0")
    (tmp_path / "lock").write_text("")
    with pytest.raises(DesignError, match="is already running on this computer"):
        installed("")


def test_root_must_name_somebody_else(monkeypatch, tmp_path):
    stand_in(tmp_path, monkeypatch, "exit 0")
    monkeypatch.setattr(session_module.os, "geteuid", lambda: 0)
    with pytest.raises(DesignError, match="refuses to run as root: name an ordinary user"):
        installed("")
    with pytest.raises(DesignError, match="no such user on this computer"):
        installed("nobody-of-that-name")
    with pytest.raises(DesignError, match="refuses root"):
        installed("root")


def test_the_scripts_beside_are_python_of_the_system():
    """They import nothing that the project brings."""
    beside = Path(session_module.__file__).parent / "beside"
    for file in beside.glob("*.py"):
        tree = ast.parse(file.read_text())
        imported = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
        imported |= {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
        assert imported <= sys.stdlib_module_names | {"hal", "linuxcnc", "collections.abc"}
