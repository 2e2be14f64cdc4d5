"""Pictures of the proof: error before and after, pose by pose, and over the number of touches."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from matstd.artefact.worth import TouchCurve
from matstd.diagnosis.accuracy import Proof
from matstd.report.style import BLUE, INK, RED, SOFT, Figure, figure, plain, series
from matstd.twin.units import UM

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


def draw_proof(proofs: Sequence[Proof]) -> Figure:
    """Distributions of |error| before and after, and after against its stated uncertainty."""
    drawn = figure(4.0)
    left, right = drawn.subplots(1, 2, width_ratios=(1.5, 1.0))
    edges = np.geomspace(0.05, 1000.0, 81)
    for k, proof in enumerate(proofs):
        for vectors, colour, word in (
            (proof.before, RED, "without a model"),
            (proof.after, BLUE, "not predicted by the identified model"),
        ):
            size = np.linalg.norm(vectors, axis=1) / UM
            left.hist(
                size,
                edges,
                histtype="stepfilled",
                color=colour,
                alpha=0.28,
                label=word if k == 0 else None,
            )
            rms = np.sqrt(np.mean(size**2))
            left.axvline(rms, color=colour, lw=1.2)
    left.set_xscale("log")
    left.set_xlabel("volumetric error at a pose in µm (lines: root mean square)")
    left.set_ylabel("poses")
    drawn.legend(
        *left.get_legend_handles_labels(),
        fontsize=8.5,
        loc="outside lower left",
        ncols=2,
        frameon=False,
    )
    left.set_title(f"{len(proofs)} random machine{'s' * (len(proofs) > 1)}", loc="left")
    _uncertainty(right, proofs)
    plain(left)
    return drawn


def _uncertainty(ax: Any, proofs: Sequence[Proof]) -> None:
    """Unpredicted error over its stated standard uncertainty, cumulated."""
    for k, proof in enumerate(proofs):
        ratio = np.sort(np.linalg.norm(proof.after, axis=1) / proof.u)
        share = np.arange(1, len(ratio) + 1) / len(ratio)
        ax.plot(ratio, 100.0 * share, lw=1.4, color=series(k), label=f"machine {k + 1}")
    ax.axvline(2.0, color=SOFT, lw=0.8, ls="--")
    ax.set_xlim(0.0, 4.0)
    ax.set_ylim(0.0, 101.0)
    ax.set_xlabel("unpredicted error over its stated standard uncertainty")
    ax.set_ylabel("poses in %")
    ax.set_title("check of the stated uncertainty", loc="left")
    ax.legend(fontsize=8, loc="lower right", frameon=False)
    plain(ax)
