"""The page of a design run: pictures, figures and tables of everything that was made."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from matstd.artefact.place import Placement
from matstd.artefact.reach import standing_remarks
from matstd.artefact.worth import TouchCurve, touch_curve
from matstd.cad_out.meshes import read_stl
from matstd.diagnosis.task import guarded
from matstd.report.design_view import DesignScene, design_live, error_field
from matstd.report.layout import KeyFigure, LiveView, Page, Picture, Section, Table, write_page
from matstd.report.numbers import digits, percent, plural, um
from matstd.report.pages.design_result import Design
from matstd.report.pages.identifiability_section import identifiability_sections
from matstd.report.pages.proof_sections import proof_sections, task_sections, worst_machine
from matstd.report.pages.standard_sections import (
    at_most,
    cad_sections,
    comparison_table,
    criterion_words,
    making_sections,
    patch_table,
)
from matstd.report.pages.study_page import (
    Shown,
    draw_study_volumes,
    parameters_words,
    study_sections,
)
from matstd.report.plots import draw_order, draw_touch_curves, draw_touches
from matstd.report.scenes import draw_standard
from matstd.report.task import FILES
from matstd.report.words import (
    best_rival,
    comparison_remarks,
    features_words,
    identification_lines,
    shown_line,
    verdict_of_design,
)
from matstd.twin.errors import DesignError
from matstd.twin.units import UM
from matstd.twin.words import listed

_STEP_FACE = "largest deviation of a STEP face from its design"

MAPS = "sensitivity"  # folder of the maps

GREEN, YELLOW = 0.8, 0.5
"""Shares of a tolerance in which conformity can be proved from which it is green and yellow. Green:
the uncertainty takes a tenth of the zone at each end."""

_CURVES = (
    "Remaining error against the number of touches, predicted for every artefact by one rule: its "
    "touches in the order in which each helps most, repeated beyond their number. Marked: the "
    "{count} identifying touches of the table above. The curves are the standard deviation that "
    "the touches leave to machines of the stated error ranges, without random draws."
)
_SHARES = (
    "An effect counts as visible when 30 % of its signature remain beside the geometric model; the "
    "total are the effects that unrestricted touches could show."
)
_NEXT = (
    "Send `{file}`, `drawing.pdf` and `making.json` to the workshop, have the piece "
    "calibrated (`matstd calibrate`), then follow `setup/setup.html` on the machine."
)
_CHECKED = (
    "The programs were read back as text and checked block by block, and exactly that text was run "
    "on the twin. They have not been run on a machine or a programming station: follow the steps "
    "of docs/controls.md before the first run."
)
_LIMITS = (
    "The proof covers rigid-body geometry only; `matstd diagnose` searches a real run for other "
    "effects.",
    "The simulated machines probe a standard exactly as designed. The uncertainty of its "
    "calibration is included in the predicted errors here and after other artefacts, and in the "
    "uncertainty of the measuring task.",
    "Travels, pivots and table size are taken from the machine file.",
)


def write_design_page(design: Design, folder: Path) -> list[str]:
    """Draw the pictures and write report.html.

    Returns:
        What could not be drawn and why, one line each; the page states it too.
    """
    remarks = comparison_remarks(design.placement)
    with ThreadPoolExecutor(1) as beside:  # pictures are rendered in processes of their own
        drawn = beside.submit(_renderings, design, folder, remarks)
        curves, live = _curves(design.placement), _live(design)
        standard, volumes = drawn.result()
    chain, placement = design.brief.chain, design.placement
    body, verdict = placement.standard, verdict_of_design(placement, design.brief.ranges)
    page = Page(
        heading=f"{body.name}: material standard for {chain.name}",
        lead=f"{shown_line(placement)} {verdict}".lstrip(),
        means=_meaning(design),
        next=_NEXT.format(file=FILES[design.making.make]),
        key=_key(design),
        sections=[
            replace(_opening(design, folder, remarks), pictures=standard),
            *_comparison(design, curves),
            *proof_sections(design),
            *task_sections(design),
            *_probing(design),
            Section("The standard", table=patch_table(design)),
            *making_sections(design.making),
            *cad_sections(design.conformity),
            *identifiability_sections(design),
            *study_sections(
                design.study,
                [*design.maps, *volumes],
                f"{MAPS}/",
                "Where the errors show",
                "volumetric_sections.png",
            ),
            Section("Limits of this design", items=_LIMITS),
        ],
        foot=[
            f"Project `{design.brief.path.name}`, seed {design.brief.seed}. Deviations are "
            "tool side minus workpiece side; uncertainties are standard uncertainties (k = 1)."
        ],
        live=live,
    )
    write_page(folder / "report.html", page)
    return remarks


def _renderings(
    design: Design, folder: Path, remarks: list[str]
) -> tuple[list[Picture], list[Shown]]:
    """The standard, and the maps in three dimensions; without OpenGL remarks instead."""
    mesh, file, standard = read_stl(folder / "standard.stl"), "standard.png", list[Picture]()
    try:
        draw_standard(design.placement.standard, mesh, folder / file)
        caption = "The standard from two sides: features with their names, datum plane."
        standard.append(Picture(file, caption))
    except DesignError as error:
        remarks.append(f"No pictures of the standard: {error}")
    stands = design.brief.setup.T_table_artefact
    return standard, draw_study_volumes(design.study, folder / MAPS, remarks, mesh, stands)


def _live(design: Design) -> LiveView:
    """What moves on the page, with the errors of the first simulated machine."""
    first = design.machines[0]
    believed = first.campaign.run.touches.setups[0]
    return design_live(
        DesignScene(
            brief=design.brief,
            placement=design.placement,
            plan=design.plan,
            minutes=design.times.minutes,
            field=error_field(design.brief, believed, first.errors, first.fit),
        )
    )


def _key(design: Design) -> list[KeyFigure]:
    own, rival = design.placement.own, best_rival(design.placement)
    touches, machines = len(design.placement.requests), design.machines
    worst = worst_machine(machines)
    user, tolerance = worst.in_workspace, design.brief.task.tolerance
    others = f"; the worst of {len(machines)} machines" if len(machines) > 1 else ""
    best = (
        [KeyFigure(um(rival.rms_user), f"the same with the best other artefact: {rival.name}")]
        if rival is not None
        else []
    )
    return [
        KeyFigure(
            um(own.rms_user),
            f"remaining uncertainty of the tool point in your workspace, rms, after the {touches} "
            f"identifying touches of {um(design.brief.noise)} noise (predicted)",
        ),
        *best,
        KeyFigure(
            f"{digits(user.rms_before / UM)} → {um(user.rms_after)}",
            "volumetric error of a simulated machine in your workspace, before and after, rms"
            + others,
        ),
        *([] if tolerance is None else [_tolerance_figure(design, tolerance)]),
        *(
            [KeyFigure(at_most(design.conformity.worst_face[1]), _STEP_FACE)]
            if design.conformity.face_deviation
            else []
        ),
    ]


def _tolerance_figure(design: Design, tolerance: float) -> KeyFigure:
    """Traffic light of the tolerance of the user's task."""
    share = _provable(design, tolerance)[0]
    light = "good" if share >= GREEN else "fair" if share >= YELLOW else "bad"
    words = f"of the tolerance of {um(tolerance)} remain for the part"
    return KeyFigure(percent(share), words, light)


def _opening(design: Design, folder: Path, remarks: Sequence[str]) -> Section:
    """What was designed, and what its user has to know first."""
    chain, body, plan = design.brief.chain, design.placement.standard, design.plan
    brief = design.brief
    standing = standing_remarks(chain, brief.setup.T_table_artefact, brief.down)
    assumed = [*chain.remarks, *standing]
    marks = (folder / "machine.toml").read_text(encoding="utf-8").count("# PLACEHOLDER")
    if marks:
        assumed.append(
            f"The machine file marks {marks} numbers as placeholders. Replace them with the "
            "machine's own kinematic table before a program runs or a figure is used."
        )
    words = (
        f"{features_words(body, design.placement.family)} on one body, "
        f"{len(plan)} touches at {plural(_poses(design), 'table pose')} in about "
        f"{design.programs.duration / 60.0:.0f} minutes: {_roles(design)}. "
        f"Chain `{chain.notation}`, {parameters_words(chain)}."
    )
    return Section(sentences=[words], warnings=[*assumed, *remarks])


def _roles(design: Design) -> str:
    """What the touches of a visit are for: 480 identify, 110 prove, 60 begin the visits."""
    placement, plan = design.placement, design.plan
    identify, prove = len(placement.requests), len(placement.proof)
    words = [f"{identify} identify the errors", f"{prove} prove the model"]
    if more := len(plan) - identify - prove:
        words.append(f"{more} repeat one point of a ball, at the beginning of every visit")
    return listed(words)


def _poses(design: Design) -> int:
    return len({v.pose for v in design.plan.visits})


def _curves(placement: Placement) -> list[TouchCurve]:
    """Error against the number of touches on every artefact; one has no body."""
    at = placement.criterion
    return [
        touch_curve(at if r.body is None else at.on(r.body), r.name, r.touches)
        for r in placement.rivals
    ]


def _comparison(design: Design, curves: list[TouchCurve]) -> list[Section]:
    """What other artefacts would leave unknown."""
    placement = design.placement
    drawn = draw_touch_curves(curves, design.brief.noise)
    caption = _CURVES.format(count=len(placement.requests))
    chosen = (
        f"Criterion of the choice of touches: {criterion_words(design.brief.options.criterion)}. "
        f"{placement.certificate} of the possible touches on this standard at its table poses; "
        f"the shares refer to table poses. {_SHARES}"
    )
    return [
        Section(
            "Comparison with other artefacts",
            sentences=identification_lines(placement, design.worst),
            table=comparison_table(design),
            notes=[chosen],
        ),
        Section(
            fold="Error against the number of touches",
            is_for_screen=True,
            pictures=[Picture("touch_curves.png", caption, drawn)],
        ),
    ]


def _probing(design: Design) -> list[Section]:
    """The plan of touches, the cost of its order, the programs."""
    plan, poses, times = design.plan, _poses(design), design.times
    come = "The poses come in mixed order and twice" if poses != 1 else "The pose comes twice"
    intro = (
        f"{len(plan)} touches in {len(plan.visits)} visits to {plural(poses, 'table pose')}: "
        f"{_roles(design)}. "
        f"{come}, the second time in reverse order and from the other side. Each visit begins with "
        f"the same point of a datum sphere, so that drift and reversal can be distinguished from "
        f"geometry. {times.words}"
    )
    programs = [
        [f"`programs/{p.file}`", str(p.touches), f"{p.duration / 60.0:.0f}"]
        for p in design.programs.programs
    ]
    reach = "Reach of the machine on such a blank by angle and travels, determined before design."
    sequence = "Rotary readings in the order of execution, with the side of approach."
    pictures = [
        Picture("reach.png", reach),
        Picture("plan_touches.png", "Touched points and normals.", draw_touches(plan)),
        Picture("plan_order.png", sequence, draw_order(plan)),
    ]
    files = Table(("program", "touches", "minutes"), programs)
    return [
        Section("Probing", sentences=[intro], table=files, notes=[_CHECKED]),
        Section(fold="Cost of the order", is_for_screen=True, table=times.orders),
        Section(fold="Reach, touches and their order", is_for_screen=True, pictures=pictures),
    ]


def _meaning(design: Design) -> str:
    """Whether the design does what was asked for, with the tolerance where one is given."""
    user = worst_machine(design.machines).in_workspace
    words = (
        f"A machine like yours errs by {um(user.rms_before)} rms in your workspace; after "
        f"{design.programs.duration / 60.0:.0f} minutes of probing {um(user.rms_after)} are "
        "not known, as simulated with the emitted programs"
    )
    tolerance = design.brief.task.tolerance
    if tolerance is None:
        return f"{words}."
    share, name = _provable(design, tolerance)
    return (
        f"{words}. Of the tolerance of {um(tolerance)} of {design.brief.task.name}, "
        f"{percent(share)} remain in which a part measured on this machine is proved good "
        f"(results {name}; ISO 14253-1)."
    )


def _provable(design: Design, tolerance: float) -> tuple[float, str]:
    """Largest share of a tolerance in which conformity can be proved, and by which results."""
    shares = {n: guarded(tolerance, b.u, b.dof).share for n, b in design.budgets.items()}
    best = max(shares, key=shares.__getitem__)
    return shares[best], best
