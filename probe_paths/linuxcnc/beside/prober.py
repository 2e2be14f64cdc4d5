#!/usr/bin/env python3
"""Component of LinuxCNC's hardware layer: the touch probe, whose contact the exact twin decides.

Runs in the Python of the system and knows nothing but five joint positions. When a probing stroke
has begun it sends where it began and its direction to the twin, and gets the distance to the
contact. The comparison with it is left to components of the servo thread, in the very period in
which the axes get there: a busy computer cannot delay it.

    prober.py SOCKET JOINTS
"""

import json
import math
import socket
import sys
import time
from typing import Any, TextIO

import hal

PROBING = 5  # type of motion of a G38 move
DIRECTION_KNOWN_AFTER = 0.05
"""Way after which the direction of a stroke is known to eleven digits, mm."""

NEVER = 1e9


def snapshot(component: Any, joints: int) -> list[float]:
    """Positions of one and the same period: read until two readings agree."""
    while True:
        one = [component[f"joint-{i}"] for i in range(joints)]
        if one == [component[f"joint-{i}"] for i in range(joints)]:
            return one


def arm(component: Any, gains: list[float], threshold: float) -> None:
    """From now on the probe is on where the joints are beyond the threshold along the gains."""
    component["threshold"] = NEVER
    for name, gain in zip(("sum2.0.gain0", "sum2.0.gain1", "sum2.1.gain0"), gains):
        hal.set_p(name, repr(gain))
    time.sleep(0.005)  # a few periods, so that no old sum meets the new threshold
    component["threshold"] = threshold


def ask(stream: TextIO, question: dict[str, Any]) -> Any:
    """One line to the twin, one line back."""
    stream.write(json.dumps(question) + "\n")
    stream.flush()
    return json.loads(stream.readline())


def watch(component: Any, stream: TextIO, joints: int) -> None:
    """For ever: find where a stroke begins, ask, arm."""
    begin: Any = None
    armed = False
    while True:
        now = time.localtime()
        component["seconds"] = now.tm_hour * 3600 + now.tm_min * 60 + now.tm_sec
        component["date"] = now.tm_year * 10000 + now.tm_mon * 100 + now.tm_mday
        if component["motion-type"] != PROBING:
            if begin is not None:
                component["threshold"] = NEVER
            begin, armed = None, False
        elif begin is None:
            begin = snapshot(component, joints)
        elif not armed:
            here = snapshot(component, joints)
            way = [b - a for a, b in zip(begin[:3], here[:3])]
            length = math.sqrt(sum(v * v for v in way))
            if length > DIRECTION_KNOWN_AFTER:
                direction = [v / length for v in way]
                travel = ask(stream, {"joints": begin, "direction": direction})
                start = sum(d * p for d, p in zip(direction, begin))
                threshold = NEVER if travel is None else start + travel
                arm(component, direction, threshold)
                armed = True
                here = snapshot(component, joints)
                beyond = sum(d * p for d, p in zip(direction, here)) - threshold
                if beyond > 0.0:  # the contact was not to be expected for a quarter of a millimetre
                    ask(stream, {"late": beyond})
        time.sleep(0.0005)


def main() -> None:
    """Connect, say that the component is there, watch."""
    joints = int(sys.argv[2])
    component = hal.component("prober")
    for i in range(joints):
        component.newpin(f"joint-{i}", hal.HAL_FLOAT, hal.HAL_IN)
    component.newpin("motion-type", hal.HAL_S32, hal.HAL_IN)
    for name in ("threshold", "seconds", "date"):
        component.newpin(name, hal.HAL_FLOAT, hal.HAL_OUT)
    component["threshold"] = NEVER
    link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    link.connect(sys.argv[1])
    component.ready()
    try:
        watch(component, link.makefile("rw"), joints)
    except (KeyboardInterrupt, ValueError):  # LinuxCNC, or the twin, ends
        component.exit()


if __name__ == "__main__":
    main()
