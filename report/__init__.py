"""The only home of drawings, pages and prose.

In come the results of the rooms below (a study, a standard with its touches, a comparison, a
diagnosis, a whole design run), which carry numbers, enumerations and names. Out go sentences, PNG
pictures, and HTML pages that stand alone. Nothing is decided here: every number in a sentence is a
number in a result.

A new picture is a function from a result to a figure (`maps`, `plots`); a section of a page lists
it with its caption. A new sentence is a function in `words`.
"""

PARTS = {
    "style": "paper, colours and labels of every picture",
    "layout": "sections of a page, and how they become HTML, CSV and PDF",
    "live": "data and scripts of pages that move",
    "effects": "titles of effects",
    "laws": "laws that were learnt, with their page and their Python file",
    "words": "sentences, for pages and for the console",
    "geometry": "geometry of the machine, mistakes in its description",
    "verdict": "the three parts of a verdict, and what results mean for the machine",
    "identifiability": "what touches can determine, in words and in result files",
    "task": "calibration of a standard, uncertainty of a measuring task",
    "maps": "sensitivities and volumetric error over a workspace or along a path",
    "plots": "plans, proofs, residuals, effects",
    "run_view": "the live view of a run: effects to switch, and the error with them",
    "scenes": "pictures in three dimensions, rendered in a process of their own",
    "machine": "a machine that moves, with its errors and a program, on a page",
    "design_view": "what moves on the page of a design",
    "drawing": "the sheet for the workshop, PDF and SVG",
    "pages": "the pages: results as lists of sections",
    "compensation": "what compensation corrects and what remains, with its page",
    "drift": "laws of a thermal drift, with their page",
    "charts": "control charts of a machine over several runs, with their page",
}
"""What each part has, from bottom to top: each imports only from those before it."""
