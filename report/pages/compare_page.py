"""The page of a comparison: what a model leaves of a run, where, and what that varies with."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from matstd.diagnosis.answer import Comparison
from matstd.diagnosis.fit import Reported
from matstd.report.geometry import fault_sentences, geometry_section
from matstd.report.pages.page import write_page
from matstd.report.pages.residual_section import (
    Picture,
    gross_rows,
    pattern_pictures,
    region_rows,
    residual_pictures,
    setting,
)
from matstd.report.plots import draw_on_standard, is_spread
from matstd.report.words import comparison_sentence, learnt_lines, remark_sentence, structure_words
from matstd.twin.units import UM

PAGE = "report.html"
PICTURES = "pictures"


def write_compare_page(
    found: Comparison,
    folder: str | Path,
    title: str,
    rng: np.random.Generator,
    told: Mapping[str, Sequence[Reported]] | None = None,
) -> Path:
    """Draw the pictures of a comparison and write its page, which stands alone.

    Args:
        found: The comparison.
        folder: Where `report.html` and the folder `pictures` go.
        title: What was compared: the name of the run file.
        rng: Shuffles residuals, to show what chance looks like.
        told: Numbers of effects as the model file keeps them, by name.
    """
    folder = Path(folder)
    place = folder / PICTURES
    place.mkdir(parents=True, exist_ok=True)
    on_standard = []
    if is_spread(found.run.touches):
        draw_on_standard(place / "on_standard.png", (("measured minus predicted", found.fit),))
        on_standard.append(Picture("on_standard.png", "Touched points in the standard's frame."))
    z = found.normalised if found.is_prediction else None
    worst = found.worst
    write_page(
        folder / PAGE,
        "compare.html",
        place=place,
        title=title,
        found=found,
        sentence=comparison_sentence(found),
        faults=fault_sentences(found.faults),
        remarks=[remark_sentence(r) for r in found.remarks],
        where=region_rows(found.where),
        structure=[{"words": structure_words(s), "p": s.p_value} for s in found.structure],
        learnt_lines=learnt_lines(found.learnt, told or {}) if found.learnt else [],
        um=UM,
        on_standard=on_standard,
        pictures=residual_pictures(place, "residual", found.fit, z),
        patterns=pattern_pictures(place, found.fit, found.structure, rng),
        gross=gross_rows(found.fit),
        geometry=geometry_section(found.run.touches, found.geometry),
        worst_line=int(found.run.line[worst]),
        worst_um=float(found.residual[worst]) / UM,
        worst_normalised=float(found.normalised[worst]),
        replicates=found.fit.noise.replicates,
        replicates_dof=found.fit.noise.replicates_dof,
        **setting(found.run, found.fit),
    )
    return folder / PAGE
