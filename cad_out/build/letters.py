"""Engraved lines as tools of the CAD kernel: every letter one prism."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from cad_out.details import DEPTH, HEIGHT, LINE, Lettering, strokes
from twin.frames import Array

_PROUD = 0.2  # mm that a tool stands out of the material
_LEAST = 0.02  # mm: shorter edges of an outline are left out


def engraved(lettering: Sequence[Lettering]) -> list[Any]:
    """What the engraving takes away."""
    from cad_out.build.primitives import raised

    tools = []
    for line in lettering:
        for loops in outlines(line):
            tools.append(raised(loops, line.T_artefact_text, -DEPTH, _PROUD))
    return tools


def outlines(line: Lettering) -> list[list[Array]]:
    """Every connected figure of a line of text: its outline and the holes in it, mm."""
    from manifold3d import CrossSection, FillRule, JoinType

    scale, figures = line.height / HEIGHT, []
    for stroke in strokes(line.text):
        places = scale * stroke
        for begin, end in pairwise(places):
            along = (end - begin) / np.linalg.norm(end - begin)
            across = 0.5 * LINE * np.array([-along[1], along[0]])
            begin, end = begin - 0.5 * LINE * along, end + 0.5 * LINE * along
            corners = [begin - across, end - across, end + across, begin + across]
            figures.append(CrossSection([np.array(corners)], FillRule.NonZero))
    if not figures:
        return []
    whole = CrossSection.compose([])
    for figure in figures:
        whole = whole + figure
    whole = whole.offset(-_LEAST, JoinType.Miter).offset(_LEAST, JoinType.Miter)
    whole = whole.simplify(_LEAST)
    return [[np.asarray(loop) for loop in part.to_polygons()] for part in whole.decompose()]
