"""Sentences on a study: sampling, volumetric error, dominant errors."""

from collections.abc import Sequence

import numpy as np

from matstd.sensitivity.montecarlo import Stability, Volumetric
from matstd.sensitivity.shares import Part, Place, Region
from matstd.sensitivity.study import Study
from matstd.twin.units import DEG, UM

_SHOWN = 5  # parameters with the largest shares


def study_words(study: Study) -> list[str]:
    """The study in a few lines."""
    v = study.volumetric
    lines = [
        sampling_words(v),
        f"volumetric error over {len(study.q)} poses: mean {v.mean.mean() / UM:.1f} µm, "
        f"P95 {v.p95.mean() / UM:.1f} µm, P95 at the worst pose {v.p95.max() / UM:.1f} µm",
    ]
    if v.tolerance < float("inf"):
        lines.append(
            f"more than {v.tolerance / UM:g} µm: on average {v.exceedance.mean():.1%} "
            f"of the machines, {v.exceedance.max():.1%} at the worst pose"
        )
    ranked = ", ".join(f"{name} {share:.1%}" for name, share in study.ranking()[:_SHOWN])
    lines.append(f"largest shares of the variance: {ranked}")
    return lines


def unsampled(study: Study) -> str:
    """Note beside a volumetric error that was not sampled."""
    mean, worst = study.tail
    return (
        "Computed to first order for normally distributed errors, without sampling; the 95 % "
        f"quantile sampled at {len(study.q)} poses differs by {100.0 * mean:+.1f} % on average, "
        f"{100.0 * worst:+.1f} % at worst."
    )


def sampling_words(v: Volumetric) -> str:
    """Note beside every Monte Carlo figure: draws, seed, precision."""
    words = (
        f"{v.draws} random machines, seed {v.seed}, mean and P95 to "
        f"± {v.achieved / UM:.2g} µm (95 %) at every pose"
    )
    return words if v.stability is None else f"{words}; {stability_words(v.stability)}"


def stability_words(stability: Stability) -> str:
    """Whether the requested number of digits is stable."""
    found = (
        f"{stability.digits} significant digits of the standard deviation after "
        f"{stability.batches} batches (JCGM 101, 7.9.4)"
    )
    if stability.is_stable:
        return f"stable to {found}"
    if not np.isfinite(stability.ratio):
        return f"NOT shown to be stable to {found}: one batch is no evidence"
    return f"NOT stable to {found}: {stability.ratio:.2g} times the tolerance"


def place_words(place: Place) -> str:
    """`corners: X, Y and Z in their outer sixths`, `B from 20° to 30°`, `C within 15° of 90°`."""
    letters = ", ".join(place.axes[:-1]) + (" and " if len(place.axes) > 1 else "")
    letters += "".join(place.axes[-1:])
    low, high = (limit / DEG for limit in place.limits)
    return {
        Part.WHOLE: "whole workspace",
        Part.MIDDLE: f"middle: {letters} in their middle third",
        Part.CORNERS: f"corners: {letters} in their outer sixths",
        Part.END: f"{letters} from {low:.0f}° to {high:.0f}°",
        Part.AROUND: f"{letters} within {0.5 * (high - low):.0f}° of {0.5 * (low + high):.0f}°",
    }[place.part]


def dominant_words(region: Region, names: Sequence[str], enough: float = 0.5) -> str:
    """Errors that together cause a share of `enough` of the deviation in a region."""
    shares = region.mean_shares
    order = region.largest(len(shares))
    if not order:
        return f"{place_words(region.place)}: no error displaces the tool point."
    count = int(np.searchsorted(np.cumsum(shares[order]), enough)) + 1
    kept = order[:count]
    if count == 1:
        return f"{names[kept[0]]} causes {100.0 * shares[kept[0]]:.0f} % of the variance"
    named = ", ".join(f"{names[i]} {100.0 * shares[i]:.0f} %" for i in kept)
    return f"{named}: together {100.0 * shares[kept].sum():.0f} % of the variance"
