"""What a result shows of itself: a short text, and in a notebook a table with a picture.

The texts are registered in `matstd.twin.display` when this module is imported. For a new result,
register a text, and a picture if one says most.
"""

from collections.abc import Callable
from functools import singledispatch
from html import escape
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import Brief
from matstd.artefact.certify import CalibrationFit
from matstd.artefact.compare import IdentifiabilityReport
from matstd.diagnosis.answer import Comparison, Diagnosis
from matstd.diagnosis.files import SavedModel
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import Learning
from matstd.diagnosis.residual import rank_variables
from matstd.probe_paths.emit import Program, ProgramSet
from matstd.probe_paths.plan import TouchPlan
from matstd.probe_paths.stations import Station
from matstd.report.geometry import change_sentences
from matstd.report.identifiability import gist
from matstd.report.laws import law_sentence, no_law_sentence
from matstd.report.layout import picture
from matstd.report.maps import draw_regions
from matstd.report.numbers import microns, plural, sentence
from matstd.report.pages.design_result import Design
from matstd.report.pages.uncertainty_page import Budgets
from matstd.report.plots import draw_fall, draw_over_variables
from matstd.report.style import save
from matstd.report.task import calibration_lines
from matstd.report.words import comparison_sentence, features_words, study_words, verdict_sentence
from matstd.sensitivity.shares import regions
from matstd.sensitivity.study import Study
from matstd.twin.display import Displayed, Tabular, html, text
from matstd.twin.machine import Chain
from matstd.twin.model import Model
from matstd.twin.numbers import rms
from matstd.twin.record import Run
from matstd.twin.units import MINUTE

_ROWS = 10  # of a table that are shown; of the others their number


@text.register
def _run(run: Run) -> str:
    size = rms(run.deviation)
    poses = len(np.unique(run.touches.pose))
    return (
        f"{len(run)} touches at {poses} table poses of {run.touches.chain.name}, "
        f"deviations {microns(size)} rms, stated uncertainty {microns(float(np.median(run.u)))}"
    )


@text.register
def _fit(fit: Fit) -> str:
    return (
        f"{len(fit.model.effects)} effects fitted to {int(fit.used.sum())} touches: "
        f"{microns(fit.rms)} rms left, {microns(fit.test_rms)} rms of touches held out"
    )


text.register(Comparison, comparison_sentence)


@text.register
def _diagnosis(found: Diagnosis) -> str:
    """The verdict, and of several runs what changed between them."""
    changes = [] if found.trend is None else change_sentences(found.trend)
    return "\n".join([verdict_sentence(found), *(f"- {words}" for words in changes)])


text.register(Study, lambda study: "\n".join(study_words(study)))
text.register(IdentifiabilityReport, lambda known: f"{gist(known)}.")
text.register(Chain, lambda chain: f"{chain.name}: {chain.notation}")
text.register(CalibrationFit, lambda found: calibration_lines(found)[0])


@text.register
def _learning(learning: Learning) -> str:
    words = [sentence(law_sentence(learning, one)) for one in learning.laws]
    return "\n".join(words or [no_law_sentence(learning)])


@text.register
def _budgets(made: Budgets) -> str:
    return "\n- ".join([f"{made.task.name}: {made.sentence}", *made.lines])


@text.register
def _model(model: Model) -> str:
    return (
        f"model of {model.chain.name}: {len(model.effects)} effects, "
        f"{len(model.parameters)} parameters"
    )


@text.register
def _saved(saved: SavedModel) -> str:
    source = saved.source
    return f"{saved.model!r}, estimated from {source.touches} touches ({source.run})"


@text.register
def _standard(standard: Standard) -> str:
    state = "as designed" if standard.known is None else f"calibrated with {standard.known.source}"
    return f"{standard.name}: {features_words(standard)}, {state}"


@text.register
def _brief(brief: Brief) -> str:
    return (
        f"{brief.path.name}: {brief.options.name} for {brief.chain.name}, "
        f"programs for {Path(brief.programs.control).name}"
    )


@text.register
def _design(design: Design) -> str:
    standard, programs = design.standard, design.programs.programs
    where = "" if design.folder is None else f", in {design.folder}"
    return (
        f"{standard.name} for {design.brief.chain.name}: "
        f"{features_words(standard, design.placement.family)}, "
        f"{len(design.placement.touches)} touches, "
        f"{len(programs)} programs{where}"
    )


@text.register
def _plan(plan: TouchPlan) -> str:
    poses = len({visit.pose for visit in plan.visits})
    return (
        f"set-up {plan.setup.name}: {plural(len(plan), 'touch')} in "
        f"{plural(len(plan.visits), 'visit')} of {plural(poses, 'pose')}"
    )


@text.register
def _program(program: Program) -> str:
    minutes = f"about {program.duration / MINUTE:.0f} min"
    return f"{program.file}: {plural(program.touches, 'touch')}, {minutes}"


@text.register
def _programs(programs: ProgramSet) -> str:
    return "\n".join(map(text, programs.programs))


@text.register
def _station(station: Station) -> str:
    return f"{station.plan!r}, with tool {station.dialect.tool}\n{station.programs!r}"


@singledispatch
def drawing(result: object) -> Callable[[Path], None] | None:
    """What draws the picture of a result into a file; None where there is none."""
    return None


@drawing.register
def _over_variables(found: Comparison) -> Callable[[Path], None]:
    return lambda path: save(draw_over_variables(found.fit, rank_variables(found.fit)), path)


drawing.register(Diagnosis, lambda found: lambda path: save(draw_fall(found), path))


@drawing.register
def _regions(study: Study) -> Callable[[Path], None]:
    found = regions(study.population, study.workspace)
    return lambda path: save(draw_regions(study.chain, found), path)


@html.register
def _all_of(result: Displayed) -> str:
    """The text, the first rows of the table and the picture of a result."""
    parts = [f"<p>{escape(text(result)).replace(chr(10), '<br>')}</p>"]
    if isinstance(result, Tabular):
        parts.append(_table(result))
    draw = drawing(result)
    if draw is not None:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "result.png"
            draw(path)
            parts.append(f'<img src="{picture(path)}" style="max-width: 100%">')
    return "\n".join(parts)


def _table(result: Tabular) -> str:
    """The first rows, and how many there are."""
    columns = result.columns()
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    rows = [
        "<tr>" + "".join(f"<td>{escape(result.cell(value))}</td>" for value in row) + "</tr>"
        for row in islice(zip(*columns.values(), strict=True), _ROWS)
    ]
    count = len(next(iter(columns.values())))
    more = f"<caption>{_ROWS} of {count} rows</caption>" if count > _ROWS else ""
    return f"<table>{more}<tr>{head}</tr>{''.join(rows)}</table>"
