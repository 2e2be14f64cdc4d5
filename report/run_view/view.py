"""The live view as a page takes it: elements, style and script."""

from collections.abc import Mapping

from markupsafe import Markup

from matstd.diagnosis.answer import Comparison, Diagnosis
from matstd.diagnosis.geometry import LearntGeometry, Rung
from matstd.diagnosis.reduced import Board, compared_board, diagnosed_board
from matstd.report.layout import LiveView
from matstd.report.live import scripted, style
from matstd.report.run_view.run_data import run_data
from matstd.report.words import sizes

_PLACE = Markup(
    '<section id="live" class="live run" hidden '
    'aria-label="Effects to switch, residuals, errors"></section>'
)


def run_view(
    board: Board,
    title: str,
    set_up_alone: float | None = None,
    reported: Mapping[str, str] | None = None,
) -> LiveView:
    """The view of a run and its effects.

    Args:
        board: As `diagnosed_board` or `compared_board` makes it.
        title: Name of the run.
        set_up_alone: Held-out error without geometry, mm; None where it is not known.
        reported: Sizes of found effects by name, in words.
    """
    data = run_data(board, title, set_up_alone, reported or {})
    return LiveView(
        style=style(),
        place=_PLACE,
        script=scripted("run_page", data),
    )


def diagnosis_view(result: Diagnosis, title: str) -> LiveView:
    """Of a diagnosis: found effects on."""
    reported = {s.effect.name: sizes(s, most=2) for s in result.steps if s.effect is not None}
    return run_view(diagnosed_board(result), title, _set_up_alone(result.geometry), reported)


def comparison_view(found: Comparison, title: str) -> LiveView:
    """Of a comparison: no effect on."""
    return run_view(compared_board(found), title, _set_up_alone(found.geometry))


def _set_up_alone(geometry: LearntGeometry) -> float | None:
    """Held-out error before anything of the machine was fitted, mm."""
    return next((s.test_rms for s in geometry.ladder if s.rung is Rung.SETUP), None)
