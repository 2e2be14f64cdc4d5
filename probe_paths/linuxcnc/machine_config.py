"""A machine for LinuxCNC: every axis of the chain on its own, the probe asked at the twin.

LinuxCNC samples the probe once in every period of its servo thread and stores the position at that
moment: the axes move on between the contact and the sample (`latch_error`).
"""

from pathlib import Path

import numpy as np

from matstd.nc.linuxcnc import net, tool_table, variables
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import Probe, ProgramFrame
from matstd.twin.machine import Chain

SERVO_PERIOD = 1e-3  # period of the servo thread of our machine, s


def latch_error(feed: float, period: float = SERVO_PERIOD, latency: float = 0.0) -> float:
    """Largest distance of a latched position beyond the contact, along the stroke, mm.

    ``feed (period + latency)``: the contact falls anywhere into a period, so that the error is
    uniform between ``feed latency`` and this.

    Args:
        feed: Feed of the touch that measures, mm/s.
        period: Period of the servo thread, s.
        latency: Latency of the probe's signal, s.
    """
    return feed * (period + latency)


def latch_u(feed: float, period: float = SERVO_PERIOD, latency: float = 0.0) -> float:
    """Standard uncertainty of a touch by the latch, mm, about the contact itself.

    The root of the mean square of an error that is uniform between ``a = feed latency`` and
    ``b = feed (period + latency)``: ``sqrt((a^2 + a b + b^2) / 3)``. Nothing is corrected: the
    common part acts as a larger ball, which the calibration of the probe absorbs.

    Reference:
        JCGM 100, 4.3.7 (rectangular distribution).
    """
    a, b = feed * latency, latch_error(feed, period, latency)
    return float(np.sqrt((a * a + a * b + b * b) / 3.0))


SPEED, ACCELERATION = 500.0, 5000.0
"""Speed and acceleration, mm/s and mm/s^2, or in degrees: nothing is gained by a slow twin."""

PROBER = "prober.py"
HEADLESS = "headless.py"
PROGRAMS = "programs.txt"
MESSAGES = "headless.txt"

BESIDE = Path(__file__).parent / "beside"
"""Files that go to LinuxCNC: templates, and scripts for the Python of the system."""

_SUMMED = ("sum2.0.in0", "sum2.0.in1", "sum2.1.in0")


def machine_files(chain: Chain, probe: Probe, dialect: Dialect, socket: str) -> dict[str, str]:
    """Text of every file of the machine, by name.

    The preset stands where `ProgramFrame` wants it, the probe in the tool table.
    """
    frame = ProgramFrame(chain, probe)
    letters = sorted(frame.letters, key="XYZABC".index)
    numbers = {
        "headless": HEADLESS,
        "prober": PROBER,
        "socket": socket,
        "period": round(SERVO_PERIOD * 1e9),
        "letters": "".join(letters),
        "spaced": " ".join(letters),
        "joints": len(letters),
        "speed": SPEED,
        "acceleration": ACCELERATION,
    }
    axes = [_axis(chain, letter, i) for i, letter in enumerate(letters)]
    offsets = [frame.reading(a, 0.0) - (probe.tool_length if a == "Z" else 0.0) for a in "XYZ"]
    return {
        "machine.ini": _text("machine.ini").format(**numbers) + "".join(axes),
        "machine.hal": _text("machine.hal").format(**numbers, positions=_positions(len(letters))),
        "machine.var": variables({dialect.preset: offsets}),
        "tool.tbl": tool_table(dialect.tool, probe.tool_length, probe.radius),
    }


def _text(name: str) -> str:
    return (BESIDE / name).read_text(encoding="utf-8")


def _axis(chain: Chain, letter: str, joint: int) -> str:
    """Tables of one axis; a rotary axis is not wrapped, so that its readings are unchanged."""
    link = chain.link(letter)
    low, high = (v / link.unit for v in link.range)
    return _text("axis.ini").format(
        letter=letter,
        joint=joint,
        low=low,
        high=high,
        speed=SPEED,
        acceleration=ACCELERATION,
        kind="LINEAR" if link.kind == "linear" else "ANGULAR",
        home=min(max(0.0, low), high),
    )


def _positions(joints: int) -> str:
    """Position feedback of every joint, equal to its command."""
    lines = []
    for i in range(joints):
        sinks = (f"joint.{i}.motor-pos-fb", f"prober.joint-{i}", *_SUMMED[i : i + 1])
        lines.append(net(f"position-{i}", f"joint.{i}.motor-pos-cmd", *sinks))
    return "\n".join(lines)
