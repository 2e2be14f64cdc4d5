"""What LinuxCNC needs to take corrections: a HAL file and the component, beside its INI file."""

import configparser
import re
from pathlib import Path
from shutil import copyfile

from matstd.compensation.service import OutputLimits, Service
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_text, write_whole
from matstd.twin.machine import Chain

HAL_FILE, COMPONENT, SOCKET = "corrector.hal", "corrector.py", "corrector.sock"

HEAD = "# matstd serve --linuxcnc wrote this"
"""First line of the HAL file, by which it is known as ours."""

LARGEST_RATIO = 0.9
"""Share of an axis's speed and acceleration that LinuxCNC lets external offsets have."""

BESIDE = Path(__file__).parent / "beside"
"""The component, which runs in the Python of the system."""


class Control:
    """An INI file of LinuxCNC.

    Attributes:
        path: Of it.
        letters: Axes of the control, in its order.
    """

    def __init__(self, path: Path) -> None:
        """Read it.

        Raises:
            BadFile: No such file, no INI file, or one without the axes.
        """
        self.path, self._text = path, read_text(path)
        self._ini = configparser.ConfigParser(
            strict=False, interpolation=None, inline_comment_prefixes=("#", ";")
        )
        try:
            self._ini.read_string(self._text)
        except configparser.MissingSectionHeaderError as error:
            expected = "a section such as [EMC]: an INI file of LinuxCNC"
            raise BadFile(path, f"line {error.lineno}", repr(error.line), expected) from None
        except configparser.ParsingError as error:
            number, line = error.errors[0]
            raise BadFile(path, f"line {number}", line, "an INI file of LinuxCNC") from None
        self.letters = self._value("TRAJ", "COORDINATES").replace(" ", "").upper()

    def _value(self, section: str, key: str) -> str:
        value = self._ini.get(section, key, fallback="").strip()
        if not value:
            raise BadFile(self.path, f"[{section}]", f"no {key}", f"{key} = ...")
        return value

    def _number(self, section: str, key: str) -> float:
        value = self._value(section, key)
        try:
            return float(value)
        except ValueError:
            raise BadFile(self.path, f"[{section}] {key}", value, "a number") from None

    def check(self, chain: Chain) -> None:
        """Whether it is the control of a machine, and lets itself be corrected.

        Raises:
            BadFile: Inches, an axis that is missing, no share of speed for external offsets.
        """
        unit = self._value("TRAJ", "LINEAR_UNITS")
        if unit.lower() not in ("mm", "metric"):
            raise BadFile(self.path, "[TRAJ] LINEAR_UNITS", unit, "mm")
        missing = [a for a in chain.programmed_axes if a not in self.letters]
        if missing:
            expected = f"the axes of {chain.name}: {', '.join(chain.programmed_axes)}"
            raise BadFile(self.path, "[TRAJ] COORDINATES", self.letters, expected)
        for axis in chain.linear_axes:
            section, key = f"AXIS_{axis}", "OFFSET_AV_RATIO"
            ratio = self._number(section, key)
            if not 0.0 < ratio <= LARGEST_RATIO:
                expected = f"above 0, and {LARGEST_RATIO:g} at most: what external offsets may use"
                raise BadFile(self.path, f"[{section}] {key}", f"{ratio:g}", expected)

    def ends(self, axis: str) -> tuple[float, float]:
        """Limits of an axis, mm."""
        section = f"AXIS_{axis}"
        return self._number(section, "MIN_LIMIT"), self._number(section, "MAX_LIMIT")

    @property
    def hal_files(self) -> list[Path]:
        """HAL files of the control in their order."""
        named = re.findall(r"(?mi)^\s*HALFILE\s*=\s*([^\s#]+)", self._text)
        return [self.path.parent / name for name in named]

    @property
    def reads_ours(self) -> bool:
        """Whether our HAL file is among them."""
        return HAL_FILE in (path.name for path in self.hal_files)

    def signals(self) -> dict[str, str]:
        """Signals that pins are on already, by the pin: a pin has one signal only."""
        out: dict[str, str] = {}
        for path in self.hal_files:
            if path.name == HAL_FILE or not path.is_file():
                continue
            for line in read_text(path).splitlines():
                words = line.partition("#")[0].split()
                if words[:1] == ["net"]:
                    out |= {pin: words[1] for pin in words[2:] if "." in pin}
        return out


def write_control_files(control: Control, service: Service, limits: OutputLimits) -> list[Path]:
    """Write the HAL file and the component beside the INI file; those of before are replaced.

    Args:
        control: That was checked.
        service: Of its machine.
        limits: That the component keeps by itself.

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
    words += ["--linear", "".join(linear), "--sensors", ",".join(service.sensors)]
    words += ["--ends", ",".join("{}:{:g}:{:g}".format(a, *control.ends(a)) for a in linear)]
    for name in ("most", "rate", "patience", "hold"):
        words += [f"--{name}", f"{getattr(limits, name):g}"]
    words = [w or "''" for w in words]
    lines = [HEAD, f"# corrections of {chain.name}; net your temperatures and spindle speed below"]
    lines.append(f"loadusr -Wn corrector {' '.join(words)}")
    known = control.signals()

    def net(name: str, source: str, *sinks: str) -> None:
        lines.append(f"net {known.get(source, name)} {source} => {' '.join(sinks)}")

    for low in (a.lower() for a in control.letters if a in chain.axes):
        net(f"corrector-at-{low}", f"axis.{low}.pos-cmd", f"corrector.position-{low}")
    for low in map(str.lower, linear):
        lines.append(f"setp axis.{low}.eoffset-scale {_scale():g}")
        net(f"corrector-counts-{low}", f"corrector.counts-{low}", f"axis.{low}.eoffset-counts")
        net(f"corrector-has-{low}", f"axis.{low}.eoffset-request", f"corrector.requested-{low}")
    net(
        "corrector-enable",
        "corrector.enable",
        *(f"axis.{a.lower()}.eoffset-enable" for a in linear),
    )
    net("corrector-on", "motion.motion-enabled", "corrector.machine-on")
    net("corrector-homed", "motion.is-all-homed", "corrector.homed")
    lines += [f"setp corrector.temperature-{n} {v:g}" for n, v in state.temperature.items()]
    if state.spindle_rpm is not None:
        lines.append(f"setp corrector.spindle-rpm {state.spindle_rpm:g}")
    return "\n".join(lines) + "\n"


def _scale() -> float:
    """One count, mm, as the component has it."""
    found = re.search(r"(?m)^SCALE = (\S+)$", (BESIDE / "corrector.py").read_text("utf-8"))
    assert found is not None
    return float(found[1])
