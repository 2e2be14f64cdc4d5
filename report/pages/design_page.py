"""The page of a design run: pictures, figures and tables of everything that was made."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard, max_slope, min_concave_radius
from matstd.artefact.compare import Rival
from matstd.artefact.reach import standing_remarks
from matstd.artefact.worth import Criterion, touch_curve
from matstd.cad_out.making import FIRST_MODE, ROUGHNESS, SAG, Cutting, FaceHint, Making, Stiffness
from matstd.report.pages.design_result import Design, Proven
from matstd.report.pages.identifiability_section import known_content
from matstd.report.pages.page import digits, write_page
from matstd.report.pages.study_page import draw_study_volumes, study_content
from matstd.report.pages.time_section import minutes, order_content
from matstd.report.plots import (
    draw_touch_curves,
    write_order_picture,
    write_proof_picture,
    write_touches_picture,
)
from matstd.report.scenes import draw_standard
from matstd.report.style import save
from matstd.report.task import budget_rows, modulus_words, task_lines
from matstd.report.words import (
    best_rival,
    comparison_remarks,
    criterion_words,
    design_lines,
    verdict_of_design,
)
from matstd.twin.errors import DesignError
from matstd.twin.units import DEG, UM

MAPS, CURVES = "sensitivity", "touch_curves.png"
"""Folder of the maps, file of a picture."""

_EXCERPT = 46  # lines of the first program
_FLAT = 10_000.0  # mm: a ball of 3 mm cannot tell such a face from a plane


def write_design_page(design: Design, folder: Path) -> list[str]:
    """Draw the pictures and write report.html.

    Args:
        design: What was made; its files lie in the folder.
        folder: The results.

    Returns:
        What could not be drawn and why, one line each; the page says it too.
    """
    remarks: list[str] = comparison_remarks(design.placement)
    chain, stands = design.brief.chain, design.brief.setup.T_table_artefact
    assumed = [*chain.remarks, *standing_remarks(chain, stands)]
    with ThreadPoolExecutor(1) as beside:  # pictures are rendered in processes of their own
        counted = beside.submit(_times, design)
        pictures = _standard_pictures(design, folder, remarks)
        maps = [*design.maps, *_volumes(design, folder, remarks)]
        write_touches_picture(folder / "plan_touches.png", design.plan)
        write_order_picture(folder / "plan_order.png", design.plan)
        write_proof_picture(folder / "proof.png", [m.in_workspace for m in design.machines])
        curves = _draw_curves(design, folder)
        on_machine, in_order = counted.result()
    write_page(
        folder / "report.html",
        "design.html",
        folder=folder,
        project=design.brief,
        verdict=verdict_of_design(design.placement, design.brief.ranges),
        standard=design.placement.standard,
        plan=design.plan,
        programs=design.programs,
        pictures=pictures,
        remarks=[*assumed, *remarks],
        placeholders=(folder / "machine.toml").read_text(encoding="utf-8").count("# PLACEHOLDER"),
        curves_caption=curves,
        **study_content(design.study, maps),
        **_standard(design, on_machine),
        **_proof(design),
        **in_order,
        **known_content(design, folder),
        excerpt="\n".join([*design.programs.programs[0].text.splitlines()[:_EXCERPT], "..."]),
    )
    return remarks


def _standard_pictures(design: Design, folder: Path, remarks: list[str]) -> list[tuple[str, str]]:
    """Pictures that need OpenGL; without it the rest of the page is written all the same."""
    standard, stl = design.placement.standard, folder / "standard.stl"
    made = []
    try:
        draw_standard(standard, stl, folder / "standard.png")
        made.append(("standard.png", "The standard from two sides: patches, spheres, datum plane."))
    except DesignError as error:
        remarks.append(f"No pictures of the standard: {error}")
    return made


def _volumes(design: Design, folder: Path, remarks: list[str]) -> list[tuple[str, str]]:
    """Maps in three dimensions, with the standard in its place."""
    stands = design.brief.setup.T_table_artefact
    place = folder / MAPS
    return draw_study_volumes(design.study, place, remarks, folder / "standard.stl", stands)


def _draw_curves(design: Design, folder: Path) -> str:
    """Error left against the number of touches, on every artefact; returns the caption."""
    placement = design.placement
    curves = [
        touch_curve(_on(placement.criterion, r.body), r.name, r.touches) for r in placement.rivals
    ]
    save(draw_touch_curves(curves, design.brief.noise), folder / CURVES)
    return (
        "Error left against the number of touches, predicted for every artefact by one rule: its "
        "touches in the order in which each helps most, and beyond their number all of them again. "
        f"Marked: the {len(placement.requests)} identifying touches of the table above. No machine "
        "is drawn for it: it is the spread that the touches leave to machines of the stated error "
        "ranges."
    )


def _on(criterion: Criterion, body: Standard | None) -> Criterion:
    """The criterion for touches on a body, or on none."""
    return criterion if body is None else criterion.on(body)


def _times(design: Design) -> tuple[dict[str, float], dict[str, Any]]:
    """Minutes of every artefact, and what the page tells of the order: without any picture."""
    return minutes(design), order_content(design)


def _standard(design: Design, on_machine: dict[str, float]) -> dict[str, Any]:
    """Tables of the patches, of other artefacts and of the CAD files.

    Args:
        on_machine: Minutes of every artefact.
    """
    c = design.conformity
    faces, best = max(c.face_deviation.values()) / UM, best_rival(design.placement)
    return {
        "patches": [_patch(p, design) for p in design.placement.standard.patches],
        "certificate": design.placement.certificate,
        "criterion": criterion_words(design.brief.options.criterion),
        "identification": " ".join(
            design_lines(design.placement, design.brief.ranges, design.worst)[2:]
        ),
        "comparison": [_rival(r, design, on_machine) for r in design.placement.rivals],
        "rival": _rival(best, design, on_machine) if best is not None else None,
        "step_deviation": _at_most(faces),
        "making": _making(design.making),
        "cad": [
            ("STEP", f"AP242, mm, {c.step_bytes / 1e6:.1f} MB, {len(c.names)} named faces"),
            (
                "solids",
                f"{c.solids}: body, balls and screws, valid: {_yes(c.is_valid)}, "
                f"closed: {_yes(c.is_closed)}",
            ),
            ("volume", f"{c.volume / 1e3:.3f} cm³ re-read, {c.volume_built / 1e3:.3f} cm³ built"),
            ("mass", f"{c.mass:.2f} kg"),
            (
                "faces against design",
                f"{_at_most(faces)}, read without any CAD kernel; 0.01 µm allowed",
            ),
            (
                "STL",
                f"{c.triangles} triangles, {c.stl_bytes / 1e6:.1f} MB, "
                f"watertight: {_yes(c.is_watertight)} (trimesh), volume {c.mesh_volume / 1e3:.3f} "
                f"and {c.manifold_volume / 1e3:.3f} cm³ (trimesh, manifold3d)",
            ),
            (
                "mesh against faces",
                f"{max(c.chord_error.values()) / UM:.1f} µm at most, "
                f"{c.chord / UM:.0f} µm asked for",
            ),
        ],
    }


def _making(made: Making) -> list[tuple[str, str]]:
    """Rows about cutters and stiffness; what is beyond a limit says so."""
    cutting = made.cutting
    cutters = ", ".join(
        f"{face} {f'Ø{d:g}' if d else 'none of 6 mm or more'}" for face, d in cutting.cutter.items()
    )
    beyond = _out_of_reach(cutting)
    return [
        (
            "ball-end mill of 6 mm, 10 D out of its holder",
            f"reaches {100 * cutting.upright:.0f} % of the surface from above, "
            f"{np.floor(1000 * cutting.tilted) / 10:g} % tilted by 45° at most{beyond}",
        ),
        ("largest ball-end mill of a face, mm", cutters),
        *_stands(made),
        *((f"milling {face} with 6 mm", _milling(hint)) for face, hint in made.hints.items()),
    ]


def _stands(made: Making) -> list[tuple[str, str]]:
    """How stiff it is, and with what modulus; that it is not known where there is none."""
    stiff, words = made.stiffness, modulus_words(made.material)
    if stiff is None:
        return [("first mode, stiffness and sag", words)]
    name, sag = stiff.worst
    mode = "" if stiff.first_mode >= FIRST_MODE else f"; at least {FIRST_MODE:.0f} Hz are wanted"
    often = sorted(f for f, value in stiff.sag.items() if value > SAG)
    told = f"; beyond {SAG / UM:g} µm: {', '.join(often)}" if often else ""
    told += "; taken off by evaluations ([sag] of standard.toml)"
    return [
        ("Young's modulus", words),
        ("first mode on rigid screws", f"{stiff.first_mode:.0f} Hz{mode}"),
        *_softest(stiff),
        ("sag from upright to lying on its side", f"{name} {sag / UM:.2f} µm at most{told}"),
    ]


def _softest(stiff: Stiffness) -> list[tuple[str, str]]:
    """The ball that gives most under a touch."""
    if not stiff.at_balls:
        return []
    ball = min(stiff.at_balls, key=stiff.at_balls.__getitem__)
    words = f"{ball} {stiff.at_balls[ball] * UM:.1f} N/µm on its post, plate and pads"
    return [("softest ball, in its softest direction", words)]


def _out_of_reach(cutting: Cutting) -> str:
    """What the finishing cutter does not reach, and how far out of its holder it would."""
    if not cutting.out_of_reach:
        return ""
    enough = f"{cutting.overhang:g} mm out of its holder it reaches all"
    none = "no overhang that was tried reaches all: try a smaller blank.height_mm"
    words = enough if np.isfinite(cutting.overhang) else none
    return f", not at all: {', '.join(cutting.out_of_reach)}; {words}"


def _milling(hint: FaceHint) -> str:
    """Slopes, step-over and tilt of one face in words."""
    low, high = (angle / DEG for angle in hint.slope)
    widths = ", ".join(
        f"{width:.2f} mm for Ra {ra / UM:g} µm"
        for ra, width in zip(ROUGHNESS, hint.step_over, strict=True)
    )
    words = f"slopes {low:.0f} to {high:.0f}°; step-over {widths}; "
    if hint.axis is None or hint.contact is None:
        return words + "no single tilt of the axis up to 45° reaches all of it"
    tilt, azimuth = (angle / DEG for angle in hint.axis)
    tilts = ", ".join(f"{angle / DEG:.0f}" for angle in hint.tilts)
    least, most = (angle / DEG for angle in hint.contact)
    return words + (
        f"reached at tilts of {tilts}°; farthest from the tip at {tilt:.0f}° towards "
        f"{azimuth:.0f}° (contact at {least:.0f} to {most:.0f}°)"
    )


def _rival(rival: Rival, design: Design, on_machine: dict[str, float]) -> dict[str, Any]:
    """Row of an artefact in the table that compares them."""
    return {
        "name": rival.name,
        "is_this": rival is design.placement.own,
        "touches": len(design.placement.requests),
        "rms_um": rival.rms / UM,
        "p95_um": rival.p95 / UM,
        "rms_user_um": rival.rms_user / UM,
        "p95_user_um": rival.p95_user / UM,
        "visible": rival.visible,
        "could_be_visible": rival.could_be_visible,
        "minutes": on_machine[rival.name],
        "rms_random_um": rival.rms_random / UM,
        "estimable": rival.estimable,
    }


def _at_most(um: float) -> str:
    """A deviation that may be nothing but rounding, with no more digits than make sense."""
    return "< 0.0001 µm" if um < 1e-4 else f"{digits(um, 2)} µm"


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def _radius(value: float) -> str:
    """Smallest concave radius; a face that is convex everywhere has none, one of 10 m is flat."""
    if not np.isfinite(value):
        return "convex"
    return f"{value:.1f}" if value < _FLAT else "flat"


def _patch(patch: FreeformPatch, design: Design) -> dict[str, Any]:
    """One row of the table of patches."""
    x, y, z = patch.point(np.zeros((1, 2)))[0]
    return {
        "name": patch.name,
        "centre": f"{x:.0f}, {y:.0f}, {z:.0f}".replace("-", "−"),
        "radius": _radius(min_concave_radius(patch)),
        "slope": f"{max_slope(patch) / DEG:.0f}",
        "touches": int(np.sum(design.plan.feature == patch.name)),
        "errors": ", ".join(f"{e.name}\u00a0{100 * e.share:.0f}\u00a0%" for e in patch.errors[:5]),
    }


def _proof(design: Design) -> dict[str, Any]:
    """Table of the machines; the worst one opens the page."""
    machines = [_machine(m) for m in design.machines]
    return {
        "machines": machines,
        "worst": max(machines, key=lambda m: m["proofs"][0]["after_um"]),
        "noise_um": design.brief.noise / UM,
        "proof_poses": len(design.machines[0].proof.before),
        "poses": len({v.pose for v in design.plan.visits}),
        "minutes": round(design.programs.duration / 60.0),
        "task": design.brief.task.name,
        "budgets": budget_rows(design.budgets),
        "first_budget": next(iter(design.budgets.values())),
        "task_lines": task_lines(design.budgets, design.brief.task.tolerance, design.visits),
    }


def _machine(machine: Proven) -> dict[str, Any]:
    places = (("your workspace", machine.in_workspace), ("probed volume", machine.proof))
    return {
        "number": machine.seed + 1,
        "proofs": [
            {
                "where": where,
                "before_um": proof.rms_before / UM,
                "after_um": proof.rms_after / UM,
                "u_um": proof.rms_u / UM,
                "factor": proof.factor,
                "covered": proof.covered,
            }
            for where, proof in places
        ],
    }
