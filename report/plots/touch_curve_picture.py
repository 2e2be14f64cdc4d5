"""Picture of the error left against the number of touches, for several artefacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matstd.artefact.worth import TouchCurve
from matstd.report.style import INK, figure, plain, series
from matstd.twin.units import UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MARKERS = "osD^vPX*"
_NOT_A_BODY = "ideal"  # first word of scatter without a body: dashed


def draw_touch_curves(curves: Sequence[TouchCurve], noise: float) -> Figure:
    """Curves on logarithmic scales, the value at the designed number marked."""
    drawn = figure(4.4)
    left, right = drawn.subplots(1, 2, sharey=True)
    for axes, title, user in ((left, "your workspace", True), (right, "probed volume", False)):
        for k, curve in enumerate(curves):
            _curve(axes, k, curve, (curve.rms_user if user else curve.rms) / UM)
        axes.set(xscale="log", yscale="log", xlabel=f"touches of {noise / UM:.3g} µm noise")
        axes.set_title(title, loc="left", fontsize=10.5, color=INK)
        plain(axes)
    left.set_ylabel("unpredicted tool point error in µm rms")
    handles, labels = left.get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return drawn


def _curve(axes: Any, k: int, curve: TouchCurve, values: Any) -> None:
    """One artefact; a mark at the number of touches it was designed with."""
    own = k == 0
    axes.plot(
        curve.counts,
        values,
        marker=_MARKERS[k % len(_MARKERS)],
        markevery=[curve.counts.index(curve.designed)],
        ms=9 if own else 6.5,
        markeredgecolor="white",
        color=series(k),
        lw=2.6 if own else 1.5,
        ls="--" if curve.name.startswith(_NOT_A_BODY) else "-",
        zorder=5 if own else 3,
        label=curve.name,
    )
