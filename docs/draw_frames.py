"""Draws docs/frames.svg: frames, positive readings and the sign of a touch.

    python docs/draw_frames.py [other.png]

The machine is the one of the worked examples, [w C' B' X' f Y Z (C1) t], seen against -y.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np

SVG = Path(__file__).with_name("frames.svg")
GREY, GREY_LINE = "#d9d9d9", "#6b6b6b"
WORK, WORK_DARK, WORK_LINE = "#fbd9b5", "#f4b877", "#b45f06"
TOOL, TOOL_DARK, TOOL_LINE = "#cfe2f3", "#9fc5e8", "#0b5394"
STEEL = "#b6c2b0"
BLACK = "#111111"
RED = "#b00020"

TABLE, GAUGE, BALL, B_LINE, ARTEFACT = -500.0, -130.0, -290.0, -420.0, (-105.0, -500.0)
RADIUS = 15.0  # of the ball, drawn five times too large


def _box(axes: Any, x: float, z: float, width: float, height: float, face: str, line: str) -> None:
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((x, z), width, height, fc=face, ec=line, lw=1.0))


def _arrow(
    axes: Any, start: tuple[float, float], end: tuple[float, float], color: str, **more: Any
) -> None:
    style = {"arrowstyle": "-|>", "color": color, "lw": 1.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", end, start, arrowprops=style | more, zorder=6)


def _turn(
    axes: Any,
    centre: tuple[float, float],
    radii: tuple[float, float],
    degrees: tuple[float, float],
    color: str,
) -> None:
    """Arc with its head at the second angle, counter-clockwise positive on paper."""
    angle = np.radians(np.linspace(*degrees, 60))
    x, z = centre[0] + radii[0] * np.cos(angle), centre[1] + radii[1] * np.sin(angle)
    axes.plot(x[:-2], z[:-2], color=color, lw=1.8, zorder=6, solid_capstyle="butt")
    _arrow(axes, (x[-6], z[-6]), (x[-1], z[-1]), color, lw=0, mutation_scale=14)


def _into_page(axes: Any, x: float, z: float, color: str, size: float = 11.0) -> None:
    from matplotlib.patches import Circle

    axes.add_patch(Circle((x, z), size, fc="white", ec=color, lw=1.3, zorder=7))
    d = size * 0.7
    for s in (1.0, -1.0):
        axes.plot([x - d, x + d], [z - s * d, z + s * d], color=color, lw=1.3, zorder=8)


def _frame(axes: Any, x: float, z: float, size: float = 50.0) -> None:
    """Axes of a frame: x to the right, z up, y into the page."""
    _arrow(axes, (x, z), (x + size, z), BLACK, lw=1.5, mutation_scale=11)
    _arrow(axes, (x, z), (x, z + size), BLACK, lw=1.5, mutation_scale=11)
    axes.text(x + size - 6, z - 17, "x", ha="center", va="center", style="italic", zorder=8)
    axes.text(x - 14, z + size - 8, "z", ha="center", va="center", style="italic", zorder=8)
    _into_page(axes, x, z, BLACK, 8.0)


def _note(axes: Any, text: str, at: tuple[float, float], to: tuple[float, float], **k: Any) -> None:
    """Text with a thin line to what it speaks of."""
    line = {"arrowstyle": "-", "color": "0.45", "lw": 0.8, "shrinkA": 2, "shrinkB": 0}
    k = {"ha": "left", "va": "center", "zorder": 8} | k
    axes.annotate(text, to, at, arrowprops=line, **k)


def _bodies(axes: Any) -> None:
    """Foundation, workpiece side and tool side."""
    from matplotlib.patches import Circle, Polygon

    _box(axes, -400, -820, 800, 70, GREY, GREY_LINE)
    _box(axes, 310, -750, 90, 960, GREY, GREY_LINE)
    _box(axes, -280, -750, 500, 55, WORK_DARK, WORK_LINE)
    foot = [(-75, -695), (75, -695), (55, -640), (-55, -640)]
    axes.add_patch(Polygon(foot, fc=WORK_DARK, ec=WORK_LINE))
    angle = np.radians(np.linspace(205.6, 334.4, 60))
    cradle = np.column_stack([250 * np.cos(angle), B_LINE + 250 * np.sin(angle)])
    axes.add_patch(Polygon(cradle, fc=WORK, ec=WORK_LINE))
    _box(axes, -190, -528, 380, 28, WORK_DARK, WORK_LINE)
    x = np.linspace(-180, 20, 80)
    top = BALL - RADIUS - 40 * ((x + 6) / 170) ** 2 + 10 * np.sin((x + 6) / 22) * (x < -6)
    outline = [(-180, TABLE), *zip(x, top, strict=True), (20, TABLE)]
    axes.add_patch(Polygon(outline, fc=STEEL, ec="#4b5b45", lw=1.0))
    _box(axes, 48, 60, 262, 110, TOOL_DARK, TOOL_LINE)
    _box(axes, -48, GAUGE, 96, 340, TOOL, TOOL_LINE)
    _box(axes, -22, GAUGE - 60, 44, 60, TOOL_DARK, TOOL_LINE)
    axes.plot([0, 0], [GAUGE - 60, BALL], color=TOOL_LINE, lw=3)
    axes.add_patch(Circle((0, BALL), RADIUS, fc=RED, ec="#7a0016", zorder=5))
    _into_page(axes, 0, B_LINE, WORK_LINE)


def _readings(axes: Any) -> None:
    """Which way each body goes for a growing reading."""
    _arrow(axes, (-170, -723), (-262, -723), WORK_LINE)
    axes.text(-158, -723, "X+", color=WORK_LINE, va="center", weight="bold")
    _turn(axes, (0, B_LINE), (200, 200), (286, 318), WORK_LINE)
    axes.text(46, -610, "B+", color=WORK_LINE, ha="right", va="center", weight="bold")
    _turn(axes, (0, -508), (205, 30), (325, 215), WORK_LINE)
    axes.text(200, -512, "C+", color=WORK_LINE, va="center", weight="bold")
    _arrow(axes, (-78, 40), (-78, 132), TOOL_LINE)
    axes.text(-78, 146, "Z+", color=TOOL_LINE, ha="center", va="bottom", weight="bold")
    _into_page(axes, 180, 115, TOOL_LINE)
    axes.text(200, 115, "Y+", color=TOOL_LINE, va="center", weight="bold")
    _turn(axes, (0, -178), (44, 12), (215, 325), TOOL_LINE)
    axes.text(50, -196, "C1+", color=TOOL_LINE, va="center", weight="bold")


def machine(axes: Any) -> None:
    """The machine with its four frames."""
    _bodies(axes)
    _readings(axes)
    for x, z in ((0.0, 0.0), (0.0, GAUGE), (0.0, TABLE), ARTEFACT):
        _frame(axes, x, z)
    left, right = -440, 95
    _note(
        axes,
        "machine frame: where the\ngauge point stands with\nevery axis at zero",
        (left, 10),
        (-9, 2),
    )
    _note(axes, "tool frame: at the gauge\npoint, z from tip to spindle", (left, -120), (-9, GAUGE))
    _note(axes, "ball centre: (0, 0, -L)\nin the tool frame", (left, -240), (-16, BALL))
    _note(axes, "artefact frame:\nin the table frame\nby the set-up", (left, -400), (-113, -496))
    _note(axes, "table frame:\n[workpiece] origin,\ngoes with the table", (right, -440), (8, -495))
    _note(axes, "line of B", (right, -340), (11, B_LINE + 4))
    _note(axes, "standard", (left, -320), (-174, -350))
    axes.text(0, -787, "f, the foundation", color=GREY_LINE, ha="center", va="center")
    words = (
        "Arrows: where a body goes while its reading grows. A reading moves the\n"
        "tool relative to the workpiece: the bodies of C', B' and X' go the other way."
    )
    axes.text(left, 255, words, va="center")
    axes.set(xlim=(-445, 405), ylim=(-830, 290), aspect="equal", anchor="N")
    axes.axis("off")


def touch(axes: Any) -> None:
    """Nominal and real ball at the trigger, and what comes out as the deviation."""
    from matplotlib.patches import Circle, Polygon

    x = np.linspace(-2.6, 2.6, 80)
    top = -0.06 * x**2
    axes.add_patch(Polygon([(-2.6, -1.9), *zip(x, top, strict=True), (2.6, -1.9)],
                           fc=STEEL, ec="#4b5b45"))  # fmt: skip
    axes.add_patch(Circle((0, 1), 1, fc="none", ec=RED, lw=1.8, zorder=4))
    axes.add_patch(Circle((-0.35, 0.25), 1, fc="none", ec=RED, lw=1.4, ls=(0, (4, 3)), zorder=4))
    axes.plot([0, -0.35], [1, 0.25], "o", color=RED, ms=4, zorder=6)
    _arrow(axes, (-0.35, 0.25), (0, 1), RED)
    axes.text(-0.3, 0.78, "δ", color=RED, size=13, ha="right")
    _arrow(axes, (0, 0), (0, 2.75), BLACK)
    axes.text(0.1, 2.6, "n", size=13, weight="bold")
    axes.plot(0, 0, "o", color=BLACK, ms=5, zorder=6)
    axes.text(0.12, -0.3, "p", size=13, weight="bold")
    for z in (0.0, -0.75):
        axes.plot([0.2 if z == 0 else -0.3, 1.4], [z, z], color="0.4", lw=0.8, zorder=3)
    _arrow(axes, (1.25, 0), (1.25, -0.75), BLACK, lw=1.3)
    axes.text(1.35, -0.42, "dev < 0", va="center", weight="bold")
    _note(axes, "where the ball is:\nit touches", (1.2, 2.2), (0.72, 1.69))
    _note(axes, "where the readings\nput it", (-3.0, 1.95), (-1.1, 0.92))
    formula = "dev = n · (nominal centre − p) − radius\n= −n · δ + n · shift + bias"
    axes.text(0, -2.6, formula, ha="center", va="center", size=11.5)
    words = (
        "δ: where the ball is minus where the readings\nput it, relative to the table;\n"
        "shift: of the standard;  bias: of the probe.\n"
        "Positive: the control sees the surface\noutside its calibrated place."
    )
    axes.text(0, -4.0, words, ha="center", va="center")
    axes.set(xlim=(-2.85, 3.0), ylim=(-4.8, 3.2), aspect="equal", anchor="N")
    axes.axis("off")


def error(axes: Any) -> None:
    """A component error of a workpiece-side axis: tool side minus workpiece side."""
    from matplotlib.patches import Rectangle

    _box(axes, -2.6, -1.0, 5.2, 0.5, GREY, GREY_LINE)
    _box(axes, -1.75, -0.5, 2.6, 0.7, WORK_DARK, WORK_LINE)
    nominal = Rectangle((-1.1, -0.5), 2.6, 0.7, fc="none", ec=WORK_LINE, ls=(0, (4, 3)), zorder=4)
    axes.add_patch(nominal)
    axes.plot([0.2, 0.2], [0.95, 0.28], color=TOOL_LINE, lw=3, solid_capstyle="butt")
    axes.plot([0.2, 0.2], [0.28, 0.2], color=RED, lw=3, solid_capstyle="butt")
    axes.plot([-0.45, -0.45], [0.2, 0.55], color=WORK_LINE, lw=1.0)
    _arrow(axes, (-0.45, 0.45), (0.2, 0.45), BLACK, lw=1.5)
    axes.text(-0.6, 0.5, "EXX > 0", ha="right", va="center", weight="bold")
    axes.text(1.75, -0.15, "nominal\n(dashed)", color=WORK_LINE, va="center")
    words = (
        "The workpiece stands too far in −x: the tool,\nseen from it, too far in +x.\n"
        "δ = e + r × (x − c) for an error (e, r) of any\naxis, on either side of f."
    )
    axes.text(0, -1.95, words, ha="center", va="center")
    axes.set(xlim=(-2.85, 3.0), ylim=(-2.6, 1.1), aspect="equal", anchor="N")
    axes.axis("off")


def main() -> None:
    """Draw the machine beside the two signs."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    mpl.rcParams |= {"svg.hashsalt": "frames", "font.size": 9.5, "svg.fonttype": "path"}
    figure, parts = plt.subplot_mosaic(
        [["machine", "touch"], ["machine", "error"]],
        figsize=(10.6, 7.7), width_ratios=(1.66, 1.0), height_ratios=(8.0, 4.1),
        layout="constrained",
    )  # fmt: skip
    titles = {
        "machine": "[w C' B' X' f Y Z (C1) t]",
        "touch": "the deviation of a touch",
        "error": "an error: tool side minus workpiece side",
    }
    for name, draw in (("machine", machine), ("touch", touch), ("error", error)):
        draw(parts[name])
        parts[name].set_title(titles[name], weight="bold", size=11.5)
    figure.savefig(SVG, metadata={"Date": None})
    for other in sys.argv[1:]:
        figure.savefig(other, dpi=110)


if __name__ == "__main__":
    main()
