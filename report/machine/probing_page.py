"""Playback of probing programs: the machine, the standard on it, every touch with what it finds."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.compensation.field import MachineErrors
from matstd.probe_paths.control import interpret
from matstd.probe_paths.emit import ProgramSet
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import ToolClearance, TouchPlan
from matstd.report.machine.error_series import ErrorFunction, error_functions
from matstd.report.machine.machine_page import machine_html
from matstd.report.machine.machine_words import ShownMachine
from matstd.report.machine.played import played_probing
from matstd.report.machine.set_up import set_up_bodies, with_clearance
from matstd.twin.files import write_whole

PLAYBACK = "playback.html"  # name of the page

TRIED = "the machine of errors.toml, on which the programs were tried first"


def write_playback(
    page: Path,
    plan: TouchPlan,
    programs: ProgramSet,
    dialect: Dialect,
    errors: MachineErrors | None = None,
) -> None:
    """Write the page; the text of programs is read again, and nothing else is played."""
    chain = plan.chain
    read = [
        interpret(
            p.text.encode("ascii"), Path(p.file), programs.masks.get, chain, plan.probe, dialect
        )
        for p in programs.programs
    ]
    room = (plan.standard, plan.setup, plan.probe, plan.options.workshop)
    stands = ToolClearance(chain, *room)
    played = played_probing(chain, read, [p.text for p in programs.programs], plan.options.standoff)
    duration = float(played.time[-1])
    found: Sequence[ErrorFunction] = ()
    if errors is not None:
        found = error_functions(errors, plan.probe.length, duration)
    shown = ShownMachine(
        chain=chain,
        length=plan.probe.length,
        duration=duration,
        errors=found,
        source=TRIED if errors is not None else "",
        bodies=set_up_bodies(stands),
        replaced=("t",),
        program=with_clearance(played, stands),
        datum=(np.zeros(len(chain.axes)), plan.probe.length),
    )
    write_whole(page, machine_html(shown))
