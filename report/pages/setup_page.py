"""The set-up sheet: what an operator needs beside the programs, on two pages of paper."""

from collections.abc import Sequence
from pathlib import Path

from matstd.probe_paths.campaign import setup_tolerance
from matstd.probe_paths.language import LANGUAGES, Label, Q, interlocks
from matstd.probe_paths.locate import Companions
from matstd.probe_paths.plan import SMALLEST_GAP, Heading, ProgramFrame, calibration_hash
from matstd.probe_paths.stations import Station
from matstd.report.pages.page import write_page
from matstd.report.plots import write_setup_picture
from matstd.report.scenes import PLAYBACK, write_playback
from matstd.twin.frames import fixed_xyz_angles
from matstd.twin.units import DEG, MINUTE

PAGE, PICTURE = "setup.html", "setup.png"
"""Names in the folder of the sheet."""

_REMEDY = {
    Label.OTHER_PROBE: "number and length of the probe in the tool table, to the ball's far pole",
    Label.RADIUS: "calibration of the probe; another stylus",
    Label.ROTATION: "column ROT of the preset's row",
    Label.TOP: "software limit of Z against the machine file",
    Label.PRESET_X: "X of the preset's row: the centre of the table",
    Label.PRESET_Y: "Y of the preset's row: the centre of the table",
    Label.PRESET_Z: "Z of the preset's row: the face of the table",
    Label.ZERO_1: "the rotary axis in the preset's row",
    Label.ZERO_2: "the rotary axis in the preset's row",
}


def write_setup_page(
    folder: Path,
    stations: Sequence[Station],
    number: int,
    others: Companions,
) -> Path:
    """Write the sheet of a station with its drawing and playback; the path of the page.

    Args:
        folder: To be made.
        stations: Of the campaign, in their order.
        number: Of the station, from 0.
        others: Programs that are run before its own.
    """
    station = stations[number]
    plan, programs, dialect = station.plan, station.programs, station.dialect
    page, picture, playback = (_named(name, station, number) for name in (PAGE, PICTURE, PLAYBACK))
    folder.mkdir(parents=True, exist_ok=True)
    write_setup_picture(folder / picture, plan)
    write_playback(folder / playback, plan, programs, dialect)
    T = plan.setup.T_table_artefact
    tests = interlocks(LANGUAGES[dialect.language], ProgramFrame(plan.chain, plan.probe))
    heading = Heading(
        standard=plan.standard.name,
        setup=plan.setup,
        probe=plan.probe,
        workshop=plan.options.workshop,
    )
    tolerance = setup_tolerance(plan)
    write_page(
        folder / page,
        "setup.html",
        picture_file=folder / picture,
        standard=plan.standard,
        chain=plan.chain,
        probe=plan.probe,
        workshop=plan.options.workshop,
        dialect=dialect,
        origin=T[:3, 3].tolist(),
        angles=(fixed_xyz_angles(T[:3, :3]) / DEG).tolist(),
        calibration=calibration_hash(plan.standard),
        workshop_hash=heading.workshop_hash,
        programs=[(p.name, p.touches, p.duration / MINUTE) for p in programs.programs],
        minutes=programs.duration / MINUTE,
        visits=len(plan.visits),
        refused=[str(refusal) for refusal in plan.refused],
        alarms=[(int(t.label), t.what, f"{t.limit:g}", _REMEDY[t.label]) for t in tests],
        others=others,
        playback=playback,
        stations=stations,
        here=station,
        sheets=[_named(PAGE, one, i) for i, one in enumerate(stations)],
        within_deg=round(others.spread.angle / DEG, 3),
        start=int(Q.START),
        missed=int(Label.NO_CONTACT),
        tolerance=tolerance,
        clearance=SMALLEST_GAP,
    )
    return folder / page


def _named(file: str, station: Station, number: int) -> str:
    """Name of a file of a station; those after the first are told by set-up and tool."""
    stem, _, ending = file.rpartition(".")
    return file if number == 0 else f"{stem}_{station.setup}_T{station.dialect.tool}.{ending}"
