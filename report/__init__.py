"""The only home of drawings, pages and prose.

In come the results of the rooms below (a study, a standard with its touches, a comparison, a
diagnosis, a whole design run), which carry numbers, enumerations and names. Out go sentences, PNG
pictures, and HTML pages that stand alone. Nothing is decided here: what is a number in a sentence
is a number in a result.

    style   paper, colours and labels of every picture
    effects what effects are called
    words   sentences, for pages and for the console
    identifiability
            what touches can know, in words and in result files
    task    uncertainty of a measuring task
    maps    sensitivities and volumetric error over a workspace or along a path
    plots   plans, proofs, residuals, effects
    scenes  pictures in three dimensions, rendered in a process of their own
    drawing the sheet for the workshop, PDF and SVG
    pages   HTML, one template a page in `pages/templates`
    compensation
            what compensation corrects and leaves, with its page
    drift   laws of a thermal drift beside one another, with their page

A new picture is a function that takes a result and a path (`maps`, `plots` or `scenes`) and is
called by the page that shows it; a new sentence is a function in `words`.
"""

from matstd.report.maps import draw_maps, draw_path
from matstd.report.pages import (
    Design,
    Proven,
    write_compare_page,
    write_design_page,
    write_diagnosis_page,
    write_study_page,
)
from matstd.report.plots import (
    draw_fall,
    draw_on_standard,
    draw_over_variables,
    write_order_picture,
    write_proof_picture,
    write_touches_picture,
)
from matstd.report.scenes import Scene, draw_standard, draw_volumes
from matstd.report.words import comparison_sentence, study_words, verdict_sentence

PARTS = (
    "style",
    "effects",
    "words",
    "geometry",
    "identifiability",
    "task",
    "maps",
    "plots",
    "scenes",
    "drawing",
    "pages",
    "compensation",
    "drift",
)
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "Design",
    "Proven",
    "Scene",
    "comparison_sentence",
    "draw_fall",
    "draw_maps",
    "draw_on_standard",
    "draw_over_variables",
    "draw_path",
    "draw_standard",
    "draw_volumes",
    "study_words",
    "verdict_sentence",
    "write_compare_page",
    "write_design_page",
    "write_diagnosis_page",
    "write_order_picture",
    "write_proof_picture",
    "write_study_page",
    "write_touches_picture",
]
