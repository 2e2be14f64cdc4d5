"""Emitted programs on a LinuxCNC that is installed here, without a screen: the twin is its machine.

In: programs of a design and a `VirtualMachine`. Out: what the control itself logged, evaluated
(`rehearse`). `machine_files` makes a machine of independent axes; the scripts in `beside` run in
the Python of the system, as user interface and as component of the hardware layer; the exact twin
(`TwinContact`) is asked over a socket where every stroke will meet the surface.
"""

from matstd.probe_paths.linuxcnc.rehearsal import rehearse as rehearse
from matstd.probe_paths.linuxcnc.rehearsal import shortened as shortened
from matstd.probe_paths.linuxcnc.session import installed as installed
