"""Tests for structure left in a residual: is it noise, and if not, what does it vary with?

Four kinds of test, of which each sees what the others miss: smooth functions of every recorded
variable and pair, in several directions; waves in time; neighbours in time and on the standard that
agree without any shape; gross errors that lie together. The probability of each is corrected for
the number of all, so that white noise is said to have structure once in a thousand runs.
"""

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import gammainc, ndtr

from matstd.diagnosis.evidence import EffectSet, Progress, ResidualSpace, quiet
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import PRIOR_DOF, shots
from matstd.diagnosis.residual.pattern_tests import PatternTests, TestedPattern
from matstd.diagnosis.residual.patterns import pairs, variables
from matstd.diagnosis.residual.waves import Wave, best_wave
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches

FEATURE_DISTANCE = 1e4
"""Distance (mm) by which different features are held apart in the search for neighbours."""

NEIGHBOURS = 5  # neighbours of a touch that are looked at
MIN_GROSS = 3  # fewer gross errors than this make no crowd


class Shape(Enum):
    """Kinds of patterns that are looked for."""

    SMOOTH = "smooth"
    WAVE = "wave"
    NEIGHBOURS = "neighbours"
    CROWD = "crowd"
    DRIVER = "unrecorded driver"


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """One test of a residual for one kind of pattern."""

    shape: Shape
    variables: tuple[str, ...]
    direction: str
    p_value: float  # probability in white noise, corrected for all the tests made
    share: float  # of the squared residual that it holds beyond chance
    evidence: float
    # projected features scaled to their most likely size, (N + P, K): a prior of one each; None for
    # tests that name no pattern
    columns: Array | None
    period: float = 0.0  # of a wave, s; zero for everything else
    law: str = ""  # of a driver that was not recorded: how it acts, as `thermal-expansion(Z)`


def find_structure(
    effects: EffectSet,
    progress: Progress = quiet,
    smooth: PatternTests | None = None,
    most: int = 12,
) -> list[Structure]:
    """Everything material that a residual varies with beyond chance, the most certain first.

    A smooth pattern has the score test of `PatternTests`; a wave in time is an F test, scanned over
    periods; two tests of neighbours (in time, on the standard) ask no shape at all; gross errors
    that lie together are no accidents.

    Args:
        smooth: Patterns freed of the same model, where other effects are looked at as well.
        most: Columns are returned for so many of the most certain.
    """
    complement = effects.complement
    if effects.objective <= 0.0:  # a run without any deviation at all
        return []
    smooth = smooth or PatternTests(complement)
    tested = smooth.of(effects)
    progress(0.6, "structure left")
    wave = best_wave(effects, complement.touches, smooth.rows)
    neighbours = [*_neighbours(effects), *_crowds(complement)]
    count = sum(len(t.p) for t in tested) + wave.count + len(neighbours)
    beyond = {_as_structure(t, count): t for t in tested if t.p.min() * count < POLICY.false_alarm}
    found = [
        *beyond,
        _wave_structure(effects, wave, count, smooth.rows),
        *(_corrected(n, count) for n in neighbours),
    ]
    counts = (
        f for f in found if f.p_value < POLICY.false_alarm and f.share > POLICY.material_share
    )
    found = sorted(counts, key=lambda f: f.p_value)
    progress(1.0, "structure left")
    first = [replace(f, columns=beyond[f].columns()) if f in beyond else f for f in found[:most]]
    return [*first, *found[most:]]


def _as_structure(tested: TestedPattern, count: int) -> Structure:
    """Best roughness of a pattern, its probability corrected for all tests."""
    return Structure(
        shape=Shape.SMOOTH,
        variables=tested.pattern.variables,
        direction=tested.pattern.direction,
        p_value=min(1.0, float(tested.p.min()) * count),
        share=tested.share,
        evidence=tested.evidence,
        columns=None,
    )


def _corrected(found: Structure, count: int) -> Structure:
    """With the number of tests paid for."""
    return replace(found, p_value=min(1.0, found.p_value * count))


def _wave_structure(effects: EffectSet, wave: Wave, count: int, rows: IntArray) -> Structure:
    """The best wave in time as a structure; its two amplitudes are as free as the data like."""
    n = effects.complement.count + PRIOR_DOF
    fall = -np.log(max(1.0 - wave.drop / effects.objective, 1e-9))
    gained = 0.5 * n * fall - np.log1p(wave.drop) - np.log(max(wave.count, 1))
    p = min(1.0, wave.p_value * count)
    return Structure(
        shape=Shape.WAVE,
        variables=("time_s",),
        direction=wave.direction,
        p_value=p,
        share=wave.drop * (len(effects.complement.u) / len(rows)) / effects.objective,
        evidence=float(gained),
        columns=effects.complement.project(wave.columns) if p < POLICY.false_alarm else None,
        period=wave.period,
    )


def _without_columns(shape: Shape, variables: tuple[str, ...], p: float, share: float) -> Structure:
    """A test that names no pattern."""
    return Structure(
        shape=shape,
        variables=variables,
        direction="normal",
        p_value=p,
        share=share,
        evidence=-np.inf,
        columns=None,
    )


def _neighbours(effects: EffectSet) -> list[Structure]:
    """Do neighbours agree: in time, and on the standard within one set-up?

    ``sum r_i r_j`` over pairs has the mean ``-sum q_i . q_j`` in white noise, because the fit makes
    residuals of neighbours slightly opposite, and nearly the variance of the number of pairs.
    """
    complement = effects.complement
    n = len(complement.u)
    touches = complement.touches[complement.used]
    r = effects.residual[:n] / np.sqrt(effects.objective / max(effects.dof, 1.0))
    Q = complement.Q[:n]
    out = []
    for names, left, right in _neighbour_pairs(touches):
        mean = -float(np.einsum("np,np->", Q[left], Q[right]))
        count = max(len(left), 1)
        common = float(r[left] @ r[right]) - mean
        p = float(ndtr(-common / np.sqrt(count)))
        # a neighbour that correlates by c explains c^2 of the square of a touch
        out.append(_without_columns(Shape.NEIGHBOURS, names, p, (common / count) ** 2))
    return out


def _crowds(complement: ResidualSpace) -> list[Structure]:
    """Do gross errors lie together? Accidents do not; a cause of its own does."""
    allowed = complement.used | complement.gross
    found = crowds(complement.touches, allowed, complement.gross)
    return [_without_columns(Shape.CROWD, names, p, 1.0) for names, p in found.items()]


def _neighbour_pairs(touches: Touches) -> list[tuple[tuple[str, ...], IntArray, IntArray]]:
    """Pairs of touches that follow each other, and that lie next to each other on the standard."""
    order = np.argsort(touches.time, kind="stable")
    out: list[tuple[tuple[str, ...], IntArray, IntArray]] = []
    if np.ptp(touches.time) > 0.0:
        out.append((("time_s",), order[:-1], order[1:]))
    label = np.unique(touches.feature, return_inverse=True)[1]
    tree = cKDTree(np.column_stack([touches.point, FEATURE_DISTANCE * label]))
    distance, index = tree.query(tree.data, k=2)
    near = np.sort(np.column_stack([np.arange(len(label)), index[:, 1]]), axis=1)
    # a touch repeated at one point may come first in its own list: it is no neighbour of itself
    near = np.unique(near[(distance[:, 1] < FEATURE_DISTANCE) & (near[:, 0] < near[:, 1])], axis=0)
    places = ("px_mm", "py_mm", "pz_mm")
    extents = np.ptp(touches.point, axis=0)
    names = tuple(p for p, extent in zip(places, extents, strict=True) if extent > 0.0)
    if len(near) and names:
        out.append((names, near[:, 0], near[:, 1]))
    return out


def crowds(touches: Touches, allowed: Mask, gross: Mask) -> dict[tuple[str, str], float]:
    """Probability, pair of variables by pair, that gross errors lie so close to one another.

    Counted are the pairs of gross errors that are among each other's nearest touches; if every
    touch is as likely a gross error as every other, that number is nearly Poisson distributed with
    the mean ``links g (g - 1) / (n (n - 1))``. Coordinates of one shot, which are left out
    together, count once. Not corrected for the number of pairs.

    Args:
        allowed: Those that could have been found out, (N,).
        gross: Those that were, (N,).
    """
    shot = shots(touches)
    rows = np.flatnonzero(allowed)
    rows = rows[np.unique(shot[rows], return_index=True)[1]]
    bad = np.isin(shot[rows], shot[gross])
    n, g = len(rows), int(bad.sum())
    known = variables(touches)
    out: dict[tuple[str, str], float] = {}
    if g < MIN_GROSS or n <= 2 * NEIGHBOURS:
        return out
    for names in pairs(touches, known):
        place = np.column_stack([known[name][rows] for name in names])
        place = (place - place.min(axis=0)) / np.ptp(place, axis=0)
        near = cKDTree(place).query(place, k=NEIGHBOURS + 1)[1]
        own = np.repeat(np.arange(n), NEIGHBOURS + 1)
        # a link either way is one number: a unique column is found ten times sooner than a pair
        links = np.unique(np.minimum(own, near.ravel()) * n + np.maximum(own, near.ravel()))
        low, high = links // n, links % n
        links = links[low < high]
        together = int((bad[low] & bad[high])[low < high].sum())
        mean = len(links) * g * (g - 1) / (n * (n - 1))
        out[names] = float(gammainc(together, mean)) if together else 1.0
    return out
