"""Sections that the pages of compare and diagnose share: residuals, regions, outliers, the run."""

from collections.abc import Callable, Sequence

import numpy as np

from matstd.diagnosis.answer import Diagnosis, GroupResidual
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.residual import Region, Structure, has_poses, rank_variables
from matstd.report.layout import Picture, Section, Table
from matstd.report.numbers import capital, digits, p_value, plural, pose_word, span
from matstd.report.plots import (
    draw_normal_plot,
    draw_on_standard,
    draw_over_variables,
    draw_pattern,
    draw_pose_arrows,
    draw_region,
    is_spread,
)
from matstd.report.words import region_sentence, structure_words
from matstd.twin.frames import Array
from matstd.twin.record import Run, Touches
from matstd.twin.units import UM

FIRST, WHOLE = 12, 40  # variables that are shown unfolded, and at most
PATTERN_PICTURES = 3  # patterns that are drawn at most
REGIONS = 2  # regions that are drawn

_REGION = (
    "Residual of each touch divided by its lever on this error, over each variable that bounds the "
    "region (shaded); only touches within its other bounds. Dots: means with standard errors. "
    "Line: the size, the weighted mean in the region."
)

DEPENDENCES = 8  # variables that a table lists with their patterns; further ones are named below it

_OVER = (
    "Residual over each recorded variable, the strongest dependence first. Grey: touches. Dots: "
    "means with standard errors, red beyond three standard errors. Right-hand scale: in units of "
    "the stated uncertainty."
)
_POSES = (
    "Mean residual vector of each table pose. Left: an arrow along X and Y at the rotary readings, "
    "coloured by Z. Right: the components with their standard uncertainties."
)
_NORMAL = (
    "Residuals over their stated standard uncertainty, corrected for leverage, against the normal "
    "distribution. Touches left out of the fit are listed by line of the run file."
)


def residual_sections(name: str, fit: Fit, z: Array | None = None) -> list[Section]:
    """Pictures of the residual of a fit; those of the weaker variables are folded.

    Args:
        name: First word of the files.
        z: Residuals over their standard uncertainty where that exceeds the touch's own, (N,).
    """
    panels, file = rank_variables(fit), f"pictures/{name}"
    first, more = panels[:FIRST], panels[FIRST:WHOLE]
    out = []
    if first:
        over = Picture(f"{file}_over.png", _OVER, draw_over_variables(fit, first))
        out.append(Section(pictures=[over]))
    if more:
        shown = draw_over_variables(fit, more)
        others = Picture(f"{file}_over_more.png", "Residual over the other variables.", shown)
        out.append(Section(fold="The same for the other variables", pictures=[others]))
    last = [Picture(f"{file}_normal.png", _NORMAL, draw_normal_plot(fit, z))]
    if has_poses(fit):
        last.insert(0, Picture(f"{file}_poses.png", _POSES, draw_pose_arrows(fit)))
    return [*out, Section(pictures=last)]


def on_standard(touches: Touches, *fits: tuple[str, Fit]) -> list[Picture]:
    """The standard coloured by residual, all fits on one scale; none for readings at one place."""
    caption = "Touched points in the frame of the standard, coloured by residual."
    file = "pictures/on_standard.png"
    return [Picture(file, caption, draw_on_standard(fits))] if is_spread(touches) else []


def pattern_pictures(
    fit: Fit, found: Sequence[Structure], rng: np.random.Generator
) -> list[Picture]:
    """Patterns of a residual, the most certain first, each beside the residual shuffled."""
    out: list[Picture] = []
    seen: set[tuple[tuple[str, ...], float]] = set()
    for k, one in enumerate(found):
        if (one.variables, one.period) in seen or len(out) >= PATTERN_PICTURES:
            continue
        seen.add((one.variables, one.period))
        drawn = draw_pattern(fit, one, rng)
        if drawn is not None:
            words = f"{capital(structure_words(one))}; probability by chance {p_value(one.p_value)}"
            out.append(Picture(f"pictures/pattern_{k}.png", f"{words}.", drawn))
    return out


def region_section(fit: Fit, found: Sequence[Region], title: str = "") -> Section:
    """Regions in which a model fails, with the error over what bounds them."""
    if not found:
        words = "No region stands out: no error of one component is limited to a part of the run."
        return Section(title, sentences=[words])
    cells: dict[str, Callable[[Region], str]] = {
        "error and region": region_sentence,
        "residual there, µm rms": lambda r: f"{r.rms / UM:.2f}",
        "probability by chance": lambda r: p_value(r.p_value),
    }
    caption = (
        "Errors of one component that are off in a part of the run: mean beside what the fitted "
        "model says (± standard uncertainty from the noise). Regions may share touches; the "
        "probability counts all components and regions that were tried"
    )
    drawn = [
        Picture(f"pictures/region_{k}.png", f"{capital(region_sentence(r))}. {_REGION}", picture)
        for k, r in enumerate(found[:REGIONS])
        if (picture := draw_region(fit, r)) is not None
    ]
    return Section(title, table=Table.of(found, cells, caption), pictures=drawn)


def dependence_section(result: Diagnosis, title: str = "") -> Section:
    """Variables on which the residual depends."""
    found = result.depends_on
    if not found:
        return Section(title, sentences=["The residual depends on no recorded variable."])
    table = Table.of(
        found[:DEPENDENCES],
        {
            "variable": lambda d: f"`{d.variable}`",
            "pattern": lambda d: structure_words(d.structure),
            "probability by chance": lambda d: p_value(d.p_value),
        },
        "Variables on which the residual depends beyond chance",
    )
    more = ", ".join(f"`{d.variable}`" for d in found[DEPENDENCES:])
    return Section(title, table=table, notes=[f"Also on {more}."] if more else [])


def group_section(fold: str, groups: Sequence[GroupResidual]) -> Section:
    """Residuals of poses or features, folded."""
    cells: dict[str, Callable[[GroupResidual], str]] = {
        "": lambda g: g.name or "all",
        "touches": lambda g: str(g.touches),
        "mean, µm": lambda g: f"{g.mean / UM:+.2f}",
        "rms, µm": lambda g: f"{g.rms / UM:.2f}",
        "rms in u": lambda g: f"{g.normalised:.2f}",
    }
    return Section(fold=fold, table=Table.of(groups, cells))


def outlier_section(fit: Fit) -> Section:
    """Gross errors, the largest first, by line of the run file."""
    rows = np.flatnonzero(fit.gross.rows | fit.gross_test_rows)
    rows = rows[np.argsort(-np.abs(fit.residual[rows]))]
    if not len(rows):
        return Section("Outliers", sentences=["No touch is an outlier."])
    t, was = fit.run.touches, "was" if len(rows) == 1 else "were"
    cells: dict[str, Callable[[int], str]] = {
        "line of the run file": lambda i: str(fit.run.line[i]),
        "feature": lambda i: str(t.feature[i]),
        "set-up": lambda i: t.setups[t.setup[i]].name,
        "pose": lambda i: str(t.pose[i]),
        "residual, µm": lambda i: f"{fit.residual[i] / UM:+.1f}",
        "standard deviations": lambda i: digits(abs(fit.gross.score[i]), 2),
    }
    words = (
        f"{plural(len(rows), 'touch')} with a residual far beyond the noise {was} left out of the "
        "estimates. The run file is unchanged. Inspect these touches, probe them again, or correct "
        "their lines."
    )
    return Section("Outliers", sentences=[words], table=Table.of(rows.tolist(), cells))


def extent(touches: Touches) -> str:
    """`at 24 table poses in 2.1 h`, as far as the run has poses and times."""
    poses = len(np.unique(np.column_stack([touches.setup, touches.pose]), axis=0))
    at = f" at {plural(poses, pose_word(touches))}" if touches.chain.rotary_axes else ""
    time = float(np.ptp(touches.time))
    return f"{at} in {span(time)}" if time > 0.0 else at


def run_foot(run: Run, title: str) -> list[str]:
    """What was measured, and the conventions of a page about it."""
    chain, setups = run.touches.chain, len(np.unique(run.touches.setup))
    return [
        f"Run `{title}`, fingerprint `{run.fingerprint}`. Machine `{chain.name}`, "
        f"`{chain.notation}`; {len(run)} touches in {plural(setups, 'set-up')}, the set-ups "
        "estimated. Residual: measured minus predicted deviation along the outward normal. "
        "Uncertainties are standard uncertainties (k = 1)."
    ]
