"""A machine that moves on a page: its bodies, its errors, a program that is played.

In: a chain, errors of a machine, a program that was read. Out: one HTML file. Bodies are plain
solids by rule from the chain, or the user's meshes; errors go into the page as functions of the
readings, and the page multiplies the exact kinematics itself (`live/parts/kinematics.js`).
"""

from matstd.report.machine.error_series import error_functions
from matstd.report.machine.machine_page import machine_data, machine_html
from matstd.report.machine.machine_words import ShownMachine, shown_lines
from matstd.report.machine.meshes import body_meshes, drawing_triangles, thinned
from matstd.report.machine.played import Played, played_part, played_probing
from matstd.report.machine.probing_page import PLAYBACK, write_playback
from matstd.report.machine.set_up import (
    probe_body,
    set_up_bodies,
    standard_bodies,
    with_clearance,
)
from matstd.report.machine.solids import Drawn

__all__ = [
    "PLAYBACK",
    "Drawn",
    "Played",
    "ShownMachine",
    "body_meshes",
    "drawing_triangles",
    "error_functions",
    "machine_data",
    "machine_html",
    "played_part",
    "played_probing",
    "probe_body",
    "set_up_bodies",
    "shown_lines",
    "standard_bodies",
    "thinned",
    "with_clearance",
    "write_playback",
]
