"""The page of a diagnosis: verdict, error after each step, effects, what remains open."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from matstd.diagnosis.answer import Diagnosis, Step, Verdict
from matstd.diagnosis.next_visit import VisitPlan
from matstd.report.effects import class_words, effect_cell
from matstd.report.geometry import fault_sentences, geometry_sections
from matstd.report.laws import law_sections, short_words, size_words
from matstd.report.layout import KeyFigure, Page, Picture, Section, Table, write_page
from matstd.report.numbers import capital, digits, microns, p_value, sentence
from matstd.report.pages.rival_sections import (
    detection_sections,
    next_sections,
    rival_sections,
    tried_sections,
)
from matstd.report.pages.run_sections import (
    dependence_section,
    extent,
    on_standard,
    outlier_section,
    pattern_pictures,
    region_section,
    residual_sections,
    run_foot,
)
from matstd.report.pages.trend_section import trend_sections
from matstd.report.plots import draw_effect, draw_fall, draw_form, is_form
from matstd.report.run_view import diagnosis_step, diagnosis_view
from matstd.report.style import series
from matstd.report.verdict import diagnosis_meaning, part_lines
from matstd.report.words import (
    figures,
    remark_sentence,
    sizes,
    stated_noise,
    values,
    verdict_sentence,
)
from matstd.twin.frames import Array
from matstd.twin.library import kinds
from matstd.twin.units import UM

_COURSE = (
    "Left: the part of the run that this effect explains, with its fitted course. Right: the same "
    "touches with the effect in the model. Dots: means with standard errors."
)
_FORM = (
    "Left: the form of this feature, as its touches and the fit show it. Right: the same touches "
    "with the form in the model."
)
_HELD_OUT = (
    "Probabilities are corrected for the search over inner parameters and for the number of "
    "effects tried. The held-out error is what to expect for another run of the same touches, with "
    "its noise and the uncertainty of the prediction; it is estimated from rows that the fit did "
    "not use. A correct model therefore stays slightly above the noise."
)


def write_diagnosis_page(
    result: Diagnosis,
    folder: str | Path,
    title: str,
    rng: np.random.Generator,
    is_saved: bool = False,
    body: Array | None = None,
    visit: VisitPlan | None = None,
) -> Path:
    """Write `report.html` and its pictures into a folder.

    Args:
        rng: Shuffles residuals, to show what chance produces.
        is_saved: Whether the model file has what was found.
        body: Triangles of what was probed, where it is known.
        visit: That distinguishes laws from their rivals, where laws were learnt.
    """
    fits = [("starting model", result.start)]
    fits += [("final model", result.fit)] if len(result.steps) > 1 else []
    page = Page(
        heading=f"Diagnosis of {title}",
        lead=verdict_sentence(result),
        key=_key(result),
        sections=[
            _parts(result),
            _notes(result),
            *trend_sections(result.trend),
            _steps(result),
            *(_effect(result, i) for i in range(1, len(result.steps))),
            *_learnt(result, visit),
            Section(pictures=on_standard(result.run.touches, *fits)),
            *geometry_sections(result.run.touches, result.geometry),
            *(_unexplained(result, rng) if is_open(result) else ()),
            *tried_sections(result),
            *rival_sections(result),
            *detection_sections(result.detectable),
            *next_sections(result),
            *_residuals(result),
            outlier_section(result.fit),
        ],
        foot=run_foot(result.run, title),
        means=diagnosis_meaning(result),
        next=diagnosis_step(result, title, is_saved),
        live=diagnosis_view(result, title, body),
    )
    return write_page(Path(folder) / "report.html", page)


def is_open(result: Diagnosis) -> bool:
    """Whether something remains that the diagnosis does not explain."""
    return result.verdict in (Verdict.UNEXPLAINED, Verdict.UNDECIDED)


def _key(result: Diagnosis) -> list[KeyFigure]:
    look = "bad" if is_open(result) else "found" if result.verdict is Verdict.MISSING else "good"
    stated = stated_noise(result.run)
    before, after = result.promise_before, result.promise
    fall = f"{before.elsewhere / UM:.2f} → " if result.has_fallen else ""
    held_out = int((result.run.split == "test").sum())
    noise = result.standing.noise
    return [
        KeyFigure(result.verdict.value, "verdict", look),
        KeyFigure(
            f"{fall}{after.elsewhere / UM:.2f} µm",
            f"error to expect elsewhere, rms; at the same touches {microns(after.same)}",
        ),
        KeyFigure(
            microns(stated),
            f"stated noise; scatter of the residual {microns(stated * noise.factor)}",
        ),
        KeyFigure(digits(noise.chi2_ratio), "chi-square per degree of freedom"),
        KeyFigure(
            str(len(result.run)),
            f"touches{extent(result.run.touches)}{f'; {held_out} held out' if held_out else ''}",
        ),
    ]


def _parts(result: Diagnosis) -> Section:
    """The verdict in three parts, repeatability, and the errors to expect."""
    rows = [[capital(name), sentence(words)] for name, words in part_lines(result)]
    return Section("Verdict in parts", table=Table(("part", "finding"), rows))


def _notes(result: Diagnosis) -> Section:
    faults = [f"**{sentence(words)}**" for words in fault_sentences(result.faults)]
    return Section(notes=[*faults, *(sentence(remark_sentence(r)) for r in result.remarks)])


def _steps(result: Diagnosis) -> Section:
    """The error falling from step to step."""
    rows = [_step(result, step) for step in result.steps]
    rows += _law_steps(result)
    columns = ("step", "size ± standard uncertainty", "probability by chance")
    errors = ("fitted, µm", "held out, µm", "chi-square per degree of freedom")
    pictures = []
    if len(rows) > 1:
        caption = (
            "The held-out error decides; that of the touches in the fit is optimistic, because "
            f"{len(result.fit.parameters)} parameters were fitted to them."
        )
        pictures.append(Picture("pictures/fall.png", caption, draw_fall(result)))
    return Section(
        "Error after each step",
        sentences=[_HELD_OUT],
        table=Table((*columns, *errors), rows, best=[len(rows) - 1]),
        pictures=pictures,
    )


def _step(result: Diagnosis, step: Step) -> list[str]:
    if step.effect is None:
        return ["starting model", "", "", *figures(step.fit)]
    title, name = effect_cell(step)
    sign = "withdrawn:" if step.effect in result.withdrawn else "+"
    cell = f"{sign} {title}\n`{name}`" if name else f"{sign} {title}"
    return [cell, sizes(step, most=2), p_value(step.p_value), *figures(step.fit)]


def _law_steps(result: Diagnosis) -> list[list[str]]:
    """The model with the laws that were learnt, as the last step."""
    laws = result.laws
    if laws is None or not laws.laws:
        return []
    sign = "instead:" if laws.instead_of else "+"
    names = "\n".join(short_words(one.law) for one in laws.laws)
    size = "; ".join(size_words(laws, one.law) for one in laws.laws)
    return [[f"{sign} {names}", size, "", *figures(laws.after)]]


def _effect(result: Diagnosis, i: int) -> Section:
    """One added effect: its numbers, its formula, its course over the run."""
    step, found = result.steps[i], values(result.steps[i])
    assert step.effect is not None
    more = "; all its numbers are in diagnosis.json" if len(found) < len(step.reported) else ""
    words = capital(", ".join(" ".join(pair) for pair in found))
    sentences = [f"{words}{more}." if words else ""]
    kind = next((k for k in kinds() if k.word == step.effect.kind), None)
    if kind is not None:
        # a Greek mu: figures of the library stay lengths on the page of an angle instrument
        typical = kind.typical.replace("µ", "\N{GREEK SMALL LETTER MU}")
        sentences.append(f"`{kind.formula}`\nTypical: {typical} ({kind.source}).")
    if step.is_named:
        sentences.append("Added by name.")
    if step.effect in result.withdrawn:
        sentences.append("Withdrawn: the learnt law explains the run better.")
    form = is_form(result.fit, step.effect)
    drawn = (
        draw_form(result.fit, step.effect)
        if form
        else draw_effect(result.fit, step.effect, series(i - 1))
    )
    return Section(
        capital(class_words(step)),
        is_part=True,
        sentences=[s for s in sentences if s],
        pictures=[Picture(f"pictures/effect_{i}.png", _FORM if form else _COURSE, drawn)],
    )


def _learnt(result: Diagnosis, visit: VisitPlan | None) -> list[Section]:
    """The laws of what remains, where they were looked for."""
    if result.laws is None:
        return []
    heading = "Learnt from what remains"
    return [Section(heading), *law_sections(result.laws, visit)]


def _unexplained(result: Diagnosis, rng: np.random.Generator) -> list[Section]:
    return [
        dependence_section(result, "Unexplained residual"),
        Section(pictures=pattern_pictures(result.fit, result.left, rng)),
        region_section(result.fit, result.where),
    ]


def _residuals(result: Diagnosis) -> Sequence[Section]:
    """The residual of the starting model, and of the final one where that is another."""
    title = "Where the starting model fails"
    out = [Section(title)]
    if not is_open(result):
        out = [dependence_section(result, title), region_section(result.start, result.where)]
    out += residual_sections("before", result.start)
    if len(result.steps) > 1:
        out += [Section("Residual of the final model"), *residual_sections("after", result.fit)]
    return out
