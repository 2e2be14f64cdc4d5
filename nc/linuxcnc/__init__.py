"""Files of LinuxCNC: its INI file read, HAL files read and written, variables and tools written."""

from matstd.nc.linuxcnc.files import Ini, net, tool_table, variables

__all__ = ["Ini", "net", "tool_table", "variables"]
