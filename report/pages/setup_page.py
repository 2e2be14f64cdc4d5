"""The set-up sheet: what an operator needs beside the programs, on two pages of paper."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.artefact.reach import standing_remarks, table_face
from matstd.compensation.field import MachineErrors
from matstd.probe_paths.campaign import setup_tolerance
from matstd.probe_paths.language import LANGUAGES, Dialect, Label, Q, interlocks, turn_tests
from matstd.probe_paths.locate import Companions
from matstd.probe_paths.plan import SMALLEST_GAP, Heading, TouchPlan, calibration_hash
from matstd.probe_paths.stations import Station
from matstd.report.layout import Page, Picture, Section, Table, write_page
from matstd.report.machine import PLAYBACK, head_sections, swivel_remarks, write_playback
from matstd.report.numbers import plural
from matstd.report.plots import draw_setup
from matstd.twin.frames import fixed_xyz_angles
from matstd.twin.units import DEG, MINUTE

PAGE, PICTURE = "setup.html", "setup.png"  # names in the folder of the sheet

_REMEDY = {
    Label.OTHER_PROBE: "number and length of the probe in the tool table, to the ball's far pole",
    Label.CYCLES: "status display: end the rotation, mirror image or scaling by its own cycle",
    Label.RADIUS: "calibration of the probe; another stylus",
    Label.ROTATION: "column ROT of the preset's row",
    Label.TOP: "software limit of Z against the machine file",
    Label.TURNED: "`WRAPPED_ROTARY` of the axis in the INI file: 0",
    Label.TOOL_OFFSET: "X and Y of the probe in the tool table: zero",
    Label.ZERO_1: "the rotary axis in the preset's row",
    Label.ZERO_2: "the rotary axis in the preset's row",
}
_REMEDY_GCODE = {
    Label.RADIUS: "diameter of the ball in the tool table; another stylus",
    Label.ROTATION: "rotation of the preset (`G10 L2 R`): zero",
    Label.ZERO_1: "offset of the rotary axis in the preset: zero",
    Label.ZERO_2: "offset of the rotary axis in the preset: zero",
}
"""Where LinuxCNC keeps what iTNC has in columns of tables."""
_NOSE = {
    True: ", as stated in the project",
    False: ", assumed; measure yours and state `nose_diameter_mm`",
    None: "",
}
"""By what the diameter of the nose is known; of programs alone it is not."""
_PRESETS = (Label.PRESET_X, Label.PRESET_Y, Label.PRESET_Z)
_CAMPAIGN = (
    "Stations in their order; all logs are evaluated together. Between set-ups the standard is "
    "clamped anew; every line has its own sheet"
)
_PLACE = "Pose of the standard in the table frame (origin: table centre{zero})"
_TOLERANCE = (
    "Admissible offset of the standard from this pose, in either direction, one at a time: the "
    f"programs keep a clearance of {SMALLEST_GAP:g} mm (of a rotation: at the farthest point of "
    "the standard), or less where a touch would be lost, tested on the twin with 60 touches"
)
_BEYOND = (
    "A standard with a larger offset may be hit, and no alarm tests where it stands: align it "
    "better, or state its actual pose in the project."
)
_SEARCH = "Where the standard may stand elsewhere, a search program finds its place."
_NO_SEARCH = "No program finds the place of the standard: align it within the offsets stated here."
_ALARMS = (
    "A program that stops shows {shown}. Before number {missed} can occur, nothing has been touched"
)
_LABEL_SHOWN = "the label at which it stopped"
_SUBPROGRAM_SHOWN = "1014 (no contact) or 1011, and the subprogram `O` of the alarm in its listing"
_LOAD = (
    "Load programs and masks. The control must not mark any block as an error: where it does, "
    "write the programs with the words of its software (`--control`, a dialect)."
)
_LOAD_GCODE = (
    "Prepare LinuxCNC: probe at `motion.probe-input`, seconds of the day at `motion.analog-in-00`, "
    "the date (20310506) at `motion.analog-in-01`, `[AXIS_Z] MAX_LIMIT` in the INI file, and "
    "`[RS274NGC] INI_VARS` not 0. Load the programs. Logs appear in the folder in which LinuxCNC "
    "was started."
)
_COMMON_STEPS = (
    "First run in single block with the override low. While the probe moves to its first touch, "
    "deflect the stylus with a plastic rod, never by hand: it must stop and retract at once. Start "
    "the program again afterwards.",
    "Compare the place of the first touch with the drawing before you continue.",
)


def write_setup_page(
    folder: Path,
    stations: Sequence[Station],
    number: int,
    others: Companions,
    errors: MachineErrors | None = None,
    conditions: Sequence[str] = (),
) -> Path:
    """Write the sheet of a station with its drawing and playback; returns the path of the page.

    Args:
        folder: Created if it does not exist.
        stations: Of the campaign, in their order.
        number: Of the station, from 0.
        others: Programs that are run before its own.
        errors: Of the machine that the playback shows; None for none.
        conditions: Sentences on the state of the machine in which the programs are to run.
    """
    station = stations[number]
    plan, programs, dialect = station.plan, station.programs, station.dialect
    page, picture, playback = (_named(name, station, number) for name in (PAGE, PICTURE, PLAYBACK))
    folder.mkdir(parents=True, exist_ok=True)
    write_playback(folder / playback, plan, programs, dialect, errors)
    standard, many = plan.standard, len(stations) > 1
    serial = f", serial {standard.serial}" if standard.serial else ""
    which = f", set-up {station.setup} with tool {dialect.tool}" if many else ""
    workshop = Heading(
        standard=standard.name, setup=plan.setup, probe=plan.probe, workshop=plan.options.workshop
    ).workshop_hash
    has_bodies = len(plan.options.workshop.solids) > 1  # beside the table
    red = "Red: clamps and fixtures that the programs avoid. " if has_bodies else ""
    drawing = (
        f"Blue: the standard and its spheres, with its own x and y. {red}"
        "The programs do not know any object that is not drawn here."
    )
    content = Page(
        heading=f"Set-up sheet: {standard.name}{serial} on {plan.chain.name}{which}",
        lead=(
            f"{plural(len(programs.programs), 'program')}, {plural(len(plan.visits), 'visit')}"
            f"{' of table poses' * bool(plan.chain.rotary_axes)}, about "
            f"{programs.duration / MINUTE:.0f} min. Machine "
            f"`{plan.chain.arrangement}`, calibration `{calibration_hash(standard)}`, workshop "
            f"`{workshop}`, as in the head of every program and log."
        ),
        means="The programs move as drawn only if standard, probe and preset stand as stated here. "
        + (_NO_SEARCH if others.search is None else _SEARCH),
        next="Work through the steps in their order, single block and feed low at first. Stop at "
        "any difference from what is stated here.",
        key=(),
        sections=[
            Section(pictures=[Picture(picture, drawing, draw_setup(plan))]),
            *([_campaign(stations, number)] if many else []),
            *_mount(plan),
            *head_sections(plan),
            *_probe(station),
            *_run(station, others, playback, conditions),
            _alarms(plan, station),
            *([Section("Omitted touches", items=_omitted(plan))] if plan.refused else []),
        ],
        foot=["Limits in mm; those of angles in degrees."],
    )  # fmt: skip
    return write_page(folder / page, content)


def _omitted(plan: TouchPlan) -> list[str]:
    """Touches that cannot be made, those of one place and reason in one line."""
    counts = Counter(map(str, plan.refused))
    return [f"{plural(count, 'touch')} on {words}" for words, count in counts.items()]


def _campaign(stations: Sequence[Station], number: int) -> Section:
    """All stations, with their sheets."""
    rows = []
    for k, one in enumerate(stations):
        sheet, programs = _named(PAGE, one, k), one.programs.programs
        rows.append(
            [
                str(one.setup),
                str(one.dialect.tool),
                " ".join(f"`{p.name}`" for p in programs),
                str(sum(p.touches for p in programs)),
                f"{one.programs.duration / MINUTE:.0f}",
                "this one" if k == number else f"[{sheet}]({sheet})",
            ]
        )
    columns = ("set-up", "tool", "programs", "touches", "about, in min", "sheet")
    return Section("Campaign", table=Table(columns, rows, _CAMPAIGN))


def _mount(plan: TouchPlan) -> list[Section]:
    """Where the standard stands, how exactly, and what holds it."""
    T, tolerance = plan.setup.T_table_artefact, setup_tolerance(plan)
    angles = fixed_xyz_angles(T[:3, :3]) / DEG
    bodies = [body.name for body in plan.options.workshop.bodies]
    held = f"{', '.join(bodies)} as drawn" if bodies else "no clamp is stated; use the base screws"
    columns = [f"{a} in mm" for a in "xyz"] + [f"about {a} in °" for a in "xyz"]
    place = [*(f"{v + 0.0:.3f}" for v in T[:3, 3]), *(f"{v + 0.0:.4f}" for v in angles)]
    units = dict(zip("XYZABC", (1.0,) * 3 + (DEG,) * 3, strict=True))
    limits = [f"{tolerance[letter].offset / unit:.3g}" for letter, unit in units.items()]
    reasons = ["clearance" if one.is_clearance else "lost touch" for one in tolerance.values()]
    free = " Rotary axes must be free to turn with Z retracted." * bool(plan.chain.rotary_axes)
    zero = _zero(plan)
    return [
        Section("Mount", table=Table(columns, [place], _PLACE.format(zero=zero))),
        Section(
            table=Table(
                ["", *columns], [["at most ±", *limits], ["limited by", *reasons]], _TOLERANCE
            ),
            notes=[f"Clamp from outside the faces and spheres: {held}.{free}"],
            warnings=[_BEYOND, *standing_remarks(plan.chain, T), *swivel_remarks(plan.chain)],
        ),
    ]


def _zero(plan: TouchPlan) -> str:
    """Where the rotary axes stand when the table frame holds, if there are any."""
    return ", rotary axes at zero" if plan.chain.rotary_axes else ""


def _probe(station: Station) -> list[Section]:
    """Entries of tool table and preset, dimensions of the probe."""
    probe, dialect = station.plan.probe, station.dialect
    rows = [
        ["tool", f"T{dialect.tool}, no spindle speed; the programs stop the spindle"],
        [
            "length in the tool table, to the far pole of the ball, in mm",
            f"{probe.tool_length:.4f}",
        ],
        ["radius of the ball in mm", f"{probe.radius:.4f}"],
        ["preset", f"{_preset(dialect)}: table centre{_zero(station.plan)}, no basic rotation"],
    ]
    angle = (
        "0°, by every program (`M19`); calibrate the probe at the same angle"
        if dialect.is_oriented
        else "as at the calibration; the programs leave it (`is_oriented` of a dialect sets it). "
        "Look at the mark on the probe after every tool call: a stylus that runs out shifts all "
        "touches of a program"
    )
    rows.append(["orientation of the spindle", angle])
    if dialect.folder:
        rows.append(["folder of programs, masks and logs", f"`{dialect.folder}`"])
    cylinders = [[f"{end:.1f}", f"{2.0 * radius:.1f}"] for end, radius in probe.stack]
    nose = f"nose of the spindle{_NOSE[probe.nose_is_stated]}"
    cylinders.append([nose, f"{2.0 * probe.nose_radius:.1f}"])
    caption = "Cylinders of the probe from the centre of the ball upwards; measure yours"
    return [
        Section("Probe and control", table=Table(("what", "value"), rows)),
        Section(table=Table(("up to, in mm", "diameter in mm"), cylinders, caption)),
    ]


def _is_gcode(dialect: Dialect) -> bool:
    return dialect.language == "gcode"


def _preset(dialect: Dialect) -> str:
    """The preset as the control names it."""
    return f"G{53 + dialect.preset}" if _is_gcode(dialect) else f"row {dialect.preset}"


def _run(
    station: Station, others: Companions, playback: str, conditions: Sequence[str]
) -> list[Section]:
    """The programs, and the steps from loading to the logs."""
    rows = [
        [f"`{p.name}`", str(p.touches), f"{p.duration / MINUTE:.0f}"]
        for p in station.programs.programs
    ]
    shown = (
        f"[{playback}]({playback}), beside this sheet, plays the programs on the machine: every "
        "motion with its line, readings, touch, clearance and the deviation that it finds."
    )
    return [
        Section(
            "Run",
            notes=[" ".join(conditions)] if conditions else [],
            table=Table(("program", "touches", "about, in min"), rows),
        ),
        Section(sentences=[shown], items=_steps(others, station.dialect), is_ordered=True),
    ]


def _steps(others: Companions, dialect: Dialect) -> list[str]:
    dry = others.dry_run.programs[0]
    visit = LANGUAGES[dialect.language].parameter(Q.START)
    return [
        _LOAD_GCODE if _is_gcode(dialect) else _LOAD,
        "Calibrate the probe; clean standard and ball.",
        _search_step(others),
        *_first_steps(others, dialect),
        f"Run `{dry.name}` from the folder of this sheet: all motions of the programs, up to "
        f"{others.raised:g} mm higher and without a touch, {dry.duration / MINUTE:.0f} min.",
        _ball_step(others),
        *_COMMON_STEPS,
        f"Keep the log of every program, including one that stopped. Restart that program at the "
        f"visit in which it stopped: `{visit}` in its head is the number of that visit "
        "(the program still turns to the visits before it, without a touch). Give all its logs to "
        "`matstd evaluate`.",
    ]


def _search_step(others: Companions) -> str:
    if others.search is None:
        return f"There is no search program for a standard in another pose: {others.no_search}."
    search = others.search.programs[0]
    return (
        f"If the standard stands within {others.spread.distance:g} mm and "
        f"{round(others.spread.angle / DEG, 3):g}° of its pose, but not within the offsets above: "
        f"run `{search.name}` from the folder of this sheet (at most "
        f"{search.duration / MINUTE + 0.5:.0f} min), then `matstd replan` with its log. It writes "
        "these programs for the actual pose of the standard."
    )


def _first_steps(others: Companions, dialect: Dialect) -> list[str]:
    """The commissioning program, where the control may need it."""
    if others.first is None:
        missing = f"There is no commissioning program to try the control with: {others.no_first}."
        return [missing] if others.no_first else []
    first = others.first.programs[0]
    stop, missed = "label 93", "`FN 14: ERROR= 1014`"
    if _is_gcode(dialect):
        stop, missed = "subprogram `O93`", "message 1014"
    return [
        f"On a control that has not run these programs before: first run `{first.name}` from the "
        "folder of this sheet, with the standard in its pose, in single block with the override "
        f"low. It has {first.blocks} blocks with every word that the other programs use: one touch "
        "in the air, after which it must continue, and one on a ball. From its log, "
        f"`matstd evaluate` determines which Z the control returns. If it stops at {stop}, "
        "upper end of Z, length of the tool, basic rotation or preset differ from those below, or "
        f"a cycle of an earlier job is active; at {missed} the control returns another touch "
        "status than the programs expect."
    ]


def _ball_step(others: Companions) -> str:
    if others.ball is None:
        return f"There is no ball to compare the probe before and after: {others.no_ball}."
    ball = others.ball.programs[0]
    return (
        f"Run `{ball.name}` from the folder of this sheet before the first program, again after "
        f"the last one, and whenever you stop for longer: {ball.touches} touches on one ball, "
        f"{ball.duration / MINUTE + 0.5:.0f} min. From its logs, `matstd evaluate` reports how far "
        "the ball has moved and whether the probe has changed, and rejects measurements between "
        "which the probe has changed."
    )


def _alarms(plan: TouchPlan, station: Station) -> Section:
    """What every alarm tests, and what to check."""
    missed = int(Label.NO_CONTACT)
    language = LANGUAGES[station.dialect.language]
    tests = [*interlocks(language, plan.frame), *turn_tests(language, plan.frame)]
    lost = "a touch met nothing; Z is up, the log contains all touches so far"
    rows = [[str(missed), lost, "", "pose of the standard; is the probe switched on?"]]
    is_gcode = _is_gcode(station.dialect)
    remedies = _REMEDY | (_REMEDY_GCODE if is_gcode else {}) | _of_presets(plan, station.dialect)
    shown = _SUBPROGRAM_SHOWN if is_gcode else _LABEL_SHOWN
    for label in dict.fromkeys(test.label for test in tests):
        own = [test for test in tests if test.label == label]
        what = "; ".join(dict.fromkeys(test.what for test in own))
        limits = "; ".join(dict.fromkeys(f"{test.limit:g}" for test in own))
        rows.append([str(int(label)), what, limits, remedies[label]])
    columns = ("alarm", "test", "tolerance", "check")
    return Section("Alarms", table=Table(columns, rows, _ALARMS.format(missed=missed, shown=shown)))


def _of_presets(plan: TouchPlan, dialect: Dialect) -> dict[Label, str]:
    """What to check of the preset: the face in the direction in which it looks, else the centre."""
    out_of_face = np.abs(table_face(plan.setup.T_table_artefact)[:3, 2]) > 0.5
    where = _preset(dialect) if _is_gcode(dialect) else "the preset's row"
    return {
        label: f"{letter} of {where}: the {'face' if is_face else 'centre'} of the table"
        for label, letter, is_face in zip(_PRESETS, "XYZ", out_of_face, strict=True)
    }


def _named(file: str, station: Station, number: int) -> str:
    """Name of a file of a station; after the first they bear set-up and tool."""
    stem, _, ending = file.rpartition(".")
    return file if number == 0 else f"{stem}_{station.setup}_T{station.dialect.tool}.{ending}"
