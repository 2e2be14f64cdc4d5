"""Sections of a design page on the standard: faces, rivals, CAD files, making."""

import numpy as np

from matstd.artefact.body import FreeformPatch, max_slope, min_concave_radius
from matstd.artefact.worth import CriterionOptions
from matstd.cad_out.making import FIRST_MODE, ROUGHNESS, SAG, Cutting, FaceHint, Making, Stiffness
from matstd.cad_out.verify import Conformity
from matstd.report.layout import Heading, Section, Table
from matstd.report.numbers import concave_radius_words, digits, percent, plural, um
from matstd.report.pages.design_result import Design
from matstd.report.task import modulus_words, price_lines
from matstd.twin.units import DEG, UM

_PATCHES = (
    "Features that test the model that was identified from the other balls: position, curvature, "
    "and the errors that dominate the signal of a face"
)
_RIVALS = (
    "Predicted standard deviation of the volumetric error after {touches} touches each, {noise} "
    "noise, with the calibration uncertainty of every feature. All bodies follow the rules of the "
    "standard: reach, angle, clearance and number of table poses. The optimiser that places the "
    "patches also places the spheres. The ideal scatter has no body, no obstacles and no "
    "uncertainty"
)
_HOW_FACES = "measured without a CAD kernel; limit 0.01 µm"
_MAKING = (
    "`drawing.pdf` is the sheet for the workshop; `making.json` has these figures by feature. Sag "
    "matters on tables that tilt: `matstd evaluate` corrects every touch for it, with a fifth of "
    "it as standard uncertainty."
)

_CRITERIA = {
    "I": "mean variance of the predicted tool point over probed volume and workspace",
    "G": "largest variance of the predicted tool point at any pose of probed volume and workspace",
    "D": "volume of the joint uncertainty of the parameters, in units of their expected sizes",
    "A": "mean variance of the parameters, in units of their expected sizes",
    "E": "variance of the least well determined error pattern, as it moves the tool point",
}


def patch_table(design: Design) -> Table:
    """The features that prove."""
    columns = ("feature", "centre x, y, z, mm", "smallest concave radius, mm", "steepest slope, °")
    rows = [_patch(p, design) for p in design.placement.standard.patches]
    body, plan = design.placement.standard, design.plan
    for ball in (s for s in body.spheres if s.proves):
        x, y, z = ball.centre
        count = str(int(np.sum(plan.feature == ball.name)))
        rows.append([ball.name, f"{x:.0f}, {y:.0f}, {z:.0f}", "convex", "–", count, "–"])
    return Table((*columns, "touches", "dominant errors (share of its signal)"), rows, _PATCHES)


def _patch(patch: FreeformPatch, design: Design) -> list[str]:
    x, y, z = patch.point(np.zeros((1, 2)))[0]
    return [
        patch.name,
        f"{x:.0f}, {y:.0f}, {z:.0f}",
        concave_radius_words(min_concave_radius(patch)),
        f"{max_slope(patch) / DEG:.0f}",
        str(int(np.sum(design.plan.feature == patch.name))),
        ", ".join(f"{e.name}\u00a0{100 * e.share:.0f}\u00a0%" for e in patch.errors[:5]),
    ]


def comparison_table(design: Design) -> Table:
    """The standard beside other artefacts."""
    placement, user, volume = design.placement, "in your workspace, µm", "in the probed volume, µm"
    rows = []
    for rival in placement.rivals:
        time = design.times.minutes[rival.name]
        left = (rival.rms_user, rival.p95_user, rival.rms, rival.p95, rival.rms_random)
        rows.append(
            [
                rival.name,
                f"{time:.0f}" if np.isfinite(time) else "–",
                *(digits(value / UM) for value in left),
                digits(rival.estimable),
                f"{rival.visible} of {rival.could_be_visible}",
            ]
        )
    columns: list[Heading] = [
        "artefact",
        "minutes on\nthe machine",
        *((user, words) for words in ("rms", "95 % of poses")),
        *((volume, words) for words in ("rms", "95 % of poses", "rms, random\ntouches")),
        "combinations\ndetermined",
        "effects of the\nlibrary visible",
    ]
    caption = _RIVALS.format(touches=len(placement.requests), noise=um(design.brief.noise))
    own = [i for i, rival in enumerate(placement.rivals) if rival is placement.own]
    return Table(columns, rows, caption, own)


def criterion_words(wanted: CriterionOptions) -> str:
    """Criterion by which the touches were chosen."""
    words = [_CRITERIA[wanted.name]]
    if wanted.robust_machines:
        which = (
            "" if wanted.robust_share == 1.0 else f"the worst {percent(wanted.robust_share)} of "
        )
        words.append(f"averaged over {which}{wanted.robust_machines} random machines")
    if wanted.potential and wanted.name == "D":
        words.append("together with the effects of the library")
    elif wanted.potential:
        words.append(
            f"with a weight of {percent(wanted.potential)} for the visibility of library effects"
        )
    return ", ".join(words)


def cad_sections(c: Conformity) -> list[Section]:
    """CAD files, measured after they were written."""
    rows = [
        ["STEP", f"AP242, mm, {c.step_bytes / 1e6:.1f} MB, {len(c.names)} named faces"],
        [
            "solids",
            f"{c.solids}: body, balls and screws, valid: {_yes(c.is_valid)}, "
            f"closed: {_yes(c.is_closed)}",
        ],
        ["volume", f"{c.volume / 1e3:.3f} cm³ re-read, {c.volume_built / 1e3:.3f} cm³ built"],
        ["mass", f"{c.mass:.2f} kg"],
        *([["of parts", _parts_words(c)]] if c.parts else []),
        *(
            [["faces against design", f"{at_most(c.worst_face[1])}, {_HOW_FACES}"]]
            if c.face_deviation
            else []
        ),
        [
            "STL",
            f"{c.triangles} triangles, {c.stl_bytes / 1e6:.1f} MB, "
            f"watertight: {_yes(c.is_watertight)} (trimesh), volume {c.mesh_volume / 1e3:.3f} "
            f"and {c.manifold_volume / 1e3:.3f} cm³ (trimesh, manifold3d)",
        ],
        [
            "mesh against faces",
            f"{c.worst_chord[1] / UM:.1f} µm at most, requested {c.chord / UM:.0f} µm",
        ],
    ]
    return [
        Section(fold="CAD files, measured after writing", is_for_screen=True, table=Table((), rows))
    ]


def _parts_words(c: Conformity) -> str:
    """What the file of the second construction holds."""
    kinds = {kind: sum(kind in name for name in c.parts) for kind in ("STUD", "BLOCK")}
    return (
        f"standard-parts.step: plate, {plural(kinds['STUD'], 'stud')} and "
        f"{plural(kinds['BLOCK'], 'block')}, balls and screws; every solid valid and closed"
    )


def at_most(deviation: float) -> str:
    """A deviation that may be nothing but rounding, with no more digits than make sense."""
    return "< 0.0001 µm" if deviation < 1e-4 * UM else um(deviation, 2)


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def making_sections(made: Making) -> list[Section]:
    """Cutters, stiffness and milling."""
    table = Table((), making_rows(made))
    return [
        Section("Making the standard", sentences=[_MAKING]),
        Section(fold="Cutters, stiffness, milling", is_for_screen=True, table=table),
    ]


def making_rows(made: Making) -> list[tuple[str, str]]:
    """Rows about cutters and stiffness, with every limit that is exceeded."""
    cutting = made.cutting
    cutters = ", ".join(
        f"{face} {f'Ø{d:g}' if d else 'none of 6 mm or more'}" for face, d in cutting.cutter.items()
    )
    return [
        (
            "ball-end mill of 6 mm, 10 D out of its holder",
            f"reaches {100 * cutting.upright:.0f} % of the surface from above, "
            f"{np.floor(1000 * cutting.tilted) / 10:g} % tilted by 45° at most"
            f"{_out_of_reach(cutting)}",
        ),
        ("largest ball-end mill of a face, mm", cutters),
        *_stiffness_rows(made),
        *[
            (words.partition(": ")[0], words.partition(": ")[2])
            for words in price_lines(made.prices, made.make)
        ],
        *((f"milling {face} with 6 mm", _milling(hint)) for face, hint in made.hints.items()),
    ]


def _stiffness_rows(made: Making) -> list[tuple[str, str]]:
    stiff, words = made.stiffness, modulus_words(made.material)
    if stiff is None:
        return [("first mode, stiffness and sag", words)]
    name, sag = stiff.worst
    mode = "" if stiff.first_mode >= FIRST_MODE else f"; required: {FIRST_MODE:.0f} Hz or more"
    beyond = sorted(f for f, value in stiff.sag.items() if value > SAG)
    more = f"; more than {SAG / UM:g} µm: {', '.join(beyond)}" if beyond else ""
    corrected = "; corrected by evaluations ([sag] of standard.toml)"
    return [
        ("Young's modulus", words),
        ("first mode on rigid screws", f"{stiff.first_mode:.0f} Hz{mode}"),
        *_softest(stiff),
        (
            "sag from upright to lying on its side",
            f"{name} {sag / UM:.2f} µm at most{more}{corrected}",
        ),
    ]


def _softest(stiff: Stiffness) -> list[tuple[str, str]]:
    """The most compliant ball under a touch."""
    if not stiff.at_balls:
        return []
    ball = min(stiff.at_balls, key=stiff.at_balls.__getitem__)
    words = f"{ball} {stiff.at_balls[ball] * UM:.1f} N/µm on its post, plate and pads"
    return [("softest ball, in its softest direction", words)]


def _out_of_reach(cutting: Cutting) -> str:
    """Faces that the finishing cutter does not reach, and the overhang at which it would."""
    if not cutting.out_of_reach:
        return ""
    enough = f"with an overhang of {cutting.overhang:g} mm it reaches all of them"
    none = "no overhang that was tried reaches them: try a smaller blank.height_mm"
    words = enough if np.isfinite(cutting.overhang) else none
    return f", not at all: {', '.join(cutting.out_of_reach)}; {words}"


def _milling(hint: FaceHint) -> str:
    """Slopes, step-over and tilt of one face."""
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
