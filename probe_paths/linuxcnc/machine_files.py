"""A machine for LinuxCNC: every axis of the chain on its own, the probe asked at the twin."""

from probe_paths.language import Dialect
from probe_paths.linuxcnc.latch import PERIOD
from probe_paths.plan import Probe, ProgramFrame
from twin.machine import Chain
from twin.units import DEG

SPEED, ACCELERATION = 500.0, 5000.0
"""Of linear axes, mm/s and mm/s^2; of rotary ones in degrees. Nothing is gained by a slow twin."""

PROBER = "prober.py"
HEADLESS = "headless.py"
PROGRAMS = "programs.txt"
SAID = "headless.txt"

_AXIS = """\
[AXIS_{letter}]
MIN_LIMIT = {low}
MAX_LIMIT = {high}
MAX_VELOCITY = {speed}
MAX_ACCELERATION = {acceleration}
[JOINT_{joint}]
TYPE = {kind}
MIN_LIMIT = {low}
MAX_LIMIT = {high}
MAX_VELOCITY = {speed}
MAX_ACCELERATION = {acceleration}
FERROR = 1.0
MIN_FERROR = 1.0
HOME = {home}
HOME_OFFSET = {home}
HOME_SEQUENCE = 0
"""

_INI = """\
[EMC]
VERSION = 1.1
MACHINE = matstd
[DISPLAY]
DISPLAY = ./{headless}
MAX_FEED_OVERRIDE = 1.0
[TASK]
TASK = milltask
CYCLE_TIME = 0.005
[RS274NGC]
PARAMETER_FILE = machine.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4.0
SERVO_PERIOD = {period}
[HAL]
HALFILE = machine.hal
[TRAJ]
COORDINATES = {spaced}
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = {speed}
MAX_LINEAR_VELOCITY = {speed}
DEFAULT_LINEAR_ACCELERATION = {acceleration}
MAX_LINEAR_ACCELERATION = {acceleration}
[KINS]
KINEMATICS = trivkins coordinates={letters} kinstype=BOTH
JOINTS = {joints}
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.100
TOOL_TABLE = tool.tbl
"""

_HAL = """\
loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt sum2 count=2
loadrt comp count=1
addf motion-command-handler servo-thread
addf motion-controller servo-thread
addf sum2.0 servo-thread
addf sum2.1 servo-thread
addf comp.0 servo-thread
loadusr -Wn prober ./{prober} {socket} {joints}
{positions}
net partial sum2.0.out => sum2.1.in1
net along sum2.1.out => comp.0.in1
net threshold prober.threshold => comp.0.in0
net contact comp.0.out => motion.probe-input
net kind motion.motion-type => prober.motion-type
net seconds prober.seconds => motion.analog-in-00
net date prober.date => motion.analog-in-01
net stop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""

_SUMMED = ("sum2.0.in0", "sum2.0.in1", "sum2.1.in0")


def machine_files(chain: Chain, probe: Probe, dialect: Dialect, socket: str) -> dict[str, str]:
    """Text of every file of the machine, by name.

    The preset stands where `ProgramFrame` wants it, the probe in the tool table.

    Args:
        probe: In the spindle.
        dialect: Numbers of tool and preset.
        socket: Where the twin answers.
    """
    frame = ProgramFrame(chain, probe)
    letters = sorted(frame.letters, key="XYZABC".index)
    numbers = {
        "headless": HEADLESS,
        "prober": PROBER,
        "socket": socket,
        "period": round(PERIOD * 1e9),
        "letters": "".join(letters),
        "spaced": " ".join(letters),
        "joints": len(letters),
        "speed": SPEED,
        "acceleration": ACCELERATION,
    }
    axes = [_axis(chain, letter, i) for i, letter in enumerate(letters)]
    offsets = [frame.reading(a, 0.0) - (probe.tool_length if a == "Z" else 0.0) for a in "XYZ"]
    variables = [(5161 + i, 0.0) for i in range(9)] + [(5181 + i, 0.0) for i in range(9)]
    variables += [(5210, 0.0)] + [(5211 + i, 0.0) for i in range(9)] + [(5220, 1.0)]
    for system in range(9):
        rest = [0.0] * 7  # A to W, and the rotation
        values = [*(offsets if system == dialect.preset - 1 else [0.0] * 3), *rest]
        variables += [(5221 + 20 * system + i, v) for i, v in enumerate(values)]
    return {
        "machine.ini": _INI.format(**numbers) + "".join(axes),
        "machine.hal": _HAL.format(**numbers, positions=_positions(len(letters))),
        "machine.var": "".join(f"{number}\t{value:.6f}\n" for number, value in variables),
        "tool.tbl": (
            f"T{dialect.tool} P{dialect.tool} Z{probe.tool_length:.6f} D{2.0 * probe.radius:.6f}\n"
        ),
    }


def _axis(chain: Chain, letter: str, joint: int) -> str:
    """Tables of one axis; a rotary one is not wrapped, so that readings are what they are."""
    is_linear = letter in "XYZ"
    low, high = (v if is_linear else v / DEG for v in chain.link(letter).range)
    return _AXIS.format(
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
    """Every joint is where it is told to be, at once."""
    lines = []
    for i in range(joints):
        summed = _SUMMED[i] if i < len(_SUMMED) else ""
        to = f"joint.{i}.motor-pos-fb prober.joint-{i} {summed}".rstrip()
        lines.append(f"net position-{i} joint.{i}.motor-pos-cmd => {to}")
    return "\n".join(lines)
