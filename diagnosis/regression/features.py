"""Touches of one feature that are off together: a face not cleaned, a chip, a wrong calibration.

An accident strikes a touch; dirt strikes a place of the standard. Touches of one feature, or of one
part of it, that lie off the prediction of all others by one amount are no accidents, whose number
is limited, and no law of the machine, which would not end where the feature or the part does.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression.linear import Solution
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches

MIN_OF_FEATURE = 10
"""Touches of a feature that is judged as a whole: a law of the machine displaces five by nearly one
amount. Of a smaller feature each touch stands out by itself, or none does."""

MIN_TOGETHER = 3  # gross errors of a feature that may be off together
MOST_OF_RUN = 0.4  # share of the touches that may be off with their features: most are right
MOST_FEATURES = 0.25  # share of the features, or one, that may be off: of more a law is the cause

LEAST_OFFSET = 5.0
"""Offset of a feature over the scatter of all touches from which it is named. Each of its touches
by itself then stands out; of a run with something hidden the scatter is large, and a feature that
something hidden displaces by less than this is left to the search."""

LEAST_SHARE = 0.8  # of the touches of a feature that must be off by more than half of its offset

MOST_SCATTER = 0.3
"""Standard deviation of touches that are off together, over their mean. It was 0.5 at the features
that a law of the machine displaced, and 0.02 at a face with a film of 25 um."""

NEAREST = 2
"""Touches of the feature next to a gross error, of which at least half must be gross errors, too:
beside those on a chip two thirds and more were, one in six where a cable of the machine pulled in
some of the poses."""


def robust_scale(values: Array) -> float:
    """Standard deviation by the median of the absolute values; immune to a tenth of outliers."""
    return float(1.4826 * np.median(np.abs(values))) if len(values) else 0.0


@dataclass(frozen=True, eq=False)
class Features:
    """What every touch is of, and where on the standard."""

    number: IntArray  # of the feature, in every run another; negative for none, (N,)
    point: Array  # of the artefact frame, mm, (N, 3)

    @classmethod
    def of(cls, touches: Touches) -> "Features":
        """Those of a run; none where no ball touches a standard."""
        own = np.unique(touches.feature, return_inverse=True)[1]
        each = np.unique(np.column_stack([touches.run, own]), axis=0, return_inverse=True)[1]
        is_known = touches.instrument.is_ball_on_standard & (touches.feature != "")
        return cls(np.where(is_known, each.ravel(), -1), touches.point)

    def is_place(self, rows: Mask, among: Mask) -> bool:
        """Whether rows of one feature are those of a place on it."""
        near = cKDTree(self.point[among]).query(self.point[rows], k=NEAREST + 1)[1]
        return float(rows[among][near].mean() * (NEAREST + 1) - 1) >= 0.5 * NEAREST


@dataclass(frozen=True, eq=False)
class Offsets:
    """Features that lie off as a whole."""

    rows: Mask  # their touches, (N,)
    half: Array  # half of the offset of each, (N,); zero elsewhere

    def still(self, out: Mask, features: Features) -> "Offsets":
        """Those of which nearly all touches are out."""
        own = features.number
        each = [self.rows & (own == f) for f in np.unique(own[self.rows])]
        kept = [rows for rows in each if out[rows].mean() >= LEAST_SHARE]
        return Offsets(np.logical_or.reduce([*kept, np.zeros_like(out)]), self.half)


def whole_features(rest: Array, fit: Solution, allowed: Mask, features: Features) -> Offsets:
    """Features whose touches nearly all lie off by one amount, one after the other.

    With ``A = 1 - Q Q^T`` and a column c that is one at the touches of a feature, the offset that
    the others leave it is ``c^T r / c^T A c``, with the standard uncertainty
    ``s (c^T A c)^-1/2``; s is the scatter of the others, for the degrees of freedom that are left:
    a model of as many parameters as touches leaves nearly none of it. The most certain is taken
    into the fit, and the next one is looked for.

    Args:
        rest: Observed minus predicted, whitened, (N,).
        fit: To all rows that may be used.
        allowed: Those rows, (N,).
    """
    rows, half = np.zeros(len(rest), dtype=bool), np.zeros(len(rest))
    label, Q, r = features.number[allowed], fit.Q, rest[allowed]
    names, count = np.unique(label[label >= 0], return_counts=True)
    left, freed = set(names[count >= MIN_OF_FEATURE].tolist()), np.sqrt(len(r) / max(fit.dof, 1.0))
    while left:
        each = {f: _freed(label == f, Q, r) for f in left}
        best = max(left, key=lambda f: abs(each[f][1]))
        (c, moved, length), own = each[best], label == best
        after = r - moved * c
        size, scale = abs(moved) / length, freed * robust_scale(after[~own])
        is_certain = min(size, abs(moved)) > LEAST_OFFSET * scale > 0.0
        is_most = float(np.mean(np.abs(after[own]) < 0.5 * size)) >= LEAST_SHARE
        if not (is_certain and is_most) or robust_scale(after[own]) > MOST_SCATTER * size:
            break
        here = np.flatnonzero(allowed)[own]
        rows[here], half[here] = True, 0.5 * size
        Q, r = np.column_stack([Q, c]), after
        left.remove(best)
    of = len(np.unique(features.number[rows]))
    is_law = of > max(1.0, MOST_FEATURES * len(names)) or rows.sum() > MOST_OF_RUN * len(r)
    return Offsets(rows & (not is_law), half)


def _freed(own: Mask, Q: Array, r: Array) -> tuple[Array, float, float]:
    """Column ``A c / l`` of some rows, (n,), what it takes of a residual, ``c^T r / l``, and l.

    Its length is ``l^2 = c^T A c``; one that a model imitates has none.
    """
    c = own - Q @ Q[own].sum(axis=0)
    length = max(float(np.sqrt(max(c[own].sum(), 0.0))), 1e-9)
    return c / length, float(r[own].sum()) / length, length


def together(out: Mask, allowed: Mask, error: Array, features: Features) -> Mask:
    """Gross errors of one size on one place of a feature, more than accidents would be, (N,).

    Args:
        out: Gross errors, (N,).
        allowed: Rows that may be used at all, (N,).
        error: Left-out prediction error of every row, (N,).
    """
    found, number = np.zeros(len(out), dtype=bool), features.number
    names, count = np.unique(number[out & (number >= 0)], return_counts=True)
    for f in names[count >= MIN_TOGETHER]:
        own, among = out & (number == f), allowed & (number == f)
        is_alike = float(np.std(error[own])) < MOST_SCATTER * abs(float(np.mean(error[own])))
        if is_alike and features.is_place(own, among):
            p = _chance(int(allowed.sum()), int(among.sum()), int(out.sum()), int(own.sum()))
            if p * len(np.unique(number[allowed])) < POLICY.false_alarm:
                found |= own
    return found


def _chance(touches: int, here: int, gross: int, found: int) -> float:
    """Probability that of some gross errors anywhere so many or more meet one feature."""
    from scipy.stats import hypergeom  # half a second, and few runs need it

    return float(hypergeom.sf(found - 1, touches, here, gross))
