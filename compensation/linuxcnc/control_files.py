"""What LinuxCNC needs to take corrections: a HAL file and the component, beside its INI file."""

from pathlib import Path
from shutil import copyfile

from matstd.compensation.service import OutputLimits, Service
from matstd.nc.linuxcnc import Ini, net
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import write_whole
from matstd.twin.machine import Chain

HAL_FILE, COMPONENT, SOCKET = "corrector.hal", "corrector.py", "corrector.sock"

HEAD = "# matstd serve --linuxcnc wrote this"
"""First line of the HAL file, by which it is known as ours."""

SCALE = 1e-5  # one count of an external offset, mm: both the component and the control take it

LARGEST_RATIO = 0.9
"""Share of an axis's speed and acceleration that LinuxCNC lets external offsets have."""

BESIDE = Path(__file__).parent / "beside"  # the component, which runs in the Python of the system


class Control(Ini):
    """INI file of a LinuxCNC that corrections are given to."""

    def check(self, chain: Chain) -> None:
        """Whether it is the control of the machine and accepts corrections.

        Raises:
            BadFile: Inches, an axis that is missing, no share of speed for external offsets.
        """
        unit = self.value("TRAJ", "LINEAR_UNITS")
        if unit.lower() not in ("mm", "metric"):
            raise BadFile(self.path, "[TRAJ] LINEAR_UNITS", unit, "mm")
        missing = [a for a in chain.programmed_axes if a not in self.letters]
        if missing:
            expected = f"the axes of {chain.name}: {', '.join(chain.programmed_axes)}"
            raise BadFile(self.path, "[TRAJ] COORDINATES", self.letters, expected)
        for axis in chain.linear_axes:
            section, key = f"AXIS_{axis}", "OFFSET_AV_RATIO"
            ratio = self.number(section, key)
            if not 0.0 < ratio <= LARGEST_RATIO:
                expected = f"above 0, and {LARGEST_RATIO:g} at most: what external offsets may use"
                raise BadFile(self.path, f"[{section}] {key}", f"{ratio:g}", expected)

    @property
    def reads_ours(self) -> bool:
        """Whether our HAL file is among those of the control."""
        return HAL_FILE in (path.name for path in self.hal_files)


def write_control_files(control: Control, service: Service, limits: OutputLimits) -> list[Path]:
    """Write the HAL file and the component beside the INI file; those of before are replaced.

    Raises:
        DesignError: A file of that name is not ours.
    """
    folder = control.path.parent
    hal, component = folder / HAL_FILE, folder / COMPONENT
    source = BESIDE / "corrector.py"
    ours = {hal: HEAD, component: source.read_text(encoding="utf-8").splitlines()[2]}
    for path, line in ours.items():
        if path.exists() and line not in path.read_text(encoding="utf-8", errors="replace"):
            raise DesignError(f"{path} already exists and is not ours; move it away")
    write_whole(hal, hal_text(control, service, limits))
    copyfile(source, component)
    component.chmod(0o755)
    return [hal, component]


def hal_text(control: Control, service: Service, limits: OutputLimits) -> str:
    """The HAL file: the component, its pins on those of the axes."""
    chain, state = service.errors.chain, service.errors.state
    folder = control.path.parent.resolve()
    linear = service.correction.linear_axes
    words = [str(folder / COMPONENT), "--socket", str(folder / SOCKET)]
    words += ["--axes", "".join(a for a in control.letters if a in chain.axes)]
    words += ["--linear", "".join(linear), "--scale", f"{SCALE:g}"]
    words += ["--sensors", ",".join(service.sensors)]
    words += ["--ends", ",".join("{}:{:.10g}:{:.10g}".format(a, *control.ends(a)) for a in linear)]
    for name in ("most", "rate", "patience", "hold"):
        words += [f"--{name}", f"{getattr(limits, name):g}"]
    words = [w or "''" for w in words]
    lines = [HEAD, f"# corrections of {chain.name}; net your temperatures and spindle speed below"]
    lines.append(f"loadusr -Wn corrector {' '.join(words)}")
    # a pin takes one signal only, so signals that the control's files already use are kept
    known = control.signals(but=HAL_FILE)

    def connect(name: str, source: str, *sinks: str) -> None:
        lines.append(net(known.get(source, name), source, *sinks))

    for low in (a.lower() for a in control.letters if a in chain.axes):
        connect(f"corrector-at-{low}", f"axis.{low}.pos-cmd", f"corrector.position-{low}")
    for low in map(str.lower, linear):
        lines.append(f"setp axis.{low}.eoffset-scale {SCALE:g}")
        connect(f"corrector-counts-{low}", f"corrector.counts-{low}", f"axis.{low}.eoffset-counts")
        connect(f"corrector-has-{low}", f"axis.{low}.eoffset-request", f"corrector.requested-{low}")
    enabled = (f"axis.{a.lower()}.eoffset-enable" for a in linear)
    connect("corrector-enable", "corrector.enable", *enabled)
    connect("corrector-on", "motion.motion-enabled", "corrector.machine-on")
    connect("corrector-homed", "motion.is-all-homed", "corrector.homed")
    lines += [f"setp corrector.temperature-{n} {v:g}" for n, v in state.temperature.items()]
    if state.spindle_rpm is not None:
        lines.append(f"setp corrector.spindle-rpm {state.spindle_rpm:g}")
    return "\n".join(lines) + "\n"
