"""The page of a comparison: the residual of a model, where it occurs, what it depends on."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from matstd.diagnosis.answer import Comparison
from matstd.diagnosis.fit import Reported
from matstd.report.geometry import fault_sentences, geometry_sections
from matstd.report.layout import KeyFigure, Page, Section, Table, write_page
from matstd.report.numbers import digits, microns, p_value, sentence
from matstd.report.pages.run_sections import (
    extent,
    group_section,
    on_standard,
    outlier_section,
    pattern_pictures,
    region_section,
    residual_sections,
    run_foot,
)
from matstd.report.run_view import comparison_step, comparison_view
from matstd.report.verdict import comparison_meaning, promise_words, repeatability_words
from matstd.report.words import comparison_sentence, learnt_lines, remark_sentence, structure_words
from matstd.twin.frames import Array
from matstd.twin.units import UM

PATTERN_ROWS = 12  # patterns that the table lists

_PREDICTED = (
    "The machine is as estimated before this run; only the set-ups of the standard were estimated "
    "from it. Uncertainties include that of the prediction."
)
_FITTED = (
    "The whole model was fitted to this run: {count} parameters with the set-ups. The residual is "
    "what the model cannot represent."
)
_PATTERNS = (
    "Patterns beyond chance, the most certain first; probabilities are corrected for the number of "
    "tests"
)
_NO_PATTERN = (
    "No dependence beyond chance on any variable, pair of variables, wave in time, feature or pose."
)


def write_compare_page(
    found: Comparison,
    folder: str | Path,
    title: str,
    rng: np.random.Generator,
    reported: Mapping[str, Sequence[Reported]] | None = None,
    body: Array | None = None,
) -> Path:
    """Write `report.html` and its pictures into a folder.

    Args:
        rng: Shuffles residuals, to show what chance produces.
        reported: Numbers of effects as the model file keeps them, by name.
        body: Triangles of what was probed, where it is known.
    """
    page = Page(
        heading=f"{title} against the model",
        lead=comparison_sentence(found),
        key=_key(found),
        sections=[
            _opening(found, reported or {}),
            region_section(found.fit, found.where, "Where the model fails"),
            Section(pictures=on_standard(found.run.touches, ("measured − predicted", found.fit))),
            *geometry_sections(found.run.touches, found.geometry),
            *_patterns(found, title, rng),
            Section("Residuals by pose and by feature"),
            group_section(f"{len(found.poses)} table poses", found.poses),
            group_section(f"{len(found.features)} features", found.features),
            outlier_section(found.fit),
        ],
        foot=run_foot(found.run, title),
        means=comparison_meaning(found),
        next=comparison_step(found, title),
        live=comparison_view(found, title, body),
    )
    return write_page(Path(folder) / "report.html", page)


def _key(found: Comparison) -> list[KeyFigure]:
    run, worst = found.run, found.worst
    times = digits(abs(found.normalised[worst]), 2)
    return [
        KeyFigure(
            f"{digits(found.rms_measured / UM)} → {found.rms / UM:.2f} µm",
            "rms measured; rms of the residual",
        ),
        KeyFigure(digits(found.chi2_ratio), "chi-square per degree of freedom"),
        KeyFigure(
            f"{found.residual[worst] / UM:+.2f} µm",
            f"worst touch, line {run.line[worst]}: {times} u",
        ),
        KeyFigure(microns(found.scatter), "scatter of the residual"),
        KeyFigure(str(len(run)), f"touches{extent(run.touches)}"),
    ]


def _opening(found: Comparison, reported: Mapping[str, Sequence[Reported]]) -> Section:
    """What was fitted, mistakes in the description, remarks."""
    fitted = _FITTED.format(count=len(found.fit.parameters))
    learnt = learnt_lines(found.learnt, reported) if found.learnt else []
    return Section(
        sentences=[_PREDICTED if found.is_prediction else fitted, *learnt, *_expected(found)],
        notes=[
            *(f"**{sentence(words)}**" for words in fault_sentences(found.faults)),
            *(sentence(remark_sentence(remark)) for remark in found.remarks),
        ],
    )


def _expected(found: Comparison) -> list[str]:
    """Repeatability, and the errors to expect of a model that was fitted here."""
    repeats = repeatability_words(found.repeatability, found.scatter)
    out = [sentence(f"repeatability: {repeats}")]
    if found.promise is not None:
        out.append(sentence(f"error to expect: {promise_words(found.promise)}"))
    return out


def _patterns(found: Comparison, title: str, rng: np.random.Generator) -> list[Section]:
    """What the residual depends on, in a table and in pictures."""
    heading = "Variables that the residual depends on"
    z = found.normalised if found.is_prediction else None
    residuals = residual_sections("residual", found.fit, z)
    if not found.structure:
        return [Section(heading, sentences=[_NO_PATTERN]), *residuals]
    rows = [[structure_words(s), p_value(s.p_value)] for s in found.structure[:PATTERN_ROWS]]
    which = f"To identify the physical effect: `matstd diagnose {title} -o OUT`"
    return [
        Section(
            heading,
            table=Table(("pattern", "probability by chance"), rows, _PATTERNS),
            pictures=pattern_pictures(found.fit, found.structure, rng),
            notes=[which],
        ),
        *residuals,
    ]
