"""Draws docs/architecture.svg: the rooms, and the records that go from one to the next.

python docs/draw_architecture.py [other.png]
"""

import sys
from pathlib import Path
from typing import Any

SVG = Path(__file__).with_name("architecture.svg")
INK, SOFT, ARROW = "#1c2430", "#5c6878", "#0072b2"

ROOMS = {
    # name: (x, y, width, height, colour, what happens there)
    "matstd": (0.0, 8.35, 15.0, 0.95, "#eef1f5", "the command line: wires the rooms, prints"),
    "report": (0.0, 6.95, 15.0, 0.95, "#eef1f5", "the only drawings, pages and sentences"),
    "cad_out": (11.7, 5.2, 3.3, 1.1, "#fbe3c8", "STEP and STL, measured"),
    "probe_paths": (5.6, 5.2, 5.6, 1.1, "#fbe3c8", "programs, and what a control's logs say"),
    "artefact": (5.6, 3.2, 9.4, 1.1, "#fbe3c8", "the standard, and where it is touched"),
    "compensation": (0.0, 5.2, 4.3, 1.1, "#d5e8d8", "the model goes back to a control"),
    "diagnosis": (0.0, 3.2, 4.3, 1.1, "#d5e8d8", "fit, find what the model lacks"),
    "information": (0.0, 1.6, 4.3, 0.95, "#dbe8f4", "what touches can know: criteria"),
    "nc": (4.6, 1.6, 2.4, 0.95, "#dbe8f4", "programs, read once"),
    "importers": (7.3, 1.6, 2.9, 0.95, "#dbe8f4", "tables of others as runs"),
    "sensitivity": (10.5, 1.6, 4.5, 0.95, "#dbe8f4", "where errors show; machines"),
    "twin": (0.0, 0.0, 15.0, 0.95, "#dbe8f4", "machines, touches, effects, files"),
}
ARROWS = (
    # from, to, record, where its name stands
    ((11.4, 0.95), (11.4, 1.6), "Chain", (11.55, 1.27)),
    ((3.6, 0.95), (3.6, 1.6), "Touches", (3.75, 1.27)),
    ((11.4, 2.55), (11.4, 3.2), "Population, Workspace", (11.55, 2.87)),
    ((4.1, 2.55), (5.75, 3.2), "Selection", (5.35, 2.87)),
    ((8.2, 2.55), (8.2, 3.2), "Sheet", (8.35, 2.87)),
    ((2.1, 2.55), (2.1, 3.2), "Posterior", (2.25, 2.87)),
    ((12.6, 4.3), (12.6, 5.2), "Standard", (12.75, 4.75)),
    ((6.7, 4.3), (6.7, 5.2), "Standard, Requests", (6.85, 4.75)),
    ((5.6, 5.35), (4.3, 4.1), "Run", (4.35, 4.95)),
    ((1.0, 4.3), (1.0, 5.2), "SavedModel", (1.15, 4.75)),
    ((2.1, 6.3), (2.1, 6.95), "Result, VerifiedTables", (2.25, 6.62)),
    ((12.6, 6.3), (12.6, 6.95), "Conformity", (12.75, 6.62)),
    ((6.7, 6.3), (6.7, 6.95), "TouchPlan, ProgramSet", (6.85, 6.62)),
    ((7.5, 7.9), (7.5, 8.35), "", (0.0, 0.0)),
)


def main() -> None:
    """Write the drawing."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "house", "font.size": 11}):
        drawn = Figure(figsize=(10.0, 6.4))
        axes = drawn.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(-0.2, 15.2), ylim=(-0.2, 9.5))
        axes.set_axis_off()
        for name, room in ROOMS.items():
            _room(axes, name, *room)
        for start, end, record, at in ARROWS:
            style = {"arrowstyle": "-|>", "color": ARROW, "lw": 1.8, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", end, start, arrowprops=style)
            axes.text(*at, record, color=ARROW, va="center", family="monospace", size=10)
        drawn.savefig(SVG, metadata={"Date": None})
        for other in sys.argv[1:]:
            drawn.savefig(other, dpi=110)


def _room(
    axes: Any, name: str, x: float, y: float, width: float, height: float, fill: str, words: str
) -> None:
    from matplotlib.patches import FancyBboxPatch

    style = "round,pad=0,rounding_size=0.12"
    axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle=style, fc=fill, ec=SOFT, lw=1.0))
    middle = (x + 0.5 * width, y + 0.5 * height)
    axes.text(middle[0], middle[1] + 0.12, name, ha="center", weight="bold", color=INK, size=12)
    axes.text(middle[0], middle[1] - 0.08, words, ha="center", va="top", color=INK, size=9.5)


if __name__ == "__main__":
    main()
