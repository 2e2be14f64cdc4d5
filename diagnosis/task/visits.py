"""Repeated visits to the same places on calibrated features, seen from where the standard stands.

Datum features place the standard in every visit, as a workpiece is placed by its own; what is
measured on the others is the deviation of a surface, as a user would measure it. A model takes off
what it predicts first.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Prior, fit_run
from matstd.twin.effects import body_errors, placing_errors
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Model, columns
from matstd.twin.record import Labels, Run, Touches
from matstd.twin.units import DEG

MIN_PLACES = 8
"""Places below which nothing is said of a task: their spread has too few degrees of freedom."""

_VISIT_SPACING = 1.0  # mm on the surface between visits to one place: touches stand several apart
_VISIT_TURN = 6.0 * DEG  # between rotary readings of such visits: a standard may be clamped 5 aside


@dataclass(frozen=True, eq=False)
class Visits:
    """Deviations of J places in n visits."""

    # measured beyond what a model predicts, the standard placed by its datum features, (n, J), mm
    deviation: Array
    face: Labels  # feature of every place, (J,)
    pose: np.ndarray  # table pose of every place, (J,)
    # region of the machine, by the half of its range that every linear axis is in, (J,)
    region: np.ndarray
    # deviation per standard uncertainty of everything that the calibration leaves unknown, the
    # datum features included, (J, Q), mm
    shared: Array
    lost: int = 0  # places that not every visit has
    gross: int = 0  # places left out because a visit met something else there

    def __len__(self) -> int:
        return len(self.deviation)


def visits_of(
    runs: Sequence[Run],
    is_task: Sequence[Mask],
    is_datum: Sequence[Mask],
    calibration: Array,
    model: Model | None = None,
    estimates: Prior | None = None,
) -> Visits:
    """Pair the places of several runs of one standard.

    Args:
        is_task: Touches like those of the task, of every run, (N,).
        is_datum: Touches that place the standard, (N,); all others take no part.
        calibration: Columns (N, Q) of the first run per standard uncertainty of the features'
            places, mm; what its size leaves open comes to it, the same in all visits.
        model: What is known of the machine; None for nothing.

    Raises:
        NotEnoughData: One visit, no datum, or too few places that all of them have.
    """
    if len(runs) < 2:
        raise NotEnoughData("one visit, expected at least 2: one says nothing of repeatability")
    seen = [
        _placed(run, task, datum, model, estimates)
        for run, task, datum in zip(runs, is_task, is_datum, strict=True)
    ]
    first = runs[0].touches
    rows = _apart(first, np.flatnonzero(is_task[0]))
    found = [rows] + [
        _same_places(first, rows, run.touches, np.flatnonzero(task))
        for run, task in zip(runs[1:], is_task[1:], strict=True)
    ]
    at = np.stack(found)
    there = np.all(at >= 0, axis=0)
    deviation = np.stack([d[0][r] for d, r in zip(seen, at, strict=True)])
    far = np.any(np.stack([d[1][r] for d, r in zip(seen, at, strict=True)]), axis=0) & there
    # a place counts only if every visit has it: the covariances compare the same places
    kept = there & ~far
    if kept.sum() < MIN_PLACES:
        raise NotEnoughData(
            f"{int(kept.sum())} places on freeform faces that every visit has and that are like "
            f"the task, expected at least {MIN_PLACES}"
        )
    mine = rows[kept]
    unknown = np.concatenate([calibration, _size_columns(first)], axis=1)
    return Visits(
        deviation=deviation[:, kept],
        face=first.feature[mine],
        pose=first.pose[mine],
        region=_region(first[mine]),
        shared=_placed_columns(runs[0], is_datum[0], unknown)[mine],
        lost=int((~there).sum()),
        gross=int(far.sum()),
    )


def _placed(
    run: Run, is_task: Mask, is_datum: Mask, model: Model | None, estimates: Prior | None
) -> tuple[Array, Mask]:
    """Deviations seen from the datum features, (N,), mm, and which of them are gross errors."""
    if not is_datum.any():
        raise NotEnoughData("no touch on a ball or the datum plane places the standard")
    # the machine is held at what is known of it: a free size of the standard would take its scale
    run = replace(run, touches=_without_sizes(run.touches))
    used = is_task | is_datum
    split = np.where(is_task[used], "test", "train")
    model = model or Model(run.touches.chain, ())
    mean = np.zeros(0) if estimates is None else estimates.mean
    known = Prior(mean, np.zeros((len(mean), len(mean))))
    fit = fit_run(replace(run[used], split=split), model, known)
    deviation, far = np.full(len(run), np.nan), np.zeros(len(run), dtype=np.bool_)
    deviation[used], far[used] = fit.residual, fit.gross_test_rows
    if estimates is not None:  # what the model itself does not know is no accident of a touch
        u = np.linalg.norm(model.columns(run.touches) @ estimates.root, axis=1)
        far[used] &= np.abs(fit.residual) > fit.gross.limit * u[used]
    return deviation, far


def _without_sizes(touches: Touches) -> Touches:
    """Touches of a standard whose size, its growth taken off, is not to be estimated."""
    return replace(touches, setups=tuple(replace(s, body=None) for s in touches.setups))


def _size_columns(touches: Touches) -> Array:
    """Deviation per standard uncertainty of temperature and expansion of the standard, (N, K)."""
    sizes = body_errors(touches)
    return columns(sizes, touches) * [p.sd for one in sizes for p in one.parameters]


def _placed_columns(run: Run, is_datum: Mask, calibration: Array) -> Array:
    """What calibration does to deviations that are seen from the datum features, (N, Q), mm."""
    S = columns(placing_errors(run.touches), run.touches)
    placed = np.linalg.lstsq(S[is_datum], calibration[is_datum], rcond=1e-9)[0]
    return np.asarray(calibration - S @ placed)


def _region(touches: Touches) -> np.ndarray:
    """Number of the part of the machine where a touch is, one of eight for three linear axes."""
    linear = touches.chain.linear_columns
    q = touches.q[:, linear]
    return np.asarray((q > 0.5 * (q.min(axis=0) + q.max(axis=0))) @ 2 ** np.arange(len(linear)))


def _apart(touches: Touches, rows: np.ndarray) -> np.ndarray:
    """The first touch of every place; places that are revisited count once."""
    again = _same_places(touches, rows, touches, rows)
    return np.unique(again[again >= 0])


def _same_places(first: Touches, rows: np.ndarray, other: Touches, among: np.ndarray) -> np.ndarray:
    """Row of the touch at the same place of the standard for every row, the first such; else -1."""
    rotary = first.chain.rotary_columns
    out = np.full(len(rows), -1)
    for k, row in enumerate(rows):
        same = among[other.feature[among] == first.feature[row]]
        off = np.linalg.norm(other.point[same] - first.point[row], axis=1)
        turn = np.abs(other.q[same][:, rotary] - first.q[row, rotary]).max(axis=1, initial=0.0)
        near = (off < _VISIT_SPACING) & (turn < _VISIT_TURN)
        if near.any():
            out[k] = same[near][np.argmin((off + turn / _VISIT_TURN)[near].round(3))]
    return out
