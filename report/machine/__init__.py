"""A machine that moves on a page: its bodies, its errors, a program that is played.

In: a chain, errors of a machine, a program that was read. Out: one HTML file. Bodies are plain
solids by rule from the chain, or the user's meshes; errors go into the page as functions of the
readings, and the page multiplies the exact kinematics itself (`live/parts/kinematics.js`).
"""

from matstd.report.machine.error_series import error_functions as error_functions
from matstd.report.machine.head_section import head_sections as head_sections
from matstd.report.machine.machine_page import machine_data as machine_data
from matstd.report.machine.machine_page import machine_html as machine_html
from matstd.report.machine.machine_words import ShownMachine as ShownMachine
from matstd.report.machine.machine_words import shown_lines as shown_lines
from matstd.report.machine.meshes import body_meshes as body_meshes
from matstd.report.machine.meshes import drawing_triangles as drawing_triangles
from matstd.report.machine.meshes import thinned as thinned
from matstd.report.machine.played import Played as Played
from matstd.report.machine.played import played_part as played_part
from matstd.report.machine.played import played_probing as played_probing
from matstd.report.machine.probing_page import PLAYBACK as PLAYBACK
from matstd.report.machine.probing_page import write_playback as write_playback
from matstd.report.machine.set_up import probe_body as probe_body
from matstd.report.machine.set_up import set_up_bodies as set_up_bodies
from matstd.report.machine.set_up import standard_bodies as standard_bodies
from matstd.report.machine.set_up import with_clearance as with_clearance
from matstd.report.machine.solids import Drawn as Drawn
from matstd.report.machine.swivel import swivel_remarks as swivel_remarks
