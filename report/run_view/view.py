"""The live view as a page takes it: elements, style and script."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from markupsafe import Markup

from matstd.diagnosis.answer import Comparison, Diagnosis
from matstd.diagnosis.geometry import LearntGeometry, Rung
from matstd.diagnosis.laws import Learning
from matstd.diagnosis.reduced import Board, compared_board, diagnosed_board, learnt_board
from matstd.report.laws import LawCurve, law_curve, no_law_sentence, size_words
from matstd.report.layout import LiveView, Page, write_page
from matstd.report.live import scripted, style
from matstd.report.numbers import sentence
from matstd.report.run_view.run_data import Findings, run_data
from matstd.report.verdict import part_lines
from matstd.report.words import region_sentence, sizes, structure_words
from matstd.twin.files import write_whole
from matstd.twin.frames import Array


class Framed:
    """A live view that a notebook shows; `save` writes it as a page of its own."""

    def __init__(self, title: str, lead: str, view: LiveView) -> None:
        """Make the page of a view; arguments as of `Page`."""
        page = Page(heading=title, lead=lead, key=(), sections=(), live=view)
        with TemporaryDirectory() as folder:
            self.page = write_page(Path(folder) / "view.html", page).read_text(encoding="utf-8")

    def _repr_html_(self) -> str:
        """The page in a frame of its own, so that neither disturbs the other."""
        style = "width:100%;height:760px;border:0"  # a frame has no height of its own
        return f'<iframe srcdoc="{escape(self.page)}" style="{style}"></iframe>'

    def save(self, path: str | Path) -> Path:
        """Write the page."""
        write_whole(path, self.page)
        return Path(path)


PATTERNS_IN_VIEW = 2  # patterns of a residual that are named

_PLACE = Markup(
    '<section id="live" class="live run" hidden '
    'aria-label="Effects to switch, residuals, errors"></section>'
)


def run_view(
    board: Board, findings: Findings, curves: Mapping[str, Sequence[LawCurve]] | None = None
) -> LiveView:
    """The view of a run, with findings of the report and curves of laws by their names."""
    return LiveView(
        style=style(), place=_PLACE, script=scripted("run_page", run_data(board, findings, curves))
    )


def diagnosis_view(result: Diagnosis, title: str, body: Array | None = None) -> LiveView:
    """Of a diagnosis: found effects on, and laws that were learnt of what they leave.

    Args:
        body: Triangles of what was probed, where it is known.
    """
    laws = result.laws if result.laws is not None and result.laws.laws else None
    found = {s.effect.name: sizes(s, most=2) for s in result.steps if s.effect is not None}
    findings = Findings(
        title,
        set_up_alone=_set_up_alone(result.geometry),
        sizes=found if laws is None else found | _law_sizes(laws),
        remains=sentence(dict(part_lines(result))["what remains"]),
        body=body,
    )
    if laws is None:
        return run_view(diagnosed_board(result), findings)
    return run_view(learnt_board(laws, result.found), findings, _curves(laws))


def learnt_view(learning: Learning, title: str, body: Array | None = None) -> LiveView:
    """Of laws that were learnt: they are on, each with its curve over its variables."""
    remains = "" if learning.laws else no_law_sentence(learning)
    findings = Findings(title, sizes=_law_sizes(learning), remains=remains, body=body)
    return run_view(learnt_board(learning), findings, _curves(learning))


def _law_sizes(learning: Learning) -> dict[str, str]:
    return {one.law.name: size_words(learning, one.law) for one in learning.laws}


def _curves(learning: Learning) -> dict[str, list[LawCurve]]:
    """Of every law, over each of its variables; a surface is none over either of them."""
    laws = [one.law for one in learning.laws if not one.law.is_surface]
    return {law.name: [law_curve(learning, law, driver) for driver in law.drivers] for law in laws}


def comparison_view(found: Comparison, title: str, body: Array | None = None) -> LiveView:
    """Of a comparison: no effect on."""
    words = [*map(structure_words, found.structure), *map(region_sentence, found.where)]
    patterns = "; ".join(words[:PATTERNS_IN_VIEW])
    findings = Findings(
        title,
        set_up_alone=_set_up_alone(found.geometry),
        remains=sentence(patterns) if patterns else "Nothing beyond chance.",
        body=body,
        is_prediction=found.is_prediction,
    )
    return run_view(compared_board(found), findings)


def _set_up_alone(geometry: LearntGeometry) -> float | None:
    """Held-out error before anything of the machine was fitted, mm."""
    return next((s.test_rms for s in geometry.ladder if s.rung is Rung.SETUP), None)
