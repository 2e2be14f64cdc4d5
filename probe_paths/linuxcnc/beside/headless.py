#!/usr/bin/env python3
"""User interface of LinuxCNC without a screen: starts the programs of `programs.txt` one by one.

Runs in the Python of the system, in the folder of the machine. What happens goes to `headless.txt`,
a line each: `ready`, `done NAME`, `stopped NAME: why`. It ends when all is done or something has
stopped, and LinuxCNC with it.
"""

import time
from collections.abc import Callable
from pathlib import Path

import linuxcnc

STATE = linuxcnc.stat()
COMMAND = linuxcnc.command()
ERRORS = linuxcnc.error_channel()


def report(text: str) -> None:
    """A line that is there at once, whatever happens next."""
    with open("headless.txt", "a", encoding="utf-8") as file:
        file.write(f"{text}\n")


def wait(is_so: Callable[[], bool], seconds: float) -> str:
    """Wait until something holds; what LinuxCNC says of an error, or that it took too long."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        STATE.poll()
        if is_so():
            return ""
        error = ERRORS.poll()
        if error and error[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR):
            return " ".join(error[1].split())
        time.sleep(0.02)
    return f"nothing after {seconds} s"


def is_idle() -> bool:
    """The program has ended."""
    return bool(STATE.interp_state == linuxcnc.INTERP_IDLE)


def start() -> str:
    """Machine on, every axis where it is said to be."""
    COMMAND.state(linuxcnc.STATE_ESTOP_RESET)
    COMMAND.wait_complete()
    COMMAND.state(linuxcnc.STATE_ON)
    COMMAND.wait_complete()
    COMMAND.mode(linuxcnc.MODE_MANUAL)
    COMMAND.wait_complete()
    COMMAND.home(-1)
    return wait(lambda: all(STATE.homed[: STATE.joints]), 30)


def run(name: str, seconds: float) -> str:
    """Run one program; empty where it came to its end, or why it did not."""
    COMMAND.mode(linuxcnc.MODE_AUTO)
    COMMAND.wait_complete()
    COMMAND.program_open(name)
    COMMAND.wait_complete()
    COMMAND.auto(linuxcnc.AUTO_RUN, 0)
    error = wait(lambda: not is_idle(), 30)
    if error:
        return error
    error = wait(lambda: is_idle() or STATE.paused, seconds)
    if not error and STATE.paused:
        error = "M0"
    if error:
        COMMAND.abort()
        COMMAND.wait_complete()
    return error


def main() -> None:
    """All programs, or as many as run."""
    error = start()
    if error:
        return report(f"stopped machine: {error}")
    report("ready")
    for line in Path("programs.txt").read_text().splitlines():
        name, seconds = line.split()
        error = run(str(Path(name).resolve()), float(seconds))
        if error:
            return report(f"stopped {name}: {error}")
        report(f"done {name}")


if __name__ == "__main__":
    main()
