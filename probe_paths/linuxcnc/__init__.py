"""Emitted programs on a LinuxCNC that is installed here, without a screen: the twin is its machine.

In: programs for LinuxCNC and a `VirtualMachine`. Out: the log that the control itself wrote
(`Session`). `machine_files` makes a machine of five independent axes; the scripts in `beside` run
in the Python of the system, as user interface and as component of the hardware layer; the exact
twin (`TwinContact`) is asked over a socket where every stroke will meet the surface.
"""

from probe_paths.linuxcnc.latch import PERIOD, latch_error, latch_u
from probe_paths.linuxcnc.machine_files import machine_files
from probe_paths.linuxcnc.session import Session, installed, machine_folder, run_on_linuxcnc
from probe_paths.linuxcnc.shortened import shortened
from probe_paths.linuxcnc.twin_contact import Stroke, TwinContact

__all__ = [
    "PERIOD",
    "Session",
    "Stroke",
    "TwinContact",
    "installed",
    "latch_error",
    "latch_u",
    "machine_files",
    "machine_folder",
    "run_on_linuxcnc",
    "shortened",
]
