"""The whole sheet: three views, and everything else in the columns beside and below them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import Standard
from matstd.cad_out.details import Details, details_of, tolerances_of
from matstd.report.drawing.marks import (
    BELOW,
    Views,
    draw_axes,
    draw_cuts,
    draw_datums,
    draw_dimensions,
    draw_tolerances,
    large_face,
)
from matstd.report.drawing.sections import draw_face, draw_screw, draw_seat
from matstd.report.drawing.sheet import PAPERS, Block, Paper, Sheet, View, block_of
from matstd.report.drawing.tables import COLUMN, TITLE, Issuer, blocks_of, draw_title
from matstd.report.drawing.views import draw_from, draw_hole_names, draw_top
from matstd.twin.errors import NotBuildable
from matstd.twin.files import written_whole

DRAWING = ("drawing.pdf", "drawing.svg")  # names of the files
_SCALES = (2.0, 1.0, 0.5, 0.2, 0.1, 0.05)  # of ISO 5455
_SMALLEST = 0.5  # scale of the views below which the sheet is rather larger
_SECTIONS = (2.0, 1.0)  # scales of sections, the first that finds room
_LEFT, _ABOVE = 45.0, 34.0  # mm of paper: where the views begin, from the left and the upper edge
_APART, _BETWEEN = 34.0, 44.0  # mm between the views, side by side and one below the other
_DATUM_MARGIN = 26.0  # mm to the right of the view from the left, for the signs of datum A
_GAP = 4.0  # mm between blocks
_SIGNS = 14.0  # mm above the title block, for edges and surfaces


@dataclass
class _Column:
    """Free room, filled from above; mm of paper."""

    x: float
    width: float
    top: float
    low: float

    def take(self, block: Block, gap: float = 0.0) -> tuple[float, float] | None:
        """Left and upper edge of a block that finds room, in the middle of the column."""
        if block.width > self.width + 1e-9 or self.top - block.height < self.low:
            return None
        top, self.top = self.top, self.top - block.height - gap
        return self.x + 0.5 * (self.width - block.width), top


def write_drawing(folder: Path, standard: Standard, issuer: Issuer) -> None:
    """One sheet as PDF and SVG, the same bytes for the same standard."""
    import matplotlib

    sheet = draw_sheet(standard, details_of(standard), issuer)
    fixed: list[dict[str, Any]] = [{"CreationDate": None, "ModDate": None}, {"Date": None}]
    with matplotlib.rc_context({"svg.hashsalt": "matstd", "pdf.fonttype": 42}):
        for name, metadata in zip(DRAWING, fixed, strict=True):
            with written_whole(folder / name) as part:
                sheet.figure.savefig(part, format=name[-3:], metadata=metadata)


def draw_sheet(standard: Standard, details: Details, issuer: Issuer) -> Sheet:
    """Views, sections, tables, notes and title block on the smallest paper that holds them.

    Raises:
        NotBuildable: No paper up to A0 holds them.
    """
    blocks = blocks_of(standard, details, issuer.make)
    for paper, scale in _formats(standard):
        sheet, views = Sheet(paper), _views(paper, standard, scale)
        draw_from(sheet, views.front, standard, details, np.array([0.0, 1.0, 0.0]))
        draw_from(sheet, views.left, standard, details, np.array([1.0, 0.0, 0.0]))
        draw_top(sheet, views.top, standard, details)
        draw_dimensions(sheet, views, standard, standard.top)
        draw_datums(sheet, views, standard, details)
        draw_tolerances(sheet, views, standard, details)
        draw_axes(sheet, views.top)
        sections = _sections(sheet, views.top, standard, details)
        draw_hole_names(sheet, views.top, standard, details)
        if _fill(sheet, views, standard, sections, blocks):
            draw_title(sheet, standard, issuer, scale)
            return sheet
    raise NotBuildable(f"'{standard.name}' finds no room on a sheet of A0")


def _formats(standard: Standard) -> Iterable[tuple[Paper, float]]:
    """Papers and scales at which the views fit, the smallest paper first; small scales last."""
    (a, b), tall = standard.base.half_size, standard.top
    for scales in ([s for s in _SCALES if s >= _SMALLEST], [s for s in _SCALES if s < _SMALLEST]):
        for paper in PAPERS:
            wide = paper.width - _LEFT - _APART - _DATUM_MARGIN - COLUMN - 10.0
            high = paper.height - _ABOVE - _BETWEEN - BELOW - 10.0
            yield from (
                (paper, s) for s in scales if 2 * s * (a + b) <= wide and s * (tall + 2 * b) <= high
            )


def _views(paper: Paper, standard: Standard, scale: float) -> Views:
    a, b = standard.base.half_size
    floor = paper.height - _ABOVE - scale * standard.top
    front = View(_LEFT + scale * a, floor, scale)
    left = View(_LEFT + scale * (2 * a + b) + _APART, floor, scale)
    return Views(front, left, View(front.x, floor - _BETWEEN - scale * b, scale))


def _sections(
    sheet: Sheet, top: View, standard: Standard, details: Details
) -> list[Iterator[Block]]:
    """Sections with what they look like at every scale, the largest first, drawn when tried."""
    ball, hole = draw_cuts(sheet, top, standard, details)
    out: list[tuple[Callable[[Sheet, View], None], Iterable[float]]] = []
    if ball:
        out.append((partial(draw_seat, sphere=ball, standard=standard, details=details), _SECTIONS))
    if hole:
        out.append((partial(draw_screw, hole=hole, standard=standard, details=details), (1.0,)))
    face = large_face(standard)
    if face is not None:
        held = next(t for t in tolerances_of(standard, details) if t.face == face.name)
        draw_it = partial(draw_face, patch=face, standard=standard, tolerance=held)
        out.append((draw_it, (s for s in _SCALES if top.scale <= s <= 1.0)))
    return [map(block_of, scales, repeat(draw)) for draw, scales in out]


def _fill(
    sheet: Sheet,
    views: Views,
    standard: Standard,
    sections: list[Iterator[Block]],
    blocks: list[Block],
) -> bool:
    """Draws sections and tables in the free columns; whether all found room."""
    a, b = standard.base.half_size
    title = sheet.right - TITLE[0]
    top, scale = views.top, views.top.scale
    under = top.y - scale * b - BELOW
    right = _Column(sheet.right - COLUMN, COLUMN, sheet.high - 3.0, sheet.low + TITLE[1] + _SIGNS)
    x = top.x + scale * a + 18.0
    middle = _Column(x, title - _GAP - x, views.front.y - 30.0, sheet.low + 4.0)
    low = _Column(sheet.left + 4.0, x - sheet.left - 8.0, under, sheet.low + 4.0)
    placed: list[tuple[Block, tuple[float, float]]] = []
    for choices in sections:
        tried = ((one, column) for one in choices for column in (middle, low))
        found = next(((one, at) for one, c in tried if (at := c.take(one, 2 * _GAP))), None)
        if found is None:
            return False
        placed.append(found)
    columns = [right]
    for column, end in ((low, low.top), (middle, min(middle.top, under))):
        count = int((column.width + _GAP) / (COLUMN + _GAP))
        for k in range(count):
            left = column.x + k * (COLUMN + _GAP)
            columns.append(_Column(left, COLUMN, end, column.low))
    for block in blocks:
        # in order: what did not fit into a column goes on in the next
        while columns and not (place := columns[0].take(block)):
            columns.pop(0)
        if not columns or not place:
            return False
        placed.append((block, place))
    for block, at in placed:
        block.draw(sheet, *at)
    return True
