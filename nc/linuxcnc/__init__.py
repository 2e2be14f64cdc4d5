"""Files of LinuxCNC: its INI file read, HAL files read and written, variables and tools written."""

from matstd.nc.linuxcnc.hal import net
from matstd.nc.linuxcnc.ini import Ini
from matstd.nc.linuxcnc.tables import tool_table, variables

__all__ = ["Ini", "net", "tool_table", "variables"]
