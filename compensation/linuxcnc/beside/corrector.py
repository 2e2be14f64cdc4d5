#!/usr/bin/env python3
"""Component of LinuxCNC's hardware layer: corrections of the service as external offsets.

Runs in the Python of the system. It sends positions and temperatures to the service and gives what
comes back to the control, by itself limited and never in a jump: also when the service is gone, the
machine is switched off and on, or an axis comes near the end of its travel.

    corrector.py --socket S --axes XYZBC --linear XYZ --scale MM [--sensors a,b]
                 [--ends X:-400:400,...] [--most MM] [--rate MM_S] [--patience S] [--hold S]
"""

import argparse
import json
import math
import socket
import time
from typing import Any, Optional

LOOK_PERIOD = 0.002  # between two looks at the pins, s
SMALLEST_MOTION = 1e-6  # smallest change of a position that is a motion, mm or degrees
LONGEST_STEP = 0.005  # longest time that one step may stand for, s: a pause is no licence to jump

MAX_OTHER_OFFSETS = 25
"""Looks in a row at which the control has another offset than it was given, until that counts."""

SETTLING_TIME = 0.01  # time in which an offset that is taken back has really gone, s
RECONNECT_PERIOD = 0.5  # between two tries to reach the service, s


class Giver:
    """What the linear axes are given: goes towards what is wanted, at a rate; begins at zero.

    LinuxCNC adds up changes of counts. Those that come while the machine is off are lost, and
    switching it on begins at zero again with the axes where they are.
    """

    def __init__(
        self, axes: int, scale: float, most: float, rate: float, patience: float, hold: float
    ) -> None:
        """So many axes, mm of a count, mm, mm/s and s."""
        self.scale, self.most, self.rate = scale, most, rate
        self.patience, self.hold = patience, hold
        self.given, self.wanted = [0.0] * axes, [0.0] * axes
        self.counts, self.base = [0] * axes, [0] * axes
        self.answered_at: Optional[float] = None
        self.last: Optional[float] = None
        self.astray = 0

    def answer(self, wanted: "list[float]", now: float) -> None:
        """A correction of the service; one that is no number is no answer, so the last one ages."""
        if all(map(math.isfinite, wanted)):
            self.wanted, self.answered_at = list(wanted), now

    def age(self, now: float) -> float:
        """Age of the last correction, s."""
        return 1e9 if self.answered_at is None else now - self.answered_at

    def is_valid(self, now: float) -> bool:
        """Whether the service answers."""
        return self.age(now) <= self.patience

    def step(
        self, now: float, is_on: bool, requested: "list[float]", room: "list[tuple[float, float]]"
    ) -> "list[int]":
        """Counts at this moment.

        Args:
            now: s, of a clock that only goes forward.
            is_on: Machine on and every axis homed.
            requested: Offsets that the control has been given, mm.
            room: Smallest and largest offset that keeps an axis within its travel, mm.
        """
        passed = 0.0 if self.last is None else min(max(now - self.last, 0.0), LONGEST_STEP)
        self.last = now
        if not is_on:
            self.base, self.given, self.astray = list(self.counts), [0.0] * len(self.given), 0
            return self.counts
        self._agree(requested)
        far = self.rate * passed
        fades = self.age(now) > self.hold
        for k, (low, high) in enumerate(room):
            aim = 0.0 if fades else min(max(self.wanted[k], -self.most), self.most)
            aim = min(max(aim, min(low, 0.0)), max(high, 0.0))
            self.given[k] += min(max(aim - self.given[k], -far), far)
            self.counts[k] = self.base[k] + round(self.given[k] / self.scale)
        return self.counts

    def _agree(self, requested: "list[float]") -> None:
        """Where counts were lost for good, go on from what the control has."""
        theirs = [round(v / self.scale) for v in requested]
        ours = [c - b for c, b in zip(self.counts, self.base)]
        self.astray = self.astray + 1 if any(abs(a - b) > 1 for a, b in zip(theirs, ours)) else 0
        if self.astray > MAX_OTHER_OFFSETS:
            self.base = [c - v for c, v in zip(self.counts, theirs)]
            self.given, self.astray = [v * self.scale for v in theirs], 0


def room_of(
    position: float, speed: float, ends: "tuple[float, float]", rate: float
) -> "tuple[float, float]":
    """Offsets that keep an axis within its travel, and can be taken back before its end comes.

    Args:
        position: mm.
        speed: mm/s.
        ends: Ends of the travel, mm.
        rate: Rate at which an offset changes, mm/s.
    """
    low, high = ends
    share = min(1.0, rate / abs(speed)) if speed else 1.0
    below, above = low - position, high - position
    if speed < 0.0:
        below = min(below - SETTLING_TIME * speed, 0.0) * share
    if speed > 0.0:
        above = max(above - SETTLING_TIME * speed, 0.0) * share
    return below, above


class Link:
    """The socket of the service: one question at a time, nothing is waited for."""

    def __init__(self, path: str, patience: float) -> None:
        """Where the service listens, and how long an answer may take, s."""
        self.path, self.patience = path, patience
        self.socket: Optional[socket.socket] = None
        self.asked_at: Optional[float] = None
        self.tried_at = -1e9
        self.text = b""
        self.number = 0

    def exchange(self, question: "dict[str, Any]", now: float) -> Optional["dict[str, Any]"]:
        """Send a question if none is open; an answer if one has come."""
        try:
            if self.socket is None and not self._connected(now):
                return None
            if self.asked_at is None:
                self.number += 1
                line = json.dumps({"number": self.number, **question}) + "\n"
                self.socket.sendall(line.encode())  # type: ignore[union-attr]
                self.asked_at = now
            return self._received(now)
        except (OSError, ValueError):
            self.close()
            return None

    def _connected(self, now: float) -> bool:
        if now - self.tried_at < RECONNECT_PERIOD:
            return False
        self.tried_at = now
        link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        link.settimeout(0.2)
        try:
            link.connect(self.path)
        except OSError:
            link.close()
            return False
        link.setblocking(False)
        self.socket = link
        return True

    def _received(self, now: float) -> Optional["dict[str, Any]"]:
        try:
            data = self.socket.recv(65536)  # type: ignore[union-attr]
        except BlockingIOError:
            if self.asked_at is not None and now - self.asked_at > self.patience:
                self.close()
            return None
        if not data:
            self.close()
            return None
        self.text += data
        line, end, rest = self.text.rpartition(b"\n")
        if not end:
            return None
        self.text, self.asked_at = rest, None
        answer: dict[str, Any] = json.loads(line.rpartition(b"\n")[2])
        return answer if answer.get("number") == self.number else None

    def close(self) -> None:
        """Begin anew."""
        if self.socket is not None:
            self.socket.close()
        self.socket, self.asked_at, self.text = None, None, b""


class Corrector:
    """Pins of the component, and what happens at every look at them."""

    def __init__(self, args: argparse.Namespace, component: Any) -> None:
        """Make the pins."""
        import hal

        self.args, self.component = args, component
        self.letters = args.axes.lower()
        self.linear = args.linear.lower()
        self.sensors = [s for s in args.sensors.split(",") if s]
        for letter in self.letters:
            component.newpin(f"position-{letter}", hal.HAL_FLOAT, hal.HAL_IN)
        for letter in self.linear:
            component.newpin(f"requested-{letter}", hal.HAL_FLOAT, hal.HAL_IN)
            component.newpin(f"counts-{letter}", hal.HAL_S32, hal.HAL_OUT)
        for name in self.sensors:
            component.newpin(f"temperature-{name}", hal.HAL_FLOAT, hal.HAL_IN)
        component.newpin("spindle-rpm", hal.HAL_FLOAT, hal.HAL_IN)
        for name in ("machine-on", "homed"):
            component.newpin(name, hal.HAL_BIT, hal.HAL_IN)
        for name in ("enable", "valid"):
            component.newpin(name, hal.HAL_BIT, hal.HAL_OUT)
        component.newpin("age", hal.HAL_FLOAT, hal.HAL_OUT)
        limits = (args.most, args.rate, args.patience, args.hold)
        self.giver = Giver(len(self.linear), args.scale, *limits)
        self.link = Link(args.socket, args.patience)
        self.ends = dict(_ends(part) for part in args.ends.split(",") if part)
        self.at: dict[str, float] = {}
        self.ways = {letter: 0 for letter in self.letters}
        self.looked_at = 0.0
        self.quality = ""

    def look(self, now: float) -> None:
        """Read the pins, ask, give."""
        pins = self.component
        at = {letter: pins[f"position-{letter}"] for letter in self.letters}
        speeds = self._speeds(at, now)
        answer = self.link.exchange(
            {
                "readings": at,
                "directions": self.ways,
                "temperatures": {n: pins[f"temperature-{n}"] for n in self.sensors},
                "spindle_rpm": pins["spindle-rpm"],
            },
            now,
        )
        if answer is not None:
            self.quality = answer["quality"]
            # a fading answer is not taken as new, so that the last correction ages and goes to zero
            if self.quality != "fading":
                self.giver.answer(answer["correction"], now)
        never = (-1e9, 1e9)
        room = [
            room_of(at[x], speeds[x], self.ends.get(x, never), self.giver.rate) for x in self.linear
        ]
        is_on = bool(pins["machine-on"] and pins["homed"])
        requested = [pins[f"requested-{x}"] for x in self.linear]
        for x, counts in zip(self.linear, self.giver.step(now, is_on, requested, room)):
            pins[f"counts-{x}"] = counts
        pins["enable"] = True
        pins["valid"] = is_on and self.quality == "valid" and self.giver.is_valid(now)
        pins["age"] = self.giver.age(now)

    def _speeds(self, at: "dict[str, float]", now: float) -> "dict[str, float]":
        """Speed of every axis since the last look; remembers which way it went last."""
        passed = max(now - self.looked_at, 1e-4)
        moved = {x: at[x] - self.at.get(x, at[x]) for x in at}
        for x, way in moved.items():
            if abs(way) > SMALLEST_MOTION:
                self.ways[x] = 1 if way > 0.0 else -1
        self.at, self.looked_at = at, now
        return {x: way / passed for x, way in moved.items()}


def _ends(text: str) -> "tuple[str, tuple[float, float]]":
    letter, low, high = text.split(":")
    return letter.lower(), (float(low), float(high))


def arguments(words: Optional["list[str]"] = None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--name", default="corrector")
    for name in ("--socket", "--axes", "--linear"):
        parser.add_argument(name, required=True)
    parser.add_argument("--scale", type=float, required=True)
    for name in ("--sensors", "--ends"):
        parser.add_argument(name, default="")
    for name, value in (("--most", 0.2), ("--rate", 1.0), ("--patience", 0.5), ("--hold", 5.0)):
        parser.add_argument(name, type=float, default=value)
    return parser.parse_args(words)


def main() -> None:
    """Say that the component is there, look for ever."""
    import hal

    args = arguments()
    component = hal.component(args.name)
    corrector = Corrector(args, component)
    component.ready()
    try:
        while True:
            corrector.look(time.monotonic())
            time.sleep(LOOK_PERIOD)
    except KeyboardInterrupt:
        component.exit()


if __name__ == "__main__":
    main()
