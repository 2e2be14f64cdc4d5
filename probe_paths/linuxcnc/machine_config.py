"""A machine for LinuxCNC: every axis of the chain on its own, the probe asked at the twin."""

from pathlib import Path

from matstd.nc.linuxcnc import net, tool_table, variables
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.linuxcnc.latch import SERVO_PERIOD
from matstd.probe_paths.plan import Probe, ProgramFrame
from matstd.twin.machine import Chain
from matstd.twin.units import DEG

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

    Args:
        dialect: Numbers of tool and preset.
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
    is_linear = letter in "XYZ"
    low, high = (v if is_linear else v / DEG for v in chain.link(letter).range)
    return _text("axis.ini").format(
        letter=letter,
        joint=joint,
        low=low,
        high=high,
        speed=SPEED,
        acceleration=ACCELERATION,
        kind="LINEAR" if is_linear else "ANGULAR",
        home=min(max(0.0, low), high),
    )


def _positions(joints: int) -> str:
    """Position feedback of every joint, equal to its command."""
    return "\n".join(
        net(
            f"position-{i}",
            f"joint.{i}.motor-pos-cmd",
            f"joint.{i}.motor-pos-fb",
            f"prober.joint-{i}",
            *_SUMMED[i : i + 1],
        )
        for i in range(joints)
    )
