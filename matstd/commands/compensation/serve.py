"""`matstd serve`: corrections while the machine moves, over OPC UA or on LinuxCNC."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.compensation.options import MODEL, STATE
from matstd.console import say
from matstd.next_steps import next_line
from matstd.options import Options
from matstd.twin.units import NM, UM
from matstd.twin.words import listed

if TYPE_CHECKING:
    from matstd.api.compensating import Compensation
    from matstd.compensation.service import OutputLimits, Service


OPTIONS: Options = {
    **MODEL,
    "--endpoint=opc.tcp://localhost:4840 URL": "address of the OPC UA server "
    "(opc.tcp://localhost:4840: reachable from this computer only)",
    "--linuxcnc MACHINE.ini": "correct this LinuxCNC on this computer by external offsets, instead "
    "of OPC UA",
    "--most=200.0 UM": "largest correction of an axis, µm (200)",
    "--rate=1000.0 UM_S": "largest rate of change of a correction, µm/s (1000)",
    "--patience=0.5 S": "time without readings until a correction is marked invalid, s (0.5)",
    "--hold=5.0 S": "time without readings until a correction returns to zero, s (5)",
    **STATE,
}


def run(args: argparse.Namespace) -> int:
    """Answer until it is stopped."""
    import asyncio
    import logging

    from matstd.commands.compensation.job import read_job
    from matstd.compensation.service import OutputLimits, serve

    limits = OutputLimits(args.most * UM, args.rate * UM, args.patience, args.hold)
    machine = read_job(args)
    if args.linuxcnc:
        return _on_linuxcnc(args, machine, limits)
    service = machine.service(limits)
    logging.getLogger("asyncua").setLevel(logging.CRITICAL)

    def ready() -> None:
        say(f"{args.endpoint}: {_corrected(service)}; Ctrl-C stops it")
        say(next_line(args))

    asyncio.run(serve(service, args.endpoint, ready))
    return 0


def _on_linuxcnc(args: argparse.Namespace, machine: Compensation, limits: OutputLimits) -> int:
    """Write the files of the control, answer its component until it is stopped."""
    import asyncio

    from matstd.compensation.linuxcnc import (
        HAL_FILE,
        SOCKET,
        Control,
        serve_linuxcnc,
        write_control_files,
    )

    ini = args.linuxcnc
    control = Control(Path(ini))
    control.check(machine.errors.chain)
    service = machine.service(limits)
    written = write_control_files(control, service, limits)
    say(f"{', '.join(map(str, written))}: for the control")
    if not control.reads_ours:
        say(f"{ini}: add HALFILE = {HAL_FILE} below the others in [HAL]", style="bold")

    def ready() -> None:
        say(f"{ini}: {_corrected(service)}; start LinuxCNC now or later; Ctrl-C stops it")
        say(next_line(args))

    asyncio.run(serve_linuxcnc(service, Path(ini).parent / SOCKET, ready))
    return 0


def _corrected(service: Service) -> str:
    correction, sensors = service.correction, service.sensors
    follows = f", following {listed(list(sensors))}" if sensors else ""
    return (
        f"corrects {listed(list(correction.linear_axes))}{follows}; tables leave at most "
        f"{correction.interpolation / NM:.1f} nm"
    )
