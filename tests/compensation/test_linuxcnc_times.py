"""The real control without a screen: a compensated turn takes as long as the turn it was."""

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest
from linuxcnc_rig import AXES, AXIS, HAL, INI, a_user

from compensation.field.state import State
from compensation.part_programs.frame import Frame
from compensation.part_programs.program import read_part_program
from compensation.programs.compensation import compensated
from compensation.tables.header import header_of
from probe_paths.linuxcnc.session import LOCK

pytestmark = pytest.mark.slow

TURN = "G21 G90 G94\nG0 X10 Y0 Z0 B0 C0\nG1 C90 F720\nG1 X11 B-20 F60\nM2\n"
"""7.5 s of turning alone, 1 s along 1 mm beside a turn of B by 20 degrees."""

SCREEN = '''#!/usr/bin/env python3
"""Runs programs one after the other and notes how long each took."""
import json, time, linuxcnc
stat, command, errors, took, said = (
    linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel(), {}, []
)
def wait(is_so):
    end = time.monotonic() + 60.0
    while True:
        stat.poll()
        error = errors.poll()
        if error:
            said.append(str(error[1]))
        if is_so() or time.monotonic() > end:
            return
        time.sleep(0.002)
command.state(linuxcnc.STATE_ESTOP_RESET)
command.state(linuxcnc.STATE_ON)
wait(lambda: stat.task_state == linuxcnc.STATE_ON)
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.home(-1)
wait(lambda: all(stat.homed[:5]))
for name in ("before.ngc", "after.ngc"):
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    command.program_open(name)
    command.wait_complete()
    begun = time.monotonic()
    command.auto(linuxcnc.AUTO_RUN, 0)
    wait(lambda: stat.interp_state != linuxcnc.INTERP_IDLE)
    wait(lambda: stat.interp_state == linuxcnc.INTERP_IDLE)
    took[name] = time.monotonic() - begun
open("took.json", "w").write(json.dumps({**took, "errors": said}))
'''


def test_a_compensated_turn_takes_its_time(bench_chain, datum, known):
    user = a_user()
    folder = Path(tempfile.mkdtemp(prefix="matstd-times-"))
    axes = [AXIS.format(a, i, low, high, kind) for i, (a, low, high, kind) in enumerate(AXES)]
    ini = INI.replace("HALFILE = corrector.hal\n", "").replace("scenario.py", "screen.py")
    plain = ["loadrt [", "addf motion", "user-enable", "tool-"]
    hal = [line for line in HAL.splitlines() if any(word in line for word in plain)]
    hal += [
        f"net position-{k} joint.{k}.motor-pos-cmd => joint.{k}.motor-pos-fb"
        for k in range(len(AXES))
    ]
    program = folder / "before.ngc"
    program.write_text(TURN)
    made = compensated(
        read_part_program(program, Frame(bench_chain, datum)),
        known,
        header_of(bench_chain, "0123456789ab", datum, State()),
    )
    texts = {
        "machine.ini": ini + "".join(axes),
        "machine.hal": "\n".join(hal) + "\n",
        "tool.tbl": "T1 P1 Z0 D1\n",
        "machine.var": "",
        "screen.py": SCREEN,
        "after.ngc": made.text,
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "screen.py").chmod(0o755)
    for path in (folder, *folder.iterdir()):
        if user:
            shutil.chown(path, user)
    keep = {k: v for k, v in os.environ.items() if k in ("PATH", "LANG", "LC_ALL")}
    try:
        done = subprocess.run(
            ["linuxcnc", "-r", "machine.ini"],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=150,
            check=False,
            env=keep | {"HOME": str(folder)},
            user=user,
        )
    finally:
        if LOCK.exists():
            subprocess.run(["halrun", "-U"], cwd=folder, user=user, check=False)
            LOCK.unlink(missing_ok=True)
    told = folder / "took.json"
    assert told.exists(), done.stdout + done.stderr
    took = json.loads(told.read_text())
    assert not took["errors"]
    assert took["before.ngc"] > 8.0
    # blends between the lines it becomes cost 0.4 s; 1.9 s altogether with F as it stood
    assert abs(took["after.ngc"] / took["before.ngc"] - 1.0) < 0.08, took
    shutil.rmtree(folder)
