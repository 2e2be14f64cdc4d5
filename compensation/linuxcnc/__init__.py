"""Corrections on LinuxCNC: the service, asked by a component of the control's hardware layer.

In: a `Service`, and the control's INI file (`Control`). Out: a HAL file and the component beside it
(`write_control_files`), and answers on a socket (`serve_linuxcnc`). The component gives them to the
control as external offsets, which are added before kinematics.
"""

from matstd.compensation.linuxcnc.control_files import HAL_FILE as HAL_FILE
from matstd.compensation.linuxcnc.control_files import SOCKET as SOCKET
from matstd.compensation.linuxcnc.control_files import Control as Control
from matstd.compensation.linuxcnc.control_files import write_control_files as write_control_files
from matstd.compensation.linuxcnc.link import serve_linuxcnc as serve_linuxcnc
